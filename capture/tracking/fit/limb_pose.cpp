#include "capture/tracking/fit/limb_pose.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

bool isArm(Limb limb) {
  return limb == kLeftArm || limb == kRightArm;
}

V3 unitAcross(const V3& v, const V3& along) {
  V3 out = v - v.dot(along) * along;
  const float length = out.norm();
  if (length < 1e-4F) return V3::Zero();
  return out / length;
}

V3 anyAcross(const V3& along) {
  const V3 min = std::abs(along.x()) < 0.6F ? V3::UnitX() : V3::UnitY();
  return unitAcross(min, along);
}

}  // namespace

Node upperNodeOf(Limb limb) {
  constexpr Node nodes[] = {kLeftUpperArm, kRightUpperArm, kLeftThigh, kRightThigh};
  return nodes[limb];
}
Node lowerNodeOf(Limb limb) {
  constexpr Node nodes[] = {kLeftForearm, kRightForearm, kLeftShin, kRightShin};
  return nodes[limb];
}
Node endNodeOf(Limb limb) {
  constexpr Node nodes[] = {kLeftHand, kRightHand, kLeftFoot, kRightFoot};
  return nodes[limb];
}
bool isOf(Limb limb, int node) {
  return node == upperNodeOf(limb) || node == lowerNodeOf(limb) || node == endNodeOf(limb);
}

void layLimb(Limb limb, const PosedModel& body, const V3& upper, const V3& lower, BodyPose& pose) {
  const Node node = upperNodeOf(limb);
  const auto& def = nodeDefs()[node];
  const M3& above = body.rotation[def.parent];
  const float bend = std::acos(std::clamp(upper.dot(lower), -1.0F, 1.0F));
  // The lower limb bends forward for an arm, backward for a leg; a straight limb takes the shortest rotation.
  V3 side = unitAcross(isArm(limb) ? lower : V3(-lower), upper);
  if (bend < 0.15F || side.squaredNorm() < 0.5F) {
    const V3 rest = isArm(limb) ? V3(limb == kLeftArm ? 1.0F : -1.0F, 0.0F, 0.0F) : V3(0.0F, -1.0F, 0.0F);
    const Q shortest = rotationBetween(V3(above * rest), upper);
    side = unitAcross(shortest * (above * V3::UnitZ()), upper);
    if (side.squaredNorm() < 0.5F) side = anyAcross(upper);
  }
  M3 rotation;
  if (isArm(limb)) {
    const V3 x = limb == kLeftArm ? upper : V3(-upper);
    rotation.col(0) = x;
    rotation.col(2) = side;
    rotation.col(1) = side.cross(x);
  } else {
    rotation.col(1) = -upper;
    rotation.col(2) = side;
    rotation.col(0) = V3(-upper).cross(side);
  }
  pose.turn[node] = Q(M3(above.transpose() * rotation)).normalized();
  const Node low = lowerNodeOf(limb);
  pose.angle[low][0] = std::clamp(bend, nodeDefs()[low].min[0], nodeDefs()[low].max[0]);
  pose.angle[endNodeOf(limb)] = {0.0F, 0.0F};
}

void layLegs(const PosedModel& body, float hips, BodyPose& pose) {
  constexpr float kSeated = 0.7F;  // hips below this are on a seat [m]
  V3 ahead = body.rotation[kPelvis].col(2);
  ahead.y() = 0.0F;
  const V3 down = -V3::UnitY();
  const V3 thigh = hips < kSeated && ahead.norm() > 0.1F ? V3(ahead.normalized()) : down;
  for (const Limb leg : {kLeftLeg, kRightLeg}) layLimb(leg, body, thigh, down, pose);
}

