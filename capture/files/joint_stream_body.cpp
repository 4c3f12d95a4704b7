#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

/// Judges a stream's unit and axes by the body: people are 1 to 2.3 m tall, have the proportions of people, and stand.
namespace lorica::joints {
namespace {

using J = BodyJoint;

/// Until the unit is known, numbers are read as this: any of the units' numbers are then within the limits [m].
constexpr double kUnknown = 0.001;
constexpr double kMinHeight = 1.0, kMaxHeight = 2.3, kUsualHeight = 1.7;
/// Of a person's height: what the joints from the ankles to the head's middle leave out; then the height by the trunk
/// and by an arm where the legs, or hips too, are not seen.
constexpr double kHeightByChain = 1.13, kHeightByTrunk = 3.4, kHeightByArm = 2.9;
/// From shoulder to shoulder, by the length from the shoulders' middle to that of the hips.
constexpr double kShouldersByTrunk = 0.7;

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + countOf(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Height {
  double value = 0.0;  ///< in the rows' unit; 0: nobody is seen
  bool whole = false;  ///< from head to feet
};

/// How tall people are by the lengths between their joints, in whatever pose.
Height heightOf(std::span<const Observation> rows) {
  // The median over the frames; 0 if it is never seen.
  const auto length = [&](const auto& wayIn) {
    std::vector<double> lengths;
    for (const Observation& row : rows) {
      if (const std::optional<Vec3> way = wayIn(row.frame)) lengths.push_back(way->norm());
    }
    return median(lengths);
  };
  const auto bone = [&](J from, J to) {
    return length([&](const SkeletonFrame& frame) { return between(frame, from, to); });
  };
  const auto limb = [&](J top, J middle, J end) { return bone(top, middle) + bone(middle, end); };
  const auto overNeck = [](const SkeletonFrame& frame, const std::optional<Vec3>& to) {
    std::optional<Vec3> neck = seen(frame, J::kNeck);
    if (!neck) neck = middleOf(frame, {J::kLeftShoulder, J::kRightShoulder}, true);
    return neck && to ? std::optional<Vec3>(*to - *neck) : std::nullopt;
  };
  const double head = length([&](const auto& frame) { return overNeck(frame, seen(frame, J::kHead)); });
  const double trunk = length([&](const auto& frame) {
    return overNeck(frame, middleOf(frame, {J::kLeftHip, J::kRightHip}, true));
  });
  const double leg =
      std::max({limb(J::kLeftHip, J::kLeftKnee, J::kLeftFoot), limb(J::kRightHip, J::kRightKnee, J::kRightFoot),
                bone(J::kLeftHip, J::kLeftFoot), bone(J::kRightHip, J::kRightFoot)});
  if (trunk > 0.0 && leg > 0.0) return {kHeightByChain * (head + trunk + leg), head > 0.0};
  if (trunk > 0.0) return {kHeightByTrunk * trunk};
  return {kHeightByArm * std::max(limb(J::kLeftShoulder, J::kLeftElbow, J::kLeftHand),
                                  limb(J::kRightShoulder, J::kRightElbow, J::kRightHand))};
}

/// The sum over the frames of the vectors from the middle of hips, knees and feet to that of head, neck and shoulders.
Vec3 uprightOf(std::span<const Observation> rows) {
  const auto sumOf = [&](std::initializer_list<J> upper, std::initializer_list<J> lower) {
    Vec3 sum = Vec3::Zero();
    for (const Observation& row : rows) {
      const auto high = middleOf(row.frame, upper), low = middleOf(row.frame, lower);
      if (high && low) sum += *high - *low;
    }
    return sum;
  };
  const Vec3 upright = sumOf({J::kHead, J::kNeck, J::kLeftShoulder, J::kRightShoulder},
                             {J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot});
  // Heads alone, of those whose hips are not seen.
  return upright.isZero(0.0) ? sumOf({J::kHead}, {J::kLeftShoulder, J::kRightShoulder}) : upright;
}

/// The share of the frames in which a test of the hips' middle holds.
template <typename Test>
double shareOfHips(std::span<const Observation> rows, const Test& test) {
  double seen = 0.0, holds = 0.0;
  for (const Observation& row : rows) {
    const std::optional<Vec3> hips = middleOf(row.frame, {J::kLeftHip, J::kRightHip}, true);
    if (!hips) continue;
    seen += 1.0;
    holds += test(*hips) ? 1.0 : 0.0;
  }
  return seen > 0.0 ? holds / seen : 0.0;
}

/// Height by width of the picture in which the body has the proportions of people, of the usual ones.
std::pair<double, std::string_view> pictureOf(std::span<const Observation> rows) {
  using Picture = std::pair<double, std::string_view>;
  constexpr std::array<Picture, 5> kPictures = {
      {{9.0 / 16.0, "16:9"}, {3.0 / 4.0, "4:3"}, {1.0, "1:1"}, {4.0 / 3.0, "3:4"}, {16.0 / 9.0, "9:16"}}};
  std::vector<double> ratios;
  for (const Observation& row : rows) {
    const auto shoulders = middleOf(row.frame, {J::kLeftShoulder, J::kRightShoulder}, true);
    const auto hips = middleOf(row.frame, {J::kLeftHip, J::kRightHip}, true);
    if (!shoulders || !hips) continue;
    const Vec3 across = *between(row.frame, J::kRightShoulder, J::kLeftShoulder);
    const Vec3 trunk = *shoulders - *hips;
    const double height = std::pow(std::hypot(across.x(), across.z()) / kShouldersByTrunk, 2) - trunk.x() * trunk.x() -
                          trunk.z() * trunk.z();
    if (height > 0.0 && trunk.y() != 0.0) ratios.push_back(std::sqrt(height) / std::abs(trunk.y()));
  }
  if (ratios.empty()) return kPictures[0];
  const double ratio = std::log(median(ratios));
  return *std::min_element(kPictures.begin(), kPictures.end(), [&](const Picture& a, const Picture& b) {
    return std::abs(std::log(a.first) - ratio) < std::abs(std::log(b.first) - ratio);
  });
}

void scale(std::vector<Observation>& rows, const Vec3& by) {
  changePositions(rows, [&](const Vec3& position) { return Vec3(position.cwiseProduct(by)); });
}

/// Landmarks in a picture: x and y are of the picture, z is 0 at the hips. They have no scale of their own.
bool isPicture(std::span<const Observation> rows, double height) {
  const auto flat = [&](const Vec3& hips) {
    return std::abs(hips.z()) < 0.03 * height && std::hypot(hips.x(), hips.y()) > 0.1 * height;
  };
  return uprightOf(rows).y() < 0.0 && shareOfHips(rows, flat) > 0.8;
}

void scalePicture(RawStream& raw) {
  // Coordinates from 0 to 1 are fractions of the picture's width and height; others are pixels.
  double largest = 0.0;
  for (const Observation& row : raw.rows) {
    if (const auto upper = middleOf(row.frame, {J::kLeftShoulder, J::kRightShoulder})) {
      largest = std::max(largest, upper->head<2>().cwiseAbs().maxCoeff() / kUnknown);
    }
  }
  const auto [ratio, name] = largest < 4.0 ? pictureOf(raw.rows) : std::pair(1.0, std::string_view());
  scale(raw.rows, {1.0, ratio, 1.0});
  const double height = heightOf(raw.rows).value;
  scale(raw.rows, Vec3::Constant(kUsualHeight / height));
  raw.unit = fmt::format("{}, since z is 0 at the hips: scaled to a body of {:g} m",
                         name.empty() ? "pixels" : fmt::format("fractions of a {} picture", name), kUsualHeight);
}

/// A picture in which nothing has the size of a person gives any numbers.
Result<void> checkReach(std::string_view file, std::span<const Observation> rows) {
  for (const Observation& row : rows) {
    for (const TrackedJoint& joint : row.frame.joints) {
      if (joint.position.cwiseAbs().maxCoeff() <= kLargestCoordinate) continue;
      return badFormat("{}: found a joint {:.3g} m from the middle, if people are 1.7 m tall, expected at most {:g} m",
                       file, joint.position.cwiseAbs().maxCoeff(), kLargestCoordinate);
    }
  }
  return {};
}

Result<double> unitOf(std::string_view file, const Height& height, std::string& words) {
  struct Unit {
    double metres;
    std::string_view name;
  };
  constexpr std::array<Unit, 5> kUnits = {
      {{1.0, "metres"}, {0.01, "centimetres"}, {0.001, "millimetres"}, {0.0254, "inches"}, {0.3048, "feet"}}};
  // By a trunk or an arm alone heights are rough.
  const double slack = height.whole ? 1.0 : 1.4;
  for (const Unit& unit : kUnits) {
    const double metres = height.value * unit.metres;
    if (metres < kMinHeight / slack || metres > kMaxHeight * slack) continue;
    words = fmt::format("{}, since the body measures {:.4g} ({:.2f} m)", unit.name, height.value, metres);
    return unit.metres;
  }
  return badFormat("{}: found people who measure {:.3g}, expected 1 to 2.3 metres in any unit", file, height.value);
}

/// Rotates the axes so that Y is up.
void turnUp(std::vector<Observation>& rows, int axis, bool down) {
  Eigen::Matrix3d turn;
  if (axis == 0) turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  if (axis == 2) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  if (down) turn.topRows<2>() *= -1.0;  // half a turn about Z
  changePositions(rows, [&](const Vec3& position) { return Vec3(turn * position); });
}

/// Which of the file's axes are left, up and ahead of the sensor.
Result<void> judgeAxes(std::string_view file, RawStream& raw, bool world) {
  const Vec3 upright = uprightOf(raw.rows);
  int axis = 1;
  upright.cwiseAbs().maxCoeff(&axis);
  if (upright.isZero(0.0)) axis = 1;
  const bool down = upright[axis] < 0.0;
  if (!upright.isZero(0.0) && std::abs(upright[axis]) < 0.7 * upright.norm()) {
    return badFormat("{}: found no heads above or below hips along x, y or z, expected one of them to point up or down",
                     file);
  }
  raw.centred = shareOfHips(raw.rows, [](const Vec3& hips) { return hips.norm() < 0.03; }) > 0.9;
  raw.axes = fmt::format("{} is {}", "XYZ"[axis], down ? "down" : "up");
  if (down) raw.axes += fmt::format(", since heads have smaller {} than hips", "xyz"[axis]);
  // People before a sensor that looks along +Z are at some distance. Other cameras, those of graphics, look along -Z:
  // who looks at one looks along +Z.
  const double before = shareOfHips(raw.rows, [](const Vec3& hips) { return hips.z() > 0.3; });
  const bool hips = shareOfHips(raw.rows, [](const Vec3&) { return true; }) > 0.0;
  if (axis != 1) {
    turnUp(raw.rows, axis, down);
    raw.axes += ", rotated so that Y is up";
    raw.worldAxes = raw.towardsFront = true;
  } else if (down) {
    flip(raw.rows, {-1.0, -1.0, 1.0});  // cameras have y down and x to their right
  } else if (world || (hips && before < 0.9)) {
    raw.worldAxes = true;
    raw.towardsFront = raw.centred;
  }
  return {};
}

}  // namespace

/// States are 0, 1 and 2, Azure Kinect's levels up to 3, confidences at most 1, else they are percents. Those with
/// other values than states are probabilities.
void judgeConfidences(std::vector<Observation>& rows) {
  constexpr double kLargestState = 3.0;
  double largest = 0.0;
  const auto each = [&](const auto& change) {
    for (Observation& row : rows) std::for_each(row.frame.joints.begin(), row.frame.joints.end(), change);
  };
  each([&](const TrackedJoint& joint) { largest = std::max(largest, joint.confidence); });
  bool probable = false;
  each([&](TrackedJoint& joint) {
    if (largest > kLargestState) joint.confidence *= 0.01;
    probable = probable || 2.0 * joint.confidence != std::floor(2.0 * joint.confidence);
  });
  each([&](TrackedJoint& joint) {
    if (largest > 1.0 && largest <= kLargestState) joint.confidence = std::min(1.0, 0.5 * joint.confidence);
    if (probable) joint.confidence = joint.confidence < 0.1 ? 0.0 : joint.confidence < 0.5 ? 0.5 : 1.0;
    if (!(joint.confidence > 0.0)) joint = {};
  });
}

Result<RawStream> judged(std::string_view file, std::optional<double> unit,
                         const std::function<Result<RawStream>(double unit)>& read, bool world) {
  LORICA_TRY(RawStream raw, read(unit.value_or(kUnknown)));
  const Height height = heightOf(raw.rows);
  if (unit) {
    raw.unit = fmt::format("{:g} m per unit, as the header says", *unit);
  } else if (height.value > 0.0 && isPicture(raw.rows, height.value)) {
    scalePicture(raw);
    LORICA_TRY_DO(checkReach(file, raw.rows));
  } else if (height.value > 0.0) {
    std::string words;
    LORICA_TRY(const double found, unitOf(file, {height.value / kUnknown, height.whole}, words));
    LORICA_TRY(raw, read(found));
    raw.unit = words;
  }
  judgeConfidences(raw.rows);
  LORICA_TRY_DO(judgeAxes(file, raw, world));
  return raw;
}

}  // namespace lorica::joints
