#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/json.h"
#include "geometry/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

/// Reads what Azure Kinect's offline_processor writes: frames, each with a time and bodies, each with a list of joints;
/// and MediaPipe's landmarks, in whatever lists and objects a program puts them.
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
  if (order.empty())
    return badFormat("{}: found no joint_names and {}, expected 32", name, counted(std::int64_t(count), "joint"));
  return order;
}

/// The first member with one of some plain names, separated by blanks; nullptr if there is none.
const json* memberCalled(const json& object, std::string_view names) {
  if (!object.is_object()) return nullptr;
  const json* found = nullptr;
  const auto isMember = [&](std::string_view name) {
    for (const auto& [key, value] : object.items()) {
      if (plainName(key) == name) found = &value;
    }
    return found != nullptr;
  };
  return firstWord(names, isMember).empty() ? nullptr : found;
}

/// A frame's time in its own unit [s], if its name says so; nullopt: it has none.
std::optional<std::pair<double, std::optional<double>>> timeOf(const json& frame) {
  std::optional<std::pair<double, std::optional<double>>> found;
  if (!frame.is_object()) return found;
  for (const auto& [key, value] : frame.items()) {
    const std::string plain = plainName(key);
    // Not how long something took.
    if (!plain.starts_with("time") && plain.find("timestamp") == std::string::npos && plain.size() > 4) continue;
    std::optional<double> unit = unitOfTime(plain);
    if (!unit || (found && !(*unit > 0.0 && !found->second))) continue;
    if (*unit == 0.0) unit.reset();
    if (value.is_number()) found = {value.get<double>(), unit};
    if (!value.is_string()) continue;
    if (const auto clock = readClock(value.get_ref<const std::string&>())) found = {*clock, 1.0};
  }
  return found;
}

/// Frames per second, which the file or one of its members says; nullopt: nothing is said.
std::optional<double> rateIn(const json& root, int levels = 2) {
  constexpr std::string_view kRates = "fps framerate framespersecond videofps samplerate samplingrate";
  if (const json* rate = memberCalled(root, kRates); rate != nullptr && rate->is_number()) {
    const double perSecond = rate->get<double>();
    if (perSecond >= 0.1 && perSecond <= 1e4) return perSecond;
  }
  if (!root.is_object() || levels == 0) return std::nullopt;
  for (const auto& [key, value] : root.items()) {
    if (const std::optional<double> rate = rateIn(value, levels - 1)) return rate;
  }
  return std::nullopt;
}

/// Times of rows whose frames have none. @param numbers  of each row's frame
void countFrames(const json& root, std::span<const double> numbers, RawStream& raw) {
  const std::optional<double> rate = rateIn(root);
  for (int i = 0; i < countOf(raw.rows); ++i) raw.rows[i].frame.time = numbers[i];
  raw.secondsPerTick = 1.0 / rate.value_or(30.0);
  if (!rate) raw.notes.emplace_back("The file has no times: 30 frames per second were assumed.");
}

/// Three numbers in a list or as members x, y, z; nullopt: another thing.
std::optional<Vec3> positionIn(const json& value) {
  Vec3 position;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr std::array<std::array<const char*, 2>, 3> kAxes = {{{"x", "X"}, {"y", "Y"}, {"z", "Z"}}};
    const json* number = value.is_array() ? (axis < countOf(value) ? &value[axis] : nullptr)
                                          : memberOf(value, {kAxes[axis][0], kAxes[axis][1]});
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
  if (raw.rows.empty()) {
    return badFormat("{}: found no body in {}, expected at least one", file, counted(std::ssize(*frames), "frame"));
  }
  if (!timed) countFrames(root, numbers, raw);
  return raw;
}

/// A point of a body and the joint that it is.
struct Landmark {
  SensorJoint joint = SensorJoint::kOther;
  const json* point = nullptr;
};
using Landmarks = std::vector<Landmark>;

