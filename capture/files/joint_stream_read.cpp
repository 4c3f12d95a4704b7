#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <set>
#include <utility>

/// Reads the rows of every layout.
namespace lorica::joints {
namespace {

/// Larger numbers are not times in any unit; differences of smaller ones are still exact integers.
constexpr double kLargestTick = 1e18;

Error badField(const RowReader& row, const Column& column, std::string_view expected, int from = 0,
               std::string_view owner = {}) {
  return row.badField(from + column.at, fmt::format("{}{}", owner, column.called), expected);
}

/// Parses "Tracked", "INFERRED", "NotTracked", Azure Kinect's levels, or the numbers 2, 1, 0.
std::optional<double> confidenceOf(std::string_view state) {
  const auto is = [&](auto... words) { return (sameWord(state, words) || ...); };
  if (is("2", "tracked", "medium", "high")) return 1.0;
  if (is("1", "inferred", "low")) return 0.5;
  if (is("0", "nottracked", "not_tracked", "not tracked", "none")) return 0.0;
  return std::nullopt;
}

/// Three fields times the layout's unit; none if one is missing or all are 0: sensors write both for joints that they
/// do not see.
Result<std::optional<Vec3>> readPosition(const Layout& layout, const RowReader& row,
                                         const std::array<Column, 3>& columns, int from, std::string_view owner) {
  Vec3 position = Vec3::Zero();
  bool missing = false;
  for (int axis = 0; axis < 3; ++axis) {
    double value = 0.0;
    const NumberKind kind = readNumber(row.field(from + columns[axis].at), value);
    if (kind == NumberKind::kBad) return badField(row, columns[axis], "a number", from, owner);
    if (kind == NumberKind::kNumber && std::abs(value * layout.unit) > kLargestCoordinate) {
      const std::string_view what = layout.order.empty() ? "metres" : "a position";
      return badField(row, columns[axis], fmt::format("{} within +-{:g}", what, kLargestCoordinate / layout.unit), from,
                      owner);
    }
    missing = missing || kind == NumberKind::kMissing;
    position[axis] = value * layout.unit;
  }
  if (missing || position == Vec3::Zero()) return std::optional<Vec3>();
  return std::optional<Vec3>(position);
}

/// A joint's number; nullopt: a name, or no whole number.
std::optional<int> jointNumberIn(std::string_view field) {
  constexpr double kLargest = 99.0;
  double number = 0.0;
  const bool known = readNumber(field, number) == NumberKind::kNumber && number >= 0.0 && number <= kLargest &&
                     number == std::floor(number);
  return known ? std::optional(static_cast<int>(number)) : std::nullopt;
}

/// @param from   column that the joint's columns count from
/// @param owner  prefix of columns in errors
Result<SensedJoint> readJoint(const Layout& layout, const RowReader& row, const JointColumns& columns, int from = 0,
                              std::string_view owner = {}) {
  std::optional<SensorJoint> joint = columns.joint;
  if (!joint) {
    const std::string_view name = row.field(columns.name.at);
    const std::optional<int> number = jointNumberIn(name);
    joint = number ? columns.numbering.jointOf(*number) : sensorJointCalled(name);
  }
  if (!joint) return badField(row, columns.name, "the name of a Kinect joint");
  SensedJoint read{*joint, {}, 1.0, {}};
  if (columns.state) {
    const std::optional<double> state = confidenceOf(row.field(from + columns.state.at));
    if (!state) return badField(row, columns.state, layout.states, from, owner);
    read.confidence = *state;
  }
  LORICA_TRY(read.position, readPosition(layout, row, columns.position, from, owner));
  if (columns.confidence) {
    constexpr double kPercents = 100.0;
    std::string_view field = row.field(columns.confidence.at);
    const bool mayBeState = !layout.states.empty();
    if (mayBeState && field.ends_with('%')) field.remove_suffix(1);
    const bool number = readNumber(field, read.confidence) == NumberKind::kNumber;
    if (const auto state = number || !mayBeState ? std::nullopt : confidenceOf(field)) {
      read.confidence = *state;
    } else if (!number || read.confidence < 0.0 || read.confidence > (mayBeState ? kPercents : 1.0)) {
      return badField(row, columns.confidence, mayBeState ? layout.states : "a confidence from 0 to 1");
    }
    // Joints that MSR Action3D's sensor derives from others, such as the neck, have 0 although their position is right.
    if (layout.format == JointFormat::kMsrAction3d) read.confidence = read.confidence >= 0.5 ? 1.0 : 0.5;
  }
  if (!columns.turn || !read.position || read.confidence <= 0.0) return read;
  Quat q = Quat::Identity();
  bool whole = true;
  for (int i = 0; i < 4; ++i) {
    const NumberKind kind = readNumber(row.field(columns.turn.at + i), q.coeffs()[i]);
    if (kind == NumberKind::kBad) {
      return badField(row, {columns.turn.at + i, fmt::format("{}{}", columns.turn.called, "xyzw"[i])}, "a number");
    }
    whole = whole && kind == NumberKind::kNumber;
  }
  const double length = q.coeffs().stableNorm();
  if (!whole || !(std::abs(length - 1.0) < 0.05)) return read;
  q.coeffs() /= length;
  read.orientation = q;
  return read;
}

/// Whether frames usually follow each other as those of a sensor do: between 2 and 200 of them per second.
bool isPlausibleClock(std::span<const double> times, double secondsPerTick) {
  std::vector<double> steps;
  for (int i = 1; i < countOf(times); ++i) {
    if (times[i] != times[i - 1]) steps.push_back(std::abs(times[i] - times[i - 1]) * secondsPerTick);
  }
  if (steps.empty()) return false;
  const auto middle = steps.begin() + countOf(steps) / 2;
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
  if (raw.rows.size() < 2 || isPlausibleClock(ticks, *raw.secondsPerTick)) return;
  raw.secondsPerTick.reset();  // the unit is guessed from the time steps
  if (!isPlausibleClock(loggedSeconds, 1.0)) return;
  raw.secondsPerTick = 1.0;
  for (int i = 0; i < countOf(raw.rows); ++i) raw.rows[i].frame.time = loggedSeconds[i];
  raw.notes.emplace_back(
      "The sensor's time does not advance like one in 100 ns: the seconds before |kb were used instead.");
}

/// Rejoins numbers that were split at decimal commas: every run of numbers ends at the position of the next word.
bool repairRow(RowReader& row, const Columns& header) {
  if (row.count() <= header.count || row.delimiter() != Delimiter::kComma) return false;
  const std::span<const std::string_view> tokens = row.fields();
  std::vector<std::string_view> repaired;
  repaired.reserve(header.count);
  int token = 0;
  for (int c = 0; c < header.count;) {
    if (!header.torn[c]) {
      if (token == countOf(tokens)) return false;
      repaired.push_back(tokens[token++]);
      ++c;
      continue;
    }
    const int first = c, firstToken = token;
    while (c < header.count && header.torn[c]) ++c;
    while (token < countOf(tokens) && !isWord(tokens[token])) ++token;
    const auto numbers = joinDecimalCommas(tokens.subspan(firstToken, token - firstToken), c - first);
    if (!numbers) return false;
    repaired.insert(repaired.end(), numbers->begin(), numbers->end());
  }
  if (token != countOf(tokens)) return false;
  row.replaceFields(std::move(repaired));
  return true;
}

/// Finds in which order the rows below a header number joints, if they do.
void findNumbering(std::string_view text, std::string_view file, Columns& columns) {
  if (columns.kind == JointFormat::kNamedColumns) return;
  std::set<int> numbers;
  bool landmarks = false;
  RowReader row(text, file);
  for (bool below = false; row.next(); below = true) {
    if (!below) continue;
    repairRow(row, columns);
    if (!row.fit(columns.count)) continue;
    for (const JointColumns& joint : columns.joints) {
      if (!joint.name) continue;
      const std::optional<int> number = jointNumberIn(row.field(joint.name.at));
      if (!number) return;  // names
      numbers.insert(*number);
      landmarks = landmarks || plainName(joint.name.called).find("landmark") != std::string::npos;
    }
  }
  Numbering numbering = numberingOf(numbers, landmarks);
  if (numbering.order.joints.empty()) numbering = numberingOf(numbers, true);  // some of MediaPipe's
  if (numbering.order.joints.empty()) return;
  for (JointColumns& joint : columns.joints) joint.numbering = numbering;
  columns.notes.push_back(
      fmt::format("The rows number joints: they were taken in {}'s order.", numbering.order.sensor));
}

/// A row's time: a number, or a time of day, which is in seconds.
Result<double> readTime(const RowReader& row, const Columns& columns, bool& isClock) {
  const std::optional<double> clock = readClock(row.field(columns.time.at));
  isClock = isClock || clock.has_value();
  if (clock) return *clock;
  return row.number(columns.time.at, columns.time.called, kLargestTick);
}

/// Reads the rows below a header, or all rows.
Result<RawStream> readAll(const Layout& layout, Columns columns, RowReader& row, std::string_view file) {
  const bool fixed = !layout.order.empty(), longRows = layout.format == JointFormat::kKinect1Long;
  const bool wide = layout.format == JointFormat::kKinect2Wide, named = layout.format == JointFormat::kNamedColumns;
  const bool tellPeople = layout.before == "n" || (longRows && !columns.person);
  const int jointsPerRow = countOf(columns.joints) / layout.rowsPerFrame;
  RawStream raw;
  raw.secondsPerTick = columns.tick;
  raw.notes = std::move(columns.notes);
  if (!layout.note.empty()) raw.notes.emplace_back(layout.note);
  if (!columns.time) columns.time = std::exchange(columns.frame, {});
  const bool frames = columns.time.called == "frame";
  PersonNumbers persons;
  PersonTracks tracks;
  SensorSkeleton body;
  std::bitset<kSensorJointCount> seen;
  double time = 0.0;
  int user = 1;
  int joint = 0;  // that the next row starts with
  int incomplete = 0, tooFew = 0;
  bool torn = false, cut = false, isClock = false;
  const auto endFrame = [&] {
    if (named || body[SensorJoint::kNose].confidence > 0.0) body.complete();
    SkeletonFrame& frame = raw.rows.emplace_back(observe(body, time, user)).frame;
    if (tellPeople) frame.user = tracks.personAt(time, frame);
    if (longRows || named) body = {};
  };
  const auto endGroup = [&] {
    if (seen.none()) return;
    if (seen.count() < kKinect1JointCount) ++incomplete;
    seen.reset();
    const auto isSeen = [](const TrackedJoint& j) { return j.confidence > 0.0; };
    if (std::count_if(body.joints.begin(), body.joints.end(), isSeen) >= kFewestSeenJoints) return endFrame();
    ++tooFew;
    body = {};
  };
  do {
    if (!fixed) torn = repairRow(row, columns) || torn;
    if (!row.fit(columns.count)) {
      cut = row.cutOff() && (!fixed || row.count() < columns.count);
      if (cut) break;
      if (!fixed) return row.badCount(fmt::format("{} as in the header", columns.count));
      return row.badCount(columns.count > layout.count() ? layout.expectedRowWithMore : layout.expectedRow);
    }
    double now = static_cast<double>(raw.rows.size());
    if (columns.time) {
      LORICA_TRY(now, readTime(row, columns, isClock));
      if (fixed && frames && now != std::floor(now)) return row.badField(columns.time.at, "frame", "a whole number");
    }
    int owner = 1;
    if (columns.person && fixed) {
      const Result<double> read = row.number(columns.person.at, "user", 1e6);
      if (!read || *read != std::floor(*read)) {
        return row.badField(columns.person.at, "user", "a whole number within +-1e+06");
      }
      owner = static_cast<int>(*read);
    } else if (columns.person) {
      owner = persons.of(row.field(columns.person.at));
    }
    for (const int end = joint + jointsPerRow; joint < end; ++joint) {
      LORICA_TRY(const SensedJoint read, readJoint(layout, row, columns.joints[joint]));
      // The same joint again at the same time belongs to another person, or is a duplicate.
      const bool again = seen[static_cast<int>(read.joint)] && read.joint != SensorJoint::kOther;
      if (longRows && (now != time || owner != user || again)) endGroup();
      time = now;
      user = owner;
      seen.set(static_cast<int>(read.joint));
      body.set(read);
    }
    if (joint == countOf(columns.joints)) {
      joint = 0;
      if (!longRows) endFrame();
    }
  } while (row.next());
  if (longRows) endGroup();
  if (raw.rows.empty()) {
    return badFormat("{}: found no frame, expected {}", file, layout.expectedFile);
  }
  if (isClock) raw.secondsPerTick = 1.0;
  if (longRows && incomplete > 0) {
    raw.notes.push_back(fmt::format("{} fewer than 20 joints{}.", counted(incomplete, "frame has", "frames have"),
                                    tooFew > 0 ? fmt::format("; {} with fewer than 3 were omitted", tooFew) : ""));
  }
  if (fixed && (layout.rowsPerFrame > 1 ? joint != 0 : cut)) {
    raw.notes.push_back(fmt::format("The last frame, line {}, is truncated and was omitted.", row.line()));
  }
  if (wide && torn) raw.notes.emplace_back("Numbers split at decimal commas were rejoined.");
  if (!fixed && (!columns.time || frames) && !raw.secondsPerTick) {
    raw.secondsPerTick = 1.0 / 30.0;
    raw.notes.emplace_back("The file has no times: 30 frames per second were assumed.");
  }
  if (layout.repair != nullptr) layout.repair(raw);
  return raw;
}

}  // namespace

int PersonNumbers::of(std::string_view id) {
  constexpr std::size_t kLongestId = 40;
  const auto [entry, isNew] = numbers_.try_emplace(std::string(id.substr(0, kLongestId)), 0);
  if (isNew) entry->second = countOf(numbers_);
  return entry->second;
}

Result<RawStream> readRows(const Layout& layout, std::string_view text, std::string_view file) {
  RowReader row(text, file);
  if (!row.next()) return badFormat("{}: found an empty file, expected {}", file, layout.expectedFile);
  const bool fixed = !layout.order.empty();
  Columns columns;
  if (fixed) {
    const bool header = layout.format == JointFormat::kNite2 && isWord(row.field(0));
    if (header && !row.next()) return badFormat("{}: found no frame, expected {}", file, layout.expectedFile);
    columns = columnsOf(layout, !layout.more.empty() && !row.fit(layout.count()));
    if (header) columns.notes.emplace_back("The header was ignored: columns are assumed to be in NiTE 2's order.");
  } else {
    LORICA_TRY(columns, columnsOf(row, layout.format));
    if (!row.next()) return badFormat("{}: found a header and no rows, expected {}", file, layout.expectedFile);
    findNumbering(text, file, columns);
  }
  return readAll(layout, std::move(columns), row, file);
}

Result<RawStream> readBodies(const Layout& layout, std::string_view text, std::string_view file) {
  constexpr int kMaxBodies = 6;
  constexpr int kHands = 2;
  const int count = 2 + layout.count();  // 1, the person, the joints
  const std::vector<JointColumns> columns = columnsOf(layout).joints;
  RawStream raw;
  raw.secondsPerTick = layout.tick;
  RowReader row(text, file);
  PersonNumbers persons;
  std::vector<double> loggedSeconds;  // value before "|kb", one per row
  int otherRows = 0;
  bool logged = true;
  while (row.next()) {
    const std::string_view tag = row.field(0);
    const std::size_t bar = tag.find('|');
    if (bar != std::string_view::npos && !sameWord(tag.substr(bar + 1), "kb")) {
      ++otherRows;
      continue;
    }
    int column = 4;
    if (row.cutOff() && row.count() < column) break;
    if (row.count() < column) return row.badCount("at least 4: tag, time, 6, 25, then six bodies");
    LORICA_TRY(const double tick, row.number(1, "time", kLargestTick));
    const Result<double> bodies = row.number(2, "bodies", kMaxBodies);
    if (!bodies || *bodies < 1.0 || *bodies != std::floor(*bodies)) {
      return row.badField(2, "bodies", "the number of bodies that follow, 1 to 6");
    }
    if (row.field(3) != "25") return row.badField(3, "joints", "25 joints per body");
    double seconds = 0.0;
    logged = logged && bar != std::string_view::npos &&
             readNumber(tag.substr(0, bar), seconds) == NumberKind::kNumber && std::abs(seconds) < 1e12;

    const auto ends = [&] { return row.count() <= column || (row.count() == column + 1 && row.field(column).empty()); };
    // Some programs leave out the absent bodies at the end of a row.
    for (int b = 0; b < static_cast<int>(*bodies) && !ends(); ++b) {
      if (row.field(column) == "0") {
        ++column;
        continue;
      }
      if (row.field(column) != "1") return row.badField(column, fmt::format("body {}", b + 1), "0 (absent) or 1");
      if (row.count() < column + count) {
        if (!row.cutOff()) {
          return row.badCount(fmt::format("more: {} bodies, each 0 or 1,id,25 x (state x y z),hands", *bodies));
        }
        column = -1;
        break;
      }
      SensorSkeleton body;
      const std::string owner = fmt::format("body {}, ", b + 1);
      for (const JointColumns& joint : columns) {
        LORICA_TRY(const SensedJoint read, readJoint(layout, row, joint, column + 2, owner));
        body.set(read);
      }
      raw.rows.push_back(observe(body, tick, persons.of(row.field(column + 1))));
      loggedSeconds.push_back(seconds);
      column += count;
      // The state of both hands, which some programs omit at the end of a row.
      column += std::min(kHands, row.count() - column);
    }
    if (column < 0) break;
    if (!ends()) return row.badField(column, "after the bodies", "the row to end here");
  }
  if (raw.rows.empty()) return badFormat("{}: found no body, expected at least one", file);
  if (otherRows > 0)
    raw.notes.push_back(counted(otherRows, "row of another kind than kb was", "rows of other kinds than kb were") +
                        " skipped.");
  chooseClock(raw, logged ? loggedSeconds : std::vector<double>());
  return raw;
}

Result<RawStream> readNamed(const Layout& layout, std::string_view text, std::string_view file) {
  RowReader row(text, file);
  if (!row.next()) return badFormat("{}: found an empty file, expected a header", file);
  LORICA_TRY(const Columns columns, columnsOf(row, layout.format));
  // Kinect v1's and v2's own have their unit and axes.
  if (layout.format == JointFormat::kKinect2Wide ||
      (layout.format == JointFormat::kKinect1Long && sameWord(columns.joints[0].name.called, "JointType"))) {
    LORICA_TRY(RawStream raw, readRows(layout, text, file));
    judgeConfidences(raw.rows);
    return raw;
  }
  const auto read = [&](double unit) {
    Layout known = layout;
    known.unit = unit;
    return readRows(known, text, file);
  };
  return judged(file, columns.unit, read, layout.world);
}

}  // namespace lorica::joints
