// NumPy's `.npy` files: rays in, hits and AOVs out, so that Python can make and read them.
//
// Little-endian, C order. A file is believed only as far as its bytes go: type, shape and length
// are all checked against each other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace onepass {

/// One field of a structured array.
struct NpyField {
    std::string name;
    std::string type;  ///< "<f4" or "<u4"
};

/// Rays: float32, N x 8: org, tmin, dir, tmax. Any value is allowed, NaN too; N may be 0.
/// Throws: Error for a file that cannot be opened, is no `.npy`, has another type, order or shape,
/// or is shorter or longer than its header says.
std::vector<Ray> read_rays_npy(const std::filesystem::path& path);
void write_rays_npy(const std::filesystem::path& path, std::span<const Ray> rays);

/// Hits: structured, N: t, u, v float32; prim_id, inst_id uint32. A miss: t = inf, ids 0xFFFFFFFF.
/// Throws: as read_rays_npy.
std::vector<Hit> read_hits_npy(const std::filesystem::path& path);
void write_hits_npy(const std::filesystem::path& path, std::span<const Hit> hits);

/// A structured array of any shape; `bytes` holds its elements, field by field, without padding.
/// Written whole or not at all.
void write_structured_npy(const std::filesystem::path& path, std::span<const NpyField> fields,
                          std::span<const size_t> shape, std::span<const std::byte> bytes);

}  // namespace onepass
