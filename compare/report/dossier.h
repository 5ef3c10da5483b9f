// The data of several runs sorted by scene: what the page's sections walk through.
//
// Holds pointers into the Results it was made from; those must outlive it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/results.h"

namespace onepass::report {

/// A record with the tracer it speaks of and the run it comes from.
template <class Record>
struct Entry {
    const Record* record = nullptr;
    const TracerRecord* tracer = nullptr;  ///< of the same run; null if the run lists none
    size_t run = 0;

    const Record* operator->() const { return record; }
};

template <class Record>
const std::string& tracer_name(const Record& record) {
    return record.tracer;
}
inline const std::string& tracer_name(const TracerRecord& record) { return record.name; }

/// All that is known of one scene.
struct SceneDossier {
    std::string name;
    std::vector<Entry<SceneRecord>> versions;  ///< different contents under this name; mostly one
    std::vector<Entry<TracerRecord>> tracers;
    std::vector<Entry<CheckRecord>> checks;
    /// Checks of a tracer on a ray kind of which `checks` holds one with at least as many rays,
    /// such as those that a bench makes along with its timings.
    std::vector<Entry<CheckRecord>> lesser_checks;
    /// Embree's own rows (CheckRecord::reference): one a tracer and ray kind, that of the most
    /// rays.
    std::vector<Entry<CheckRecord>> references;
    std::vector<Entry<ImageRecord>> images;
    std::vector<Entry<TimingRecord>> timings;
    std::vector<Entry<SweepPoint>> sweeps;
    std::vector<Entry<TradeoffPoint>> tradeoffs;
};

struct Dossier {
    const std::vector<Results>* runs = nullptr;
    const std::vector<std::filesystem::path>* folders = nullptr;
    std::vector<SceneDossier> scenes;  ///< in the order of their first appearance
    bool software_renderer = false;    ///< some GL figure was made by a CPU
};

/// Sorts the runs. Records that two runs share word for word (a check made again with the same rays
/// and the same outcome) appear once, and so does a tracer that a run lists at many grid sizes.
Dossier gather(const std::vector<Results>& runs, const std::vector<std::filesystem::path>& folders);

/// The tracer's name, and its parameters as far as `peers` of that name have other values:
/// "paper/texture2d/fragment (edge_tolerance = 1.0)". Not escaped.
std::string label(const std::string& name, const TracerRecord* tracer,
                  const std::vector<const TracerRecord*>& peers);

/// The same among the records of one list.
template <class Record>
std::string label(const std::vector<Entry<Record>>& peers, const Entry<Record>& entry) {
    std::vector<const TracerRecord*> tracers;
    for (const Entry<Record>& peer : peers) tracers.push_back(peer.tracer);
    return label(tracer_name(*entry.record), entry.tracer, tracers);
}

/// A parameter's value as a number; NaN if the tracer is unknown or has no such parameter.
double param_value(const TracerRecord* tracer, const std::string& name);

/// The part before the first '/': "paper".
std::string strategy_of(const std::string& tracer_name);

}  // namespace onepass::report
