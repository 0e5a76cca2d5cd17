// Fates of joints: what becomes of each joint's line when the section is cut. Inside libs/blocks only.

#pragma once

#include "model/grouped.hpp"
#include "model/network.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace jointcreep::blocks
{

// The fate of a piece of a joint's line. Where pieces overlap, because merging has moved them, the first named
// counts.
enum class Fate : Index { kept, shared, on_outline, dangling_end, outside };

// Collects pieces of joints with their fates. What no piece covers in the end has merged away.
class FateRecord
{
public:
    explicit FateRecord(const Joints& joints) : joints_(joints) {}

    // A piece between two places near the line of a joint.
    void add(Index joint, Fate fate, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

    // The joint is extended beyond an end. The extension counts as overlap for other joints only.
    void extend(Index joint);

    // Lengths by joint; a length up to `tolerance` [m] does not make a joint's fate.
    JointFates table(double tolerance) const;

private:
    struct Piece {
        Index joint;
        Fate fate;
        double low, high; // along the joint from its first end [m]
    };
    static constexpr std::size_t fates = 5;
    struct Lengths {
        std::array<double, fates> by_fate{};
        double covered = 0, extended = 0; // by any of them; beyond the joint's ends [m]
    };
    static Lengths lengths_of(std::span<const Piece> pieces, double length);
    const Joints& joints_;
    std::vector<Piece> pieces_;
    std::vector<char> is_extended_; // by joint; empty if none is
};

// The joint traces of each joint, in order along it.
class TracesAlong
{
public:
    explicit TracesAlong(const Joints& joints);

    // Where a joint has been extended beyond an end, its traces are taken to stop there. Elsewhere a trace
    // that reaches the joint's end continues with the joint as far as it is drawn, or moved.
    void end_before(Index joint, bool first_end, bool second_end);

    // Fraction of the piece of a joint between two places that is joint trace; `overlap` [m] is how far
    // traces that reach its end continue.
    double fraction(Index joint, const Eigen::Vector2d& p, const Eigen::Vector2d& q, double overlap) const;

private:
    struct Stretch {
        double low, high;   // [m]
        double highest_yet; // of this and all before [m]
    };
    const Joints& joints_;
    Grouped<Stretch> stretches_;            // of each joint
    std::vector<std::array<bool, 2>> ends_; // of each joint; empty if none does
};

} // namespace jointcreep::blocks
