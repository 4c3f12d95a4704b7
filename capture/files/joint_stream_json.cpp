#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/json.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <utility>

/// Reads what Azure Kinect's offline_processor writes: frames, each with a time and bodies, each with a list of joints.
namespace lorica::joints {
namespace {

using nlohmann::json;

/// The first of the members that a list or number is called; nullptr if there is none.
const json* memberOf(const json& object, std::initializer_list<const char*> names) {
  if (!object.is_object()) return nullptr;
  for (const char* name : names) {
    if (const auto at = object.find(name); at != object.end()) return &*at;
  }
  return nullptr;
}

/// The joints in the order of the file: by its list of names, else by their count.
Result<std::vector<SensorJoint>> orderIn(const json& file, int count, std::string_view name) {
  std::vector<SensorJoint> order;
  if (const json* names = memberOf(file, {"joint_names"}); names != nullptr && names->is_array()) {
    for (const json& joint : *names) {
      const auto known = joint.is_string() ? sensorJointCalled(joint.get_ref<const std::string&>()) : std::nullopt;
      order.push_back(known.value_or(SensorJoint::kOther));
    }
  } else {
    const std::span<const SensorJoint> usual = orderOf(count).joints;
    order.assign(usual.begin(), usual.end());
  }
  if (order.empty()) return badFormat("{}: found no joint_names and {} joints, expected 32", name, count);
  return order;
}

/// A frame's time in its own unit; nullopt: it has none.
std::optional<std::pair<double, std::optional<double>>> timeOf(const json& frame) {
  struct Clock {
    const char* name;
    std::optional<double> tick;  ///< [s]
  };
  for (const Clock& clock : {Clock{"timestamp_usec", 1e-6},
                             {"timestamp_us", 1e-6},
                             {"timestamp_ms", 1e-3},
                             {"timestamp_s", 1.0},
                             {"timestamp", {}},
                             {"time", {}}}) {
    const json* time = memberOf(frame, {clock.name});
    if (time == nullptr || !time->is_number()) continue;
    return std::pair(time->get<double>(), clock.tick);
  }
  return std::nullopt;
}

/// Three numbers in a list or as members x, y, z; nullopt: another thing.
std::optional<Vec3> positionIn(const json& value) {
  Vec3 position;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
    const json* number =
        value.is_array() ? (axis < countOf(value) ? &value[axis] : nullptr) : memberOf(value, {kAxes[axis]});
    if (number == nullptr || !number->is_number()) return std::nullopt;
    position[axis] = number->get<double>();
  }
  return position;
}

/// Reads one body. @param confidences  0 to 3, or nullptr
Result<SensorSkeleton> readBody(const json& positions, const json* confidences, std::span<const SensorJoint> order,
                                double unit, const std::string& where) {
  SensorSkeleton body;
  if (countOf(positions) > countOf(order)) {
    return badFormat("{}: found {} joint_positions, expected at most {}, as there are joint_names", where,
                     positions.size(), order.size());
  }
  for (int j = 0; j < countOf(positions); ++j) {
    if (positions[j].is_null()) continue;
    const std::optional<Vec3> position = positionIn(positions[j]);
    if (!position || !((*position * unit).cwiseAbs().maxCoeff() <= kLargestCoordinate)) {
      return badFormat("{}, joint {}: found {}, expected a position of 3 numbers within +-{:g}", where, j + 1,
                       quotedWord(positions[j].dump()), kLargestCoordinate / unit);
    }
    double confidence = 1.0;
    if (confidences != nullptr && confidences->is_array() && j < countOf(*confidences) && (*confidences)[j].is_number())
      confidence = std::clamp(0.5 * (*confidences)[j].get<double>(), 0.0, 1.0);  // 1 is low, 2 is medium
    const bool seen = !position->isZero(0.0);
    if (order[j] != SensorJoint::kOther)
      body.set({order[j], seen ? std::optional<Vec3>(unit * *position) : std::nullopt, confidence, {}});
  }
  body.complete();
  return body;
}

Result<RawStream> readFrames(const json& root, double unit, std::string_view file) {
  RawStream raw;
  const json* frames = memberOf(root, {"frames"});
  if (frames == nullptr || !frames->is_array()) {
    return badFormat("{}: found no list of frames, expected frames, each with bodies", file);
  }
  std::vector<SensorJoint> order;
  PersonNumbers persons;
  std::vector<double> numbers;  // of each row's frame
  int number = -1;
  bool timed = true;
  for (const json& frame : *frames) {
    ++number;
    const auto time = timeOf(frame);
    timed = timed && time;
    if (time) raw.secondsPerTick = time->second;
    const json* bodies = memberOf(frame, {"bodies"});
    if (bodies == nullptr || !bodies->is_array()) continue;
    for (const json& one : *bodies) {
      const std::string where = fmt::format("{}, frame {}", file, number);
      const json* positions = memberOf(one, {"joint_positions", "positions"});
      if (positions == nullptr || !positions->is_array()) {
        return badFormat("{}: found a body without joint_positions, expected a list of them", where);
      }
      if (order.empty()) {
        LORICA_TRY(order, orderIn(root, countOf(*positions), file));
      }
      const json* confidences = memberOf(one, {"joint_confidence_levels", "confidence_levels", "joint_confidences"});
      LORICA_TRY(const SensorSkeleton body, readBody(*positions, confidences, order, unit, where));
      const json* id = memberOf(one, {"body_id", "id"});
      const int person = persons.of(id != nullptr ? id->dump() : std::string());
      raw.rows.push_back(observe(body, timed ? time->first : number, person));
      numbers.push_back(number);
    }
  }
  if (raw.rows.empty()) return badFormat("{}: found no body in {} frames, expected at least one", file, frames->size());
  if (!timed) {
    for (int i = 0; i < countOf(raw.rows); ++i) raw.rows[i].frame.time = numbers[i];
    raw.secondsPerTick = 1.0 / 30.0;
    raw.notes.emplace_back("The file has no times: 30 frames per second were assumed.");
  }
  return raw;
}

}  // namespace

Result<RawStream> readAzureJson(const Layout&, std::string_view text, std::string_view file) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first == std::string_view::npos || text[first] != '{') {
    return badFormat("{}: found {}, expected the JSON of a processed Azure Kinect recording", file,
                     quotedWord(text.substr(0, 20)));
  }
  LORICA_TRY(const json root, parseJson(text.substr(first), file));
  return judged(file, std::nullopt, [&](double unit) { return readFrames(root, unit, file); });
}

}  // namespace lorica::joints
