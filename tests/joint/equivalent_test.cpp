#include "joint/equivalent.hpp"

#include "joint/bridged.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace equivalent_test
{

using namespace jointcreep;
using namespace jointcreep::joint;
using namespace jointcreep::unit;

namespace
{

constexpr Strength open_joint{.1 * MPa, 30 * deg, 0, 4 * deg};
constexpr Strength rock{2 * MPa, 50 * deg, 1 * MPa, 12 * deg};

// Two unit squares of two rocks on top of each other, the joint between them the first edge; the second edge
// is the lower one's base, the third its left side, the fourth a bonded one.
struct Section {
    Scene scene;
    Network network;

    explicit Section(double joint_fraction)
    {
        scene.rocks = {{"lower", 2700, 30 * GPa, .2, RockStrength{2 * MPa, 50 * deg, 3 * MPa}},
                       {"upper", 2700, 30 * GPa, .2, RockStrength{4 * MPa, 40 * deg, 1 * MPa}}};
        scene.joint_materials = {
            {"smooth", 1e9, 2e8, 0, 20 * deg, 0, {}},
            {"rough", 6.9e8, 2.8e8, .1 * MPa, 30 * deg, .05 * MPa, {Kelvin{1e9, 2e15, 3e8, 4e15}}}};
        scene.boundaries = {{{0, 0}, {1, 0}, false, false, "smooth"}, {{0, 0}, {0, 1}, true, false, ""}};

        // Not in the scene's order, which may not matter.
        network.names = {{"upper", "lower"}, {"rough", "smooth"}, {"bedding"}, {}};
        network.joints = {{0}, {7}, {0}, {{-1, 1}}, {{2, 1}}, {}, {}, {}};
        Blocks& blocks = network.blocks;
        blocks.vertex = {{0, 1}, {1, 1}, {0, 0}, {1, 0}};
        blocks.edge_vertex = {{0, 1}, {2, 3}, {0, 2}, {0, 3}};
        blocks.edge_block = {{0, 1}, {1, -1}, {1, -1}, {1, 1}};
        blocks.edge_kind = {1, 0, 0, 2};
        blocks.edge_joint = {0, -1, -1, -1};
        blocks.edge_joint_fraction = {joint_fraction, 0, 0, 0};
        blocks.edge_boundary = {-1, 0, 1, -1};
        blocks.block_rock = {0, 1};
    }
};

// Level lines of a set through a square of 10 m, 3 m above its base and every 2 m from there, each cut into
// edges at the given places; the third edge list is the persistence by edge. The first line has a block below
// and one above it, of one rock.
struct Lines {
    Scene scene;
    Network network;

    struct Line {
        std::vector<std::array<double, 2>> traces;
        std::vector<double> cuts; // ascending, 0 and 10 among them
    };

    explicit Lines(const std::vector<Line>& lines)
    {
        scene.outline = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
        scene.zone_size = 1;
        scene.rocks = {{"rock", 2700, 30 * GPa, .2, RockStrength{2 * MPa, 50 * deg, 3 * MPa}},
                       {"soft", 2700, 10 * GPa, .2, RockStrength{2 * MPa, 50 * deg, 3 * MPa}}};
        scene.joint_materials = {
            {"rough", 6.9e8, 2.8e8, .1 * MPa, 30 * deg, .05 * MPa, {Kelvin{1e9, 2e15, 3e8, 4e15}}}};
        JointSet set;
        set.name = "bedding";
        set.persistence = .5;
        set.length = ProbabilityLaw{ProbabilityLaw::Kind::constant, 2, 0};
        scene.joint_sets = {set};
        network.names = {{"rock", "soft"}, {"rough"}, {"bedding"}, {}};
        Blocks& blocks = network.blocks;
        blocks.block_rock = {0, 0};
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const auto row = static_cast<Index>(i);
            const double y = 3 + 2.0 * row;
            network.joints.set.push_back(0);
            network.joints.number.push_back(row);
            network.joints.material.push_back(0);
            network.joints.from.emplace_back(-1, y);
            network.joints.to.emplace_back(11, y);
            for (const auto& [from, to] : lines[i].traces) {
                network.joints.trace_joint.push_back(row);
                network.joints.trace_from.emplace_back(from, y);
                network.joints.trace_to.emplace_back(to, y);
            }
            for (std::size_t c = 0; c + 1 < lines[i].cuts.size(); ++c) {
                const double from = lines[i].cuts[c], to = lines[i].cuts[c + 1];
                const auto vertex = static_cast<Index>(blocks.vertex.size());
                blocks.vertex.emplace_back(from, y);
                blocks.vertex.emplace_back(to, y);
                blocks.edge_vertex.push_back({vertex, vertex + 1});
                blocks.edge_block.push_back({0, 1});
                blocks.edge_kind.push_back(1);
                blocks.edge_joint.push_back(row);
                blocks.edge_boundary.push_back(-1);
                double open = 0;
                for (const auto& [low, high] : lines[i].traces)
                    open += std::max(0.0, std::min(high, to) - std::max(low, from));
                blocks.edge_joint_fraction.push_back(std::min(1.0, open / (to - from)));
            }
        }
        blocks.block_area = {30, 70};
        blocks.block_ring = {0, 1, 2};
        blocks.ring_start = {0, 4, 8};
        for (const double base : {0, 3})
            for (const Eigen::Vector2d& corner :
                 {Eigen::Vector2d(0, base), Eigen::Vector2d(10, base),
                  Eigen::Vector2d(10, base == 0 ? 3 : 10), Eigen::Vector2d(0, base == 0 ? 3 : 10)}) {
                blocks.ring_vertex.push_back(static_cast<Index>(blocks.vertex.size()));
                blocks.vertex.push_back(corner);
            }
    }

    EquivalentJoints averaged(AverageOver over, StiffnessRule stiffness = StiffnessRule::joint)
    {
        scene.averaging = {over, stiffness};
        return average_strength(scene, network);
    }
};

// A first line of edges all joint, half, and all bridge; a second one with 3 m of joint in one edge.
Lines two_lines()
{
    return Lines({{{{0, 4}, {6, 7}}, {0, 4, 8, 10}}, {{{5, 8}}, {0, 10}}});
}

void expect_near(const std::vector<double>& found, const std::vector<double>& wanted)
{
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i)
        EXPECT_NEAR(found[i], wanted[i], 1e-12) << i;
}

