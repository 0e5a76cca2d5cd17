#include "implicit/stiffness.hpp"

#include <omp.h>
#include <sys/mman.h>

#include <algorithm>
#include <new>
#include <span>

namespace jointcreep::implicit
{

namespace
{

// The unknowns of some gridpoints, x and y in turn.
std::vector<int> unknowns_of(const std::vector<std::array<int, 2>>& unknown,
                             std::span<const Index> gridpoints)
{
    std::vector<int> all;
    for (const Index g : gridpoints)
        all.insert(all.end(), unknown[g].begin(), unknown[g].end());
    return all;
}

// Entries of the stiffness of a zone.
std::size_t square_of_zone(const rock::Zones& zones)
{
    const auto unknowns = static_cast<std::size_t>(2 * zones.gridpoints_of_zone);
    return unknowns * unknowns;
}

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
template <class Matrix>
void check_memory(Eigen::UmfPackLU<Matrix>& factor)
{
    if (factor.umfpackFactorizeReturncode() == UMFPACK_ERROR_out_of_memory)
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
    const bool is_known = is_present_ == assembly.zones.is_present && is_free_ == assembly.is_free &&
                          tied_ == assembly.tied && n_ > 0;
    if (!is_known) {
        is_present_ = assembly.zones.is_present;
        is_free_ = assembly.is_free;
        tied_ = assembly.tied;
        number_unknowns(assembly);
        find_pattern(assembly);
    }
    if (!is_known || zone_stiffness_ != assembly.zones.stiffness) {
        zone_stiffness_ = assembly.zones.stiffness;
        fill_zones(assembly);
    }
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
    unknown_.assign(leader.size(), {-1, -1});
    n_ = 0;
    for (std::size_t g = 0; g < leader.size(); ++g)
        if (leader[g] == static_cast<Index>(g) && has_part[g])
            for (int i = 0; i < 2; ++i)
                if (assembly.is_free[g][i] > 0)
                    unknown_[g][i] = static_cast<int>(n_++);
    for (std::size_t g = 0; g < leader.size(); ++g)
        unknown_[g] = unknown_[leader[g]];
}

void Stiffness::find_pattern(const Assembly& assembly)
{
    const rock::Zones& zones = assembly.zones;
    const joint::Contacts& contacts = assembly.contacts;
    std::vector<Eigen::Triplet<double, int>> entries;
    const auto couple = [&](const auto& unknowns) {
        for (const int row : unknowns)
            for (const int column : unknowns)
                if (row >= 0 && column >= 0)
                    entries.emplace_back(row, column, 0.0);
    };
    for (std::size_t zone = 0; zone < zones.zone_of(zones.size()); ++zone)
        if (const std::size_t z = zones.first_point_of(zone); zones.is_present[z])
            couple(unknowns_of(unknown_, zones.gridpoints(z)));
    present_contact_.clear();
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed) {
            present_contact_.push_back(static_cast<Index>(c));
            couple(unknowns_of(unknown_, contacts.gridpoint[c]));
        }
    zones_.resize(n_, n_);
    zones_.setFromTriplets(entries.begin(), entries.end());

    const auto entry_of = [&](int row, int column) {
        if (row < 0 || column < 0)
            return -1;
        const int* const begin = zones_.innerIndexPtr() + zones_.outerIndexPtr()[column];
        const int* const end = zones_.innerIndexPtr() + zones_.outerIndexPtr()[column + 1];
        return static_cast<int>(std::lower_bound(begin, end, row) - zones_.innerIndexPtr());
    };
    const auto list = [&](const std::vector<int>& unknowns, int* place) {
        for (const int row : unknowns)
            for (const int column : unknowns)
                *place++ = entry_of(row, column);
    };
    const std::size_t square = square_of_zone(zones);
    zone_entry_.assign(square * zones.zone_of(zones.size()), -1);
    for (std::size_t zone = 0; zone < zones.zone_of(zones.size()); ++zone)
        if (const std::size_t z = zones.first_point_of(zone); zones.is_present[z])
            list(unknowns_of(unknown_, zones.gridpoints(z)), &zone_entry_[square * zone]);
    contact_entry_.resize(contacts.gridpoint.size());
    for (const Index c : present_contact_)
        list(unknowns_of(unknown_, contacts.gridpoint[c]), contact_entry_[c].data());

    has_factor_ = has_pattern_of_yielding_ = false;
    factorised_ = zones_;
    if (n_ == 0)
        return;
    check_room_for_blas();
    factor_.analyzePattern(factorised_);
    check_memory(factor_);
}

// Adds the zones' stiffness: block(stress point, i, j) per area between its gridpoints [Pa/m2].
template <class Block>
void Stiffness::add_zones(Matrix& matrix, const rock::Zones& zones, const Block& block) const
{
    double* const values = matrix.valuePtr();
    const int n = zones.gridpoints_of_zone;
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (!zones.is_present[z])
            continue;
        const int* const entries = &zone_entry_[square_of_zone(zones) * zones.zone_of(z)];
        const auto of_point = block(z);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const Eigen::Matrix2d between = zones.area[z] * of_point(i, j);
                for (int row = 0; row < 2; ++row)
                    for (int column = 0; column < 2; ++column)
                        if (const int entry = entries[2 * n * (2 * i + row) + 2 * j + column]; entry >= 0)
                            values[entry] += between(row, column);
            }
    }
}

// Adds the contacts' stiffness: block(contact) of the force on side b by its displacement [Pa].
template <class Block>
void Stiffness::add_contacts(Matrix& matrix, const Block& block) const
{
    double* const values = matrix.valuePtr();
    for (const Index c : present_contact_) {
        const Eigen::Matrix2d of_b = block(c);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
                if (const int entry = contact_entry_[c][4 * i + j]; entry >= 0)
                    values[entry] += (i / 2 == j / 2 ? 1 : -1) * of_b(i % 2, j % 2);
    }
}

