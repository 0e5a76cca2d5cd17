// Names and numbers as the formats of other programs can have them. Inside libs/exchange only.

#pragma once

#include "exchange/layers.hpp"

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace jointcreep::exchange
{

// A text in double quotes as JSON has it; Python reads the same.
std::string json_text(std::string_view text);

// A text as the value of an attribute of XML, without quotes around it. Throws input_error where it has control
// characters or is not UTF-8, which XML cannot have.
std::string xml_text(const std::string& text);

// A text without the characters of `forbidden` and without line breaks: each becomes `instead`.
std::string without(std::string text, std::string_view forbidden, char instead);

// Names of letters, digits, - and _ alone, at most so long, each given out for one name only (upper and lower case
// are the same); where two would be alike, the second has a number behind it.
class PlainNames
{
public:
    explicit PlainNames(std::size_t longest) : longest_(longest) {}
    const std::string& of(const std::string& name);
    const std::map<std::string, std::string>& all() const { return given_; }

private:
    std::size_t longest_;
    std::map<std::string, std::string> given_;
    std::set<std::string> taken_; // in upper case
};

// "x y z" with a separator, each number so that it reads back as the same double.
std::string place_text(const Eigen::Vector3d& place, std::string_view separator);
std::string place_text(const Eigen::Vector2d& place, std::string_view separator);

// The value of an attribute of a row as text; empty where there is none.
std::string text_of(const Attribute& attribute, std::size_t row);

// The attribute of a layer with this name, or null.
const Attribute* find_attribute(const Layer& layer, std::string_view name);

// A table of what the lines and polygons of a file are, for formats that cannot say it: id, layer, set, number,
// joint, fate, block, rock, stage, realization. The id of a row of a layer is asked for once, in their order.
using IdOf = std::function<std::string(const Layer&, std::size_t row)>;
std::string ids_csv(std::span<const Layer> layers, const IdOf& id);

// Ids that count rows from `first`, in each layer anew.
IdOf counted_from(std::size_t first);

} // namespace jointcreep::exchange
