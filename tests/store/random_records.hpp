// Random records that keep to the schema, a folder to write them into, and a comparison that misses nothing
// the schema declares.

#pragma once

#include "store/check.hpp"
#include "store/files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include <stdlib.h>

namespace jointcreep::store
{

class TemporaryFolder
{
public:
    TemporaryFolder()
    {
        std::string name = testing::TempDir() + "jointcreep-XXXXXX";
        if (!::mkdtemp(name.data()))
            throw std::runtime_error("no temporary folder");
        folder_ = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() { std::filesystem::remove_all(folder_); }

    std::string operator/(const std::string& name) const { return folder_ / name; }
    std::vector<std::string> files() const
    {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            names.push_back(entry.path().filename());
        std::ranges::sort(names);
        return names;
    }

private:
    std::filesystem::path folder_;
};

inline std::string bytes_of(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class RandomRecords
{
public:
    RandomRecords(std::uint64_t seed, std::size_t largest) : random_(seed), largest_(largest) {}

    ResultFile result(bool with_trace = true)
    {
        ResultFile file;
        file.provenance.seed = random_();
        file.provenance.realization = static_cast<Index>(random_() % 1000);
        fill(schema::fields_of(file.provenance));
        fill(schema::fields_of(file.network));
        fill(schema::fields_of(file.equivalent));
        fill(schema::fields_of(file.result));
        if (with_trace) {
            fill(schema::fields_of(file.result.step_history));
            fill(schema::fields_of(file.result.guards));
            fill(schema::fields_of(file.result.failure));
            file.result.failure.reason += '!'; // without one it is none
            fill(schema::fields_of(file.safety));
        }
        keep_invariants(file);
        return file;
    }

    CheckpointFile checkpoint(bool with_motion)
    {
        CheckpointFile file;
        static_cast<ResultFile&>(file) = result(false);
        file.safety = {};
        fill(schema::fields_of(file.checkpoint));
        if (with_motion)
            fill(schema::fields_of(file.checkpoint.dynamics));
        return file;
    }

private:
    // At least 2 rows of everything, so that there is something to index, and a second one that differs.
    std::size_t size(const std::string& dimension)
    {
        const auto [found, is_new] = sizes_.try_emplace(dimension, 2 + random_() % (largest_ - 1));
        if (is_new && dimension == "edge") // each vertex is an end of one
            found->second = std::max(found->second, (size("vertex") + 1) / 2);
        return found->second;
    }

    void fill(const std::vector<fields::Field>& fields)
    {
        for (const fields::Field& field : fields) {
            std::size_t rows = 1;
            for (const std::string& name : field.dimensions)
                rows *= name.ends_with("+1") ? size(name.substr(0, name.size() - 2)) + 1 : size(name);
            fields::resize(field.values, rows);
            std::visit([&](auto values) { fill(field.limits, values); }, fields::flat(field.values));
        }
    }

    // Numbers of all magnitudes, and signs where allowed; sometimes the ends of the range.
    void fill(const fields::Limits& limits, std::span<double> values)
    {
        for (double& value : values) {
            value = std::ldexp(fraction() + 0.5, static_cast<int>(random_() % 200) - 100);
            if (std::isinf(limits.least) && !limits.positive && random_() % 2)
                value = -value;
            if (std::isfinite(limits.least) && std::isfinite(limits.most))
                value = limits.least + fraction() * (limits.most - limits.least);
            if (std::isfinite(limits.least) && random_() % 10 == 0)
                value = limits.least;
            if (std::isfinite(limits.most) && random_() % 10 == 0)
                value = limits.most;
        }
        if (limits.ascending)
            std::ranges::sort(values);
    }

    void fill(const fields::Limits& limits, std::span<Index> values)
    {
        std::int64_t least = 0, most = std::numeric_limits<Index>::max();
        if (std::isfinite(limits.least))
            least = std::lround(limits.least);
        if (std::isfinite(limits.most))
            most = std::lround(limits.most);
        for (const std::string& into : {limits.index_of, limits.rows_of})
            if (!into.empty())
                most = static_cast<std::int64_t>(size(into)) - (into == limits.index_of ? 1 : 0);
        if (limits.or_none)
            least = -1;
        for (Index& value : values)
            value = static_cast<Index>(std::uniform_int_distribution<std::int64_t>(least, most)(random_));
        if (limits.ascending)
            std::ranges::sort(values);
        if (!limits.rows_of.empty()) {
            values.front() = 0;
            values.back() = static_cast<Index>(most);
        }
    }

    void fill(const fields::Limits&, std::span<std::string> values)
    {
        static const std::vector<std::string> letters = {"a",  "Z", " ",  "\n",        "0",
                                                         "\"", "ß", "節", "\U0001F600"};
        for (std::string& value : values) {
            value.clear();
            for (std::size_t left = random_() % 20; left > 0; --left)
                value += letters[random_() % letters.size()];
        }
    }

    void keep_invariants(ResultFile& file)
    {
        Names& all = file.network.names;
        for (std::vector<std::string>* names : {&all.rock, &all.joint_material, &all.joint_set, &all.stage})
            for (std::size_t i = 0; i < names->size(); ++i)
                (*names)[i] += '#' + std::to_string(i);
        Blocks& blocks = file.network.blocks;
        for (std::size_t edge = 0; edge < blocks.edge_vertex.size(); ++edge) {
            const auto next = static_cast<Index>(2 * edge), n = static_cast<Index>(blocks.vertex.size());
            // The first edges have all vertices.
            blocks.edge_vertex[edge] =
                next < n ? std::array<Index, 2>{next, (next + 1) % n} : two_of(blocks.vertex.size());
            const auto kind = static_cast<EdgeKind>(blocks.edge_kind[edge]);
            blocks.edge_block[edge] = two_of(blocks.block_area.size());
            if (kind == EdgeKind::boundary)
                blocks.edge_block[edge][random_() % 2] = -1;
            blocks.edge_joint[edge] = kind == EdgeKind::joint ? 0 : -1;
        }
        EquivalentJoints& joints = file.equivalent;
        for (std::size_t unit = 0; unit < joints.normal_kelvin_stiffness.size(); ++unit) {
            joints.normal_kelvin_viscosity[unit] += joints.normal_kelvin_stiffness[unit] > 0 ? 1e-30 : 0;
            joints.shear_kelvin_viscosity[unit] += joints.shear_kelvin_stiffness[unit] > 0 ? 1e-30 : 0;
        }
        Mesh& mesh = file.result.mesh;
        mesh.gridpoint[0] = {0, 0};
        mesh.gridpoint[1] = {1 + fraction(), 0};
        mesh.gridpoint[2] = {fraction(), 1 + fraction()};
        for (auto& corners : mesh.zone_gridpoint) {
            corners = {0, 1, 2};
            std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(random_() % 3),
                        corners.end());
        }
        const bool is_quadratic = random_() % 2 == 0;
        mesh.zone_middle.resize(is_quadratic ? mesh.zone_gridpoint.size() : 0, {2, 0, 1});
        mesh.side_middle.resize(is_quadratic ? mesh.side_gridpoint.size() : 0, 1);
        for (auto& gridpoints : mesh.contact_gridpoint)
            gridpoints = two_of(mesh.gridpoint.size());
        for (auto& normal : mesh.contact_normal) {
            const double angle = 2 * std::numbers::pi * fraction();
            normal = {std::cos(angle), std::sin(angle)};
        }
    }

    std::array<Index, 2> two_of(std::size_t count)
    {
        const auto first = static_cast<Index>(random_() % count);
        const auto step = static_cast<Index>(1 + random_() % (count - 1));
        return {first, (first + step) % static_cast<Index>(count)};
    }

    double fraction() { return std::uniform_real_distribution<double>()(random_); }

    std::mt19937_64 random_;
    std::size_t largest_;
    std::map<std::string, std::size_t> sizes_ = {{"gridpoint", 3 + largest_}};
};

template <class Record>
bool same(const Record& left, const Record& right)
{
    const auto fields = schema::fields_of(fields::reading(left));
    const auto others = schema::fields_of(fields::reading(right));
    const auto equal = [](const fields::Values& a, const fields::Values& b) {
        return std::visit(
            [&](auto* value) { return *value == *std::get<std::remove_const_t<decltype(value)>>(b); }, a);
    };
    return std::ranges::equal(fields, others, equal, &fields::Field::values, &fields::Field::values);
}

inline bool same(const NetworkFile& left, const NetworkFile& right)
{
    return same(left.provenance, right.provenance) && left.provenance.seed == right.provenance.seed &&
           left.provenance.realization == right.provenance.realization && same(left.network, right.network);
}

inline bool same(const JointsFile& left, const JointsFile& right)
{
    return same(static_cast<const NetworkFile&>(left), static_cast<const NetworkFile&>(right)) &&
           same(left.equivalent, right.equivalent);
}

inline bool same(const ResultFile& left, const ResultFile& right)
{
    return same(static_cast<const JointsFile&>(left), static_cast<const JointsFile&>(right)) &&
           same(left.result, right.result) && same(left.result.step_history, right.result.step_history) &&
           same(left.result.guards, right.result.guards) && same(left.result.failure, right.result.failure) &&
           same(left.safety, right.safety);
}

inline bool same(const CheckpointFile& left, const CheckpointFile& right)
{
    return same(static_cast<const ResultFile&>(left), static_cast<const ResultFile&>(right)) &&
           same(left.checkpoint, right.checkpoint) &&
           same(left.checkpoint.dynamics, right.checkpoint.dynamics);
}

inline void write(const std::string& path, const ResultFile& file)
{
    write_result(path, file.provenance, file.network, file.equivalent, file.result, file.safety);
}

} // namespace jointcreep::store
