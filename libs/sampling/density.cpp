#include "sampling/density.hpp"

#include "model/error.hpp"
#include "sampling/laws.hpp"
#include "sampling/orientations.hpp"
#include "sampling/quoted.hpp"

#include <numbers>

namespace jointcreep::sampling
{

namespace
{

constexpr double least_along = 1e-3; // of a scanline: it runs next to along all joints

[[noreturn]] void refuse(const JointSet& set, const std::string& what)
{
    throw input_error(quoted(set) + ": " + what);
}

double of_size(const JointSet& set, const std::optional<ProbabilityLaw>& law, int order)
{
    if (!law)
        refuse(set, set.kind == SetKind::discs ? "discs need a diameter" : "segments need a length");
    return moment_of_positive(*law, order);
}

// Joint area per volume that a target stands for.
double area_of_target(const JointSet& set, const Scene& scene, const Rose& rose)
{
    const Density& target = *set.density;
    const bool discs = set.kind == SetKind::discs;
    switch (target.measure) {
    case Density::Measure::p10: {
        const double met = rose.along(direction_of(target.scanline, scene));
        if (met < least_along)
            refuse(set, "its density is measured on a scanline that runs along the set, and meets next to "
                        "none of its joints");
        return target.value / met;
    }
    case Density::Measure::p20:
        if (set.kind == SetKind::lines)
            break;
        if (discs)
            return target.value * std::numbers::pi / 4 * of_size(set, set.diameter, 2) /
                   (of_size(set, set.diameter, 1) * rose.in_section());
        return target.value * of_size(set, set.length, 1) / rose.in_section();
    case Density::Measure::p21:
        return target.value / rose.in_section();
    case Density::Measure::p30:
        if (!discs)
            break;
        return target.value * std::numbers::pi / 4 * of_size(set, set.diameter, 2);
    case Density::Measure::p32:
        return target.value;
    }
    refuse(set, "lines have no number per area, and only discs one per volume");
}

} // namespace

SetDensity density_of(const JointSet& set, const Scene& scene)
{
    const Orientations orientations(set, scene);
    const Rose rose = orientations.rose();
    const double across = rose.along(orientations.across_mean_trace());
    const bool in_space = !set.trace_angle;
    SetDensity density;
    double area = 0;
    if (set.density) {
        if (set.kind == SetKind::lines && set.persistence <= 0)
            refuse(set, "a density is one of joint traces, and a persistence of 0 leaves none");
        area = area_of_target(set, scene, rose);
    } else if (set.kind == SetKind::lines) {
        const double spacing = mean_of_positive(set.spacing);
        const double in_section = set.poles.empty() ? spacing / orientations.mean_trace().norm()
                                                    : spacing * rose.along(orientations.mean_pole()) / across;
        area = set.persistence / (in_section * across);
        density.spacing = in_section;
    } else {
        refuse(set, "segments and discs need a density");
    }
    density.p21 = area * rose.in_section();
    if (in_space)
        density.p32 = area;
    if (set.kind == SetKind::lines && set.density)
        density.spacing = set.persistence / (area * across);
    if (set.kind == SetKind::segments)
        density.p20 = density.p21 / of_size(set, set.length, 1);
    if (set.kind == SetKind::discs) {
        density.p30 = area * 4 / (std::numbers::pi * of_size(set, set.diameter, 2));
        density.p20 = density.p30 * of_size(set, set.diameter, 1) * rose.in_section();
    }
    return density;
}

double expected_p10(const JointSet& set, const Scene& scene, const Eigen::Vector3d& direction)
{
    const Rose rose = Orientations(set, scene).rose();
    return density_of(set, scene).p21 / rose.in_section() * rose.along(direction);
}

} // namespace jointcreep::sampling