/// The landmarks that a list or object consists of; empty: it is something else.
Landmarks landmarksIn(const json& value) {
  constexpr int kLandmarks = 33;  // of MediaPipe
  Landmarks named, numbered;
  if (!value.is_structured()) return named;
  const Numbering numbering = {countOf(value) == kLandmarks ? orderOf(kLandmarks) : JointOrder()};
  for (const auto& [key, point] : value.items()) {  // of a list, the keys are numbers
    if (!positionIn(point)) continue;
    double number = 0.0;
    if (readNumber(key, number) == NumberKind::kNumber && number >= 0.0 && number < kLandmarks) {
      if (const auto joint = numbering.jointOf(static_cast<int>(number))) numbered.push_back({*joint, &point});
    }
    const json* called = memberOf(point, {"name", "landmark", "joint", "part", "type"});
    const std::string& name = called != nullptr && called->is_string() ? called->get_ref<const std::string&>() : key;
    // Python writes "PoseLandmark.NOSE".
    if (const auto joint = sensorJointCalled(name.substr(name.rfind('.') + 1))) named.push_back({*joint, &point});
  }
  if (countOf(named) < kFewestNamedJoints) named = std::move(numbered);
  return countOf(named) < kFewestNamedJoints ? Landmarks() : named;
}

/// A person in a frame.
struct Sighting {
  double time = 0.0, number = 0.0;
  std::string person;
  Landmarks landmarks;
};

bool isWorld(std::string_view key) {
  const std::string plain = plainName(key);
  return plain.find("world") != std::string::npos || plain.ends_with("3d");
}

/// Finds people in a frame. Those in a list are several; of an object's members one has them, that of the world first.
/// @param person  who it is, if the file says so
void findPeople(const json& value, const std::string& person, int level, std::vector<Sighting>& people) {
  constexpr int kLevels = 6;
  constexpr std::string_view kIds = "personid trackid bodyid poseid person";
  if (!value.is_structured() || level > kLevels) return;
  if (Landmarks landmarks = landmarksIn(value); !landmarks.empty()) {
    people.push_back({.person = person, .landmarks = std::move(landmarks)});
    return;
  }
  if (value.is_array()) {
    for (const json& one : value) {
      const json* id = memberOf(one, {"id"});  // of a frame it would be the frame's
      findPeople(one, id != nullptr ? id->dump() : person + std::to_string(people.size()), level + 1, people);
    }
    return;
  }
  const json* id = memberCalled(value, kIds);
  const std::size_t before = people.size();
  for (const bool world : {true, false}) {
    for (const auto& [key, member] : value.items()) {
      if (isWorld(key) != world) continue;
      findPeople(member, id != nullptr && !id->is_structured() ? id->dump() : person, level + 1, people);
      if (people.size() > before) return;
    }
  }
}

/// A list of frames, or an object whose members are called by their numbers.
struct FrameList {
  std::vector<std::pair<double, const json*>> frames = {};  ///< by number
  bool world = false;
};

