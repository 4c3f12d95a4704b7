#include "capture/files/joint_stream_parts.h"
#include "capture/files/joint_stream_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <map>

/// Kinect v1 and v2 recordings whose rows contain names or counts.
namespace lorica::joints {
namespace {

constexpr double kLargestTick = 1e18;
constexpr double kHundredNanoseconds = 1e-7;
constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

/// Kinect v2 gives every tracked body a new 17-digit number: people are renumbered from 1 in order of appearance.
class PersonNumbers {
 public:
  int of(std::string_view id) {
    const auto [entry, isNew] = numbers_.try_emplace(std::string(id.substr(0, kLongestId)), 0);
    if (isNew) entry->second = static_cast<int>(numbers_.size());
    return entry->second;
  }

 private:
  static constexpr std::size_t kLongestId = 40;
  std::map<std::string, int> numbers_;
};

/// Parses "Tracked", "INFERRED", "NotTracked", or their numbers 2, 1, 0.
std::optional<double> confidenceOf(std::string_view state) {
  for (const std::string_view name : {"2", "tracked"}) {
    if (sameWord(state, name)) return 1.0;
  }
  for (const std::string_view name : {"1", "inferred"}) {
    if (sameWord(state, name)) return 0.5;
  }
  for (const std::string_view name : {"0", "nottracked", "not_tracked", "not tracked"}) {
    if (sameWord(state, name)) return 0.0;
  }
  return std::nullopt;
}

/// The name in lower case and without the dot in "Position.X".
std::string plainName(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') {
      plain += static_cast<char>(c - 'A' + 'a');
    } else if (c != '.' && c != '_' && c != ' ' && c != '-') {
      plain += c;
    }
  }
  return plain;
}

/// Content of a column of the wide layout.
struct WideColumn {
  enum class Kind : std::uint8_t { kOther, kTime, kPerson, kJoint, kStatus, kPosition, kTurn } kind = Kind::kOther;
  std::size_t group = 0;  ///< index of the joint in the row
  int axis = 0;
};

struct WideHeader {
  struct Group {
    std::optional<SensorJoint> joint;  ///< if the header names it
    std::size_t nameColumn = kNoColumn;
    std::size_t statusColumn = kNoColumn;
    std::array<std::size_t, 3> positionColumn{kNoColumn, kNoColumn, kNoColumn};
  };
  std::vector<WideColumn> columns;
  std::vector<Group> groups;
  std::size_t timeColumn = kNoColumn;
  std::size_t personColumn = kNoColumn;
};

/// Columns are found by name in any order. The n-th occurrence of a name without a joint prefix ("PositionX") belongs
/// to the n-th joint; the row specifies which joint that is.
Result<WideHeader> readWideHeader(const RowReader& reader) {
  using Kind = WideColumn::Kind;
  WideHeader header;
  header.columns.resize(reader.count());
  std::map<std::string, std::size_t> timesSeen;
  std::map<std::string, std::size_t> groupOfJoint;
  constexpr std::size_t kMaxGroups = 64;
  const auto groupAt = [&](std::size_t n) -> WideHeader::Group& {
    if (header.groups.size() <= n) header.groups.resize(n + 1);
    return header.groups[n];
  };
  for (std::size_t c = 0; c < reader.count(); ++c) {
    const std::string name = plainName(reader.field(c));
    WideColumn& column = header.columns[c];
    if (name == "time" || name == "timestamp" || name == "relativetime") {
      header.timeColumn = c;
      column.kind = Kind::kTime;
    } else if (name == "skeletonid" || name == "bodyid" || name == "trackingid") {
      header.personColumn = c;
      column.kind = Kind::kPerson;
    }
    struct Ending {
      std::string_view text;
      Kind kind;
      int axis;
    };
    constexpr std::array<Ending, 9> kEndings = {{{"joint", Kind::kJoint, 0},
                                                 {"status", Kind::kStatus, 0},
                                                 {"positionx", Kind::kPosition, 0},
                                                 {"positiony", Kind::kPosition, 1},
                                                 {"positionz", Kind::kPosition, 2},
                                                 {"rotationw", Kind::kTurn, 0},
                                                 {"rotationx", Kind::kTurn, 1},
                                                 {"rotationy", Kind::kTurn, 2},
                                                 {"rotationz", Kind::kTurn, 3}}};
    for (const Ending& ending : kEndings) {
      if (!std::string_view(name).ends_with(ending.text)) continue;
      const std::string owner = name.substr(0, name.size() - ending.text.size());
      const std::optional<SensorJoint> joint = sensorJointNamed(owner);
      if (!owner.empty() && !joint) continue;
      const std::size_t group =
          joint ? groupOfJoint.try_emplace(owner, groupOfJoint.size()).first->second : timesSeen[name]++;
      if (group >= kMaxGroups) return reader.badField(c, name, "at most 64 joints");
      column = {ending.kind, group, ending.axis};
      WideHeader::Group& g = groupAt(group);
      g.joint = joint;
      if (ending.kind == Kind::kJoint) g.nameColumn = c;
      if (ending.kind == Kind::kStatus) g.statusColumn = c;
      if (ending.kind == Kind::kPosition) g.positionColumn[ending.axis] = c;
    }
  }
  if (header.timeColumn == kNoColumn) return reader.fail("found a header without a Time column, expected one");
  for (std::size_t g = 0; g < header.groups.size(); ++g) {
    const WideHeader::Group& group = header.groups[g];
    if (!group.joint && group.nameColumn == kNoColumn) {
      return reader.fail(fmt::format("found no Joint column for joint {}, expected one for each joint", g + 1));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (group.positionColumn[axis] != kNoColumn) continue;
      return reader.fail(
          fmt::format("found no Position{} column for joint {}, expected one for each joint", "XYZ"[axis], g + 1));
    }
  }
  if (header.groups.empty())
    return reader.fail("found a header without PositionX columns, expected one for each joint");
  return header;
}

