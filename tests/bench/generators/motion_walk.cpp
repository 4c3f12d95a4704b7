#include "geometry/counts.h"
#include "tests/bench/generators/motion_clips.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica::motion {

namespace {

constexpr double kPi = std::numbers::pi;

/// A loop parametrised by arc length s [m]: straight ahead, a left turn through half a circle, straight back, another
/// turn, and ahead to the start. Curvature rises and falls smoothly in a turn.
class Loop {
 public:
  static constexpr double kHalfStraight = 0.75;
  static constexpr double kTurn = 3.3;
  static constexpr double kLength = 4.0 * kHalfStraight + 2.0 * kTurn;

  Loop() {
    // Integrated once, in fine steps; then the loop is centred on the origin.
    Vec3 at = Vec3::Zero();
    double farthest = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      points_.push_back(at);
      farthest = std::max(farthest, at.x());
      const double middle = heading((i + 0.5) * kStep);
      at += kStep * Vec3(std::sin(middle), 0.0, std::cos(middle));
    }
    for (Vec3& p : points_) p.x() -= 0.5 * farthest;
  }

  static double heading(double s) {
    const auto turn = [](double u) {
      u = std::clamp(u, 0.0, 1.0);
      return kPi * u - 0.5 * std::sin(2.0 * kPi * u);
    };
    return turn((s - kHalfStraight) / kTurn) + turn((s - 3.0 * kHalfStraight - kTurn) / kTurn);
  }

  static double curvature(double s) { return (heading(s + 1e-3) - heading(s - 1e-3)) / 2e-3; }

  [[nodiscard]] Vec3 at(double s) const {
    const double position = std::clamp(s, 0.0, kLength) / kStep;
    const auto i = std::min(static_cast<std::size_t>(position), points_.size() - 2);
    const double share = position - i;
    return (1.0 - share) * points_[i] + share * points_[i + 1];
  }

 private:
  static constexpr int kSteps = 8000;
  static constexpr double kStep = kLength / kSteps;
  std::vector<Vec3> points_;
};

/// Distance walked over time: stands, speeds up, slows in the turns, stops. Tabulated and interpolated smoothly.
struct Pace {
  static constexpr double kStart = 0.9;
  static constexpr double kTick = 1.0 / 240.0;
  std::vector<double> distance;

  Pace() {
    double s = 0.0;
    while (s < Loop::kLength - 1e-3) {
      distance.push_back(s);
      const double turning = std::abs(Loop::curvature(s));
      const double cruise = 1.22 - 0.13 * turning;
      // Speed as a function of the distance walked: smooth, and never quite zero until the end.
      const double goneBy = s + 0.004;
      const double left = Loop::kLength - s;
      const double begin = std::min(1.0, std::sqrt(goneBy / 0.55));
      const double end = std::min(1.0, std::sqrt(left / 0.6));
      const double envelope = begin * (2.0 - begin) * end * (2.0 - end);
      s += kTick * std::max(0.03, cruise * envelope);
    }
    distance.push_back(Loop::kLength);
    smooth();
  }

  /// Averages over a quarter second, so that acceleration has no jumps.
  void smooth() {
    const int reach = 36;
    std::vector<double> soft(distance.size() + 2 * reach);
    for (int i = 0; i < countOf(soft); ++i) {
      double sum = 0.0;
      double weights = 0.0;
      for (int k = -reach; k <= reach; ++k) {
        const int j = std::clamp(i - reach + k, 0, countOf(distance) - 1);
        const double weight = 1.0 + std::cos(kPi * k / (reach + 1));
        sum += weight * distance[j];
        weights += weight;
      }
      soft[i] = sum / weights;
    }
    distance = std::move(soft);
  }

  [[nodiscard]] double operator()(double time) const {
    const double position = (time - kStart) / kTick;
    if (position <= 0.0) return 0.0;
    const std::size_t i = position;
    if (i + 1 >= distance.size()) return distance.back();
    const double share = position - i;
    return (1.0 - share) * distance[i] + share * distance[i + 1];
  }
  [[nodiscard]] double speed(double time) const { return ((*this)(time + 0.02) - (*this)(time - 0.02)) / 0.04; }
  /// The first time at which s is reached.
  [[nodiscard]] double when(double s) const {
    const auto at = std::lower_bound(distance.begin(), distance.end(), s);
    return kStart + kTick * (at - distance.begin());
  }
  [[nodiscard]] double end() const { return kStart + kTick * distance.size(); }
};

