#include "scene/shorthand.hpp"

#include "model/units.hpp"
#include "scene/scene_keys.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <variant>
#include <vector>

namespace jointcreep::scene
{
namespace
{

using namespace keys;
using Point = Eigen::Vector2d;

constexpr std::int64_t usual_sides = 32, most_sides = 1000; // of a whole circle

// Functions of a formula. Those of angles have a d, for degrees, in their names.
struct Function {
    std::string_view name;
    std::size_t least, most; // how many values it has
    double (*of)(const std::vector<double>&);
};
constexpr std::size_t most_values = 20;
const std::vector<Function>& functions()
{
    using Values = const std::vector<double>&;
    static const std::vector<Function> all{
        {"abs", 1, 1, [](Values x) { return std::abs(x[0]); }},
        {"exp", 1, 1, [](Values x) { return std::exp(x[0]); }},
        {"ln", 1, 1, [](Values x) { return std::log(x[0]); }},
        {"sqrt", 1, 1, [](Values x) { return std::sqrt(x[0]); }},
        {"sind", 1, 1, [](Values x) { return std::sin(x[0] * unit::deg); }},
        {"cosd", 1, 1, [](Values x) { return std::cos(x[0] * unit::deg); }},
        {"tand", 1, 1, [](Values x) { return std::tan(x[0] * unit::deg); }},
        {"atand", 1, 1, [](Values x) { return std::atan(x[0]) / unit::deg; }},
        {"min", 2, most_values, [](Values x) { return *std::ranges::min_element(x); }},
        {"max", 2, most_values, [](Values x) { return *std::ranges::max_element(x); }}};
    return all;
}

// Numbers by name, and formulas of them.
class Variables
{
public:
    Variables(const TomlValue& root, const Reading& reading)
        : table_(root.find("variables")), reading_(reading)
    {
    }

    // Of a number, or of a text such as "H", "2 * H + 3" or "max(a, b) / 2". `title` is what messages call the key.
    double value_of(const TomlValue& written, const std::string& title)
    {
        if (const auto* const whole = std::get_if<std::int64_t>(&written.content))
            return static_cast<double>(*whole);
        if (const auto* const number = std::get_if<double>(&written.content)) {
            if (!std::isfinite(*number))
                refuse(written, title, "expected a finite number");
            return *number;
        }
        const auto* const text = std::get_if<std::string>(&written.content);
        if (!text)
            refuse(written, title, "expected a number, or a text with names of [variables]");
        Sum sum{*this, written, title, *text};
        const double value = sum.read();
        if (!std::isfinite(value))
            refuse(written, title, "its value is not a finite number");
        return value;
    }

    [[noreturn]] void refuse(const TomlValue& at, const std::string& title, const std::string& what) const
    {
        Place{reading_, ""}.refuse(at.line, title + " = " + shown(at) + ": " + what);
    }

    // Values of all of them, used or not.
    void check()
    {
        if (!table_)
            return;
        const auto* const entries = std::get_if<TomlValue::Table>(&table_->content);
        if (!entries)
            Place{reading_, ""}.refuse(table_->line,
                                       "variables is " + shown(*table_) + ": expected a table [variables]");
        for (const TomlEntry& entry : *entries) {
            const bool is_name = !entry.key.empty() && std::ranges::all_of(entry.key, is_of_name) &&
                                 !is_digit(entry.key.front()) && entry.key.front() != '_';
            if (!is_name)
                refuse(entry.value, "[variables] " + shown(TomlValue{.content = entry.key}),
                       "expected a name of letters, digits and _ that begins with a letter");
            named(entry.key, entry.value, "[variables] " + entry.key);
        }
    }

private:
    const TomlValue* table_;
    const Reading& reading_;
    std::map<std::string, double, std::less<>> known_{};
    std::vector<std::string> open_{}; // whose value is being found

    static bool is_digit(char c) { return c >= '0' && c <= '9'; }
    static bool is_of_name(char c)
    {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_';
    }

