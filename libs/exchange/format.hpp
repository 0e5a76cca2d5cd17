// The table of formats: one row for each, with its name, its extensions, what it can hold and how it is written.
//
// To add one: write a function from a job to files, declare it in exchange/writers.hpp, and add its row in format.cpp.
// The command line, `jointexport --formats` and the page docs/exchange.md follow.

#pragma once

#include "exchange/layers.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::exchange
{

// What is to be written.
struct Job {
    std::span<const Section> sections; // at least one
    std::vector<std::string> layers;   // at least one
    std::optional<double> width{};     // of planes across the section [m]

    std::vector<Layer> all(std::string_view layer) const; // one of each section
};

// A file of an export: the output itself, or one beside it.
struct File {
    std::string word;      // NAME.word.EXT; empty: the output itself
    std::string extension; // in place of the output's; empty: the same
    std::string bytes;
};

struct Format {
    std::string_view name;
    std::vector<std::string_view> extensions; // ".csv"
    std::vector<std::string_view> holds;      // layers, and zones, contacts, histories, failure of a result
    std::vector<std::string_view> usual;      // of a network or joints file
    std::string_view usual_of_result;         // empty: the same
    bool holds_several = false;               // layers in one file
    bool holds_realizations = false;          // of several files in one
    std::string_view written;                 // how, in a few words
    // The output comes last: it is there only when the others are. Null: of a result alone, or a format that this
    // build lacks.
    std::vector<File> (*write)(const Job&) = nullptr;
    bool needs_gdal = false;
    bool is_binary = false; // not for standard output
};

const std::vector<Format>& formats();

// Whether this build has GDAL.
bool has_gdal();

// The table as `jointexport --formats` prints it.
std::string formats_text();

// The format of an output: by name, or by its extension where only one format has that, or one of its name. Standard
// output, "-", needs the name of a text format. Throws input_error that lists what there is.
const Format& format_of(const std::string& output, const std::optional<std::string>& name);

} // namespace jointcreep::exchange
