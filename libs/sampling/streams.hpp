// Random numbers by counter: every joint has its own streams, one for each thing drawn for it, so that what
// is drawn for one never shifts what is drawn for another.
//
// Philox4x32 of 10 rounds (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3; SC 2011).
//   key      the seed: {low word, high word}
//   counter  {purpose and block, realization, key of the joint set, number of the joint}
// The first word holds the purpose in its upper 4 bits and counts blocks in the other 28; a block of four
// words gives two draws.

#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

namespace jointcreep::sampling
{

// What a stream is drawn for. The numbers are part of every network ever made: never change one.
enum class Purpose : std::uint32_t {
    spacing = 0,
    orientation = 1,
    position = 2,
    traces_ahead = 3,
    traces_behind = 4,
    count = 5,
    size = 6,
    ends_ahead = 7,
    ends_behind = 8
};

// 32-bit hash (FNV-1a) of a joint set's name: the set's streams depend on its name, not on its place in the
// scene. Two names may share one.
std::uint32_t set_key(std::string_view name);

// One block of Philox4x32-10.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

// All the streams of one joint set in one realization.
struct SetStreams {
    std::uint64_t seed;
    std::int32_t realization;
    std::uint32_t set_key;
};

// A uniform random bit generator of 64 bits. Negative joint numbers are as good as others.
class Stream
{
public:
    using result_type = std::uint64_t;

    Stream(const SetStreams& set, std::int32_t joint_number, Purpose purpose);

    static constexpr result_type min() { return 0; }
    static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

    result_type operator()();

private:
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_; // of the next block
    result_type waiting_ = 0;              // second half of the last block
    bool has_waiting_ = false;
};

} // namespace jointcreep::sampling
