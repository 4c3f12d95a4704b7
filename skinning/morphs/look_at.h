#pragma once

#include "skinning/character.h"

#include <array>
#include <cstdint>
#include <span>

namespace lorica {

/// What moves when a character looks somewhere.
enum class LookAtKind : std::uint8_t {
  kNone,
  kBone,        ///< the joints of the eyes
  kExpression,  ///< lookUp, lookDown, lookLeft, lookRight
};

/// Maps 0 .. inputMax to 0 .. output linearly; larger inputs give `output`.
struct LookAtRange {
  double inputMax = 1.5707963267948966;  ///< [rad], greater than 0
  double output = 0.0;                   ///< [rad] for bones, weight for expressions

  [[nodiscard]] double operator()(double angle) const;  ///< @param angle  [rad], its sign is ignored
};

/// How a character's eyes follow what it looks at.
/// https://github.com/vrm-c/vrm-specification: VRMC_vrm-1.0/lookAt.md, and `firstPerson` in 0.0/README.md. Curves of
/// 0.x are read as straight lines, as three-vrm reads them.
struct LookAt {
  LookAtKind kind = LookAtKind::kNone;        ///< by bones, by expressions or not at all
  LookAtRange inner;                          ///< horizontally towards the nose; only for bones
  LookAtRange outer;                          ///< horizontally away from it, and both sides of expressions
  LookAtRange down;                           ///< downwards
  LookAtRange up;                             ///< upwards
  JointIndex head = kNoJoint;                 ///< of the character
  JointIndex leftEye = kNoJoint;              ///< kNoJoint if only expressions move the gaze
  JointIndex rightEye = kNoJoint;             ///< the same
  Vec3 offsetFromHead{0.0, 0.0, 0.0};         ///< the point between the eyes, in the head joint's frame and units
  Quat modelFromHead = Quat::Identity();      ///< rotation of the head at rest
  Quat modelFromLeftEye = Quat::Identity();   ///< rotations of the eyes at rest
  Quat modelFromRightEye = Quat::Identity();  ///< rotation of that eye at rest
};

/// Where a character looks, relative to its head; ahead if both are 0.
struct Gaze {
  double yaw = 0.0;    ///< positive to its left [rad]
  double pitch = 0.0;  ///< positive downwards [rad]
};

/// The gaze from between the eyes to a point; ahead if the character has no head.
/// @param worldFromHead  of the head's joint
/// @param target         [m], world
[[nodiscard]] Gaze gazeTowards(const LookAt& lookAt, const Affine3& worldFromHead, const Vec3& target);

/// The gaze of eyes that do not follow what is behind them: unchanged up to 60 degrees to a side, from there fading to
/// ahead at 90 degrees, so that it never jumps.
[[nodiscard]] Gaze followed(const Gaze& gaze);

/// Weights of lookUp, lookDown, lookLeft and lookRight for a gaze, 0 or more; all 0 unless expressions move the eyes.
struct GazeWeights {
  float up = 0.0F;     ///< 0 to 1
  float down = 0.0F;   ///< 0 to 1
  float left = 0.0F;   ///< of the character; 0 to 1
  float right = 0.0F;  ///< of the character; 0 to 1
};
/// Weights of the four expressions that look about; 0 unless LookAtKind::kExpression.
[[nodiscard]] GazeWeights gazeWeights(const LookAt& lookAt, const Gaze& gaze);

/// Rotations of the left and the right eye about the axes of the model; identity unless bones move the eyes.
[[nodiscard]] std::array<Quat, 2> eyeRotations(const LookAt& lookAt, const Gaze& gaze);

/// Turns the eyes and what hangs on them. Does nothing unless bones move the eyes. Does not allocate memory.
/// @param worldFromModel  one for each joint, see computeWorldFromModel(); changed for the eyes
void turnEyes(const Character& character, const LookAt& lookAt, const Gaze& gaze, std::span<Affine3> worldFromModel);

}  // namespace lorica
