// How fast the error falls as zones shrink: displacements given all round a plate, from an exact solution of plane strain.

#include "../mechanics/sections.hpp"

#include "implicit/equilibrium.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>

namespace order_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;
using Complex = std::complex<double>;

namespace
{

constexpr double youngs_modulus = 1e9, poissons_ratio = 0.3;

// 2 G (u + i v) = kappa phi - z conj(phi') - conj(psi) with polynomials of the fourth degree (Muskhelishvili): not one
// of the displacements that zones have.
Vector2d exact(const Vector2d& place)
{
    constexpr double kappa = 3 - 4 * poissons_ratio, twice_g = youngs_modulus / (1 + poissons_ratio);
    const Complex z(place.x() / 4, place.y() / 4), a(3e5, 1e5), b(-2e5, 4e5);
    const Complex phi = a * z * z * z * z, slope = 4.0 * a * z * z * z, psi = b * z * z * z * z;
    const Complex moved = (kappa * phi - z * std::conj(slope) - std::conj(psi)) / twice_g;
    return {moved.real(), moved.imag()};
}

// Root of the mean square of the error inside [m], over that of the displacements.
double error_of(bool quadratic, double size)
{
    Scene scene = section({{0, 0}, {4, 0}, {4, 2}, {0, 2}}, 0.01);
    scene.zone_size = size;
    scene.asks_for_quadratic_zones = quadratic;
    scene.gravity = 0;
    scene.rocks[0].youngs_modulus = youngs_modulus;
    scene.rocks[0].poissons_ratio = poissons_ratio;
    Section s = assembled(std::move(scene), {}, 1e9, 1e9);
    mechanics::Assembly& assembly = s.assembly;
    std::vector<std::size_t> inside;
    for (std::size_t g = 0; g < assembly.position.size(); ++g) {
        const Vector2d& p = assembly.position[g];
        if (std::min({p.x(), 4 - p.x(), p.y(), 2 - p.y()}) > 1e-9) {
            inside.push_back(g);
            continue;
        }
        assembly.displacement[g] = exact(p);
        assembly.is_free[g] = assembly.is_free_untied[g] = {0, 0};
    }
    implicit::Solver solver;
    const auto found =
        solver.equilibrate(assembly, {.tolerance = 1e-10, .unloading_increments = 1, .most_steps = 1000}, {});
    EXPECT_TRUE(found) << solver.reason();
    double error = 0, all = 0;
    for (const std::size_t g : inside) {
        error += (assembly.displacement[g] - exact(assembly.position[g])).squaredNorm();
        all += exact(assembly.position[g]).squaredNorm();
    }
    return std::sqrt(error / all);
}

} // namespace

// The mesh of each size is another one, so that the order is one over two halvings.
TEST(order, constant_strain_is_of_second_order_and_quadratic_zones_of_third)
{
    for (const bool quadratic : {false, true}) {
        const double coarse = error_of(quadratic, 0.5), fine = error_of(quadratic, 0.125);
        const double order = std::log(coarse / fine) / std::log(4.0);
        EXPECT_GT(order, quadratic ? 2.8 : 1.8) << coarse << ' ' << fine;
        EXPECT_LT(coarse, quadratic ? 5e-4 : 1e-2);
        std::printf("%s: errors %.2e, %.2e, order %.2f\n", quadratic ? "quadratic" : "constant strain",
                    coarse, fine, order);
    }
}

} // namespace order_test
