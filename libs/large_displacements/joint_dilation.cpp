#include "large_displacements/face_contacts.hpp"
#include "large_displacements/face_overlap.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

// A pair that slips, or may slip, if its joint rises by x.
struct Sheared {
    double share;          // F tan(psi), for the work [N/m]
    double trial, carries; // shear force without slip, and strength, at x = 0 [N/m]
    double rises, shears;  // strength over x, shear force over slip [Pa]
};

// The pairs of one joint.
struct Dilating {
    std::vector<Sheared> sheared;
    double pressed = 0; // sum of F [N/m]
    double left = 0;    // dilation left until asperities are sheared off [m]

    // sum of F tan(psi) slip(x) over sum of F [m], and the rate at which it falls [-].
    std::array<double, 2> raising(double x) const
    {
        std::array<double, 2> sum{0, 0};
        for (const Sheared& one : sheared) {
            const double excess = one.trial - one.carries - one.rises * x;
            sum[0] += one.share / pressed * std::clamp(excess, 0.0, one.trial) / one.shears;
            if (excess > 0 && excess < one.trial)
                sum[1] += one.share / pressed * one.rises / one.shears;
        }
        return sum;
    }

    // The x that equals it [m].
    double rise() const
    {
        double low = 0, high = sheared.empty() ? 0.0 : raising(0)[0], x = 0;
        if (high == 0)
            return 0;
        for (int i = 0; i < 100; ++i) { // Newton's method; exact once it is on the right straight piece
            const auto [raised, slope] = raising(x);
            (raised > x ? low : high) = x;
            double next = (raised + slope * x) / (1 + slope);
            if (!(next >= low && next <= high))
                next = (low + high) / 2;
            const double change = std::abs(next - x);
            x = next;
            if (change <= 1e-15 * x)
                break;
        }
        return std::min(x, left);
    }
};

// Relative displacement of the middle of a closed pair in a step [m].
struct Moved {
    double opened, slid;
};

Moved moved_in_middle(const FacePair& pair, const Faces& faces, const std::vector<Vector2d>& place,
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
    return {parted.dot(pair.normal), parted.dot(along(pair.normal)) - turned};
}

// `slopes`: of the pair now; `pressed`: its normal force [N/m].
Sheared sheared_by(const Moved& moved, const FacePair& pair, const joint::Law& law,
                   const joint::Slopes& slopes, double pressed)
{
    const double trial = std::abs(pair.tau + slopes.k_s * moved.slid) * pair.length,
                 presses = pressed - slopes.k_n * pair.length * moved.opened;
    const auto strength = [&](const joint::Slopes& now) {
        return now.cohesion * pair.length + presses * now.tan_phi;
    };
    joint::Slopes now = slopes;
    if (!pair.is_broken && joint::weakens_by_slip(law) && trial > std::max(0.0, strength(slopes))) {
        joint::State broken = pair.state();
        broken.is_broken = true;
        now = joint::slopes(law, broken, pair.sigma);
    }
    return {pressed * slopes.tan_psi, trial, strength(now), now.tan_phi * slopes.k_n * pair.length,
            slopes.k_s * pair.length};
}

bool wears(const joint::Law& law)
{
    return joint::dilates(law) && joint::remembers(law);
}

// For laws whose dilation wears off, tan(psi) is the mean over the pairs of a joint, as the joint is raised as a whole.
// With a tan(psi) for each pair, the rise would depend on where the pressure is. A block that rocks would then rock
// ever more.
double mean_tan_psi(const std::vector<Index>& joint, const std::vector<FacePair>& pairs,
                    const std::vector<joint::Law>& laws)
{
    double sum = 0, length = 0;
    for (const Index p : joint)
        if (const FacePair& pair = pairs[p]; wears(laws[pair.law]) && pair.is_closed) {
            sum += pair.length * joint::slopes(laws[pair.law], pair.state(), pair.sigma).tan_psi;
            length += pair.length;
        }
    return length > 0 ? sum / length : 0.0;
}

} // namespace

// Raises the joints that dilate, for the slip of this step: by x = sum of F tan(psi) slip(x) over sum of F. F are the
// normal forces of the pairs of a joint. slip(x) reduces the shear force of a pair to its strength after the rise. The
// right side falls with x.
void FaceContacts::dilate(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move)
{
    for (FacePair& pair : pairs_)
        pair.raised = 0;
    Dilating dilating;
    double most = 0;
    for (const std::vector<Index>& joint : joints_) {
        dilating.sheared.clear();
        dilating.pressed = dilating.left = 0;
        const double worn = mean_tan_psi(joint, pairs_, laws_);
        for (const Index p : joint) {
            const FacePair& pair = pairs_[p];
            const double pressed = -pair.sigma * pair.length;
            if (!pair.is_closed || pressed <= 0)
                continue;
            dilating.pressed += pressed;
            const joint::Law& law = laws_[pair.law];
            joint::Slopes slopes = joint::slopes(law, pair.state(), pair.sigma);
            if (wears(law))
                slopes.tan_psi = worn;
            if (slopes.tan_psi == 0 || slopes.k_s == 0)
                continue;
            dilating.left = std::max(dilating.left, joint::dilation_end(law) - pair.dilation);
            const Moved moved = moved_in_middle(pair, faces_, place, move);
            dilating.sheared.push_back(sheared_by(moved, pair, law, slopes, pressed));
        }
        const double rise = dilating.rise();
        if (rise == 0)
            continue;
        most = std::max(most, rise);
        for (const Index p : joint) {
            pairs_[p].raised = rise;
            pairs_[p].raise(rise);
        }
    }
    raised_ += most;
}

} // namespace jointcreep::large_displacements
