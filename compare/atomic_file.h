// Files that are written whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace onepass {

/// Throws: Error if `path` is a folder, or its own folder does not exist. Costs nothing, so
/// commands call it before they compute what is to be written.
void check_writable(const std::filesystem::path& path);

/// Calls `write` with a temporary path in the same folder (same extension), then renames it to
/// `path`. If anything throws, the temporary file is removed and `path` is as it was.
/// Throws: Error as check_writable, or if the file cannot be moved; and what `write` throws.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// The same for bytes that are at hand.
void write_bytes_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace onepass
