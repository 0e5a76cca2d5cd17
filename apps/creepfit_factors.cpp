#include "creepfit_factors.hpp"

#include "creepfit_words.hpp"

#include "model/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

namespace jointcreep::creepfit
{

namespace
{

struct Name {
    std::string_view option, words;
    Scaled::Quantity scaled;
};
constexpr std::array<Name, 4> names{{{"kelvin-stiffness", "Kelvin stiffness E", Scaled::kelvin_stiffness},
                                     {"kelvin-viscosity", "Kelvin viscosity eta", Scaled::kelvin_viscosity},
                                     {"joint-stiffness", "joint stiffness K", Scaled::joint_stiffness},
                                     {"horizontal-stress", "horizontal stress", Scaled::horizontal_stress}}};

const Name& name_of(const Scaled& scaled)
{
    return *std::find_if(names.begin(), names.end(),
                         [&](const Name& name) { return name.scaled == scaled.quantity; });
}

std::string trimmed(const std::string& text)
{
    const std::size_t begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
    return begin == std::string::npos ? std::string() : text.substr(begin, end - begin + 1);
}

constexpr std::array<std::string_view, 2> directions{"normal-", "shear-"};

// A factor of the name, with its direction and material.
back_analysis::Factor factor_by(const std::string& option)
{
    back_analysis::Factor factor;
    const std::size_t at = option.find('@');
    std::string_view name = std::string_view(option).substr(0, at);
    for (int direction = 0; direction < 2; ++direction)
        if (name.starts_with(directions[static_cast<std::size_t>(direction)])) {
            factor.scaled.direction = direction;
            name.remove_prefix(directions[static_cast<std::size_t>(direction)].size());
            break;
        }
    if (at != std::string::npos && (factor.material = option.substr(at + 1)).empty())
        throw input_error("--fit: \"" + option + "\" has no joint material behind @");
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const Name& n) { return n.option == name; });
    const bool is_of_joints = factor.scaled.direction != Scaled::both || !factor.material.empty();
    if (found == names.end() || (is_of_joints && found->scaled == Scaled::horizontal_stress))
        throw input_error("--fit: \"" + option + "\" is none of " + all_options(", ") +
                          "; those of joints may have normal- or shear- before them and @MATERIAL behind");
    factor.scaled.quantity = found->scaled;
    return factor;
}

// "LOW:HIGH", or "LOW:START:HIGH".
void set_bounds(back_analysis::Factor& factor, const std::string& option, const std::string& text)
{
    std::vector<double> numbers;
    std::istringstream bounds(text);
    char colon = ':', rest = 0;
    for (double number = 0; colon == ':' && numbers.size() < 3 && bounds >> number;) {
        numbers.push_back(number);
        if (!(bounds >> colon))
            colon = 0;
    }
    const double low = numbers.empty() ? 0 : numbers.front(), high = numbers.empty() ? 0 : numbers.back();
    if (numbers.size() < 2 || colon != 0 || bounds >> rest || !(low < high) || low < 1e-6 || high > 1e6)
        throw input_error("--fit: the bounds of " + option + " are \"" + text +
                          "\"; expected two factors LOW:HIGH with 1e-6 <= LOW < HIGH <= 1e6, perhaps "
                          "LOW:START:HIGH");
    factor.low = low;
    factor.high = high;
    factor.start = numbers.size() == 3 ? numbers[1] : usual_start(low, high);
    if (factor.start < low || factor.start > high)
        throw input_error("--fit: the start of " + option + " is outside its bounds, \"" + text + '"');
}

} // namespace

double usual_start(double low, double high)
{
    return low <= 1 && 1 <= high ? 1 : std::sqrt(low * high);
}

std::string option_of(const back_analysis::Factor& factor)
{
    const int direction = factor.scaled.direction;
    return std::string(direction == Scaled::both ? "" : directions[static_cast<std::size_t>(direction)]) +
           std::string(name_of(factor.scaled).option) +
           (factor.material.empty() ? "" : '@' + factor.material);
}

std::string words_of(const back_analysis::Factor& factor)
{
    const int direction = factor.scaled.direction;
    return std::string(direction == Scaled::both ? ""
                       : direction == 0          ? "normal "
                                                 : "shear ") +
           std::string(name_of(factor.scaled).words) +
           (factor.material.empty() ? "" : " of " + factor.material);
}

std::string all_options(const std::string& last)
{
    std::string all;
    for (std::size_t i = 0; i < names.size(); ++i)
        all += (i == 0 ? "" : i + 1 < names.size() ? ", " : last) + std::string(names[i].option);
    return all;
}

Factors factors_in(const std::string& text)
{
    Factors factors;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string item = trimmed(text.substr(begin, end - begin));
        begin = end + 1;
        if (item.empty())
            throw input_error(trimmed(text).empty()
                                  ? "--fit is empty; expected one factor at least"
                                  : "--fit: \"" + text + "\" has nothing before or after a comma");
        const std::size_t equals = item.find('=');
        const std::string option = trimmed(item.substr(0, equals));
        back_analysis::Factor factor = factor_by(option);
        for (const back_analysis::Factor& other : factors)
            if (other.scaled == factor.scaled && other.material == factor.material)
                throw input_error("--fit: " + option + " is given twice");
        if (equals != std::string::npos)
            set_bounds(factor, option, item.substr(equals + 1));
        factors.push_back(factor);
    }
    return factors;
}

std::string in_words(const Factors& factors, const std::vector<double>& values)
{
    std::string words;
    for (std::size_t i = 0; i < factors.size(); ++i)
        words += (i > 0 ? ", " : "") + option_of(factors[i]) + ' ' + rounded(values[i]);
    return words;
}

} // namespace jointcreep::creepfit
