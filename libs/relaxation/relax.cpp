#include "relaxation/relax.hpp"

#include "model/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace jointcreep::relaxation
{

using Eigen::Vector2d;
using mechanics::Assembly;
using mechanics::Balance;
using mechanics::Certificate;

namespace
{

constexpr Index check_every = 20, window = 100; // [steps]
constexpr Index patience = 5000;                // between looks at what moves on [steps]
constexpr double safety = 0.9;                  // of the largest stable step
constexpr Index chunk = 512;                    // gridpoints summed together, whatever the number of threads

// Contact forces at the last few checks.
class ForceMemory
{
public:
    // Takes the present forces and returns the largest change over the last `window` steps, infinite before.
    double change_since_window(const Assembly& assembly)
    {
        std::vector<Vector2d>& oldest = kept_[n_ % kept_.size()];
        double change = std::numeric_limits<double>::infinity();
        if (n_ >= kept_.size()) {
            change = 0;
            for (std::size_t c = 0; c < oldest.size(); ++c)
                change = std::max(change, (assembly.contact_force[c] - oldest[c]).norm());
        }
        oldest = assembly.contact_force;
        ++n_;
        return change;
    }

private:
    std::array<std::vector<Vector2d>, window / check_every> kept_;
    std::size_t n_ = 0;
};

class Relaxation
{
public:
    Relaxation(Assembly& assembly, const Equilibrium& settings, const std::vector<double>& row_sums)
        : a_(assembly), settings_(settings), velocity_(assembly.position.size(), Vector2d::Zero()),
          start_(assembly.displacement), patience_ago_(assembly.displacement)
    {
        if (settings.damping == Damping::mass && settings.masses == Masses::scaled)
            throw input_error("equilibrium: damping \"mass\" needs masses = \"real\"; scaled masses have no "
                              "frequency of their own");
        take_stiffness(row_sums);
        too_far_ = size_of(assembly) / 10;
        const std::size_t n_chunks = (assembly.position.size() + chunk - 1) / chunk;
        energy_.resize(n_chunks);
        quotient_.resize(n_chunks);
        damped_.resize(n_chunks);
        if (settings.stiffness_damping > 0)
            assembly.zones.last_stress = assembly.zones.stress;
        forget_dissipated_energy(assembly);
        stored_at_start_ = stored_energy(assembly);
        if (settings.damping == Damping::adaptive)
            last_force_ = assembly.force;
    }

    // Of the solver, since this began [s].
    double time() const { return time_before_ + steps_since_ * dt_; }

    void step()
    {
        const auto n = static_cast<Index>(velocity_.size());
        const auto n_chunks = static_cast<Index>(energy_.size());
        const double alpha = settings_.damping == Damping::mass ? settings_.mass_damping : alpha_;
        const double keep = (1 - alpha * dt_ / 2) / (1 + alpha * dt_ / 2);
        // Velocities live half a step before displacements: from rest the first one gets half a step's gain.
        // With a whole one the stiffest parts would overshoot, and stopping them again and again would blow
        // them up.
        const double interval = (starts_from_rest_ ? 0.5 : 1.0) * dt_;
        const double gain = interval / (1 + alpha * dt_ / 2);
        starts_from_rest_ = false;
        const double local = settings_.damping == Damping::local ? settings_.local_damping : 0.0;
        const bool adaptive = settings_.damping == Damping::adaptive;
#pragma omp parallel for schedule(static) num_threads(a_.threads) if (a_.threads > 1)
        for (Index k = 0; k < n_chunks; ++k) {
            double energy = 0, work = 0, damped = 0;
            for (Index g = k * chunk; g < std::min(n, (k + 1) * chunk); ++g) {
                Vector2d force = a_.force[g].cwiseProduct(a_.is_free[g]);
                const Vector2d free_force = force;
                Vector2d& v = velocity_[g];
                if (adaptive) { // how the force has answered to the last step's motion
                    work -= v.dot(force - last_force_[g]);
                    last_force_[g] = force;
                    if (mass_[g] > 0)
                        energy += v.squaredNorm() / mass_[g];
                }
                if (local > 0)
                    force -= local * Vector2d(v.x() == 0 ? 0 : std::copysign(std::abs(force.x()), v.x()),
                                              v.y() == 0 ? 0 : std::copysign(std::abs(force.y()), v.y()));
                const Vector2d last = v;
                v = keep * v + gain * mass_[g] * force;
                if (mass_[g] > 0)
                    damped += free_force.dot(v + last) / 2 * dt_ -
                              (v.squaredNorm() - last.squaredNorm()) / (2 * mass_[g]);
                a_.displacement[g] += dt_ * v;
            }
            energy_[k] = energy;
            quotient_[k] = work;
            damped_[k] = damped;
        }
        double energy = 0, work = 0;
        for (Index k = 0; k < n_chunks; ++k) {
            energy += energy_[k];
            work += quotient_[k];
            total_damped_ += damped_[k];
        }
        if (adaptive)
            alpha_ = energy > 0 && work > 0 ? std::min(2 * std::sqrt(work / (dt_ * energy)), 1.9 / dt_) : 0.0;
        find_forces(a_);
        ++steps_since_;
        if (!stiffening_.empty())
            follow_stiffness();
    }

    // Throws if a piece of rock is on its way: far already, or steadily.
    void check_motion(Index steps)
    {
        const auto [moved, g] = mechanics::farthest_move(start_, a_.displacement);
        if (!(moved <= too_far_))
            throw equilibrium_error(
                "no equilibrium: the rock at " + shown(a_.position[g]) + " has moved " +
                (std::isfinite(moved) ? shown_length(moved) : std::string("without bound")) +
                " and is still moving; is it held by anything?");
        if (steps % patience != 0)
            return;
        // What comes to rest slows down. What slides or falls does not: damping only lends it a steady speed.
        const auto [lately, h] = mechanics::farthest_move(patience_ago_, a_.displacement);
        windows_without_slowing_ = lately > 0.95 * moved_before_ ? windows_without_slowing_ + 1 : 0;
        if (windows_without_slowing_ == 4)
            throw equilibrium_error("no equilibrium: the rock at " + shown(a_.position[h]) +
                                    " moves on without slowing down, " + shown_length(lately) +
                                    " over the last " + std::to_string(patience) +
                                    " steps; it slides or falls, and nothing stops it");
        moved_before_ = lately;
        patience_ago_ = a_.displacement;
    }

    // Ends the motion and settles the account of energy.
    void finish(Certificate& certificate)
    {
        a_.stiffness_damping_rate = 0;
        find_forces(a_);
        certificate.stored = stored_energy(a_) - stored_at_start_;
        certificate.dissipated = dissipated_energy(a_);
        certificate.work_of_loads = work_of_loads(a_, start_);
        // Stiffness damping works inside zones and contacts, unseen by the gridpoints' motion: it takes what
        // is missing.
        certificate.damped = settings_.stiffness_damping > 0
                                 ? certificate.work_of_loads - certificate.stored - certificate.dissipated
                                 : total_damped_;
    }

private:
    // Masses and step for these row sums.
    void take_stiffness(const std::vector<double>& row_sums)
    {
        const double local = settings_.damping == Damping::local ? 1 + settings_.local_damping : 1.0;
        time_before_ = time();
        steps_since_ = 0;
        if (settings_.masses == Masses::real) {
            mass_ = lumped_masses(a_);
            double highest = 0; // frequency squared
            for (std::size_t g = 0; g < mass_.size(); ++g)
                if (mass_[g] > 0)
                    highest = std::max(highest, row_sums[g] / mass_[g]);
            // Stiffness damping shortens the stable step: (2 / w) (sqrt(1 + xi^2) - xi), xi = beta w / 2.
            const double xi = settings_.stiffness_damping * std::sqrt(highest) / 2;
            dt_ = safety * 2 / std::sqrt(highest * local) * (std::sqrt(1 + xi * xi) - xi);
        } else {
            dt_ = 1;
            mass_.clear();
            for (const double sum : row_sums)
                mass_.push_back(sum * local / (4 * safety * safety));
        }
        for (double& m : mass_)
            m = m > 0 ? 1 / m : 0.0; // from here on inverse; gridpoints without any rock do not move
        a_.stiffness_damping_rate = settings_.stiffness_damping / dt_;
        const mechanics::Contacts& contacts = a_.contacts;
        stiffening_.clear();
        for (std::size_t c = 0; c < contacts.law.size(); ++c)
            if (!is_linear(contacts.law[c]) && contacts.status[c] != ContactStatus::removed)
                stiffening_.emplace_back(c, mechanics::room_to_stiffen * normal_stiffness(c));
    }

    double normal_stiffness(std::size_t contact) const
    {
        const mechanics::Contacts& contacts = a_.contacts;
        return slopes(contacts.law[contact], contacts.state[contact], contacts.traction[contact].x()).k_n;
    }

    // Masses or the step follow joints that have grown stiffer than these are stable for. Velocities keep the
    // kinetic energy, or the account would not close.
    void follow_stiffness()
    {
        if (std::none_of(stiffening_.begin(), stiffening_.end(), [&](const auto& contact) {
                return normal_stiffness(contact.first) > contact.second;
            }))
            return;
        const std::vector<double> before = mass_;
        const double last_dt = dt_;
        take_stiffness(stiffness_row_sums(a_));
        for (std::size_t g = 0; g < before.size(); ++g) {
            if (!(before[g] > 0))
                continue;
            const Vector2d last = velocity_[g], force = a_.force[g].cwiseProduct(a_.is_free[g]);
            velocity_[g] *= std::sqrt(mass_[g] / before[g]);
            // The next step takes half of the last one's work to be that of this velocity.
            total_damped_ += force.dot(last_dt * last - dt_ * velocity_[g]) / 2;
        }
    }

    static std::string shown_length(double length)
    {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), "%.3g m", length);
        return text.data();
    }

    Assembly& a_;
    const Equilibrium& settings_;
    std::vector<Vector2d> velocity_;
    std::vector<Vector2d> start_, patience_ago_, last_force_;
    std::vector<double> mass_; // inverse [m/kg]
    std::vector<double> energy_, quotient_, damped_;
    double total_damped_ = 0, stored_at_start_ = 0;
    std::vector<std::pair<std::size_t, double>> stiffening_; // contacts, and how stiff they may be [Pa/m]
    double time_before_ = 0;                                 // at the last change of the step [s]
    Index steps_since_ = 0;
    double dt_ = 0, too_far_ = 0, alpha_ = 0;
    double moved_before_ = std::numeric_limits<double>::infinity(); // in the last window of `patience` steps
    int windows_without_slowing_ = 0;
    bool starts_from_rest_ = true;
};

} // namespace

