#include "sampling/streams.hpp"

#include <Random123/philox.h>

#include <cassert>

namespace jointcreep::sampling
{

namespace
{

constexpr unsigned block_bits = 28;

} // namespace

std::uint32_t set_key(std::string_view name)
{
    std::uint32_t hash = 2166136261U;
    for (const char letter : name)
        hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
    return hash;
}

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key)
{
    using Philox = r123::Philox4x32_R<10>;
    const Philox::ctr_type words =
        Philox{}({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
    return {words[0], words[1], words[2], words[3]};
}

Stream::Stream(const SetStreams& set, std::int32_t joint_number, Purpose purpose)
    : key_{static_cast<std::uint32_t>(set.seed), static_cast<std::uint32_t>(set.seed >> 32U)},
      counter_{static_cast<std::uint32_t>(purpose) << block_bits, static_cast<std::uint32_t>(set.realization),
               set.set_key, static_cast<std::uint32_t>(joint_number)}
{
}

Stream::result_type Stream::operator()()
{
    if (has_waiting_) {
        has_waiting_ = false;
        return waiting_;
    }
    const auto words = philox(counter_, key_);
    ++counter_[0];
    assert(counter_[0] << (32 - block_bits) != 0); // else the next purpose's numbers would follow
    waiting_ = static_cast<result_type>(words[3]) << 32U | words[2];
    has_waiting_ = true;
    return static_cast<result_type>(words[1]) << 32U | words[0];
}

} // namespace jointcreep::sampling
