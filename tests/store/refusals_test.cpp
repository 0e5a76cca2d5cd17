// Files that are readable, but not what was wanted, are refused with a message that says where and what.

#include "random_records.hpp"

#include "model/error.hpp"

#include <hdf5.h>

namespace jointcreep::store::refusals_test
{

// A good result file that a test changes behind the library's back.
class Refusal : public testing::Test
{
protected:
    Refusal() { write(path, file); }

    // What the reader says after `change`; "" if it is content.
    std::string after(const auto& change) const
    {
        const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
        H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
        const hid_t opened = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
        EXPECT_GE(opened, 0);
        change(opened);
        EXPECT_GE(H5Fclose(opened), 0);
        H5Pclose(access);
        return message();
    }

    std::string message() const
    {
        try {
            read_result(path);
        } catch (const input_error& error) {
            const std::string text = error.what();
            EXPECT_TRUE(text.starts_with(path + ": ")) << text;
            return text;
        }
        return "";
    }

    // The message after the first value of a dataset was changed.
    template <class Value>
    std::string with_first(const std::string& dataset, hid_t type, Value value) const
    {
        return after([&](hid_t opened) {
            const hid_t set = H5Dopen2(opened, dataset.c_str(), H5P_DEFAULT);
            const hid_t space = H5Dget_space(set);
            const auto count = H5Sget_simple_extent_npoints(space);
            std::vector<Value> values(static_cast<std::size_t>(count));
            EXPECT_GE(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
            values[0] = value;
            EXPECT_GE(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
            H5Sclose(space);
            H5Dclose(set);
        });
    }

    static void set_text(hid_t object, const char* name, const std::string& value)
    {
        const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
        H5Tset_size(type, value.size());
        H5Tset_strpad(type, H5T_STR_NULLPAD);
        H5Adelete(object, name);
        const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
        EXPECT_GE(H5Awrite(attribute, type, value.data()), 0);
        H5Aclose(attribute);
        H5Sclose(space);
        H5Tclose(type);
    }

    static void set_numbers(hid_t object, const char* name, const std::vector<Index>& values)
    {
        const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
        EXPECT_GE(H5Awrite(attribute, H5T_NATIVE_INT32, values.data()), 0);
        H5Aclose(attribute);
    }

    // Puts a dataset of another type or shape in the place of one.
    static void replace(hid_t opened, const char* dataset, hid_t type, const std::vector<hsize_t>& extents)
    {
        H5Ldelete(opened, dataset, H5P_DEFAULT);
        const hid_t space = H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
        const hid_t set = H5Dcreate2(opened, dataset, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        EXPECT_GE(set, 0);
        set_text(set, "units", "1");
        H5Dclose(set);
        H5Sclose(space);
    }

    const TemporaryFolder folder;
    const std::string path = folder / "result.h5";
    const ResultFile file = RandomRecords(4, 6).result();
};

#define EXPECT_SAYS(message, words) EXPECT_PRED2(says, message, std::string(words))

bool says(const std::string& message, const std::string& words)
{
    return message.find(words) != std::string::npos;
}

TEST_F(Refusal, OfNothing)
{
    EXPECT_EQ(message(), "");
}

TEST_F(Refusal, OfTheWrongKind)
{
    write_network(path, file.provenance, file.network);
    EXPECT_SAYS(message(),
                "this is a \"jointcreep network\" file; expected a \"jointcreep result\" file, which "
                "demsolve makes");
    EXPECT_THROW(read_joints(path), input_error);
    EXPECT_SAYS(after([](hid_t opened) { set_text(opened, "filetype", "jointcreep movie"); }), "movie");
    EXPECT_SAYS(after([](hid_t opened) { set_text(opened, "filetype", "statepoint"); }), "statepoint");
    EXPECT_SAYS(after([](hid_t opened) { H5Adelete(opened, "filetype"); }), "filetype");
}

TEST_F(Refusal, OfAnotherMajorVersion)
{
    EXPECT_EQ(after([](hid_t opened) { set_numbers(opened, "format_version", {2, 7}); }), "");
    for (const int version : {1, 3})
        EXPECT_SAYS(after([version](hid_t opened) {
                        set_numbers(opened, "format_version", {version, 0});
                    }),
                    "format version " + std::to_string(version) + "; this program reads version 2");
    EXPECT_THROW(kind_of(path), input_error);
}

TEST_F(Refusal, OfIncompleteFiles)
{
    EXPECT_SAYS(after([](hid_t opened) { set_numbers(opened, "complete", {0}); }), "complete");
    EXPECT_SAYS(after([](hid_t opened) { H5Adelete(opened, "complete"); }), "complete");
}

// Every dataset in turn.
TEST_F(Refusal, OfMissingDatasets)
{
    ResultFile empty;
    const std::string good = bytes_of(path);
    for (const auto& fields : {schema::fields_of(empty.provenance), schema::fields_of(empty.network),
                               schema::fields_of(empty.equivalent), schema::fields_of(empty.result),
                               schema::fields_of(empty.result.step_history),
                               schema::fields_of(empty.result.failure), schema::fields_of(empty.safety)})
        for (const fields::Field& field : fields) {
            EXPECT_SAYS(after([&](hid_t opened) {
                            EXPECT_GE(H5Ldelete(opened, field.path.c_str(), H5P_DEFAULT), 0);
                        }),
                        field.path + " is missing");
            std::ofstream(path, std::ios::binary) << good;
        }
    EXPECT_SAYS(after([](hid_t opened) { H5Ldelete(opened, "/mesh", H5P_DEFAULT); }), "/mesh/");
}

TEST_F(Refusal, OfAnotherUnit)
{
    EXPECT_SAYS(after([](hid_t opened) {
                    const hid_t set = H5Dopen2(opened, "/history/displacement", H5P_DEFAULT);
                    set_text(set, "units", "mm");
                    H5Dclose(set);
                }),
                "/history/displacement is in mm; expected m");
}

TEST_F(Refusal, OfAnotherTypeOrShape)
{
    const hsize_t edges = file.network.blocks.edge_kind.size();
    EXPECT_SAYS(after([&](hid_t opened) { replace(opened, "/edges/kind", H5T_IEEE_F64LE, {edges}); }),
                "/edges/kind is of the wrong type; expected int32");
    EXPECT_SAYS(after([&](hid_t opened) {
                    replace(opened, "/edges/kind", H5T_STD_I32LE, {edges, 1});
                }),
                "/edges/kind has the wrong number of dimensions; expected 1");
    EXPECT_SAYS(after([&](hid_t opened) { replace(opened, "/edges/kind", H5T_STD_I32LE, {edges + 1}); }),
                "/edges/kind has " + std::to_string(edges + 1) + " rows along edge; expected " +
                    std::to_string(edges));
    EXPECT_SAYS(after([&](hid_t opened) {
                    replace(opened, "/edges/vertex", H5T_STD_I32LE, {edges, 3});
                }),
                "/edges/vertex has rows of 3 values; expected 2");
}

// A shape that the file cannot fill must not be believed: these would be 8 GB, and more than anything.
TEST_F(Refusal, OfImpossibleSizes)
{
    write_network(path, file.provenance, file.network);
    after([](hid_t opened) { replace(opened, "/names/rock", H5T_C_S1, {hsize_t(1) << 30}); });
    EXPECT_THROW(read_network(path), file_error);
    after([](hid_t opened) { replace(opened, "/names/rock", H5T_C_S1, {hsize_t(1) << 60}); });
    EXPECT_THROW(read_network(path), input_error);
}

TEST_F(Refusal, OfValuesOutOfRange)
{
    EXPECT_SAYS(with_first<Index>("/edges/kind", H5T_NATIVE_INT32, 3),
                "/edges/kind[0] is 3; expected 0 to 2");
    write(path, file);
    EXPECT_SAYS(with_first<Index>("/edges/vertex", H5T_NATIVE_INT32, 100),
                "/edges/vertex[0, 0] is 100; expected index of vertex (there are " +
                    std::to_string(file.network.blocks.vertex.size()) + ")");
    write(path, file);
    EXPECT_SAYS(with_first<Index>("/edges/block", H5T_NATIVE_INT32, -2), "expected index of block or -1");
    write(path, file);
    EXPECT_SAYS(with_first("/states/stress", H5T_NATIVE_DOUBLE, std::nan("")),
                "/states/stress[0, 0, 0] is nan; expected finite");
    write(path, file);
    EXPECT_SAYS(with_first("/blocks/area", H5T_NATIVE_DOUBLE, 0.0), "/blocks/area[0] is 0; expected > 0");
    write(path, file);
    EXPECT_SAYS(with_first("/equivalent/cohesion", H5T_NATIVE_DOUBLE, -1.0), "expected >= 0");
    write(path, file);
    EXPECT_SAYS(with_first("/history/time", H5T_NATIVE_DOUBLE, 1e300), "/history/time[1]");
    write(path, file);
    EXPECT_SAYS(with_first<Index>("/blocks/first_ring", H5T_NATIVE_INT32, 1), "/blocks/first_ring[");
}

TEST_F(Refusal, OfValuesThatContradictEachOther)
{
    const auto& blocks = file.network.blocks;
    const auto& mesh = file.result.mesh;
    EXPECT_SAYS(with_first<Index>("/edges/vertex", H5T_NATIVE_INT32, blocks.edge_vertex[0][1]),
                "/edges/vertex, row 0: it must hold that the two vertices of an edge differ");
    write(path, file);
    ResultFile twice = file;
    ASSERT_GT(twice.network.names.rock.size(), 1U);
    twice.network.names.rock.back() = twice.network.names.rock.front();
    try {
        write(path, twice); // by the rules of reading
        FAIL() << "it is written";
    } catch (const file_error& error) {
        EXPECT_SAYS(error.what(), "/names/rock, row " + std::to_string(twice.network.names.rock.size() - 1) +
                                      ": it must hold that all names differ");
    }
    EXPECT_SAYS(with_first<Index>("/mesh/contact_gridpoint", H5T_NATIVE_INT32, mesh.contact_gridpoint[0][1]),
                "/mesh/contact_gridpoint, row 0");
    write(path, file);
    EXPECT_SAYS(with_first<Index>("/mesh/zone_gridpoint", H5T_NATIVE_INT32, mesh.zone_gridpoint[0][1]),
                "/mesh/zone_gridpoint, row 0");
    write(path, file);
    EXPECT_SAYS(with_first<Index>("/edges/joint", H5T_NATIVE_INT32, -1 - blocks.edge_joint[0]),
                "/edges/joint, row 0");
    write(path, file);
    EXPECT_SAYS(with_first("/mesh/contact_normal", H5T_NATIVE_DOUBLE, 2.0), "/mesh/contact_normal, row 0");
    write(path, file);
    ASSERT_GT(file.equivalent.shear_kelvin_stiffness[0], 0);
    EXPECT_SAYS(with_first("/equivalent/shear_kelvin_viscosity", H5T_NATIVE_DOUBLE, 0.0),
                "/equivalent/shear_kelvin_viscosity, row 0: it must hold that a Kelvin unit with a stiffness "
                "has a viscosity");
}

TEST_F(Refusal, OfFilesThatAreNotHdf5)
{
    std::ofstream(path, std::ios::trunc) << "title = \"a scene\"\n";
    EXPECT_THROW(read_result(path), file_error);
    EXPECT_THROW(read_result(folder / "absent.h5"), file_error);
    EXPECT_THROW(kind_of(folder / "."), file_error);
}

TEST_F(Refusal, NotOfDatasetsOfLaterMinorVersions)
{
    EXPECT_EQ(after([](hid_t opened) {
                  const hid_t group = H5Gcreate2(opened, "/water", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
                  H5Gclose(group);
              }),
              "");
}

} // namespace jointcreep::store::refusals_test
