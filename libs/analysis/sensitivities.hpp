// Sensitivities of the histories' displacements, found along with the analysis (sensitivity/sensitivity.hpp).

#pragma once

#include "analysis/section.hpp"
#include "analysis/watcher.hpp"

#include <optional>

namespace jointcreep::analysis
{

class Sensitivities : public Watcher
{
public:
    // Before the in-situ equilibrium. `engine` is the one that finds the equilibria. Rows go into
    // Section::sensitivities.
    Sensitivities(std::vector<Scaled> parameters, Section& section, implicit::Solver& engine);

    void equilibrium_ends(double still_applied) override;
    void displacements_start() override;
    void creep_begins(const mechanics::Creep& creep) override;
    void step_begins() override;
    void step_settles(const Step& step) override;
    void step_is_rejected() override;
    void step_ends(const Step& step) override;
    void step_is_halved() override;
    void step_is_cut(const Step& step) override;
    void stage_begins() override;
    void rock_is_removed() override;
    void loads_change() override;
    void row_is_due(const std::string& event) override;

private:
    Section& section_;
    implicit::Solver& engine_;
    sensitivity::Sensitivity sensitivity_;
    std::optional<sensitivity::Sensitivity> at_start_; // of the step
};

} // namespace jointcreep::analysis
