#pragma once

#include "prepare/read_motion.h"
#include "viewer/renderer/window_values.h"

#include <string_view>

namespace lorica {

/// How the user may change the treatment of a window's session while it runs.
struct TreatmentControl {
  WindowTreatment first = {};  ///< of the session as it was made
  // Why one stays as it was made, whatever the user has kept; empty = it can be changed. With static storage duration.
  std::string_view noMirror = {};
  std::string_view noSmoothing = {};
  std::string_view noGravity = {};

  /// Everything stays as it was made.
  void fix(std::string_view why) { noMirror = noSmoothing = noGravity = why; }
};

/// Mirror and smoothing that were given with the command stay so.
/// @param tracked  whether there are joints to be smoothed
[[nodiscard]] TreatmentControl treatmentControl(const MotionOptions& options, bool tracked);

/// What stays as it was made stays so in the user's choice.
[[nodiscard]] WindowTreatment allowed(const TreatmentControl& control, WindowTreatment chosen);

/// The options with a window's mirror and smoothing.
[[nodiscard]] MotionOptions treated(MotionOptions options, const WindowTreatment& treatment);

}  // namespace lorica
