#include "exchange/xdmf.hpp"

#include "exchange/forces.hpp"
#include "exchange/text.hpp"
#include "model/error.hpp"
#include "model/utf8.hpp"

#include <algorithm>
#include <initializer_list>
#include <span>
#include <string_view>
#include <utility>

namespace jointcreep::exchange
{

namespace
{

using fields::Column;
using fields::ForceColumns;

// Types of numbers, as a data item's attributes.
constexpr std::string_view real = "NumberType=\"Float\" Precision=\"8\"";
constexpr std::string_view integer = "NumberType=\"Int\" Precision=\"4\"";
constexpr std::string_view byte = "NumberType=\"UChar\" Precision=\"1\"";

std::string text_of(std::initializer_list<std::size_t> numbers)
{
    std::string text;
    for (const std::size_t number : numbers)
        text.append(text.empty() ? "" : " ").append(std::to_string(number));
    return text;
}

// A name of a file as text of XML, which has no way to write most control characters.
std::string escaped(const std::string& text)
{
    if (!is_plain_text(text))
        throw input_error(
            text + ": an .xdmf2 file cannot refer to a name with control characters, or one that is not "
                   "UTF-8. Rename the file");
    return xml_text(text);
}

// Times that tell the states apart, strictly increasing [day].
std::vector<double> distinct(std::vector<double> times)
{
    for (std::size_t i = times.size() - 1; i-- > 0;)
        times[i] = std::min(times[i], times[i + 1] - 0.001);
    return times;
}

// What is there in each state, without repetition: which of the patterns a state has, and the patterns.
struct Presence {
    std::vector<std::size_t> pattern_of; // [state]
    std::vector<std::vector<bool>> patterns;
};

// `codes` [state, cell] are 0 where a cell is removed.
Presence presence_of(std::span<const Index> codes, std::size_t states)
{
    const std::size_t cells = codes.size() / states;
    Presence presence;
    for (std::size_t state = 0; state < states; ++state) {
        std::vector<bool> there(cells);
        for (std::size_t cell = 0; cell < cells; ++cell)
            there[cell] = codes[state * cells + cell] != 0;
        if (presence.patterns.empty() || presence.patterns.back() != there) // rock never comes back
            presence.patterns.push_back(std::move(there));
        presence.pattern_of.push_back(presence.patterns.size() - 1);
    }
    return presence;
}

// The text of a temporal collection, in the order in which it is read.
class CollectionText
{
public:
    CollectionText(std::string_view name, const Result& result, const std::string& result_file,
                   const std::vector<Index>& codes)
        : file_(escaped(result_file)), time_(distinct(result.states.time)),
          presence_(presence_of(codes, time_.size())), cells_(codes.size() / time_.size())
    {
        text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n";
        for (const std::vector<bool>& pattern : presence_.patterns) {
            text_.append("<DataItem Format=\"XML\" ").append(byte);
            text_.append(" Dimensions=\"").append(text_of({cells_})).append("\">\n");
            for (std::size_t cell = 0; cell < cells_; ++cell)
                text_.append(pattern[cell] ? "0" : "32").append(cell % 32 == 31 ? "\n" : " ");
            text_ += "\n</DataItem>\n";
        }
        text_.append("<Grid Name=\"").append(name);
        text_ += "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
    }

    void open_state()
    {
        text_.append("<Grid Name=\"state ").append(std::to_string(state_));
        text_.append("\" GridType=\"Uniform\">\n<Time Value=\"")
            .append(shown(time_[state_]))
            .append("\"/>\n");
    }

    void triangles(const std::string& path)
    {
        text_.append("<Topology TopologyType=\"Triangle\" NumberOfElements=\"").append(text_of({cells_}));
        text_ += "\">\n";
        dataset(integer, path, {cells_, 3});
        text_ += "</Topology>\n";
    }

    void vertices()
    {
        text_.append("<Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" NumberOfElements=\"");
        text_.append(text_of({cells_})).append("\"/>\n");
    }

    void points(const std::string& path, std::size_t number)
    {
        text_ += "<Geometry GeometryType=\"XY\">\n";
        dataset(real, path, {number, 2});
        text_ += "</Geometry>\n";
    }

    // A dataset that holds for all states.
    void scalar(std::string_view name, std::string_view centre, std::string_view type,
                const std::string& path, std::size_t rows)
    {
        open_attribute(name, "Scalar", centre, {rows});
        dataset(type, path, {rows});
        text_ += "</Attribute>\n";
    }

    // This state's part of a dataset [state, row], or of one column of a dataset [state, row, column].
    void scalar_of_state(std::string_view name, std::string_view centre, std::string_view type,
                         const std::string& path, std::size_t rows)
    {
        open_attribute(name, "Scalar", centre, {rows});
        part(type, path, {rows}, {state_, 0}, {1, rows}, {time_.size(), rows});
        text_ += "</Attribute>\n";
    }
    void column_of_state(std::string_view name, std::string_view centre, const std::string& path,
                         std::size_t rows, std::size_t columns, std::size_t column)
    {
        open_attribute(name, "Scalar", centre, {rows});
        part(real, path, {rows}, {state_, 0, column}, {1, rows, 1}, {time_.size(), rows, columns});
        text_ += "</Attribute>\n";
    }
    // ... or of a dataset of vectors [state, row, 2], to which the reader adds a third component, 0.
    void vector_of_state(std::string_view name, std::string_view centre, const std::string& path,
                         std::size_t rows)
    {
        open_attribute(name, "Vector", centre, {rows, 2});
        part(real, path, {rows, 2}, {state_, 0, 0}, {1, rows, 2}, {time_.size(), rows, 2});
        text_ += "</Attribute>\n";
    }

