// Keeps the state of an analysis, so that another run can continue from there: before every stage; and, when some time
// has passed since or it is asked for, at the next moment at which that is possible (model/checkpoint.hpp).

#pragma once

#include "analysis/section.hpp"
#include "analysis/step_recorder.hpp"
#include "analysis/watcher.hpp"

#include <chrono>
#include <optional>

namespace jointcreep::analysis
{

class Checkpoints : public Watcher, public SearchKeeper
{
public:
    // `take` makes a checkpoint of the analysis as it is.
    Checkpoints(Section& section, StepRecorder& step_history, const Recording& recording,
                std::function<Checkpoint()> take)
        : section_(section), step_recorder_(step_history), keep_(recording.keep),
          every_(recording.keep_every), now_(recording.keep_now), keeps_next_(recording.keep_beginning),
          take_(std::move(take))
    {
        section.keeper = this;
    }

    // The analysis continues from there. Its result up to there is needed when a search that was kept begins again;
    // what is computed before is in it already.
    void continue_from(Checkpoint kept, Result so_far)
    {
        here_ = std::move(kept);
        is_here_ = true;
        keeps_next_ = false;
        if (here_.search.empty())
            return;
        search_ = std::exchange(here_.search, {});
        search_number_ = here_.search_number;
        so_far_ = std::move(so_far);
    }

    void stage_begins() override { come_to(true); }
    void may_continue_here() override { come_to(false); }

    bool search_begins(const std::function<void(Tape&)>& pass) override
    {
        if (++searches_ - 1 != search_number_ || search_.empty())
            return false;
        so_far_.mesh = std::move(section_.result.mesh);
        section_.result = std::move(so_far_);
        Tape tape(std::exchange(search_, {}));
        pass(tape);
        tape(step_recorder_);
        tape.check_end();
        return true;
    }
    void search_goes_on(const std::function<void(Tape&)>& pass) override
    {
        if (!is_due())
            return;
        Tape tape;
        pass(tape);
        tape(step_recorder_);
        here_.search_number = searches_ - 1;
        here_.search = std::move(tape).numbers();
        keep();
        here_.search.clear();
    }

private:
    using Clock = std::chrono::steady_clock;

    void come_to(bool is_stage)
    {
        Tape::check(search_.empty() || is_here_); // else the search that was kept has not come
        searches_ = 0;
        if (std::exchange(is_here_, false) || !keep_) // the moment that it continues from
            return;
        here_ = take_();
        if (std::exchange(keeps_next_, false) || is_stage || is_due())
            keep();
    }
    bool is_due() const
    {
        return keep_ && search_.empty() && ((every_ && Clock::now() - last_ >= *every_) || now_());
    }
    void keep()
    {
        keep_(section_.result, here_);
        last_ = Clock::now();
    }

    Section& section_;
    StepRecorder& step_recorder_;
    std::function<void(const Result&, const Checkpoint&)> keep_;
    std::optional<std::chrono::duration<double>> every_;
    std::function<bool()> now_;
    bool keeps_next_; // whether due or not
    std::function<Checkpoint()> take_;
    Clock::time_point last_ = Clock::now();
    Checkpoint here_;            // at the last moment from which another run can continue
    bool is_here_ = false;       // that moment comes again
    Index searches_ = 0;         // since then
    std::vector<double> search_; // that was kept, until it begins again
    Index search_number_ = 0;
    Result so_far_{};
};

} // namespace jointcreep::analysis
