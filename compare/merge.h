// Uniting the shards of one study (compare/study.h): the file that one run of all its points would
// have written, but for times and for the manifests of those who measured.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/results.h"

namespace onepass {

/// A result file that was read.
struct ShardFile {
    std::string name;
    Results results;
};

/// Joins the points of all files, in the order of the study's keys, whatever the order of the
/// files. The result keeps every file's manifest in StudyRecord::parts; its own holds what they
/// agree on, their different texts joined by " | ", 0 cores if they differ, the latest time, and
/// the command line without --shard and --json.
///
/// `partial`: points may be missing, and then the result is not complete. Merging what was merged
/// gives the same as merging all at once.
/// Throws: Error naming file and difference for a file that is no study; or of another request,
///         seed or commit (of uncommitted changes: another build); or that shares a point with
///         another; or whose scene is not the others'; naming the points that are missing and whose
///         they are, unless `partial`.
Results merge_shards(const std::vector<ShardFile>& files, bool partial);

/// Whether times of the two can be compared: the same kind of CPU, cores, GL device and Embree.
bool like_machines(const Manifest& a, const Manifest& b);

/// Makes the paths of the results' pictures and pixel sheets, which are relative to `from`,
/// relative to `to`.
void move_pictures(Results& results, const std::filesystem::path& from,
                   const std::filesystem::path& to);

}  // namespace onepass
