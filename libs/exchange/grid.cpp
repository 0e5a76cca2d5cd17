#include "exchange/grid.hpp"

#include "store/arrays.hpp"

#include <bit>
#include <cstring>
#include <span>

namespace jointcreep::exchange
{

namespace
{

template <class Vector>
GridArray in_three(std::string name, const std::vector<Vector>& vectors)
{
    std::vector<double> flat;
    flat.reserve(3 * vectors.size());
    for (const Vector& vector : vectors)
        for (Eigen::Index i = 0; i < 3; ++i)
            flat.push_back(i < vector.size() ? vector[i] : 0.0);
    return {std::move(name), 3, std::move(flat)};
}

// Bytes in base64 (RFC 4648).
std::string base64(std::span<const unsigned char> bytes)
{
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t at) { return at < bytes.size() ? unsigned{bytes[at]} : 0U; };
        const unsigned three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        text += letters[three >> 18];
        text += letters[three >> 12 & 63];
        text += i + 1 < bytes.size() ? letters[three >> 6 & 63] : '=';
        text += i + 2 < bytes.size() ? letters[three & 63] : '=';
    }
    return text;
}

constexpr std::string_view type_of(double)
{
    return "Float64";
}
constexpr std::string_view type_of(Index)
{
    return "Int32";
}
constexpr std::string_view type_of(std::int64_t)
{
    return "Int64";
}
constexpr std::string_view type_of(unsigned char)
{
    return "UInt8";
}

// The text of a grid, in the order in which VTK wants its parts.
class GridText
{
public:
    void section(std::string_view name, const std::vector<GridArray>& arrays)
    {
        if (arrays.empty() && name != "FieldData")
            return;
        text_.append("<").append(name).append(">\n");
        for (const GridArray& array : arrays)
            std::visit([&](const auto& values) { add(name, array, values); }, array.values);
        text_.append("</").append(name).append(">\n");
    }
    void write(std::string_view text) { text_ += text; }
    std::string finish()
    {
        return text_ + "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"base64\">\n_" + appended_ +
               "\n</AppendedData>\n</VTKFile>\n";
    }

private:
    template <class Value>
    void add(std::string_view section, const GridArray& array, const std::vector<Value>& values)
    {
        text_.append("<DataArray type=\"").append(type_of(Value{})).append("\" Name=\"").append(array.name);
        // In field data the number of tuples is to be said.
        text_.append(section == "FieldData" ? "\" NumberOfTuples=\"" : "\" NumberOfComponents=\"");
        text_.append(std::to_string(section == "FieldData" ? values.size() : array.components));
        text_.append("\" format=\"appended\" offset=\"").append(std::to_string(appended_.size()));
        text_ += "\"/>\n";
        static_assert(std::endian::native == std::endian::little);
        const std::uint64_t size = values.size() * sizeof(Value);
        std::vector<unsigned char> bytes(sizeof size + size);
        std::memcpy(bytes.data(), &size, sizeof size);
        if (size > 0)
            std::memcpy(bytes.data() + sizeof size, values.data(), size);
        appended_ += base64(bytes);
    }

    std::string text_, appended_;
};

std::vector<unsigned char> types_of(const Grid& grid)
{
    return std::vector<unsigned char>(grid.offsets.size(), static_cast<unsigned char>(grid.type));
}

} // namespace

GridArray array_of(std::string name, const std::vector<Eigen::Vector2d>& vectors)
{
    return in_three(std::move(name), vectors);
}

GridArray array_of(std::string name, const std::vector<Eigen::Vector3d>& vectors)
{
    return in_three(std::move(name), vectors);
}

GridArray array_of(std::string name, const std::vector<std::string>& names)
{
    std::vector<unsigned char> bytes;
    for (const std::string& text : names) {
        bytes.insert(bytes.end(), text.begin(), text.end());
        bytes.push_back(0);
    }
    return {std::move(name), 1, std::move(bytes)};
}

std::string vtu_of(const Grid& grid)
{
    GridText text;
    text.write("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
               "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
               "header_type=\"UInt64\">\n<UnstructuredGrid>\n");
    text.section("FieldData", grid.field_data);
    text.write("<Piece NumberOfPoints=\"" + std::to_string(grid.point_count()) + "\" NumberOfCells=\"" +
               std::to_string(grid.offsets.size()) + "\">\n");
    text.section("PointData", grid.point_data);
    text.section("CellData", grid.cell_data);
    text.section("Points", {grid.points});
    text.section("Cells", {array_of("connectivity", grid.connectivity), array_of("offsets", grid.offsets),
                           array_of("types", types_of(grid))});
    return text.finish();
}

std::string vtkhdf_of(const Grid& grid)
{
    using Whole = std::vector<std::int64_t>;
    std::vector<GridArray> arrays{
        array_of("NumberOfConnectivityIds", Whole{static_cast<std::int64_t>(grid.connectivity.size())}),
        array_of("NumberOfPoints", Whole{static_cast<std::int64_t>(grid.point_count())}),
        array_of("NumberOfCells", Whole{static_cast<std::int64_t>(grid.offsets.size())})};
    arrays.push_back(grid.points);
    arrays.back().name = "Points";
    Whole offsets{0}; // here also where the first cell begins
    offsets.insert(offsets.end(), grid.offsets.begin(), grid.offsets.end());
    arrays.push_back(array_of("Connectivity", grid.connectivity));
    arrays.push_back(array_of("Offsets", offsets));
    arrays.push_back(array_of("Types", types_of(grid)));
    const auto add = [&](const char* section, const std::vector<GridArray>& of_section) {
        for (const GridArray& array : of_section) {
            arrays.push_back(array);
            arrays.back().name = section + array.name;
        }
    };
    add("FieldData/", grid.field_data);
    add("PointData/", grid.point_data);
    add("CellData/", grid.cell_data);

    std::vector<store::PlainArray> plain;
    for (const GridArray& array : arrays)
        plain.push_back(
            {"/VTKHDF/" + array.name, array.components,
             std::visit([](const auto& values) -> store::PlainValues { return std::span(values); },
                        array.values)});
    return store::hdf5_of(plain, "/VTKHDF", {{"Type", "UnstructuredGrid"}}, {{"Version", {1, 0}}});
}

} // namespace jointcreep::exchange
