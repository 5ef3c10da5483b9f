// Content hashes: results name the very rays and the very scene they were made with.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/scene.h"
#include "core/types.h"

namespace onepass {

/// FNV-1a, 64 bits: small, the same everywhere, and enough to tell two inputs apart. Not meant to
/// withstand someone who wants a collision.
class Fnv1a64 {
  public:
    void add(const void* bytes, size_t count);
    uint64_t value() const { return value_; }

  private:
    uint64_t value_ = 0xcbf29ce484222325u;
};

/// 16 lower-case hexadecimal digits.
std::string hash_text(uint64_t hash);

/// SHA-256 of the bytes as 64 lower-case hexadecimal digits. For what an edit must not pass unseen;
/// it does not tell who wrote the bytes.
std::string sha256_text(std::string_view bytes);

/// Hash of the rays' bytes, in order.
uint64_t hash_rays(std::span<const Ray> rays);

/// Hash of all that a picture or a hit depends on: geometry, transforms, materials, lights, cameras
/// and colours; names do not count.
uint64_t hash_scene(const Scene& scene);

}  // namespace onepass
