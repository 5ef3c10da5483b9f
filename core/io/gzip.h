// Decompression of .gz files. Internal to core/io.
#pragma once

#include <filesystem>
#include <string>

namespace onepass {

/// The decompressed content of a gzip file.
/// Throws: Error for a file that cannot be read, is not gzip, or is truncated or damaged.
std::string read_gzip(const std::filesystem::path& path);

}  // namespace onepass
