// Monitoring points: where they are found, and what is held once they are gone.

#include "sections.hpp"

#include "mechanics/excavation.hpp"
#include "mechanics/recorder.hpp"
#include "model/error.hpp"

#include <gtest/gtest.h>

namespace recorder_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using namespace jointcreep::mechanics;

namespace
{

Section benched(std::vector<MonitoringPoint> points)
{
    Scene scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
    scene.zone_size = 1.5;
    scene.stages.push_back({"cut", 100, {{{12, 4}, {21, 4}, {21, 11}, {10, 11}}}});
    scene.points = std::move(points);
    return assembled(std::move(scene), {}, 1e9, 1e9);
}

} // namespace

TEST(recorder, interpolates_within_zones_and_prefers_rock_that_stays)
{
    Section s = benched({{"inside", {3.21, 2.34}, 0}, {"on the bench", {15, 4}, 0}, {"goes", {18, 9}, 0}});
    const Recorder recorder(s.scene, s.network.blocks, s.mesh);
    const auto field = [](const Vector2d& p) { return Vector2d(1e-3 * p.x(), -2e-3 * p.y() + 1e-4 * p.x()); };
    for (std::size_t g = 0; g < s.mesh.gridpoint.size(); ++g)
        s.assembly.displacement[g] = field(s.mesh.gridpoint[g]);
    Result result;
    recorder.record_history(result, 0, "", s.assembly);
    for (int p = 0; p < 3; ++p)
        EXPECT_LT((result.history.displacement[p] - field(s.scene.points[p].at)).norm(), 1e-15);

    excavate(s.assembly, s.network.blocks, s.mesh, Loading(s.scene, s.mesh), 0);
    for (Vector2d& d : s.assembly.displacement)
        d *= 2;
    recorder.record_history(result, 86400, "cut", s.assembly);
    EXPECT_EQ(result.history.time, (std::vector<double>{0, 1}));
    EXPECT_EQ(result.history.present, (std::vector<Index>{1, 1, 1, 1, 1, 0}));
    EXPECT_LT((result.history.displacement[4] - 2 * field({15, 4})).norm(), 1e-15);
    EXPECT_EQ(result.history.displacement[5], result.history.displacement[2]); // held
}

// Cutting moves the corner of the cut into the rock that stays, or out of it: a point that was given for the corner, or
// on either side of the face, stays on its rock.
TEST(recorder, a_point_stays_on_its_rock_where_cutting_moves_a_corner)
{
    for (const Vector2d& move : {Vector2d(-0.09, -0.09), Vector2d(0.09, 0.09)}) {
        Section s =
            benched({{"corner", {12, 4}, 0}, {"below", {12.05, 3.98}, 0}, {"above", {12.05, 4.02}, 0}});
        for (Vector2d& place : s.mesh.gridpoint)
            if ((place - Vector2d(12, 4)).norm() < 1e-9)
                place += move;
        const Recorder recorder(s.scene, s.network.blocks, s.mesh);
        excavate(s.assembly, s.network.blocks, s.mesh, Loading(s.scene, s.mesh), 0);
        Result result;
        recorder.record_history(result, 0, "cut", s.assembly);
        EXPECT_EQ(result.history.present, (std::vector<Index>{1, 1, 0})) << move.transpose();
    }
}

TEST(recorder, readings_count_from_their_first_row)
{
    Section s = benched({{"early", {3, 3}, 0}, {"late", {4, 3}, 172800}});
    const Recorder recorder(s.scene, s.network.blocks, s.mesh);
    Result result;
    for (const double day : {0.0, 1.0, 2.0}) {
        recorder.record_history(result, day * 86400, "", s.assembly);
        recorder.start_readings(result, day * 86400);
    }
    EXPECT_EQ(result.history.first_reading_row, (std::vector<Index>{0, 2}));
}

TEST(recorder, refuses_a_point_outside_the_rock_and_a_gauge_without_joint)
{
    Section s = benched({{"lost", {30, 3}, 0}});
    EXPECT_THROW(Recorder(s.scene, s.network.blocks, s.mesh), input_error);
    s.scene.points.clear();
    s.scene.gauges.push_back({"gauge", {3, 3}});
    EXPECT_THROW(Recorder(s.scene, s.network.blocks, s.mesh), input_error);
}

} // namespace recorder_test
