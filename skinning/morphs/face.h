#pragma once

#include "skinning/morphs/expressions.h"
#include "skinning/morphs/look_at.h"
#include "skinning/morphs/morphs.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// How far the eyelids are closed at a time, 0 to 1.
///
/// The time is divided into slots of 4 s, each with one blink that begins 2 to 4 s after the slot does and lasts 0.1 to
/// 0.2 s, both from a hash of the slot's number and the seed. So blinks begin 2 to 6 s apart, and the value depends on
/// nothing but the arguments.
/// @param time  [s]
[[nodiscard]] float blinkWeight(double time, std::uint64_t seed = 0);

/// What drives a face in one frame, beside the weights that somebody set.
struct FaceInput {
  double time = 0.0;                            ///< of the session, for blinking [s]
  Gaze gaze;                                    ///< ahead, or gazeTowards() a camera
  std::span<const MorphWeightTrack> clip = {};  ///< of the clip that plays, see Morphs::clips
  double clipTime = 0.0;                        ///< [s]
};

/// The face of one character: from chosen weights, a clip, blinking and gaze to weights of morph targets.
///
/// A clip sets the targets that it has tracks for; expressions add to that. The face blinks only while no clip moves
/// targets and no blink expression was set; it follows the gaze only while no look expression was set.
class Face {
 public:
  /// @param morphs, expressions, lookAt  must outlive the face and stay unchanged
  Face(const Morphs& morphs, const Expressions& expressions, const LookAt& lookAt);

  /// Sets an expression until it is set again.
  /// @param expression  index, see findExpression()
  void set(std::size_t expression, float weight);
  void setBlinking(bool blinks) { blinks_ = blinks; }

  /// Computes the weights of a frame. Does not allocate memory.
  void update(const FaceInput& input);

  /// What each expression contributes, after overrides: for its colours and textures.
  [[nodiscard]] std::span<const float> expressionWeights() const { return effective_; }
  /// For applyMorphs().
  [[nodiscard]] std::span<const float> targetWeights() const { return targets_; }

 private:
  /// Index of a preset's expression, or -1.
  [[nodiscard]] int indexOf(const char* preset) const;
  void drive(int expression, float weight);

  const Morphs* morphs_;
  const Expressions* expressions_;
  const LookAt* lookAt_;
  int blink_, blinkLeft_, blinkRight_, lookUp_, lookDown_, lookLeft_, lookRight_;
  bool blinks_ = true;
  std::vector<float> chosen_;  // by set()
  std::vector<float> wanted_;  // with what drives itself
  std::vector<float> effective_;
  std::vector<float> targets_;
};

}  // namespace lorica
