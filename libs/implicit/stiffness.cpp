#include "implicit/stiffness.hpp"

#include <omp.h>
#include <sys/mman.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <span>

namespace jointcreep::implicit
{

namespace
{

// Of analyses in several threads one at a time factorises or solves: OpenBLAS without threads has one buffer for all, and
// METIS draws from the one rand().
std::mutex one_at_a_time;

// The unknowns of some gridpoints, x and y in turn.
std::vector<int> unknowns_of(const std::vector<std::array<int, 2>>& unknown,
                             std::span<const Index> gridpoints)
{
    std::vector<int> all;
    for (const Index g : gridpoints)
        all.insert(all.end(), unknown[g].begin(), unknown[g].end());
    return all;
}

// A kind of force with a constant stiffness, until it yields.
template <class Force>
concept HasConstants = requires(const Force& force)
{
    constants(force);
};

#ifdef JOINTCREEP_CHOLMOD
// OpenBLAS takes this much address space at its first use [bytes], and asks for it again and again where it does not
// get it.
constexpr std::size_t blas_buffer = std::size_t{192} << 20;

void check_room_for_blas()
{
    static const bool has_room = [] {
        void* const room =
            mmap(nullptr, blas_buffer, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        return room != MAP_FAILED && munmap(room, blas_buffer) == 0;
    }();
    if (!has_room)
        throw std::bad_alloc();
}

template <class Factor>
void check_memory(Factor& factor)
{
    if (factor.cholmod().status == CHOLMOD_OUT_OF_MEMORY)
        throw std::bad_alloc();
}
void check_memory(UmfPackFactor& factor)
{
    if (factor.is_out_of_memory())
        throw std::bad_alloc();
}
#else
void check_room_for_blas() {}
template <class Factor>
void check_memory(const Factor&)
{
} // Eigen's own factor throws by itself
#endif

} // namespace

void Stiffness::follow(const Assembly& assembly)
{
    Eigen::setNbThreads(assembly.threads); // of products; Eigen would take all there are
    bool is_known =
             is_free_ == assembly.is_free && along_ == assembly.along && tied_ == assembly.tied && n_ > 0,
         is_same = true;
    for_each_force(
        [&](const auto& force, Part& part) {
            std::vector<Index> there = present(force);
            is_known = is_known && there == part.there;
            part.there = std::move(there);
            if constexpr (HasConstants<decltype(force)>) {
                is_same = is_same && constants(force) == part.of;
                part.of = constants(force);
            }
        },
        assembly, parts_);
    if (!is_known) {
        is_free_ = assembly.is_free;
        along_ = assembly.along;
        tied_ = assembly.tied;
        number_unknowns(assembly);
        find_pattern(assembly);
    }
    if (!is_known || !is_same)
        fill_constant(assembly);
}

void Stiffness::number_unknowns(const Assembly& assembly)
{
    // Gridpoints without rock stay where they are.
    std::vector<char> has_part(assembly.position.size(), 0);
    std::vector<Index> leader(assembly.position.size());
    for (std::size_t g = 0; g < leader.size(); ++g) {
        has_part[g] = has_rock(assembly.zones, static_cast<Index>(g)) ? 1 : 0;
        leader[g] = static_cast<Index>(g);
    }
    for (const auto& [follower, first] : assembly.tied) {
        leader[follower] = first;
        has_part[first] = static_cast<char>(has_part[first] | has_part[follower]);
    }
    directions_.clear();
    for (const Vector2d& along : assembly.along)
        directions_.push_back(
            along.isZero(0) ? Eigen::Matrix2d(Eigen::Matrix2d::Identity())
                            : (Eigen::Matrix2d() << along.x(), -along.y(), along.y(), along.x()).finished());
    unknown_.assign(leader.size(), {-1, -1});
    n_ = 0;
    for (std::size_t g = 0; g < leader.size(); ++g)
        if (leader[g] == static_cast<Index>(g) && has_part[g])
            for (int i = 0; i < (is_on_rollers(assembly, g) ? 1 : 2); ++i)
                if (assembly.is_free[g][i] > 0)
                    unknown_[g][i] = static_cast<int>(n_++);
    for (std::size_t g = 0; g < leader.size(); ++g)
        unknown_[g] = unknown_[leader[g]];
}

void Stiffness::find_pattern(const Assembly& assembly)
{
    std::vector<Eigen::Triplet<double, int>> entries;
    for_each_force(
        [&](const auto& force, const Part& part) {
            for (const Index group : part.there) {
                const std::vector<int> unknowns = unknowns_of(unknown_, coupled_by(force, group));
                for (const int row : unknowns)
                    for (const int column : unknowns)
                        if (row >= 0 && column >= 0)
                            entries.emplace_back(row, column, 0.0);
            }
        },
        assembly, parts_);
    constant_.resize(n_, n_);
    constant_.setFromTriplets(entries.begin(), entries.end());

    const auto entry_of = [&](int row, int column) {
        if (row < 0 || column < 0)
            return -1;
        const int* const begin = constant_.innerIndexPtr() + constant_.outerIndexPtr()[column];
        const int* const end = constant_.innerIndexPtr() + constant_.outerIndexPtr()[column + 1];
        return static_cast<int>(std::lower_bound(begin, end, row) - constant_.innerIndexPtr());
    };
    for_each_force(
        [&](const auto& force, Part& part) {
            part.entry.clear();
            for (const Index group : part.there) {
                const std::vector<int> unknowns = unknowns_of(unknown_, coupled_by(force, group));
                part.entry.resize(unknowns.size() * unknowns.size() * group, -1);
                for (const int row : unknowns)
                    for (const int column : unknowns)
                        part.entry.push_back(entry_of(row, column));
            }
        },
        assembly, parts_);

    has_factor_ = has_pattern_of_yielding_ = false;
    factorised_ = constant_;
    if (n_ == 0)
        return;
    check_room_for_blas();
    const std::lock_guard lock(one_at_a_time);
    factor_.analyzePattern(factorised_);
    check_memory(factor_);
}

template <class Force, class Call>
void Stiffness::add(Matrix& matrix, const Force& force, const Part& part, const Call& call) const
{
    if (part.there.empty())
        return;
    double* const values = matrix.valuePtr();
    const std::size_t n = coupled_by(force, part.there[0]).size();
    call([&](Index group, int i, int j, const Eigen::Matrix2d& of_xy) {
        Eigen::Matrix2d block = of_xy;
        if (!directions_.empty()) {
            const auto gridpoints = coupled_by(force, group);
            block = directions_[gridpoints[i]].transpose() * of_xy * directions_[gridpoints[j]];
        }
        const int* const entries = part.square(group, n);
        for (int row = 0; row < 2; ++row) {
            const int* const of_row = entries + 2 * n * static_cast<std::size_t>(2 * i + row);
            for (int column = 0; column < 2; ++column)
                if (const int entry = of_row[2 * j + column]; entry >= 0)
                    values[entry] += block(row, column);
        }
    });
}

void Stiffness::fill_constant(const Assembly& assembly)
{
    std::fill(constant_.valuePtr(), constant_.valuePtr() + constant_.nonZeros(), 0.0);
    for_each_force(
        [&](const auto& force, const Part& part) {
            if constexpr (HasConstants<decltype(force)>)
                add(constant_, force, part,
                    [&](const auto& add_block) { add_constant_stiffness(force, part.there, add_block); });
        },
        assembly, parts_);
    has_factor_ = false;
}

VectorXd Stiffness::solve_yielding(const Assembly& assembly, const Tangents& tangents,
                                   const VectorXd& dashpots, const VectorXd& right)
{
    Matrix matrix = constant_;
    std::fill(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros(), 0.0);
    for_each_force(
        [&](const auto& force, const auto& of_force, const Part& part) {
            add(matrix, force, part,
                [&](const auto& add_block) { add_stiffness(force, part.there, of_force, add_block); });
        },
        assembly, tangents, parts_);
    for (Eigen::Index i = 0; i < dashpots.size(); ++i)
        matrix.coeffRef(i, i) += dashpots[i];
    check_room_for_blas();
    const std::lock_guard lock(one_at_a_time);
    if (!has_pattern_of_yielding_)
        yielding_factor_.analyzePattern(matrix);
    check_memory(yielding_factor_);
    has_pattern_of_yielding_ = true;
    yielding_factor_.factorize(matrix);
    check_memory(yielding_factor_);
    if (yielding_factor_.info() != Eigen::Success)
        return {};
    VectorXd x = yielding_factor_.solve(right);
    check_memory(yielding_factor_);
    return yielding_factor_.info() == Eigen::Success && x.allFinite() ? x : VectorXd();
}

VectorXd Stiffness::gathered(const Assembly& assembly, const std::vector<Vector2d>& over_gridpoints) const
{
    VectorXd x = VectorXd::Zero(n_);
    for (std::size_t g = 0; g < over_gridpoints.size(); ++g) {
        const Vector2d components = turned(static_cast<Index>(g), over_gridpoints[g]);
        for (int i = 0; i < 2; ++i)
            if (unknown_[g][i] >= 0 && assembly.is_free[g][i] > 0)
                x[unknown_[g][i]] += components[i];
    }
    return x;
}

void Stiffness::add_to(std::vector<Vector2d>& over_gridpoints, const VectorXd& unknowns, double factor) const
{
    for (std::size_t g = 0; g < over_gridpoints.size(); ++g) {
        Vector2d components(0, 0);
        for (int i = 0; i < 2; ++i)
            if (unknown_[g][i] >= 0)
                components[i] = factor * unknowns[unknown_[g][i]];
        over_gridpoints[g] += turned_back(static_cast<Index>(g), components);
    }
}

template <class Force, class Tangent>
void Stiffness::add_product(const Force& force, Index group, const Tangent& tangent,
                            const Eigen::Ref<const VectorXd>& x, Eigen::Ref<VectorXd> y) const
{
    const auto value = [&](int unknown) { return unknown >= 0 ? x[unknown] : 0.0; };
    const auto gridpoints = coupled_by(force, group);
    add_force_change(
        force, group, tangent,
        [&](int i) {
            const auto& [along_x, along_y] = unknown_[gridpoints[i]];
            return turned_back(gridpoints[i], Vector2d(value(along_x), value(along_y)));
        },
        [&](int i, const Vector2d& of_xy) {
            const Vector2d change = turned(gridpoints[i], of_xy);
            for (int k = 0; k < 2; ++k)
                if (const int unknown = unknown_[gridpoints[i]][k]; unknown >= 0)
                    y[unknown] += change[k];
        });
}

VectorXd Stiffness::times(const Assembly& assembly, const Tangents& tangents, const VectorXd& x) const
{
    // It is symmetric, and rows are summed faster than columns are spread.
    VectorXd y = constant_.transpose() * x;
    for_each_force(
        [&](const auto& force, const auto& of_force, const Part& part) {
            if constexpr (!HasConstants<decltype(force)>)
                for (const Index group : part.there)
                    add_product(force, group, of_force[group], x, y);
        },
        assembly, tangents, parts_);
    return y;
}

Stiffness::Change Stiffness::change(const Assembly& assembly, const Tangents& before,
                                    const Tangents& after) const
{
    Change change;
    for_each_force(
        [&](const auto& force, const auto& from, const auto& to, const Part& part,
            std::vector<Index>& groups) {
            if constexpr (!HasConstants<decltype(force)>)
                for (const Index group : part.there) {
                    if (from[group] == to[group])
                        continue;
                    groups.push_back(group);
                    for (const int unknown : unknowns_of(unknown_, coupled_by(force, group)))
                        if (unknown >= 0)
                            change.unknowns.push_back(unknown);
                }
        },
        assembly, before, after, parts_, change.groups);
    std::sort(change.unknowns.begin(), change.unknowns.end());
    change.unknowns.erase(std::unique(change.unknowns.begin(), change.unknowns.end()), change.unknowns.end());
    return change;
}

void Stiffness::add_change(const Assembly& assembly, const Change& change, const Tangents& before,
                           const Tangents& after, const Eigen::Ref<const VectorXd>& x,
                           Eigen::Ref<VectorXd> y) const
{
    for_each_force(
        [&](const auto& force, const auto& from, const auto& to, const std::vector<Index>& groups) {
            if constexpr (!HasConstants<decltype(force)>)
                for (const Index group : groups)
                    add_product(force, group, to[group] - from[group], x, y);
        },
        assembly, before, after, change.groups);
}

bool Stiffness::factorise(const Assembly& assembly, const Tangents& tangents)
{
    std::copy(constant_.valuePtr(), constant_.valuePtr() + constant_.nonZeros(), factorised_.valuePtr());
    for_each_force(
        [&](const auto& force, const auto& of_force, const Part& part) {
            if constexpr (!HasConstants<decltype(force)>) {
                auto symmetric = of_force;
                for (auto& tangent : symmetric)
                    tangent = tangent.symmetric();
                add(factorised_, force, part,
                    [&](const auto& add_block) { add_stiffness(force, part.there, symmetric, add_block); });
            }
        },
        assembly, tangents, parts_);
    // Threads inside of the factorisation cost more than they gain at these sizes.
    const std::lock_guard lock(one_at_a_time);
    const int levels = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
    if (factorised_.rows() > 0) // CHOLMOD does not survive rock of which nothing can move
        factor_.factorize(factorised_);
    omp_set_max_active_levels(levels);
    check_memory(factor_);
    has_factor_ = factor_.info() == Eigen::Success;
    factor_of_ = tangents;
    return has_factor_;
}

VectorXd Stiffness::solve(const VectorXd& right) const
{
    if (right.size() == 0)
        return right;
    const std::lock_guard lock(one_at_a_time);
    VectorXd x = factor_.solve(right);
    if (factor_.info() != Eigen::Success) // there is a factor: memory for the solution was short
        throw std::bad_alloc();
    return x;
}

} // namespace jointcreep::implicit
