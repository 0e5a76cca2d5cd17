// What is written is read back, in every kind of file, and equal records give equal bytes.

#include "random_records.hpp"

#include "model/error.hpp"

#include <rapidcheck/gtest.h>

#include <chrono>
#include <thread>

namespace jointcreep::store::files_test
{

namespace
{

ResultFile any_records()
{
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    const auto largest = *rc::gen::inRange<std::size_t>(2, 60);
    return RandomRecords(seed, largest).result(*rc::gen::arbitrary<bool>());
}

} // namespace

RC_GTEST_PROP(Files, ReadBackWhatWasWritten, ())
{
    const TemporaryFolder folder;
    const ResultFile file = any_records();

    write_network(folder / "network.h5", file.provenance, file.network);
    RC_ASSERT(kind_of(folder / "network.h5") == FileKind::network);
    RC_ASSERT(same(read_network(folder / "network.h5"), static_cast<const NetworkFile&>(file)));

    write_joints(folder / "joints.h5", file.provenance, file.network, file.equivalent);
    RC_ASSERT(kind_of(folder / "joints.h5") == FileKind::joints);
    RC_ASSERT(same(read_joints(folder / "joints.h5"), static_cast<const JointsFile&>(file)));

    write(folder / "result.h5", file);
    RC_ASSERT(kind_of(folder / "result.h5") == FileKind::result);
    RC_ASSERT(same(read_result(folder / "result.h5"), file));
}

RC_GTEST_PROP(Files, ReadBackACheckpoint, ())
{
    const TemporaryFolder folder;
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    const auto largest = *rc::gen::inRange<std::size_t>(2, 60);
    const CheckpointFile file = RandomRecords(seed, largest).checkpoint(*rc::gen::arbitrary<bool>());
    write_checkpoint(folder / "kept.h5", file.provenance, file.network, file.equivalent, file.result,
                     file.checkpoint);
    RC_ASSERT(kind_of(folder / "kept.h5") == FileKind::checkpoint);
    RC_ASSERT(same(read_checkpoint(folder / "kept.h5"), file));
    RC_ASSERT(same(read_result(folder / "kept.h5"), static_cast<const ResultFile&>(file))); // the run so far
}

TEST(Files, HoldJointsThatDoNotCreep)
{
    const TemporaryFolder folder;
    ResultFile file = RandomRecords(1, 20).result();
    EquivalentJoints& joints = file.equivalent;
    for (auto* of_units : {&joints.normal_kelvin_stiffness, &joints.shear_kelvin_stiffness,
                           &joints.normal_kelvin_viscosity, &joints.shear_kelvin_viscosity})
        of_units->clear();
    write(folder / "result.h5", file);
    const ResultFile read = read_result(folder / "result.h5");
    EXPECT_TRUE(same(read, file));
    EXPECT_EQ(read.equivalent.kelvin_units(), 0u);
}

TEST(Files, AreNotWrittenWithRowsOfUnequalLength)
{
    const TemporaryFolder folder;
    ResultFile file = RandomRecords(1, 20).result();
    file.equivalent.normal_kelvin_stiffness.push_back(0);
    try {
        write(folder / "result.h5", file);
        FAIL() << "written";
    } catch (const file_error& error) {
        EXPECT_NE(std::string(error.what()).find("/equivalent/normal_kelvin_stiffness"), std::string::npos)
            << error.what();
    }
}

RC_GTEST_PROP(Files, GiveEarlierProgramsWhatTheyNeed, ())
{
    const TemporaryFolder folder;
    const ResultFile file = any_records();
    write(folder / "result.h5", file);
    RC_ASSERT(same(read_joints(folder / "result.h5"), static_cast<const JointsFile&>(file)));
    RC_ASSERT(same(read_network(folder / "result.h5"), static_cast<const NetworkFile&>(file)));
}

RC_GTEST_PROP(Files, OfEqualRecordsAreEqual, ())
{
    const TemporaryFolder folder;
    const ResultFile file = any_records();
    write(folder / "one.h5", file);
    const ResultFile again = read_result(folder / "one.h5");
    write(folder / "two.h5", again);
    RC_ASSERT(bytes_of(folder / "one.h5") == bytes_of(folder / "two.h5"));
    RC_ASSERT(sha256_of(folder / "one.h5") == sha256_of(folder / "two.h5"));
    RC_ASSERT((folder.files() == std::vector<std::string>{"one.h5", "two.h5"}));
}

// HDF5 would note when an object was made, to the second.
TEST(Files, DoNotTellWhenTheyWereMade)
{
    const TemporaryFolder folder;
    const ResultFile file = RandomRecords(1, 5).result();
    write(folder / "one.h5", file);
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    write(folder / "two.h5", file);
    EXPECT_TRUE(bytes_of(folder / "one.h5") == bytes_of(folder / "two.h5"));
}

// Several chunks in a dataset, the last of them partly empty.
TEST(Files, HoldLargeArrays)
{
    const TemporaryFolder folder;
    ResultFile file = RandomRecords(1, 5).result();
    std::mt19937_64 random(2);
    file.network.joints.trace_joint.assign(300'001, 0);
    file.network.joints.trace_from.resize(300'001);
    for (Eigen::Vector2d& place : file.network.joints.trace_from)
        place = {static_cast<double>(random()), -static_cast<double>(random())};
    file.network.joints.trace_to = file.network.joints.trace_from;
    file.provenance.scene.assign(3'000'000, 'x');
    write(folder / "result.h5", file);
    EXPECT_TRUE(same(read_result(folder / "result.h5"), file));
}

TEST(Files, MayHaveEmptyArrays)
{
    const TemporaryFolder folder;
    NetworkFile file;
    file.provenance.program = file.provenance.version = file.provenance.input_sha256 =
        file.provenance.options = {""};
    file.network.blocks.block_ring = file.network.blocks.ring_start = file.network.blocks.edge_share = {0};
    write_network(folder / "network.h5", file.provenance, file.network);
    EXPECT_TRUE(same(read_network(folder / "network.h5"), file));
}

TEST(Files, DigestIsThatOfSha256)
{
    const TemporaryFolder folder;
    std::ofstream(folder / "abc") << "abc"; // the example of FIPS 180-2
    EXPECT_EQ(sha256_of(folder / "abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_THROW(sha256_of(folder / "absent"), file_error);
    EXPECT_THROW(sha256_of(folder / "."), file_error);
}

} // namespace jointcreep::store::files_test
