// A sum of very many numbers without their rounding errors (Kahan). Inside libs/large_displacements only.

#pragma once

namespace jointcreep::large_displacements
{

// What rounding leaves out is `lost`, and comes with the next one.
template <class Value>
void add(const Value& one, Value& sum, Value& lost)
{
    const Value with_lost = one + lost, before = sum;
    sum += with_lost;
    lost = with_lost - (sum - before);
}

} // namespace jointcreep::large_displacements
