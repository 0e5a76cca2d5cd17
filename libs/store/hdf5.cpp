#include "store/hdf5.hpp"

#include "model/error.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <new>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace jointcreep::store::hdf5
{

using fields::Field;
using schema::Dimensions;

namespace
{

constexpr hsize_t chunk_bytes = 1 << 20;
constexpr hsize_t most_elements = hsize_t(1) << 31;
constexpr unsigned deflation = 1;            // level
const std::string with_scales = "/history/"; // the group whose axes have coordinates in it
constexpr hsize_t best_compression = 1100;   // deflate cannot do better than about 1030 to 1

extern "C" herr_t take_description(unsigned, const H5E_error2_t* error, void* text)
{
    *static_cast<std::string*>(text) = error->desc ? error->desc : "";
    return 1; // stop: the first is the innermost
}

// Why HDF5 failed, in its own words.
std::string reason()
{
    std::string text;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_description, &text);
    return text.empty() ? "HDF5 gives no reason" : text;
}

template <class Result>
Result ok(Result result, const std::string& what)
{
    if (result < 0)
        throw file_error("cannot " + what + ": " + reason());
    return result;
}

// Before a file is opened or made. HDF5 crashes where it gets no memory for its own tables, or gives another reason:
// where memory is limited, so much must be free.
void begin()
{
    constexpr std::size_t room = std::size_t{16} << 20; // [bytes]
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        ::operator delete(::operator new(room));
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Object properties(hid_t kind)
{
    return {H5Pcreate(kind), H5Pclose, "set up HDF5"};
}

// Creation properties without times, which would make two equal files differ.
Object timeless(hid_t kind)
{
    Object list = properties(kind);
    ok(H5Pset_obj_track_times(list, false), "set up HDF5");
    return list;
}

// HDF5 makes the file in our memory, so that the closed file is still there when HDF5 has freed its own. (What
// H5Fget_file_image gives of an open file has a superblock with a wrong checksum in HDF5 1.10.)
extern "C" void* grow(void*, std::size_t size, H5FD_file_image_op_t, void* memory)
try {
    auto& bytes = *static_cast<std::vector<std::byte>*>(memory);
    bytes.resize(size);
    return bytes.data();
} catch (const std::bad_alloc&) {
    return nullptr;
}

extern "C" herr_t keep(void*, H5FD_file_image_op_t, void*)
{
    return 0;
}

extern "C" void* same_memory(void* memory)
{
    return memory;
}

extern "C" herr_t keep_memory(void*)
{
    return 0;
}

Object create_in(std::vector<std::byte>& memory)
{
    begin();
    const Object access = properties(H5P_FILE_ACCESS);
    constexpr std::size_t growth = 1 << 20;
    ok(H5Pset_fapl_core(access, growth, false), "set up HDF5");
    H5FD_file_image_callbacks_t callbacks{};
    callbacks.image_realloc = grow;
    callbacks.image_free = keep;
    callbacks.udata_copy = same_memory;
    callbacks.udata_free = keep_memory;
    callbacks.udata = &memory;
    ok(H5Pset_file_image_callbacks(access, &callbacks), "set up HDF5");
    ok(H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110), "set up HDF5"); // checksums everywhere
    const Object creation = timeless(H5P_FILE_CREATE);
    return {H5Fcreate("image", H5F_ACC_TRUNC, creation, access), H5Fclose, "create a file in memory"};
}

// The length that a closed file of this version says it has: the end-of-file address in its superblock.
std::size_t length_of(const std::vector<std::byte>& file)
{
    constexpr std::size_t place = 28;
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < sizeof length; ++i)
        length |= std::to_integer<std::uint64_t>(file.at(place + i)) << (8 * i);
    return length;
}

// Text of fixed length, padded with zero bytes: variable length would put it where nothing checks it.
Object text_type(std::size_t length)
{
    Object type(H5Tcopy(H5T_C_S1), H5Tclose, "set up HDF5");
    ok(H5Tset_size(type, std::max<std::size_t>(length, 1)), "set up HDF5");
    ok(H5Tset_strpad(type, H5T_STR_NULLPAD), "set up HDF5");
    ok(H5Tset_cset(type, H5T_CSET_UTF8), "set up HDF5");
    return type;
}

Object number_type(hid_t type)
{
    return {H5Tcopy(type), H5Tclose, "set up HDF5"};
}

