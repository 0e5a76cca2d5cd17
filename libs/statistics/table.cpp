#include "statistics/statistics.hpp"

#include "model/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace jointcreep::statistics
{

namespace
{

std::string number(double value, const std::string& unit)
{
    const bool is_count = unit == "1" && std::abs(value) < 1e15 && value == std::round(value);
    if (is_count) {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), "%.0f", value);
        return text.data();
    }
    return rounded(unit == "rad" ? value * 180 / std::numbers::pi : value);
}

std::string shown_unit(const std::string& unit)
{
    return unit == "rad" ? "deg" : unit == "1" ? "" : unit;
}

// In letters, not in bytes of UTF-8.
std::size_t width_of(const std::string& text)
{
    return static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

using Cells = std::array<std::string, 9>;

Cells cells_of(const Statistics& rows, std::size_t row)
{
    const std::string& unit = rows.unit[row];
    const bool is_law = rows.has_target[row] == 0 && rows.quantity[row].ends_with(", law");
    Cells cells{rows.quantity[row], shown_unit(unit)};
    if (rows.has_target[row] == 1)
        cells[2] = number(rows.target[row], unit);
    if (!is_law || rows.is_tested[row] == 1)
        cells[3] = (is_law ? "D " : "") + number(rows.achieved[row], unit);
    if (rows.has_interval[row] == 1) {
        cells[4] = number(rows.low[row], unit);
        cells[5] = number(rows.high[row], unit);
    }
    cells[6] = std::to_string(rows.sample_size[row]);
    if (rows.is_tested[row] == 1)
        cells[7] = number(rows.p_value[row], "1");
    static const std::array<std::string, 4> verdicts = {"", "too few", "pass", "FAIL"};
    cells[8] = verdicts.at(static_cast<std::size_t>(rows.verdict[row]));
    return cells;
}

} // namespace

std::string table(const Statistics& rows)
{
    const std::string percent = number(100 * rows.confidence, "1") + "%";
    std::vector<Cells> lines = {{"", "unit", "target", "achieved", percent + " from", "to", "n", "p", ""}};
    for (std::size_t row = 0; row < rows.quantity.size(); ++row)
        lines.push_back(cells_of(rows, row));
    std::array<std::size_t, 9> widths{};
    for (const Cells& line : lines)
        for (std::size_t c = 0; c < line.size(); ++c)
            widths.at(c) = std::max(widths.at(c), width_of(line.at(c)));

    std::string text;
    const auto print = [&](const Cells& line) {
        std::string shown = "  ";
        for (std::size_t c = 0; c < line.size(); ++c) {
            const std::string gap(widths.at(c) - width_of(line.at(c)), ' ');
            const bool is_left = c < 2 || c == 8;
            shown += (is_left ? line.at(c) + gap : gap + line.at(c)) + "  ";
        }
        shown.erase(shown.find_last_not_of(' ') + 1);
        text += shown + "\n";
    };
    print(lines[0]);
    for (std::size_t row = 0; row < rows.quantity.size(); ++row) {
        if (row == 0 || rows.subject[row] != rows.subject[row - 1])
            text += rows.subject[row] + "\n";
        print(lines[row + 1]);
    }
    const auto count = [&](Verdict verdict) {
        return std::count(rows.verdict.begin(), rows.verdict.end(), static_cast<Index>(verdict));
    };
    text += "\n" + std::to_string(count(Verdict::pass)) + " pass, " + std::to_string(count(Verdict::fail)) +
            " fail, " + std::to_string(count(Verdict::too_few)) +
            " without verdict (sample too small). A network that follows its laws fails anywhere with a "
            "probability of " +
            number(100 * rows.false_alarm_rate, "1") + "% at most.\n";
    return text;
}

std::string left_out(const Scene& scene)
{
    std::string text;
    const auto add = [&](const std::string& name, const std::string& why) {
        text += (text.empty() ? "not looked at: \"" : "; \"") + name + "\" (" + why + ")";
    };
    for (const JointSet& set : scene.joint_sets)
        if (!set.rocks.empty())
            add(set.name, "in some rocks only");
    for (const MappedSet& mapped : scene.mapped)
        add(mapped.name, "mapped");
    return text.empty() ? text : text + "\n";
}

} // namespace jointcreep::statistics
