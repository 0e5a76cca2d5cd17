#include "analysis/sensitivities.hpp"

namespace jointcreep::analysis
{

Sensitivities::Sensitivities(std::vector<Scaled> parameters, Section& section, implicit::Solver& engine)
    : section_(section), engine_(engine),
      sensitivity_(std::move(parameters), section.scene, section.mesh(), section.assembly)
{
    section.sensitivities.resize(sensitivity_.size());
}

void Sensitivities::equilibrium_ends(double still_applied)
{
    sensitivity_.settle(section_.assembly, engine_, section_.now, still_applied);
}

void Sensitivities::displacements_start()
{
    sensitivity_.start_from_here(section_.assembly);
}

void Sensitivities::creep_begins(const mechanics::Creep& creep)
{
    sensitivity_.start_creep(creep);
}

void Sensitivities::step_begins()
{
    at_start_ = sensitivity_;
    sensitivity_.start_step(section_.assembly);
}

void Sensitivities::step_settles(const Step& step)
{
    if (step.creep != nullptr)
        sensitivity_.creep_step(*step.creep, step.duration, section_.assembly, engine_, step.end);
    else
        sensitivity_.settle(section_.assembly, engine_, step.end);
}

void Sensitivities::step_is_rejected()
{
    sensitivity_ = *at_start_;
}

void Sensitivities::step_ends(const Step& step)
{
    if (step.closing != nullptr)
        sensitivity_.finish_step(*step.closing, step.duration, step.is_whole, section_.assembly);
}

void Sensitivities::step_is_halved()
{
    sensitivity_.shorten(0.5);
}

void Sensitivities::step_is_cut(const Step& step)
{
    sensitivity_.cut(step.closing->last_cut(), *step.creep, step.duration, section_.assembly, engine_,
                     step.end);
}

void Sensitivities::stage_begins()
{
    sensitivity_.before_excavation(section_.assembly);
}

void Sensitivities::rock_is_removed()
{
    sensitivity_.after_excavation(section_.assembly);
}

void Sensitivities::loads_change()
{
    sensitivity_.start_afresh();
}

void Sensitivities::row_is_due(const std::string& /*event*/)
{
    for (std::size_t p = 0; p < sensitivity_.size(); ++p)
        section_.recorder.append_at_points(section_.sensitivities[p], sensitivity_.displacement(p),
                                           section_.assembly);
}

} // namespace jointcreep::analysis
