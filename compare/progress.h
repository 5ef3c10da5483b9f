// How long work reports that it moves on, and learns that it should stop. Silent itself: the bar on
// the terminal is the command line's (cli/progress_bar.h).
#pragma once

#include <functional>

namespace onepass {

/// Called with the share of the work that is done, 0 to 1; answers false to ask for a stop. Work
/// that is stopped returns what it has, whole up to there.
using Progress = std::function<bool(double done)>;

inline bool go_on(const Progress& progress, double done) { return !progress || progress(done); }

/// From now on the first Ctrl-C (SIGINT) only sets the flag that stop_requested() reads; a second
/// one ends the process.
void catch_interrupts();
bool stop_requested();

}  // namespace onepass
