#include "tests/bench/generators/motion_clips.h"

#include <cmath>
#include <numbers>

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
      const double halfWidth = (out ? 0.33 : 0.095) + random.between(-0.012, 0.012);
      const Placement to = standing(side, 0.0, random.between(-0.012, 0.012), 0.0, halfWidth);
      // Rise, pitch at lift and at landing, roll time, settle time: see Step.
      (side == kLeft ? left : right)
          .push_back({takeoff(jump), takeoff(jump) + kFlight, to, 0.035, 0.55, 0.42, 0.14, 0.11});
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
  struct Turn {
    double lift, land, yawDegrees;
  };
  const auto steps = [&](Side side, std::initializer_list<Turn> turns) {
    std::vector<Step> all;
    for (const Turn& turn : turns) {
      // Rise, pitch at lift and at landing, roll time, settle time: see Step.
      all.push_back({turn.lift, turn.land, around(side, turn.yawDegrees), 0.045, 0.42, 0.12, 0.2, 0.14});
    }
    return FootPath(around(side, 0.0), std::move(all));
  };
  // A pause with the back to the camera from 3.74 to 5 s, then the rest of the turn.
  p.duration = 9.6;
  p.leftFoot = steps(kLeft, {{1.05, 1.43, 52.0},
                             {2.2, 2.58, 128.0},
                             {3.36, 3.74, 182.0},
                             {5.0, 5.38, 235.0},
                             {6.13, 6.5, 310.0},
                             {7.28, 7.65, 361.0}});
  p.rightFoot = steps(
      kRight, {{1.62, 2.02, 80.0}, {2.76, 3.16, 165.0}, {5.56, 5.96, 262.0}, {6.68, 7.1, 345.0}, {7.95, 8.3, 360.0}});
  p.x = balanceOver(p.leftFoot, p.rightFoot, 0.1, 0.24, 0);
  p.z = balanceOver(p.leftFoot, p.rightFoot, 0.1, 0.24, 2);

  const Track heading = inDegrees({{0.8, 0.0},
                                   {1.45, 27},
                                   {2.05, 68},
                                   {2.6, 105},
                                   {3.2, 148},
                                   {3.85, 177},
                                   {4.7, 180},
                                   {5.4, 209},
                                   {6.0, 250},
                                   {6.55, 287},
                                   {7.15, 330},
                                   {7.8, 357},
                                   {8.4, 360}});
  p.heading = heading;
  // Eyes first, then shoulders, then hips.
  const Track gaze = inDegrees({{0.4, 0.0},
                                {0.95, 38},
                                {1.6, 78},
                                {2.3, 125},
                                {2.9, 165},
                                {3.4, 188},
                                {3.9, 180},
                                {4.5, 178},
                                {4.95, 222},
                                {5.6, 262},
                                {6.3, 315},
                                {6.85, 352},
                                {7.4, 362},
                                {8.2, 360}});
  p.headYaw = gaze;
  p.chestTwist = [=](double t) { return 0.35 * (gaze(t - 0.05) - heading(t)); };
  const Track moving{{0.8, 0.0}, {1.4, 1.0}, {3.4, 1.0}, {4.1, 0.0}, {4.7, 0.0}, {5.3, 1.0}, {7.6, 1.0}, {8.5, 0.0}};
  p.headPitch = [=](double t) { return 0.03 + 0.1 * moving(t); };
  p.height = [=](double t) { return 0.913 - 0.022 * moving(t); };
  p.chestPitch = [=](double t) { return 0.03 + 0.05 * moving(t); };
  // Arms swing out with the turn, the leading one more.
  const auto arm = [=](double lag, double before, double forward, double out, double fold) -> ArmCurve {
    return [=](double t) {
      const double turnRate = heading(t - lag) - heading(t - before);
      ArmPose a = swungArm(degrees(3.0 + forward * turnRate), degrees(8.0 + out * moving(t - 0.1)) + 0.1 * turnRate,
                           degrees(18.0 + fold * moving(t - 0.15)));
      a.twist = 0.3;
      return a;
    };
  };
  p.leftArm = arm(0.0, 0.25, -14.0, 9.0, 14.0);
  p.rightArm = arm(0.05, 0.3, 30.0, 7.0, 18.0);
  return p;
}

}  // namespace lorica::motion
