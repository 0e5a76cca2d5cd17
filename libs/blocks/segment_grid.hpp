// Segments by the square cells they run through. Inside libs/blocks only.

#pragma once

#include "model/network.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace jointcreep::blocks
{

struct Segment {
    Eigen::Vector2d from, to; // [m]
};

// Every segment is listed in all cells it has a place in, and in some it only passes close by: margin() is
// more than rounding can put a place off.
class SegmentGrid
{
public:
    // Lists the first `listed` of the segments; the grid suits them all.
    SegmentGrid(const std::vector<Segment>& segments, std::size_t listed);
    explicit SegmentGrid(const std::vector<Segment>& segments) : SegmentGrid(segments, segments.size()) {}

    double cell() const { return cell_; }         // side of a cell [m]
    double margin() const { return margin_; }     // [m]
    double farthest() const { return farthest_; } // largest coordinate of any segment [m]
    double extent() const { return extent_.maxCoeff(); }

    // Calls in_column(column, first row, last row) for all columns a segment runs through.
    template <class InColumn>
    void for_columns(const Segment& s, InColumn in_column) const;

    // Whether a segment runs through a cell that lists one; so does all that has a place in common with one.
    bool is_near_listed(const Segment& s) const
    {
        bool is_near = false;
        for_columns(s, [&](Index column, Index first, Index last) {
            is_near = is_near || start_[number(column, first)] != start_[number(column, last) + 1];
        });
        return is_near;
    }

    // Calls visit(segments, low, high) for every cell, with its corners; segments in ascending order.
    template <class Visit>
    void for_cells(Visit visit) const
    {
        for (Index column = 0; column < columns_; ++column)
            for (Index row = 0; row < rows_; ++row) {
                const Eigen::Vector2d low = low_ + Eigen::Vector2d(column * cell_, row * cell_);
                visit(at(column, row), low, low + Eigen::Vector2d(cell_, cell_));
            }
    }

    std::span<const Index> at(Index column, Index row) const
    {
        const std::size_t c = number(column, row);
        return {entry_.data() + start_[c], entry_.data() + start_[c + 1]};
    }

private:
    std::size_t number(Index column, Index row) const
    {
        return static_cast<std::size_t>(column) * rows_ + row;
    }
    Index index(double offset, Index count) const
    {
        return static_cast<Index>(std::clamp(offset / cell_, 0.0, static_cast<double>(count - 1)));
    }

    Eigen::Vector2d low_{0, 0}, extent_{0, 0};    // [m]
    double cell_ = 1, margin_ = 0, farthest_ = 0; // [m]
    Index columns_ = 0, rows_ = 0;
    std::vector<std::size_t> start_;
    std::vector<Index> entry_;
};

inline SegmentGrid::SegmentGrid(const std::vector<Segment>& segments, std::size_t listed)
{
    if (segments.empty())
        return;
    using Eigen::Vector2d;
    Vector2d high = low_ = segments[0].from;
    double length = 0;
    for (const Segment& s : segments) {
        low_ = low_.cwiseMin(s.from.cwiseMin(s.to));
        high = high.cwiseMax(s.from.cwiseMax(s.to));
        length += (s.to - s.from).norm();
    }
    const auto count = static_cast<double>(segments.size());
    farthest_ = std::max(low_.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    extent_ = (high - low_).cwiseMax(std::max(1e-9 * (high - low_).maxCoeff(), 1e-9 * farthest_));
    const double area = extent_.x() * extent_.y();
    // Long lines: two or three through a cell. Short edges: about two to a cell. Never more cells, nor more
    // segments in cells, than can be afforded.
    cell_ = std::max({std::min(2 * area / length, std::sqrt(2 * area / count)),
                      std::sqrt(area / (4 * count + 4e6)), length / (8 * count + 8e6),
                      extent_.maxCoeff() / 30000});
    columns_ = static_cast<Index>(extent_.x() / cell_) + 1;
    rows_ = static_cast<Index>(extent_.y() / cell_) + 1;
    margin_ = 1e-7 * cell_ + 2e-15 * farthest_;

    start_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (std::size_t i = 0; i < listed; ++i)
        for_columns(segments[i], [&](Index column, Index first, Index last) {
            for (Index row = first; row <= last; ++row)
                ++start_[number(column, row)];
        });
    std::size_t sum = 0; // each cell's end, then, as it fills from the back, its start
    for (std::size_t& n : start_)
        n = sum += n;
    entry_.resize(sum);
    for (std::size_t i = listed; i-- > 0;)
        for_columns(segments[i], [&](Index column, Index first, Index last) {
            for (Index row = first; row <= last; ++row)
                entry_[--start_[number(column, row)]] = static_cast<Index>(i);
        });
}

template <class InColumn>
void SegmentGrid::for_columns(const Segment& s, InColumn in_column) const
{
    const bool is_rightward = s.from.x() <= s.to.x();
    const Eigen::Vector2d p = (is_rightward ? s.from : s.to) - low_,
                          q = (is_rightward ? s.to : s.from) - low_;
    const auto [least, most] = std::minmax({p.y(), q.y()});
    const double dx = q.x() - p.x(), slope = dx > margin_ ? (q.y() - p.y()) / dx : 0;
    const Index first = index(p.x() - margin_, columns_), last = index(q.x() + margin_, columns_);
    for (Index column = first; column <= last; ++column) {
        double bottom = least, top = most;
        if (dx > margin_ && first != last) {
            const double a = p.y() + slope * (column * cell_ - 2 * margin_ - p.x());
            const double b = p.y() + slope * ((column + 1) * cell_ + 2 * margin_ - p.x());
            bottom = std::max(bottom, std::min(a, b));
            top = std::min(top, std::max(a, b));
        }
        in_column(column, index(bottom - margin_, rows_), index(top + margin_, rows_));
    }
}

} // namespace jointcreep::blocks