std::string refusal(const Section& section)
{
    try {
        average_strength(section.scene, section.network);
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

} // namespace

// By hand: an edge within each of two rocks, one on their border, on a set that has a softer material in one.
TEST(equivalent, a_set_has_another_material_in_another_rock)
{
    Lines lines({{{{0, 10}}, {0, 4, 8, 10}}});
    lines.scene.joint_materials = {{"rough", 6e8, 2e8, .1 * MPa, 30 * deg, 0, {Kelvin{1e9, 2e15, 3e8, 4e15}}},
                                   {"clay", 1e8, 5e7, 0, 20 * deg, 0, {}}};
    lines.network.names.joint_material = {"rough", "clay"};
    lines.scene.joint_sets[0].material_in = {{"soft", "clay"}};
    lines.network.blocks.block_rock = {0, 1};
    lines.network.blocks.edge_block = {{0, 0}, {1, 1}, {0, 1}};
    const EquivalentJoints joints = lines.averaged(AverageOver::edge);
    expect_near(joints.normal_stiffness, {6e8, 1e8, 1e8});
    expect_near(joints.shear_stiffness, {2e8, 5e7, 5e7});
    expect_near(joints.cohesion, {.1 * MPa, 0, 0});
    expect_near(joints.friction_angle, {30 * deg, 20 * deg, 20 * deg});
    expect_near(joints.normal_kelvin_stiffness, {1e9, 0, 0});

    lines.scene.joint_materials[1].normal_stiffness = 7e8;
    expect_near(lines.averaged(AverageOver::edge).normal_stiffness, {6e8, 7e8, 6e8});
}

TEST(Average, IsTheJointAtPersistence1AndTheRockAt0)
{
    const Strength whole = average(open_joint, rock, 1), none = average(open_joint, rock, 0);
    EXPECT_DOUBLE_EQ(whole.cohesion, open_joint.cohesion);
    EXPECT_DOUBLE_EQ(whole.friction_angle, open_joint.friction_angle);
    EXPECT_DOUBLE_EQ(whole.tensile_strength, open_joint.tensile_strength);
    EXPECT_DOUBLE_EQ(none.cohesion, rock.cohesion);
    EXPECT_DOUBLE_EQ(none.friction_angle, rock.friction_angle);
    EXPECT_DOUBLE_EQ(none.tensile_strength, rock.tensile_strength);
}

TEST(Average, IsWhatAHandFinds)
{
    // k = 0.25: c = .025 + 1.5, T = .75 MPa, tan(phi) = .25 * .577350 + .75 * 1.191754 = 1.038153
    const Strength quarter = average(open_joint, rock, .25);
    EXPECT_NEAR(quarter.cohesion, 1.525 * MPa, 1e-6);
    EXPECT_NEAR(std::tan(quarter.friction_angle), 1.038153, 1e-6);
    EXPECT_NEAR(quarter.tensile_strength, .75 * MPa, 1e-6);
    // tan(psi) = .25 tan(4) + .75 tan(12) = .25 * .069927 + .75 * .212557 = .176899
    EXPECT_NEAR(std::tan(quarter.dilation_angle), .176899, 1e-6);
}

// The bridges' cohesion goes, and friction is the joint's; but never more than before.
TEST(AverageStrength, LeavesTheJointsResidualStrength)
{
    Section section(.25);
    const EquivalentJoints without = average_strength(section.scene, section.network);
    EXPECT_TRUE(without.law.empty() || without.law[0] == 0);
    for (const auto& [name, values] : without.own)
        EXPECT_EQ(values.empty() ? 0 : values[0], 0) << name;
    section.scene.joint_materials[1].law = 1; // residual strength
    section.scene.joint_materials[1].own = {{"residual_cohesion", .04 * MPa},
                                            {"residual_friction_angle", 20 * deg}};
    EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_EQ(joints.law[0], 1);
    EXPECT_DOUBLE_EQ(joints.own["residual_cohesion"][0], .01 * MPa);
    EXPECT_DOUBLE_EQ(joints.own["residual_friction_angle"][0], 20 * deg);
    EXPECT_EQ(joints.cohesion[0], without.cohesion[0]);
    EXPECT_EQ(joints.friction_angle[0], without.friction_angle[0]);
    for (Rock& rock : section.scene.rocks)
        rock.strength->friction_angle = 5 * deg;
    EquivalentJoints weaker = average_strength(section.scene, section.network);
    EXPECT_LT(weaker.friction_angle[0], 20 * deg);
    EXPECT_EQ(weaker.own["residual_friction_angle"][0], weaker.friction_angle[0]);
}

TEST(Average, FallsWithPersistenceUnderAWeakerJoint)
{
    Strength last = average(open_joint, rock, 0);
    for (int i = 1; i <= 100; ++i) {
        const Strength next = average(open_joint, rock, i / 100.0);
        EXPECT_LT(next.cohesion, last.cohesion);
        EXPECT_LT(next.friction_angle, last.friction_angle);
        EXPECT_LT(next.tensile_strength, last.tensile_strength);
        last = next;
    }
}

TEST(AverageStrength, TakesTheWeakerRockInEachStrengthByItself)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_NEAR(joints.cohesion[0], (.4 * .1 + .6 * 2) * MPa, 1e-6);          // of the lower rock
    EXPECT_NEAR(joints.tensile_strength[0], (.4 * .05 + .6 * 1) * MPa, 1e-6); // of the upper
    EXPECT_NEAR(std::tan(joints.friction_angle[0]), .4 * std::tan(30 * deg) + .6 * std::tan(40 * deg), 1e-12);
}