struct Written {
    Object type; // in the file and in memory
    const void* data;
    std::string text; // what `data` points to, if it is text
};

Written written(std::span<double> values)
{
    return {number_type(H5T_IEEE_F64LE), values.data(), {}};
}

Written written(std::span<Index> values)
{
    return {number_type(H5T_STD_I32LE), values.data(), {}};
}

Written written(std::span<std::string> values)
{
    std::size_t length = 1;
    for (const std::string& value : values)
        length = std::max(length, value.size());
    Written result{text_type(length), nullptr, std::string(values.size() * length, '\0')};
    for (std::size_t i = 0; i < values.size(); ++i)
        std::ranges::copy(values[i], result.text.begin() + static_cast<std::ptrdiff_t>(i * length));
    return result;
}

std::vector<hsize_t> extents_of(const Field& field, const Dimensions& dimensions)
{
    std::vector<hsize_t> extents;
    if (field.dimensions.size() < 2)
        extents.push_back(fields::rows(field.values));
    else
        for (const std::string& name : field.dimensions)
            extents.push_back(dimensions.size(name));
    if (fields::components(field.values) > 1)
        extents.push_back(fields::components(field.values));
    return extents;
}

// Chunks of about 1 MiB, as equal as can be so that little of the last one is padding.
std::vector<hsize_t> chunk_of(std::vector<hsize_t> extents, std::size_t element_bytes)
{
    hsize_t bytes = element_bytes;
    for (const hsize_t extent : extents)
        bytes *= extent;
    for (hsize_t& extent : extents) {
        if (bytes <= chunk_bytes)
            break;
        const hsize_t row_bytes = bytes / extent;
        const hsize_t fitting = std::max<hsize_t>(1, chunk_bytes / row_bytes);
        const hsize_t pieces = (extent + fitting - 1) / fitting;
        extent = (extent + pieces - 1) / pieces;
        bytes = row_bytes * extent;
    }
    return extents;
}

// Whether deflating is worth its time: a piece from the middle, shuffled as HDF5 does it, loses a quarter.
// Coordinates do not.
bool is_worth_deflating(const void* data, std::size_t elements, std::size_t element_bytes)
{
    constexpr std::size_t piece = 1 << 16; // bytes
    const std::size_t count = piece / element_bytes;
    if (elements < 4 * count)
        return true;
    const auto* const from = static_cast<const Bytef*>(data) + elements / 2 * element_bytes;
    std::vector<Bytef> shuffled(count * element_bytes), deflated(compressBound(shuffled.size()));
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t byte = 0; byte < element_bytes; ++byte)
            shuffled[byte * count + i] = from[i * element_bytes + byte];
    uLongf size = deflated.size();
    return compress2(deflated.data(), &size, shuffled.data(), shuffled.size(), deflation) != Z_OK ||
           size < shuffled.size() / 4 * 3;
}

void write_text(hid_t object, const std::string& name, const std::string& value)
{
    const Object type = text_type(value.size());
    const Object space(H5Screate(H5S_SCALAR), H5Sclose, "set up HDF5");
    const Object attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                           "create the attribute " + name);
    ok(H5Awrite(attribute, type, value.c_str()), "write the attribute " + name);
}

void write_numbers(hid_t object, const std::string& name, hid_t type, const void* values, hsize_t count)
{
    const Object space(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose,
                       "set up HDF5");
    const Object attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                           "create the attribute " + name);
    ok(H5Awrite(attribute, type, values), "write the attribute " + name);
}

void write_list(hid_t object, const std::string& name, hid_t type, const void* values, hsize_t count)
{
    const Object space(H5Screate_simple(1, &count, nullptr), H5Sclose, "set up HDF5");
    const Object attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                           "create the attribute " + name);
    ok(H5Awrite(attribute, type, values), "write the attribute " + name);
}

// Names of the dataset's axes, as H5DSset_label() of the high-level library writes them: text of variable length.
void write_labels(hid_t dataset, const std::vector<std::string>& axes)
{
    std::vector<const char*> labels;
    for (const std::string& axis : axes)
        labels.push_back(axis.c_str());
    if (labels.empty())
        return;
    const Object type(H5Tcopy(H5T_C_S1), H5Tclose, "set up HDF5");
    ok(H5Tset_size(type, H5T_VARIABLE), "set up HDF5");
    write_list(dataset, "DIMENSION_LABELS", type, labels.data(), labels.size());
}