    double named(const std::string& name, const TomlValue& at, const std::string& title)
    {
        if (const auto found = known_.find(name); found != known_.end())
            return found->second;
        const TomlValue* const value = table_ ? table_->find(name) : nullptr;
        if (!value) {
            std::vector<std::string> names;
            if (const auto* const entries =
                    table_ ? std::get_if<TomlValue::Table>(&table_->content) : nullptr)
                for (const TomlEntry& entry : *entries)
                    names.push_back(entry.key);
            const std::string meant = nearest(name, names);
            refuse(at, title,
                   "[variables] has no " + name + (meant.empty() ? "" : "; did you mean " + meant + "?") +
                       " (A number is written without quotes)");
        }
        if (std::ranges::find(open_, name) != open_.end())
            refuse(at, title, "the value of " + name + " depends on itself");
        constexpr std::size_t deepest = 50; // variables whose values are needed for each other
        if (open_.size() >= deepest)
            refuse(at, title, "the value of " + name + " is nested too deep in other variables");
        open_.push_back(name);
        const double number = value_of(*value, "[variables] " + name);
        open_.pop_back();
        known_[name] = number;
        return number;
    }

    // sum = product {(+|-) product}, product = factor {(*|/) factor}, factor = -factor | power,
    // power = value [^ factor], value = number | name | (sum) | function(sum {, sum})
    struct Sum {
        Variables& variables;
        const TomlValue& at;
        const std::string& title;
        std::string_view rest;
        int depth = 0;

        [[noreturn]] void refuse(const std::string& what) const { variables.refuse(at, title, what); }

        char next()
        {
            rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
            return rest.empty() ? '\0' : rest.front();
        }
        bool takes(char c)
        {
            if (next() != c)
                return false;
            rest.remove_prefix(1);
            return true;
        }
        double read()
        {
            const double value = sum();
            if (next() != '\0')
                refuse(
                    "\"" + std::string(rest) +
                    "\" is no part of a formula of numbers and names of [variables], such as \"2 * H + 3\"");
            return value;
        }
        double sum()
        {
            double value = product();
            for (;;)
                if (takes('+'))
                    value += product();
                else if (takes('-'))
                    value -= product();
                else
                    return value;
        }
        double product()
        {
            double value = factor();
            for (;;)
                if (takes('*'))
                    value *= factor();
                else if (takes('/'))
                    value /= factor();
                else
                    return value;
        }
        double factor()
        {
            constexpr int deepest = 100;
            if (++depth > deepest)
                refuse("it is nested too deep");
            const double value = factor_inside();
            --depth;
            return value;
        }
        double factor_inside()
        {
            if (takes('-'))
                return -factor();
            const double base = value();
            return takes('^') ? finite(std::pow(base, factor()), "a power in it") : base;
        }
        // A comparison in min() and max() would hide one that is not.
        double finite(double value, const std::string& what) const
        {
            if (!std::isfinite(value))
                refuse(what + " is not a finite number");
            return value;
        }
        double value()
        {
            if (takes('(')) {
                const double value = sum();
                if (!takes(')'))
                    refuse("a ( without its )");
                return value;
            }
            if (is_digit(next()) || next() == '.') {
                double number = 0;
                const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
                if (error != std::errc())
                    refuse("\"" + std::string(rest) + "\" does not begin with a number");
                rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
                return number;
            }
            const auto last = std::ranges::find_if_not(rest, is_of_name);
            const std::string name(rest.begin(), last);
            if (name.empty())
                refuse(rest.empty() ? "a number or a name of [variables] is missing at its end"
                                    : "\"" + std::string(rest) +
                                          "\" does not begin with a number or a name of [variables]");
            rest.remove_prefix(name.size());
            return takes('(') ? called(name) : variables.named(name, at, title);
        }
        // After the function's "(".
        double called(const std::string& name)
        {
            const auto found = std::ranges::find(functions(), name, &Function::name);
            if (found == functions().end()) {
                std::string names;
                for (const Function& one : functions())
                    names += (names.empty() ? "" : ", ") + std::string(one.name);
                refuse("there is no function " + name + "; expected one of " + names +
                       " (the d is for degrees)");
            }
            std::vector<double> values;
            do
                values.push_back(finite(sum(), "a value of " + name));
            while (values.size() < most_values && takes(','));
            if (!takes(')'))
                refuse(next() == ',' ? name + " has too many values" : "a ( without its )");
            if (values.size() < found->least || values.size() > found->most)
                refuse(name + " has " + std::to_string(values.size()) + " values; expected " +
                       (found->most == 1 ? "one" : "two or more"));
            return finite(found->of(values), name + " of " + shown(values.front()));
        }
    };
};

// To a nanometre, so that a corner at 1 is not written as 0.9999999999999998.
std::string text_of(const Point& point)
{
    const auto rounded = [](double metres) { return std::round(metres * 1e9) / 1e9 + 0.0; };
    return "[" + shown(rounded(point.x())) + ", " + shown(rounded(point.y())) + "]";
}

// The centre of the circle through three points; not finite where they are on a line.
Point centre_of(const Point& a, const Point& b, const Point& c)
{
    const Point u = b - a, v = c - a;
    const double twice = 2 * (u.x() * v.y() - u.y() * v.x());
    return a + Point(v.y() * u.squaredNorm() - u.y() * v.squaredNorm(),
                     u.x() * v.squaredNorm() - v.x() * u.squaredNorm()) /
                   twice;
}

// A whole number has no exponent, which would make it one that is not whole in TOML.
std::string text_of(double value)
{
    constexpr double largest_whole = 9007199254740992; // 2^53
    return value == std::round(value) && std::abs(value) <= largest_whole
               ? std::to_string(std::llround(value))
               : shown(value);
}

class Writer
{
public:
    Writer(const std::string& text, const std::string& name)
        : text_(text), root_(parse_toml(text, name)), reading_{.name = name, .whole = "scene"},
          variables_(root_, reading_)
    {
    }

