#include "compare/atomic_file.h"

#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"

namespace onepass {
namespace fs = std::filesystem;

void check_writable(const fs::path& path) {
    std::error_code ignored;
    if (path.filename().empty() || fs::is_directory(path, ignored)) {
        throw Error({path.string(), "a folder", "the name of a file to write", "Add a file name."});
    }
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) {
        throw Error({path.string(), fmt::format("no folder '{}'", folder.string()),
                     "an existing folder", "Make the folder first."});
    }
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
    check_writable(path);
    fs::path temporary = path;
    temporary.replace_filename(
        fmt::format(".{}.{}.tmp{}", path.stem().string(), getpid(), path.extension().string()));
    try {
        write(temporary);
        std::error_code failure;
        fs::rename(temporary, path, failure);
        if (failure) {
            throw Error({path.string(), failure.message(), "a file that can be replaced",
                         "Check the permissions of the folder."});
        }
    } catch (...) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        throw;
    }
}

void write_bytes_atomically(const fs::path& path, std::string_view bytes) {
    write_atomically(path, [&](const fs::path& temporary) {
        std::ofstream file(temporary, std::ios::binary);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) {
            throw Error({path.string(), "a failed write", "space and permission to write",
                         "Check the disk and the permissions of the folder."});
        }
    });
}

}  // namespace onepass
