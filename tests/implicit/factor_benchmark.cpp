// factor_benchmark: what CHOLMOD alone takes for the matrix that the implicit engine factorises.
//
//   factor_benchmark joints.h5 ZONE_SIZE_M
//
// Prints two lines of CSV, head and values, for the section before anything is dug, all contacts stuck, and a
// little shear stiffness where a joint has none, as in the engine (implicit/linear.cpp): sizes of mesh and
// matrix; processor time of analysing (the order in which unknowns are eliminated, and where the factor is
// not zero), factorising and one back-substitution [s]; entries of the factor and the most memory that
// CHOLMOD held on the way [MB]; what one product with the matrix takes [s].
//
// The matrix is assembled here once more, by itself, and must agree with the engine's
// (implicit/stiffness.hpp).

#include "implicit/stiffness.hpp"
#include "mechanics/assembly.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"
#include "zoning/zone.hpp"

#include <cholmod.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

using namespace jointcreep;
using mechanics::Assembly;
using mechanics::Vector2d;

namespace
{

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

// Processor time of a call [s]: the shortest of at least five, and of a second of them, as others may be at
// work beside it.
double seconds_of(const std::function<void()>& call)
{
    double shortest = std::numeric_limits<double>::infinity(), all = 0;
    for (int i = 0; i < 5 || (all < 1 && i < 1000); ++i) {
        const std::clock_t start = std::clock();
        call();
        const double taken = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        shortest = std::min(shortest, taken);
        all += taken;
    }
    return shortest;
}

// Row of each gridpoint's {x, y} in the engine's matrix; -1 where held.
std::vector<std::array<int, 2>> rows_of(const Assembly& assembly, const implicit::Stiffness& stiffness)
{
    std::vector<Vector2d> number(assembly.position.size(), Vector2d::Zero());
    stiffness.add_to(
        number, Eigen::VectorXd::LinSpaced(stiffness.size(), 1, static_cast<double>(stiffness.size())), 1);
    std::vector<std::array<int, 2>> rows(number.size());
    for (std::size_t g = 0; g < rows.size(); ++g)
        rows[g] = {static_cast<int>(number[g].x()) - 1, static_cast<int>(number[g].y()) - 1};
    return rows;
}

// Its lower half.
Matrix matrix_of(const Assembly& assembly, const std::vector<joint::Tangent>& tangents,
                 const std::vector<std::array<int, 2>>& rows, Eigen::Index size)
{
    std::vector<Eigen::Triplet<double, int>> entries;
    const auto add = [&](Index a, Index b, const Eigen::Matrix2d& block) {
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                if (rows[b][j] >= 0 && rows[a][i] >= rows[b][j])
                    entries.emplace_back(rows[a][i], rows[b][j], block(i, j));
    };
    const rock::Zones& zones = assembly.zones;
    for (std::size_t z = 0; z < zones.size(); ++z) {
        const mechanics::Vector3d& c = zones.stiffness[z];
        Eigen::Matrix3d elastic;
        elastic << c[0], c[1], 0, c[1], c[0], 0, 0, 0, c[2];
        std::array<Eigen::Matrix<double, 3, 2>, 3> strain;
        for (int i = 0; i < 3; ++i) {
            const Vector2d& slope = zones.gradients(z)[i];
            strain[i] << slope.x(), 0, 0, slope.y(), slope.y(), slope.x();
        }
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                add(zones.gridpoints(z)[i], zones.gridpoints(z)[j],
                    zones.area[z] * strain[i].transpose() * elastic * strain[j]);
    }
    const joint::Contacts& contacts = assembly.contacts;
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        const Vector2d& n = contacts.normal[c];
        const Vector2d t(n.y(), -n.x());
        const Eigen::Matrix2d block = contacts.length[c] * (tangents[c].normal * n * n.transpose() +
                                                            tangents[c].shear * t * t.transpose());
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                add(contacts.gridpoint[c][i], contacts.gridpoint[c][j], (i == j ? 1 : -1) * block);
    }
    Matrix matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

void measure(const std::string& path, double zone_size)
{
    const store::JointsFile file = store::read_joints(path);
    Scene scene = scene::parse_scene(file.provenance.scene, path + ": /scene");
    scene.zone_size = zone_size;
    const Mesh mesh = zoning::zone(scene, file.network.blocks);
    const Assembly assembly = mechanics::assemble(scene, file.network, file.equivalent, mesh);
    std::vector<joint::Tangent> stuck(assembly.contacts.law.size());
    for (std::size_t c = 0; c < stuck.size(); ++c) {
        const auto& law = std::get<joint::Coulomb>(assembly.contacts.law[c]);
        stuck[c] = {law.k_n, law.k_s > 0 ? law.k_s : 1e-6 * law.k_n, 0, 0};
    }

    implicit::Stiffness stiffness;
    stiffness.follow(assembly);
    Matrix matrix = matrix_of(assembly, stuck, rows_of(assembly, stiffness), stiffness.size());
    const Eigen::VectorXd probe = Eigen::VectorXd::Random(stiffness.size());
    const Eigen::VectorXd product = stiffness.times(assembly, {.contacts = stuck}, probe);
    const double apart = (matrix.selfadjointView<Eigen::Lower>() * probe - product).norm() / product.norm();
    if (!(apart < 1e-12))
        throw std::runtime_error("the matrix is not the engine's: products differ by " +
                                 std::to_string(apart));

    cholmod_common common;
    cholmod_start(&common);
    cholmod_sparse lower = Eigen::viewAsCholmod(matrix);
    lower.stype = -1;
    cholmod_dense right = Eigen::viewAsCholmod(const_cast<Eigen::VectorXd&>(product));
    cholmod_factor* factor = nullptr;
    const double analyse = seconds_of([&] {
        cholmod_free_factor(&factor, &common);
        factor = cholmod_analyze(&lower, &common);
    });
    const double factorise = seconds_of([&] { cholmod_factorize(&lower, factor, &common); });
    if (common.status != CHOLMOD_OK)
        throw std::runtime_error("CHOLMOD's status is " + std::to_string(common.status));
    cholmod_dense *solution = nullptr, *y = nullptr, *e = nullptr;
    const double solve = seconds_of(
        [&] { cholmod_solve2(CHOLMOD_A, factor, &right, nullptr, &solution, nullptr, &y, &e, &common); });
    const Eigen::Map<const Eigen::VectorXd> found(static_cast<const double*>(solution->x), probe.size());
    if (!((matrix.selfadjointView<Eigen::Lower>() * found - product).norm() < 1e-10 * product.norm()))
        throw std::runtime_error("CHOLMOD's solution is wrong");
    const double multiply = seconds_of([&] { stiffness.times(assembly, {.contacts = stuck}, probe); });

    std::cout << "zones,unknowns,matrix_entries,factor_entries,cholmod_MB,analyse_s,factorise_s,solve_s,"
                 "product_s\n"
              << mesh.zone_gridpoint.size() << ',' << matrix.rows() << ',' << matrix.nonZeros() << ','
              << common.lnz << ',' << static_cast<double>(common.memory_usage) / 1e6 << ',' << analyse << ','
              << factorise << ',' << solve << ',' << multiply << '\n';
    for (cholmod_dense** vector : {&solution, &y, &e})
        cholmod_free_dense(vector, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
}

} // namespace

int main(int argc, char** argv)
{
    try {
        if (argc != 3)
            throw std::runtime_error("usage: factor_benchmark JOINTS.h5 ZONE_SIZE_M");
        measure(argv[1], std::stod(argv[2]));
    } catch (const std::exception& error) {
        std::cerr << "factor_benchmark: " << error.what() << '\n';
        return 1;
    }
}