    std::string written_out()
    {
        variables_.check();
        for (const Part<Scene>& part : scene_parts())
            if (part.info.written != Written::inside)
                for_each_table(part.info.name.empty() ? root_ : or_nothing(root_.find(part.info.name)),
                               [&](const TomlValue& table) { write_table(table, part); });
        std::ranges::sort(changes_, {}, &Change::first);
        std::string out;
        std::size_t at = 0;
        for (const Change& change : changes_) {
            out += text_.substr(at, change.first - at) + change.text;
            at = change.past;
        }
        return out + text_.substr(at);
    }

private:
    struct Change {
        std::size_t first, past; // [byte]
        std::string text;
    };
    const std::string& text_;
    TomlValue root_;
    Reading reading_;
    Variables variables_;
    std::vector<Change> changes_{};

    static const TomlValue& or_nothing(const TomlValue* value)
    {
        static const TomlValue nothing{};
        return value ? *value : nothing;
    }

    // A table, or all of a list.
    template <class Use>
    static void for_each_table(const TomlValue& value, Use use)
    {
        if (const auto* const list = std::get_if<TomlValue::List>(&value.content))
            for (const TomlValue& one : *list)
                use(one);
        else
            use(value);
    }

    // In place of a value; the lines that it took stay.
    void change(const TomlValue& value, std::string by)
    {
        const auto lines = std::count(text_.begin() + static_cast<std::ptrdiff_t>(value.first),
                                      text_.begin() + static_cast<std::ptrdiff_t>(value.past), '\n');
        changes_.push_back(
            {value.first, value.past, std::move(by) + std::string(static_cast<std::size_t>(lines), '\n')});
    }

    void write_table(const TomlValue& table, const Part<Scene>& part)
    {
        for (const KeyInfo& key : part.keys)
            if (const TomlValue* const value = table.find(key.name))
                write_key(*value, key, part);
    }

