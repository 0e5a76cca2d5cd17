// Files that appear under their name only when they are whole.

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace jointcreep::store
{

// Writes the bytes to PATH.partial-<random> beside `path`, syncs them, and renames that to `path`. On failure
// throws file_error (its message without the path), removes the partial file, and leaves what was under
// `path`. Only a killed program can leave a partial file behind; the next save to `path` removes it.
void save(const std::string& path, std::span<const std::byte> bytes);

// The same for files that belong together: all are written beside before the first gets its name. Messages begin with
// the path.
struct NamedBytes {
    std::string path;
    std::span<const std::byte> bytes;
};
void save_together(const std::vector<NamedBytes>& files);

// Whether `path`, without links in it, is called as a partial file of `output`, which the next save() removes.
bool is_partial_of(const std::string& output, const std::string& path);

} // namespace jointcreep::store
