// The pictures of a check: gathered in memory, written when the point they belong to is finished,
// so that a check that fails half way leaves no stray files.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "compare/images.h"

namespace onepass::cli {

class PictureSet {
  public:
    /// `folder`: where --pictures says; empty: beside `json`; with neither, pictures are dropped.
    /// A build without PNG support drops them too, and says so on stderr.
    PictureSet(const std::string& folder, const std::string& json);

    bool wanted() const { return wanted_; }
    bool has_folder() const { return has_folder_; }

    /// Keeps a picture as JSON_NAME.png (JSON: the results' name, so that two runs in one folder do
    /// not overwrite each other's), once; returns its path relative to the JSON's folder, or "" if
    /// pictures are dropped.
    std::string add(const std::string& name, Picture picture);

    /// The same for any other small file; `extension` with its dot. Kept by a build without PNG
    /// support as well.
    std::string add_file(const std::string& name, const std::string& extension, std::string bytes);

    /// Makes the folder and writes the pictures and files gathered since the last call. Throws:
    /// Error if it cannot.
    void write();

    /// Says on stderr how many were written, if any.
    void report() const;

  private:
    std::filesystem::path path_of(const std::string& name, const std::string& extension) const;
    std::string as_named_in_json(const std::filesystem::path& path) const;

    bool wanted_ = false;
    bool has_folder_ = false;
    std::filesystem::path folder_;
    std::filesystem::path json_folder_;
    std::string prefix_;
    std::vector<std::pair<std::filesystem::path, Picture>> pictures_;   ///< not yet written
    std::vector<std::pair<std::filesystem::path, std::string>> files_;  ///< not yet written
    std::set<std::filesystem::path> written_;                           ///< of the pictures
};

}  // namespace onepass::cli
