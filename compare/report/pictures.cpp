#include "compare/report/pictures.h"

#include <array>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass::report {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
// Signature, then the IHDR chunk: length, type, width, height.
constexpr size_t kPngHeaderBytes = 24;
constexpr size_t kPngWidthAt = 16;
constexpr size_t kPngHeightAt = 20;

unsigned big_endian(const std::string& bytes, size_t at) {
    unsigned value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

}  // namespace

std::string base64(const std::string& bytes) {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t at = 0; at < bytes.size(); at += 3) {
        const size_t left = bytes.size() - at;
        uint32_t group = 0;
        for (size_t i = 0; i < 3; ++i) {
            group = group << 8 | (i < left ? static_cast<unsigned char>(bytes[at + i]) : 0u);
        }
        out += kDigits[group >> 18 & 63];
        out += kDigits[group >> 12 & 63];
        out += left > 1 ? kDigits[group >> 6 & 63] : '=';
        out += left > 2 ? kDigits[group & 63] : '=';
    }
    return out;
}

std::string read_png(const std::filesystem::path& path) {
    const std::string remedy =
        "Keep the pictures beside the JSON file that names them, or make the run again";
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw Error({path.string(), "no readable file", "a picture of this run", remedy});
    }
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (bytes.size() < kPngHeaderBytes || !bytes.starts_with(kPngSignature)) {
        throw Error({path.string(), fmt::format("{} bytes that are no PNG", bytes.size()),
                     "a PNG picture of this run", remedy});
    }
    return bytes;
}

PngSize png_size(const std::string& bytes) {
    ONEPASS_CHECK_LE(kPngHeaderBytes, bytes.size());
    return {big_endian(bytes, kPngWidthAt), big_endian(bytes, kPngHeightAt)};
}

std::string data_uri(const std::string& png_bytes) {
    return "data:image/png;base64," + base64(png_bytes);
}

}  // namespace onepass::report
