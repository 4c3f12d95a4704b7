#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/result.h"

#include <string>

namespace lorica {

/// What reading from a depth source came to.
enum class DepthRead : std::uint8_t {
  kFrame,      ///< a new frame was written
  kWaiting,    ///< none came within a tenth of a second
  kUnplugged,  ///< the sensor is gone; it may come back: ask again
  kEnd,        ///< of a recording
};

/// Where depth frames come from: a sensor, a recording, the virtual sensor. One thread reads.
class DepthSource {
 public:
  virtual ~DepthSource() = default;

  /// Of all frames.
  [[nodiscard]] virtual const DepthCamera& camera() const = 0;
  /// For people: "PrimeSense, PS1080 (1d27/0609@1/4)", "body.oni", "virtual sensor".
  [[nodiscard]] virtual std::string name() const = 0;

  /// Waits for the next frame, at most about a tenth of a second where the source is live. Frames come once, in order.
  /// @param frame  written where the answer is kFrame, its storage used again; else untouched
  /// @return what came, or what is wrong with the data for good
  [[nodiscard]] virtual Result<DepthRead> next(DepthFrame& frame) = 0;
};

}  // namespace lorica
