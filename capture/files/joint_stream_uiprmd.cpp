#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <limits>
#include <numbers>

/// UI-PRMD (https://webpages.uidaho.edu/ui-prmd/): a person's skeleton as offsets and angles, derived from Kinect v2.
namespace lorica::joints {
namespace {

constexpr int kJoints = 22;
/// The waist is its own parent.
constexpr std::array<int, kJoints> kParent = {0,  0,  1,  2, 3,  4,  3,  6, 7,  8,  3,
                                              10, 11, 12, 0, 14, 15, 16, 0, 18, 19, 20};
constexpr int kHeadTip = 5;

Quat about(const Vec3& axis, double degrees) {
  return Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis));
}

using Row = std::array<Vec3, kJoints>;

/// Reads the next row of 22 x 3 numbers, NaN for missing ones; nullopt at the end.
Result<std::optional<Row>> nextRow(const Layout& layout, RowReader& reader, double largest, std::string_view unit) {
  if (!reader.next()) return std::optional<Row>{};
  const int count = layout.count();
  if (!reader.fit(count)) {
    if (reader.cutOff() && reader.count() < count) return std::optional<Row>{};
    return reader.badCount(fmt::format("{} in {}", layout.expectedRow, unit));
  }
  Row row;
  for (int i = 0; i < count; ++i) {
    double& to = row[i / 3][i % 3];
    if (readNumber(reader.field(i), to) == NumberKind::kMissing) {
      to = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    LORICA_TRY(to, reader.number(i, fmt::format("{} {}", layout.called(i / 3), "xyz"[i % 3]), largest));
  }
  return std::optional<Row>(row);
}

}  // namespace

Result<RawStream> readUiPrmd(std::string_view positions, std::string_view file, std::string_view angles,
                             std::string_view anglesFile) {
  const Layout& layout = layoutOf(JointFormat::kUiPrmd);
  RawStream raw;
  raw.worldAxes = true;  // Y up, the left side at +X, toes towards +Z
  raw.secondsPerTick = layout.tick;
  raw.notes.emplace_back(layout.note);
  RowReader offsetRows(positions, file);
  RowReader angleRows(angles, anglesFile);
  while (true) {
    LORICA_TRY(const auto offsets, nextRow(layout, offsetRows, kLargestCoordinate * 100.0, "centimetres"));
    LORICA_TRY(const auto turns, nextRow(layout, angleRows, 3600.0, "degrees"));
    if (!offsets || !turns) {
      if (offsets.has_value() != turns.has_value()) {
        raw.notes.push_back(fmt::format("{} has fewer rows than {}: the extra rows were omitted.",
                                        offsets ? anglesFile : file, offsets ? file : anglesFile));
      }
      break;
    }
    // A joint rotates its children, first about Y, then X, then Z: the only order in which standing feet stay in place.
    // NaN propagates down the limb: the children of an unknown joint are unknown, too.
    Row position;
    std::array<Quat, kJoints> turn;
    SensorSkeleton body;
    for (int j = 0; j < kJoints; ++j) {
      const Vec3& angle = (*turns)[j];
      const Quat local =
          about(Vec3::UnitZ(), angle.z()) * about(Vec3::UnitX(), angle.x()) * about(Vec3::UnitY(), angle.y());
      const Vec3 offset = layout.unit * (*offsets)[j];
      position[j] = j == 0 ? offset : Vec3(position[kParent[j]] + turn[kParent[j]] * offset);
      turn[j] = j == 0 ? local : (turn[kParent[j]] * local).normalized();
      const bool known = position[j].allFinite();
      if (known && position[j].cwiseAbs().maxCoeff() > kLargestCoordinate) {
        return offsetRows.fail(
            fmt::format("found joint {} more than 40 m away, expected offsets in centimetres", j + 1));
      }
      // Limbs carry no real twist: elbows bend about arbitrary axes, and hands, shins and feet flip from frame to
      // frame.
      using enum SensorJoint;
      const SensorJoint joint = layout.order[j];
      const bool turned = (joint == kHead || joint == kNeck || joint == kSpineMid) && turn[j].coeffs().allFinite();
      body.set({joint, known ? std::optional(position[j]) : std::nullopt, 1.0,
                turned ? std::optional(turn[j]) : std::nullopt});
    }
    Observation& row = raw.rows.emplace_back(observe(body, static_cast<double>(raw.rows.size()), 1));
    TrackedJoint& head = row.frame[BodyJoint::kHead];
    if (head.confidence > 0.0 && position[kHeadTip].allFinite())
      head.position = 0.5 * (head.position + position[kHeadTip]);
  }
  if (raw.rows.empty()) return badFormat("{}: found no frame, expected {}", file, layout.expectedFile);
  return raw;
}

}  // namespace lorica::joints
