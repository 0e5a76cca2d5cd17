// Sets of creeping joints that need no zones: displacements j = B u + g with any u, tractions F with B^T F =
// f.
//   B = 1: every traction is given;  no u: every displacement is given (platens);  between: redundant.
// In closed form: F = K (j - sum of d), every unit d' = (F - E d) / eta, a linear system of the d.

#pragma once

#include "mechanics/creep.hpp"

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

#include <cmath>
#include <random>

namespace jointcreep::test
{

using Eigen::MatrixXd;
using Eigen::VectorXd;

inline constexpr std::array<CreepScheme, 4> all_schemes = {CreepScheme::published, CreepScheme::backward,
                                                           CreepScheme::linear_force, CreepScheme::fitted};

// Edges whose normal direction is a chain each (Maxwell dashpot last); nothing creeps along them.
inline EquivalentJoints joints_of(const std::vector<Chain>& chains)
{
    EquivalentJoints joints;
    std::size_t units = 0;
    for (const Chain& chain : chains)
        units = std::max(units, chain.units.size());
    for (const Chain& chain : chains) {
        joints.normal_stiffness.push_back(chain.spring);
        joints.normal_maxwell_viscosity.push_back(0);
        for (std::size_t u = 0; u < units; ++u) {
            const KelvinUnit unit = u < chain.units.size() ? chain.units[u] : KelvinUnit{0, 0};
            joints.normal_kelvin_stiffness.push_back(unit.stiffness);
            joints.normal_kelvin_viscosity.push_back(unit.stiffness > 0 ? unit.viscosity : 0);
            if (unit.stiffness == 0 && unit.viscosity > 0)
                joints.normal_maxwell_viscosity.back() = unit.viscosity;
        }
    }
    joints.shear_stiffness = joints.cohesion = joints.friction_angle = joints.tensile_strength =
        joints.dilation_angle = joints.dilation_until = joints.shear_maxwell_viscosity =
            std::vector<double>(chains.size(), 0.0);
    joints.law.assign(chains.size(), 0);
    joints.shear_kelvin_stiffness = joints.shear_kelvin_viscosity =
        std::vector<double>(chains.size() * units, 0.0);
    return joints;
}

inline Scene creeping(CreepScheme scheme)
{
    Scene scene;
    scene.creep.emplace().scheme = scheme;
    return scene;
}

class CreepingJoints
{
public:
    CreepingJoints(std::vector<Chain> chains, MatrixXd B) : chains_(std::move(chains)), B_(std::move(B))
    {
        const auto n = static_cast<Eigen::Index>(chains_.size());
        given_ = VectorXd::Zero(n);
        load_ = growth_ = VectorXd::Zero(B_.cols());
        for (Eigen::Index c = 0; c < n; ++c)
            for (const KelvinUnit& unit : chains_[c].units) {
                joint_.push_back(c);
                units_.push_back(unit);
            }
    }

    // At once, at the start of time.
    CreepingJoints& put_on(VectorXd load)
    {
        load_ = std::move(load);
        return *this;
    }
    // And so much more in each second.
    CreepingJoints& load_by(VectorXd growth)
    {
        growth_ = std::move(growth);
        return *this;
    }
    // Takes a joint away: it carries nothing.
    CreepingJoints& take_away(Eigen::Index joint)
    {
        chains_[joint].spring = 0;
        return *this;
    }
    CreepingJoints& give(VectorXd displacements)
    {
        given_ = std::move(displacements);
        return *this;
    }

    // Largest of the rates lam.
    double rate() const
    {
        double most = 0;
        for (const KelvinUnit& unit : units_)
            most = std::max(most, unit.stiffness / unit.viscosity);
        return most;
    }

    // Tractions at `time` with springs of stiffness k that are at rest at the displacements `offset`.
    VectorXd tractions(const VectorXd& k, const VectorXd& offset, double time = 0) const
    {
        VectorXd displacement = given_;
        if (B_.cols() > 0)
            displacement +=
                B_ * (B_.transpose() * k.asDiagonal() * B_)
                         .ldlt()
                         .solve(load_ + time * growth_ - B_.transpose() * k.cwiseProduct(given_ - offset));
        return k.cwiseProduct(displacement - offset);
    }

    // F = first + growth t - S sum(d).
    struct System {
        VectorXd first, growth;
        MatrixXd S;
    };
    System system() const
    {
        const auto n = static_cast<Eigen::Index>(chains_.size());
        VectorXd k(n);
        for (Eigen::Index c = 0; c < n; ++c)
            k[c] = chains_[c].spring;
        System all{tractions(k, VectorXd::Zero(n)), VectorXd(n), MatrixXd(n, n)};
        all.growth = tractions(k, VectorXd::Zero(n), 1) - all.first;
        for (Eigen::Index c = 0; c < n; ++c)
            all.S.col(c) = all.first - tractions(k, VectorXd::Unit(n, c));
        return all;
    }

