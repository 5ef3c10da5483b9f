// What ladders (compare/stress.h) and trials (compare/trials.h) share: a contestant's record on a
// rung, and what they count there.
#pragma once

#include <string>
#include <string_view>

#include "compare/stress.h"
#include "core/error.h"

namespace onepass {

// Kinds of failure that are no class of hits.
inline constexpr char kExhausted[] = "exhausted";  ///< kFlagExhausted
inline constexpr char kGaveUp[] = "gave_up";       ///< the cast ended with an Error

/// A rung's record for a contestant, before anything is counted.
RungRecord empty_record(double knob, const std::string& label, const Contestant& contestant);

void add_failure(RungRecord& record, std::string_view kind);

/// All `trials` of the record fail as kGaveUp. What takes the work and then throws has not refused
/// it: a twin's fetch out of range, for instance.
void give_up(RungRecord& record, size_t trials);

/// What a record's `refusal` says of an Error.
std::string refusal_text(const Error& error);

/// The judge's hit, in float.
Hit true_hit(const Verdict& verdict);

}  // namespace onepass
