// Numbers with their derivative by one variable (forward differentiation). A joint law computed with them gives its
// response and the derivative of the response, from one formula.
//
//     f(x + e) = f(x) + f'(x) e,    e^2 = 0
//
// Comparisons use the value alone: at a kink the derivative is that of the branch taken.

#pragma once

#include <algorithm>
#include <cmath>

namespace jointcreep::joint
{

struct Dual {
    double value = 0, slope = 0; // f, f'

    Dual() = default;
    constexpr Dual(double constant)
        : value(constant) {} // NOLINT(google-explicit-constructor): a number is one
    constexpr Dual(double of, double by) : value(of), slope(by) {}

    Dual operator-() const { return {-value, -slope}; }
    Dual& operator+=(const Dual& b) { return *this = {value + b.value, slope + b.slope}; }
    Dual& operator-=(const Dual& b) { return *this = {value - b.value, slope - b.slope}; }
    Dual& operator*=(const Dual& b) { return *this = {value * b.value, slope * b.value + value * b.slope}; }
    Dual& operator/=(const Dual& b)
    {
        const double quotient = value / b.value;
        return *this = {quotient, (slope - quotient * b.slope) / b.value};
    }
    friend Dual operator+(Dual a, const Dual& b) { return a += b; }
    friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
    friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
    friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
    friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
    friend auto operator<=>(const Dual& a, const Dual& b) { return a.value <=> b.value; }

    friend Dual abs(const Dual& a) { return a.value < 0 ? -a : a; }
    friend Dual exp(const Dual& a)
    {
        const double e = std::exp(a.value);
        return {e, e * a.slope};
    }
    friend Dual expm1(const Dual& a) { return {std::expm1(a.value), std::exp(a.value) * a.slope}; }
    friend Dual log10(const Dual& a) { return {std::log10(a.value), a.slope / (a.value * std::log(10.0))}; }
    friend Dual tan(const Dual& a)
    {
        const double t = std::tan(a.value);
        return {t, (1 + t * t) * a.slope};
    }
    friend Dual copysign(const Dual& size, const Dual& sign)
    {
        return std::signbit(size.value) == std::signbit(sign.value) ? size : -size;
    }
};

inline double value_of(double a)
{
    return a;
}
inline double value_of(const Dual& a)
{
    return a.value;
}

} // namespace jointcreep::joint
