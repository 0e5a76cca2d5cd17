#include "exchange/text.hpp"

#include "exchange/csv.hpp"
#include "model/error.hpp"
#include "model/utf8.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>

namespace jointcreep::exchange
{

std::string json_text(std::string_view text)
{
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
            std::array<char, 8> code{};
            std::snprintf(code.data(), code.size(), "\\u%04x", static_cast<unsigned>(c));
            quoted += code.data();
        } else {
            quoted += c;
        }
    }
    return quoted + '"';
}

std::string xml_text(const std::string& text)
{
    if (!is_plain_text(text))
        throw input_error("the name " + json_text(text) +
                          " has control characters, or is not UTF-8: this format cannot hold it. Rename it");
    std::string safe;
    for (const char c : text) {
        switch (c) {
        case '&':
            safe += "&amp;";
            break;
        case '<':
            safe += "&lt;";
            break;
        case '>':
            safe += "&gt;";
            break;
        case '"':
            safe += "&quot;";
            break;
        default:
            safe += c;
        }
    }
    return safe;
}

std::string without(std::string text, std::string_view forbidden, char instead)
{
    for (char& c : text)
        if (forbidden.find(c) != std::string_view::npos || static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            c = instead;
    return text;
}

const std::string& PlainNames::of(const std::string& name)
{
    const auto known = given_.find(name);
    if (known != given_.end())
        return known->second;
    std::string plain;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80 && (std::isalnum(byte) || c == '-' || c == '_'))
            plain += c;
        else if ((byte & 0xC0) != 0x80) // once a character
            plain += '_';
    }
    if (plain.empty())
        plain = "_";
    const auto upper = [](std::string text) {
        for (char& c : text)
            c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        return text;
    };
    plain.resize(std::min(plain.size(), longest_));
    std::string free = plain;
    for (int n = 2; !taken_.insert(upper(free)).second; ++n) {
        const std::string number = "_" + std::to_string(n);
        free = plain.substr(0, longest_ - number.size()) + number;
    }
    return given_[name] = free;
}

std::string place_text(const Eigen::Vector3d& place, std::string_view separator)
{
    return shown(place.x())
        .append(separator)
        .append(shown(place.y()))
        .append(separator)
        .append(shown(place.z()));
}

std::string place_text(const Eigen::Vector2d& place, std::string_view separator)
{
    return shown(place.x()).append(separator).append(shown(place.y()));
}

std::string text_of(const Attribute& attribute, std::size_t row)
{
    const std::optional<double> value = attribute.value(row);
    if (!value)
        return "";
    if (attribute.names)
        return (*attribute.names)[static_cast<std::size_t>(*value)];
    return attribute.is_integer ? std::to_string(static_cast<Index>(*value)) : shown(*value);
}

const Attribute* find_attribute(const Layer& layer, std::string_view name)
{
    const auto found = std::ranges::find(layer.attributes, name, &Attribute::name);
    return found == layer.attributes.end() ? nullptr : &*found;
}

IdOf counted_from(std::size_t first)
{
    return [first](const Layer&, std::size_t row) { return std::to_string(first + row); };
}

std::string ids_csv(std::span<const Layer> layers, const IdOf& id)
{
    constexpr std::array names = {"set", "number", "joint", "fate", "block", "rock", "stage", "realization"};
    std::string table = "id,layer";
    for (const char* name : names)
        table.append(",").append(name);
    table += '\n';
    for (const Layer& layer : layers) {
        std::array<const Attribute*, names.size()> of{};
        for (std::size_t i = 0; i < names.size(); ++i)
            of[i] = find_attribute(layer, names[i]);
        for (std::size_t row = 0; row < layer.rows(); ++row) {
            table.append(id(layer, row)).append(",").append(layer.name);
            for (const Attribute* attribute : of)
                table.append(",").append(attribute ? csv_field(text_of(*attribute, row)) : "");
            table += '\n';
        }
    }
    return table;
}

} // namespace jointcreep::exchange