std::vector<std::string> axes_of(const Field& field)
{
    std::vector<std::string> axes = field.dimensions;
    if (!axes.empty() && fields::components(field.values) > 1)
        axes.emplace_back("component");
    return axes;
}

// Text as the high-level library of HDF5 writes it into attributes of dimension scales.
void write_terminated_text(hid_t dataset, const std::string& name, const std::string& value)
{
    const Object type(H5Tcopy(H5T_C_S1), H5Tclose, "set up HDF5");
    ok(H5Tset_size(type, value.size() + 1), "set up HDF5");
    write_numbers(dataset, name, type, value.c_str(), 1);
}

hobj_ref_t reference_to(hid_t file, const std::string& path)
{
    hobj_ref_t reference{};
    ok(H5Rcreate(&reference, file, path.c_str(), H5R_OBJECT, -1), "refer to " + path);
    return reference;
}

hid_t plain_type_of(std::span<const double>)
{
    return H5T_IEEE_F64LE;
}
hid_t plain_type_of(std::span<const Index>)
{
    return H5T_STD_I32LE;
}
hid_t plain_type_of(std::span<const std::int64_t>)
{
    return H5T_STD_I64LE;
}
hid_t plain_type_of(std::span<const unsigned char>)
{
    return H5T_STD_U8LE;
}

std::string without_padding(std::string text)
{
    text.erase(text.find_last_not_of('\0') + 1);
    return text;
}

bool is_fixed_text(hid_t type)
{
    return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
           H5Tget_strpad(type) != H5T_STR_SPACEPAD;
}

std::string text_attribute(hid_t object, const std::string& name, const std::string& owner)
{
    if (!ok(H5Aexists(object, name.c_str()), "find the attribute " + name))
        throw input_error(owner + " has no attribute " + name);
    const Object attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                           "open the attribute " + name);
    const Object type(H5Aget_type(attribute), H5Tclose, "read the type of the attribute " + name);
    const Object space(H5Aget_space(attribute), H5Sclose, "read the shape of the attribute " + name);
    constexpr std::size_t longest = 1 << 16; // what HDF5 itself allows
    if (!is_fixed_text(type) || H5Sget_simple_extent_npoints(space) != 1 || H5Tget_size(type) > longest)
        throw input_error("the attribute " + name + " of " + owner + " is not one fixed-length text");
    std::string text(H5Tget_size(type), '\0');
    ok(H5Aread(attribute, type, text.data()), "read the attribute " + name);
    return without_padding(text);
}

void read_numbers(hid_t file, const std::string& name, hid_t type, void* values, std::size_t count)
{
    if (!ok(H5Aexists(file, name.c_str()), "find the attribute " + name))
        throw input_error("the file has no attribute " + name);
    const Object attribute(H5Aopen(file, name.c_str(), H5P_DEFAULT), H5Aclose, "open the attribute " + name);
    const Object actual(H5Aget_type(attribute), H5Tclose, "read the type of the attribute " + name);
    const Object space(H5Aget_space(attribute), H5Sclose, "read the shape of the attribute " + name);
    if (H5Tget_class(actual) != H5T_INTEGER || H5Sget_simple_extent_npoints(space) != hssize_t(count))
        throw input_error("the attribute " + name + " is not made of " + std::to_string(count) + " integers");
    ok(H5Aread(attribute, type, values), "read the attribute " + name);
}

std::uint64_t size_of_file(const std::string& path)
{
    struct stat status {
    };
    if (::stat(path.c_str(), &status) != 0 || ::access(path.c_str(), R_OK) != 0)
        throw file_error(std::string("cannot read: ") + std::strerror(errno));
    if (!S_ISREG(status.st_mode))
        throw file_error("cannot read: this is not a regular file");
    return static_cast<std::uint64_t>(status.st_size);
}

// Whether a file begins as text does.
bool is_text(const std::string& path)
{
    std::array<char, 256> begin{};
    std::ifstream file(path, std::ios::binary);
    file.read(begin.data(), begin.size());
    const auto of_text = [](char c) { return (c >= ' ' && c < 0x7f) || c == '\n' || c == '\r' || c == '\t'; };
    return file.gcount() > 0 && std::all_of(begin.begin(), begin.begin() + file.gcount(), of_text);
}

