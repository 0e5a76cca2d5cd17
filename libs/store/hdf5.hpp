// The door to HDF5: a file made in memory, and a file open for reading, both by the fields of the schema.
// Messages come without the file's name.

#pragma once

#include "store/arrays.hpp"
#include "store/check.hpp"

#include <hdf5.h>

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace jointcreep::store::hdf5
{

// An HDF5 object that is closed when this goes.
class Object
{
public:
    // `what` was being done; if `id` says that it failed, throws file_error.
    Object(hid_t id, herr_t (*closing)(hid_t), const std::string& what);
    Object(Object&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    ~Object()
    {
        if (id_ >= 0)
            close_(id_);
    }
    operator hid_t() const { return id_; }
    void close(const std::string& what); // throws file_error if that fails

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

// A file that exists in memory only, so that HDF5 never meets a disk error: after one, HDF5 1.10 ends a
// program with a segmentation fault in its exit handler.
class Image
{
public:
    Image();
    Image(const Image&) = delete; // HDF5 knows where memory_ is
    Image& operator=(const Image&) = delete;
    void add(const fields::Field& field, const schema::Dimensions& dimensions);
    void add(const PlainArray& array);
    void set_text(const std::string& attribute, const std::string& value);
    void set_text_of(const std::string& group, const std::string& attribute, const std::string& value);
    void set_numbers_of(const std::string& group, const std::string& attribute,
                        const std::vector<std::int64_t>& values);
    void set_integers(const std::string& attribute,
                      const std::vector<Index>& values); // a single one as a scalar
    void set_natural(const std::string& attribute, std::uint64_t value);
    // Its bytes, which stay with this.
    std::span<const std::byte> close();

private:
    void make_group_of(const std::string& path);
    void attach_scales();
    Object add(const std::string& path, hid_t type, const void* data, const std::vector<hsize_t>& extents);

    std::vector<std::byte> memory_;
    Object file_;
    std::set<std::string> groups_;
    std::map<std::string, std::vector<std::string>> axes_; // of the datasets that get dimension scales
};

class Source
{
public:
    explicit Source(const std::string& path);

    bool has_group(const std::string& path) const;
    // Resizes and fills what the field points to. Type, shape and units are checked, the values not.
    void read(const fields::Field& field, schema::Dimensions& dimensions) const;

    // Attributes of the file. They throw input_error if it is not there or of another type.
    std::string text(const std::string& attribute) const;
    std::vector<Index> integers(const std::string& attribute, std::size_t count) const;
    std::uint64_t natural(const std::string& attribute) const;

private:
    std::uint64_t size_; // of the file [bytes]
    Object file_;
};

} // namespace jointcreep::store::hdf5
