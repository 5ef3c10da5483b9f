// A GPU's clocks, as NVIDIA's management library tells them.
//
// The library comes with the driver and is opened at run time; where it is absent, so are the
// clocks: nothing is guessed. Knows nothing of GL.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "compare/results.h"

namespace onepass {

/// Reads the clocks of this machine's one NVIDIA GPU.
class ClockReader {
  public:
    /// `library`: name or path of the management library, as dlopen takes it.
    explicit ClockReader(const std::string& library = "libnvidia-ml.so.1");
    ~ClockReader();
    ClockReader(const ClockReader&) = delete;
    ClockReader& operator=(const ClockReader&) = delete;

    /// The device's name; where there is nothing to read, why: no library, no device, or several,
    /// of which GL does not tell the one it uses.
    const std::string& source() const { return source_; }

    /// Absent where source() says why. Cost: below 1 ms.
    std::optional<ClockReading> read() const;

  private:
    struct Library;

    std::string connect(const std::string& library);

    std::unique_ptr<Library> library_;  ///< null: nothing to read
    std::string source_;
};

}  // namespace onepass