LimbLine reachFor(const V3& origin, float upperLength, float lowerLength, const V3& target, const V3& pole) {
  V3 line = target - origin;
  float distance = line.norm();
  if (distance < 1e-4F) {
    line = pole;
    distance = 1e-4F;
  }
  const V3 along = line.normalized();
  const float reach =
      std::clamp(distance, std::abs(upperLength - lowerLength) + 0.01F, upperLength + lowerLength - 1e-3F);
  const float share =
      (upperLength * upperLength + reach * reach - lowerLength * lowerLength) / (2.0F * upperLength * reach);
  const float c = std::clamp(share, -1.0F, 1.0F);
  const float s = std::sqrt(1.0F - c * c);
  V3 side = unitAcross(pole, along);
  if (side.squaredNorm() < 0.5F) side = anyAcross(along);
  const V3 upper = c * along + s * side;
  const V3 lower = (reach * along - upperLength * upper) / lowerLength;
  return {upper, lower.normalized()};
}

BodyPose turnedAbout(const BodyPose& pose, const Proportions& proportions) {
  PosedModel body;
  poseBody(pose, proportions, body);
  BodyPose out = pose;
  // Half a turn about the vertical would turn the trunk's forward bend into a backward bend, so mirror it: the new
  // front is the old back, and its lean in the world is the same.
  const Q half(Eigen::AngleAxisf(3.14159265F, V3::UnitY()));
  out.turn[kPelvis] = pose.turn[kPelvis] * half;
  for (const Node node : {kSpine, kChest, kNeck}) out.turn[node] = half.conjugate() * pose.turn[node] * half;
  for (const Node node : {kLeftClavicle, kRightClavicle}) out.angle[node] = {0.0F, 0.0F};
  for (const int limb : {0, 1, 2, 3}) {
    const auto mine = static_cast<Limb>(limb);
    const auto other = static_cast<Limb>(limb ^ 1);
    PosedModel turned;
    poseBody(out, proportions, turned);
    const auto up = upperNodeOf(mine);
    const auto low = lowerNodeOf(mine);
    const auto end = endNodeOf(mine);
    const V3 origin = turned.position[up];
    const V3 mid = body.position[lowerNodeOf(other)];
    const V3 tip = body.position[endNodeOf(other)];
    const float a = (turned.position[low] - origin).norm();
    const float b = (turned.position[end] - turned.position[low]).norm();
    V3 pole = mid - origin;
    if (mine == kLeftLeg || mine == kRightLeg) pole = turned.rotation[kPelvis].col(2);
    const LimbLine line = reachFor(origin, a, b, tip, pole);
    layLimb(mine, turned, line.upper, line.lower, out);
  }
  return out;
}

BodyPose standingPose(const V3& root, float heading, float aside, float forward, float elbow) {
  BodyPose pose;
  pose.root = root;
  pose.turn[kPelvis] = Q(Eigen::AngleAxisf(heading, V3::UnitY()));
  PosedModel body;
  poseBody(pose, Proportions(), body);
  const M3& turn = body.rotation[kPelvis];
  for (const Limb limb : {kLeftArm, kRightArm}) {
    const float m = limb == kLeftArm ? 1.0F : -1.0F;
    const V3 upper = V3(m * std::sin(aside), -std::cos(aside) * std::cos(forward), std::cos(aside) * std::sin(forward));
    const V3 front = V3(0.0F, std::sin(forward), std::cos(forward));
    const V3 lower = std::cos(elbow) * upper + std::sin(elbow) * unitAcross(front, upper);
    layLimb(limb, body, turn * upper, turn * lower, pose);
  }
  return pose;
}

const BodyPose& restPose() {
  static const BodyPose rest = standingPose(V3::Zero(), 0.0F, 0.15F, 0.1F, 0.25F);
  return rest;
}

BodyPose sittingPose(const V3& root, float heading) {
  BodyPose pose = standingPose(root, heading, 0.2F, 0.3F, 0.7F);
  for (const Node node : {kLeftThigh, kRightThigh}) pose.turn[node] = Q(Eigen::AngleAxisf(-1.4F, V3::UnitX()));
  for (const Node node : {kLeftShin, kRightShin}) pose.angle[node][0] = 1.4F;
  return pose;
}

}  // namespace lorica::fit
