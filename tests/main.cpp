// Runs the tests of a folder, or those of the files that are named: `joint_tests coulomb` those of coulomb_test.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>

namespace
{

// "suite.test:suite.test...", what --gtest_filter takes; empty if the file has none.
std::string tests_in(const std::string& file)
{
    std::string names;
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int s = 0; s < all.total_test_suite_count(); ++s) {
        const testing::TestSuite& suite = *all.GetTestSuite(s);
        for (int t = 0; t < suite.total_test_count(); ++t) {
            const testing::TestInfo& test = *suite.GetTestInfo(t);
            if (std::filesystem::path(test.file()).filename() == file)
                names += std::string(test.test_suite_name()) + '.' + test.name() + ':';
        }
    }
    return names;
}

} // namespace

int main(int argc, char** argv)
{
    testing::InitGoogleTest(&argc, argv);
    std::string filter;
    for (int i = 1; i < argc; ++i) {
        const std::string file = std::string(argv[i]) + "_test.cpp", names = tests_in(file);
        if (names.empty()) {
            std::cerr << argv[0] << ": no tests in " << file << '\n';
            return 2;
        }
        filter += names;
    }
    if (!filter.empty()) {
        // What the environment leaves out, GTEST_FILTER='-*name*', stays out.
        const std::string given = GTEST_FLAG_GET(filter);
        GTEST_FLAG_SET(filter, filter + given.substr(std::min(given.find('-'), given.size())));
    }
    return RUN_ALL_TESTS();
}
