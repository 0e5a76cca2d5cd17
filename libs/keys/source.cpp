#include "keys/source.hpp"

#include "keys/polygon.hpp"

#include <map>

namespace jointcreep::keys
{
namespace
{

constexpr std::size_t most_names_shown = 10;

} // namespace

std::string Given::told(const std::string& key, const std::string& what) const
{
    const TomlValue* const value = find(key);
    return title + (value ? " " + key + " = " + shown(*value) : " has no " + key) + ": " + what;
}

std::int64_t Given::line_of(const std::string& key) const
{
    const TomlValue* const value = find(key);
    return value ? value->line : table.line;
}

void Given::refuse(const std::string& key, const std::string& what) const
{
    Place{reading, title}.refuse(line_of(key), told(key, what));
}

void Given::report(const std::string& key, const std::string& what) const
{
    attempt(reading, [&] { refuse(key, what); });
}

Given Source::once(const std::string& table) const
{
    const TomlValue* const value = root.find(table);
    return {reading, value ? *value : root, "[" + table + "]"};
}

Given Source::in_list(const std::string& table, std::size_t i) const
{
    const TomlValue& value = std::get<TomlValue::List>(root.find(table)->content)[i];
    const TomlValue* const own_name = value.find("name");
    return {reading, value, "[[" + table + "]]" + (own_name ? " " + shown(*own_name) : "")};
}

void Source::check_unique(const std::vector<std::string>& tables) const
{
    std::map<std::string, std::int64_t> line_of;
    for (const std::string& table : tables) {
        const TomlValue* const list = root.find(table);
        const std::size_t count = list ? std::get<TomlValue::List>(list->content).size() : 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Given given = in_list(table, i);
            const TomlValue& name = *given.find("name");
            const auto [other, is_new] = line_of.try_emplace(std::get<std::string>(name.content), name.line);
            if (!is_new)
                given.report("name", "the name is taken in line " + std::to_string(other->second));
        }
    }
}

void check_reference(const Given& given, const std::string& key, const std::string& name,
                     const std::set<std::string>& known, const std::string& what)
{
    if (known.contains(name))
        return;
    if (known.empty())
        return given.report(key, "there is no " + what);
    std::string all;
    std::size_t shown_names = 0;
    for (const auto& one : known)
        if (shown_names++ < most_names_shown)
            all += (all.empty() ? "\"" : ", \"") + one + '"';
    if (known.size() > most_names_shown)
        all += ", ...";
    const auto meant = nearest(name, {known.begin(), known.end()});
    const TomlValue* const value = given.find(key);
    const bool is_in_list = value && std::holds_alternative<TomlValue::List>(value->content);
    given.report(key, (is_in_list ? "has \"" + name + "\"; " : "") + "expected the name of a " + what + ": " +
                          all + (meant.empty() ? "" : "; did you mean \"" + meant + "\"?"));
}

void check_polygon(const Given& given, const std::string& key, const Polygon& polygon)
{
    if (const auto fault = polygon_fault(polygon); !fault.empty())
        given.refuse(key, fault + "; expected a simple polygon of at least 3 corners, not closed");
}

} // namespace jointcreep::keys
