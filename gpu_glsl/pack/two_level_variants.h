// The tables of storage texture2d in two other forms, for what the paper says against them:
// triangles copied into every cell's list, and addresses that are indices into virtual
// one-dimensional arrays.
//
// Both start from the finished tables, so that they hold the same cells, lists and triangles, and
// differ in nothing but where these lie.
#pragma once

#include "gpu_glsl/pack/two_level_textures.h"

namespace onepass {

/// For storage/two_level_grid/texture2d_copies: an object grid's list becomes a run of triangle
/// records within one row, each ending in the triangle's number; references stay to instances only.
///
/// `shared`: the scene's tables, with addresses of 32 bits. Cost: O(cells + references).
/// Throws: Error if the copies do not fit a texture.
TwoLevelTextures with_copied_triangles(const Scene& scene, TwoLevelTextures shared,
                                       const TextureLimits& limits);

/// For storage/two_level_grid/texture2d_virtual: every address becomes the index of the texel in
/// its table, row after row; the cells become such a table too.
///
/// `direct`: the scene's tables, with addresses of 32 bits. Cost: O(cells + references).
/// Throws: Error for a table of more than 2^24 texels, beyond which a float index does not count.
TwoLevelTextures with_virtual_arrays(const Scene& scene, TwoLevelTextures direct,
                                     const TextureLimits& limits);

}  // namespace onepass
