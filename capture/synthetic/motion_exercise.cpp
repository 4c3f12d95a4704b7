#include "capture/synthetic/motion_clips.h"

#include <cmath>

namespace lorica::motion {

namespace {

constexpr double kGravity = 9.81;

/// Quintics through points with given value, rate and acceleration: continuous in all three.
Curve through(std::vector<std::pair<double, CurvePoint>> points) {
  return [points = std::move(points)](double t) {
    if (t <= points.front().first) return points.front().second.value;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (t > points[i].first) continue;
      const double duration = points[i].first - points[i - 1].first;
      return quintic(points[i - 1].second, points[i].second, duration, (t - points[i - 1].first) / duration);
    }
    return points.back().second.value;
  };
}

/// Height of the centre of mass at which the left leg is stretched to a fraction of its length.
double massHeightAt(Performance p, double time, double stretch) {
  p.heightIsCentreOfMass = false;
  double height = 0.9;
  SkeletonFrame frame;
  for (int i = 0; i < 20; ++i) {
    p.height = Track(height);
    frame = performAt(p, time);
    const Vec3 leg = frame[BodyJoint::kLeftHip].position - p.leftFoot.at(time).ankle;
    const double flatSq = leg.x() * leg.x() + leg.z() * leg.z();
    height += std::sqrt(stretch * stretch * kLeg * kLeg - flatSq) - leg.y();
  }
  return centreOfMass(frame).y();
}

}  // namespace

Performance jumpingJacks() {
  Performance p;
  p.seed = 33;
  p.liveliness = 0.6;
  constexpr int kJumps = 14;
  constexpr double kFirst = 1.25;
  constexpr double kFlight = 0.255;
  constexpr double kContact = 0.275;
  const auto takeoff = [&](int jump) { return kFirst + jump * (kFlight + kContact); };

  std::vector<Step> left, right;
  std::vector<TrackKey> arms{{0.5, -0.12}, {1.1, 0.0}};  // 0 hangs, 1 is overhead
  std::vector<TrackKey> elbows{{0.6, degrees(16.0)}, {1.1, degrees(32.0)}};
  std::vector<TrackKey> wide{{takeoff(0), 0.0}};
  RandomNumbers random(34);
  for (int jump = 0; jump < kJumps; ++jump) {
    const bool out = jump % 2 == 0;
    for (const Side side : {kLeft, kRight}) {
      Step step;
      step.lift = takeoff(jump);
      step.land = takeoff(jump) + kFlight;
      const double halfWidth = (out ? 0.33 : 0.095) + random.between(-0.012, 0.012);
      step.to = standing(side, 0.0, random.between(-0.012, 0.012), 0.0, halfWidth);
      step.apex = 0.035;
      step.offPitch = 0.55;
      step.landPitch = 0.42;
      step.rollTime = 0.14;
      step.settleTime = 0.11;
      (side == kLeft ? left : right).push_back(step);
    }
    const double land = takeoff(jump) + kFlight;
    arms.push_back({land + 0.05, out ? random.between(0.94, 1.0) : random.between(0.0, 0.04)});
    elbows.push_back({land - 0.12, degrees(out ? 24.0 : 30.0)});
    elbows.push_back({land + 0.08, degrees(out ? 14.0 : 18.0)});
    wide.push_back({land + 0.08, out ? 1.0 : 0.0});
  }
  const double landed = takeoff(kJumps - 1) + kFlight;
  arms.push_back({landed + 0.6, -0.12});
  p.duration = std::ceil(landed + 1.5);
  p.leftFoot = FootPath(standing(kLeft), left);
  p.rightFoot = FootPath(standing(kRight), right);
  const Track widthTrack(wide);
  p.kneesOut = [=](double t) { return 0.08 + 0.12 * widthTrack(t); };

  // From hanging through horizontal to overhead the upper arms roll outward, so that the hands meet above the head.
  const ArmPose hang = reach(kHang, kHangPole);
  const ArmPose low = reach({0.16, -0.51, 0.06}, kHangPole);
  const ArmPose level = reach({0.52, 0.10, 0.10}, {0.3, -1.0, -0.9});
  const ArmPose high = reach({-0.07, 0.53, 0.09}, {1.0, 0.0, -0.3});
  std::array<Track, 3> swing;
  for (int axis = 0; axis < 3; ++axis) {
    swing[axis] =
        Track{{-0.12, hang.swing[axis]}, {0.0, low.swing[axis]}, {0.5, level.swing[axis]}, {1.0, high.swing[axis]}};
  }
  const Track raise(arms);
  const Track fold(elbows);
  const auto arm = [=](double lag) -> ArmCurve {
    return [=](double t) {
      ArmPose a;
      const double up = raise(t - lag);
      a.swing = Vec3(swing[0](up), swing[1](up), swing[2](up));
      a.elbow = fold(t - lag);
      a.twist = 0.2;
      a.bend = 0.8 * (raise(t - lag - 0.05) - up);  // the hands lag behind
      return a;
    };
  };
  p.leftArm = arm(0.0);
  p.rightArm = arm(0.012);

  // Crouch in the stance between flights, upright in the air.
  std::vector<TrackKey> bend{{0.55, 0.0}, {0.98, 1.0}, {takeoff(0) + 0.04, 0.1}};
  for (int jump = 0; jump < kJumps; ++jump) {
    bend.push_back({takeoff(jump) + kFlight + 0.45 * kContact, 0.55});
    if (jump + 1 < kJumps) bend.push_back({takeoff(jump + 1) + 0.05, 0.08});
  }
  bend.push_back({landed + 0.75, 0.0});
  const Track crouch(bend);
  p.pelvisPitch = [=](double t) { return 0.16 * crouch(t); };
  p.chestPitch = [=](double t) { return 0.02 + 0.13 * crouch(t - 0.02); };
  p.headPitch = [=](double t) { return 0.02 + 0.06 * crouch(t - 0.04); };
  p.z = Track{{0.5, 0.028}, {0.95, 0.06}, {landed, 0.06}, {landed + 0.8, 0.03}};

  // The centre of mass moves in parabolas during flights; each stance joins one to the next without a jump in force.
  p.heightIsCentreOfMass = true;
  const double stand = massHeightAt(p, 0.0, 0.994);
  std::vector<std::pair<double, CurvePoint>> height{{0.5, {stand, 0.0, 0.0}}, {0.95, {stand - 0.11, 0.0, 5.0}}};
  for (int jump = 0; jump < kJumps; ++jump) {
    const double up = takeoff(jump);
    const double down = up + kFlight;
    const double from = massHeightAt(p, up, 0.985);
    const double to = massHeightAt(p, down, 0.975);
    const double rate = (to - from) / kFlight + 0.5 * kGravity * kFlight;
    height.push_back({up, {from, rate, -kGravity}});
    height.push_back({down, {to, rate - kGravity * kFlight, -kGravity}});
  }
  height.push_back({landed + 0.2, {stand - 0.1, 0.0, 5.0}});
  height.push_back({landed + 0.75, {stand, 0.0, 0.0}});
  p.height = through(height);
  return p;
}

