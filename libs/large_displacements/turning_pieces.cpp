// Rock that deforms turns with its own moment of inertia, however few zones it has.
//
// Masses lumped at the corners of zones have too large a moment of inertia about the centre of a piece of rock: three times that of
// a square of two zones. The mass matrix of a piece that is free is therefore
//     M - b (M s) (M s)^T,    b = (1 - r) / I,
// with M the lumped masses, s the rotation about the centre, I = s^T M s, and r the rock's own moment of inertia over I. Then
// s^T (M - ...) s = r I, and all other motion has the lumped masses. The inverse (Sherman and Morrison) is
//     M^-1 + g s s^T,         g = (1 / r - 1) / I:
// a moment T about the centre adds g T s to the accelerations.

#include "large_displacements/dynamics.hpp"
#include "large_displacements/in_chunks.hpp"
#include "model/disjoint_sets.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{
namespace
{

constexpr double least_correction = 1e-3; // of the moment of inertia; below it there is none

} // namespace

void Dynamics::find_pieces()
{
    DisjointSets sets(now_.place.size());
    std::vector<char> is_of_piece(now_.place.size(), 0);
    const std::vector<Index> leader = leaders();
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        if (deforms(z))
            for (const Index g : assembly_.zones.gridpoints(z)) {
                is_of_piece[leader[g]] = 1;
                sets.join(leader[g], leader[assembly_.zones.gridpoints(z)[0]]);
            }
    const std::vector<double> masses = lumped_masses(assembly_);
    struct Found {
        Piece piece;
        double mass = 0, lumped = 0, own = 0; // [kg/m], moments of inertia [kg m]
        Vector2d centre{0, 0};
        bool is_free = true;
    };
    std::vector<Found> all;
    std::map<Index, std::size_t> number; // by root
    for (std::size_t g = 0; g < now_.place.size(); ++g)
        if (is_of_piece[g]) {
            const auto [at, is_new] = number.try_emplace(sets.root(static_cast<Index>(g)), all.size());
            if (is_new)
                all.emplace_back();
            Found& found = all[at->second];
            found.piece.gridpoint.push_back(static_cast<Index>(g));
            found.mass += masses[g];
            found.centre += masses[g] * assembly_.position[g];
            found.is_free = found.is_free && body_of_[g] < 0 && assembly_.is_free[g].minCoeff() > 0;
        }
    for (Found& found : all) {
        found.centre /= found.mass;
        for (const Index g : found.piece.gridpoint)
            found.lumped += masses[g] * (assembly_.position[g] - found.centre).squaredNorm();
    }
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        if (deforms(z)) {
            Found& found = all[number.at(sets.root(leader[assembly_.zones.gridpoints(z)[0]]))];
            Vector2d sum(0, 0);
            double squares = 0;
            for (const Index g : assembly_.zones.gridpoints(z)) {
                const Vector2d arm = assembly_.position[g] - found.centre;
                squares += arm.squaredNorm();
                sum += arm;
            }
            found.own += assembly_.zones.mass[z] / 12 * (squares + sum.squaredNorm());
        }
    pieces_.clear();
    piece_of_.assign(now_.place.size(), -1);
    for (Found& found : all) {
        found.piece.share = found.own / found.lumped;
        if (!found.is_free || 1 - found.piece.share < least_correction)
            continue;
        for (const Index g : found.piece.gridpoint)
            piece_of_[g] = static_cast<Index>(pieces_.size());
        pieces_.push_back(std::move(found.piece));
    }
}

Dynamics::Turn Dynamics::turn_of(const Piece& piece) const
{
    Turn turn;
    double mass = 0;
    for (const Index g : piece.gridpoint) {
        mass += 1 / now_.inverse_mass[g];
        turn.centre += now_.place[g] / now_.inverse_mass[g];
    }
    turn.centre /= mass;
    double lumped = 0;
    for (const Index g : piece.gridpoint) {
        const Vector2d s = rotation(now_.place[g] - turn.centre);
        lumped += s.squaredNorm() / now_.inverse_mass[g];
        turn.momentum += s.dot(now_.velocity[g]) / now_.inverse_mass[g];
        turn.moment += s.dot(now_.force[g]);
    }
    turn.b = (1 - piece.share) / lumped;
    turn.g = (1 / piece.share - 1) / lumped;
    return turn;
}

std::vector<Dynamics::Turn> Dynamics::turns() const
{
    std::vector<Turn> turns(pieces_.size());
    for_each(static_cast<Index>(pieces_.size()), assembly_.threads,
             [&](Index p) { turns[p] = turn_of(pieces_[p]); });
    return turns;
}

// The frequency squared that steps must be short enough for, where a piece turns on contacts with these row sums of
// stiffness [Pa], beside the highest one without it [1/s2]. Turning adds at most g s^T K s to that one; a piece that turns as a
// rigid one has s^T K s / (r I), and steps are so much shorter as those of rigid bodies.
double Dynamics::frequency_with(const Piece& piece, double highest, double impacts,
                                const std::vector<double>& sums_of_contacts) const
{
    const Turn turn = turn_of(piece);
    double stiffness = 0;
    for (const Index g : piece.gridpoint)
        stiffness += sums_of_contacts[g] * (now_.place[g] - turn.centre).squaredNorm();
    const double own = turn.g * stiffness / (1 - piece.share); // g = (1 - r) / (r I)
    return std::max(highest + turn.g * stiffness, impacts * impacts * own);
}

// Few zones on very stiff joints would need far shorter steps, in which dashpots make too much of rounding errors: such pieces
// keep the lumped masses.
void Dynamics::leave_stiff_pieces(double highest, double impacts, const std::vector<double>& sums_of_contacts)
{
    constexpr double most = 8; // of the frequency squared: steps are a third at least
    std::erase_if(pieces_, [&](const Piece& piece) {
        return frequency_with(piece, highest, impacts, sums_of_contacts) > most * highest;
    });
    piece_of_.assign(piece_of_.size(), -1);
    for (std::size_t p = 0; p < pieces_.size(); ++p)
        for (const Index g : pieces_[p].gridpoint)
            piece_of_[g] = static_cast<Index>(p);
}

} // namespace jointcreep::large_displacements
