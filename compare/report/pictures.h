// The pictures of a page: PNG files turned into data URIs, each content once a scene.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace onepass::report {

std::string base64(const std::string& bytes);

/// A PNG file's content. Throws: Error if it cannot be read or does not start as a PNG does.
std::string read_png(const std::filesystem::path& path);

/// Pixels of a PNG, from its header.
struct PngSize {
    unsigned width = 0;
    unsigned height = 0;
};
PngSize png_size(const std::string& bytes);

/// `data:image/png;base64,...`.
std::string data_uri(const std::string& png_bytes);

}  // namespace onepass::report
