// How the joints of a set lie, seen from the section. Vectors are in the section's frame: along its x, its y,
// and across it, where y is up and `across` is horizontal, 90 degrees clockwise from the bearing of +x.
//
// What a law in space is a law of, and what is drawn from it:
//  - lines, dip and dip direction or Fisher: of the planes that a scanline in the section along the mean
//    trace's normal m meets; drawn as it is. The law of all planes of the set, by area, is then that one over
//    |n.m|.
//  - lines, bootstrap: of all planes of the set; drawn with the probability |n.m| of being met by that
//  scanline.
//  - segments, discs: of all joints of the set in space; drawn with the probability |n_p|, the sine of the
//    angle to the section, of being met by the section.
// A law of the trace angle is drawn as it is: of lines that is the law along the scanline, of segments the
// law of all traces.

#pragma once

#include "model/scene.hpp"
#include "sampling/streams.hpp"

#include <Eigen/Core>

#include <vector>

namespace jointcreep::sampling
{

// The part in the section of a joint plane's upward unit normal: n_p = n - (n . e_z) e_z, in the section's x
// and y. |n_p| is the sine of the angle between plane and section; joints of true spacing s are s / |n_p|
// apart in it. Angles [rad]: dip below the horizontal, dip direction and azimuth of +x clockwise from north.
Eigen::Vector2d section_normal(double dip, double dip_direction, double azimuth);

// The trace of such a plane in the section, counter-clockwise from +x, in [-pi/2, pi/2] for dips up to pi/2
// [rad]; meaningless for a plane parallel to the section, where n_p = 0.
double trace_angle(double dip, double dip_direction, double azimuth);

// Upward unit normal.
Eigen::Vector3d pole_of(double dip, double dip_direction, double azimuth);

// Unit vector along a scanline. Throws input_error if it has a trend and the section has no azimuth.
Eigen::Vector3d direction_of(const Scanline& scanline, const Scene& scene);

// All the joints of a set by their unit normals, each with its share of the joint area. Laws other than the
// bootstrap are laid out on a grid, close enough for means to 1e-3.
struct Rose {
    std::vector<Eigen::Vector3d> pole; // unit vectors [-]
    std::vector<double> share;         // sums to 1 [-]

    // Mean of |n.v|: joints met by a scanline along the unit vector v, per area of joint in a volume.
    double along(const Eigen::Vector3d& v) const;
    // Mean of |n_p|: trace length in the section, per area of joint in a volume.
    double in_section() const;
};

class Orientations
{
public:
    // Throws input_error: no orientation, an azimuth is missing, or the set is parallel to the section.
    Orientations(const JointSet& set, const Scene& scene);

    // The trace of the mean plane, of length |n_p|.
    const Eigen::Vector2d& mean_trace() const { return mean_trace_; }
    // Unit normal of the mean plane; of a bootstrap the axis that its poles lie nearest to.
    const Eigen::Vector3d& mean_pole() const { return mean_pole_; }
    // Unit normal of the mean trace, in the section: the vector m above.
    Eigen::Vector3d across_mean_trace() const;
    // Largest angle to the mean trace that is worth looking for: 5 standard deviations, 85 degrees at most
    // [rad].
    double steepest() const;

    // One joint that is in the section.
    struct Drawn {
        Eigen::Vector2d trace; // unit vector along it
        Eigen::Vector3d pole;  // upward unit normal; zero if the set has a law of the trace angle
    };
    Drawn draw_joint(Stream& stream) const;

    // Of all joints of the set; in the section itself, if it has a law of the trace angle. Of lines, traces
    // more than 85 degrees off the mean trace and planes less than 3 degrees off the section are left out.
    Rose rose() const;

private:
    Eigen::Vector3d draw_pole(Stream& stream) const;

    const JointSet& set_;
    double azimuth_ = 0;                // [rad]
    std::vector<Eigen::Vector3d> pole_; // of a bootstrap
    std::vector<double> sum_;           // of shares up to each
    Eigen::Vector3d mean_pole_;
    Eigen::Vector2d mean_trace_;
};

} // namespace jointcreep::sampling
