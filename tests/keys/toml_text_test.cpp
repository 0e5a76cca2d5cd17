// What is not TOML, or is more than toml++ can take, is refused with its line.

#include "keys/toml_text.hpp"

#include "model/error.hpp"

#include <gtest/gtest.h>

namespace toml_text_test
{

using namespace jointcreep;
using namespace jointcreep::keys;

namespace
{

std::string refusal(const std::string& text)
{
    try {
        parse_toml(text, "text");
        return "accepted";
    } catch (const input_error& error) {
        return error.what();
    }
}

void expect_refused(const std::string& text, const std::string& line, const std::string& why)
{
    const auto message = refusal(text);
    EXPECT_TRUE(message.starts_with("text, line " + line + ": ")) << message;
    EXPECT_NE(message.find(why), std::string::npos) << message;
}

TEST(toml_text, values_know_their_line)
{
    const auto root = parse_toml("a = 1\n[b]\nc = \"x\"\n\n[[d]]\ne = 1994-06-15\n", "text");
    EXPECT_EQ(root.find("a")->line, 1);
    EXPECT_EQ(root.find("b")->line, 2);
    EXPECT_EQ(root.find("b")->find("c")->line, 3);
    EXPECT_EQ(std::get<std::string>(root.find("b")->find("c")->content), "x");
    const auto& first = std::get<TomlValue::List>(root.find("d")->content)[0];
    EXPECT_EQ(first.line, 5);
    EXPECT_EQ(shown(*first.find("e")), "1994-06-15");
    EXPECT_EQ(root.find("x"), nullptr);
}

TEST(toml_text, windows_line_ends_and_byte_order_mark)
{
    EXPECT_EQ(parse_toml("\xef\xbb\xbf# a\r\na = 1\r\nb = 2\r\n", "text").find("b")->line, 3);
}

TEST(toml_text, characters_beyond_ascii)
{
    const std::string umlaut = "\xc3\xa4";
    EXPECT_EQ(
        refusal("a = \"" + umlaut + "\" # " + umlaut + "\nb = '''" + umlaut + "'''\nc = '" + umlaut + "'\n"),
        "accepted");
    EXPECT_EQ(refusal("a = \"\\\"" + umlaut + "\"\nb = \"\"\"\n\"" + umlaut + "\"\"\"\"\"\n"), "accepted");
    EXPECT_EQ(refusal("\"" + umlaut + "\" = 1\n"), "accepted") << "a quoted key";
    expect_refused("a = 1\n" + umlaut + " = 1\n", "2", "outside a string");
    expect_refused("a = 1 " + umlaut, "1", "outside a string");
    expect_refused("a = 1\nb = 2\xe2\x80\x93"
                   "3\n",
                   "2", "outside a string");
}

TEST(toml_text, bytes_that_are_no_text)
{
    const std::vector<std::string> wrong = {"\xff",    "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                                            "\xe2\x82"};
    for (const auto& bytes : wrong)
        expect_refused("# \n# " + bytes + "\n", "2", "not UTF-8");
    for (const char control : {'\0', '\x01', '\b', '\f', '\x1f', '\x7f', '\r'})
        expect_refused("a = 1\n# " + std::string(1, control) + "x\n", "2", "control character");
}

TEST(toml_text, twice)
{
    expect_refused("a = 1\na = 2\n", "2", "'a'");
    expect_refused("[a]\nb = 1\n[a]\n", "3", "'a'");
    expect_refused("a = { b = 1, b = 2 }\n", "1", "'b'");
}

TEST(toml_text, slips)
{
    expect_refused("a =\n", "1", "expected value");
    expect_refused("\n[=j]\n", "2", "a table without a name");
    expect_refused("[ ]\n", "1", "a table without a name");
    expect_refused("a = [1, 2}\n", "1", "a } that closes nothing");
    expect_refused("a = \"x\nb = 1\n", "1", "without its closing quote");
    expect_refused("a = 1e400\n", "1", "1e400");
    expect_refused("a = 9223372036854775808\n", "1", "64 bits");
    expect_refused("a = 2023-02-29\n", "1", "day");
    expect_refused("a = 1994-6-15\n", "1", "month");
}

TEST(toml_text, too_deep)
{
    const auto nested = [](std::size_t n) {
        return "a = " + std::string(n, '[') + std::string(n, ']') + "\n";
    };
    EXPECT_EQ(refusal(nested(15)), "accepted");
    expect_refused(nested(17), "1", "too deep");
    expect_refused(nested(1000000), "1", "too deep");
    std::string key = "a";
    for (int i = 0; i < 1000000; ++i)
        key += ".a";
    expect_refused(key + " = 1\n", "1", "too many parts");
    expect_refused("[" + key + "]\n", "1", "too many parts");
}

TEST(toml_text, long_messages_are_cut)
{
    EXPECT_LT(refusal(std::string(1000000, 'a') + " = 1\n" + std::string(1000000, 'a') + " = 1\n").size(),
              300u);
}

TEST(toml_text, nan_and_inf_are_left_to_the_keys)
{
    EXPECT_EQ(refusal("a = nan\nb = -inf\n"), "accepted");
}

// toml++ looks for the end of this broken number, and meets a letter it can do nothing with.
TEST(toml_text, what_stops_toml_plus_plus_ends_the_program_with_a_message)
{
    EXPECT_EXIT(parse_toml("a = -e\"\xc3\xa9\"\n", "text"), testing::ExitedWithCode(2),
                "text: cannot be read as TOML");
}

} // namespace

} // namespace toml_text_test
