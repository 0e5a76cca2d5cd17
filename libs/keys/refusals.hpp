// All that is wrong with a text, not the first fault alone: where a step of reading or checking is refused, the next one is
// tried.

#pragma once

#include "model/error.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace jointcreep::keys
{

// A fault at a line of the text.
struct refusal : input_error {
    std::int64_t line;
    refusal(std::int64_t at, const std::string& what) : input_error(what), line(at) {}
};

// Ends a step whose faults have been kept: what it would have made must not be used.
struct already_refused {
};

class Refusals
{
public:
    // Runs a step, and keeps the fault that it is refused with.
    template <class Step>
    void attempt(Step step)
    {
        try {
            step();
        } catch (const already_refused&) {
        } catch (const refusal& fault) {
            add(fault.line, fault.what());
        } catch (const input_error& fault) {
            add(0, fault.what());
        }
    }
    std::size_t count() const { return faults_.size(); }

    // Throws input_error if there is any fault: a line each, in the order of the text's lines.
    void end() const;

private:
    struct Fault {
        std::int64_t line;
        std::string what;
    };
    std::vector<Fault> faults_{};

    void add(std::int64_t line, const std::string& what) { faults_.push_back({line, what}); }
};

} // namespace jointcreep::keys
