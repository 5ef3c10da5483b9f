#include "compare/cli/progress_bar.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace onepass::cli {
namespace {

using std::chrono::steady_clock;

constexpr int kBarWidth = 30;
constexpr auto kRedrawEvery = std::chrono::milliseconds(100);

/// Below this share, a guess of the time left would jump about.
constexpr double kLeastShareToGuess = 0.02;

}  // namespace

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)),
      on_terminal_(isatty(STDERR_FILENO) == 1),
      start_(steady_clock::now()),
      shown_(start_) {}

ProgressBar::~ProgressBar() {
    if (on_terminal_) fmt::print(stderr, "\r\033[K");
}

Progress ProgressBar::part(double begin, double end) {
    return [this, begin, end](double done) {
        show(begin + (end - begin) * done);
        return !stop_requested();
    };
}

void ProgressBar::say(const std::string& line) {
    fmt::print(stderr, "{}onepass: {}\n", on_terminal_ ? "\r\033[K" : "", line);
}

void ProgressBar::show(double done) {
    const auto now = steady_clock::now();
    if (!on_terminal_ || now - shown_ < kRedrawEvery) return;
    shown_ = now;
    const int full = static_cast<int>(kBarWidth * std::clamp(done, 0.0, 1.0));
    fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %", title_, "", full, "",
               kBarWidth - full, 100.0 * done);
    if (done > kLeastShareToGuess) {
        const double elapsed_s = std::chrono::duration<double>(now - start_).count();
        fmt::print(stderr, ", about {:.0f} s left", elapsed_s * (1.0 - done) / done);
    }
    std::fflush(stderr);
}

}  // namespace onepass::cli
