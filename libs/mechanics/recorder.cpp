#include "mechanics/recorder.hpp"

#include "model/error.hpp"
#include "model/polygon.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace jointcreep::mechanics
{

namespace
{

std::string named_place(const std::string& what, const std::string& name, const Vector2d& at)
{
    return what + " \"" + name + "\" at " + shown(at);
}

bool stays_longer(Index stage, Index than)
{
    return stage != than && than != -1 && (stage == -1 || stage > than);
}

// The stage that removes the rock about a place of the scene, -1 if none does; of several the last. Nothing where
// there is no rock.
std::optional<Index> stage_about(const Vector2d& place, double radius, const Scene& scene)
{
    constexpr int directions = 180; // one in every corner of 2 degrees
    std::optional<Index> last;
    for (int i = 0; i < directions; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5) / directions;
        const Vector2d at = place + radius * Vector2d(std::cos(angle), std::sin(angle));
        const auto covers_it = [&](const Polygon& polygon) { return covers(polygon, at); };
        if (!covers_it(scene.outline) || std::ranges::any_of(scene.holes, covers_it))
            continue;
        const auto first = std::ranges::find_if(
            scene.stages, [&](const Stage& stage) { return std::ranges::any_of(stage.remove, covers_it); });
        const Index stage =
            first == scene.stages.end() ? -1 : static_cast<Index>(first - scene.stages.begin());
        if (!last || stays_longer(stage, *last))
            last = stage;
    }
    return last;
}

} // namespace

Recorder::Place Recorder::place_in_zone(const Mesh& mesh, std::size_t z, const std::array<double, 3>& share)
{
    const auto& corners = mesh.zone_gridpoint[z];
    Place place{{corners.begin(), corners.end()}, {share.begin(), share.end()}, static_cast<Index>(z)};
    if (!mesh.is_quadratic())
        return place;
    place.gridpoint.insert(place.gridpoint.end(), mesh.zone_middle[z].begin(), mesh.zone_middle[z].end());
    for (int i = 0; i < 3; ++i) {
        place.share[i] = share[i] * (2 * share[i] - 1);
        place.share.push_back(4 * share[i] * share[(i + 1) % 3]);
    }
    return place;
}

Recorder::Recorder(const Scene& scene, const Blocks& blocks, const Mesh& mesh)
{
    Vector2d low = mesh.gridpoint[0], high = low;
    for (const Vector2d& p : mesh.gridpoint) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    // A point on a slanting face is, in doubles, a little off it. Cutting moves faces, too; by up to 1.3 shortest
    // edges in the shiplock's networks.
    const double size = (high - low).norm();
    const double reach = std::max(1e-6 * size, 2 * scene.cutting.shortest_edge);

    for (const MonitoringPoint& point : scene.points) {
        const std::optional<Index> stage = stage_about(point.at, 1e-6 * size, scene);
        std::optional<Place> found = stage ? find(point.at, reach, stage, blocks, mesh) : std::nullopt;
        if (!found)
            found = find(point.at, reach, {}, blocks, mesh);
        if (!found)
            throw input_error(named_place("point", point.name, point.at) +
                              " is not in the rock; it must lie in the section or on its outline");
        point_.push_back(*found);
        point_name_.push_back(point.name);
        point_position_.push_back(point.at);
        first_reading_.push_back(point.first_reading);
    }
    for (const Gauge& gauge : scene.gauges) {
        Index nearest = -1;
        double distance = std::numeric_limits<double>::infinity();
        for (std::size_t c = 0; c < mesh.contact_edge.size(); ++c) {
            const double d = (mesh.gridpoint[mesh.contact_gridpoint[c][1]] - gauge.at).norm();
            if (d < distance) {
                distance = d;
                nearest = static_cast<Index>(c);
            }
        }
        if (nearest < 0)
            throw input_error(named_place("gauge", gauge.name, gauge.at) + ": the section has no joint");
        gauge_name_.push_back(gauge.name);
        gauge_contact_.push_back(nearest);
    }
}

