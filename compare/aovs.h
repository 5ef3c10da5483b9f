// A frame as named channels: what `render --aov` writes to EXR or `.npy`.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/tracer.h"

namespace onepass {

/// One image plane, row-major, row 0 at the top. Ids and counts stay uint32: float cannot hold
/// them.
struct Channel {
    std::string name;  ///< "R", "t", "N.x", "prim_id", ...
    std::variant<std::vector<float>, std::vector<uint32_t>> values;
};

/// The names that --aov takes: color, t, u, v, prim_id, inst_id, normal, cells, tests, references,
/// rays, flags.
std::vector<std::string> aov_names();

/// The channels of the named AOVs, in that order: color is R, G, B; normal is N.x, N.y, N.z; each
/// other is one channel of its own name.
/// Throws: Error for an unknown name, or one that the frame does not hold (a tracer without
/// counters has no cells).
std::vector<Channel> aov_channels(const Frame& frame, const std::vector<std::string>& names);

/// Writes channels as an H x W structured `.npy` array, one field a channel. Whole or not at all.
void write_channels_npy(const std::filesystem::path& path, uint32_t width, uint32_t height,
                        const std::vector<Channel>& channels);

/// The channels' elements pixel by pixel, four bytes each: how both file formats want them.
std::vector<std::byte> interleaved(const std::vector<Channel>& channels);

}  // namespace onepass
