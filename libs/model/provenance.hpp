// Where a file comes from: one row a program of the chain, the last being the one that wrote the file.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace jointcreep
{

// What the programs warned of, in order.
struct Warnings {
    std::vector<std::string> program{}; // which said it
    std::vector<std::string> text{};

    void add(const std::string& by, const std::string& what)
    {
        program.push_back(by);
        text.push_back(what);
    }
};

struct Provenance {
    std::string scene;      // the scene's text, as it was read
    std::uint64_t seed = 0; // of the joint sets
    std::int32_t realization = 0;
    std::vector<std::string> program;
    std::vector<std::string> version;      // of that program
    std::vector<std::string> input_sha256; // digest of what it read
    std::vector<std::string> options;      // the options given that can change its result, "" if none
    Warnings warnings{};
};

} // namespace jointcreep
