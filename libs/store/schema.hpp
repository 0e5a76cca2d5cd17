// The one list of everything in a file. Writing, reading, checking and docs/file-format.md all follow it: a
// new member of a record needs a line here, and no more.

#pragma once

#include "model/network.hpp"
#include "model/provenance.hpp"
#include "model/result.hpp"
#include "store/files.hpp"

#include <functional>
#include <limits>
#include <span>
#include <variant>

namespace jointcreep::store::schema
{

inline constexpr Index major_version = 2, minor_version = 2;

// Which values a dataset may hold. Real numbers are always finite.
struct Limits {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool positive = false;
    bool ascending = false;    // no value is below the one before
    std::string index_of = {}; // a dimension; -1, where allowed, means none
    bool or_none = false;
    std::string rows_of = {}; // a dimension: the first value is 0, the last the size of the dimension
};

// Where the values are in memory.
using Values = std::variant<std::vector<double>*, std::vector<Index>*, std::vector<Eigen::Vector2d>*,
                            std::vector<Eigen::Vector3d>*, std::vector<Eigen::Vector4d>*,
                            std::vector<std::array<Index, 2>>*, std::vector<std::array<Index, 3>>*,
                            std::vector<std::string>*, double*, Index*, std::string*>;

struct Field {
    std::string path; // of the dataset
    Values values;
    std::vector<std::string>
        dimensions;    // names, also "name+1"; none for a single value, a dataset of one element
    std::string units; // "1" for numbers without one, and for text
    Limits limits;
    std::string description;
};

// What must hold between the values of a row, beyond the limits of each.
struct Invariant {
    std::string path; // of the dataset that messages name
    std::string sentence;
    std::string dimension; // whose every row it holds for
    std::function<bool(std::size_t row)> holds;
};

struct Described {
    std::string name;
    std::string description;
};

// The fields point into the record. A record that is only read may be given too, as `reading(record)`.
std::vector<Field> fields_of(Provenance& provenance);
std::vector<Field> fields_of(Network& network);
std::vector<Field> fields_of(EquivalentJoints& equivalent);
std::vector<Field> fields_of(Result& result); // without its step history, dynamics and failure
std::vector<Field> fields_of(StepHistory& step_history);
std::vector<Field> fields_of(DynamicsHistory& dynamics);
std::vector<Field> fields_of(Failure& failure);
std::vector<Field> fields_of(Safety& safety);
std::vector<Field> fields_of(Checkpoint& checkpoint); // without the state of a dynamic analysis
std::vector<Field> fields_of(DynamicsState& state);

// To be asked only once the fields are within their limits. They refer to the record.
std::vector<Invariant> invariants_of(const Network& network);
std::vector<Invariant> invariants_of(const EquivalentJoints& joints);
std::vector<Invariant> invariants_of(const Mesh& mesh);

// For those who do not write through a field.
template <class Record>
Record& reading(const Record& record)
{
    return const_cast<Record&>(record);
}

// Dimensions, with what one row of each is.
const std::vector<Described>& dimensions();

// Attributes of the file itself.
const std::vector<Described>& root_attributes();

// "jointcreep network" and so on; and the program that makes such a file.
std::string file_type(FileKind kind);
std::string maker(FileKind kind);

// What the limits ask for: "0 to 1", "index of block or -1".
std::string wanted(const Limits& limits);

// The values as one flat array, vectors spread into their components.
using Flat = std::variant<std::span<double>, std::span<Index>, std::span<std::string>>;
Flat flat(const Values& values);
std::size_t components(const Values& values); // of one row: 1 to 4
std::size_t rows(const Values& values);
void resize(const Values& values, std::size_t rows); // of an array

} // namespace jointcreep::store::schema
