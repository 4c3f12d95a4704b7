#pragma once

#include "capture/tracking/fit/body_model.h"

namespace lorica::fit {

enum Limb : std::uint8_t { kLeftArm, kRightArm, kLeftLeg, kRightLeg };
inline constexpr int kFitLimbCount = 4;

/// The nodes of a limb: upper, lower, end.
[[nodiscard]] Node upperNodeOf(Limb limb);
[[nodiscard]] Node lowerNodeOf(Limb limb);
[[nodiscard]] Node endNodeOf(Limb limb);
[[nodiscard]] bool isOf(Limb limb, int node);

/// Aligns a limb with two directions; its end is as at rest. The rest of the pose stays.
/// @param body   of the pose: the limb's parent is read
/// @param upper  unit, from shoulder or hip to elbow or knee, floor frame
/// @param lower  unit, from elbow or knee to the limb's end
void layLimb(Limb limb, const PosedModel& body, const V3& upper, const V3& lower, BodyPose& pose);

/// Lays both legs as whoever has their hips at this height stands or sits: down to the ground, or the thighs level.
/// @param hips  over the ground, of the mannequin's size [m]
void layLegs(const PosedModel& body, float hips, BodyPose& pose);

/// The two directions of a limb that reaches for a target, with elbow or knee on one side of the line to it.
/// @param pole  which side; not parallel to the line
struct LimbLine {
  V3 upper, lower;
};
[[nodiscard]] LimbLine reachFor(const V3& origin, float upperLength, float lowerLength, const V3& target,
                                const V3& pole);

/// The same figure facing the other way: trunk and head are turned about the vertical; hands, elbows, knees and feet
/// stay in place but swap sides.
[[nodiscard]] BodyPose turnedAbout(const BodyPose& pose, const Proportions& proportions);

/// A standing figure that faces a direction of the floor plane: heading 0 faces +Z, increasing towards +X.
/// @param aside    angle of the arms sideways, from hanging [rad]
/// @param forward  angle of the arms forward, from hanging [rad]
/// @param elbow    bend of the elbows [rad]
[[nodiscard]] BodyPose standingPose(const V3& root, float heading, float aside, float forward, float elbow);
/// Arms hang, legs are straight; at the origin.
[[nodiscard]] const BodyPose& restPose();
/// Thighs level, shins down.
[[nodiscard]] BodyPose sittingPose(const V3& root, float heading);

}  // namespace lorica::fit
