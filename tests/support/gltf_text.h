// Hand-made glTF: JSON text with its buffer as a data URI.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace onepass::test {

/// Appends the raw bytes of `values` and returns the offset where they start.
template <class T>
size_t append_bytes(std::string& bytes, const std::vector<T>& values) {
    const size_t offset = bytes.size();
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return offset;
}

inline std::string base64(const std::string& bytes) {
    constexpr const char* kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; ++k) {
            word =
                word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (size_t k = 0; k < 4; ++k) {
            text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=';
        }
    }
    return text;
}

/// A glTF file of one buffer; `members` are the JSON members after asset and buffers.
inline std::string gltf_text(const std::string& buffer, const std::string& members) {
    return R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": )" +
           std::to_string(buffer.size()) + R"(, "uri": "data:application/octet-stream;base64,)" +
           base64(buffer) + R"("}], )" + members + "}";
}

}  // namespace onepass::test
