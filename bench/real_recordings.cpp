#include "bench/real_recordings.h"

#include "capture/virtual_sensor/virtual_body.h"
#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <string_view>
#include <utility>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

/// Girth of a rendered person relative to the tracker's model.
constexpr double kGirth = 1.1;
/// From the body's axis to its back [m].
constexpr double kBack = 0.15;

/// Rows of numbers after a header; an empty field is NaN.
std::vector<std::vector<double>> readTable(const std::string& text) {
  std::vector<std::vector<double>> rows;
  for (std::size_t at = text.find('\n'); at != std::string::npos && at + 1 < text.size();) {
    const std::size_t end = std::min(text.find('\n', at + 1), text.size());
    std::string_view line(text.data() + at + 1, end - at - 1);
    std::vector<double> row;
    while (!line.empty()) {
      const std::size_t comma = std::min(line.find(','), line.size());
      double value = std::numeric_limits<double>::quiet_NaN();
      std::from_chars(line.data(), line.data() + comma, value);
      row.push_back(value);
      line.remove_prefix(std::min(comma + 1, line.size()));
    }
    if (!row.empty()) rows.push_back(std::move(row));
    at = end < text.size() ? end : std::string::npos;
  }
  return rows;
}

Result<std::map<int, Joints>> readTruth(const fs::path& file) {
  const Result<std::string> text = readFile(file);
  if (!text) return text.error();
  std::map<int, Joints> frames;
  for (const std::vector<double>& row : readTable(*text)) {
    if (row.size() != 1 + 3 * kBodyJointCount) {
      return Error{ErrorCode::kBadFormat, fmt::format("{}: a row has {} numbers, expected {}", file.string(),
                                                      row.size(), 1 + 3 * kBodyJointCount)};
    }
    Joints& joints = frames[static_cast<int>(row[0])];
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      joints[j] = Vec3(row[1 + 3 * j], row[2 + 3 * j], row[3 + 3 * j]);
    }
  }
  return frames;
}

Result<nlohmann::json> readJson(const fs::path& file) {
  const Result<std::string> text = readFile(file);
  if (!text) return text.error();
  nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object()) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: expected a JSON object", file.string())};
  }
  return json;
}

/// The truth's floor; a level camera 1.2 m up if it has none.
Isometry3 floorOf(const nlohmann::json& json) {
  Isometry3 result = Isometry3::Identity();
  if (!json.contains("floor") || !json["floor"].is_object()) {
    result.translation().y() = 1.2;
    return result;
  }
  const auto normal = json["floor"]["normal"].get<std::vector<double>>();
  const Vec3 up(normal.at(0), normal.at(1), normal.at(2));
  const Vec3 back = (Vec3::UnitZ() - up.z() * up).normalized();
  Eigen::Matrix3d rows;
  rows << up.cross(back).transpose(), up.transpose(), back.transpose();
  result.linear() = rows;
  result.translation().y() = json["floor"]["height"].get<double>();
  return result;
}

/// The rows of marks.csv that are of a recording: recording, frame, person, joint, x, y, depth_mm, visible.
Result<void> readMarks(const std::string& text, const Eigen::Vector2d& middle, RealRecording& recording) {
  std::map<std::string, BodyJoint, std::less<>> joints;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    joints.emplace(nameOf(static_cast<BodyJoint>(j)), static_cast<BodyJoint>(j));
  }
  std::map<int, std::map<int, std::vector<MarkedJoint>>> people;
  const std::vector<std::vector<double>> rows = readTable(text);
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  for (const std::vector<double>& row : rows) {
    std::getline(lines, line);
    if (!line.starts_with(recording.name + ',')) continue;
    std::istringstream fields(line);
    std::string field;
    for (int i = 0; i < 4; ++i) std::getline(fields, field, ',');
    const auto joint = joints.find(field);
    if (row.size() < 7 || joint == joints.end()) {
      return Error{ErrorCode::kBadFormat, fmt::format("marks.csv: no joint or too few numbers: {}", line)};
    }
    people[static_cast<int>(row[1])][static_cast<int>(row[2])].push_back(
        {joint->second, Eigen::Vector2d(row[4], row[5]) - middle, 1e-3 * row[6]});
  }
  for (auto& [frame, marked] : people) {
    for (auto& [person, marks] : marked) recording.marks[frame].push_back(std::move(marks));
  }
  return {};
}