Certificate relax(Assembly& assembly, const Equilibrium& settings, const StepObserver& observe)
{
    find_forces(assembly);
    Certificate certificate;
    const std::vector<double> row_sums = stiffness_row_sums(assembly);
    const double stiffest = *std::max_element(row_sums.begin(), row_sums.end());
    double farthest = 0; // displacement on the way [m]
    const auto balance_now = [&] {
        for (const Vector2d& u : assembly.displacement)
            farthest = std::max(farthest, u.norm());
        return balance_of(assembly, stiffest, farthest, settings.tolerance);
    };
    certificate.out_of_balance_ratio = balance_now().ratio();
    if (certificate.out_of_balance_ratio <= settings.tolerance)
        return certificate;

    Relaxation relaxation(assembly, settings, row_sums);
    ForceMemory memory;
    memory.change_since_window(assembly);
    Index steps_in_balance = 0;
    while (certificate.steps < settings.most_steps) {
        relaxation.step();
        ++certificate.steps;
        if (observe)
            observe(relaxation.time());
        if (certificate.steps % check_every != 0)
            continue;
        relaxation.check_motion(certificate.steps);
        const Balance balance = balance_now();
        certificate.out_of_balance_ratio = balance.ratio();
        certificate.contact_force_change = memory.change_since_window(assembly) / balance.mean;
        if (!std::isfinite(certificate.out_of_balance_ratio))
            throw equilibrium_error("no equilibrium: forces are no longer finite numbers after " +
                                    std::to_string(certificate.steps) + " steps");
        steps_in_balance =
            certificate.out_of_balance_ratio <= settings.tolerance ? steps_in_balance + check_every : 0;
        if (steps_in_balance >= window && certificate.contact_force_change <= settings.tolerance) {
            relaxation.finish(certificate);
            return certificate;
        }
    }
    const Balance balance = balance_of(assembly);
    throw equilibrium_error(
        "no equilibrium after " + std::to_string(certificate.steps) + " steps: the out-of-balance ratio is " +
        shown(certificate.out_of_balance_ratio) + ", wanted " + shown(settings.tolerance) +
        "; farthest from balance is the rock at " + shown(assembly.position[balance.worst]));
}

} // namespace jointcreep::relaxation