/// Rejoins numbers that were split at decimal commas: every run of numbers ends at the position of the next word.
bool repairWideRow(RowReader& reader, const WideHeader& header) {
  const std::span<const std::string_view> tokens = reader.fields();
  std::vector<std::string_view> repaired;
  repaired.reserve(header.columns.size());
  const auto isTorn = [&](std::size_t c) {
    return header.columns[c].kind == WideColumn::Kind::kPosition || header.columns[c].kind == WideColumn::Kind::kTurn;
  };
  std::size_t token = 0;
  for (std::size_t c = 0; c < header.columns.size();) {
    if (!isTorn(c)) {
      if (token == tokens.size()) return false;
      repaired.push_back(tokens[token++]);
      ++c;
      continue;
    }
    std::size_t columnEnd = c;
    while (columnEnd < header.columns.size() && isTorn(columnEnd)) ++columnEnd;
    std::size_t tokenEnd = token;
    while (tokenEnd < tokens.size() && !isWord(tokens[tokenEnd])) ++tokenEnd;
    const auto numbers = joinDecimalCommas(tokens.subspan(token, tokenEnd - token), columnEnd - c);
    if (!numbers) return false;
    repaired.insert(repaired.end(), numbers->begin(), numbers->end());
    token = tokenEnd;
    c = columnEnd;
  }
  if (token != tokens.size()) return false;
  reader.replaceFields(std::move(repaired));
  return true;
}

/// Whether frames usually follow each other as those of a sensor do: between 2 and 200 of them per second.
bool isPlausibleClock(std::span<const double> times, double secondsPerTick) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] != times[i - 1]) steps.push_back(std::abs(times[i] - times[i - 1]) * secondsPerTick);
  }
  if (steps.empty()) return false;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle >= 0.005 && *middle <= 0.5;
}

/// Rows of Kinect v2 bodies hold the sensor's time in 100 ns and, before |kb, the seconds of the program that wrote
/// them. The sensor's is exact, but some programs write something else in its place.
/// @param loggedSeconds  one per row; empty if a row has none
void chooseClock(RawStream& raw, std::span<const double> loggedSeconds) {
  std::vector<double> ticks;
  ticks.reserve(raw.rows.size());
  for (const Observation& row : raw.rows) ticks.push_back(row.frame.time);
  if (raw.rows.size() < 2 || isPlausibleClock(ticks, kHundredNanoseconds)) return;
  if (isPlausibleClock(loggedSeconds, 1.0)) {
    raw.secondsPerTick = 1.0;
    for (std::size_t i = 0; i < raw.rows.size(); ++i) raw.rows[i].frame.time = loggedSeconds[i];
    raw.notes.emplace_back(
        "The sensor's time does not advance like one in 100 ns: the seconds before |kb were used instead.");
    return;
  }
  raw.secondsPerTick.reset();  // the unit is guessed from the time steps
}

}  // namespace

