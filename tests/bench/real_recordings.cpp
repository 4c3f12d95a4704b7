#include "tests/bench/real_recordings.h"

#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <string_view>
#include <utility>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

/// A row of numbers; an empty field, or one with words, is NaN.
std::vector<double> numbersOf(std::string_view line) {
  std::vector<double> row;
  while (!line.empty()) {
    const std::size_t comma = std::min(line.find(','), line.size());
    double value = std::numeric_limits<double>::quiet_NaN();
    std::from_chars(line.data(), line.data() + comma, value);
    row.push_back(value);
    line.remove_prefix(std::min(comma + 1, line.size()));
  }
  return row;
}

Result<std::map<int, Joints>> readTruth(const fs::path& file) {
  const Result<std::string> text = readFile(file);
  if (!text) return text.error();
  std::map<int, Joints> frames;
  std::istringstream lines(*text);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const std::vector<double> row = numbersOf(line);
    if (row.empty()) continue;
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
  std::map<int, std::map<int, std::vector<MarkedJoint>>> people;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    if (!line.starts_with(recording.name + ',')) continue;
    const std::vector<double> row = numbersOf(line);
    std::istringstream fields(line);
    std::string field;
    for (int i = 0; i < 4; ++i) std::getline(fields, field, ',');
    int joint = 0;
    while (joint < kBodyJointCount && nameOf(static_cast<BodyJoint>(joint)) != field) ++joint;
    if (row.size() < 7 || joint == kBodyJointCount) {
      return Error{ErrorCode::kBadFormat, fmt::format("marks.csv: no joint or too few numbers: {}", line)};
    }
    people[static_cast<int>(row[1])][static_cast<int>(row[2])].push_back(
        {static_cast<BodyJoint>(joint), Eigen::Vector2d(row[4], row[5]) - middle, 1e-3 * row[6]});
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

}  // namespace lorica::bench
