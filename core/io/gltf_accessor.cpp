#include "core/io/gltf_accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

[[noreturn]] void throw_broken(const std::string& where, const std::string& got,
                               const std::string& expected) {
    throw Error({where, got, expected, "Export the file again."});
}

template <class T>
const T& item(const std::vector<T>& items, int index, const char* kind, const std::string& where) {
    if (index < 0 || static_cast<size_t>(index) >= items.size()) {
        throw_broken(where, fmt::format("{} {}", kind, index),
                     fmt::format("one of the file's {}", items.size()));
    }
    return items[static_cast<size_t>(index)];
}

/// `count` elements of `size` bytes, copied from a buffer view into consecutive bytes.
std::vector<unsigned char> packed_elements(const tinygltf::Model& model, int view_index,
                                           size_t offset, size_t count, size_t size,
                                           const std::string& where) {
    const tinygltf::BufferView& view = item(model.bufferViews, view_index, "bufferView", where);
    const tinygltf::Buffer& buffer = item(model.buffers, view.buffer, "buffer", where);
    if (view.byteOffset > buffer.data.size() ||
        view.byteLength > buffer.data.size() - view.byteOffset) {
        throw_broken(where,
                     fmt::format("bufferView {} with bytes {} + {}", view_index, view.byteOffset,
                                 view.byteLength),
                     fmt::format("bytes within its buffer of {}", buffer.data.size()));
    }
    const size_t stride = view.byteStride == 0 ? size : view.byteStride;
    const bool fits =
        count == 0 || (offset <= view.byteLength && size <= view.byteLength - offset &&
                       (count - 1) <= (view.byteLength - offset - size) / stride);
    if (!fits) {
        throw_broken(
            where, fmt::format("{} elements of {} bytes at {}", count, size, offset),
            fmt::format("elements within bufferView {} of {} bytes", view_index, view.byteLength));
    }
    std::vector<unsigned char> packed(count * size);
    const unsigned char* source = buffer.data.data() + view.byteOffset + offset;
    if (count > 0 && stride == size) {
        std::memcpy(packed.data(), source, packed.size());
    } else {
        for (size_t i = 0; i < count; ++i) {
            std::memcpy(packed.data() + i * size, source + i * stride, size);
        }
    }
    return packed;
}

std::vector<uint32_t> widened_indices(const std::vector<unsigned char>& bytes, size_t size) {
    std::vector<uint32_t> indices(bytes.size() / size);
    for (size_t i = 0; i < indices.size(); ++i) {
        for (size_t k = 0; k < size; ++k) {  // glTF is little-endian
            indices[i] |= static_cast<uint32_t>(bytes[i * size + k]) << (8 * k);
        }
    }
    return indices;
}

/// 1, 2 or 4 for an unsigned component type.
size_t index_size(int component_type, const std::string& where) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return 4;
        default:
            throw_broken(where, fmt::format("indices of component type {}", component_type),
                         "unsigned 8, 16 or 32 bit indices");
    }
}

/// All elements of an accessor, sparse substitution done.
std::vector<unsigned char> accessor_bytes(const tinygltf::Model& model,
                                          const tinygltf::Accessor& accessor, size_t size,
                                          const std::string& where) {
    std::vector<unsigned char> bytes = packed_elements(
        model, accessor.bufferView, accessor.byteOffset, accessor.count, size, where);
    if (!accessor.sparse.isSparse) return bytes;

    const auto& sparse = accessor.sparse;
    if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
        throw_broken(where, "a sparse accessor with a negative count or offset", "0 or more");
    }
    const auto count = static_cast<size_t>(sparse.count);
    const size_t size_of_index = index_size(sparse.indices.componentType, where);
    const std::vector<uint32_t> targets =
        widened_indices(packed_elements(model, sparse.indices.bufferView,
                                        static_cast<size_t>(sparse.indices.byteOffset), count,
                                        size_of_index, where),
                        size_of_index);
    const std::vector<unsigned char> values =
        packed_elements(model, sparse.values.bufferView,
                        static_cast<size_t>(sparse.values.byteOffset), count, size, where);
    for (size_t i = 0; i < count; ++i) {
        if (targets[i] >= accessor.count) {
            throw_broken(where, fmt::format("sparse index {}", targets[i]),
                         fmt::format("one below {}", accessor.count));
        }
        std::memcpy(bytes.data() + targets[i] * size, values.data() + i * size, size);
    }
    return bytes;
}

