// The progress bar: a line on stderr while that is a terminal, and nothing otherwise.
#pragma once

#include <chrono>
#include <string>

#include "compare/progress.h"

namespace onepass::cli {

/// Shown from its first update to its destruction. Knows its own share of a longer job, so that
/// loops can hand parts of it on.
class ProgressBar {
  public:
    explicit ProgressBar(std::string title);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// A callback for the part [begin, end] of the whole; false once Ctrl-C was pressed.
    Progress part(double begin, double end);

    /// A line on stderr, terminal or not, that the bar does not overwrite.
    void say(const std::string& line);

  private:
    void show(double done);

    std::string title_;
    bool on_terminal_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point shown_;
};

}  // namespace onepass::cli
