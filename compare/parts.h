// A long run in steps: each step's results are kept as they finish, so that the same command goes
// on where it was stopped.
//
// A part is a Results file like any other, PARTS_FOLDER/STEP.json; paths of its pictures are
// relative to the run's folder, not to its own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "compare/results.h"

namespace onepass {

/// Why results of `past` cannot stand for what a run of `present` would find: another build,
/// device, CPU, seed or command line; empty if they can. The time does not count.
std::string origin_difference(const Manifest& past, const Manifest& present);

/// A part as it was found.
struct FoundPart {
    std::optional<Results> results;  ///< only if it can stand for a new run
    std::string why_not;             ///< else: why a part that is there cannot; empty: none there
};

class PartStore {
  public:
    /// Makes `folder` and those above it.
    /// Throws: Error if it cannot.
    explicit PartStore(std::filesystem::path folder);

    /// `present`: the manifest with which the step would run now. A file that cannot be read is no
    /// part.
    FoundPart find(const std::string& step, const Manifest& present) const;

    /// Whole or not at all. Throws: as write_results.
    void save(const std::string& step, const Results& results) const;

  private:
    std::filesystem::path path_of(const std::string& step) const;

    std::filesystem::path folder_;
};

/// Appends all records of `part`; the manifest stays as it is, but for the judge.
void append_results(Results& results, const Results& part);

}  // namespace onepass
