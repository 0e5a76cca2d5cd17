// A short form of the fuzzers, for any compiler: gives a reader every input of a corpus, then N inputs of it with changes by chance.
//
//   scene_short corpus/scene 20000     exit code 0; whatever else ends it is a fault, as of the fuzz targets (fuzz.hpp)
//
// The last input is in the file last-input of the folder that it is called from.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace
{

constexpr unsigned longest = 20; // s, that one input may take

void give(const std::string& input)
{
    std::ofstream("last-input", std::ios::binary) << input;
    alarm(longest);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

std::vector<std::string> inputs_of(const char* folder)
{
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        paths.push_back(entry.path());
    std::ranges::sort(paths);
    std::vector<std::string> inputs;
    for (const auto& path : paths) {
        std::ifstream file(path, std::ios::binary);
        inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    return inputs;
}

// A piece of it is removed, repeated or replaced by one of another input, or bytes are set; some times.
std::string changed(std::string input, const std::string& other, std::mt19937_64& random)
{
    const auto below = [&](std::size_t end) {
        return end == 0 ? 0 : static_cast<std::size_t>(random() % end);
    };
    for (std::size_t change = 0, changes = 1 + below(4); change < changes && !input.empty(); ++change) {
        const std::size_t at = below(input.size()), length = 1 + below(16);
        switch (below(4)) {
        case 0:
            input.erase(at, length);
            break;
        case 1:
            input.insert(at, input.substr(at, length));
            break;
        case 2:
            input.replace(at, length, other.substr(below(other.size()), length));
            break;
        default:
            input[at] = static_cast<char>(random());
        }
    }
    return input;
}

} // namespace

int main(int argc, char** argv)
{
    const std::vector<std::string> inputs = argc == 3 ? inputs_of(argv[1]) : std::vector<std::string>();
    if (inputs.empty()) {
        std::cerr << "usage: " << argv[0] << " FOLDER N, where the folder has a file for each input\n";
        return 2;
    }
    for (const std::string& input : inputs)
        give(input);
    std::mt19937_64 random(1); // NOLINT: the same inputs in every run
    const long number = std::strtol(argv[2], nullptr, 10);
    for (long n = 0; n < number; ++n) {
        const std::string& input = inputs[random() % inputs.size()];
        give(changed(input, inputs[random() % inputs.size()], random));
    }
    std::cout << inputs.size() << " inputs of the corpus, " << number << " changed ones\n";
    return 0;
}
