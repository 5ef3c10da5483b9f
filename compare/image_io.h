// The one module that knows OpenImageIO: PNG and EXR files.
//
// A build without it (ONEPASS_WITH_OPENIMAGEIO=OFF) keeps these functions; they then throw an Error
// that says so, and AOVs go to `.npy` (aovs.h) instead.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/aovs.h"
#include "compare/images.h"

namespace onepass {

/// False in a build without OpenImageIO.
bool image_files_supported();

/// "OpenImageIO 2.4.7", or "not built in".
std::string image_io_description();

/// Writes an 8-bit sRGB PNG, whole or not at all. Throws: Error if it cannot.
void write_png(const std::filesystem::path& path, const Picture& picture);

/// Writes an OpenEXR file: float channels as 32-bit float, uint32 channels as UINT, so that ids
/// (kNoId too) are exact. Whole or not at all. Throws: Error if it cannot.
void write_exr(const std::filesystem::path& path, uint32_t width, uint32_t height,
               const std::vector<Channel>& channels);

}  // namespace onepass
