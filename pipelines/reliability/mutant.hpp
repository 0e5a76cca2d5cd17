// Operators with a mark between them, for mutants.py: `a + mutant::plus<7> + b` is a + b, or a - b where the environment
// variable JOINTCREEP_MUTANT is 7. A process writes the numbers of the marks that it came to into a file of the folder that
// JOINTCREEP_MUTANTS_SEEN names.

#pragma once

#if defined(__cplusplus) && __cplusplus >= 202002L

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdlib>
#include <fstream>
#include <string>
#include <type_traits>
#include <unistd.h>
#include <utility>

namespace mutant
{

inline const int chosen = [] {
    const char* const number = std::getenv("JOINTCREEP_MUTANT");
    return number ? std::atoi(number) : 0;
}();

struct Seen {
    std::array<bool, 10000> marks{};

    ~Seen()
    {
        if (const char* const folder = std::getenv("JOINTCREEP_MUTANTS_SEEN")) {
            std::ofstream file(std::string(folder) + '/' + std::to_string(getpid()));
            for (std::size_t number = 0; number < marks.size(); ++number)
                if (marks[number])
                    file << number << '\n';
        }
    }
};
inline Seen seen;

template <int number>
bool is_chosen()
{
    seen.marks[number] = true;
    return chosen == number;
}

// The left operand, until the right one comes.
template <int number, char kind, class A>
struct Left {
    const A& a;
};
template <int number, char kind>
struct Mark {
};

// What an expression is worth; matrices of expressions as themselves.
template <class A>
auto value(const A& a)
{
    if constexpr (requires { a.eval(); })
        return typename A::PlainObject(a);
    else
        return a;
}

// clang-format off
#define JOINTCREEP_MUTANT(name, kind, op, changed)                                                                     \
    template <int number>                                                                                              \
    inline constexpr Mark<number, kind> name{};                                                                        \
    template <class A, int number>                                                                                     \
    Left<number, kind, A> operator op(const A& a, Mark<number, kind>)                                                  \
    {                                                                                                                  \
        return {a};                                                                                                    \
    }                                                                                                                  \
    template <class A, int number, class B>                                                                            \
    auto operator op(Left<number, kind, A> left, const B& b)                                                           \
    {                                                                                                                  \
        const A& a = left.a;                                                                                           \
        using Value = decltype(value(a op b));                                                                         \
        return is_chosen<number>() ? Value(changed) : Value(a op b);                                                   \
    }

// Whole numbers change at the bound, others turn round.
template <class A, class B>
constexpr bool whole = std::integral<A> && std::integral<B>;
template <class A, class B>
auto divided(const A& a, const B& b)
{
    if constexpr (requires { a / b; })
        return value(a / b);
    else
        return value(a * b * 0.5); // matrices
}

JOINTCREEP_MUTANT(plus, '+', +, a - b)
JOINTCREEP_MUTANT(minus, '-', -, a + b)
JOINTCREEP_MUTANT(times, '*', *, divided(a, b))
JOINTCREEP_MUTANT(over, '/', /, a * b)
JOINTCREEP_MUTANT(less, '<', <, (whole<A, B> ? a <= b : !(a < b)))
JOINTCREEP_MUTANT(more, '>', >, (whole<A, B> ? a >= b : !(a > b)))
JOINTCREEP_MUTANT(at_most, 'm', <=, (whole<A, B> ? a < b : !(a <= b)))
JOINTCREEP_MUTANT(at_least, 'l', >=, (whole<A, B> ? a > b : !(a >= b)))
JOINTCREEP_MUTANT(same, '=', ==, !(a == b))
JOINTCREEP_MUTANT(other, '!', !=, !(a != b))
// clang-format on
#undef JOINTCREEP_MUTANT

template <int number, class... A>
auto min(const A&... a)
{
    return is_chosen<number>() ? std::max(a...) : std::min(a...);
}
template <int number, class T>
T min(std::initializer_list<T> all)
{
    return is_chosen<number>() ? std::max(all) : std::min(all);
}
template <int number, class... A>
auto max(const A&... a)
{
    return is_chosen<number>() ? std::min(a...) : std::max(a...);
}
template <int number, class T>
T max(std::initializer_list<T> all)
{
    return is_chosen<number>() ? std::min(all) : std::max(all);
}

} // namespace mutant

#endif
