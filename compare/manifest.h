// Where a result comes from: this build, this machine, this moment.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "compare/results.h"
#include "core/catalogue.h"
#include "core/io/load.h"

namespace onepass {

/// The part of a manifest that this module can know; the caller adds GL, Embree and the judge.
/// Of the program, the first of `arguments`, its file name is kept: where it lay says nothing.
Manifest make_manifest(std::vector<std::string> arguments, uint64_t seed);

/// Hash of the running executable's bytes; "unknown" where the system does not show them.
/// Cost: reads the file, once a process: some 100 ms.
std::string program_hash();

/// "model name" of a /proc/cpuinfo; "unknown" if it has none.
std::string cpu_model(std::istream& cpuinfo);

/// Cores that this process may run on (its affinity mask, not the machine's count).
uint32_t usable_cores();

/// `name` is the command line's: results of one scene are found by it.
SceneRecord make_scene_record(const std::string& name, const LoadedScene& loaded);

/// `given`: the parameters as the tracer was made with; defaults are added.
TracerRecord make_tracer_record(const std::string& scene, const Tracer& tracer,
                                const TracerInfo& info, const ParamValues& given);

/// A stat's value; 0 if the tracer has none of that name.
double stat_value(const std::vector<Stat>& stats, const std::string& name);

}  // namespace onepass
