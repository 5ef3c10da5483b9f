// A study: long work made of points, each finished as a whole, written to its file as it finishes
// and never done twice.
//
// A point has a readable key; the keys of a study stand in one order that depends on the request
// alone. So does the order of the records: a run that was killed and taken up again, and shards
// that were merged (compare/merge.h), give the file that one run would have given, but for times.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "compare/results.h"

namespace onepass {

/// "2/4" -> {2, 4}. Throws: Error for another form, or an index out of 1 to count.
Shard parse_shard(const std::string& text);

/// "2/4".
std::string to_string(const Shard& shard);

/// True if the shard takes the point: point k of the keys' order goes to shard k mod count + 1, so
/// that neighbours, which cost alike, are spread.
bool takes(const Shard& shard, size_t point);

/// The words of a command line that say what is asked: all but --shard and --json, which say who
/// does it and where it goes.
std::vector<std::string> request_of(const std::vector<std::string>& arguments);

/// The points' records in the order of `keys`; what points share (their scene, its tracers,
/// their builds, and refusals) stands once, as the first of them has it. `study` says whose each
/// record is. The manifest is the caller's, but for the judge. Throws: Error if two points have
/// different scenes of one name.
Results join_points(const std::vector<std::string>& keys,
                    const std::map<std::string, Results>& points);

/// The reverse: each finished point with its records, and with the manifest of the whole.
/// Throws: Error naming `file` if its study is not sound: an unknown key, list or row.
std::map<std::string, Results> split_points(const Results& results, const std::string& file);

struct StudyRequest {
    std::vector<std::string> keys;  ///< of all shards; one that is repeated counts once
    Shard shard;
    Manifest manifest;           ///< as the run would write it now, the GL device included
    std::filesystem::path file;  ///< empty or "-": nothing is kept on the way
};

class Study {
  public:
    /// Begins, or takes up what an earlier run of the same request left unfinished in the file. A
    /// complete file, or one that is no study, is made anew by the first point that finishes.
    /// Throws: Error if the file is the unfinished study of another request: other arguments, seed,
    /// shard, build, machine. What differs is said. Also if its digest is not that of its content:
    /// the next point would seal the edit.
    explicit Study(StudyRequest request);

    /// Points of this shard that an earlier run had finished.
    size_t kept() const { return kept_; }
    /// Points of this shard that are finished, the kept ones included.
    size_t done() const { return done_.size(); }
    /// Points of this shard.
    size_t total() const { return mine_.size(); }
    bool finished() const { return done() == total(); }

    /// The point is this shard's, and not finished.
    bool needs(const std::string& key) const;

    /// Throws: Error if a finished point has another scene of this name: its file has changed.
    /// For a scene just opened, before anything is measured in it.
    void check_scene(const SceneRecord& scene) const;

    /// Takes over a finished point: its records, its scene's and its tracers' among them. Writes
    /// the file anew, whole or not at all: who kills the process loses only the points in flight.
    /// Cost: writes all records so far. 1,000 points of a tuning study are 1.1 MB; writing them
    /// took 40 to 55 ms on a busy machine of two cores.
    void add(const std::string& key, Results point);

    /// All finished points; complete if none of this shard's is missing.
    Results results() const;

  private:
    void take_up();

    StudyRequest request_;
    std::vector<std::string> mine_;        ///< keys of this shard, in order
    std::map<std::string, Results> done_;  ///< by key
    size_t kept_ = 0;
};

}  // namespace onepass