    void write_key(const TomlValue& value, const KeyInfo& key, const Part<Scene>& part)
    {
        const std::string title = part.info.shown() + " " + key.name;
        static const std::set<std::string> of_numbers{"number", "integer", "date",
                                                      "point",  "poles",   "load history"};
        if (of_numbers.contains(key.kind))
            write_numbers(value, title, key.kind == "date");
        else if (key.kind == "polygon" || key.kind == "polyline")
            write_corners(value, title, key.kind == "polygon");
        else if (key.kind == "polygons") {
            if (const auto* const list = std::get_if<TomlValue::List>(&value.content))
                for (const TomlValue& one : *list)
                    write_corners(one, title, true);
        } else
            for (const Part<Scene>& inside : scene_parts())
                if (inside.info.written == Written::inside &&
                    inside.info.name == part.info.name + "." + key.name)
                    for_each_table(value, [&](const TomlValue& table) { write_table(table, inside); });
    }

    // With a name, or a sum of numbers. The reader of the key refuses other texts, as a number or a date in quotes.
    static bool is_sum(const std::string& text, bool is_date)
    {
        return std::ranges::any_of(text,
                                   [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }) ||
               (!is_date && (text.find_first_of("+*/^(") != text.npos || text.find(" - ") != text.npos));
    }

    // Texts in it, at any depth.
    void write_numbers(const TomlValue& value, const std::string& title, bool is_date)
    {
        if (const auto* const list = std::get_if<TomlValue::List>(&value.content))
            for (const TomlValue& one : *list)
                write_numbers(one, title, is_date);
        else if (const auto* const text = std::get_if<std::string>(&value.content);
                 text && is_sum(*text, is_date))
            change(value, text_of(variables_.value_of(value, title)));
    }

    // --- Circles and arcs ----------------------------------------------------------------------------------

    const TomlValue& key_of(const TomlValue& shape, std::string_view key, const std::string& title,
                            const std::string& wanted) const
    {
        const TomlValue* const value = shape.find(key);
        if (!value)
            variables_.refuse(shape, title, "has no " + std::string(key) + ": expected " + wanted);
        return *value;
    }

    Point point_of(const TomlValue& value, const std::string& title)
    {
        const auto* const list = std::get_if<TomlValue::List>(&value.content);
        if (!list || list->size() != 2)
            variables_.refuse(value, title, "expected a point [x, y]");
        return {variables_.value_of(list->front(), title), variables_.value_of(list->back(), title)};
    }

    // Of a whole circle, or of an arc of that share of one.
    std::int64_t sides_of(const TomlValue& shape, const std::string& title, double share)
    {
        const TomlValue* const given = shape.find("sides");
        if (!given)
            return std::max<std::int64_t>(
                share < 1 ? 2 : 3, std::llround(std::ceil(static_cast<double>(usual_sides) * share - 1e-6)));
        const double sides = variables_.value_of(*given, title + " sides");
        const double least = share < 1 ? 1 : 3;
        if (!(sides >= least && sides <= most_sides) || sides != std::round(sides))
            variables_.refuse(*given, title + " sides",
                              "expected a whole number from " + shown(least) + " to " +
                                  std::to_string(most_sides));
        return std::llround(sides);
    }

    void check_keys_of(const TomlValue& shape, const std::string& title,
                       const std::vector<std::string>& known, const std::string& wanted) const
    {
        for (const TomlEntry& entry : std::get<TomlValue::Table>(shape.content))
            if (std::ranges::find(known, entry.key) == known.end())
                variables_.refuse(shape, title, "has a key " + entry.key + ": expected " + wanted);
    }

    void write_circle(const TomlValue& circle, const std::string& title)
    {
        const std::string wanted = "a circle { center_m = [x, y], radius_m = r }, with sides = n if needed";
        check_keys_of(circle, title, {"center_m", "radius_m", "sides"}, wanted);
        const Point center = point_of(key_of(circle, "center_m", title, wanted), title + " center_m");
        const TomlValue& written = key_of(circle, "radius_m", title, wanted);
        const double radius = variables_.value_of(written, title + " radius_m");
        if (!(radius > 0))
            variables_.refuse(written, title + " radius_m", "expected a radius above 0 m");
        const std::int64_t sides = sides_of(circle, title, 1);
        std::string corners;
        for (std::int64_t i = 0; i < sides; ++i)
            corners += (i ? ", " : "") +
                       text_of(center + radius * direction(2 * std::numbers::pi * static_cast<double>(i) /
                                                           static_cast<double>(sides)));
        change(circle, "[" + corners + "]");
    }