/// Footfalls along the loop, alternating right and left, and the gait phase: equals k when the body passes over
/// footfall k.
struct Gait {
  FootPath left, right;
  Track phase;
  double end = 0.0;
};

Gait planGait(const Loop& loop, const Pace& pace) {
  constexpr double kStride = 0.6;
  const int count = std::lround(Loop::kLength / kStride);
  // Footfall k is at distance k * stride; one more brings the feet side by side.
  struct Fall {
    double s, land, lift;
  };
  std::vector<Fall> falls;
  const double stride = Loop::kLength / count;
  for (int k = 0; k <= count + 1; ++k) {
    const double s = std::min(k * stride, Loop::kLength);
    // The last long stance ends early, before the decelerating body leaves the foot too far behind.
    const double lift = k == count - 1 ? s + 0.37 : s + 0.45;
    falls.push_back({s, pace.when(s - 0.29), pace.when(std::min(lift, Loop::kLength - 0.03))});
  }
  // From standing, the right foot moves first and the weight is already over the left one.
  const double first = pace.when(0.02);
  falls[1].land = std::max(falls[1].land, first + 0.42);
  falls[0].lift = std::max(falls[0].lift, falls[1].land + 0.1);
  for (int k = 2; k <= count + 1; ++k) {
    auto& fall = falls[k];
    const double lift = falls[k - 2].lift;
    fall.land = std::max({fall.land, falls[k - 1].land + 0.3, k == 2 ? falls[0].lift + 0.36 : 0.0});
    if (k >= 3) fall.land = std::max(fall.land, lift + 0.36);
    auto& before = falls[k - 1];
    before.lift = std::max(before.lift, fall.land + 0.09);
  }

  Gait gait;
  const Vec3 begin = loop.at(0.0);
  const std::array<Placement, 2> start{standing(kLeft, begin.x(), begin.z()), standing(kRight, begin.x(), begin.z())};
  std::array<std::vector<Step>, 2> steps;
  std::vector<TrackKey> phase{{first - 0.25, 0.0}};
  for (int k = 1; k <= count + 1; ++k) {
    const Side side = k % 2 == 1 ? kRight : kLeft;
    const Fall& fall = falls[k];
    const bool closing = k == count + 1;
    Step step;
    step.lift = k == 1 ? first : falls[k - 2].lift;
    step.land = fall.land;
    const Vec3 at = loop.at(fall.s);
    const bool lastTwo = k >= count;
    step.to = standing(side, at.x(), at.z(), Loop::heading(fall.s), lastTwo ? 0.09 : 0.068);
    const double swing = pace.speed(0.5 * (step.lift + step.land)) / 1.2;
    step.apex = closing ? 0.05 : 0.03;
    step.offPitch = k == 1 ? 0.45 : closing ? 0.4 : 0.62 * std::clamp(swing, 0.6, 1.0) + 0.12;
    step.landPitch = closing ? -0.03 : -0.33 * std::clamp(swing, 0.5, 1.0);
    step.rollTime = k == 1 ? 0.25 : 0.3;
    step.settleTime = 0.11;
    if (k >= 2 && !closing) {
      // In a turn the foot follows the curve; on a straight line it would brush the other leg.
      const double middle = falls[k - 1].s;
      const Vec3 onCurve = loop.at(middle);
      const Placement aside = standing(side, onCurve.x(), onCurve.z(), Loop::heading(middle), 0.075);
      const Placement from = steps[side].empty() ? start[side] : steps[side].back().to;
      step.bow = 0.9 * Vec3(aside.x - 0.5 * (from.x + step.to.x), 0.0, aside.z - 0.5 * (from.z + step.to.z));
    }
    steps[side].push_back(step);
    phase.push_back({step.land, k - 0.5});
  }
  gait.end = falls.back().land;
  phase.push_back({gait.end + 0.45, count + 1.0});
  gait.left = FootPath(start[kLeft], steps[kLeft]);
  gait.right = FootPath(start[kRight], steps[kRight]);
  gait.phase = Track(phase);
  return gait;
}

}  // namespace