Result<RawStream> parseKinect2Bodies(std::string_view text, std::string_view file) {
  constexpr std::size_t kMaxBodies = 6;
  constexpr std::size_t kHands = 2;
  RawStream raw;
  raw.secondsPerTick = kHundredNanoseconds;
  RowReader reader(text, file);
  PersonNumbers persons;
  std::vector<double> loggedSeconds;  // value before "|kb", one per row
  std::size_t otherRows = 0;
  bool logged = true;
  while (reader.next()) {
    const std::string_view tag = reader.field(0);
    const std::size_t bar = tag.find('|');
    if (bar != std::string_view::npos && !sameWord(tag.substr(bar + 1), "kb")) {
      ++otherRows;
      continue;
    }
    std::size_t column = 4;
    const auto cut = [&](std::size_t needed) { return reader.cutOff() && reader.count() < column + needed; };
    if (cut(0)) break;
    if (reader.count() < column) return reader.badCount("at least 4: tag, time, 6, 25, then six bodies");
    const Result<double> tick = reader.number(1, "time", kLargestTick);
    if (!tick) return tick.error();
    const Result<double> bodies = reader.number(2, "bodies", kMaxBodies);
    if (!bodies || *bodies < 1.0 || *bodies != std::floor(*bodies)) {
      return reader.badField(2, "bodies", "the number of bodies that follow, 1 to 6");
    }
    if (reader.field(3) != "25") return reader.badField(3, "joints", "25 joints per body");
    double seconds = 0.0;
    logged = logged && bar != std::string_view::npos &&
             readNumber(tag.substr(0, bar), seconds) == NumberKind::kNumber && std::abs(seconds) < 1e12;

    bool whole = true;
    for (int b = 0; b < static_cast<int>(*bodies) && whole; ++b) {
      // Some programs leave out the absent bodies at the end of a row.
      const bool ends = reader.count() <= column || (reader.count() == column + 1 && reader.field(column).empty());
      if (ends) break;
      const std::string_view present = reader.field(column);
      if (present == "0") {
        ++column;
        continue;
      }
      if (present != "1") return reader.badField(column, fmt::format("body {}", b + 1), "0 (absent) or 1");
      constexpr std::size_t kBody = 2 + 4 * kSensorJointCount;
      if (reader.count() < column + kBody) {
        whole = false;
        break;
      }
      SensorSkeleton body;
      for (std::size_t j = 0; j < kSensorJointCount; ++j) {
        const std::size_t first = column + 2 + 4 * j;
        const auto called = [&](std::string_view what) {
          return fmt::format("body {}, joint {}{}", b + 1, j + 1, what);
        };
        const std::optional<double> confidence = confidenceOf(reader.field(first));
        if (!confidence) return reader.badField(first, called(" state"), "0, 1 or 2");
        Result<std::optional<Vec3>> position = reader.position(first + 1, called(""), 1.0);
        if (!position) return position.error();
        body.set(static_cast<SensorJoint>(j), *position, *confidence);
      }
      raw.rows.push_back(observe(body, *tick, persons.of(reader.field(column + 1))));
      loggedSeconds.push_back(seconds);
      column += kBody;
      // The state of both hands, which some programs omit at the end of a row.
      column += std::min(kHands, reader.count() - column);
    }
    if (!whole) {
      if (reader.cutOff()) break;
      return reader.badCount(fmt::format("more: {} bodies, each 0 or 1,id,25 x (state x y z),hands", *bodies));
    }
    if (reader.count() > column + 1 || (reader.count() == column + 1 && !reader.field(column).empty())) {
      return reader.badField(column, "after the bodies", "the row to end here");
    }
  }
  if (raw.rows.empty()) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: found no body, expected at least one", file)};
  }
  if (otherRows > 0) raw.notes.push_back(fmt::format("{} rows of other kinds than kb were skipped.", otherRows));
  chooseClock(raw, logged ? loggedSeconds : std::vector<double>());
  return raw;
}

