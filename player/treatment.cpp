#include "player/treatment.h"

namespace lorica {

TreatmentControl treatmentControl(const MotionOptions& options, bool tracked) {
  TreatmentControl control;
  control.first.mirror = options.mirror;
  if (options.mirror) control.noMirror = "--mirror was given";
  if (options.smoothGiven) {
    control.first.smoothing = options.smooth == "off" ? 0 : kSmoothingAsGiven;
    control.noSmoothing = "--smooth was given";
  }
  if (!tracked) control.noSmoothing = "only tracked joints are smoothed";
  return control;
}

WindowTreatment allowed(const TreatmentControl& control, WindowTreatment chosen) {
  if (!control.noMirror.empty()) chosen.mirror = control.first.mirror;
  if (!control.noSmoothing.empty()) chosen.smoothing = control.first.smoothing;
  if (!control.noGravity.empty()) chosen.gravity = control.first.gravity;
  return chosen;
}

MotionOptions treated(MotionOptions options, const WindowTreatment& treatment) {
  options.mirror = treatment.mirror;
  if (treatment.smoothing == kSmoothingAsGiven) return options;
  const double cutoff = kSmoothings[treatment.smoothing].minCutoff;
  options.smooth = cutoff > 0.0 ? "one-euro" : "off";
  options.oneEuro = OneEuroSettings();
  options.oneEuro.minCutoff = cutoff;
  return options;
}

}  // namespace lorica