void Stiffness::fill_zones(const Assembly& assembly)
{
    const rock::Zones& zones = assembly.zones;
    std::fill(zones_.valuePtr(), zones_.valuePtr() + zones_.nonZeros(), 0.0);
    add_zones(zones_, zones, [&zones](std::size_t z) {
        return [&zones, z](int i, int j) { return stiffness_between(zones, z, i, j); };
    });
    has_factor_ = false;
}

VectorXd Stiffness::solve_yielding(const Assembly& assembly, const std::vector<Tangent>& tangents,
                                   const std::vector<rock::YieldingZone>& start, const VectorXd& dashpots,
                                   const VectorXd& right)
{
    const rock::Zones& zones = assembly.zones;
    const joint::Contacts& contacts = assembly.contacts;
    Matrix matrix = zones_;
    std::fill(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros(), 0.0);
    add_zones(matrix, zones, [&](std::size_t z) {
        const Eigen::Matrix3d tangent = tangent_at(zones, z, assembly.displacement, start);
        return [&zones, z, tangent](int i, int j) { return stiffness_between(zones, z, i, j, tangent); };
    });
    add_contacts(matrix, [&](Index c) -> Eigen::Matrix2d { return stiffness_of(contacts, c, tangents[c]); });
    for (Eigen::Index i = 0; i < dashpots.size(); ++i)
        matrix.coeffRef(i, i) += dashpots[i];
    check_room_for_blas();
    if (!has_pattern_of_yielding_)
        yielding_factor_.analyzePattern(matrix);
    has_pattern_of_yielding_ = true;
    yielding_factor_.factorize(matrix);
    check_memory(yielding_factor_);
    if (yielding_factor_.info() != Eigen::Success)
        return {};
    VectorXd x = yielding_factor_.solve(right);
    return yielding_factor_.info() == Eigen::Success && x.allFinite() ? x : VectorXd();
}

VectorXd Stiffness::gathered(const Assembly& assembly, const std::vector<Vector2d>& over_gridpoints) const
{
    VectorXd x = VectorXd::Zero(n_);
    for (std::size_t g = 0; g < over_gridpoints.size(); ++g)
        for (int i = 0; i < 2; ++i)
            if (unknown_[g][i] >= 0 && assembly.is_free[g][i] > 0)
                x[unknown_[g][i]] += over_gridpoints[g][i];
    return x;
}

void Stiffness::add_to(std::vector<Vector2d>& over_gridpoints, const VectorXd& unknowns, double factor) const
{
    for (std::size_t g = 0; g < over_gridpoints.size(); ++g)
        for (int i = 0; i < 2; ++i)
            if (unknown_[g][i] >= 0)
                over_gridpoints[g][i] += factor * unknowns[unknown_[g][i]];
}

VectorXd Stiffness::times(const Assembly& assembly, const std::vector<Tangent>& tangents,
                          const VectorXd& x) const
{
    // It is symmetric, and rows are summed faster than columns are spread.
    VectorXd y = zones_.transpose() * x;
    for (const Index c : present_contact_)
        add_contact(assembly, c, tangents[c], x, y);
    return y;
}

Stiffness::Change Stiffness::change(const Assembly& assembly, const std::vector<Tangent>& before,
                                    const std::vector<Tangent>& after) const
{
    Change change;
    for (const Index c : present_contact_) {
        const Tangent &from = before[c], &to = after[c];
        if (from == to)
            continue;
        change.contacts.push_back({c,
                                   {to.normal - from.normal, to.shear - from.shear,
                                    to.friction - from.friction, to.dilation - from.dilation}});
        for (const Index g : assembly.contacts.gridpoint[c])
            for (const int unknown : unknown_[g])
                if (unknown >= 0)
                    change.unknowns.push_back(unknown);
    }
    std::sort(change.unknowns.begin(), change.unknowns.end());
    change.unknowns.erase(std::unique(change.unknowns.begin(), change.unknowns.end()), change.unknowns.end());
    return change;
}

void Stiffness::add_contact(const Assembly& assembly, Index contact, const Tangent& tangent,
                            const Eigen::Ref<const VectorXd>& x, Eigen::Ref<VectorXd> y) const
{
    const joint::Contacts& contacts = assembly.contacts;
    const auto value = [&](int unknown) { return unknown >= 0 ? x[unknown] : 0.0; };
    const auto& [a, b] = contacts.gridpoint[contact];
    const auto &from = unknown_[a], &to = unknown_[b];
    const Vector2d relative(value(to[0]) - value(from[0]), value(to[1]) - value(from[1]));
    const Vector2d force = joint::force_change(contacts, contact, tangent, relative);
    for (int i = 0; i < 2; ++i) {
        if (to[i] >= 0)
            y[to[i]] += force[i];
        if (from[i] >= 0)
            y[from[i]] -= force[i];
    }
}

bool Stiffness::factorise(const Assembly& assembly, const std::vector<Tangent>& tangents)
{
    const joint::Contacts& contacts = assembly.contacts;
    std::copy(zones_.valuePtr(), zones_.valuePtr() + zones_.nonZeros(), factorised_.valuePtr());
    add_contacts(factorised_, [&](Index c) -> Eigen::Matrix2d {
        return stiffness_of(contacts, c, {tangents[c].normal, tangents[c].shear, 0, 0});
    });
    // Threads inside of the factorisation cost more than they gain at these sizes.
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
    VectorXd x = factor_.solve(right);
    if (factor_.info() != Eigen::Success) // there is a factor: memory for the solution was short
        throw std::bad_alloc();
    return x;
}

} // namespace jointcreep::implicit
