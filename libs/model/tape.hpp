// The state of a long search for equilibrium, as one list of numbers: written in the middle of it, and read back by a
// run that has come to the same search. One function passes the state both ways, so that it is listed once.
//
//     tape(velocity_, time_);      // numbers, flags, fixed vectors; lists that have the same length when read
//     tape.list(pairs_);           // a list of any length
//     tape.index(gridpoint_, n);   // an index below n

#pragma once

#include "model/error.hpp"
#include "model/network.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace jointcreep
{

class Tape
{
public:
    Tape() = default; // to be written
    explicit Tape(std::vector<double> numbers) : numbers_(std::move(numbers)), reads_(true) {}

    bool reads() const { return reads_; }
    std::vector<double> numbers() && { return std::move(numbers_); }
    // To be called when all has been read.
    void check_end() const { check(next_ == numbers_.size()); }

    template <class... Items>
    void operator()(Items&... items)
    {
        (pass(items), ...);
    }

    // The size of a list of any length; its items are to follow.
    std::size_t size(std::size_t size)
    {
        pass(size);
        check(!reads_ || size <= numbers_.size() - next_);
        return size;
    }
    template <class Item>
    void list(std::vector<Item>& items)
    {
        items.resize(size(items.size()));
        for (Item& item : items)
            pass(item);
    }
    // None, or so many.
    template <class Item>
    void list_of(std::size_t size, std::vector<Item>& items)
    {
        list(items);
        check(items.empty() || items.size() == size);
    }

    template <class Number>
    void index(Number& index, std::size_t below)
    {
        pass(index);
        check(index >= 0 && static_cast<std::size_t>(index) < below);
    }
    template <class Number>
    void indices(std::vector<Number>& indices, std::size_t below)
    {
        list(indices);
        for (const Number index : indices)
            check(index >= 0 && static_cast<std::size_t>(index) < below);
    }

    static void check(bool fits)
    {
        if (!fits)
            throw input_error("the search kept is that of another run");
    }

private:
    template <class Item>
    struct is_list : std::false_type {
    };
    template <class Item>
    struct is_list<std::vector<Item>> : std::true_type {
    };
    template <class Item>
    struct is_array : std::false_type {
    };
    template <class Item, std::size_t n>
    struct is_array<std::array<Item, n>> : std::true_type {
    };

    template <class Item>
    void pass(Item& item)
    {
        if constexpr (std::is_arithmetic_v<Item> || std::is_enum_v<Item>)
            number(item);
        else if constexpr (is_list<Item>::value) {
            check(size(item.size()) == item.size());
            for (auto& one : item)
                pass(one);
        } else if constexpr (is_array<Item>::value) {
            for (auto& one : item)
                pass(one);
        } else if constexpr (std::is_base_of_v<Eigen::MatrixBase<Item>, Item>) {
            for (Eigen::Index i = 0; i < item.size(); ++i)
                pass(item.data()[i]);
        } else
            item.pass(*this);
    }

    // Files have finite numbers only: what is infinite is the largest one there.
    template <class Number>
    void number(Number& one)
    {
        constexpr double most = std::numeric_limits<double>::max();
        if (!reads_) {
            const auto value = static_cast<double>(one);
            numbers_.push_back(std::isinf(value) ? most : value);
            return;
        }
        check(next_ < numbers_.size());
        const double value = numbers_[next_++];
        if constexpr (std::is_floating_point_v<Number>)
            one = value == most ? std::numeric_limits<double>::infinity() : value;
        else {
            constexpr double least_index = -1, most_index = 9e15;
            check(value >= least_index && value <= most_index && value == std::floor(value));
            one = static_cast<Number>(value);
        }
    }

    std::vector<double> numbers_;
    std::size_t next_ = 0;
    bool reads_ = false;
};

// Keeps long searches for equilibrium.
class SearchKeeper
{
public:
    virtual ~SearchKeeper() = default;

    // A search has begun. If it is the one that was kept, `pass` takes its state from the tape: true.
    virtual bool search_begins(const std::function<void(Tape&)>& pass) = 0;
    // The search may be kept as it is now.
    virtual void search_goes_on(const std::function<void(Tape&)>& pass) = 0;
};

} // namespace jointcreep
