#include "skinning/mannequin/mannequin_skeleton.h"
#include "tests/bench/generators/mannequin_cage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {

namespace {

using enum HumanBone;

constexpr int kRing = 10;  ///< points of a limb's ring
constexpr double kStep = 2.0 * std::numbers::pi / kRing;

constexpr double kCrotchShare = 0.35;  ///< share that the innermost point of the thigh's first ring leaves to the hips
constexpr double kToeArc = 0.022;      ///< how far the sides of the toes are behind the middle [m]

[[nodiscard]] BoneWeights between(HumanBone near, HumanBone far, double share) {
  if (share <= 0.0) return {{near, 1.0}};
  if (share >= 1.0) return {{far, 1.0}};
  return {{near, 1.0 - share}, {far, share}};
}

/// A section of the arm across X.
struct ArmSection {
  double x, y, z;
  double up, down, front, back;  ///< radii [m]
  HumanBone near, far;
  double share;  ///< weight of the far bone
};

constexpr ArmSection kArm[] = {
    {0.205, 1.409, -0.018, 0.048, 0.053, 0.055, 0.058, kLeftShoulder, kLeftUpperArm, 0.76},  // deltoid
    {0.290, 1.409, -0.019, 0.043, 0.047, 0.046, 0.046, kLeftUpperArm, kLeftLowerArm, 0.0},   // biceps, triceps
    {0.400, 1.409, -0.021, 0.037, 0.037, 0.039, 0.040, kLeftUpperArm, kLeftLowerArm, 0.05},
    {0.455, 1.409, -0.022, 0.036, 0.035, 0.036, 0.039, kLeftUpperArm, kLeftLowerArm, 0.5},   // elbow
    {0.510, 1.409, -0.020, 0.038, 0.036, 0.043, 0.039, kLeftUpperArm, kLeftLowerArm, 0.95},  // top of the forearm
    {0.590, 1.408, -0.018, 0.032, 0.031, 0.038, 0.034, kLeftLowerArm, kLeftHand, 0.0},
    {0.650, 1.408, -0.016, 0.0245, 0.0235, 0.031, 0.028, kLeftLowerArm, kLeftHand, 0.08},
    {0.697, 1.408, -0.015, 0.0195, 0.0195, 0.028, 0.027, kLeftLowerArm, kLeftHand, 0.5},    // wrist
    {0.722, 1.408, -0.014, 0.0185, 0.0190, 0.033, 0.032, kLeftLowerArm, kLeftHand, 0.92},   // root of the thumb
    {0.757, 1.408, -0.014, 0.0165, 0.0160, 0.0395, 0.0385, kLeftLowerArm, kLeftHand, 1.0},  // palm
};
constexpr int kThumbRow = 8;   ///< the thumb branches off between this section and the next
constexpr int kThumbSide = 2;  ///< ... on the front

/// Point i of a ring right-handed about +X, from the top.
[[nodiscard]] Vec3 pointOn(const ArmSection& s, int i) {
  const double up = std::cos(kStep * i);
  const double front = std::sin(kStep * i);
  return {s.x, s.y + up * (up > 0.0 ? s.up : s.down), s.z + front * (front > 0.0 ? s.front : s.back)};
}

/// A finger: its last phalanx's length, its radii beyond the web, at both middle joints and at the tip. [m]
struct Finger {
  HumanBone proximal;
  double lastLength;
  double radius[4];
};
constexpr Finger kFingers[4] = {
    {kLeftIndexProximal, 0.023, {0.0096, 0.0088, 0.0079, 0.0060}},
    {kLeftMiddleProximal, 0.024, {0.0098, 0.0090, 0.0081, 0.0062}},
    {kLeftRingProximal, 0.023, {0.0094, 0.0086, 0.0077, 0.0059}},
    {kLeftLittleProximal, 0.020, {0.0084, 0.0076, 0.0068, 0.0052}},
};
constexpr double kWebDistance = 0.027;  ///< from the knuckle to the first free ring

[[nodiscard]] HumanBone nextBone(HumanBone bone, int steps = 1) {
  return static_cast<HumanBone>(static_cast<int>(bone) + steps);
}

/// A square ring of a finger: corners on a circle about `along`.
struct DigitRing {
  Vec3 centre, along;
  double radius;
  BoneWeights weights;
};

/// Extends a ring of four points by others. Corners: (top, -side), (bottom, -side), (bottom, +side), (top, +side).
void addDigit(HalfCage& cage, HalfCage::Ring ring, std::initializer_list<DigitRing> rings) {
  for (const auto& [centre, along, radius, weights] : rings) {
    const Vec3 side = Vec3::UnitY().cross(along).normalized();
    const Vec3 up = along.cross(side).normalized();
    const double r = radius * std::numbers::sqrt2 / 2.0;
    HalfCage::Ring next;
    for (const auto& [u, s] : {std::pair{1.0, -1.0}, {-1.0, -1.0}, {-1.0, 1.0}, {1.0, 1.0}}) {
      next.push_back(cage.addPoint(centre + r * u * up + r * s * side, weights));
    }
    cage.bridge(ring, next);
    ring = next;
  }
  cage.addFace(ring);
}

void addFinger(HalfCage& cage, const HalfCage::Ring& ring, const Finger& finger) {
  const HumanBone bones[3] = {finger.proximal, nextBone(finger.proximal), nextBone(finger.proximal, 2)};
  const Vec3 joints[3] = {mannequinJoint(bones[0]), mannequinJoint(bones[1]), mannequinJoint(bones[2])};
  const Vec3 first = (joints[1] - joints[0]).normalized(), rest = (joints[2] - joints[1]).normalized();
  const double web = finger.proximal == kLeftLittleProximal ? 0.8 * kWebDistance : kWebDistance;
  addDigit(cage, ring,
           {{joints[0] + web * first, first, finger.radius[0], {{bones[0], 1.0}}},
            {joints[1], rest, finger.radius[1], between(bones[0], bones[1], 0.5)},
            {joints[2], rest, finger.radius[2], between(bones[1], bones[2], 0.5)},
            {joints[2] + (finger.lastLength - 0.004) * rest, rest, finger.radius[3], {{bones[2], 1.0}}}});
}

void addThumb(HalfCage& cage, const HalfCage::Ring& ring) {
  const Vec3 mcp = mannequinJoint(kLeftThumbProximal);
  const Vec3 ip = mannequinJoint(kLeftThumbDistal);
  const Vec3 along = (ip - mcp).normalized();
  addDigit(cage, ring,
           {{mcp, along, 0.0140, between(kLeftThumbMetacarpal, kLeftThumbProximal, 0.5)},
            {ip, along, 0.0112, between(kLeftThumbProximal, kLeftThumbDistal, 0.5)},
            {ip + 0.024 * along, along, 0.0080, {{kLeftThumbDistal, 1.0}}}});
}

/// A section of the leg across Y, or of the foot across the curve that leads from the shin to the sole.
struct LegSection {
  double x;
  double yFront, zFront, yBack, zBack;  ///< front and back (of the foot: instep and sole)
  double inner, outer;                  ///< half widths [m]
  double yInner, yOuter;                ///< added to the height of the inner and outer side
  double flat;                          ///< 1 = round; smaller = flatter back (of the foot: sole)
  HumanBone near, far;
  double share;
};

constexpr LegSection kLeg[] = {
    {0.094, 0.795, 0.066, 0.792, -0.100, 0.077, 0.078, -0.008, 0.018, 1.0, kHips, kLeftUpperLeg, 0.86},
    {0.096, 0.710, 0.077, 0.710, -0.086, 0.076, 0.077, 0.0, 0.0, 1.0, kLeftUpperLeg, kLeftLowerLeg, 0.0},
    {0.097, 0.615, 0.074, 0.615, -0.074, 0.067, 0.068, 0.0, 0.0, 1.0, kLeftUpperLeg, kLeftLowerLeg, 0.0},
    {0.098, 0.545, 0.062, 0.545, -0.059, 0.055, 0.055, 0.0, 0.0, 1.0, kLeftUpperLeg, kLeftLowerLeg, 0.1},
    {0.097, 0.490, 0.056, 0.490, -0.049, 0.050, 0.048, 0.0, 0.0, 1.0, kLeftUpperLeg, kLeftLowerLeg, 0.5},
    {0.097, 0.435, 0.046, 0.435, -0.060, 0.048, 0.048, 0.0, 0.0, 1.0, kLeftUpperLeg, kLeftLowerLeg, 0.9},
    {0.098, 0.345, 0.035, 0.345, -0.080, 0.050, 0.051, 0.0, 0.0, 1.0, kLeftLowerLeg, kLeftFoot, 0.0},
    {0.099, 0.235, 0.014, 0.235, -0.072, 0.037, 0.037, 0.0, 0.0, 1.0, kLeftLowerLeg, kLeftFoot, 0.0},
    {0.099, 0.118, 0.004, 0.112, -0.072, 0.030, 0.029, 0.0, 0.0, 1.0, kLeftLowerLeg, kLeftFoot, 0.3},   // ankle
    {0.099, 0.092, 0.022, 0.050, -0.090, 0.034, 0.033, 0.0, 0.0, 0.9, kLeftLowerLeg, kLeftFoot, 0.85},  // heel
    {0.100, 0.076, 0.050, 0.002, -0.070, 0.033, 0.034, 0.0, 0.0, 0.7, kLeftFoot, kLeftToes, 0.0},
    {0.102, 0.060, 0.082, 0.005, 0.005, 0.034, 0.037, 0.0, 0.0, 0.6, kLeftFoot, kLeftToes, 0.0},
    {0.106, 0.041, 0.122, 0.000, 0.090, 0.044, 0.046, 0.0, 0.0, 0.5, kLeftFoot, kLeftToes, 0.5},  // ball
    {0.102, 0.024, 0.160, 0.004, 0.152, 0.037, 0.040, 0.0, 0.0, 0.7, kLeftFoot, kLeftToes, 1.0},
};

/// Point i of a ring right-handed about -Y (then +Z), from the back beside the inner edge; point 9 is the innermost.
[[nodiscard]] Vec3 pointOn(const LegSection& s, int i) {
  const double angle = kStep * (4 - (8 - i));
  const double side = std::cos(angle);
  // The rings have no point exactly at the front or back but two beside each: those are on the given lines.
  double front = std::sin(angle) / std::sin(2.0 * kStep);
  if (front < 0.0) front = -std::pow(-front, s.flat);
  const double y = 0.5 * (s.yFront + s.yBack) + 0.5 * front * (s.yFront - s.yBack);
  const double z = 0.5 * (s.zFront + s.zBack) + 0.5 * front * (s.zFront - s.zBack);
  const double inner = side < 0.0 ? -side : 0.0;
  const double outer = side > 0.0 ? side : 0.0;
  return {s.x + outer * s.outer - inner * s.inner, y + outer * s.yOuter + inner * s.yInner, z};
}

}  // namespace