Object open_for_reading(const std::string& path)
{
    if (path.ends_with(".toml"))
        throw input_error("is a scene; expected a file of the chain. First run: jointgen " + path +
                          " -o network.h5, then strength-averaging network.h5 -o joints.h5");
    begin();
    const Object access = properties(H5P_FILE_ACCESS);
    ok(H5Pset_file_locking(access, false, true), "set up HDF5"); // files are never changed in place
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
    if (file < 0 && is_text(path))
        throw file_error(
            "this is a text file; expected a file of the chain, which is HDF5 (network.h5, joints.h5, result.h5)");
    return {file, H5Fclose, "read as HDF5"};
}

// A link for every part of the path; H5Lexists wants all but the last to be there. None may lead to another file.
bool exists(hid_t file, const std::string& path)
{
    for (std::size_t end = 0; end != std::string::npos;) {
        end = path.find('/', end + 1);
        const std::string part = path.substr(0, end);
        if (!ok(H5Lexists(file, part.c_str(), H5P_DEFAULT), "look for " + path))
            return false;
        H5L_info_t link;
        ok(H5Lget_info(file, part.c_str(), &link, H5P_DEFAULT), "look for " + path);
        if (link.type == H5L_TYPE_EXTERNAL)
            throw input_error(part + " is a link to another file; expected it in this one");
    }
    return true;
}

// HDF5 can take values from any file that a dataset names.
void require_own_values(hid_t dataset, const std::string& path)
{
    const Object creation(H5Dget_create_plist(dataset), H5Pclose, "read the layout of " + path);
    if (H5Pget_layout(creation) == H5D_VIRTUAL ||
        ok(H5Pget_external_count(creation), "read the layout of " + path) > 0)
        throw input_error(path + " has its values in another file; expected them in this one");
}

struct TypeCheck {
    const std::string& path;
    hid_t type;
    void operator()(std::span<double>) const { want(H5Tequal(type, H5T_IEEE_F64LE) > 0, "float64"); }
    void operator()(std::span<Index>) const { want(H5Tequal(type, H5T_STD_I32LE) > 0, "int32"); }
    void operator()(std::span<std::string>) const { want(is_fixed_text(type), "fixed-length text"); }
    void want(bool holds, const char* wanted) const
    {
        if (!holds)
            throw input_error(path + " is of the wrong type; expected " + wanted);
    }
};

// Reads a whole dataset, whose `type` and number of values are right, into memory.
struct Fill {
    const std::string& path;
    hid_t dataset, type;
    void operator()(std::span<double> values) const { read(H5T_NATIVE_DOUBLE, values.data()); }
    void operator()(std::span<Index> values) const { read(H5T_NATIVE_INT32, values.data()); }
    void operator()(std::span<std::string> values) const
    {
        const std::size_t length = H5Tget_size(type);
        std::string all(values.size() * length, '\0');
        read(type, all.data());
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = without_padding(all.substr(i * length, length));
    }
    void read(hid_t as, void* values) const
    {
        ok(H5Dread(dataset, as, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "read " + path);
    }
};

// A damaged shape must not make us ask for more memory than what is stored can fill.
void require_stored(const Field& field, hid_t dataset, hid_t type, hsize_t elements, std::uint64_t file_bytes)
{
    const hsize_t stored = H5Dget_storage_size(dataset);
    const hsize_t element_bytes = H5Tget_size(type);
    if (stored > file_bytes || element_bytes > stored * best_compression ||
        elements * element_bytes > stored * best_compression)
        throw file_error(field.path + " is damaged: " + std::to_string(stored) + " bytes are stored for " +
                         std::to_string(elements) + " values of " + std::to_string(element_bytes) + " bytes");
}

// Number of values in the dataset, once its shape is found to be that of the field.
hsize_t checked_count(const Field& field, hid_t space, Dimensions& dimensions)
{
    const std::size_t axes = std::max<std::size_t>(field.dimensions.size(), 1);
    const std::size_t inner = fields::components(field.values);
    const std::size_t rank = axes + (inner > 1 ? 1 : 0);
    if (H5Sget_simple_extent_type(space) != H5S_SIMPLE || H5Sget_simple_extent_ndims(space) != int(rank))
        throw input_error(field.path + " has the wrong number of dimensions; expected " +
                          std::to_string(rank));
    std::vector<hsize_t> extents(rank);
    ok(H5Sget_simple_extent_dims(space, extents.data(), nullptr), "read the shape of " + field.path);
    hsize_t elements = 1;
    for (const hsize_t extent : extents) {
        if (extent > most_elements || (elements *= extent) > most_elements)
            throw input_error(field.path + " has more than " + std::to_string(most_elements) + " values");
    }
    for (std::size_t axis = 0; axis < field.dimensions.size(); ++axis)
        if (const schema::Fault fault = dimensions.fault(field, axis, extents[axis]))
            throw input_error(*fault);
    if (field.dimensions.empty() && extents[0] != 1)
        throw input_error(field.path + " has " + std::to_string(extents[0]) + " values; expected 1");
    if (inner > 1 && extents.back() != inner)
        throw input_error(field.path + " has rows of " + std::to_string(extents.back()) +
                          " values; expected " + std::to_string(inner));
    return elements;
}

} // namespace