/// The frames of a file: of several lists that of the world, else the longest.
FrameList frameListIn(const json& value, bool world, int level) {
  constexpr int kLevels = 3;
  FrameList best;
  if (!value.is_structured() || level > kLevels || !landmarksIn(value).empty()) return best;
  FrameList whole{.world = world};
  std::vector<Sighting> people;
  for (const auto& [key, frame] : value.items()) {
    const std::size_t digits = std::min(key.find_first_of("0123456789"), key.size());
    double number = 0.0;
    if (readNumber(std::string_view(key).substr(digits), number) == NumberKind::kNumber)
      whole.frames.emplace_back(number, &frame);
    if (people.empty()) findPeople(frame, "", 1, people);
  }
  if (people.empty()) return best;
  std::stable_sort(whole.frames.begin(), whole.frames.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (value.is_array() || whole.frames.size() == value.size()) return whole;
  for (const auto& [key, member] : value.items()) {
    FrameList list = frameListIn(member, world || isWorld(key), level + 1);
    if (std::pair(list.world, list.frames.size()) > std::pair(best.world, best.frames.size())) best = std::move(list);
  }
  if (best.frames.empty()) best.frames.emplace_back(0.0, &value);
  return best;
}

/// Everybody in all frames. @param timed  whether every frame has a time; else their numbers count
std::vector<Sighting> sightingsIn(const json& root, bool& timed, std::optional<double>& tick) {
  constexpr std::string_view kNumbers = "frame frameindex frameidx frameid framenumber frameno framenum";
  std::vector<Sighting> all;
  timed = true;
  const FrameList list = frameListIn(root, false, 0);
  for (const auto& [place, frame] : list.frames) {
    std::vector<Sighting> people;
    findPeople(*frame, "", 0, people);
    const auto time = timeOf(*frame);
    const json* number = memberCalled(*frame, kNumbers);
    timed = timed && (time || people.empty());
    if (time) tick = time->second;
    for (Sighting& one : people) {
      one.time = time ? time->first : 0.0;
      one.number = number != nullptr && number->is_number() ? number->get<double>() : place;
      all.push_back(std::move(one));
    }
  }
  timed = timed && (countOf(all) < 2 || all.front().time != all.back().time);
  return all;
}

Result<RawStream> readSightings(std::span<const Sighting> sightings, double unit, std::string_view file) {
  RawStream raw;
  PersonNumbers persons;
  for (const Sighting& one : sightings) {
    SensorSkeleton body;
    for (const auto& [joint, point] : one.landmarks) {
      const Vec3 position = unit * positionIn(*point).value();
      if (!(position.cwiseAbs().maxCoeff() <= kLargestCoordinate)) {
        return badFormat("{}, frame {:g}: found {}, expected a position within +-{:g}", file, one.number,
                         quotedWord(point->dump()), kLargestCoordinate / unit);
      }
      if (joint == SensorJoint::kOther) continue;
      const json* confidence =
          point->is_array()
              ? (countOf(*point) > 3 ? &(*point)[3] : nullptr)
              : memberOf(*point, {"visibility", "score", "confidence", "likelihood", "presence", "v", "c"});
      const double seen = confidence != nullptr && confidence->is_number() ? confidence->get<double>() : 1.0;
      const bool somewhere = !position.isZero(0.0) && seen > 0.0 && seen <= 100.0;
      body.set({joint, somewhere ? std::optional<Vec3>(position) : std::nullopt, seen, {}});
    }
    body.complete();
    raw.rows.push_back(observe(body, one.time, persons.of(one.person)));
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

Result<RawStream> readMediaPipeJson(const Layout&, std::string_view text, std::string_view file) {
  const std::size_t first = std::min(text.find_first_not_of(" \t\r\n\xef\xbb\xbf"), text.size());
  if (!isJson(text)) {
    return badFormat("{}: found {}, expected the JSON of MediaPipe's landmarks", file, quotedWord(text.substr(0, 20)));
  }
  LORICA_TRY(const json root, parseJson(text.substr(first), file));
  bool timed = false;
  std::optional<double> tick;
  const std::vector<Sighting> sightings = sightingsIn(root, timed, tick);
  if (sightings.empty()) {
    return unsupported(
        "{}: found JSON without joints, expected frames, each with MediaPipe's 33 landmarks of x, y and z, or with "
        "points that are named as joints",
        file);
  }
  return judged(file, std::nullopt, [&](double unit) -> Result<RawStream> {
    LORICA_TRY(RawStream raw, readSightings(sightings, unit, file));
    std::vector<double> numbers;
    numbers.reserve(sightings.size());
    for (const Sighting& one : sightings) numbers.push_back(one.number);
    raw.secondsPerTick = tick;
    if (!timed) countFrames(root, numbers, raw);
    return raw;
  });
}

}  // namespace lorica::joints