Result<RealRecording> readRecording(const fs::path& json) {
  const Result<nlohmann::json> meta = readJson(json);
  if (!meta) return meta.error();
  RealRecording recording;
  recording.name = json.stem().string();
  recording.kind = meta->value("kind", std::string());
  recording.file = fs::path(json).replace_extension(".oni");
  recording.firstFrame = meta->value("first_frame_with_person", 0);
  recording.peopleVisible = meta->value("people_visible", 1);
  recording.frameSeconds = meta->value("frame_seconds", 1.0 / 30.0);
  recording.gap = meta->value("gap_m", 1.0);
  recording.floorFromCamera = floorOf(*meta);
  for (const char* ending : {".joints.csv", ".joints2.csv"}) {
    const fs::path file = fs::path(json).replace_extension() += ending;
    if (!fs::exists(file)) continue;
    Result<std::map<int, Joints>> truth = readTruth(file);
    if (!truth) return truth.error();
    recording.people.push_back(std::move(*truth));
  }
  const fs::path marks = json.parent_path() / "marks.csv";
  if (!fs::exists(marks)) return recording;
  const Result<std::string> text = readFile(marks);
  if (!text) return text.error();
  const Eigen::Vector2d middle(0.5 * meta->value("width", 0), 0.5 * meta->value("height", 0));
  if (Result<void> read = readMarks(*text, middle, recording); !read) return read.error();
  return recording;
}

/// Length of a leg and the trunk.
double sizeOf(const Joints& joints) {
  const auto at = [&](BodyJoint joint) { return joints[static_cast<std::size_t>(joint)]; };
  using J = BodyJoint;
  const double legs = (at(J::kLeftHip) - at(J::kLeftKnee)).norm() + (at(J::kLeftKnee) - at(J::kLeftFoot)).norm() +
                      (at(J::kRightHip) - at(J::kRightKnee)).norm() + (at(J::kRightKnee) - at(J::kRightFoot)).norm();
  return 0.5 * legs + (at(J::kNeck) - 0.5 * (at(J::kLeftHip) + at(J::kRightHip))).norm();
}

Joints positionsOf(const SkeletonFrame& frame) {
  Joints joints;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) joints[j] = frame.joints[j].position;
  return joints;
}

/// A body of the recorded person's size that repeats their joints.
Result<VirtualPerformer> performerOf(const std::vector<SkeletonFrame>& frames, std::span<const Clothes> clothes) {
  std::vector<double> sizes;
  sizes.reserve(frames.size());
  for (const SkeletonFrame& frame : frames) sizes.push_back(sizeOf(positionsOf(frame)));
  std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
  const Character mannequin = makeMannequin();
  Result<VirtualPerformer> usual = VirtualPerformer::create(mannequin, frames);
  if (!usual) return usual;
  const double height = sizes[sizes.size() / 2] / sizeOf(positionsOf(usual->joints()));
  return VirtualPerformer::create(withClothes(withProportions(mannequin, {.height = height, .girth = kGirth}), clothes),
                                  frames);
}

}  // namespace

Result<std::vector<RealRecording>> readRealRecordings(const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<RealRecording> recordings;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".json" || !fs::exists(fs::path(entry.path()).replace_extension(".oni"))) continue;
    const auto starts = [&](const std::string& start) { return name.starts_with(start); };
    if (!names.empty() && std::ranges::none_of(names, starts)) continue;
    Result<RealRecording> recording = readRecording(entry.path());
    if (!recording) return recording.error();
    recordings.push_back(std::move(*recording));
  }
  if (recordings.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: found no recording NAME.oni with NAME.json", folder.string())};
  }
  std::ranges::sort(recordings, {}, &RealRecording::name);
  return recordings;
}

