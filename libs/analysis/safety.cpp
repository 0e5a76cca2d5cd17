#include "analysis/safety.hpp"

#include "joint/strength_factor.hpp"
#include "model/error.hpp"
#include "rock/strength_factor.hpp"

#include <limits>
#include <utility>

namespace jointcreep::analysis
{

namespace
{

// The scene with strengths divided by a factor, and a limit of displacement.
Scene trial_of(Scene scene, double factor, double most_displacement)
{
    if (factor != 1) {
        scene.rocks = rock::with_strength_divided(std::move(scene.rocks), factor);
        scene.joint_materials = joint::with_strength_divided(std::move(scene.joint_materials), factor);
    }
    scene.equilibrium.largest_displacement = most_displacement;
    return scene;
}

} // namespace

Trial::Trial(const Scene& scene, const Network& network, const EquivalentJoints& joints, double factor,
             double most_displacement, int threads, const Recording& recording, const Observer& observe)
    : factor_(factor), scene_(trial_of(scene, factor, most_displacement)),
      joints_(factor == 1 ? joints : joint::with_strength_divided(joints, factor)),
      analysis_(scene_, network, joints_, threads, recording, observe)
{
}

void Trial::run()
{
    try {
        analysis_.run();
    } catch (const equilibrium_error& error) {
        message_ = error.what();
    }
}

void Trial::go_on(Result so_far, Checkpoint kept)
{
    try {
        analysis_.go_on(std::move(so_far), std::move(kept));
    } catch (const equilibrium_error& error) {
        message_ = error.what();
    }
}

Outcome Trial::outcome() const
{
    const Ending ending = message_.empty()                           ? Ending::stands
                          : analysis_.result().failure.moves_on != 0 ? Ending::falls
                                                                     : Ending::undecided;
    return {ending, analysis_.largest_displacement(),
            rock::largest_plastic_strain(analysis_.assembly().zones)};
}

Outcome outcome_of(const Safety& trials, std::size_t i)
{
    const Ending ending = trials.stands[i] > 0    ? Ending::stands
                          : trials.stands[i] == 0 ? Ending::falls
                                                  : Ending::undecided;
    return {ending, trials.largest_displacement[i], trials.largest_plastic_strain[i]};
}

namespace
{

constexpr double most_factor = 64; // and its inverse

// Runs with different factors, and the bracket that they give.
class Search
{
public:
    Search(const RunWith& run_with, double runs_away) : run_with_(run_with), runs_away_(runs_away) {}

    // The run whose displacement others are measured by. Whether it stands.
    bool begin()
    {
        if (!stands(1 / most_factor))
            return false;
        if (const double firm = found_.trials.largest_displacement[0]; firm > 0)
            limit_ = runs_away_ * firm;
        return true;
    }

    bool stands(double factor)
    {
        const Outcome outcome = run_with_(factor, limit_, found_.trials);
        const bool stood = outcome.ending == Ending::stands;
        found_.trials.factor.push_back(factor);
        found_.trials.stands.push_back(stood ? 1 : outcome.ending == Ending::falls ? 0 : -1);
        found_.trials.largest_displacement.push_back(outcome.largest_displacement);
        found_.trials.largest_plastic_strain.push_back(outcome.largest_plastic_strain);
        (stood ? found_.stands : found_.not_above) = factor;
        return stood;
    }

    // Halves the bracket.
    Bracket narrowed(double width)
    {
        while (found_.stands && found_.not_above &&
               *found_.not_above - *found_.stands > width * *found_.stands)
            stands((*found_.stands + *found_.not_above) / 2);
        return std::move(found_);
    }

private:
    const RunWith& run_with_;
    double runs_away_;
    double limit_ = std::numeric_limits<double>::infinity(); // of displacement [m]
    Bracket found_;
};

} // namespace

Bracket bracket_of(const RunWith& run_with, double width, double runs_away)
{
    Search search(run_with, runs_away);
    if (search.begin()) {
        if (search.stands(1))
            for (double factor = 2; factor <= most_factor && search.stands(factor);)
                factor *= 2;
        else
            for (double factor = 0.5; factor > 1 / most_factor && !search.stands(factor);)
                factor /= 2;
    }
    return search.narrowed(width);
}

Bracket bracket_near(double known, const RunWith& run_with, double width, double runs_away)
{
    Search search(run_with, runs_away);
    if (search.begin()) {
        const bool up = search.stands(known);
        double step = known / 20, factor = known;
        do {
            factor += up ? step : -step;
            step *= 2;
        } while (factor <= most_factor && factor > 1 / most_factor && search.stands(factor) == up);
    }
    return search.narrowed(width);
}

} // namespace jointcreep::analysis
