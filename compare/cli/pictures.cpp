#include "compare/cli/pictures.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/options.h"
#include "compare/image_io.h"
#include "core/error.h"

namespace onepass::cli {
namespace fs = std::filesystem;

PictureSet::PictureSet(const std::string& folder, const std::string& json) {
    const bool has_json = !json.empty() && json != "-";
    if (folder.empty() && !has_json) return;
    json_folder_ = has_json ? fs::path(json).parent_path() : fs::path();
    if (json_folder_.empty()) json_folder_ = ".";
    folder_ = folder.empty() ? json_folder_ : fs::path(folder);
    if (has_json) prefix_ = fs::path(json).stem().string() + "_";
    has_folder_ = true;
    wanted_ = image_files_supported();
    if (!wanted_) fmt::print(stderr, "onepass: no pictures: OpenImageIO is not built in\n");
}

fs::path PictureSet::path_of(const std::string& name, const std::string& extension) const {
    return folder_ / (file_name_part(prefix_ + name) + extension);
}

std::string PictureSet::as_named_in_json(const fs::path& path) const {
    return fs::relative(fs::absolute(path), fs::absolute(json_folder_)).string();
}

std::string PictureSet::add(const std::string& name, Picture picture) {
    if (!wanted_) return "";
    const fs::path path = path_of(name, ".png");
    const bool known = written_.contains(path) ||
                       std::any_of(pictures_.begin(), pictures_.end(),
                                   [&](const auto& entry) { return entry.first == path; });
    if (!known) pictures_.emplace_back(path, std::move(picture));
    return as_named_in_json(path);
}

std::string PictureSet::add_file(const std::string& name, const std::string& extension,
                                 std::string bytes) {
    if (!has_folder_) return "";
    const fs::path path = path_of(name, extension);
    files_.emplace_back(path, std::move(bytes));
    return as_named_in_json(path);
}

void PictureSet::write() {
    if (pictures_.empty() && files_.empty()) return;
    std::error_code failure;
    fs::create_directories(folder_, failure);
    if (failure) {
        throw Error({folder_.string(), failure.message(), "a folder for pictures",
                     "Choose another with --pictures."});
    }
    for (const auto& [path, picture] : pictures_) {
        write_png(path, picture);
        written_.insert(path);
    }
    pictures_.clear();
    for (const auto& [path, bytes] : files_) write_bytes_atomically(path, bytes);
    files_.clear();
}

void PictureSet::report() const {
    if (written_.empty()) return;
    fmt::print(stderr, "onepass: wrote {} pictures to {}\n", written_.size(), folder_.string());
}

}  // namespace onepass::cli
