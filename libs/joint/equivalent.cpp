#include "joint/equivalent.hpp"

#include "joint/bridged.hpp"
#include "joint/law.hpp"
#include "joint/pieces.hpp"
#include "model/error.hpp"
#include "model/polygon.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace jointcreep::joint
{

namespace
{

// A persistence is a ratio of sums of lengths: nearer than this to 0 or 1 it counts as 0 or 1.
constexpr double rounding = 1e-9;
constexpr double stiffest = 10; // of a zone's stiffness

template <class Named>
const Named& by_name(const std::vector<Named>& all, const std::string& name, const std::string& kind)
{
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
    if (found == all.end())
        throw input_error("there is no " + kind + " \"" + name + "\" in the scene");
    return *found;
}

Strength strength_of(const JointMaterial& material)
{
    return {material.cohesion, material.friction_angle, material.tensile_strength, material.dilation_angle};
}

Strength weaker(const Strength& one, const Strength& other)
{
    return {std::min(one.cohesion, other.cohesion), std::min(one.friction_angle, other.friction_angle),
            std::min(one.tensile_strength, other.tensile_strength),
            std::min(one.dilation_angle, other.dilation_angle)};
}

std::string place_of(const Blocks& blocks, std::size_t edge)
{
    const Eigen::Vector2d &from = blocks.vertex[blocks.edge_vertex[edge][0]],
                          &to = blocks.vertex[blocks.edge_vertex[edge][1]];
    return "edge " + std::to_string(edge) + " from [" + shown(from.x()) + ", " + shown(from.y()) + "] to [" +
           shown(to.x()) + ", " + shown(to.y()) + "] m";
}

std::string set_name(const Network& network, std::size_t edge)
{
    return network.names.joint_set[network.joints.set[network.blocks.edge_joint[edge]]];
}

// The rocks on an edge's sides.
std::vector<const Rock*> rocks_beside(const Scene& scene, const Network& network, std::size_t edge)
{
    std::vector<const Rock*> rocks;
    for (const Index block : network.blocks.edge_block[edge])
        if (block >= 0)
            rocks.push_back(
                &by_name(scene.rocks, network.names.rock[network.blocks.block_rock[block]], "rock"));
    if (rocks.empty())
        throw input_error(place_of(network.blocks, edge) + " is a joint but has no block on either side");
    return rocks;
}

Strength bridge_strength(const Scene& scene, const Network& network, std::size_t edge, double persistence)
{
    std::optional<Strength> weakest;
    for (const Rock* const beside : rocks_beside(scene, network, edge)) {
        const Rock& rock = *beside;
        if (!rock.strength)
            throw input_error("rock \"" + rock.name + "\" has no strength, but joint set \"" +
                              set_name(network, edge) + "\" leaves bridges of it: " + shown(1 - persistence) +
                              " of " + place_of(network.blocks, edge) +
                              "; it needs a cohesion, a friction angle and a tensile strength");
        const Strength strength{rock.strength->cohesion, rock.strength->friction_angle,
                                rock.strength->tensile_strength, rock.dilation_angle};
        weakest = weakest ? weaker(*weakest, strength) : strength;
    }
    return *weakest;
}

// Input of the averages of an edge.
struct Share {
    double persistence;  // [-]
    double trace_length; // mean by length; 0 without traces [m]
    double spacing;      // of the set's lines [m]
};

double edge_length(const Blocks& blocks, std::size_t edge)
{
    return (blocks.vertex[blocks.edge_vertex[edge][0]] - blocks.vertex[blocks.edge_vertex[edge][1]]).norm();
}

// Of a block's outer ring.
Eigen::Vector2d centroid_of(const Blocks& blocks, std::size_t block)
{
    const Index ring = blocks.block_ring[block];
    const Index begin = blocks.ring_start[ring], end = blocks.ring_start[ring + 1];
    const Eigen::Vector2d origin = blocks.vertex[blocks.ring_vertex[begin]];
    double twice = 0;
    Eigen::Vector2d moment(0, 0);
    for (Index i = begin, j = end - 1; i < end; j = i++) {
        const Eigen::Vector2d a = blocks.vertex[blocks.ring_vertex[j]] - origin,
                              b = blocks.vertex[blocks.ring_vertex[i]] - origin;
        const double turn = cross(a, b);
        twice += turn;
        moment += turn * (a + b) / 3;
    }
    return origin + moment / twice;
}

// Area of the blocks where a set may be [m2]; average_strength() says which they are.
double area_of_set(const Scene& scene, const Network& network, const std::string& name)
{
    const auto found = std::find_if(scene.joint_sets.begin(), scene.joint_sets.end(),
                                    [&](const JointSet& one) { return one.name == name; });
    const Blocks& blocks = network.blocks;
    const auto holds_set = [&](std::size_t block) {
        if (found == scene.joint_sets.end())
            return true;
        if (!found->rocks.empty())
            return std::count(found->rocks.begin(), found->rocks.end(),
                              network.names.rock[blocks.block_rock[block]]) > 0;
        return !found->region || covers(*found->region, centroid_of(blocks, block));
    };
    double all = 0, of_set = 0;
    for (std::size_t block = 0; block < blocks.block_area.size(); ++block) {
        all += blocks.block_area[block];
        if (holds_set(block))
            of_set += blocks.block_area[block];
    }
    if (of_set > 0)
        return of_set;
    return found != scene.joint_sets.end() && found->region ? area_of(*found->region) : all;
}

// Share of an edge between the ends of its joint as sampled [-]. The rest is the extension of the joint.
double share_on_line(const Network& network, std::size_t edge)
{
    const Blocks& blocks = network.blocks;
    const Index joint = blocks.edge_joint[edge];
    if (blocks.fates.extended.empty() || !(blocks.fates.extended[joint] > 0))
        return 1; // merging may have moved the edge past the line's ends
    const Eigen::Vector2d from = network.joints.from[joint], along = network.joints.to[joint] - from;
    const auto place = [&](Index vertex) {
        return (blocks.vertex[vertex] - from).dot(along) / along.squaredNorm();
    };
    const auto [low, high] =
        std::minmax({place(blocks.edge_vertex[edge][0]), place(blocks.edge_vertex[edge][1])});
    if (!(high > low))
        return 1;
    const double on_line = std::max(0.0, std::min(high, 1.0) - std::max(low, 0.0)) / (high - low);
    // Joint trace found by the cutter is on the line, also where merging has moved its other end.
    return std::min(1.0, std::max(on_line, blocks.edge_joint_fraction[edge]));
}

// Sums over the lines of a set, for averages over lines and sets.
class Lines
{
public:
    Lines(const Scene& scene, const Network& network, const Pieces& pieces)
        : over_(scene.averaging.over), network_(network), of_line_(network.joints.set.size()),
          of_set_(network.names.joint_set.size()), area_(of_set_.size())
    {
        for (std::size_t piece = 0; piece < pieces.joint.size(); ++piece) {
            const Index joint = pieces.joint[piece];
            for (Sums* const sums : {&of_line_[joint], &of_set_[network.joints.set[joint]]}) {
                sums->line += pieces.length[piece];
                if (pieces.is_bridge[piece] == 0) {
                    sums->traces += pieces.length[piece];
                    sums->squares += pieces.length[piece] * pieces.length[piece];
                }
            }
        }
        for (std::size_t set = 0; set < of_set_.size(); ++set)
            area_[set] = area_of_set(scene, network, network.names.joint_set[set]);
    }

    double length(std::size_t set) const { return of_set_[set].line; }
    double persistence(std::size_t set) const { return of_set_[set].persistence(); }

    Share share(std::size_t edge) const
    {
        const Index joint = network_.blocks.edge_joint[edge], set = network_.joints.set[joint];
        const Sums &line = of_line_[joint], &all = of_set_[set];
        const double spacing = all.line > 0 ? area_[set] / all.line : 0.0;
        switch (over_) {
        case AverageOver::edge:
            break;
        case AverageOver::line:
            return {line.persistence() * share_on_line(network_, edge), line.trace_length(), spacing};
        case AverageOver::set:
            return {all.persistence() * share_on_line(network_, edge), all.trace_length(), spacing};
        }
        const double fraction = network_.blocks.edge_joint_fraction[edge];
        if (!(fraction >= 0 && fraction <= 1 + rounding))
            throw input_error("edge_joint_fraction is " + shown(fraction) + " on " +
                              place_of(network_.blocks, edge) + "; it must be from 0 to 1");
        return {std::min(1.0, fraction), all.trace_length(), spacing};
    }

private:
    struct Sums {
        double line = 0, traces = 0, squares = 0; // lengths [m], [m], and their squares [m2]

        double persistence() const { return line > 0 ? std::min(1.0, traces / line) : 0.0; }
        double trace_length() const { return traces > 0 ? squares / traces : 0.0; }
    };

    AverageOver over_;
    const Network& network_;
    std::vector<Sums> of_line_, of_set_;
    std::vector<double> area_; // where a set may be [m2]
};

// The springs of edges by a rule; each is computed once.
class Stiffnesses
{
public:
    Stiffnesses(const Scene& scene, const Network& network) : scene_(scene), network_(network) {}

    struct Found {
        std::array<JointChain, 2> chain; // normal, shear
        bool is_limited = false;
    };

    Found of(std::size_t edge, const JointMaterial& material, const Share& share)
    {
        Found found{
            {joint_chain_of(material, Direction::normal), joint_chain_of(material, Direction::shear)}};
        const StiffnessRule rule = scene_.averaging.stiffness;
        if (rule == StiffnessRule::joint || share.persistence >= 1 - rounding)
            return found;
        double compliance = 0, zone = 0;
        const std::vector<const Rock*> rocks = rocks_beside(scene_, network_, edge);
        for (const Rock* const rock : rocks) {
            const double E = rock->youngs_modulus, nu = rock->poissons_ratio;
            compliance += (1 - nu * nu) / E / static_cast<double>(rocks.size());
            zone = std::max(zone, E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / scene_.smallest_zone_size());
        }
        for (const Direction direction : {Direction::normal, Direction::shear}) {
            JointChain& chain = found.chain[direction == Direction::normal ? 0 : 1];
            const double limit = std::max(stiffest * zone, chain.spring);
            if (share.persistence > rounding && share.trace_length > 0) {
                chain = bridged(
                    chain, bridging_of({share.persistence, share.trace_length, share.spacing, 1 / compliance},
                                       chain.spring, direction));
            } else {
                chain = {std::numeric_limits<double>::infinity(), {}, 0};
            }
            if (chain.spring > limit) {
                chain.spring = limit;
                found.is_limited = true;
            }
        }
        return found;
    }

private:
    Bridging bridging_of(const BridgedLine& line, double stiffness, Direction direction)
    {
        const auto [known, is_new] = known_.try_emplace(
            {line.persistence, line.trace_length, line.spacing, line.plane_modulus, stiffness, direction});
        if (is_new)
            known->second = bridging(scene_.averaging.stiffness, line, stiffness, direction);
        return known->second;
    }

    const Scene& scene_;
    const Network& network_;
    std::map<std::tuple<double, double, double, double, double, Direction>, Bridging> known_;
};

EquivalentJoints without_joints(std::size_t edges, std::size_t kelvin_units)
{
    EquivalentJoints joints;
    for (const Parameter& parameter : all_parameters())
        parameter.in(joints).assign(edges, 0.0);
    for (std::vector<double>* const list :
         {&joints.normal_maxwell_viscosity, &joints.shear_maxwell_viscosity, &joints.persistence})
        list->assign(edges, 0.0);
    for (std::vector<double>* const list : {&joints.normal_kelvin_stiffness, &joints.shear_kelvin_stiffness,
                                            &joints.normal_kelvin_viscosity, &joints.shear_kelvin_viscosity})
        list->assign(edges * kelvin_units, 0.0);
    joints.law.assign(edges, 0);
    return joints;
}

// With rock bridges, a Maxwell dashpot becomes a Kelvin unit.
std::size_t most_kelvin_units(const Scene& scene)
{
    std::size_t most = 0;
    for (const JointMaterial& material : scene.joint_materials)
        most = std::max(most,
                        material.kelvin.size() +
                            (material.maxwell && scene.averaging.stiffness != StiffnessRule::joint ? 1 : 0));
    return most;
}

// A parameter of the joint with bridges of the share 1 - k. Means with rock are already in `strength`.
double with_bridges(const Parameter& parameter, double own, const Strength& strength, double k)
{
    switch (parameter.with_bridges) {
    case WithBridges::share:
        return k * own;
    case WithBridges::weaker:
        return std::min(own, strength.friction_angle);
    default:
        return own;
    }
}

void set_joint(EquivalentJoints& joints, std::size_t edge, const Stiffnesses::Found& found,
               const Strength& strength, const JointMaterial& material, double persistence)
{
    const JointChain &normal = found.chain[0], &shear = found.chain[1];
    joints.law[edge] = material.law;
    for (const Parameter& parameter : laws()[static_cast<std::size_t>(material.law)].parameters)
        parameter.in(joints)[edge] = with_bridges(parameter, parameter.of(material), strength, persistence);
    joints.normal_stiffness[edge] = normal.spring;
    joints.shear_stiffness[edge] = shear.spring;
    joints.cohesion[edge] = strength.cohesion;
    joints.friction_angle[edge] = strength.friction_angle;
    joints.tensile_strength[edge] = strength.tensile_strength;
    joints.dilation_angle[edge] = strength.dilation_angle;
    if (!(strength.dilation_angle > 0))
        joints.dilation_until[edge] = 0;
    joints.persistence[edge] = persistence;
    const std::size_t row = edge * joints.kelvin_units();
    for (std::size_t unit = 0; unit < normal.units.size(); ++unit) {
        joints.normal_kelvin_stiffness[row + unit] = normal.units[unit].stiffness;
        joints.normal_kelvin_viscosity[row + unit] = normal.units[unit].viscosity;
    }
    for (std::size_t unit = 0; unit < shear.units.size(); ++unit) {
        joints.shear_kelvin_stiffness[row + unit] = shear.units[unit].stiffness;
        joints.shear_kelvin_viscosity[row + unit] = shear.units[unit].viscosity;
    }
    joints.normal_maxwell_viscosity[edge] = normal.maxwell_viscosity;
    joints.shear_maxwell_viscosity[edge] = shear.maxwell_viscosity;
}

// With bridges, a joint may become one that its law does not allow: a dilation angle above the residual friction angle
// would create energy.
void check(const Network& network, const EquivalentJoints& joints, std::size_t edge)
{
    const LawInfo& law = laws()[static_cast<std::size_t>(joints.law[edge])];
    if (law.own.empty())
        return; // means of joint and rock
    const auto complaint = law.check([&](const Parameter& parameter) { return parameter.of(joints, edge); });
    if (complaint)
        throw input_error("joint set \"" + set_name(network, edge) + "\" on " +
                          place_of(network.blocks, edge) + " would have, with its rock bridges, " +
                          std::string(complaint->parameter.key) + " = " +
                          shown(complaint->parameter.of(joints, edge) / complaint->parameter.unit.in_si) +
                          ": " + complaint->wanted);
}

void refuse_bridges(const Network& network, std::size_t edge, const JointMaterial& material,
                    double persistence)
{
    const LawInfo& law = laws()[static_cast<std::size_t>(material.law)];
    if (std::ranges::any_of(law.parameters,
                            [](const Parameter& one) { return one.with_bridges == WithBridges::refused; }))
        throw input_error("joint set \"" + set_name(network, edge) + "\" leaves rock bridges, " +
                          rounded(1 - persistence) + " of " + place_of(network.blocks, edge) +
                          ", and its joint material \"" + material.name + "\" is one of " +
                          std::string(law.name) +
                          ", which has no average with rock; expected a persistence of 1");
}

// Sums of strengths times lengths.
struct StrengthSum {
    double length = 0, cohesion = 0, tan_phi = 0, tensile_strength = 0, tan_psi = 0;

    void add(double l, const Strength& strength)
    {
        length += l;
        cohesion += l * strength.cohesion;
        tan_phi += l * std::tan(strength.friction_angle);
        tensile_strength += l * strength.tensile_strength;
        tan_psi += l * std::tan(strength.dilation_angle);
    }
    Strength mean() const
    {
        if (length == 0)
            return {0, 0, 0, 0};
        return {cohesion / length, std::atan(tan_phi / length), tensile_strength / length,
                std::atan(tan_psi / length)};
    }
};

// Sums over the edges of a set.
struct SetSum {
    StrengthSum joint, bridge, equivalent;
    double joint_length = 0, limited = 0;                   // [m]
    Eigen::Vector2d stiffness{0, 0}, joint_stiffness{0, 0}; // {normal, shear}, times length [Pa]
};

SetAverages averages_of(const Scene& scene, const Network& network, const Pieces& pieces, const Lines& lines,
                        const std::vector<SetSum>& sums)
{
    SetAverages sets;
    for (std::size_t set = 0; set < sums.size(); ++set) {
        const auto found =
            std::find_if(scene.joint_sets.begin(), scene.joint_sets.end(),
                         [&](const JointSet& one) { return one.name == network.names.joint_set[set]; });
        const bool is_set = found != scene.joint_sets.end();
        const double target = is_set && found->kind == SetKind::lines ? found->persistence : 1.0;
        std::vector<double> line_length;
        for (std::size_t joint = 0; joint < network.joints.set.size(); ++joint)
            if (network.joints.set[joint] == static_cast<Index>(set))
                line_length.push_back(pieces.line_length[joint]);
        sets.target_persistence.push_back(target);
        sets.line_persistence.push_back(lines.persistence(set));
        sets.persistence_error.push_back(is_set && found->length && target > 0 && target < 1
                                             ? persistence_error(*found->length, target, line_length)
                                             : 0.0);
        const SetSum& sum = sums[set];
        const double length = sum.joint.length, per_length = length > 0 ? 1 / length : 0.0;
        sets.edge_persistence.push_back(std::min(1.0, sum.joint_length * per_length));
        sets.line_length.push_back(lines.length(set));
        sets.edge_length.push_back(length);

        const auto add = [](const Strength& strength, auto& cohesion, auto& friction_angle, auto& tension,
                            auto& dilation_angle) {
            cohesion.push_back(strength.cohesion);
            friction_angle.push_back(strength.friction_angle);
            tension.push_back(strength.tensile_strength);
            dilation_angle.push_back(strength.dilation_angle);
        };
        add(sum.joint.mean(), sets.joint_cohesion, sets.joint_friction_angle, sets.joint_tensile_strength,
            sets.joint_dilation_angle);
        add(sum.bridge.mean(), sets.bridge_cohesion, sets.bridge_friction_angle, sets.bridge_tensile_strength,
            sets.bridge_dilation_angle);
        add(sum.equivalent.mean(), sets.cohesion, sets.friction_angle, sets.tensile_strength,
            sets.dilation_angle);
        sets.joint_normal_stiffness.push_back(sum.joint_stiffness.x() * per_length);
        sets.joint_shear_stiffness.push_back(sum.joint_stiffness.y() * per_length);
        sets.normal_stiffness.push_back(sum.stiffness.x() * per_length);
        sets.shear_stiffness.push_back(sum.stiffness.y() * per_length);
        sets.limited_length.push_back(sum.limited);
    }
    return sets;
}

} // namespace

std::string joint_name(const Scene& scene, const Network& network, Index edge)
{
    const Index joint = network.blocks.edge_joint[edge];
    return joint < 0 ? scene.boundaries[network.blocks.edge_boundary[edge]].joint
                     : network.names.joint_set[network.joints.set[joint]];
}

const JointMaterial& material_of(const Scene& scene, const Network& network, std::size_t edge)
{
    const auto material = [&](const std::string& name) -> const JointMaterial& {
        return by_name(scene.joint_materials, name, "joint material");
    };
    const Index joint = network.blocks.edge_joint[edge];
    if (joint < 0)
        return material(scene.boundaries[network.blocks.edge_boundary[edge]].joint);
    const JointMaterial& usual = material(network.names.joint_material[network.joints.material[joint]]);
    const auto set = std::ranges::find(scene.joint_sets, set_name(network, edge), &JointSet::name);
    if (set == scene.joint_sets.end() || set->material_in.empty())
        return usual;
    const JointMaterial* softest = nullptr;
    for (const Rock* const rock : rocks_beside(scene, network, edge)) {
        const auto in = std::ranges::find(set->material_in, rock->name, &MaterialInRock::rock);
        const JointMaterial& here = in == set->material_in.end() ? usual : material(in->material);
        if (!softest || here.normal_stiffness < softest->normal_stiffness)
            softest = &here;
    }
    return *softest;
}

std::vector<Index> materials_of(const Scene& scene, const Network& network)
{
    std::vector<Index> materials(network.blocks.edge_kind.size(), 0);
    for (std::size_t edge = 0; edge < materials.size(); ++edge) {
        const bool is_joint = network.blocks.edge_kind[edge] == static_cast<Index>(EdgeKind::joint);
        const Index boundary = network.blocks.edge_boundary[edge];
        if (is_joint || (boundary >= 0 && !scene.boundaries[boundary].joint.empty()))
            materials[edge] =
                static_cast<Index>(&material_of(scene, network, edge) - scene.joint_materials.data());
    }
    return materials;
}

Strength average(const Strength& joint, const Strength& rock, double persistence)
{
    const double k = persistence;
    Strength mean{k * joint.cohesion + (1 - k) * rock.cohesion,
                  std::atan(k * std::tan(joint.friction_angle) + (1 - k) * std::tan(rock.friction_angle)),
                  k * joint.tensile_strength + (1 - k) * rock.tensile_strength,
                  std::atan(k * std::tan(joint.dilation_angle) + (1 - k) * std::tan(rock.dilation_angle))};
    return mean;
}

EquivalentJoints average_strength(const Scene& scene, const Network& network)
{
    const Blocks& blocks = network.blocks;
    EquivalentJoints joints = without_joints(blocks.edge_kind.size(), most_kelvin_units(scene));
    joints.pieces = pieces_of(network.joints, scene.outline, scene.holes);
    const Lines lines(scene, network, joints.pieces);
    Stiffnesses stiffnesses(scene, network);
    std::vector<SetSum> sums(network.names.joint_set.size());
    for (std::size_t edge = 0; edge < blocks.edge_kind.size(); ++edge) {
        if (blocks.edge_kind[edge] == static_cast<Index>(EdgeKind::joint)) {
            const Index joint = blocks.edge_joint[edge];
            const JointMaterial& material = material_of(scene, network, edge);
            const Share share = lines.share(edge);
            const double length = edge_length(blocks, edge);
            SetSum& sum = sums[network.joints.set[joint]];
            Strength strength = strength_of(material);
            sum.joint.add(length, strength);
            if (share.persistence < 1 - rounding) {
                const Strength rock = bridge_strength(scene, network, edge, share.persistence);
                sum.bridge.add(length, rock);
                strength = average(strength, rock, share.persistence);
            }
            sum.equivalent.add(length, strength);
            const Stiffnesses::Found found = stiffnesses.of(edge, material, share);
            sum.joint_length += length * blocks.edge_joint_fraction[edge];
            sum.joint_stiffness +=
                length * Eigen::Vector2d(material.normal_stiffness, material.shear_stiffness);
            sum.stiffness += length * Eigen::Vector2d(found.chain[0].spring, found.chain[1].spring);
            sum.limited += found.is_limited ? length : 0.0;
            if (share.persistence < 1 - rounding)
                refuse_bridges(network, edge, material, share.persistence);
            set_joint(joints, edge, found, strength, material, share.persistence);
            if (share.persistence < 1 - rounding)
                check(network, joints, edge);
        } else if (blocks.edge_kind[edge] == static_cast<Index>(EdgeKind::boundary) &&
                   blocks.edge_boundary[edge] >= 0) {
            const std::string& name = scene.boundaries[blocks.edge_boundary[edge]].joint;
            if (name.empty())
                continue;
            const JointMaterial& material = material_of(scene, network, edge);
            set_joint(joints, edge, stiffnesses.of(edge, material, {1, 0, 0}), strength_of(material),
                      material, 1);
        }
    }
    joints.sets = averages_of(scene, network, joints.pieces, lines, sums);
    return joints;
}

} // namespace jointcreep::joint
