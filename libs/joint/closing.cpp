#include "joint/closing.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::joint
{

void Closing::start(const Contacts& contacts)
{
    const std::size_t n = contacts.status.size();
    cuts_ = 0;
    was_open_.resize(n);
    opening_.resize(n);
    shear_.resize(n);
    for (std::size_t c = 0; c < n; ++c) {
        was_open_[c] = contacts.status[c] == ContactStatus::open ? 1 : 0;
        opening_[c] = opening_of(contacts, c);
        shear_[c] = contacts.relative_displacement[c].y();
    }
}

double Closing::longest_step(const Contacts& contacts, double duration)
{
    double longest = duration;
    cut_ = {};
    for (std::size_t c = 0; c < was_open_.size(); ++c) {
        if (!was_open_[c] || contacts.status[c] == ContactStatus::open ||
            contacts.status[c] == ContactStatus::removed || opening_[c] <= 0)
            continue;
        // As fast as in the last step, or else straight on to where it is now; that is later than in truth,
        // since once it touches it closes more slowly.
        const bool knows_rate = !rate_.empty() && rate_[c].x() < 0;
        const double closed = std::min(opening_of(contacts, c), 0.0);
        const double until_now = duration * opening_[c] / (opening_[c] - closed);
        const bool is_by_rate = knows_rate && opening_[c] / -rate_[c].x() < until_now;
        const double touches =
            is_by_rate ? opening_[c] / -rate_[c].x() : (knows_rate ? until_now : until_now / 2);
        // Stuck at the wrong place it may seem not to shear at all.
        const double shear_rate =
            std::max(std::abs(contacts.relative_displacement[c].y() - shear_[c]) / duration,
                     knows_rate ? std::abs(rate_[c].y()) : 0.0);
        if (touches * shear_rate > tolerance_ && touches < longest) {
            longest = touches;
            cut_ = {static_cast<Index>(c),
                    is_by_rate,
                    is_by_rate || knows_rate ? 1.0 : 0.5,
                    opening_[c],
                    is_by_rate ? rate_[c].x() : 0.0,
                    closed};
        }
    }
    if (longest < duration) {
        const double before = ++cuts_ == 1 ? 0.99 : 0.9; // it touches, so that it is open at the step's end
        longest *= before;
        cut_.share *= before;
    }
    return longest;
}

void Closing::finish(const Contacts& contacts, double duration)
{
    rate_.assign(was_open_.size(), {0, 0});
    for (std::size_t c = 0; c < was_open_.size(); ++c)
        if (was_open_[c] && contacts.status[c] == ContactStatus::open)
            rate_[c] = Eigen::Vector2d(opening_of(contacts, c) - opening_[c],
                                       contacts.relative_displacement[c].y() - shear_[c]) /
                       duration;
}

} // namespace jointcreep::joint