std::optional<Recorder::Place> Recorder::find(const Vector2d& at, double reach, std::optional<Index> wanted,
                                              const Blocks& blocks, const Mesh& mesh)
{
    const auto twice = [](const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
    std::optional<Place> best;
    double best_outside = 0;
    Index best_stage = -1;
    for (std::size_t z = 0; z < mesh.zone_gridpoint.size(); ++z) {
        const Index stage = blocks.block_stage[mesh.zone_block[z]];
        if (wanted && stage != *wanted)
            continue;
        const auto& corners = mesh.zone_gridpoint[z];
        std::array<Vector2d, 3> p;
        for (int i = 0; i < 3; ++i)
            p[i] = mesh.gridpoint[corners[i]];
        const double area = twice(p[1] - p[0], p[2] - p[0]);
        std::array<double, 3> share{};
        double outside = 0; // how far the point is outside [m]
        for (int i = 0; i < 3; ++i) {
            const Vector2d &a = p[(i + 1) % 3], &b = p[(i + 2) % 3];
            share[i] = twice(b - a, at - a) / area;
            outside = std::max(outside, -share[i] * area / (b - a).norm());
        }
        if (outside > reach)
            continue;
        if (!best || stays_longer(stage, best_stage) || (stage == best_stage && outside < best_outside)) {
            best = place_in_zone(mesh, z, share);
            best_outside = outside;
            best_stage = stage;
        }
    }
    return best;
}

bool Recorder::is_present(const Place& place, const Assembly& assembly)
{
    return assembly.zones.is_present[assembly.zones.first_point_of(place.zone)] != 0;
}

void Recorder::append(std::vector<Vector2d>& rows, const std::vector<Vector2d>& before,
                      const std::vector<Vector2d>& of_gridpoints, const Assembly& assembly) const
{
    // Where it starts is settled first: `rows` and `before` may be one.
    const std::size_t last_row = before.size() - std::min(before.size(), point_.size());
    for (std::size_t p = 0; p < point_.size(); ++p) {
        const Place& place = point_[p];
        Vector2d u = Vector2d::Zero();
        if (is_present(place, assembly))
            for (std::size_t i = 0; i < place.share.size(); ++i)
                u += place.share[i] * of_gridpoints[place.gridpoint[i]];
        else if (last_row + p < before.size())
            u = before[last_row + p];
        rows.push_back(u);
    }
}

void Recorder::begin(Result& result) const
{
    result.history.point = point_name_;
    result.history.point_position = point_position_;
    result.history.first_reading_row.assign(point_.size(), -1);
}

void Recorder::record_history(Result& result, double time, const std::string& event,
                              const Assembly& assembly) const
{
    History& history = result.history;
    if (history.time.empty())
        history.first_reading_row.assign(point_.size(), 0);
    for (const Place& place : point_)
        history.present.push_back(is_present(place, assembly) ? 1 : 0);
    append(history.displacement, history.displacement, assembly.displacement, assembly);
    history.time.push_back(time / unit::day);
    history.event.push_back(event);
    history.reset_row.push_back(history.reset_row.empty() ? 0 : history.reset_row.back());
}

void Recorder::reset(Result& result)
{
    result.history.reset_row.back() = static_cast<Index>(result.history.time.size()) - 1;
    result.states.reset_state.back() = static_cast<Index>(result.states.time.size()) - 1;
}

void Recorder::start_readings(Result& result, double time) const
{
    for (std::size_t p = 0; p < point_.size(); ++p)
        if (first_reading_[p] == time)
            result.history.first_reading_row[p] = static_cast<Index>(result.history.time.size()) - 1;
}

void Recorder::record_state(Result& result, double time, const std::string& event,
                            const Assembly& assembly) const
{
    States& states = result.states;
    states.time.push_back(time / unit::day);
    states.event.push_back(event);
    for (std::size_t g = 0; g < assembly.position.size(); ++g) {
        states.displacement.push_back(assembly.displacement[g]);
        // Also of rock that is gone, which nothing pulls.
        states.reaction.emplace_back(
            is_on_rollers(assembly, g)
                ? Vector2d(free_part(assembly, g, assembly.force[g]) - assembly.force[g])
                : Vector2d((assembly.is_free[g].array() > 0).select(0, -assembly.force[g])));
    }
    mechanics::record_state(assembly, states);
    states.reset_state.push_back(states.reset_state.empty() ? 0 : states.reset_state.back());
}

void Recorder::record_equilibrium(Result& result, double time, const Convergence& convergence,
                                  const Effort& effort) const
{
    result.equilibria.time.push_back(time / unit::day);
    result.equilibria.is_implicit.push_back(convergence.is_implicit ? 1 : 0);
    result.equilibria.searches.push_back(effort.searches);
    result.equilibria.steps.push_back(effort.steps);
    result.equilibria.factorisations.push_back(effort.factorisations);
    result.equilibria.solves.push_back(effort.solves);
    result.equilibria.unbalanced_force_ratio.push_back(convergence.unbalanced_force_ratio);
    result.equilibria.contact_force_change.push_back(convergence.contact_force_change);
    result.equilibria.remaining_displacement.push_back(convergence.remaining_displacement);
    result.equilibria.work_of_loads.push_back(convergence.work_of_loads);
    result.equilibria.stored_energy.push_back(convergence.stored);
    result.equilibria.dissipated_energy.push_back(convergence.dissipated);
    result.equilibria.damped_energy.push_back(convergence.damped);
}

void Recorder::record_step(Result& result, double time, double solver_time, const Assembly& assembly) const
{
    StepHistory& step_history = result.step_history;
    step_history.gauge = gauge_name_;
    step_history.gauge_contact = gauge_contact_;
    step_history.time.push_back(time / unit::day);
    step_history.solver_time.push_back(solver_time);
    append(step_history.displacement, result.history.displacement, assembly.displacement, assembly);
    for (const Index c : gauge_contact_)
        step_history.traction.push_back(assembly.contacts.traction[c]);
}

} // namespace jointcreep::mechanics
