// Open contacts that close during a creep step.
//
// Once closed they carry shear, counted from where they touched. A step that runs past that moment counts it
// from its own start, which makes an error of first order in the step. So the step is cut short there.

#pragma once

#include "joint/contacts.hpp"

namespace jointcreep::joint
{

class Closing
{
public:
    // `tolerance`: how far a contact may shear, in a step in which it closes, before it touches without the step
    // being cut [m].
    explicit Closing(double tolerance) : tolerance_(tolerance) {}

    // Before a step, with the contacts' own stiffnesses.
    void start(const Contacts& contacts);

    // After the equilibrium of a step of `duration` [s], with the stiffnesses it was found with: how long the
    // step may last [s], `duration` itself if no contact closes in it that matters.
    double longest_step(const Contacts& contacts, double duration);

    // What made the last longest_step shorter than the duration:  share * opening / -rate, or
    // share * duration * opening / (opening - closed), whichever it `is_by_rate`.
    struct Cut {
        Index contact = -1; // none
        bool is_by_rate = false;
        double share = 0;
        double opening = 0, rate = 0, closed = 0; // [m], [m/s], [m]
    };
    const Cut& last_cut() const { return cut_; }

    // The step is accepted.
    void finish(const Contacts& contacts, double duration);

    // Whether a contact was open at the step's start; after finish(), how fast it opens then [m/s].
    bool was_open(std::size_t contact) const { return was_open_[contact] != 0; }
    double rate(std::size_t contact) const { return rate_[contact].x(); }

    // What differs from a new one between steps.
    void transfer(const Transfer& to, Checkpoint& kept)
    {
        if (!kept.opening_rate.empty() && kept.opening_rate.size() != kept.contact_status.size())
            throw input_error("the state kept is that of another section");
        to.size(rate_, kept.opening_rate);
        to.values(rate_, kept.opening_rate);
    }

    // Forgets the rates of closing: to be called after a sudden change of loads.
    void start_afresh() { rate_.clear(); }

private:
    double tolerance_;
    int cuts_ = 0; // of this step
    Cut cut_;
    std::vector<char> was_open_;
    std::vector<double> opening_, shear_; // at the step's start [m]
    std::vector<Eigen::Vector2d> rate_;   // of {opening, shear} in the last step [m/s]
};

} // namespace jointcreep::joint
