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
    Scaled scaled;
};
constexpr std::array<Name, 4> names{{{"kelvin-stiffness", "Kelvin stiffness E", Scaled::kelvin_stiffness},
                                     {"kelvin-viscosity", "Kelvin viscosity eta", Scaled::kelvin_viscosity},
                                     {"joint-stiffness", "joint stiffness K", Scaled::joint_stiffness},
                                     {"horizontal-stress", "horizontal stress", Scaled::horizontal_stress}}};

const Name& name_of(Scaled scaled)
{
    return *std::find_if(names.begin(), names.end(), [&](const Name& name) { return name.scaled == scaled; });
}

std::string trimmed(const std::string& text)
{
    const std::size_t begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
    return begin == std::string::npos ? std::string() : text.substr(begin, end - begin + 1);
}

Scaled scaled_by(const std::string& option)
{
    const auto name =
        std::find_if(names.begin(), names.end(), [&](const Name& n) { return n.option == option; });
    if (name == names.end())
        throw input_error("--fit: \"" + option + "\" is none of " + all_options(", "));
    return name->scaled;
}

// The search starts from 1, or from the geometric mean of the bounds if 1 is outside them.
void set_bounds(back_analysis::Factor& factor, const std::string& option, const std::string& text)
{
    double low = 0, high = 0;
    char colon = 0, rest = 0;
    std::istringstream bounds(text);
    if (!(bounds >> low >> colon >> high) || colon != ':' || bounds >> rest || !(low > 0) || !(low < high) ||
        low < 1e-6 || high > 1e6)
        throw input_error("--fit: the bounds of " + option + " are \"" + text +
                          "\"; wanted two factors LOW:HIGH with 1e-6 <= LOW < HIGH <= 1e6");
    factor.low = low;
    factor.high = high;
    factor.start = low <= 1 && 1 <= high ? 1 : std::sqrt(low * high);
}

} // namespace

std::string option_of(Scaled scaled)
{
    return std::string(name_of(scaled).option);
}

std::string words_of(Scaled scaled)
{
    return std::string(name_of(scaled).words);
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
                                  ? "--fit is empty; wanted one factor at least"
                                  : "--fit: \"" + text + "\" has nothing before or after a comma");
        const std::size_t equals = item.find('=');
        const std::string option = trimmed(item.substr(0, equals));
        back_analysis::Factor factor{scaled_by(option)};
        for (const back_analysis::Factor& other : factors)
            if (other.scaled == factor.scaled)
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
        words += (i > 0 ? ", " : "") + option_of(factors[i].scaled) + ' ' + rounded(values[i]);
    return words;
}

} // namespace jointcreep::creepfit