// Also where it is only the bridges that dilate; where nothing does, there is no end.
TEST(AverageStrength, DilatesAsFarAsTheJointItself)
{
    for (const double of_rock : {0.0, 5 * deg}) {
        Section section(.4);
        for (Rock& one : section.scene.rocks)
            one.dilation_angle = of_rock;
        section.scene.joint_materials[1].dilation_until = .03;
        const EquivalentJoints joints = average_strength(section.scene, section.network);
        EXPECT_NEAR(std::tan(joints.dilation_angle[0]), .6 * std::tan(of_rock), 1e-12);
        EXPECT_EQ(joints.dilation_until[0], of_rock > 0 ? .03 : 0);
    }
}

TEST(AverageStrength, LeavesStiffnessAndCreepTheJointsOwn)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_EQ(joints.normal_stiffness[0], 6.9e8);
    EXPECT_EQ(joints.shear_stiffness[0], 2.8e8);
    EXPECT_EQ(joints.normal_kelvin_stiffness[0], 1e9);
    EXPECT_EQ(joints.normal_kelvin_viscosity[0], 2e15);
    EXPECT_EQ(joints.shear_kelvin_stiffness[0], 3e8);
    EXPECT_EQ(joints.shear_kelvin_viscosity[0], 4e15);
}

TEST(AverageStrength, HasARowOfKelvinUnitsAnEdgeAsLongAsTheLongestChain)
{
    Section section(.4);
    section.scene.joint_materials[0].maxwell = Maxwell{7e17, 8e17};
    section.scene.joint_materials[1].kelvin.push_back({5e9, 6e15, 7e9, 8e15});
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_EQ(joints.kelvin_units(), 2u);
    EXPECT_EQ(joints.normal_kelvin_stiffness, (std::vector<double>{1e9, 5e9, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(joints.shear_kelvin_viscosity, (std::vector<double>{4e15, 8e15, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(joints.normal_maxwell_viscosity, (std::vector<double>{0, 7e17, 0, 0}));
    EXPECT_EQ(joints.shear_maxwell_viscosity, (std::vector<double>{0, 8e17, 0, 0}));
}

TEST(AverageStrength, HasNoKelvinUnitsWhereNothingCreeps)
{
    Section section(.4);
    section.scene.joint_materials[1].kelvin.clear();
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_EQ(joints.kelvin_units(), 0u);
    EXPECT_TRUE(joints.normal_kelvin_stiffness.empty());
}

TEST(AverageStrength, TakesTheJointOfABoundaryWhole)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_EQ(joints.normal_stiffness[1], 1e9);
    EXPECT_EQ(joints.shear_stiffness[1], 2e8);
    EXPECT_EQ(joints.cohesion[1], 0);
    EXPECT_EQ(joints.friction_angle[1], 20 * deg);
    EXPECT_EQ(joints.normal_kelvin_stiffness[1], 0); // the material does not creep
    EXPECT_EQ(joints.normal_kelvin_viscosity[1], 0);
}

TEST(AverageStrength, IsZeroWithoutAJoint)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    for (const auto& column :
         {joints.normal_stiffness, joints.shear_stiffness, joints.cohesion, joints.friction_angle,
          joints.tensile_strength, joints.dilation_angle, joints.dilation_until,
          joints.normal_kelvin_stiffness, joints.shear_kelvin_stiffness, joints.normal_kelvin_viscosity,
          joints.shear_kelvin_viscosity, joints.normal_maxwell_viscosity, joints.shear_maxwell_viscosity}) {
        ASSERT_EQ(column.size(), 4);
        EXPECT_EQ(column[2], 0);
        EXPECT_EQ(column[3], 0);
    }
}

TEST(AverageStrength, NeedsTheRocksStrengthOnlyWhereThereAreBridges)
{
    for (const double fraction : {1.0, 1 - 1e-12, 1 + 1e-12}) {
        Section whole(fraction);
        for (Rock& each : whole.scene.rocks)
            each.strength.reset();
        const EquivalentJoints joints = average_strength(whole.scene, whole.network);
        EXPECT_EQ(joints.cohesion[0], .1 * MPa);
        EXPECT_EQ(joints.friction_angle[0], 30 * deg);
    }

    Section bridged(.75);
    bridged.scene.rocks[1].strength.reset();
    const std::string message = refusal(bridged);
    for (const char* part : {"\"upper\"", "\"bedding\"", "0.25", "[0, 1] to [1, 1] m"})
        EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(AverageStrength, RefusesWhatIsNotInTheScene)
{
    Section section(.5);
    section.network.names.joint_material[0] = "unknown";
    EXPECT_NE(refusal(section).find("joint material \"unknown\""), std::string::npos);
    for (const double fraction : {-.1, 1.1, std::nan("")})
        EXPECT_NE(refusal(Section(fraction)).find("edge_joint_fraction"), std::string::npos);
}

TEST(AverageStrength, TakesThePersistenceOfEdgeLineOrSet)
{
    Lines lines = two_lines();
    EXPECT_EQ(lines.averaged(AverageOver::edge).persistence, (std::vector<double>{1, .25, 0, .3}));
    const EquivalentJoints by_line = lines.averaged(AverageOver::line);
    expect_near(by_line.persistence, {.5, .5, .5, .3});
    EXPECT_NEAR(by_line.cohesion[2], (.5 * .1 + .5 * 2) * MPa, 1e-6);
    EXPECT_NEAR(by_line.tensile_strength[3], (.3 * .05 + .7 * 3) * MPa, 1e-6);
    expect_near(lines.averaged(AverageOver::set).persistence, {.4, .4, .4, .4});
}

TEST(AverageStrength, TakesForRockWhereAJointWasCarriedOn)
{
    // The first joint is 6 m long and carried on by 4: its edges lie wholly, half and not at all on it.
    Lines lines({{{{0, 4}}, {0, 4, 8, 10}}, {{{5, 8}}, {0, 10}}});
    lines.network.joints.from[0].x() = 0;
    lines.network.joints.to[0].x() = 6;
    lines.network.blocks.fates.extended = {4, 0};
    expect_near(lines.averaged(AverageOver::edge).persistence, {1, 0, 0, .3});
    const EquivalentJoints by_line = lines.averaged(AverageOver::line);
    expect_near(by_line.persistence, {4. / 6, 2. / 6, 0, .3});
    EXPECT_NEAR(by_line.cohesion[1], (2. / 6 * .1 + 4. / 6 * 2) * MPa, 1e-6);
    EXPECT_NEAR(by_line.cohesion[2], 2 * MPa, 1e-6);
    expect_near(lines.averaged(AverageOver::set).persistence, {7. / 16, 3.5 / 16, 0, 7. / 16});
    std::swap(lines.network.joints.from[0], lines.network.joints.to[0]);
    expect_near(lines.averaged(AverageOver::line).persistence, {4. / 6, 2. / 6, 0, .3});

    // At an end that was not carried on merging moves the edge, and takes the trace along.
    lines.network.joints.to[0].x() = .1;
    EXPECT_NEAR(lines.averaged(AverageOver::line).persistence[0], 3.9 / 5.9, 1e-12);
    lines.network.blocks.fates.extended = {0, 0};
    EXPECT_NEAR(lines.averaged(AverageOver::line).persistence[2], 3.9 / 5.9, 1e-12);

    // All joint between its ends: over lines and edges alike.
    Lines whole({{{{0, 6}}, {0, 4, 8, 10}}});
    whole.network.joints.from[0].x() = 0;
    whole.network.joints.to[0].x() = 6;
    whole.network.blocks.fates.extended = {4};
    for (const AverageOver over : {AverageOver::edge, AverageOver::line, AverageOver::set})
        expect_near(whole.averaged(over).persistence, {1, .5, 0});
}

TEST(AverageStrength, LeavesOutWhatOfALineIsInAHole)
{
    Lines lines = two_lines();
    lines.scene.holes = {{{4, 1}, {6, 1}, {6, 9}, {4, 9}}};
    const EquivalentJoints joints = lines.averaged(AverageOver::line);
    expect_near(joints.persistence, {5. / 8, 5. / 8, 5. / 8, 2. / 8});
    EXPECT_NEAR(joints.sets.line_length[0], 16, 1e-9);
}

TEST(AverageStrength, WantsNoBridgesOfSegmentsAndDiscs)
{
    Lines lines = two_lines();
    for (const SetKind kind : {SetKind::segments, SetKind::discs}) {
        lines.scene.joint_sets[0].kind = kind;
        lines.scene.joint_sets[0].persistence = 0; // of lines alone
        const SetAverages sets = lines.averaged(AverageOver::edge).sets;
        EXPECT_EQ(sets.target_persistence[0], 1);
        EXPECT_EQ(sets.persistence_error[0], 0);
    }
}

TEST(AverageStrength, SpacesStaggeredLinesByTheBlocksWhereTheSetMayBe)
{
    // The fourth edge, of 10 m by 20 m of lines, k = .4, L = 3.25 m; stiffness of the spacing area / 20 m.
    const auto expect_area = [](Lines& lines, double area) {
        const EquivalentJoints joints = lines.averaged(AverageOver::set, StiffnessRule::staggered);
        const Bridging wanted = bridging(StiffnessRule::staggered, {.4, 3.25, area / 20, 30 * GPa / .96},
                                         6.9e8, Direction::normal);
        EXPECT_NEAR(joints.normal_stiffness[3] / (wanted.bridges + wanted.share * 6.9e8), 1, 1e-9) << area;
    };
    Lines lines = two_lines();
    expect_area(lines, 100);
    lines.scene.outline = {{0, 0}, {10, 0}, {10, 20}, {0, 20}}; // with a hole: blocks are where they were
    lines.scene.holes = {{{1, 11}, {9, 11}, {9, 19}, {1, 19}}};
    expect_area(lines, 100);
    JointSet& set = lines.scene.joint_sets[0];
    set.region = {{-50, -50}, {60, -50}, {60, 4}, {-50, 4}}; // goes past the section; the upper block's
    expect_area(lines, 30);                                  // centroid is above it
    set.region = {{-50, 2}, {60, 2}, {60, 50}, {-50, 50}};
    expect_area(lines, 70);
    set.region = {{0, 2}, {10, 2}, {10, 6}, {0, 6}}; // without a block's centroid
    expect_area(lines, 40);
    set.region.reset();
    lines.scene.rocks[1].youngs_modulus = 30 * GPa;
    lines.network.blocks.block_rock = {0, 1};
    set.rocks = {"soft"};
    expect_area(lines, 70);
    set.rocks = {"rock"};
    expect_area(lines, 30);
    set.rocks = {"soft", "rock"};
    expect_area(lines, 100);
    set.rocks = {"eroded"}; // without a block
    expect_area(lines, 100);
}

TEST(AverageStrength, ReportsASetBesideJointAndBridges)
{
    Lines lines = two_lines();
    const SetAverages sets = lines.averaged(AverageOver::set, StiffnessRule::lower_bound).sets;
    EXPECT_EQ(sets.target_persistence[0], .5);
    EXPECT_NEAR(sets.line_persistence[0], .4, 1e-12);
    EXPECT_NEAR(sets.edge_persistence[0], .4, 1e-12);
    // Constant traces of 2 m, bridges of 2 m and such a deviation: 4 * 4 / (64 * 20).
    EXPECT_NEAR(sets.persistence_error[0], std::sqrt(16. / (64 * 20)), 1e-12);
    EXPECT_NEAR(sets.line_length[0], 20, 1e-9);
    EXPECT_NEAR(sets.edge_length[0], 20, 1e-12);
    EXPECT_NEAR(sets.joint_cohesion[0], .1 * MPa, 1e-6);
    EXPECT_NEAR(sets.bridge_cohesion[0], 2 * MPa, 1e-6);
    EXPECT_NEAR(sets.cohesion[0], (.4 * .1 + .6 * 2) * MPa, 1e-6);
    EXPECT_NEAR(sets.bridge_friction_angle[0], 50 * deg, 1e-12);
    EXPECT_NEAR(sets.tensile_strength[0], (.4 * .05 + .6 * 3) * MPa, 1e-6);
    EXPECT_EQ(sets.limited_length[0], 0);
    // L = (16 + 1 + 9) / 8, 2 b = L / .4: K_0 = pi E' / (4 2b ln sec(.2 pi)).
    const double k_0 =
        std::numbers::pi * 30 * GPa / .96 / (4 * 3.25 / .4 * -std::log(std::cos(.2 * std::numbers::pi)));
    EXPECT_NEAR(sets.normal_stiffness[0], k_0 + 6.9e8 / .4, 1e-3 * MPa);
    EXPECT_NEAR(sets.shear_stiffness[0], k_0 + 2.8e8 / .4, 1e-3 * MPa);
    EXPECT_NEAR(sets.joint_normal_stiffness[0], 6.9e8, 1);
}

TEST(AverageStrength, TakesTheMeanComplianceOfTwoRocks)
{
    Lines lines = two_lines();
    const double alike =
        lines.averaged(AverageOver::set, StiffnessRule::lower_bound).normal_stiffness[0] - 6.9e8 / .4;
    lines.network.blocks.block_rock = {0, 1}; // 30 and 10 GPa: 15 GPa
    const double both =
        lines.averaged(AverageOver::set, StiffnessRule::lower_bound).normal_stiffness[0] - 6.9e8 / .4;
    EXPECT_NEAR(both / alike, .5, 1e-9);
}

TEST(AverageStrength, LimitsTheStiffnessOfBridgesToThatOfZones)
{
    Lines lines = two_lines();
    for (const StiffnessRule rule :
         {StiffnessRule::lower_bound, StiffnessRule::upper_bound, StiffnessRule::staggered}) {
        const EquivalentJoints joints = lines.averaged(AverageOver::edge, rule);
        const double limit = 10 * 30 * GPa * .8 / (1.2 * .6); // zones of 1 m
        EXPECT_EQ(joints.normal_stiffness[0], 6.9e8);         // all joint
        EXPECT_GT(joints.normal_stiffness[1], 6.9e8 / .25);
        EXPECT_LT(joints.normal_stiffness[1], limit);
        EXPECT_NEAR(joints.normal_stiffness[2], limit, 1); // all bridge
        EXPECT_NEAR(joints.shear_stiffness[2], limit, 1);
        EXPECT_EQ(joints.normal_kelvin_stiffness[2], 0);
        EXPECT_NEAR(joints.sets.limited_length[0], 2, 1e-12);
        EXPECT_EQ(joints.normal_kelvin_stiffness[0], 1e9);
        EXPECT_GT(joints.normal_kelvin_stiffness[1], 1e10); // bridges hold the joint back
        EXPECT_GT(joints.normal_kelvin_viscosity[1], 0);
    }
}

TEST(AverageStrength, MakesAKelvinUnitOfABridgedMaxwellDashpot)
{
    Lines lines = two_lines();
    lines.scene.joint_materials[0].maxwell = Maxwell{7e17, 8e17};
    const EquivalentJoints joints = lines.averaged(AverageOver::edge, StiffnessRule::lower_bound);
    ASSERT_EQ(joints.kelvin_units(), 2u);
    EXPECT_EQ(joints.normal_maxwell_viscosity, (std::vector<double>{7e17, 0, 0, 0}));
    EXPECT_EQ(joints.normal_kelvin_stiffness[1], 0); // of the edge that is all joint
    EXPECT_GT(joints.normal_kelvin_stiffness[3], 0);
}

TEST(AverageStrength, NeedsTheRocksStrengthWhereTheLineHasBridges)
{
    Lines lines = two_lines();
    for (Rock& rock : lines.scene.rocks)
        rock.strength.reset();
    try {
        lines.averaged(AverageOver::line);
        FAIL();
    } catch (const input_error& error) {
        for (const char* part : {"\"rock\"", "\"bedding\"", "0.5", "[0, 3] to [4, 3] m"})
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

// However lines are cut into edges: edges average to their lines, and lines to their set.
RC_GTEST_PROP(AverageStrength, OverEdgesLinesAndSetsAgreeInTheMean, ())
{
    const auto places = [] {
        std::vector<double> all;
        for (int i = *rc::gen::inRange(0, 8); i > 0; --i)
            all.push_back(*rc::gen::inRange(1, 1000) / 100.0);
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    };
    std::vector<Lines::Line> drawn;
    for (int line = 0; line < 3; ++line) {
        Lines::Line one{{}, places()};
        one.cuts.insert(one.cuts.begin(), 0);
        one.cuts.push_back(10);
        const std::vector<double> ends = places();
        for (std::size_t i = 0; i + 1 < ends.size(); i += 2)
            one.traces.push_back({ends[i], ends[i + 1]});
        drawn.push_back(one);
    }
    Lines lines(drawn);
    const EquivalentJoints by_edge = lines.averaged(AverageOver::edge),
                           by_line = lines.averaged(AverageOver::line),
                           by_set = lines.averaged(AverageOver::set);
    const Blocks& blocks = lines.network.blocks;
    for (Index row = 0; row < 3; ++row) {
        Eigen::Vector3d edges = Eigen::Vector3d::Zero(), line = edges;
        for (std::size_t e = 0; e < blocks.edge_joint.size(); ++e)
            if (blocks.edge_joint[e] == row) {
                const double length = (blocks.vertex[2 * e + 1] - blocks.vertex[2 * e]).norm() / 10;
                edges += length * Eigen::Vector3d(by_edge.cohesion[e], std::tan(by_edge.friction_angle[e]),
                                                  by_edge.tensile_strength[e]);
                line = {by_line.cohesion[e], std::tan(by_line.friction_angle[e]),
                        by_line.tensile_strength[e]};
            }
        RC_ASSERT((edges - line).norm() < 1e-9 * line.norm());
    }
    for (const SetAverages* const sets : {&by_edge.sets, &by_line.sets}) {
        RC_ASSERT(std::abs(sets->cohesion[0] - by_set.sets.cohesion[0]) < 1e-9 * by_set.sets.cohesion[0]);
        RC_ASSERT(std::abs(sets->friction_angle[0] - by_set.sets.friction_angle[0]) < 1e-9);
        RC_ASSERT(std::abs(sets->edge_persistence[0] - by_set.sets.line_persistence[0]) < 1e-9);
    }
    RC_ASSERT(std::abs(by_set.persistence[0] - by_set.sets.line_persistence[0]) < 1e-12);
}

} // namespace equivalent_test