    // Tractions at `time`; with what units have crept since time 0 in `crept`, which has it at time 0, or is empty.
    VectorXd exact(double time) const
    {
        VectorXd crept;
        return exact(time, crept);
    }
    VectorXd exact(double time, VectorXd& crept) const
    {
        const auto n = static_cast<Eigen::Index>(chains_.size());
        const auto m = static_cast<Eigen::Index>(units_.size());
        const System all = system();
        MatrixXd sum = MatrixXd::Zero(n, m); // of the units of every joint
        for (Eigen::Index u = 0; u < m; ++u)
            sum(joint_[u], u) = 1;
        MatrixXd M = MatrixXd::Zero(m + 2, m + 2); // of the units, of time and of 1
        for (Eigen::Index u = 0; u < m; ++u) {
            M.block(u, 0, 1, m) = -(all.S * sum).row(joint_[u]) / units_[u].viscosity;
            M(u, u) -= units_[u].stiffness / units_[u].viscosity;
            M(u, m) = all.growth[joint_[u]] / units_[u].viscosity;
            M(u, m + 1) = all.first[joint_[u]] / units_[u].viscosity;
        }
        M(m, m + 1) = 1;
        VectorXd start = VectorXd::Unit(m + 2, m + 1);
        if (crept.size() > 0)
            start.head(m) = crept;
        crept = ((M * time).exp() * start).head(m);
        return all.first + time * all.growth - all.S * sum * crept;
    }

    const std::vector<Chain>& chains() const { return chains_; }
    bool grows() const { return !growth_.isZero(0); }

private:
    std::vector<Chain> chains_;
    MatrixXd B_;
    VectorXd given_, load_, growth_;  // growth: in a second
    std::vector<Eigen::Index> joint_; // of every unit
    std::vector<KelvinUnit> units_;
};

// Such joints in time steps.
class Marching
{
public:
    Marching(const CreepingJoints& joints, CreepScheme scheme)
        : joints_(joints), mesh_(mesh_of(joints)), rock_(rock_of(joints)),
          creep_(creeping(scheme), {}, joints_of(joints.chains()), mesh_, rock_)
    {
        equilibrate();
    }

    double step(double duration)
    {
        creep_.begin(duration, rock_, joints_.grows());
        time_ += duration;
        equilibrate();
        return creep_.end(rock_);
    }
    // Other loads from now on, which is time 0 for them, on the same joints; some may be taken away.
    void go_on_with(const CreepingJoints& joints)
    {
        joints_ = joints;
        time_ = 0;
        for (std::size_t c = 0; c < joints.chains().size(); ++c)
            if (joints.chains()[c].spring == 0)
                rock_.contacts.status[c] = ContactStatus::removed;
        equilibrate();
    }
    double fastest_rate() const { return creep_.fastest_rate(); }
    VectorXd tractions() const
    {
        VectorXd all(static_cast<Eigen::Index>(mesh_.contact_edge.size()));
        for (Eigen::Index c = 0; c < all.size(); ++c)
            all[c] = rock_.contacts.traction[c].x();
        return all;
    }
    VectorXd crept() const
    {
        VectorXd all(static_cast<Eigen::Index>(mesh_.contact_edge.size()));
        for (Eigen::Index c = 0; c < all.size(); ++c)
            all[c] = rock_.contacts.offset[c].x();
        return all;
    }

private:
    static Mesh mesh_of(const CreepingJoints& joints)
    {
        Mesh mesh;
        for (std::size_t c = 0; c < joints.chains().size(); ++c)
            mesh.contact_edge.push_back(static_cast<Index>(c));
        return mesh;
    }
    static mechanics::Assembly rock_of(const CreepingJoints& joints)
    {
        mechanics::Assembly rock;
        for (const Chain& chain : joints.chains())
            rock.contacts.law.push_back(joint::Coulomb{chain.spring, 0, 0, 0, 0});
        const std::size_t n = joints.chains().size();
        rock.contacts.initial_traction.assign(n, {0, 0});
        rock.contacts.traction.assign(n, {0, 0});
        rock.contacts.offset.assign(n, {0, 0});
        rock.contacts.status.assign(n, ContactStatus::stuck);
        return rock;
    }
    void equilibrate()
    {
        const auto n = static_cast<Eigen::Index>(mesh_.contact_edge.size());
        VectorXd k(n), offset(n);
        for (Eigen::Index c = 0; c < n; ++c) {
            k[c] = rock_.contacts.status[c] == ContactStatus::removed ? 0 : joint::k_n(rock_.contacts.law[c]);
            offset[c] = rock_.contacts.offset[c].x();
        }
        const VectorXd tractions = joints_.tractions(k, offset, time_);
        for (Eigen::Index c = 0; c < n; ++c)
            rock_.contacts.traction[c].x() = tractions[c];
    }

    CreepingJoints joints_;
    double time_ = 0; // [s]
    Mesh mesh_;
    mechanics::Assembly rock_;
    mechanics::Creep creep_;
};

// The largest error of any traction after any of `steps` steps of equal length.
inline double largest_error(const CreepingJoints& joints, CreepScheme scheme, double time, int steps)
{
    Marching marching(joints, scheme);
    double largest = 0;
    for (int i = 1; i <= steps; ++i) {
        marching.step(time / steps);
        largest =
            std::max(largest, (marching.tractions() - joints.exact(time * i / steps)).cwiseAbs().maxCoeff());
    }
    return largest;
}

inline Chain kelvin(double spring, double ratio, double rate)
{
    return {spring, {{spring / ratio, spring / ratio / rate}}};
}

// A rigid level cap of weight W on two pillars of equal area.
inline CreepingJoints two_pillars(const Chain& one, const Chain& other, double weight = 1e6)
{
    return CreepingJoints({one, other}, MatrixXd::Ones(2, 1)).put_on(VectorXd::Constant(1, weight));
}

} // namespace jointcreep::test
