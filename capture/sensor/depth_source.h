#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/result.h"

#include <string>

namespace lorica {

/// Result of reading from a depth source.
enum class DepthRead : std::uint8_t {
  kFrame,      ///< a new frame was written
  kWaiting,    ///< no frame arrived within a tenth of a second
  kUnplugged,  ///< the sensor is unplugged; it may return, so try again
  kEnd,        ///< end of a recording
};

/// Source of depth frames: a sensor, a recording, the virtual sensor. To be read by one thread.
class DepthSource {
 public:
  virtual ~DepthSource() = default;

  /// The camera of all frames.
  [[nodiscard]] virtual const DepthCamera& camera() const = 0;
  /// Display name: "PrimeSense, PS1080 (1d27/0609@1/4)", "body.oni", "virtual sensor".
  [[nodiscard]] virtual std::string name() const = 0;

  /// Waits for the next frame, for a live source at most about a tenth of a second. Returns every frame once, in order.
  /// @param frame  written if the result is kFrame, reusing its storage; else unchanged
  /// @return the kind of result, or an error if the data is permanently unusable
  [[nodiscard]] virtual Result<DepthRead> next(DepthFrame& frame) = 0;
};

}  // namespace lorica
