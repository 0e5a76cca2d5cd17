// Files that appear under their name only when they are whole.

#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace jointcreep::store
{

// Writes the bytes to PATH.partial-<random> beside `path`, syncs them, and renames that to `path`. On failure
// throws file_error (its message without the path), removes the partial file, and leaves what was under
// `path`. Only a killed program can leave a partial file behind; the next save to `path` removes it.
void save(const std::string& path, std::span<const std::byte> bytes);

} // namespace jointcreep::store
