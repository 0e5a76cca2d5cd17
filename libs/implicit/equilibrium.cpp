#include "implicit/equilibrium.hpp"

#include "implicit/gmres.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::implicit
{

using mechanics::Balance;
using mechanics::Certificate;

namespace
{

constexpr int most_corrections = 80;
constexpr char mended = 100; // more openings than corrections can count
constexpr int patience = 15; // iterations with an old factor: a new one costs 10 to 20 of them
constexpr int most_halvings = 6;
constexpr double least_hold = 1e-2;
constexpr double soft = 1e-6; // share of their springs that open and slipping contacts keep in the factor

double farthest_move(const std::vector<Vector2d>& from, const std::vector<Vector2d>& to)
{
    double farthest = 0;
    for (std::size_t g = 0; g < from.size(); ++g)
        farthest = std::max(farthest, (to[g] - from[g]).norm());
    return farthest;
}

} // namespace

// Where an equilibrium starts from.
struct Engine::Start {
    std::vector<joint::CoulombState> state;
    std::vector<Vector2d> displacement, traction, jump;
};

// Finds forces at the present displacements, as reached straight from the start. Returns the merit: the
// squared out-of-balance forces, each over the stiffness against which it acts.
double Engine::evaluate(Assembly& assembly, const Start& start)
{
    assembly.contacts.state = start.state;
    for (std::size_t c = 0; c < breaks_.size(); ++c)
        if (breaks_[c])
            assembly.contacts.state[c].is_broken = true;
    find_forces(assembly);
    force_ = stiffness_.gathered(assembly, assembly.force);
    return force_.cwiseQuotient(scale_).dot(force_);
}

// Takes over what contacts do now: sliding back only by way of sticking, unless this is the `first` time. A
// bond that breaks for the second time stays broken: with cohesion back at every closing it might flicker for
// ever.
void Engine::take_states(const Assembly& assembly, const Start& start, bool first)
{
    const mechanics::Contacts& contacts = assembly.contacts;
    for (std::size_t c = 0; c < active_.size(); ++c) {
        Active now = Active::stuck;
        if (contacts.status[c] == ContactStatus::open || contacts.status[c] == ContactStatus::removed)
            now = Active::open;
        else if (contacts.status[c] == ContactStatus::slipping)
            now = contacts.traction[c].y() > 0 ? Active::slips_forward : Active::slips_backward;
        const bool turns_round = (now == Active::slips_forward && active_[c] == Active::slips_backward) ||
                                 (now == Active::slips_backward && active_[c] == Active::slips_forward);
        if (!first && now == Active::open && active_[c] != Active::open && !start.state[c].is_broken &&
            ++openings_[c] >= 2)
            breaks_[c] = 1;
        active_[c] = turns_round && !first ? Active::stuck : now;
    }
}

// Of the contacts as they are active; where they hold nothing they keep the share `softness` of their
// springs.
std::vector<Tangent> Engine::tangents(const Assembly& assembly, double softness) const
{
    const mechanics::Contacts& contacts = assembly.contacts;
    std::vector<Tangent> all(active_.size());
    for (std::size_t c = 0; c < all.size(); ++c) {
        const joint::Coulomb& law = contacts.law[c];
        const double soft_shear = softness * (law.k_s > 0 ? law.k_s : law.k_n);
        switch (active_[c]) {
        case Active::open:
            all[c] = {softness * law.k_n, soft_shear, 0};
            break;
        case Active::stuck:
            all[c] = {law.k_n, law.k_s > 0 ? law.k_s : soft_shear, 0};
            break;
        default:
            all[c] = {law.k_n, soft_shear,
                      (1 - softness) * (active_[c] == Active::slips_forward ? -1 : 1) * law.tan_phi *
                          law.k_n};
        }
    }
    return all;
}

// The displacement that balances `force` to `enough` [N/m], if contacts that slip or are open keep the share
// `hold` of their springs.
VectorXd Engine::correction(const Assembly& assembly, const VectorXd& force, double enough, double hold)
{
    const std::vector<Tangent> acting = tangents(assembly, hold);
    const auto product = [&](const VectorXd& x) { return stiffness_.times(assembly, acting, x); };
    const auto precondition = [&](const VectorXd& x) {
        ++solves_;
        return stiffness_.solve(x);
    };
    VectorXd x = VectorXd::Zero(force.size());
    if (stiffness_.has_factor() && gmres(product, precondition, force, enough, patience, x) <= enough)
        return x;
    if (!stiffness_.factorise(assembly, tangents(assembly, std::max(soft, hold))))
        return {};
    ++factorisations_;
    gmres(product, precondition, force, enough, 2 * patience, x);
    return x;
}

// Moves along a correction, all the way or as far as forces come nearer to balance, and at most `too_far`
// [m]. Returns the merit there.
double Engine::go_along(Assembly& assembly, const Start& start, const VectorXd& correction, double merit,
                        double too_far)
{
    const std::vector<Vector2d> from = assembly.displacement;
    const auto merit_at = [&](double share) {
        assembly.displacement = from;
        stiffness_.add_to(assembly.displacement, correction, share);
        return evaluate(assembly, start);
    };
    double share = std::min(1.0, too_far / correction.lpNorm<Eigen::Infinity>());
    double best_share = share, best_merit = std::numeric_limits<double>::infinity();
    for (int halving = 0; halving <= most_halvings; ++halving, share /= 2) {
        const double found = merit_at(share);
        if (found < best_merit) {
            best_merit = found;
            best_share = share;
        }
        if (found < (1 - 1e-4 * share) * merit)
            return found;
    }
    return merit_at(best_share);
}

// Bonds of contacts that opened on the way and have closed again: where they make no difference they are as
// they were at the start; elsewhere they get another chance. True if that changes forces.
bool Engine::mend_bonds(const Assembly& assembly)
{
    bool changes = false;
    for (std::size_t c = 0; c < breaks_.size(); ++c)
        if (breaks_[c] && openings_[c] < mended && assembly.contacts.status[c] != ContactStatus::open) {
            breaks_[c] = 0;
            openings_[c] = mended; // the next opening is the last
            changes = changes || assembly.contacts.status[c] == ContactStatus::slipping;
        }
    return changes;
}

// The largest change of a contact's force that a displacement would bring [N/m].
double Engine::force_change(const Assembly& assembly, const VectorXd& displacement) const
{
    std::vector<Vector2d> u(assembly.position.size(), Vector2d::Zero());
    stiffness_.add_to(u, displacement, 1);
    const std::vector<Tangent> acting = tangents(assembly, 0);
    const mechanics::Contacts& contacts = assembly.contacts;
    double largest = 0;
    for (std::size_t c = 0; c < acting.size(); ++c) {
        const auto& [a, b] = contacts.gridpoint[c];
        const Vector2d jump = u[b] - u[a], &normal = contacts.normal[c];
        const double opening = normal.dot(jump), shear = normal.y() * jump.x() - normal.x() * jump.y();
        largest = std::max(largest, contacts.length[c] *
                                        std::hypot(acting[c].normal * opening,
                                                   acting[c].shear * shear + acting[c].coupling * opening));
    }
    return largest;
}

// Leaves the assembly as it was.
std::nullopt_t Engine::give_up(Assembly& assembly, const Start& start)
{
    assembly.displacement = start.displacement;
    assembly.contacts.state = start.state;
    assembly.contacts.traction = start.traction;
    assembly.contacts.jump = start.jump;
    return std::nullopt;
}

std::optional<Certificate> Engine::equilibrate(Assembly& assembly, const Equilibrium& settings,
                                               const std::vector<Vector2d>& guess)
{
    stiffness_.follow(assembly);
    mechanics::Contacts& contacts = assembly.contacts;
    const Start start{contacts.state, assembly.displacement, contacts.traction, contacts.jump};
    const std::vector<double> row_sums = stiffness_row_sums(assembly);
    const double stiffest = *std::max_element(row_sums.begin(), row_sums.end());
    const double too_far = size_of(assembly) / 10;
    std::vector<Vector2d> scales;
    for (const double sum : row_sums)
        scales.emplace_back(sum, sum);
    scale_ = stiffness_.gathered(assembly, scales);
    active_.resize(contacts.state.size(), Active::stuck);
    breaks_.assign(contacts.state.size(), 0);
    openings_.assign(contacts.state.size(), 0);
    corrections_ = factorisations_ = solves_ = 0;

    Certificate certificate;
    certificate.is_implicit = true;
    double merit = evaluate(assembly, start);
    const double stored_at_start = stored_energy(assembly);
    const std::vector<Vector2d> traction_at_start = contacts.traction, jump_at_start = contacts.jump;
    if (!guess.empty()) {
        for (std::size_t g = 0; g < guess.size(); ++g)
            assembly.displacement[g] += guess[g].cwiseProduct(assembly.is_free[g]);
        const double guessed = evaluate(assembly, start);
        if (guessed < merit) {
            merit = guessed;
        } else {
            assembly.displacement = start.displacement;
            evaluate(assembly, start);
        }
    }
    take_states(assembly, start, true);
    if (!stiffness_.has_factor()) {
        if (!stiffness_.factorise(assembly, tangents(assembly, soft))) {
            reason_ = "some rock is held by nothing";
            return give_up(assembly, start);
        }
        ++factorisations_;
    }
    double least_merit = merit;
    double hold = 0;
    int since_least = 0;

    for (;;) {
        const Balance balance = balance_of(assembly, stiffest, 0, settings.tolerance);
        certificate.out_of_balance_ratio = balance.ratio();
        if (certificate.out_of_balance_ratio <= settings.tolerance) {
            if (corrections_ == 0)
                return certificate;
            // Is it at rest, too? That is for the next correction to say.
            const VectorXd du = correction(assembly, force_, 0.1 * force_.norm(), 0);
            certificate.contact_force_change = force_change(assembly, du) / balance.mean;
            if (certificate.contact_force_change <= settings.tolerance) {
                if (!mend_bonds(assembly))
                    break;
                merit = least_merit = evaluate(assembly, start);
                take_states(assembly, start, false);
                continue;
            }
        }
        if (corrections_ == most_corrections || since_least == 15) {
            reason_ = "forces do not come into balance in " + std::to_string(corrections_) + " corrections";
            return give_up(assembly, start);
        }

        const double enough = balance.ratio() <= settings.tolerance
                                  ? 0.1 * force_.norm()
                                  : std::max(0.5 * settings.tolerance * balance.mean,
                                             (corrections_ == 0 ? 1e-2 : 1e-3) * force_.norm());
        const VectorXd du = correction(assembly, force_, enough, hold);
        ++corrections_;
        if (du.size() == 0 || !du.allFinite()) {
            reason_ = "some rock is held by nothing";
            return give_up(assembly, start);
        }
        const std::vector<Vector2d> from = assembly.displacement;
        const double found = go_along(assembly, start, du, merit, too_far);
        if (found >= merit && hold < 1) {
            // Forces would not come nearer to balance that way: hold contacts that slip or are open more
            // firmly.
            hold = std::clamp(10 * hold, least_hold, 1.0);
            assembly.displacement = from;
            evaluate(assembly, start);
            continue;
        }
        hold = hold <= least_hold ? 0 : hold / 3;
        merit = found;
        take_states(assembly, start, false);
        if (farthest_move(start.displacement, assembly.displacement) > too_far) {
            reason_ = "rock would move by more than a tenth of the section";
            return give_up(assembly, start);
        }
        if (merit < least_merit) {
            least_merit = merit;
            since_least = 0;
        } else {
            ++since_least;
        }
    }

    certificate.steps = corrections_;
    // The account of energy is that of the straight way here.
    contacts.traction = traction_at_start;
    contacts.jump = jump_at_start;
    std::fill(contacts.dissipated.begin(), contacts.dissipated.end(), 0.0);
    evaluate(assembly, start);
    certificate.stored = stored_energy(assembly) - stored_at_start;
    for (const double lost : contacts.dissipated)
        certificate.dissipated += lost;
    for (std::size_t g = 0; g < assembly.position.size(); ++g)
        certificate.work_of_loads +=
            (assembly.load[g] + assembly.applied[g]).dot(assembly.displacement[g] - start.displacement[g]);
    certificate.damped = certificate.work_of_loads - certificate.stored - certificate.dissipated;
    return certificate;
}

} // namespace jointcreep::implicit
