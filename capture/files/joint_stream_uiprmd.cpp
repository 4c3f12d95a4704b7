#include "capture/files/joint_stream_parts.h"
#include "capture/files/joint_stream_text.h"

#include <fmt/format.h>

#include <limits>
#include <numbers>

/// UI-PRMD (https://webpages.uidaho.edu/ui-prmd/): a person's skeleton as offsets and angles, derived from Kinect v2.
namespace lorica::joints {
namespace {

constexpr std::size_t kJoints = 22;
constexpr std::size_t kFields = 3 * kJoints;

/// Joint order: waist, spine, chest, neck, head, head tip; left collar, upper arm, forearm, hand; the same on the
/// right; left upper leg, lower leg, foot, toes; the same on the right. Lists each joint's parent; the waist is its own
/// parent.
constexpr std::array<std::size_t, kJoints> kParent = {0,  0,  1,  2, 3,  4,  3,  6, 7,  8,  3,
                                                      10, 11, 12, 0, 14, 15, 16, 0, 18, 19, 20};
constexpr std::size_t kHeadTip = 5;
constexpr std::array<std::size_t, 2> kToes = {17, 21};
/// Source of each of the 15 joints: the middle of the trunk is "chest", where the spine bends.
constexpr std::array<std::size_t, kBodyJointCount> kSource = {4, 3, 7, 11, 8, 12, 9, 13, 1, 14, 18, 15, 19, 16, 20};

Quat about(const Vec3& axis, double degrees) {
  return Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis));
}

using Row = std::array<Vec3, kJoints>;

/// Reads the next row of 22 x 3 numbers, NaN for missing ones; nullopt at the end.
Result<std::optional<Row>> nextRow(RowReader& reader, double largest, std::string_view expected) {
  if (!reader.next()) return std::optional<Row>{};
  if (!reader.fit(kFields)) {
    if (reader.cutOff() && reader.count() < kFields) return std::optional<Row>{};
    return reader.badCount(expected);
  }
  Row row;
  for (std::size_t i = 0; i < kFields; ++i) {
    double& to = row[i / 3][static_cast<Eigen::Index>(i % 3)];
    if (double ignored = 0.0; readNumber(reader.field(i), ignored) == NumberKind::kMissing) {
      to = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const Result<double> value = reader.number(i, fmt::format("joint {} {}", i / 3 + 1, "xyz"[i % 3]), largest);
    if (!value) return value.error();
    to = *value;
  }
  return std::optional<Row>(row);
}

}  // namespace

Result<RawStream> parseUiPrmd(std::string_view positions, std::string_view file, std::string_view angles,
                              std::string_view anglesFile) {
  RawStream raw;
  raw.axes = Axes::kWorld;  // Y up, the left side at +X, toes towards +Z
  raw.secondsPerTick = 1.0 / 30.0;
  raw.notes.emplace_back("The file has no times: 30 frames per second were assumed, the rate of UI-PRMD.");
  RowReader offsetRows(positions, file);
  RowReader angleRows(angles, anglesFile);
  while (true) {
    const Result<std::optional<Row>> offsets =
        nextRow(offsetRows, kLargestCoordinate * 100.0, "66: 22 x (x y z) in centimetres");
    if (!offsets) return offsets.error();
    const Result<std::optional<Row>> turns = nextRow(angleRows, 3600.0, "66: 22 x (x y z) in degrees");
    if (!turns) return turns.error();
    if (!*offsets || !*turns) {
      if (offsets->has_value() != turns->has_value()) {
        raw.notes.push_back(fmt::format("{} has fewer rows than {}: the extra rows were omitted.",
                                        *offsets ? anglesFile : file, *offsets ? file : anglesFile));
      }
      break;
    }
    // A joint rotates its children, first about Y, then X, then Z: the only order in which standing feet stay in place.
    // NaN propagates down the limb: the children of an unknown joint are unknown, too.
    std::array<Vec3, kJoints> position;
    std::array<Quat, kJoints> turn;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const Vec3& angle = (**turns)[j];
      const Quat local =
          about(Vec3::UnitZ(), angle.z()) * about(Vec3::UnitX(), angle.x()) * about(Vec3::UnitY(), angle.y());
      const Vec3 offset = 0.01 * (**offsets)[j];
      position[j] = j == 0 ? offset : Vec3(position[kParent[j]] + turn[kParent[j]] * offset);
      turn[j] = j == 0 ? local : (turn[kParent[j]] * local).normalized();
      if (position[j].allFinite() && position[j].cwiseAbs().maxCoeff() > kLargestCoordinate) {
        return offsetRows.fail(
            fmt::format("found joint {} more than 40 m away, expected offsets in centimetres", j + 1));
      }
    }
    Observation row;
    row.frame.time = static_cast<double>(raw.rows.size());
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      if (position[kSource[j]].allFinite()) row.frame.joints[j] = {position[kSource[j]], std::nullopt, 1.0};
    }
    // Limbs carry no real twist: elbows bend about arbitrary axes, and hands, shins and feet flip from frame to frame.
    for (const BodyJoint j : {BodyJoint::kHead, BodyJoint::kNeck, BodyJoint::kTorso}) {
      const Quat& its = turn[kSource[static_cast<std::size_t>(j)]];
      if (row.frame[j].confidence > 0.0 && its.coeffs().allFinite()) row.frame[j].orientation = its;
    }
    TrackedJoint& head = row.frame[BodyJoint::kHead];
    if (head.confidence > 0.0 && position[kHeadTip].allFinite())
      head.position = 0.5 * (head.position + position[kHeadTip]);
    for (std::size_t side = 0; side < 2; ++side) {
      if (position[kToes[side]].allFinite()) row.toes[side] = position[kToes[side]];
    }
    raw.rows.push_back(std::move(row));
  }
  if (raw.rows.empty()) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: found no frame, expected rows of 22 x (x y z)", file)};
  }
  return raw;
}

}  // namespace lorica::joints
