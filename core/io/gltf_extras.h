// What glTF cannot say, kept in `extras` under one key. Shared by the glTF reader and writer, and
// internal to them.
//
//   scene:     { "onepass": { "version": 1, "background": [r, g, b], "ambient": [r, g, b] } }
//   material:  { "onepass": { "specular": [r, g, b], "shininess": n } }
//   primitive: { "onepass": { "name": "..." } }
//
// The scene's entry marks a file of ours: its numbers are then taken as they stand.
#pragma once

#include <tiny_gltf.h>

namespace onepass {

inline constexpr const char* kExtrasKey = "onepass";
inline constexpr double kExtrasVersion = 1.0;

}  // namespace onepass