Result<RawStream> parseKinect2Wide(std::string_view text, std::string_view file) {
  RawStream raw;
  RowReader reader(text, file);
  PersonNumbers persons;
  if (!reader.next())
    return Error{ErrorCode::kBadFormat, fmt::format("{}: found an empty file, expected a header", file)};
  const Result<WideHeader> header = readWideHeader(reader);
  if (!header) return header.error();
  bool torn = false;
  while (reader.next()) {
    const std::size_t columns = header->columns.size();
    if (reader.count() > columns && reader.delimiter() == Delimiter::kComma && repairWideRow(reader, *header))
      torn = true;
    if (!reader.fit(columns)) {
      if (reader.cutOff()) break;
      return reader.badCount(fmt::format("{} as in the header", columns));
    }
    const Result<double> time = reader.number(header->timeColumn, "time", kLargestTick);
    if (!time) return time.error();
    SensorSkeleton body;
    for (const WideHeader::Group& group : header->groups) {
      std::optional<SensorJoint> joint = group.joint;
      if (!joint) joint = sensorJointNamed(reader.field(group.nameColumn));
      if (!joint) return reader.badField(group.nameColumn, "Joint", "the name of a Kinect joint");
      double confidence = 1.0;
      if (group.statusColumn != kNoColumn) {
        const std::optional<double> status = confidenceOf(reader.field(group.statusColumn));
        if (!status) return reader.badField(group.statusColumn, "Status", "TRACKED, INFERRED or NOTTRACKED");
        confidence = *status;
      }
      Vec3 position = Vec3::Zero();
      bool missing = false;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t column = group.positionColumn[axis];
        double value = 0.0;
        const NumberKind kind = readNumber(reader.field(column), value);
        if (kind == NumberKind::kBad) return reader.badField(column, "Position", "a number");
        if (kind == NumberKind::kNumber && std::abs(value) > kLargestCoordinate) {
          return reader.badField(column, "Position", "metres within +-40");
        }
        missing = missing || kind == NumberKind::kMissing;
        position[static_cast<Eigen::Index>(axis)] = value;
      }
      const bool seen = !missing && position != Vec3::Zero();
      body.set(*joint, seen ? std::optional<Vec3>(position) : std::nullopt, confidence);
    }
    const int person = header->personColumn == kNoColumn ? 1 : persons.of(reader.field(header->personColumn));
    raw.rows.push_back(observe(body, *time, person));
  }
  if (raw.rows.empty()) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: found a header and no rows, expected at least one", file)};
  }
  if (torn) raw.notes.emplace_back("Numbers split at decimal commas were rejoined.");
  return raw;
}