Performance walk() {
  const Loop loop;
  const Pace pace;
  const Gait gait = planGait(loop, pace);

  Performance p;
  p.seed = 11;
  p.duration = std::ceil(10.0 * (gait.end + 1.3)) / 10.0;
  p.leftFoot = gait.left;
  p.rightFoot = gait.right;
  p.groundIsCentreOfMass = false;
  p.liveliness = 0.7;
  const Track phase = gait.phase;

  /// How far the gait has developed, 0 to 1.
  const double end = gait.end;
  const Curve going = [=](double t) {
    return minimumJerk((t - 0.75) / 0.9) * (1.0 - minimumJerk((t - end + 0.75) / 0.9));
  };
  // Phase k + 1/2 is a footfall: the right one where the sine below is 1.
  const Curve rightAhead = [=](double t) { return going(t) * std::sin(kPi * phase(t)); };
  const Curve overLeft = [=](double t) { return going(t) * std::cos(kPi * phase(t)); };
  const Curve inward = [=](double t) {  // the lean required by a turn: tan = v^2 kappa / g
    const double v = pace.speed(t);
    return 0.75 * v * v * Loop::curvature(pace(t)) / 9.81;
  };
  const auto position = [=](double t) -> Vec3 {
    const double s = pace(t);
    const double aside = 0.022 * overLeft(t) + 0.75 * inward(t);
    return loop.at(s) + turned(Loop::heading(s), 0.0, 0.0) * Vec3(aside, 0.0, 0.015);
  };
  p.x = [=](double t) { return position(t).x(); };
  p.z = [=](double t) { return position(t).z(); };
  p.height = [=](double t) {
    return 0.915 - 0.02 * going(t) + 0.017 * going(t) * std::cos(2.0 * kPi * phase(t)) - 0.03 * std::abs(inward(t));
  };
  p.heading = [=](double t) { return Loop::heading(pace(t)) + degrees(5.0) * rightAhead(t); };
  p.pelvisPitch = [=](double t) { return degrees(2.5) * going(t); };
  p.pelvisRoll = [=](double t) { return -0.6 * inward(t) + degrees(3.0) * going(t) * std::cos(kPi * phase(t) + 0.5); };
  p.chestPitch = [=](double t) { return 0.03 + degrees(1.5) * going(t) * std::cos(2.0 * kPi * phase(t) + 1.0); };
  p.chestRoll = [=](double t) { return -0.5 * inward(t) - degrees(3.5) * going(t) * std::cos(kPi * phase(t) + 0.4); };
  p.chestTwist = [=](double t) { return -degrees(10.0) * rightAhead(t - 0.03); };
  // The gaze leads into a turn.
  p.headYaw = [=](double t) { return Loop::heading(std::min(pace(t) + 0.55 * going(t), Loop::kLength)); };
  p.headPitch = [=](double t) { return 0.06 * going(t) + 0.02 * std::cos(2.0 * kPi * phase(t)) * going(t); };
  p.headRoll = [=](double t) { return -0.35 * inward(t); };
  p.kneesOut = Track(0.03);
  const auto arm = [=](double mirror, double reachOut) -> ArmCurve {
    return [=](double t) {
      // Arms lag slightly behind the legs, swing farther forward than back, and bend more in front.
      const double swing = mirror * rightAhead(t - 0.04);
      const double later = mirror * rightAhead(t - 0.1);
      ArmPose a = swungArm(degrees(2.0 + 5.0 * going(t) + reachOut * swing), degrees(9.0) + 0.02 * swing,
                           degrees(17.0 + 9.0 * going(t) + 13.0 * later * going(t)));
      a.twist = degrees(15.0);
      a.bend = degrees(4.0 + 5.0 * later);
      return a;
    };
  };
  p.leftArm = arm(1.0, 24.0);
  p.rightArm = arm(-1.0, 21.0);
  return p;
}

}  // namespace lorica::motion
