// Records an analysis: rows of the histories, states, and the convergence report of every equilibrium.

#pragma once

#include "analysis/section.hpp"
#include "analysis/watcher.hpp"

namespace jointcreep::analysis
{

class Records : public Watcher
{
public:
    explicit Records(Section& section) : section_(section) {}

    void equilibrium_ends(double /*still_applied*/) override { record_equilibrium(); }
    void step_ends(const Step&) override { record_equilibrium(); }
    void row_is_due(const std::string& event) override
    {
        section_.recorder.record_history(section_.result, section_.now, event, section_.assembly);
    }
    void state_is_due(const std::string& event) override
    {
        section_.recorder.record_state(section_.result, section_.now, event, section_.assembly);
    }

private:
    void record_equilibrium()
    {
        const auto& [convergence, effort] = section_.settled;
        section_.recorder.record_equilibrium(section_.result, section_.now, convergence, effort);
        section_.settled.effort = {};
    }

    Section& section_;
};

} // namespace jointcreep::analysis