    static Point direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

    // From the corner before it through one point to another, which is left out where it is the polygon's first corner.
    // Returns it.
    Point write_arc(const TomlValue& arc, const Point& from, const std::string& title,
                    const std::optional<Point>& first)
    {
        const std::string wanted = "an arc { through_m = [x, y], to_m = [x, y] }, with sides = n if needed";
        check_keys_of(arc, title, {"through_m", "to_m", "sides"}, wanted);
        const Point through = point_of(key_of(arc, "through_m", title, wanted), title + " through_m");
        Point to = point_of(key_of(arc, "to_m", title, wanted), title + " to_m");
        const Point center = centre_of(from, through, to);
        const double radius = (from - center).norm();
        if (!(radius < 1e4 * ((through - from).norm() + (to - through).norm())))
            variables_.refuse(arc, title,
                              "its three points " + text_of(from) + ", " + text_of(through) + " and " +
                                  text_of(to) + " are on a straight line; expected an arc, or corners");
        const auto angle = [&](const Point& p) { return std::atan2((p - center).y(), (p - center).x()); };
        const auto turned = [](double by) { return by < 0 ? by + 2 * std::numbers::pi : by; };
        const double begin = angle(from), whole = turned(angle(to) - begin);
        const bool counter_clockwise = turned(angle(through) - begin) < whole;
        const double sweep = counter_clockwise ? whole : whole - 2 * std::numbers::pi;
        const std::int64_t sides = sides_of(arc, title, std::abs(sweep) / (2 * std::numbers::pi));
        std::string corners;
        for (std::int64_t i = 1; i < sides; ++i)
            corners += (i > 1 ? ", " : "") +
                       text_of(center + radius * direction(begin + sweep * static_cast<double>(i) /
                                                                       static_cast<double>(sides)));
        if (to != first || corners.empty())
            corners += (corners.empty() ? "" : ", ") + text_of(to);
        change(arc, corners);
        return to;
    }

    void write_corners(const TomlValue& value, const std::string& title, bool may_be_circle)
    {
        if (std::holds_alternative<TomlValue::Table>(value.content) && may_be_circle)
            return write_circle(value, title);
        const auto* const list = std::get_if<TomlValue::List>(&value.content);
        if (!list)
            return;
        std::optional<Point> first, before;
        for (const TomlValue& corner : *list) {
            if (!std::holds_alternative<TomlValue::Table>(corner.content)) {
                write_numbers(corner, title, false);
                const auto* const pair = std::get_if<TomlValue::List>(&corner.content);
                if (pair && pair->size() == 2)
                    before = point_of(corner, title);
                if (!first)
                    first = before;
            } else if (before)
                before = write_arc(corner, *before, title,
                                   may_be_circle && &corner == &list->back() ? first : std::nullopt);
            else
                variables_.refuse(corner, title, "expected a corner before the first arc, where it begins");
        }
    }
};

} // namespace

std::string written_out(const std::string& text, const std::string& name)
{
    const auto has = [&](const char* word) { return text.find(word) != std::string::npos; };
    bool has_sum = false; // perhaps: a text that begins as one without names
    for (std::size_t at = text.find('"'); at != std::string::npos && !has_sum; at = text.find('"', at + 1))
        has_sum = at + 1 < text.size() &&
                  std::string_view("0123456789.(-").find(text[at + 1]) != std::string_view::npos;
    has_sum = has_sum || std::ranges::any_of(functions(), [&](const Function& one) {
                  return has((std::string(one.name) + "(").c_str());
              });
    if (!has_sum && !has("variables") && !has("center") && !has("radius") && !has("through"))
        return text;
    return Writer(text, name).written_out();
}

} // namespace jointcreep::scene
