// Records the monitoring points, states of the whole section, and steps of the solver.

#pragma once

#include "mechanics/assembly.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace jointcreep::mechanics
{

class Recorder
{
public:
    // Finds every monitoring point's zone, in the rock that the scene has there: on a border, that which is removed
    // last. Cutting moves corners, and a point stays on its rock. The nearest contact to every gauge. Throws
    // input_error for a point outside the rock, and a gauge where there is no joint.
    Recorder(const Scene& scene, const Blocks& blocks, const Mesh& mesh);

    // Names the monitoring points in a result without rows.
    void begin(Result& result) const;

    // A row of the histories at `time` since start [s]; `event` is the stage it is the first after, or "".
    void record_history(Result& result, double time, const std::string& event,
                        const Assembly& assembly) const;

    // Counts the readings of the points whose date of first reading is `time` from the last recorded row.
    void start_readings(Result& result, double time) const;

    // Counts displacements from the last recorded row and state on.
    static void reset(Result& result);

    // Appends a row of values at the monitoring points, from values of gridpoints. A removed point keeps its value
    // of the row before.
    void append_at_points(std::vector<Vector2d>& rows, const std::vector<Vector2d>& of_gridpoints,
                          const Assembly& assembly) const
    {
        append(rows, rows, of_gridpoints, assembly);
    }

    void record_state(Result& result, double time, const std::string& event, const Assembly& assembly) const;

    void record_equilibrium(Result& result, double time, const Convergence& convergence,
                            const Effort& effort) const;

    void record_step(Result& result, double time, double solver_time, const Assembly& assembly) const;

private:
    struct Place {
        std::vector<Index> gridpoint;
        std::vector<double> share; // what the shape functions of these are there
        Index zone;
    };
    // The shares of a zone's corners are those of its area.
    static Place place_in_zone(const Mesh& mesh, std::size_t zone, const std::array<double, 3>& share);
    static bool is_present(const Place& place, const Assembly& assembly);
    // The zone that holds a place, or is nearest to it within `reach` [m], of the rock that `stage` removes. Without
    // a stage, of all rock, the zone that stays longest.
    static std::optional<Place> find(const Vector2d& at, double reach, std::optional<Index> stage,
                                     const Blocks& blocks, const Mesh& mesh);
    // A row of values at the points; a removed point keeps what the last row of `before` has.
    void append(std::vector<Vector2d>& rows, const std::vector<Vector2d>& before,
                const std::vector<Vector2d>& of_gridpoints, const Assembly& assembly) const;

    std::vector<Place> point_;
    std::vector<double> first_reading_;
    std::vector<std::string> point_name_;
    std::vector<Vector2d> point_position_;
    std::vector<std::string> gauge_name_;
    std::vector<Index> gauge_contact_;
};

} // namespace jointcreep::mechanics
