#include "capture/synthetic/motion_clips.h"

#include <cmath>
#include <numbers>

namespace lorica::motion {

Performance wave() {
  Performance p;
  p.seed = 22;
  p.duration = 10.0;
  // Rises on the toes for the big wave.
  const Track tiptoe{{5.1, 0.0}, {5.7, degrees(17.0)}, {7.5, degrees(15.0)}, {8.1, 0.0}};
  p.leftFoot = FootPath(standing(kLeft, 0.0, 0.0, 0.0, 0.105), {}, tiptoe);
  p.rightFoot = FootPath(standing(kRight, 0.0, 0.0, 0.0, 0.105), {}, tiptoe);
  p.x = Track{{0.7, 0.0}, {1.5, 0.028}, {4.0, 0.024}, {4.9, -0.005}, {9.2, 0.0}};
  p.z = Track{{5.0, 0.03}, {5.65, 0.095}, {7.5, 0.092}, {8.1, 0.035}};
  p.height = Track{{0.6, 0.913},  {1.4, 0.908}, {4.4, 0.908}, {5.2, 0.893},
                   {5.75, 0.952}, {7.5, 0.948}, {8.1, 0.9},   {8.7, 0.914}};

  const double kBeat = 0.46;
  const auto beats = [kBeat](double from, double to, double amplitude) -> Curve {
    return [=](double t) {
      const double envelope = minimumJerk((t - from) / 0.35) * (1.0 - minimumJerk((t - to + 0.35) / 0.35));
      return amplitude * envelope * std::sin(2.0 * std::numbers::pi * (t - from) / (2.0 * kBeat));
    };
  };
  // One hand: upper arm out to the side, forearm up; the forearm waves.
  const Curve one = beats(1.55, 4.3, degrees(27.0));
  const Curve both = beats(5.75, 7.7, degrees(20.0));
  const Vec3 raised(0.27, 0.27, 0.10);
  const Vec3 raisedPole(0.9, -1.0, -0.2);
  const Vec3 high(0.24, 0.47, 0.06);
  const Vec3 highPole(1.0, -0.2, 0.3);
  const ArmCurve right = armThrough({{0.55, kHang, kHangPole},
                                     {1.5, raised, raisedPole, 0.0, 0.0},
                                     {4.2, raised + Vec3(0.0, 0.01, 0.01), raisedPole},
                                     {5.0, {0.17, -0.46, 0.12}, kHangPole},
                                     {5.75, high, highPole},
                                     {7.55, high, highPole},
                                     {8.55, {0.1, -0.53, 0.07}, kHangPole},
                                     {8.9, kHang, kHangPole}});
  const ArmCurve left = armThrough({{0.5, kHang, kHangPole},
                                    {1.5, {0.075, -0.53, 0.04}, kHangPole},
                                    {4.45, {0.07, -0.532, 0.05}, kHangPole},
                                    {5.05, {0.19, -0.45, 0.13}, kHangPole},
                                    {5.8, high, highPole},
                                    {7.5, high, highPole},
                                    {8.45, {0.12, -0.525, 0.08}, kHangPole},
                                    {8.85, kHang, kHangPole}});
  p.rightArm = [=](double t) {
    // The upper arm gives way slightly and the hand lags behind the forearm.
    ArmPose a = right(t);
    a.elbow += one(t);
    a.swing.z() += both(t) - 0.12 * one(t - 0.05);
    a.twist += 0.5 * one(t - 0.06);
    return a;
  };
  p.leftArm = [=](double t) {
    ArmPose a = left(t);
    a.swing.z() += both(t + 0.02);
    return a;
  };

  p.pelvisRoll = Track{{0.7, 0.0}, {1.6, -0.035}, {4.1, -0.03}, {4.9, 0.0}};
  const Track lean{{0.6, 0.0}, {1.5, -0.06}, {4.2, -0.05}, {5.0, 0.0}};
  p.chestRoll = [=](double t) { return lean(t) + 0.06 * one(t - 0.08); };
  p.chestPitch = Track{{4.5, 0.03}, {5.15, 0.12}, {5.8, -0.05}, {7.5, -0.04}, {8.2, 0.06}, {8.9, 0.03}};
  p.chestTwist = Track{{0.7, 0.0}, {1.6, 0.05}, {4.2, 0.05}, {5.0, 0.0}};
  const Track tilt{{0.9, 0.0}, {1.7, 0.10}, {4.1, 0.08}, {5.0, 0.0}, {6.0, -0.04}, {7.5, 0.03}, {8.6, 0.0}};
  p.headRoll = [=](double t) { return tilt(t) - 0.05 * one(t - 0.1); };
  p.headYaw = Track{{0.2, 0.12}, {0.9, 0.0}, {4.6, 0.0}, {5.2, 0.03}, {8.6, 0.0}, {9.5, -0.06}};
  p.headPitch = Track{{0.2, 0.08}, {0.9, -0.03}, {4.4, -0.02}, {5.1, 0.05}, {5.8, -0.10}, {7.5, -0.08}, {8.6, 0.02}};
  return p;
}

Performance turnAround() {
  Performance p;
  p.seed = 66;
  // Left foot opens, right foot closes, around to the left in steps of about 45 degrees: a full turn, with a look about
  // halfway and a settling step.
  constexpr double kHalfWidth = 0.105;
  const auto around = [=](Side side, double yawDegrees) {
    return standing(side, 0.0, 0.0, degrees(yawDegrees), kHalfWidth);
  };
  std::vector<Step> left, right;
  const auto add = [&](Side side, double lift, double land, double yawDegrees) {
    Step step;
    step.lift = lift;
    step.land = land;
    step.to = around(side, yawDegrees);
    step.apex = 0.045;
    step.offPitch = 0.42;
    step.landPitch = 0.12;
    step.rollTime = 0.2;
    step.settleTime = 0.14;
    (side == kLeft ? left : right).push_back(step);
  };
  add(kLeft, 1.05, 1.43, 52.0);
  add(kRight, 1.62, 2.02, 80.0);
  add(kLeft, 2.2, 2.58, 128.0);
  add(kRight, 2.76, 3.16, 165.0);
  add(kLeft, 3.36, 3.74, 182.0);
  // A pause with the back to the camera, then the rest of the turn.
  add(kLeft, 5.0, 5.38, 235.0);
  add(kRight, 5.56, 5.96, 262.0);
  add(kLeft, 6.13, 6.5, 310.0);
  add(kRight, 6.68, 7.1, 345.0);
  add(kLeft, 7.28, 7.65, 361.0);
  add(kRight, 7.95, 8.3, 360.0);
  p.duration = 9.6;
  p.leftFoot = FootPath(around(kLeft, 0.0), left);
  p.rightFoot = FootPath(around(kRight, 0.0), right);
  p.x = balanceOver(p.leftFoot, p.rightFoot, 0.1, 0.24, 0);
  p.z = balanceOver(p.leftFoot, p.rightFoot, 0.1, 0.24, 2);

  const Track heading{{0.8, 0.0},          {1.45, degrees(27)},  {2.05, degrees(68)},  {2.6, degrees(105)},
                      {3.2, degrees(148)}, {3.85, degrees(177)}, {4.7, degrees(180)},  {5.4, degrees(209)},
                      {6.0, degrees(250)}, {6.55, degrees(287)}, {7.15, degrees(330)}, {7.8, degrees(357)},
                      {8.4, degrees(360)}};
  p.heading = heading;
  // Eyes first, then shoulders, then hips.
  const Track gaze{{0.4, 0.0},           {0.95, degrees(38)}, {1.6, degrees(78)},  {2.3, degrees(125)},
                   {2.9, degrees(165)},  {3.4, degrees(188)}, {3.9, degrees(180)}, {4.5, degrees(178)},
                   {4.95, degrees(222)}, {5.6, degrees(262)}, {6.3, degrees(315)}, {6.85, degrees(352)},
                   {7.4, degrees(362)},  {8.2, degrees(360)}};
  p.headYaw = gaze;
  p.chestTwist = [=](double t) { return 0.35 * (gaze(t - 0.05) - heading(t)); };
  const Track moving{{0.8, 0.0}, {1.4, 1.0}, {3.4, 1.0}, {4.1, 0.0}, {4.7, 0.0}, {5.3, 1.0}, {7.6, 1.0}, {8.5, 0.0}};
  p.headPitch = [=](double t) { return 0.03 + 0.1 * moving(t); };
  p.height = [=](double t) { return 0.913 - 0.022 * moving(t); };
  p.chestPitch = [=](double t) { return 0.03 + 0.05 * moving(t); };
  // Arms swing out with the turn, the leading one more.
  p.leftArm = [=](double t) {
    const double turnRate = heading(t) - heading(t - 0.25);
    ArmPose a = swungArm(degrees(3.0 - 14.0 * turnRate), degrees(8.0 + 9.0 * moving(t - 0.1)) + 0.1 * turnRate,
                         degrees(18.0 + 14.0 * moving(t - 0.15)));
    a.twist = 0.3;
    return a;
  };
  p.rightArm = [=](double t) {
    const double turnRate = heading(t - 0.05) - heading(t - 0.3);
    ArmPose a = swungArm(degrees(3.0 + 30.0 * turnRate), degrees(8.0 + 7.0 * moving(t - 0.1)) + 0.1 * turnRate,
                         degrees(18.0 + 18.0 * moving(t - 0.15)));
    a.twist = 0.3;
    return a;
  };
  return p;
}

}  // namespace lorica::motion
