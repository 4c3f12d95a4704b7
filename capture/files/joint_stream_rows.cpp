#include "capture/files/joint_stream_parts.h"
#include "capture/files/joint_stream_text.h"

#include <fmt/format.h>

#include <cmath>

/// Formats without names: rows with a fixed number of values.
namespace lorica::joints {
namespace {

/// Larger numbers are not times in any unit; differences of smaller ones are still exact integers.
constexpr double kLargestTick = 1e18;

Error nothingFound(std::string_view file, std::string_view expected) {
  return {ErrorCode::kBadFormat, fmt::format("{}: found no frame, expected {}", file, expected)};
}

std::string cutOffNote(std::size_t line) {
  return fmt::format("The last frame, line {}, is truncated and was omitted.", line);
}

}  // namespace

Result<RawStream> parseMsrAction3d(std::string_view text, std::string_view file) {
  constexpr std::size_t kFields = 4;
  RawStream raw;
  raw.secondsPerTick = 1.0 / 15.0;
  raw.notes.emplace_back("The file has no times: 15 frames per second were assumed, the rate of MSR Action3D.");
  RowReader reader(text, file);
  SensorSkeleton body;
  std::size_t joint = 0;
  while (reader.next()) {
    if (!reader.fit(kFields)) {
      if (reader.cutOff() && reader.count() < kFields) break;
      return reader.badCount("4: x y z confidence of a joint, 20 rows per frame");
    }
    const SensorJoint which = msrOrder()[joint];
    const std::string name = fmt::format("joint {} of the frame,", joint + 1);
    Result<std::optional<Vec3>> position = reader.position(0, name, 1.0);
    if (!position) return position.error();
    const Result<double> confidence = reader.number(3, "confidence", 1.0);
    if (!confidence || *confidence < 0.0) return reader.badField(3, "confidence", "a confidence from 0 to 1");
    // Joints that this sensor derives from others, such as the neck, always have 0 although their position is right.
    body.set(which, *position, *confidence >= 0.5 ? 1.0 : 0.5);
    if (++joint < kKinect1JointCount) continue;
    raw.rows.push_back(observe(body, static_cast<double>(raw.rows.size()), 1));
    joint = 0;
  }
  if (raw.rows.empty()) return nothingFound(file, "20 rows of x y z confidence for each frame");
  if (joint != 0) raw.notes.push_back(cutOffNote(reader.line()));
  return raw;
}

Result<RawStream> parseUtKinect(std::string_view text, std::string_view file) {
  constexpr std::size_t kFields = 1 + 3 * kKinect1JointCount;
  RawStream raw;
  RowReader reader(text, file);
  PersonTracks tracks;
  bool allEven = true;
  while (reader.next()) {
    if (!reader.fit(kFields)) {
      if (reader.cutOff() && reader.count() < kFields) {
        raw.notes.push_back(cutOffNote(reader.line()));
        break;
      }
      return reader.badCount("61: the frame number and 20 x (x y z)");
    }
    const Result<double> number = reader.number(0, "frame", kLargestTick);
    if (!number) return number.error();
    if (*number != std::floor(*number)) return reader.badField(0, "frame", "a whole number");
    allEven = allEven && std::fmod(*number, 2.0) == 0.0;
    SensorSkeleton body;
    for (std::size_t j = 0; j < kKinect1JointCount; ++j) {
      Result<std::optional<Vec3>> position = reader.position(1 + 3 * j, fmt::format("joint {}", j + 1), 1.0);
      if (!position) return position.error();
      body.set(kinect1Order()[j], *position, 1.0);
    }
    Observation row = observe(body, *number, 1);
    row.frame.user = tracks.personAt(*number, row.frame);
    raw.rows.push_back(std::move(row));
  }
  if (raw.rows.empty()) return nothingFound(file, "rows of a frame number and 20 x (x y z)");

  // The recorder counted the images of both cameras, 60 per second, and so wrote only even numbers.
  const double rate = allEven && raw.rows.size() > 1 ? 60.0 : 30.0;
  raw.secondsPerTick = 1.0 / rate;
  raw.notes.push_back(fmt::format("Frame numbers were assumed to count {:g} per second{}.", rate,
                                  rate == 60.0 ? ", because none is odd" : ""));
  return raw;
}

Result<RawStream> parseKinect2Plain(std::string_view text, std::string_view file) {
  constexpr std::size_t kFields = 3 * kSensorJointCount;
  RawStream raw;
  raw.secondsPerTick = 1.0 / 30.0;
  raw.notes.emplace_back("The file has no times: 30 frames per second were assumed.");
  RowReader reader(text, file);
  while (reader.next()) {
    if (!reader.fit(kFields)) {
      if (reader.cutOff() && reader.count() < kFields) {
        raw.notes.push_back(cutOffNote(reader.line()));
        break;
      }
      return reader.badCount("75: 25 x (x y z)");
    }
    SensorSkeleton body;
    for (std::size_t j = 0; j < kSensorJointCount; ++j) {
      Result<std::optional<Vec3>> position = reader.position(3 * j, fmt::format("joint {}", j + 1), 1.0);
      if (!position) return position.error();
      body.set(static_cast<SensorJoint>(j), *position, 1.0);
    }
    raw.rows.push_back(observe(body, static_cast<double>(raw.rows.size()), 1));
  }
  if (raw.rows.empty()) return nothingFound(file, "rows of 25 x (x y z)");
  return raw;
}

Result<RawStream> parseUpperBody(std::string_view text, std::string_view file) {
  constexpr std::size_t kArmJoints = 3;
  constexpr std::size_t kFields = 2 * 3 * kArmJoints;
  constexpr std::array<std::string_view, kArmJoints> kNames = {"shoulder", "elbow", "hand"};
  RawStream raw;
  raw.secondsPerTick = 1.0 / 30.0;
  raw.notes.emplace_back("The file has no times: 30 frames per second were assumed.");
  RowReader reader(text, file);
  double firstIsRight = 0.0;  // sum over frames of the first shoulder's offset to the sensor's left
  while (reader.next()) {
    if (!reader.fit(kFields)) {
      if (reader.cutOff() && reader.count() < kFields) {
        raw.notes.push_back(cutOffNote(reader.line()));
        break;
      }
      return reader.badCount("18: (shoulder, elbow, hand) x 2, each x y z");
    }
    Observation row;
    row.frame.time = static_cast<double>(raw.rows.size());
    for (std::size_t i = 0; i < 2 * kArmJoints; ++i) {
      const std::size_t arm = i / kArmJoints;
      Result<std::optional<Vec3>> position =
          reader.position(3 * i, fmt::format("arm {}, {}", arm + 1, kNames[i % kArmJoints]), 1.0);
      if (!position) return position.error();
      if (!*position) continue;
      // BodyJoint alternates left and right, starting at the left shoulder.
      const std::size_t joint = static_cast<std::size_t>(BodyJoint::kLeftShoulder) + 2 * (i % kArmJoints) + arm;
      row.frame.joints[joint] = {**position, std::nullopt, 1.0};
    }
    const TrackedJoint& first = row.frame[BodyJoint::kLeftShoulder];
    const TrackedJoint& second = row.frame[BodyJoint::kRightShoulder];
    if (first.confidence > 0.0 && second.confidence > 0.0) firstIsRight += first.position.x() - second.position.x();
    raw.rows.push_back(std::move(row));
  }
  if (raw.rows.empty()) return nothingFound(file, "rows of (shoulder, elbow, hand) x 2, each x y z");

  // There is no other cue: for a person facing the sensor, the right arm is on the sensor's left.
  const bool swap = firstIsRight > 0.0;
  raw.notes.push_back(
      fmt::format("The {} arm of each row is used as the left one: the person is assumed to face the sensor.",
                  swap ? "second" : "first"));
  if (swap) {
    for (Observation& row : raw.rows) {
      for (std::size_t j = static_cast<std::size_t>(BodyJoint::kLeftShoulder);
           j <= static_cast<std::size_t>(BodyJoint::kLeftHand); j += 2) {
        std::swap(row.frame.joints[j], row.frame.joints[j + 1]);
      }
    }
  }
  return raw;
}

Result<RawStream> parseNite2(std::string_view text, std::string_view file) {
  constexpr std::size_t kPlain = 2 + 4 * kBodyJointCount;
  constexpr std::size_t kTurned = 2 + 8 * kBodyJointCount;
  // NiTE writes millimetres. In metres a person is never 20 units away; in millimetres never that close.
  constexpr double kLargestInMetres = 20.0;
  RawStream raw;
  RowReader reader(text, file);
  double largest = 0.0;
  std::size_t fields = 0;
  while (reader.next()) {
    if (fields == 0) {
      if (isWord(reader.field(0))) {
        if (raw.notes.empty()) {
          raw.notes.emplace_back("The header was ignored: columns are assumed to be in NiTE 2's order.");
          continue;
        }
      }
      fields = reader.fit(kPlain) ? kPlain : kTurned;
    }
    if (!reader.fit(fields)) {
      if (reader.cutOff() && reader.count() < fields) {
        raw.notes.push_back(cutOffNote(reader.line()));
        break;
      }
      return reader.badCount(fields == kPlain ? "62: time, user, 15 x (x y z confidence)"
                                              : "62 or 122: time, user, 15 x (x y z confidence [qx qy qz qw])");
    }
    const Result<double> time = reader.number(0, "time", kLargestTick);
    if (!time) return time.error();
    const Result<double> user = reader.number(1, "user", 1e6);
    if (!user || *user != std::floor(*user)) return reader.badField(1, "user", "a whole number within +-1e+06");
    Observation row;
    row.frame.time = *time;
    row.frame.user = static_cast<int>(*user);
    const std::size_t fieldsPerJoint = fields == kPlain ? 4 : 8;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const std::size_t column = 2 + fieldsPerJoint * j;
      const std::string_view name = nameOf(static_cast<BodyJoint>(j));
      Result<std::optional<Vec3>> position = reader.position(column, name, 0.001);
      if (!position) return position.error();
      double confidence = 0.0;
      if (readNumber(reader.field(column + 3), confidence) != NumberKind::kNumber || confidence < 0.0 ||
          confidence > 1.0) {
        return reader.badField(column + 3, fmt::format("{} confidence", name), "a confidence from 0 to 1");
      }
      if (!*position || confidence <= 0.0) continue;
      TrackedJoint& joint = row.frame.joints[j];
      joint.position = **position;
      joint.confidence = confidence;
      largest = std::max(largest, joint.position.cwiseAbs().maxCoeff());
      if (fields == kPlain) continue;
      Quat q = Quat::Identity();
      bool whole = true;
      for (std::size_t i = 0; i < 4; ++i) {
        const NumberKind kind = readNumber(reader.field(column + 4 + i), q.coeffs()[static_cast<Eigen::Index>(i)]);
        if (kind == NumberKind::kBad) {
          return reader.badField(column + 4 + i, fmt::format("{} q{}", name, "xyzw"[i]), "a number");
        }
        whole = whole && kind == NumberKind::kNumber;
      }
      const double length = q.coeffs().stableNorm();
      if (!whole || !(std::abs(length - 1.0) < 0.05)) continue;
      q.coeffs() /= length;
      joint.orientation = q;
    }
    raw.rows.push_back(std::move(row));
  }
  if (raw.rows.empty()) return nothingFound(file, "rows of time, user, 15 x (x y z confidence)");
  if (largest > 0.0 && largest * 1000.0 < kLargestInMetres) {
    raw.notes.emplace_back("Positions are assumed to be in metres, because all are below 20.");
    for (Observation& row : raw.rows) {
      for (TrackedJoint& joint : row.frame.joints) joint.position *= 1000.0;
    }
  }
  return raw;
}

}  // namespace lorica::joints
