#include "tests/bench/generators/motion_clips.h"

#include <cmath>
#include <numbers>

namespace lorica::motion {

namespace {

/// A fist towards the camera side, in the arm coordinates of a rotated chest.
/// @param chestYaw  of the chest in the world
/// @param aim       angle from straight ahead towards the person's left [rad]
Vec3 fistAhead(Side side, double chestYaw, double distance, double up, double aim = 0.0) {
  const Vec3 direction = turned(aim - chestYaw, 0.0, 0.0) * Vec3::UnitZ();
  return {(side == kLeft ? 1.0 : -1.0) * distance * direction.x(), up, distance * direction.z()};
}

}  // namespace

Performance punchAndKick() {
  Performance p;
  p.seed = 55;
  p.duration = 14.0;
  p.liveliness = 1.2;

  // Guard: left foot ahead, right foot behind and turned out.
  const Placement leftStart = standing(kLeft);
  const Placement rightStart = standing(kRight);
  const Placement leftGuard{0.10, 0.17, degrees(3.0)};
  const Placement rightGuard{-0.14, -0.21, degrees(-42.0)};
  const Placement leftPivot{0.09, 0.16, degrees(32.0)};  // turned out, as the standing foot of the front kick
  const Placement leftRound{0.07, 0.14, degrees(58.0)};  // turned farther, for the roundhouse

  const auto shuffle = [](double lift, double land, Placement to, double off = 0.35) {
    // Rise, pitch at lift and at landing, roll time, settle time: see Step.
    return Step{lift, land, to, 0.03, off, 0.08, 0.15, 0.1};
  };
  Step frontKick = shuffle(6.12, 7.2, rightGuard, 0.6);
  frontKick.landPitch = 0.25;
  frontKick.via = {{6.42, {-0.05, 0.56, 0.42}, 0.0, 1.0, 0.25},
                   {6.62, {0.03, 1.02, 0.98}, 0.0, 1.0, 0.45},
                   {6.82, {-0.05, 0.58, 0.40}, 0.0, 1.0, 0.25}};
  Step roundKick = shuffle(9.95, 11.1, rightGuard, 0.6);
  roundKick.landPitch = 0.25;
  roundKick.via = {{10.28, {-0.36, 0.72, 0.26}, 0.0, 1.0, 0.4},
                   {10.5, {-0.02, 1.0, 0.94}, 0.0, 1.0, 0.75},
                   {10.74, {-0.34, 0.70, 0.30}, 0.0, 1.0, 0.4}};
  p.leftFoot = FootPath(
      leftStart, {shuffle(0.95, 1.25, leftGuard), shuffle(5.5, 5.75, leftPivot), shuffle(7.6, 7.88, leftGuard),
                  shuffle(9.3, 9.58, leftRound), shuffle(11.4, 11.7, leftGuard), shuffle(12.25, 12.6, leftStart)});
  const Track rearHeel = inDegrees({{1.75, 0},
                                    {2.1, 12},
                                    {2.9, 12},
                                    {3.1, 30},
                                    {3.4, 12},
                                    {4.5, 10},
                                    {4.75, 30},
                                    {5.1, 12},
                                    {5.5, 0},
                                    {7.5, 0},
                                    {7.9, 12},
                                    {8.5, 12},
                                    {8.72, 30},
                                    {9.05, 12},
                                    {9.5, 0}});
  p.rightFoot = FootPath(
      rightStart, {shuffle(1.3, 1.65, rightGuard), frontKick, roundKick, shuffle(12.75, 13.1, rightStart)}, rearHeel);
  const Curve balanceX = balanceOver(p.leftFoot, p.rightFoot, 0.12, 0.2, 0);
  const Curve balanceZ = balanceOver(p.leftFoot, p.rightFoot, 0.12, 0.2, 2);
  // Weight shifts into the punches.
  const Track shiftZ{{2.0, 0.0},   {2.3, 0.05}, {2.55, 0.02}, {2.78, 0.05}, {3.12, 0.09}, {3.5, 0.0},  {3.95, -0.02},
                     {4.25, 0.04}, {4.7, 0.08}, {5.2, 0.0},   {8.05, 0.0},  {8.35, 0.05}, {8.7, 0.09}, {9.1, 0.0}};
  p.x = balanceX;
  p.z = [=](double t) { return balanceZ(t) + shiftZ(t); };
  const Track ready{{0.8, 0.0}, {1.8, 1.0}, {12.1, 1.0}, {13.2, 0.0}};
  const Track low{{0.8, 0.912}, {1.8, 0.865},  {2.2, 0.855},  {2.5, 0.868},   {2.75, 0.856}, {3.1, 0.85},
                  {3.5, 0.868}, {3.95, 0.85},  {4.25, 0.858}, {4.7, 0.85},    {5.3, 0.87},   {6.2, 0.885},
                  {6.62, 0.9},  {7.1, 0.87},   {7.4, 0.85},   {7.9, 0.866},   {8.3, 0.855},  {8.7, 0.85},
                  {9.2, 0.868}, {10.1, 0.885}, {10.5, 0.9},   {11.05, 0.865}, {11.3, 0.85},  {11.8, 0.866},
                  {12.3, 0.88}, {13.3, 0.912}};
  // The small bounce of a person on the balls of the feet.
  p.height = [=](double t) { return low(t) + 0.005 * ready(t) * std::sin(2.0 * std::numbers::pi * 1.9 * t); };

  // Yaw of the hips [degrees]: guard -28; a jab turns them right, a cross left, a hook sharply right.
  p.heading =
      inDegrees({{0.9, 0},   {1.7, -28},  {2.05, -26}, {2.28, -36}, {2.55, -27}, {2.78, -36}, {3.12, 12}, {3.5, -26},
                 {3.88, -8}, {4.2, -52},  {4.42, -44}, {4.72, 12},  {5.2, -26},  {5.7, -24},  {6.3, -2},  {6.62, 14},
                 {6.9, 0},   {7.3, -28},  {8.05, -26}, {8.32, -36}, {8.7, 12},   {9.15, -24}, {9.7, -22}, {10.2, 30},
                 {10.5, 68}, {10.78, 45}, {11.2, -22}, {11.8, -27}, {12.3, -22}, {13.2, 0}});
  p.chestTwist = inDegrees({{0.9, 0},     {1.7, -8},  {2.05, -6},  {2.3, -22},  {2.55, -8}, {2.8, -22}, {3.15, 18},
                            {3.55, -8},   {3.92, 10}, {4.22, -12}, {4.45, -14}, {4.76, 18}, {5.25, -8}, {6.2, -8},
                            {6.64, -16},  {7.3, -8},  {8.05, -6},  {8.35, -22}, {8.74, 18}, {9.2, -8},  {10.1, -14},
                            {10.52, -34}, {11.2, -8}, {12.2, -8},  {13.2, 0}});
  p.pelvisPitch = Track{{0.9, 0.0},  {1.8, 0.10}, {6.0, 0.10},   {6.35, -0.10}, {6.62, -0.26}, {6.9, -0.08},
                        {7.3, 0.10}, {9.8, 0.10}, {10.5, -0.02}, {11.1, 0.10},  {12.2, 0.08},  {13.2, 0.0}};
  p.pelvisRoll = Track{{9.8, 0.0}, {10.25, -0.28}, {10.5, -0.46}, {10.78, -0.28}, {11.15, 0.0}};
  p.chestPitch =
      Track{{0.9, 0.03}, {1.8, 0.16}, {6.1, 0.16}, {6.4, 0.20}, {6.62, 0.24}, {7.2, 0.16}, {12.2, 0.14}, {13.3, 0.03}};
  p.chestRoll = Track{{3.6, 0.0}, {3.92, -0.10}, {4.22, 0.06}, {4.7, 0.0}, {9.8, 0.0}, {10.5, 0.12}, {11.2, 0.0}};
  p.headPitch = Track{{0.9, 0.0}, {1.8, 0.16}, {12.2, 0.14}, {13.3, 0.02}};
  const Track look{{1.0, 0.0}, {1.8, -4}, {3.12, 2}, {4.2, -8}, {4.8, 3}, {6.6, 0}, {10.5, 8}, {11.2, -4}, {13.3, 0}};
  p.headYaw = [=](double t) { return degrees(look(t)); };
  p.headRoll = Track{{3.7, 0.0}, {3.92, -0.05}, {4.3, 0.05}, {4.9, 0.0}, {10.0, 0.0}, {10.5, -0.14}, {11.1, 0.0}};
  p.kneesOut = Track{{0.9, 0.08}, {1.8, 0.12}, {12.0, 0.12}, {13.2, 0.08}};

  const Vec3 lead(-0.045, 0.05, 0.265);
  const Vec3 rear(-0.055, 0.055, 0.225);
  const Vec3 guardPole(0.45, -1.0, -0.1);
  const Vec3 punchPole(0.5, -0.9, -0.2);
  const double flat = degrees(75.0);
  const Vec3 jab = fistAhead(kLeft, degrees(-58.0), 0.535, 0.045, degrees(-6.0));
  const Vec3 cross = fistAhead(kRight, degrees(30.0), 0.535, 0.03, degrees(6.0));
  const ArmKey guardL{0.0, lead, guardPole, 0.25, 0.0};
  const ArmKey guardR{0.0, rear, guardPole, 0.25, 0.0};
  using Moments = std::vector<std::pair<double, const ArmKey*>>;
  const auto through = [](const Moments& moments) {
    std::vector<ArmKey> keys;
    for (const auto& [time, key] : moments) {
      keys.push_back(*key);
      keys.back().time = time;
    }
    return armThrough(keys);
  };
  const ArmKey hang{0.0, kHang, kHangPole, 0.1};
  const ArmKey jabL{0.0, jab, punchPole, flat, 0.0};
  const ArmKey crossR{0.0, cross, punchPole, flat, 0.0};
  const ArmKey hookBack{0.0, {0.15, -0.06, 0.25}, {0.8, -0.75, -0.2}, 0.4, 0.0};
  const ArmKey hookHit{0.0, {-0.04, 0.05, 0.37}, {1.0, 0.12, 0.1}, 0.6, 0.15};
  const ArmKey lowL{0.0, {0.05, -0.05, 0.26}, guardPole, 0.25};
  const ArmKey highL{0.0, {0.0, 0.02, 0.25}, guardPole, 0.25};
  const ArmKey armDown{0.0, {0.12, -0.36, 0.10}, {0.5, -0.2, -1.0}, 0.3, 0.0};
  const Moments left{{0.75, &hang},   {1.65, &guardL}, {2.04, &guardL}, {2.28, &jabL},     {2.54, &guardL},
                     {2.78, &jabL},   {3.06, &guardL}, {3.62, &guardL}, {3.92, &hookBack}, {4.2, &hookHit},
                     {4.52, &guardL}, {6.2, &guardL},  {6.62, &lowL},   {7.2, &guardL},    {8.06, &guardL},
                     {8.31, &jabL},   {8.6, &guardL},  {10.0, &guardL}, {10.5, &highL},    {11.1, &guardL},
                     {12.2, &guardL}, {13.35, &hang}};
  p.leftArm = through(left);
  const Moments right{{0.8, &hang},     {1.75, &guardR}, {2.84, &guardR},  {3.12, &crossR}, {3.44, &guardR},
                      {4.44, &guardR},  {4.72, &crossR}, {5.06, &guardR},  {6.15, &guardR}, {6.6, &armDown},
                      {7.15, &guardR},  {8.42, &guardR}, {8.7, &crossR},   {9.04, &guardR}, {9.95, &guardR},
                      {10.5, &armDown}, {11.1, &guardR}, {12.25, &guardR}, {13.45, &hang}};
  p.rightArm = through(right);
  return p;
}

}  // namespace lorica::motion