void addArmAndHand(HalfCage& cage, const HalfCage::Ring& opening) {
  HalfCage::Ring ring = opening;
  HalfCage::Ring thumbFrom;
  int row = 0;
  for (const ArmSection& section : kArm) {
    HalfCage::Ring next;
    for (int i = 0; i < kRing; ++i) {
      BoneWeights weights = between(section.near, section.far, section.share);
      const bool besideThumb = i == kThumbSide || i == kThumbSide + 1;
      if (besideThumb && row == kThumbRow) weights = between(kLeftHand, kLeftThumbMetacarpal, 0.40);
      if (besideThumb && row == kThumbRow + 1) weights = between(kLeftHand, kLeftThumbMetacarpal, 0.50);
      next.push_back(cage.addPoint(pointOn(section, i), weights));
    }
    const bool atThumb = row == kThumbRow + 1;
    cage.bridge(ring, next, atThumb ? kThumbSide : -1);
    if (atThumb) {
      addThumb(cage, {ring[2], ring[3], next[3], next[2]});
    }
    ring = next;
    ++row;
  }

  // The webs: five points on the back of the hand, front to back, and five below them. Fingers share them.
  //
  //   t0  t1  t2  t3  t4        seen from the finger tips; index finger on the left
  //   b0  b1  b2  b3  b4
  const double webX[5] = {0.797, 0.804, 0.806, 0.800, 0.783};
  const double webZ[5] = {0.0270, 0.0065, -0.0135, -0.0335, -0.0525};
  const double webY[5] = {1.4060, 1.4075, 1.4080, 1.4065, 1.4035};
  const double webHalf[5] = {0.0085, 0.0085, 0.0085, 0.0080, 0.0072};
  int top[5];
  int bottom[5];
  for (int i = 0; i < 5; ++i) {
    BoneWeights weights = {{kLeftHand, 0.6}};
    if (i == 0 || i == 4) {
      weights.emplace_back(kFingers[i == 0 ? 0 : 3].proximal, 0.4);
    } else {
      weights.emplace_back(kFingers[i - 1].proximal, 0.2);
      weights.emplace_back(kFingers[i].proximal, 0.2);
    }
    top[i] = cage.addPoint({webX[i], webY[i] + webHalf[i], webZ[i]}, weights);
    bottom[i] = cage.addPoint({webX[i], webY[i] - webHalf[i], webZ[i]}, weights);
  }
  cage.bridge(ring, {top[2], top[1], top[0], bottom[0], bottom[1], bottom[2], bottom[3], bottom[4], top[4], top[3]});
  for (int i = 0; i < 4; ++i) {
    // Right-handed about the finger: top front, bottom front, bottom back, top back.
    addFinger(cage, {top[i], bottom[i], bottom[i + 1], top[i + 1]}, kFingers[i]);
  }
}

