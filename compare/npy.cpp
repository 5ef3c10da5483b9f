#include "compare/npy.h"

#include <bit>
#include <cctype>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/atomic_file.h"
#include "core/error.h"

namespace onepass {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "\x93NUMPY";

/// The header is padded so that the data starts at a multiple of this (the format's own rule).
constexpr size_t kAlignment = 64;

const std::vector<NpyField> kHitFields = {
    {"t", "<f4"}, {"u", "<f4"}, {"v", "<f4"}, {"prim_id", "<u4"}, {"inst_id", "<u4"}};

[[noreturn]] void refuse(const fs::path& path, const std::string& got, const std::string& expected,
                         const std::string& remedy) {
    throw Error({path.string(), got, expected, remedy});
}

/// The header is a Python dictionary of strings, numbers, booleans, tuples and lists. The same text
/// becomes JSON by other quotes, brackets and names, and without commas before a closing bracket.
json parse_python_literal(const std::string& text) {
    std::string out;
    char quote = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quote) {
            if (c == quote) quote = 0;
            out += c == '\'' ? '"' : c;
        } else if (c == '\'' || c == '"') {
            quote = c;
            out += '"';
        } else if (c == ')' || c == ']' || c == '}') {
            if (!out.empty() && out.back() == ',') out.pop_back();
            out += c == ')' ? ']' : c;
        } else if (c == '(') {
            out += '[';
        } else if (text.compare(i, 4, "True") == 0 || text.compare(i, 5, "False") == 0) {
            out += static_cast<char>(std::tolower(c));
        } else if (!std::isspace(static_cast<unsigned char>(c))) {
            out += c;
        }
    }
    return json::parse(out, nullptr, false);
}

struct NpyFile {
    json descr;
    std::vector<size_t> shape;
    std::string data;  ///< all bytes after the header
};

NpyFile read_npy(const fs::path& path) {
    // Whole file.
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
        refuse(path, "a folder", "an .npy file", "Name a file.");
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse(path, "a file that cannot be opened", "an .npy file", "Check the path.");
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};

    // Magic, version, header length.
    if (!bytes.starts_with(kMagic)) {
        refuse(path, "no NumPy magic", "an .npy file", "Write it with numpy.save.");
    }
    const size_t major = bytes.size() > 6 ? static_cast<unsigned char>(bytes[6]) : 0;
    if (major < 1 || major > 3) {
        refuse(path, fmt::format("format version {}", major), "version 1, 2 or 3",
               "Write it with numpy.save.");
    }
    const size_t length_bytes = major == 1 ? 2 : 4;
    const size_t header_begin = 8 + length_bytes;
    uint32_t header_length = 0;
    if (bytes.size() >= header_begin) std::memcpy(&header_length, &bytes[8], length_bytes);
    if (bytes.size() < header_begin || bytes.size() - header_begin < header_length) {
        refuse(path, "a file that ends inside its header", "a whole .npy file",
               "Write or copy it again.");
    }

    // Header.
    const json header = parse_python_literal(bytes.substr(header_begin, header_length));
    const bool sound = header.is_object() && header.contains("descr") &&
                       header.value("fortran_order", json()).is_boolean() &&
                       header.value("shape", json()).is_array();
    if (!sound) {
        refuse(path, "a header that cannot be read", "descr, fortran_order and shape",
               "Write it with numpy.save.");
    }
    if (header["fortran_order"].get<bool>()) {
        refuse(path, "Fortran order", "C order", "Pass it through numpy.ascontiguousarray.");
    }
    NpyFile npy{header["descr"], {}, bytes.substr(header_begin + header_length)};
    for (const json& extent : header["shape"]) {
        if (!extent.is_number_unsigned()) {
            refuse(path, "shape " + header["shape"].dump(), "whole numbers",
                   "Write it with numpy.save.");
        }
        npy.shape.push_back(extent.get<size_t>());
    }
    return npy;
}