Result<Joints> readOffsets(const fs::path& file) {
  const Result<nlohmann::json> json = readJson(file);
  if (!json) return json.error();
  Joints offsets;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    const std::string name(nameOf(static_cast<BodyJoint>(j)));
    const auto& one = (*json)["metres_floor_frame"][name];
    if (!one.is_array() || one.size() != 3) {
      return Error{ErrorCode::kBadFormat, fmt::format("{}: no offset of `{}`", file.string(), name)};
    }
    offsets[j] = Vec3(one[0].get<double>(), one[1].get<double>(), one[2].get<double>());
  }
  return offsets;
}

Result<RenderedTwin> renderedTwin(const RealRecording& recording, const Joints& offsets, const DepthCamera& camera,
                                  const DepthNoiseSettings& noise, std::span<const Clothes> clothes) {
  if (recording.people.empty()) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: has no joints to repeat", recording.name)};
  }
  const bool cutOut = recording.kind == "cutout";
  VirtualSensorSettings settings;
  settings.camera = camera;
  settings.noise = noise;
  settings.framesPerSecond = 1.0 / recording.frameSeconds;
  // The camera of the people who are cut out was 1.1 m high and tilted by about 6 degrees.
  settings.room.worldFromCamera = cutOut ? worldFromCameraAt({0.0, 1.1, 0.0}, 0.105) : recording.floorFromCamera;
  settings.room.floor = !cutOut;
  double farthest = 0.0;
  int frames = 0;
  std::vector<VirtualPerson> people;
  for (const std::map<int, Joints>& person : recording.people) {
    std::vector<SkeletonFrame> motion;
    motion.reserve(person.size());
    for (const auto& [number, joints] : person) {
      SkeletonFrame& frame = motion.emplace_back();
      frame.time = number * recording.frameSeconds;
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        frame.joints[j].position = settings.room.worldFromCamera * joints[j] + offsets[j];
        frame.joints[j].confidence = 1.0;
      }
      frames = std::max(frames, number + 1);
    }
    farthest = std::min(farthest, motion.front()[BodyJoint::kTorso].position.z());
    Result<VirtualPerformer> performer = performerOf(motion, clothes);
    if (!performer) return performer.error();
    people.push_back({std::move(*performer)});
    people.back().start = -motion.front().time;
    if (motion.front().time > 0.0) people.back().absent.push_back({0.0, motion.front().time - 0.01});
  }
  settings.room.wall.reset();
  if (!cutOut) settings.room.wall = farthest - kBack - recording.gap;
  Result<VirtualSensor> sensor = VirtualSensor::create(std::move(people), settings);
  if (!sensor) return sensor.error();

  RenderedTwin twin{std::move(*sensor), recording, {}, {}};
  twin.truth.file.clear();
  twin.truth.marks.clear();
  twin.truth.floorFromCamera = settings.room.worldFromCamera;
  for (std::map<int, Joints>& person : twin.truth.people) person.clear();
  twin.repeated = twin.truth.people;
  const Mat3 cameraFromFloor = settings.room.worldFromCamera.linear().transpose();
  DepthFrame image;
  for (int number = 0; number < frames; ++number) {
    twin.sensor.render(static_cast<std::uint64_t>(number), image);
    for (std::size_t p = 0; p < recording.people.size(); ++p) {
      const auto recorded = recording.people[p].find(number);
      if (recorded == recording.people[p].end() || !twin.sensor.truth()[p].present) continue;
      const Joints& joints = twin.truth.people[p][number] = positionsOf(twin.sensor.truth()[p].joints);
      bool limb = false;
      Joints repeated;
      Vec3 offCentre = Vec3::Zero();
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        repeated[j] = recorded->second[j] + cameraFromFloor * offsets[j];
        offCentre += (joints[j] - repeated[j]) / static_cast<double>(kBodyJointCount);
      }
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        repeated[j] += offCentre;
        const double apart = (joints[j] - repeated[j]).norm();
        twin.apart.push_back(apart);
        const auto joint = static_cast<BodyJoint>(j);
        const bool trunk = joint == BodyJoint::kHead || joint == BodyJoint::kNeck || joint == BodyJoint::kTorso;
        limb = limb || (!trunk && apart > 0.15);
      }
      twin.repeated[p][number] = repeated;
      ++twin.frames;
      twin.limbApartFrames += static_cast<int>(limb);
    }
  }
  return twin;
}

}  // namespace lorica::bench