Object::Object(hid_t id, herr_t (*closing)(hid_t), const std::string& what)
    : id_(ok(id, what)), close_(closing)
{
}

void Object::close(const std::string& what)
{
    ok(close_(std::exchange(id_, -1)), what);
}

Image::Image() : file_(create_in(memory_)) {}

void Image::make_group_of(const std::string& path)
{
    const std::string group = path.substr(0, path.rfind('/'));
    if (group.empty() || !groups_.insert(group).second)
        return;
    make_group_of(group);
    const Object creation = timeless(H5P_GROUP_CREATE);
    Object(H5Gcreate2(file_, group.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, "create " + group);
}

// The dataset, with its values.
Object Image::add(const std::string& path, hid_t type, const void* data, const std::vector<hsize_t>& extents)
{
    make_group_of(path);
    const int rank = static_cast<int>(extents.size());
    const bool empty = std::ranges::find(extents, hsize_t(0)) != extents.end();
    const Object space(H5Screate_simple(rank, extents.data(), nullptr), H5Sclose, "set up HDF5");
    const Object creation = timeless(H5P_DATASET_CREATE);
    if (!empty) {
        const std::size_t element_bytes = H5Tget_size(type);
        const auto elements = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
        ok(H5Pset_chunk(creation, rank, chunk_of(extents, element_bytes).data()), "set up HDF5");
        if (is_worth_deflating(data, elements, element_bytes)) {
            ok(H5Pset_shuffle(creation), "set up HDF5");
            ok(H5Pset_deflate(creation, deflation), "set up HDF5");
        }
        ok(H5Pset_fletcher32(creation), "set up HDF5");
    }
    Object dataset(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                   "create " + path);
    if (!empty)
        ok(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write " + path);
    return dataset;
}

void Image::add(const Field& field, const Dimensions& dimensions)
{
    Written values = std::visit([](auto span) { return written(span); }, fields::flat(field.values));
    if (!values.text.empty())
        values.data = values.text.data();
    const Object dataset = add(field.path, values.type, values.data, extents_of(field, dimensions));
    write_text(dataset, "units", field.units);
    write_text(dataset, "description", field.description);
    const std::vector<std::string> axes = axes_of(field);
    write_labels(dataset, axes);
    if (field.path.starts_with(with_scales) && !axes.empty())
        axes_[field.path] = axes;
}

// Attributes as H5DSset_scale() and H5DSattach_scale() of the high-level library write them: the datasets named as the
// axes are dimension scales of the others. Readers such as xarray take all axes of a dataset or none from them.
void Image::attach_scales()
{
    if (axes_.empty())
        return;
    std::vector<std::string> components;
    add(schema::component_of_history(components), {});
    const auto has_scale = [&](const std::string& axis) { return axes_.contains(with_scales + axis); };

    struct Use {
        hobj_ref_t dataset;
        std::int64_t axis;
    };
    std::map<std::string, std::vector<Use>> uses; // of each scale
    const Object list_type(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose, "set up HDF5");
    for (const auto& [path, axes] : axes_) {
        if (path == with_scales + axes[0] || !std::ranges::all_of(axes, has_scale))
            continue; // itself a scale, or without some
        std::vector<hobj_ref_t> scales;
        for (std::size_t axis = 0; axis < axes.size(); ++axis) {
            scales.push_back(reference_to(file_, with_scales + axes[axis]));
            uses[with_scales + axes[axis]].push_back(
                {reference_to(file_, path), static_cast<std::int64_t>(axis)});
        }
        std::vector<hvl_t> lists;
        for (hobj_ref_t& scale : scales)
            lists.push_back({1, &scale});
        const Object dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
        write_list(dataset, "DIMENSION_LIST", list_type, lists.data(), lists.size());
    }
    const Object in_memory(H5Tcreate(H5T_COMPOUND, sizeof(Use)), H5Tclose, "set up HDF5");
    ok(H5Tinsert(in_memory, "dataset", offsetof(Use, dataset), H5T_STD_REF_OBJ), "set up HDF5");
    ok(H5Tinsert(in_memory, "dimension", offsetof(Use, axis), H5T_STD_I64LE), "set up HDF5");
    for (const auto& [path, its_uses] : uses) {
        const Object scale(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
        write_terminated_text(scale, "CLASS", "DIMENSION_SCALE");
        write_terminated_text(scale, "NAME", path.substr(with_scales.size()));
        write_list(scale, "REFERENCE_LIST", in_memory, its_uses.data(), its_uses.size());
    }
}

void Image::add(const PlainArray& array)
{
    std::visit(
        [&](const auto& values) {
            std::vector<hsize_t> extents{values.size() / array.components};
            if (array.components > 1)
                extents.push_back(array.components);
            add(array.path, plain_type_of(values), values.data(), extents);
        },
        array.values);
}

void Image::set_text_of(const std::string& group, const std::string& attribute, const std::string& value)
{
    const Object owner(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose, "open " + group);
    write_text(owner, attribute, value);
}

void Image::set_numbers_of(const std::string& group, const std::string& attribute,
                           const std::vector<std::int64_t>& values)
{
    const Object owner(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose, "open " + group);
    write_numbers(owner, attribute, H5T_STD_I64LE, values.data(), values.size());
}

void Image::set_text(const std::string& attribute, const std::string& value)
{
    write_text(file_, attribute, value);
}

void Image::set_integers(const std::string& attribute, const std::vector<Index>& values)
{
    write_numbers(file_, attribute, H5T_STD_I32LE, values.data(), values.size());
}

void Image::set_natural(const std::string& attribute, std::uint64_t value)
{
    write_numbers(file_, attribute, H5T_STD_U64LE, &value, 1);
}

std::span<const std::byte> Image::close()
{
    attach_scales();
    file_.close("finish the file in memory");
    return std::span(memory_).first(length_of(memory_));
}

Source::Source(const std::string& path) : size_(size_of_file(path)), file_(open_for_reading(path)) {}

bool Source::has_group(const std::string& path) const
{
    return exists(file_, path);
}

void Source::read(const Field& field, Dimensions& dimensions) const
{
    const std::string& path = field.path;
    if (!exists(file_, path))
        throw input_error(path + " is missing");
    const Object dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
    require_own_values(dataset, path);
    const Object type(H5Dget_type(dataset), H5Tclose, "read the type of " + path);
    const Object space(H5Dget_space(dataset), H5Sclose, "read the shape of " + path);
    std::visit(TypeCheck{path, type}, fields::flat(field.values));
    if (const std::string units = text_attribute(dataset, "units", path); units != field.units)
        throw input_error(path + " is in " + units + "; expected " + field.units);
    const hsize_t elements = checked_count(field, space, dimensions);
    if (elements > 0)
        require_stored(field, dataset, type, elements, size_);
    fields::resize(field.values, elements / fields::components(field.values));
    if (elements > 0)
        std::visit(Fill{path, dataset, type}, fields::flat(field.values));
}

std::string Source::text(const std::string& attribute) const
{
    return text_attribute(file_, attribute, "the file");
}

std::vector<Index> Source::integers(const std::string& attribute, std::size_t count) const
{
    std::vector<Index> values(count);
    read_numbers(file_, attribute, H5T_NATIVE_INT32, values.data(), count);
    return values;
}

std::uint64_t Source::natural(const std::string& attribute) const
{
    std::uint64_t value = 0;
    read_numbers(file_, attribute, H5T_NATIVE_UINT64, &value, 1);
    return value;
}

} // namespace jointcreep::store::hdf5