[[noreturn]] void throw_type(const tinygltf::Accessor& accessor, const std::string& expected,
                             const std::string& where) {
    throw_broken(where,
                 fmt::format("type {}, component type {}", accessor.type, accessor.componentType),
                 expected);
}

/// All floats of an accessor, element by element.
std::vector<float> read_floats(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                               int type, size_t components, const std::string& where) {
    if (accessor.type != type || accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
        constexpr const char* kNumbers[] = {"", "one 32 bit float", "two 32 bit floats",
                                            "three 32 bit floats", "four 32 bit floats"};
        throw_type(accessor, fmt::format("{} an element", kNumbers[components]), where);
    }
    const std::vector<unsigned char> bytes =
        accessor_bytes(model, accessor, components * sizeof(float), where);
    std::vector<float> floats(accessor.count * components);
    if (!floats.empty()) std::memcpy(floats.data(), bytes.data(), bytes.size());
    return floats;
}

template <class Integer>
std::vector<float> normalized(const std::vector<unsigned char>& bytes) {
    std::vector<float> floats(bytes.size() / sizeof(Integer));
    for (size_t i = 0; i < floats.size(); ++i) {
        Integer value;
        std::memcpy(&value, bytes.data() + i * sizeof(value), sizeof(value));
        constexpr float kLargest = std::numeric_limits<Integer>::max();
        floats[i] = std::max(static_cast<float>(value) / kLargest, -1.0f);
    }
    return floats;
}

/// All normalized integers of an accessor, as floats from -1 or 0 to 1.
std::vector<float> read_normalized(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                                   int type, size_t components, const std::string& where) {
    const auto read = [&](auto of_type) {
        using Integer = decltype(of_type);
        return normalized<Integer>(
            accessor_bytes(model, accessor, components * sizeof(Integer), where));
    };
    if (accessor.type == type && accessor.normalized) {
        switch (accessor.componentType) {
            case TINYGLTF_COMPONENT_TYPE_BYTE:
                return read(int8_t{});
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return read(uint8_t{});
            case TINYGLTF_COMPONENT_TYPE_SHORT:
                return read(int16_t{});
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return read(uint16_t{});
            default:
                break;
        }
    }
    throw_type(accessor, "32 bit floats, or normalized integers of 8 or 16 bits", where);
}

}  // namespace

std::vector<float> read_scalar_accessor(const tinygltf::Model& model, int accessor,
                                        const std::string& where) {
    const tinygltf::Accessor& a = item(model.accessors, accessor, "accessor", where);
    return read_floats(model, a, TINYGLTF_TYPE_SCALAR, 1, where);
}

std::vector<vec3> read_vec3_accessor(const tinygltf::Model& model, int accessor,
                                     const std::string& where) {
    const tinygltf::Accessor& a = item(model.accessors, accessor, "accessor", where);
    const std::vector<float> floats = read_floats(model, a, TINYGLTF_TYPE_VEC3, 3, where);
    std::vector<vec3> vectors(a.count);
    for (size_t i = 0; i < vectors.size(); ++i) {
        vectors[i] = vec3(floats[3 * i], floats[3 * i + 1], floats[3 * i + 2]);
    }
    return vectors;
}

std::vector<vec4> read_rotation_accessor(const tinygltf::Model& model, int accessor,
                                         const std::string& where) {
    const tinygltf::Accessor& a = item(model.accessors, accessor, "accessor", where);
    const bool is_float = a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
    const std::vector<float> floats = is_float
                                          ? read_floats(model, a, TINYGLTF_TYPE_VEC4, 4, where)
                                          : read_normalized(model, a, TINYGLTF_TYPE_VEC4, 4, where);
    std::vector<vec4> vectors(a.count);
    for (size_t i = 0; i < vectors.size(); ++i) {
        vectors[i] = vec4(floats[4 * i], floats[4 * i + 1], floats[4 * i + 2], floats[4 * i + 3]);
    }
    return vectors;
}

std::vector<uint32_t> read_index_accessor(const tinygltf::Model& model, int accessor,
                                          const std::string& where) {
    const tinygltf::Accessor& a = item(model.accessors, accessor, "accessor", where);
    if (a.type != TINYGLTF_TYPE_SCALAR) {
        throw_broken(where, fmt::format("indices of type {}", a.type), "scalars");
    }
    const size_t size = index_size(a.componentType, where);
    return widened_indices(accessor_bytes(model, a, size, where), size);
}

}  // namespace onepass