    // ... or of the dataset of a column.
    void column_of_state(const Column& column, std::string_view centre, std::size_t rows)
    {
        if (column.components == 1)
            scalar_of_state(column.name, centre, column.is_integer ? integer : real, column.dataset, rows);
        else
            column_of_state(column.name, centre, column.dataset, rows, column.components, column.component);
    }

    // Writes what is hidden, and continues with the next state.
    void close_state()
    {
        open_attribute("vtkGhostType", "Scalar", "Cell", {cells_});
        text_ += "<DataItem Reference=\"XML\">/Xdmf/Domain/DataItem[";
        text_.append(text_of({presence_.pattern_of[state_] + 1})).append("]</DataItem>\n"); // from 1
        text_ += "</Attribute>\n</Grid>\n";
        ++state_;
    }

    std::string finish() const { return text_ + "</Grid>\n</Domain>\n</Xdmf>\n"; }

private:
    void open_attribute(std::string_view name, std::string_view type, std::string_view centre,
                        std::initializer_list<std::size_t> shape)
    {
        text_.append("<Attribute Name=\"").append(name).append("\" AttributeType=\"").append(type);
        text_.append("\" Center=\"").append(centre).append("\" Dimensions=\"").append(text_of(shape));
        text_ += "\">\n";
    }

    void dataset(std::string_view type, const std::string& path, std::initializer_list<std::size_t> shape)
    {
        text_.append("<DataItem Format=\"HDF\" ").append(type);
        text_.append(" Dimensions=\"").append(text_of(shape)).append("\">");
        text_.append(file_).append(":").append(path).append("</DataItem>\n");
    }

    // `count` values from `start` on, of a dataset with `shape`, as an array with `part_shape`.
    void part(std::string_view type, const std::string& path, std::initializer_list<std::size_t> part_shape,
              std::initializer_list<std::size_t> start, std::initializer_list<std::size_t> count,
              std::initializer_list<std::size_t> shape)
    {
        text_.append("<DataItem ItemType=\"HyperSlab\" ").append(type);
        text_.append(" Dimensions=\"").append(text_of(part_shape)).append("\">\n");
        text_.append("<DataItem Format=\"XML\" ").append(integer);
        text_.append(" Dimensions=\"").append(text_of({3, start.size()})).append("\">");
        text_.append(text_of(start)).append(start.size() == 2 ? "  1 1  " : "  1 1 1  ");
        text_.append(text_of(count)).append("</DataItem>\n");
        dataset(type, path, shape);
        text_ += "</DataItem>\n";
    }

    std::string file_;
    std::vector<double> time_;
    Presence presence_;
    std::size_t cells_;
    std::size_t state_ = 0;
    std::string text_;
};

// The columns that have a dataset with a value for every row.
std::vector<Column> in_datasets(std::vector<Column> columns)
{
    std::erase_if(columns, [](const Column& column) { return column.dataset.empty(); });
    return columns;
}

void require_states(const Result& result)
{
    if (result.states.time.empty())
        throw input_error("there is no state in this result");
}

} // namespace

std::string zones_xdmf(const Result& result, const std::string& result_file)
{
    require_states(result);
    const std::size_t gridpoints = result.mesh.gridpoint.size();
    const std::size_t zones = result.mesh.zone_block.size();
    const std::vector<Column> columns = in_datasets(columns_of(&ForceColumns::of_zones, result, 0));
    CollectionText text("zones", result, result_file, result.states.zone_present);
    for (std::size_t state = 0; state < result.states.time.size(); ++state) {
        text.open_state();
        text.triangles("/mesh/zone_gridpoint");
        text.points("/mesh/gridpoint_position", gridpoints);
        text.vector_of_state("displacement", "Node", "/states/displacement", gridpoints);
        for (const Column& column : columns)
            text.column_of_state(column, "Cell", zones);
        text.scalar_of_state("zone_present", "Cell", integer, "/states/zone_present", zones);
        text.scalar("block", "Cell", integer, "/mesh/zone_block", zones);
        text.close_state();
    }
    return text.finish();
}

std::string contacts_xdmf(const Result& result, const std::string& result_file)
{
    require_states(result);
    const std::size_t contacts = result.mesh.contact_edge.size();
    if (contacts == 0)
        throw input_error("there is no contact in this result");
    const std::vector<Column> columns = in_datasets(columns_of(&ForceColumns::of_contacts, result, 0));
    CollectionText text("contacts", result, result_file, result.states.contact_status);
    for (std::size_t state = 0; state < result.states.time.size(); ++state) {
        text.open_state();
        text.vertices();
        text.points("/mesh/contact_centre", contacts);
        for (const Column& column : columns)
            text.column_of_state(column, "Node", contacts);
        text.scalar("length", "Node", real, "/mesh/contact_length", contacts);
        text.close_state();
    }
    return text.finish();
}

} // namespace jointcreep::exchange
