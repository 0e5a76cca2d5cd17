#include "joint/rising_joint.hpp"
#include "large_displacements/face_contacts.hpp"
#include "large_displacements/face_overlap.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

// Relative displacement of the middle of a closed pair in a step.
joint::Moved moved_in_middle(const FacePair& pair, const Faces& faces, const std::vector<Vector2d>& place,
                             const std::vector<Vector2d>& move)
{
    const auto a = ends_of(faces.gridpoint[pair.a], place), b = ends_of(faces.gridpoint[pair.b], place),
               move_a = ends_of(faces.gridpoint[pair.a], move),
               move_b = ends_of(faces.gridpoint[pair.b], move);
    const auto middle = [](const auto& of_ends, const std::array<double, 2>& fractions) {
        return at(of_ends, (fractions[0] + fractions[1]) / 2);
    };
    const Vector2d parted = middle(move_b, pair.on_b) - middle(move_a, pair.on_a),
                   apart = middle(b, pair.on_b) - middle(a, pair.on_a) - parted;
    const auto turn = [](const auto& ends, const auto& by_ends) {
        const Vector2d face = ends[1] - ends[0], by = by_ends[1] - by_ends[0];
        return (face.x() * by.y() - face.y() * by.x()) / face.squaredNorm();
    };
    // Common rotation is no slip, as for the shear force; there the normal rotates by this.
    const double turned = -apart.dot(pair.normal) * (turn(a, move_a) + turn(b, move_b)) / 2;
    const double lead = at(std::array{pair.creeps[0], pair.creeps[1]}, (pair.on_a[0] + pair.on_a[1]) / 2);
    return {parted.dot(pair.normal) - lead, parted.dot(along(pair.normal)) - turned + pair.creeps[2]};
}

} // namespace

// Raises the joints that dilate, for the slip of this step.
void FaceContacts::dilate(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move)
{
    for (FacePair& pair : pairs_)
        pair.raised = 0;
    double most = 0;
    for (const std::vector<Index>& pairs : joints_) {
        joint::RisingJoint joint;
        const auto part_of = [&](const FacePair& pair) {
            return joint::ClosedPartOfJoint{&laws_[pair.law], pair.state(), pair.length, pair.sigma,
                                            pair.tau};
        };
        for (const Index p : pairs)
            if (pairs_[p].is_closed)
                joint.count(part_of(pairs_[p]));
        for (const Index p : pairs)
            if (const FacePair& pair = pairs_[p]; pair.is_closed)
                joint.add(part_of(pair), [&] { return moved_in_middle(pair, faces_, place, move); });
        const double rise = joint.rise();
        if (rise == 0)
            continue;
        most = std::max(most, rise);
        for (const Index p : pairs) {
            pairs_[p].raised = rise;
            pairs_[p].raise(rise);
        }
    }
    raised_ += most;
}

} // namespace jointcreep::large_displacements
