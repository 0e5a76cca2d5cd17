// Rows of a table of everything in a file: each binds a dataset to a member of a record, with its dimensions,
// unit, limits and meaning. Writing, reading, checking and docs/file-format.md all follow these rows.
//
//     std::vector<fields::Field> fields_of(Safety& safety)
//     {
//         return {{"/safety/factor", &safety.factor, {"trial"}, "1", fields::positive(), "Factor that ..."}};
//     }

#pragma once

#include "model/statistics.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace jointcreep::fields
{

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

Limits any();
Limits positive();
Limits at_least(double least);
Limits between(double least, double most);
Limits index_of(std::string dimension);
Limits index_or_none(std::string dimension);
Limits ascending();                    // from 0 on
Limits rows_in(std::string dimension); // for "first" arrays: rows first[i] .. first[i + 1] belong to i

// What the limits ask for: "0 to 1", "index of block or -1".
std::string wanted(const Limits& limits);

// Where the values are in memory.
using Values = std::variant<std::vector<double>*, std::vector<Index>*, std::vector<Eigen::Vector2d>*,
                            std::vector<Eigen::Vector3d>*, std::vector<Eigen::Vector4d>*,
                            std::vector<std::array<Index, 2>>*, std::vector<std::array<Index, 3>>*,
                            std::vector<std::string>*, double*, Index*, std::string*>;

struct Field {
    std::string path; // of the dataset
    Values values;
    // Names, also "name+1"; none for a single value, a dataset of one element.
    std::vector<std::string> dimensions;
    std::string units; // "1" for numbers without one, and for text
    Limits limits;
    std::string description;
};

// What must hold between the values of a row, beyond the limits of each. To be asked only once the fields are
// within their limits.
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

// Fields point into a record. This gives them one that is only read, for those who do not write through a
// field.
template <class Record>
Record& reading(const Record& record)
{
    return const_cast<Record&>(record);
}

template <class Row>
void append(std::vector<Row>& rows, std::vector<Row> more)
{
    for (Row& row : more)
        rows.push_back(std::move(row));
}

// The values as one flat array, vectors spread into their components.
using Flat = std::variant<std::span<double>, std::span<Index>, std::span<std::string>>;
Flat flat(const Values& values);
std::size_t components(const Values& values); // of one row: 1 to 4
std::size_t rows(const Values& values);
void resize(const Values& values, std::size_t rows); // of an array

} // namespace jointcreep::fields
