// A sum of very many numbers without their rounding errors (Kahan). Inside libs/large_displacements only.

#pragma once

namespace jointcreep::large_displacements
{

// `lost` is the rounding error so far; it is added with the next number.
template <class Value>
void add(const Value& one, Value& sum, Value& lost)
{
    const Value with_lost = one + lost, before = sum;
    sum += with_lost;
    lost = with_lost - (sum - before);
}

} // namespace jointcreep::large_displacements
