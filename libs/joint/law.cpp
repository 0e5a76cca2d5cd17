#include "joint/law.hpp"

#include <algorithm>
#include <utility>

namespace jointcreep::joint
{

namespace
{

// The result of `answer` for the type of each law.
template <class Answer, std::size_t... Places>
auto of_each(const Answer& answer, std::index_sequence<Places...>)
{
    return std::vector{answer(std::type_identity<std::variant_alternative_t<Places, Law>>())...};
}
constexpr auto places = std::make_index_sequence<std::variant_size_v<Law>>();

} // namespace

const std::vector<LawInfo>& laws()
{
    static const auto all = of_each([](auto type) { return decltype(type)::type::info(); }, places);
    return all;
}

const std::vector<Parameter>& all_parameters()
{
    static const std::vector<Parameter> all = [] {
        std::vector<Parameter> found;
        for (const LawInfo& law : laws())
            for (const Parameter& one : law.parameters)
                if (std::ranges::none_of(found,
                                         [&](const Parameter& other) { return other.name == one.name; }))
                    found.push_back(one);
        return found;
    }();
    return all;
}

Law law_of(Index law, const ValueOf& value, double strength_divisor)
{
    using Make = Law (*)(const ValueOf&, double);
    static const auto makers = of_each(
        [](auto type) -> Make {
            return [](const ValueOf& of, double divisor) -> Law {
                return decltype(type)::type::from(of, divisor);
            };
        },
        places);
    return makers.at(static_cast<std::size_t>(law))(value, strength_divisor);
}

Law law_of(const JointMaterial& material)
{
    return law_of(
        material.law, [&](const Parameter& parameter) { return parameter.of(material); },
        material.strength_divisor);
}

Law law_of(const EquivalentJoints& joints, std::size_t edge)
{
    return law_of(
        joints.law.empty() ? 0 : joints.law[edge],
        [&](const Parameter& parameter) { return parameter.of(joints, edge); }, joints.strength_divisor);
}

} // namespace jointcreep::joint
