#include "core/io/gzip.h"

#include <cerrno>
#include <cstring>
#include <memory>

#include <zlib.h>

#include "core/error.h"

namespace onepass {
namespace {

[[noreturn]] void throw_damaged(const std::string& got) {
    throw Error({"", got, "a complete gzip file", "Fetch or compress the file again."});
}

struct CloseGzip {
    void operator()(gzFile file) const { gzclose(file); }
};

}  // namespace

std::string read_gzip(const std::filesystem::path& path) {
    const std::unique_ptr<gzFile_s, CloseGzip> file(gzopen(path.c_str(), "rb"));
    if (!file) throw_damaged(std::strerror(errno));

    std::string content;
    constexpr size_t kChunk = size_t{1} << 20;
    for (;;) {
        const size_t filled = content.size();
        content.resize(filled + kChunk);
        const int count = gzread(file.get(), content.data() + filled, kChunk);
        content.resize(filled + static_cast<size_t>(count > 0 ? count : 0));
        // zlib passes files that are not gzip through unchanged.
        if (gzdirect(file.get()) != 0) throw_damaged("a file without a gzip header");
        int error = Z_OK;
        const char* message = gzerror(file.get(), &error);
        if (error == Z_BUF_ERROR) throw_damaged("a truncated gzip file");
        if (error != Z_OK) throw_damaged(message);
        if (count <= 0) return content;
    }
}

}  // namespace onepass
