#include "model/error.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace jointcreep
{

void require(bool holds, std::string_view name, double value, std::string_view unit, std::string_view wanted)
{
    if (holds)
        return;
    std::string message(name);
    message.append(" is ").append(shown(value)).append(" ").append(unit).append("; it ").append(wanted);
    throw input_error(message);
}

std::string shown(double value)
{
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

std::string rounded(double value, int digits)
{
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
    return text.data();
}

std::string shown_time(double days)
{
    constexpr double same_time = 1e-12;
    for (int digits = 1; digits < 17; ++digits) {
        const std::string text = rounded(days, digits);
        double near = 0;
        std::from_chars(text.data(), text.data() + text.size(), near);
        if (std::abs(near - days) <= same_time * std::abs(days))
            return shown(near);
    }
    return shown(days);
}

std::string shown(const Eigen::Vector2d& place)
{
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "[%.7g, %.7g] m", place.x(), place.y());
    return text.data();
}

} // namespace jointcreep