Performance squatAndReach() {
  Performance p;
  p.seed = 44;
  p.duration = 15.0;
  const double half = 0.165;
  const Track tiptoe{{6.7, 0.0}, {7.3, degrees(24.0)}, {8.3, degrees(22.0)}, {8.9, 0.0}};
  p.leftFoot = FootPath(standing(kLeft, 0.0, 0.0, 0.0, half), {}, tiptoe);
  p.rightFoot = FootPath(standing(kRight, 0.0, 0.0, 0.0, half), {}, tiptoe);
  p.kneesOut =
      Track{{0.6, 0.08}, {1.9, 0.32}, {2.6, 0.32}, {3.5, 0.08}, {4.0, 0.08}, {5.2, 0.34}, {5.7, 0.34}, {6.7, 0.06}};
  //                 down and up          floor and up            tiptoe                  sides
  p.height = Track{{0.6, 0.908}, {1.95, 0.5}, {2.5, 0.5},    {3.5, 0.905}, {4.0, 0.905},  {5.2, 0.53},
                   {5.65, 0.54}, {6.7, 0.90}, {7.35, 0.975}, {8.25, 0.97}, {8.95, 0.902}, {14.0, 0.908}};
  p.pelvisPitch = Track{{0.6, 0.0},  {1.9, 0.34}, {2.5, 0.34},  {3.4, 0.0},   {4.0, 0.0}, {5.15, 0.72},
                        {5.6, 0.72}, {6.6, 0.02}, {7.3, -0.06}, {8.3, -0.05}, {9.0, 0.0}};
  p.chestPitch = Track{{0.6, 0.03}, {1.9, 0.28}, {2.5, 0.28},   {3.5, 0.02},   {4.0, 0.03}, {5.2, 0.62},
                       {5.7, 0.6},  {6.7, 0.05}, {7.35, -0.14}, {8.25, -0.13}, {9.0, 0.03}};
  p.x = Track{{8.8, 0.0}, {9.7, -0.045}, {10.2, -0.045}, {11.5, 0.045}, {12.0, 0.045}, {13.0, 0.0}};
  p.z = Track{{6.4, 0.032}, {7.05, 0.10}, {8.5, 0.098}, {9.15, 0.035}};
  p.pelvisRoll = Track{{8.8, 0.0}, {9.7, -0.10}, {10.2, -0.10}, {11.5, 0.10}, {12.0, 0.10}, {13.0, 0.0}};
  p.chestRoll = Track{{8.8, 0.0}, {9.75, -0.42}, {10.2, -0.42}, {11.55, 0.40}, {12.0, 0.40}, {13.1, 0.0}};
  p.chestTwist = Track{{3.9, 0.0},  {5.2, 0.10},   {6.5, 0.0},   {8.8, 0.0}, {9.75, 0.1},
                       {10.2, 0.1}, {11.55, -0.1}, {12.0, -0.1}, {13.0, 0.0}};
  p.headPitch = Track{{0.7, 0.0},   {1.9, 0.12},  {2.5, 0.12},    {3.4, 0.0},   {3.9, 0.1},  {5.0, 0.85},
                      {5.5, 0.85},  {6.6, -0.05}, {7.3, -0.55},   {8.2, -0.5},  {9.0, 0.0},  {9.7, -0.12},
                      {10.2, -0.1}, {10.9, 0.05}, {11.55, -0.12}, {12.0, -0.1}, {13.0, 0.03}};
  p.headRoll = Track{{8.8, 0.0}, {9.75, -0.32}, {10.2, -0.32}, {11.55, 0.32}, {12.0, 0.32}, {13.0, 0.0}};
  p.headYaw = Track{{8.8, 0.0}, {9.7, 0.2}, {10.2, 0.2}, {11.5, -0.2}, {12.0, -0.2}, {13.0, 0.0}};

  const Vec3 ahead(-0.02, 0.04, 0.53);  // at shoulder height, leaning forward
  const Vec3 aheadPole(0.6, -1.0, 0.0);
  const Vec3 floor(-0.10, 0.15, 0.50);
  const Vec3 up(-0.03, 0.53, 0.10);
  const Vec3 upPole(0.9, 0.0, 0.45);
  const auto arm = [&](Side side) {
    const double lag = side == kLeft ? 0.0 : 0.04;
    std::vector<ArmKey> keys{
        {0.55 + lag, kHang, kHangPole, 0.1},
        {1.85 + lag, ahead + Vec3(0.0, 0.12, -0.02), aheadPole, 0.7},
        {2.5 + lag, ahead + Vec3(0.0, 0.12, -0.02), aheadPole, 0.7},
        {3.4 + lag, kHang, kHangPole, 0.1},
        {4.05 + lag, kHang, kHangPole, 0.1},
        {4.5 + lag, {-0.04, -0.05, 0.46}, {0.7, -0.8, 0.1}, 0.2},
        {5.15 + lag, floor, aheadPole, 0.3},
        {5.65 + lag, floor, aheadPole, 0.3},
        {6.45 + lag, {-0.06, -0.05, 0.36}, aheadPole, 0.0},
        {7.35 + lag, up, upPole, 0.0},
        {8.25 + lag, up, upPole, 0.0},
        {9.0 + lag, side == kLeft ? Vec3(0.33, 0.1, 0.3) : Vec3(0.3, 0.25, 0.3), {0.5, -1.0, -0.2}, 0.2}};
    const ArmKey over{0.0, {-0.13, 0.50, 0.08}, {1.0, 0.3, 0.2}, 0.0};
    const ArmKey along{0.0, {0.24, -0.475, 0.06}, kHangPole, 0.1};
    const ArmKey between{0.0, {0.42, -0.08, 0.28}, {0.2, -1.0, -0.3}, 0.2};
    const auto at = [&](double time, ArmKey key) {
      key.time = time + lag;
      keys.push_back(key);
    };
    // When leaning left the right arm goes over the head; then vice versa.
    at(9.8, side == kLeft ? along : over);
    at(10.2, side == kLeft ? along : over);
    at(10.85, between);
    at(11.6, side == kLeft ? over : along);
    at(12.0, side == kLeft ? over : along);
    if (side == kLeft) at(12.7, between);
    at(13.5, {0.0, kHang, kHangPole, 0.1});
    return armThrough(keys);
  };
  p.leftArm = arm(kLeft);
  p.rightArm = arm(kRight);
  return p;
}

}  // namespace lorica::motion
