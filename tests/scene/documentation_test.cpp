// docs/scene.md is what the declarations of the keys say, and its example is a scene.

#include "text.hpp"

#include <fstream>
#include <iterator>
#include <sstream>

namespace documentation_test
{

using namespace jointcreep;
using namespace jointcreep::scene;

namespace
{

TEST(documentation, page_is_up_to_date)
{
    std::ifstream file(SOURCE_FOLDER "docs/scene.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    EXPECT_TRUE(page == scene_keys_markdown())
        << "docs/scene.md differs from the declared keys: jointgen --scene-keys-markdown > docs/scene.md";
}

TEST(documentation, example_is_a_scene)
{
    const auto page = scene_keys_markdown();
    const auto begin = page.find("```toml\n") + 8;
    const auto example = page.substr(begin, page.find("```", begin) - begin);
    const Scene scene = parse_scene(example, "docs/scene.md");
    EXPECT_EQ(scene.title, "A slope");
    EXPECT_EQ(scene.joint_sets.size(), 1u);
}

TEST(documentation, key_list_has_one_row_a_key)
{
    std::istringstream rows(scene_keys_tsv());
    std::string row;
    std::getline(rows, row);
    EXPECT_EQ(row, "table\tkey\tkind\tunit\trequired\tminimum\tmaximum\tdefault");
    int count = 0;
    bool found = false;
    while (std::getline(rows, row)) {
        ++count;
        EXPECT_EQ(std::count(row.begin(), row.end(), '\t'), 7) << row;
        found = found || row == "rock\tpoissons_ratio\tnumber\t-\tyes\t[0\t0.5)\t-";
    }
    EXPECT_TRUE(found);
    EXPECT_GT(count, 80);
}

} // namespace

} // namespace documentation_test
