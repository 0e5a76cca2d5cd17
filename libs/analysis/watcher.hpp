// Watchers of an analysis: their functions are called at the moments below. The schedule (analysis/analysis.hpp) does
// not know them.

#pragma once

#include "joint/closing.hpp"
#include "mechanics/creep.hpp"

#include <string>
#include <vector>

namespace jointcreep::analysis
{

// A step of creep and loading.
struct Step {
    double end;                    // since start [s]
    double duration;               // [s]
    bool is_whole;                 // has its full length: not cut short where a contact closes
    const mechanics::Creep* creep; // none: only the loading changes
    const joint::Closing* closing; // none: the creep scheme is of first order, and no step is cut
};

class Watcher
{
public:
    virtual ~Watcher() = default;

    // An equilibrium was found. `still_applied` is the share of the last stage's forces that still act [-].
    virtual void equilibrium_ends(double /*still_applied*/) {}
    // In situ, at equilibrium: displacements count from here.
    virtual void displacements_start() {}
    // Called after that, with the creep of joints and rock.
    virtual void creep_begins(const mechanics::Creep&) {}

    // A step of creep and loading begins. An equilibrium is found at its end. Then the step is rejected for its error,
    // and everything is as it was at its start; or it is accepted and has ended.
    virtual void step_begins() {}
    virtual void step_settles(const Step&) {}
    virtual void step_is_rejected() {}
    virtual void step_ends(const Step&) {}
    // In between: no equilibrium was found at its end, and the step is halved. Or one was found, and the step will be
    // cut short where a contact closes.
    virtual void step_is_halved() {}
    virtual void step_is_cut(const Step&) {}

    // Another run could continue from here: what engines have learnt is forgotten.
    virtual void may_continue_here() {}

    // A stage is to be excavated; its rock is removed.
    virtual void stage_begins() {}
    virtual void rock_is_removed() {}
    // Loads have changed suddenly, or begin to change.
    virtual void loads_change() {}

    // A row of the histories is due, or a state of the whole section; `event` is the stage that it is the
    // first after, or "".
    virtual void row_is_due(const std::string& /*event*/) {}
    virtual void state_is_due(const std::string& /*event*/) {}
};

// The watchers of an analysis, called in this order.
class Watchers
{
public:
    void add(Watcher& watcher) { watchers_.push_back(&watcher); }

    template <class... Wanted, class... Given>
    void tell(void (Watcher::*moment)(Wanted...), const Given&... given) const
    {
        for (Watcher* watcher : watchers_)
            (watcher->*moment)(given...);
    }

    void row_and_state_are_due(const std::string& event) const
    {
        tell(&Watcher::row_is_due, event);
        tell(&Watcher::state_is_due, event);
    }

private:
    std::vector<Watcher*> watchers_;
};

} // namespace jointcreep::analysis
