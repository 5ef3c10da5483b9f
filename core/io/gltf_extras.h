// What glTF cannot say, kept in `extras` under one key. Shared by the glTF reader and writer, and
// internal to them.
//
//   scene:     { "onepass": { "version": 1, "background": [r, g, b], "ambient": [r, g, b] } }
//   material:  { "onepass": { "specular": [r, g, b], "shininess": n } }
//   primitive: { "onepass": { "name": "..." } }
//   node:      { "onepass": { "node": i } }: animated node i of an animation
//   node:      { "onepass": { "instance": i } }: instance i of an animated scene, and then
//              "world_from_object": [12 numbers] where it is not quite where its node has it
//
// The scene's entry marks a file of ours: its numbers are then taken as they stand.
#pragma once

#include <tiny_gltf.h>

namespace onepass {

inline constexpr const char* kExtrasKey = "onepass";
inline constexpr const char* kNodePlaceKey = "node";
inline constexpr const char* kInstancePlaceKey = "instance";
inline constexpr const char* kRestTransformKey = "world_from_object";
inline constexpr double kExtrasVersion = 1.0;

}  // namespace onepass
