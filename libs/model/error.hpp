// How a program refuses: one exception a kind, each with its exit code (docs/programs.md).

#pragma once

#include <Eigen/Core>

#include <stdexcept>
#include <string>
#include <string_view>

namespace jointcreep
{

// The command line, the scene or an input file is not what was wanted: exit code 2.
struct input_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// No equilibrium was found: exit code 3.
struct equilibrium_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// A file could not be read or written: exit code 4.
struct file_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Refuses a value by name: require(k > 0, "normal stiffness", k, "Pa/m", "must be positive").
void require(bool holds, std::string_view name, double value, std::string_view unit, std::string_view wanted);

// A place [m] as it is shown in messages, to seven digits: "[22.64951, 67.38134] m".
std::string shown(const Eigen::Vector2d& place);

// A number as it is shown in messages: the shortest text that reads back as the same double.
std::string shown(double value);

// A time without the digits that rounding leaves, 3 for 3.0000000000000004: the shortest decimal within 1e-12 of it.
std::string shown_time(double days);

// A computed number as it is shown in messages: rounded to so many digits.
std::string rounded(double value, int digits = 4);

} // namespace jointcreep
