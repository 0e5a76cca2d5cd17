#include "store/arrays.hpp"

#include "store/hdf5.hpp"

namespace jointcreep::store
{

std::string hdf5_of(const std::vector<PlainArray>& arrays, const std::string& group,
                    const std::map<std::string, std::string>& texts,
                    const std::map<std::string, std::vector<std::int64_t>>& numbers)
{
    hdf5::Image file;
    for (const PlainArray& array : arrays)
        file.add(array);
    for (const auto& [name, text] : texts)
        file.set_text_of(group, name, text);
    for (const auto& [name, values] : numbers)
        file.set_numbers_of(group, name, values);
    const std::span<const std::byte> bytes = file.close();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

} // namespace jointcreep::store
