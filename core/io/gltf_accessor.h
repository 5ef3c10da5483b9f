// glTF accessors as plain vectors: strides, sparse substitution and every bound checked, because
// tinygltf does neither. Internal to core/io.
#pragma once

#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "core/types.h"

namespace onepass {

/// An accessor of three floats an element (POSITION, NORMAL).
/// Throws: Error at `where` for another type, or for bytes that lie outside view or buffer.
std::vector<vec3> read_vec3_accessor(const tinygltf::Model& model, int accessor,
                                     const std::string& where);

/// An accessor of one float an element (times of keys). Throws: as read_vec3_accessor.
std::vector<float> read_scalar_accessor(const tinygltf::Model& model, int accessor,
                                        const std::string& where);

/// An accessor of quaternions: four floats an element, or four normalized integers of 1 or 2 bytes,
/// which become floats as glTF says. Throws: as read_vec3_accessor.
std::vector<vec4> read_rotation_accessor(const tinygltf::Model& model, int accessor,
                                         const std::string& where);

/// An accessor of unsigned indices of 1, 2 or 4 bytes. Throws: as read_vec3_accessor.
std::vector<uint32_t> read_index_accessor(const tinygltf::Model& model, int accessor,
                                          const std::string& where);

}  // namespace onepass