/// The number of rows times `row_bytes` must be exactly what the file holds.
void check_length(const fs::path& path, const NpyFile& npy, size_t row_bytes) {
    const size_t rows = npy.shape[0];
    if (npy.data.size() % row_bytes == 0 && npy.data.size() / row_bytes == rows) return;
    refuse(path, fmt::format("{} bytes of data", npy.data.size()),
           fmt::format("{} rows of {} bytes, as the header says", rows, row_bytes),
           npy.data.size() / row_bytes < rows ? "The file is cut short: write or copy it again."
                                              : "Header and data differ: write it again.");
}

template <class Row>
std::vector<Row> rows_of(const NpyFile& npy) {
    std::vector<Row> rows(npy.shape[0]);
    if (!rows.empty())
        std::memcpy(static_cast<void*>(rows.data()), npy.data.data(), npy.data.size());
    return rows;
}

std::string shape_text(std::span<const size_t> shape) {
    std::string text;
    for (const size_t extent : shape) text += fmt::format("{}, ", extent);
    return fmt::format("({})", text.substr(0, text.size() - (shape.size() > 1 ? 2 : 1)));
}

std::string descr_text(std::span<const NpyField> fields) {
    std::string text;
    for (const NpyField& field : fields) {
        text += fmt::format("{}('{}', '{}')", text.empty() ? "" : ", ", field.name, field.type);
    }
    return fmt::format("[{}]", text);
}

void write_npy(const fs::path& path, const std::string& descr, std::span<const size_t> shape,
               std::string_view data) {
    std::string header = fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}",
                                     descr, shape_text(shape));
    const size_t prefix = kMagic.size() + 4;
    while ((prefix + header.size() + 1) % kAlignment != 0) header += ' ';
    header += '\n';
    ONEPASS_CHECK_LE(header.size(), size_t{0xFFFF});

    std::string file(kMagic);
    file += {'\1', '\0', static_cast<char>(header.size() & 0xFF),
             static_cast<char>(header.size() >> 8)};
    file += header;
    file += data;
    write_bytes_atomically(path, file);
}

template <class Row>
std::string_view bytes_of(std::span<const Row> rows) {
    return {reinterpret_cast<const char*>(rows.data()), rows.size_bytes()};
}

}  // namespace

std::vector<Ray> read_rays_npy(const fs::path& path) {
    const NpyFile npy = read_npy(path);
    if (npy.descr != "<f4") {
        refuse(path, "type " + npy.descr.dump(), "float32, little-endian ('<f4')",
               "Convert it with array.astype('<f4').");
    }
    if (npy.shape.size() != 2 || npy.shape[1] != 8) {
        refuse(path, "shape " + shape_text(npy.shape), "(N, 8): org, tmin, dir, tmax",
               "Give each ray one row of eight numbers.");
    }
    check_length(path, npy, sizeof(Ray));
    return rows_of<Ray>(npy);
}

void write_rays_npy(const fs::path& path, std::span<const Ray> rays) {
    const size_t shape[] = {rays.size(), 8};
    write_npy(path, "'<f4'", shape, bytes_of(rays));
}

std::vector<Hit> read_hits_npy(const fs::path& path) {
    const NpyFile npy = read_npy(path);
    if (npy.descr != parse_python_literal(descr_text(kHitFields))) {
        refuse(path, "type " + npy.descr.dump(), "fields " + descr_text(kHitFields),
               "Use that structured type.");
    }
    if (npy.shape.size() != 1) {
        refuse(path, "shape " + shape_text(npy.shape), "(N,): one hit a ray",
               "Make it one-dimensional.");
    }
    check_length(path, npy, sizeof(Hit));
    return rows_of<Hit>(npy);
}

void write_hits_npy(const fs::path& path, std::span<const Hit> hits) {
    const size_t shape[] = {hits.size()};
    write_npy(path, descr_text(kHitFields), shape, bytes_of(hits));
}

void write_structured_npy(const fs::path& path, std::span<const NpyField> fields,
                          std::span<const size_t> shape, std::span<const std::byte> bytes) {
    size_t expected = 4 * fields.size();
    for (const size_t extent : shape) expected *= extent;
    ONEPASS_CHECK_EQ(bytes.size(), expected);
    write_npy(path, descr_text(fields), shape, bytes_of(bytes));
}

}  // namespace onepass
