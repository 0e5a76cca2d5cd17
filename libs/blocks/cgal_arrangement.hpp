// CGAL's exact arrangement (Arrangement_2 over exact constructions), a second method beside blocks::arrange().
// Compiling it takes long: inside libs/blocks/arrange_with_cgal.cpp, tests and benchmark only.

#pragma once

#include "blocks/graph.hpp"

#include <CGAL/Arr_consolidated_curve_data_traits_2.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace jointcreep::blocks
{

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using SegmentTraits = CGAL::Arr_segment_traits_2<Exact>;
using CurveTraits =
    CGAL::Arr_consolidated_curve_data_traits_2<SegmentTraits, Index>; // data: an edge of the input
using CgalArrangement = CGAL::Arrangement_2<CurveTraits>;

inline void insert_lines(CgalArrangement& arrangement, const Graph& lines)
{
    std::vector<CurveTraits::Curve_2> curves;
    curves.reserve(lines.edge.size());
    for (std::size_t i = 0; i < lines.edge.size(); ++i) {
        const auto &a = lines.vertex[lines.edge[i].first], &b = lines.vertex[lines.edge[i].second];
        if (a != b)
            curves.emplace_back(
                SegmentTraits::Curve_2(Exact::Point_2(a.x(), a.y()), Exact::Point_2(b.x(), b.y())),
                static_cast<Index>(i));
    }
    CGAL::insert(arrangement, curves.begin(), curves.end());
}

// The double nearest to an exact number, halfway cases to even: by halving the distance between two doubles.
inline double nearest(const Exact::FT& number)
{
    using Rational = Exact::Exact_kernel::FT;
    const Rational& exact = number.exact();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double low = CGAL::to_double(number);
    while (Rational(low) > exact)
        low = std::nextafter(low, -infinity);
    while (Rational(std::nextafter(low, infinity)) <= exact)
        low = std::nextafter(low, infinity);
    const double high = std::nextafter(low, infinity);
    const Rational middle((Rational(low) + Rational(high)) / 2);
    if (exact < middle)
        return low + 0.0;
    if (exact > middle)
        return high + 0.0;
    int exponent = 0;
    return std::fmod(std::ldexp(std::frexp(low, &exponent), 53), 2) == 0 ? low : high;
}

// What blocks::arrange() promises: all edges with their ends rounded to the nearest doubles, with the lines
// they lie on; those without length left out, those with equal ends united.
using EdgeLines = std::map<std::tuple<double, double, double, double>, std::vector<Index>>;

inline EdgeLines edges_of(const CgalArrangement& arrangement, const Graph& lines)
{
    std::map<const void*, std::pair<double, double>> place;
    for (auto v = arrangement.vertices_begin(); v != arrangement.vertices_end(); ++v)
        place[&*v] = {nearest(v->point().x()), nearest(v->point().y())};
    EdgeLines edges;
    for (auto e = arrangement.edges_begin(); e != arrangement.edges_end(); ++e) {
        const auto [a, b] = std::minmax(place.at(&*e->source()), place.at(&*e->target()));
        if (a == b)
            continue;
        auto& on = edges[{a.first, a.second, b.first, b.second}];
        for (auto d = e->curve().data().begin(); d != e->curve().data().end(); ++d)
            on.push_back(lines.edge[*d].sources);
        std::sort(on.begin(), on.end());
        on.erase(std::unique(on.begin(), on.end()), on.end());
    }
    return edges;
}

} // namespace jointcreep::blocks