void addLegAndFoot(HalfCage& cage, const HalfCage::Ring& opening) {
  HalfCage::Ring ring = opening;
  for (const LegSection& section : kLeg) {
    HalfCage::Ring next;
    for (int i = 0; i < kRing; ++i) {
      Vec3 p = pointOn(section, i);
      // The toes end in an arc, not in a straight edge.
      if (section.share == 1.0) p.z() -= kToeArc * std::pow(std::cos(kStep * (i - 4)), 4.0);
      // The inside of the thigh blends smoothly into the crotch, which follows neither leg.
      const double inward = std::max(0.0, -std::cos(kStep * (i - 4)));
      const double share =
          section.near == kHips ? section.share * (1.0 - kCrotchShare * inward * inward) : section.share;
      next.push_back(cage.addPoint(p, between(section.near, section.far, share)));
    }
    cage.bridge(ring, next);
    ring = next;
  }
  // The tip of the foot: three quads from side to side, a triangle at either end.
  cage.addFace({ring[0], ring[1], ring[7], ring[8]});
  cage.addFace({ring[1], ring[2], ring[6], ring[7]});
  cage.addFace({ring[2], ring[3], ring[5], ring[6]});
  cage.addFace({ring[3], ring[4], ring[5]});
  cage.addFace({ring[8], ring[9], ring[0]});
}

}  // namespace lorica
