#include "compare/hash.h"

#include <array>
#include <vector>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "core/error.h"

namespace onepass {
namespace {

/// GLM's vectors are not trivially copyable, but hold nothing that is not in their bytes.
template <class T>
constexpr bool kIsPlain = std::is_standard_layout_v<T>&& std::is_trivially_destructible_v<T>;

template <class T>
void add_value(Fnv1a64& hash, const T& value) {
    static_assert(kIsPlain<T>);
    hash.add(&value, sizeof value);
}

/// The length goes in as well, so that neighbouring lists cannot trade elements unnoticed.
template <class T>
void add_list(Fnv1a64& hash, const std::vector<T>& values) {
    static_assert(kIsPlain<T>);
    add_value(hash, uint64_t{values.size()});
    hash.add(values.data(), values.size() * sizeof(T));
}

void add_object(Fnv1a64& hash, const Object& object) {
    add_list(hash, object.positions);
    add_list(hash, object.normals);
    add_list(hash, object.triangles);
    add_value(hash, uint64_t{object.groups.size()});
    for (const TriangleGroup& group : object.groups) {
        add_value(hash, group.first_triangle);
        add_value(hash, group.triangle_count);
    }
}

void add_animation(Fnv1a64& hash, const Animation& animation) {
    add_value(hash, uint64_t{animation.nodes.size()});
    for (const AnimatedNode& node : animation.nodes) {
        add_value(hash, node.parent);
        add_value(hash, node.parent_from_base);
        add_value(hash, node.translation);
        add_value(hash, node.rotation);
        add_value(hash, node.scale);
    }
    add_value(hash, uint64_t{animation.channels.size()});
    for (const AnimationChannel& channel : animation.channels) {
        add_value(hash, channel.node);
        add_value(hash, static_cast<uint32_t>(channel.path));
        add_value(hash, static_cast<uint32_t>(channel.interpolation));
        add_list(hash, channel.times);
        add_list(hash, channel.values);
    }
    add_value(hash, uint64_t{animation.carried.size()});
    for (const CarriedInstance& carried : animation.carried) {
        add_value(hash, carried.instance);
        add_value(hash, carried.node);
        add_value(hash, carried.node_from_object);
    }
}

}  // namespace

void Fnv1a64::add(const void* bytes, size_t count) {
    const auto* begin = static_cast<const unsigned char*>(bytes);
    for (size_t i = 0; i < count; ++i) {
        value_ = (value_ ^ begin[i]) * 0x100000001b3u;
    }
}

std::string hash_text(uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string sha256_text(std::string_view bytes) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned length = 0;
    const int done =
        EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr);
    ONEPASS_CHECK_EQ(done, 1);
    std::string text;
    for (unsigned i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
}

uint64_t hash_rays(std::span<const Ray> rays) {
    Fnv1a64 hash;
    hash.add(rays.data(), rays.size_bytes());
    return hash.value();
}

uint64_t hash_scene(const Scene& scene) {
    Fnv1a64 hash;
    add_value(hash, uint64_t{scene.objects.size()});
    for (const Object& object : scene.objects) add_object(hash, object);
    add_value(hash, uint64_t{scene.instances.size()});
    for (const Instance& instance : scene.instances) {
        add_value(hash, instance.object);
        add_value(hash, instance.world_from_object);
        add_list(hash, instance.materials);
    }
    add_value(hash, uint64_t{scene.materials.size()});
    for (const Material& material : scene.materials) {
        add_value(hash, material.diffuse);
        add_value(hash, material.specular);
        add_value(hash, material.shininess);
        add_value(hash, material.reflectivity);
    }
    add_value(hash, uint64_t{scene.lights.size()});
    for (const PointLight& light : scene.lights) {
        add_value(hash, light.position);
        add_value(hash, light.intensity);
    }
    add_value(hash, uint64_t{scene.cameras.size()});
    for (const Camera& camera : scene.cameras) {
        add_value(hash, camera.world_from_camera);
        add_value(hash, camera.vertical_fov);
    }
    add_value(hash, scene.background);
    add_value(hash, scene.ambient);
    if (!scene.animation.empty()) add_animation(hash, scene.animation);
    return hash.value();
}

}  // namespace onepass