Result<RawStream> parseKinect1Long(std::string_view text, std::string_view file) {
  // A smaller group carries no information and would let a small file expand into many frames.
  constexpr std::ptrdiff_t kFewestJoints = 3;
  RawStream raw;
  RowReader reader(text, file);
  if (!reader.next())
    return Error{ErrorCode::kBadFormat, fmt::format("{}: found an empty file, expected a header", file)};
  std::size_t timeColumn = kNoColumn;
  std::size_t jointColumn = kNoColumn;
  std::size_t stateColumn = kNoColumn;
  std::array<std::size_t, 3> positionColumn{kNoColumn, kNoColumn, kNoColumn};
  const std::size_t columns = reader.count();
  for (std::size_t c = 0; c < columns; ++c) {
    const std::string name = plainName(reader.field(c));
    if (name.starts_with("time")) timeColumn = c;
    if (name.starts_with("time(ms)")) raw.secondsPerTick = 1e-3;
    if (name.starts_with("time(s)")) raw.secondsPerTick = 1.0;
    if (name == "jointtype" || name == "joint") jointColumn = c;
    if (name == "trackingstate" || name == "status" || name == "state") stateColumn = c;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (name == std::string(1, "xyz"[axis]) || name == std::string("position") + "xyz"[axis])
        positionColumn[axis] = c;
    }
  }
  for (const std::size_t c : {timeColumn, jointColumn, positionColumn[0], positionColumn[1], positionColumn[2]}) {
    if (c == kNoColumn) return reader.fail("found another header, expected the columns Time, JointType, X, Y and Z");
  }
  const bool inOrder = jointColumn < positionColumn[0] && positionColumn[1] == positionColumn[0] + 1 &&
                       positionColumn[2] == positionColumn[0] + 2 && columns == positionColumn[0] + 3;

  PersonTracks tracks;
  SensorSkeleton body;
  std::bitset<kSensorJointCount> named;
  std::optional<double> groupTime;
  std::size_t incomplete = 0;
  std::size_t tooFew = 0;
  const auto endGroup = [&] {
    const std::ptrdiff_t seen =
        std::count_if(body.confidence.begin(), body.confidence.end(), [](double c) { return c > 0.0; });
    if (named.none()) return;
    if (named.count() < kKinect1JointCount) ++incomplete;
    if (seen >= kFewestJoints) {
      Observation row = observe(body, *groupTime, 1);
      row.frame.user = tracks.personAt(*groupTime, row.frame);
      raw.rows.push_back(std::move(row));
    } else {
      ++tooFew;
    }
    body = {};
    named.reset();
  };
  while (reader.next()) {
    if (reader.count() > columns && reader.delimiter() == Delimiter::kComma && inOrder) {
      // "12,5,Head,0,1,0,2,2,5": three numbers follow the name.
      const std::span<const std::string_view> tokens = reader.fields();
      std::size_t word = 0;
      while (word < tokens.size() && !isWord(tokens[word])) ++word;
      const std::size_t between = positionColumn[0] - jointColumn;
      const auto before = joinDecimalCommas(tokens.first(word), jointColumn);
      if (before && word + between < tokens.size()) {
        if (const auto after = joinDecimalCommas(tokens.subspan(word + between), 3)) {
          std::vector<std::string_view> repaired = *before;
          for (std::size_t i = word; i < word + between; ++i) repaired.push_back(tokens[i]);
          repaired.insert(repaired.end(), after->begin(), after->end());
          reader.replaceFields(std::move(repaired));
        }
      }
    }
    if (!reader.fit(columns)) {
      if (reader.cutOff()) break;
      return reader.badCount(fmt::format("{} as in the header", columns));
    }
    const Result<double> time = reader.number(timeColumn, "Time", kLargestTick);
    if (!time) return time.error();
    const std::optional<SensorJoint> joint = sensorJointNamed(reader.field(jointColumn));
    if (!joint) return reader.badField(jointColumn, "JointType", "the name of a Kinect joint");
    double confidence = 1.0;
    if (stateColumn != kNoColumn) {
      const std::optional<double> state = confidenceOf(reader.field(stateColumn));
      if (!state) return reader.badField(stateColumn, "TrackingState", "Tracked, Inferred or NotTracked");
      confidence = *state;
    }
    Vec3 position = Vec3::Zero();
    bool missing = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double value = 0.0;
      const NumberKind kind = readNumber(reader.field(positionColumn[axis]), value);
      const std::string name(1, "XYZ"[axis]);
      if (kind == NumberKind::kBad) return reader.badField(positionColumn[axis], name, "a number");
      if (kind == NumberKind::kNumber && std::abs(value) > kLargestCoordinate) {
        return reader.badField(positionColumn[axis], name, "metres within +-40");
      }
      missing = missing || kind == NumberKind::kMissing;
      position[static_cast<Eigen::Index>(axis)] = value;
    }
    const std::size_t which = static_cast<std::size_t>(*joint);
    // The same joint again at the same time belongs to another person, or is a duplicate.
    if (groupTime && (*time != *groupTime || named[which])) endGroup();
    groupTime = *time;
    named.set(which);
    body.set(*joint, missing || position == Vec3::Zero() ? std::optional<Vec3>() : position, confidence);
  }
  if (groupTime) endGroup();
  if (raw.rows.empty()) {
    return Error{
        ErrorCode::kBadFormat,
        fmt::format("{}: found no time with at least 3 joints, expected rows of Time, JointType, X, Y, Z", file)};
  }
  if (incomplete > 0) {
    raw.notes.push_back(fmt::format("{} frames have fewer than 20 joints{}.", incomplete,
                                    tooFew > 0 ? fmt::format("; {} with fewer than 3 were omitted", tooFew) : ""));
  }
  return raw;
}

}  // namespace lorica::joints
