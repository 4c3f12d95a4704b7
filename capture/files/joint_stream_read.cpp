#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <algorithm>
#include <bitset>
#include <cmath>

/// Reads the rows of every layout: those with fixed columns as the table says, the others after their header.
namespace lorica::joints {
namespace {

/// Larger numbers are not times in any unit; differences of smaller ones are still exact integers.
constexpr double kLargestTick = 1e18;

/// A column of a row, and what errors call it.
struct Column {
  int at = -1;
  std::string called = {};

  explicit operator bool() const { return at >= 0; }
};

/// The columns of one joint.
struct JointColumns {
  std::optional<SensorJoint> joint = {};  ///< none: the row names it
  Column name = {}, state = {}, confidence = {}, turn = {};
  std::array<Column, 3> position = {};

  /// The column of a field as in Layout, or nullptr if it is not used.
  [[nodiscard]] Column* of(char field) {
    if (field == 'j') return &name;
    if (field == 's') return &state;
    if (field == 'c') return &confidence;
    return field >= 'x' ? &position[field - 'x'] : nullptr;
  }
  /// The first axis without a column, or -1.
  [[nodiscard]] int lacks() const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!position[axis]) return axis;
    }
    return -1;
  }
};

Error badField(const RowReader& row, const Column& column, std::string_view expected, int from = 0,
               std::string_view owner = {}) {
  return row.badField(from + column.at, fmt::format("{}{}", owner, column.called), expected);
}

/// The columns of a frame's joints as the table has them. Rows that are parts of a frame start from column 0 each.
std::vector<JointColumns> columnsOf(const Layout& layout, bool withMore = false) {
  const std::string fields = std::string(layout.fields) + std::string(withMore ? layout.more : "");
  std::vector<JointColumns> all;
  for (int j = 0; j < countOf(layout.order); ++j) {
    JointColumns& joint = all.emplace_back(JointColumns{layout.order[j]});
    const std::string called = layout.called(j);
    int at = countOf(layout.before) + j % (countOf(layout.order) / layout.rowsPerFrame) * countOf(fields);
    for (const char field : fields) {
      if (field >= 'x') joint.position[field - 'x'] = {at, fmt::format("{} {}", called, field)};
      if (field == 's') joint.state = {at, called + " state"};
      if (field == 'c') joint.confidence = {at, layout.rowsPerFrame > 1 ? "confidence" : called + " confidence"};
      if (field == 'q' && !joint.turn) joint.turn = {at, called + " q"};
      ++at;
    }
  }
  return all;
}

/// Parses "Tracked", "INFERRED", "NotTracked", or their numbers 2, 1, 0.
std::optional<double> confidenceOf(std::string_view state) {
  const auto is = [&](auto... words) { return (sameWord(state, words) || ...); };
  if (is("2", "tracked")) return 1.0;
  if (is("1", "inferred")) return 0.5;
  if (is("0", "nottracked", "not_tracked", "not tracked")) return 0.0;
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

/// @param from   column that the joint's columns count from
/// @param owner  prefix of columns in errors
Result<SensedJoint> readJoint(const Layout& layout, const RowReader& row, const JointColumns& columns, int from = 0,
                              std::string_view owner = {}) {
  const std::optional<SensorJoint> joint = columns.joint ? columns.joint : sensorJointNamed(row.field(columns.name.at));
  if (!joint) return badField(row, columns.name, "the name of a Kinect joint");
  SensedJoint read{*joint, {}, 1.0, {}};
  if (columns.state) {
    const std::optional<double> state = confidenceOf(row.field(from + columns.state.at));
    if (!state) return badField(row, columns.state, layout.states, from, owner);
    read.confidence = *state;
  }
  LORICA_TRY(read.position, readPosition(layout, row, columns.position, from, owner));
  if (columns.confidence) {
    const std::string_view field = row.field(columns.confidence.at);
    const bool mayBeState = !layout.states.empty();
    const bool number = readNumber(field, read.confidence) == NumberKind::kNumber;
    if (const auto state = number || !mayBeState ? std::nullopt : confidenceOf(field)) {
      read.confidence = *state;
    } else if (!number || read.confidence < 0.0 || read.confidence > (mayBeState ? 2.0 : 1.0)) {
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

/// Kinect v2 gives every tracked body a new 17-digit number: people are renumbered from 1 in order of appearance.
class PersonNumbers {
 public:
  int of(std::string_view id) {
    const auto [entry, isNew] = numbers_.try_emplace(std::string(id.substr(0, kLongestId)), 0);
    if (isNew) entry->second = countOf(numbers_);
    return entry->second;
  }

 private:
  static constexpr std::size_t kLongestId = 40;
  std::map<std::string, int> numbers_;
};

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

/// What a header says.
struct Header {
  int count = 0;  ///< of columns
  Column time, person;
  std::optional<double> tick;  ///< of times [s], if a name says so
  std::optional<double> unit;  ///< of positions [m], if their names say so
  bool hasPosition = false;
  std::vector<JointColumns> joints;
  std::vector<bool> torn;  ///< of each column: whether it may be torn at a decimal comma
};

Result<void> checkHeader(const Layout& layout, const RowReader& row, const Header& header) {
  if (layout.jointPerRow) {
    const JointColumns* columns = header.joints.empty() ? nullptr : header.joints.data();
    if (header.time && columns != nullptr && columns->name && columns->lacks() < 0) return {};
    return row.fail("found another header, expected the columns Time, JointType, X, Y and Z");
  }
  if (!header.time) return row.fail("found a header without a Time column, expected one");
  for (int g = 0; g < countOf(header.joints); ++g) {
    const JointColumns& columns = header.joints[g];
    if (!columns.joint && !columns.name) {
      return row.fail(fmt::format("found no Joint column for joint {}, expected one for each joint", g + 1));
    }
    if (columns.lacks() < 0) continue;
    return row.fail(fmt::format("found no Position{} column for joint {}, expected one for each joint",
                                "XYZ"[columns.lacks()], g + 1));
  }
  if (header.joints.empty()) return row.fail("found a header without PositionX columns, expected one for each joint");
  return {};
}

/// Columns are found by name in any order. The n-th occurrence of a name without a joint in front ("PositionX") belongs
/// to the n-th joint; the row specifies which joint that is.
Result<Header> readHeader(const Layout& layout, const RowReader& row) {
  constexpr int kMaxJoints = 64;
  Header header;
  header.count = row.count();
  header.torn.resize(header.count);
  std::map<std::string, int> timesSeen;
  std::map<std::string, int> indexOf;
  for (int c = 0; c < header.count; ++c) {
    const std::string name = plainName(row.field(c));
    if (name == "skeletonid" || name == "bodyid" || name == "trackingid") header.person = {c};
    if (layout.jointPerRow ? name.starts_with("time")
                           : name == "time" || name == "timestamp" || name == "relativetime") {
      header.time = {c, layout.jointPerRow ? "Time" : "time"};
      if (name.starts_with("time(ms)")) header.tick = 1e-3;
      if (name.starts_with("time(s)")) header.tick = 1.0;
    }
    for (const NamedColumn& column : layout.header) {
      if (!std::string_view(name).ends_with(column.ending)) continue;
      const std::string owner = name.substr(0, name.size() - column.ending.size());
      const std::optional<SensorJoint> joint = sensorJointNamed(owner);
      if (!owner.empty() && (!joint || layout.jointPerRow)) continue;
      const int index = layout.jointPerRow ? 0
                        : joint            ? indexOf.try_emplace(owner, countOf(indexOf)).first->second
                                           : timesSeen[name]++;
      if (index >= kMaxJoints) return row.badField(c, name, "at most 64 joints");
      if (countOf(header.joints) <= index) header.joints.resize(index + 1);
      JointColumns& columns = header.joints[index];
      columns.joint = joint;
      header.torn[c] = column.field != 'j' && column.field != 's';
      if (Column* to = columns.of(column.field)) *to = {c, std::string(column.called)};
    }
  }
  LORICA_TRY_DO(checkHeader(layout, row, header));
  if (!layout.jointPerRow) return header;
  // Torn rows can be told apart only if the numbers before the name and the position at the end are all there is.
  const int name = header.joints[0].name.at;
  const auto& [x, y, z] = header.joints[0].position;
  const bool inOrder = 0 < name && name < x.at && y.at == x.at + 1 && z.at == x.at + 2 && header.count == x.at + 3;
  for (int c = 0; c < header.count; ++c) header.torn[c] = inOrder && (c < name || c >= x.at);
  return header;
}

/// The header of a file in which every column names its joint. What may be read in two ways is refused.
Result<Header> readJointHeader(const Layout& layout, const RowReader& row) {
  Header header;
  header.count = row.count();
  header.torn.resize(header.count);
  for (int c = 0; c < header.count; ++c) {
    const ColumnName column = columnNameOf(row.field(c));
    const auto is = [&](auto... names) { return ((column.plain == names) || ...); };
    if (is("bodyid", "skeletonid", "trackingid", "userid", "user", "personid", "person")) header.person = {c};
    if (is("frame", "frameid", "framenumber") && !header.time) header.time = {c, "frame"};
    if (is("time") && (!header.time || header.time.called == "frame")) {
      header.time = {c, "time"};
      header.tick = column.unit;
    }
    for (const NamedColumn& named : layout.header) {
      if (!column.plain.ends_with(named.ending)) continue;
      const std::optional<SensorJoint> joint =
          sensorJointCalled(column.plain.substr(0, column.plain.size() - named.ending.size()));
      if (!joint) continue;
      auto at = std::find_if(header.joints.begin(), header.joints.end(),
                             [&](const JointColumns& columns) { return columns.joint == joint; });
      if (at == header.joints.end()) at = header.joints.insert(at, {joint});
      Column& to = *at->of(named.field);
      if (to) return row.badField(c, to.called, "one column for this");
      to = {c, std::string(row.field(c))};
      if (named.field < 'x') continue;
      if (header.hasPosition && header.unit != column.unit) return row.badField(c, to.called, "one unit of length");
      header.unit = column.unit;
      header.hasPosition = true;
    }
  }
  std::erase_if(header.joints,
                [](const JointColumns& columns) { return columns.lacks() == 0 && !columns.position[1]; });
  for (const JointColumns& columns : header.joints) {
    if (columns.lacks() < 0) continue;
    return row.fail(fmt::format("found '{}' without {}, expected x, y and z of each joint",
                                columns.position[columns.lacks() == 0 ? 1 : 0].called, "xyz"[columns.lacks()]));
  }
  if (countOf(header.joints) < kFewestNamedJoints) {
    return row.fail(fmt::format("found a header that names {} joints, expected at least {}", header.joints.size(),
                                kFewestNamedJoints));
  }
  // In files without ankles the joint at the end of the leg is called foot.
  const auto has = [&](SensorJoint joint) {
    return std::any_of(header.joints.begin(), header.joints.end(), [&](const auto& j) { return j.joint == joint; });
  };
  using enum SensorJoint;
  if (has(kAnkleLeft) || has(kAnkleRight)) return header;
  for (JointColumns& columns : header.joints) {
    if (columns.joint == kFootLeft) columns.joint = kAnkleLeft;
    if (columns.joint == kFootRight) columns.joint = kAnkleRight;
  }
  return header;
}

/// The median over the frames of the largest extent of a person; 0 if at most one joint is ever seen [m].
double sizeOf(std::span<const Observation> rows) {
  std::vector<double> sizes;
  for (const Observation& row : rows) {
    Eigen::AlignedBox3d box;
    for (const TrackedJoint& joint : row.frame.joints) {
      if (joint.confidence > 0.0) box.extend(joint.position);
    }
    if (!box.isEmpty()) sizes.push_back(box.diagonal().norm());
  }
  if (sizes.empty()) return 0.0;
  const auto middle = sizes.begin() + countOf(sizes) / 2;
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

/// The sum over the frames of the vectors from the middle of hips, knees and feet to that of head, neck and shoulders.
Vec3 uprightOf(std::span<const Observation> rows) {
  using J = BodyJoint;
  constexpr std::array kUpper = {J::kHead, J::kNeck, J::kLeftShoulder, J::kRightShoulder};
  constexpr std::array kLower = {J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot};
  Vec3 upright = Vec3::Zero();
  for (const Observation& row : rows) {
    const auto middleOf = [&](std::span<const J> joints) {
      Vec3 sum = Vec3::Zero();
      double count = 0.0;
      for (const J joint : joints) {
        if (!(row.frame[joint].confidence > 0.0)) continue;
        sum += row.frame[joint].position;
        count += 1.0;
      }
      return count > 0.0 ? std::optional<Vec3>(sum / count) : std::nullopt;
    };
    const std::optional<Vec3> upper = middleOf(kUpper), lower = middleOf(kLower);
    if (upper && lower) upright += *upper - *lower;
  }
  return upright;
}

/// Rejoins numbers that were split at decimal commas: every run of numbers ends at the position of the next word.
bool repairRow(RowReader& row, const Header& header) {
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

}  // namespace

ColumnName columnNameOf(std::string_view name) {
  using Unit = std::pair<std::string_view, double>;
  constexpr std::array<Unit, 3> kLengths = {{{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}}};
  constexpr std::array<Unit, 13> kTimes = {{{"s", 1.0},
                                            {"sec", 1.0},
                                            {"seconds", 1.0},
                                            {"ms", 1e-3},
                                            {"msec", 1e-3},
                                            {"milliseconds", 1e-3},
                                            {"us", 1e-6},
                                            {"usec", 1e-6},
                                            {"microseconds", 1e-6},
                                            {"ns", 1e-9},
                                            {"nsec", 1e-9},
                                            {"nanoseconds", 1e-9},
                                            {"100ns", 1e-7}}};
  ColumnName column{plainName(name), {}};
  std::erase_if(column.plain, [](char c) { return c == '[' || c == ']' || c == '(' || c == ')'; });
  for (const std::string_view word : {"relativetime", "timestamp", "timespan", "time"}) {
    if (!column.plain.starts_with(word)) continue;
    const std::string_view rest = std::string_view(column.plain).substr(word.size());
    const auto unit = std::find_if(kTimes.begin(), kTimes.end(), [&](const Unit& u) { return u.first == rest; });
    if (unit != kTimes.end()) return {"time", unit->second};
    return {rest.empty() ? "time" : column.plain, {}};
  }
  for (const auto& [word, metres] : kLengths) {
    const std::size_t end = column.plain.size() - word.size();
    if (!column.plain.ends_with(word) || end == 0 || column.plain[end - 1] < 'x' || column.plain[end - 1] > 'z')
      continue;
    return {column.plain.substr(0, end), metres};
  }
  return column;
}

Result<RawStream> readFixedRows(const Layout& layout, std::string_view text, std::string_view file) {
  RawStream raw;
  raw.secondsPerTick = layout.tick;
  if (!layout.note.empty()) raw.notes.emplace_back(layout.note);
  RowReader row(text, file);
  PersonTracks tracks;
  SensorSkeleton body;
  std::vector<JointColumns> columns;
  bool withMore = false, cut = false;
  int joint = 0;  // that the next row starts with
  while (row.next()) {
    if (columns.empty()) {
      if (layout.format == JointFormat::kNite2 && raw.notes.empty() && isWord(row.field(0))) {
        raw.notes.emplace_back("The header was ignored: columns are assumed to be in NiTE 2's order.");
        continue;
      }
      withMore = !layout.more.empty() && !row.fit(layout.count());
      columns = columnsOf(layout, withMore);
    }
    const int count = layout.count(withMore);
    if (!row.fit(count)) {
      cut = row.cutOff() && row.count() < count;
      if (cut) break;
      return row.badCount(withMore ? layout.expectedRowWithMore : layout.expectedRow);
    }
    double time = static_cast<double>(raw.rows.size());
    int user = 1;
    for (int c = 0; c < countOf(layout.before); ++c) {
      const char field = layout.before[c];
      if (field == 'u') {
        const Result<double> read = row.number(c, "user", 1e6);
        if (!read || *read != std::floor(*read)) return row.badField(c, "user", "a whole number within +-1e+06");
        user = static_cast<int>(*read);
        continue;
      }
      LORICA_TRY(time, row.number(c, field == 'n' ? "frame" : "time", kLargestTick));
      if (field == 'n' && time != std::floor(time)) return row.badField(c, "frame", "a whole number");
    }
    for (const int end = joint + countOf(columns) / layout.rowsPerFrame; joint < end; ++joint) {
      LORICA_TRY(const SensedJoint read, readJoint(layout, row, columns[joint]));
      body.set(read);
    }
    if (joint < countOf(columns)) continue;
    joint = 0;
    Observation& observed = raw.rows.emplace_back(observe(body, time, user));
    if (layout.before == "n") observed.frame.user = tracks.personAt(time, observed.frame);
  }
  if (raw.rows.empty()) return badFormat("{}: found no frame, expected {}", file, layout.expectedFile);
  if (layout.rowsPerFrame > 1 ? joint != 0 : cut) {
    raw.notes.push_back(fmt::format("The last frame, line {}, is truncated and was omitted.", row.line()));
  }
  if (layout.repair != nullptr) layout.repair(raw);
  return raw;
}

Result<RawStream> readBodies(const Layout& layout, std::string_view text, std::string_view file) {
  constexpr int kMaxBodies = 6;
  constexpr int kHands = 2;
  const int count = 2 + layout.count();  // 1, the person, the joints
  const std::vector<JointColumns> columns = columnsOf(layout);
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
  if (otherRows > 0) raw.notes.push_back(fmt::format("{} rows of other kinds than kb were skipped.", otherRows));
  chooseClock(raw, logged ? loggedSeconds : std::vector<double>());
  return raw;
}

/// Reads the rows after a header.
Result<RawStream> readRows(const Layout& layout, const Header& header, RowReader& row, std::string_view file) {
  // A smaller frame carries no information and would let a small file expand into many frames.
  constexpr int kFewestJoints = 3;
  RawStream raw;
  raw.secondsPerTick = header.tick;
  PersonNumbers persons;
  PersonTracks tracks;
  SensorSkeleton body;
  double time = 0.0;
  std::bitset<kSensorJointCount> named;
  int incomplete = 0, tooFew = 0;
  bool torn = false;
  const auto endFrame = [&](int person) {
    raw.rows.push_back(observe(body, time, person));
    body = {};
  };
  const auto endGroup = [&] {
    if (named.none()) return;
    if (named.count() < kKinect1JointCount) ++incomplete;
    named.reset();
    const auto seen = [](const TrackedJoint& joint) { return joint.confidence > 0.0; };
    if (std::count_if(body.joints.begin(), body.joints.end(), seen) < kFewestJoints) {
      ++tooFew;
      body = {};
      return;
    }
    endFrame(1);
    SkeletonFrame& frame = raw.rows.back().frame;
    frame.user = tracks.personAt(time, frame);
  };
  while (row.next()) {
    torn = repairRow(row, header) || torn;
    if (!row.fit(header.count)) {
      if (row.cutOff()) break;
      return row.badCount(fmt::format("{} as in the header", header.count));
    }
    double now = static_cast<double>(raw.rows.size());
    if (header.time) {
      LORICA_TRY(now, row.number(header.time.at, header.time.called, kLargestTick));
    }
    for (const JointColumns& joint : header.joints) {
      LORICA_TRY(const SensedJoint read, readJoint(layout, row, joint));
      // The same joint again at the same time belongs to another person, or is a duplicate.
      if (layout.jointPerRow && (now != time || named[static_cast<int>(read.joint)])) endGroup();
      time = now;
      named.set(static_cast<int>(read.joint));
      body.set(read);
    }
    if (!layout.jointPerRow) endFrame(header.person ? persons.of(row.field(header.person.at)) : 1);
  }
  if (layout.jointPerRow) endGroup();
  if (raw.rows.empty()) return badFormat("{}: {}", file, layout.expectedFile);
  if (layout.jointPerRow && incomplete > 0) {
    raw.notes.push_back(fmt::format("{} frames have fewer than 20 joints{}.", incomplete,
                                    tooFew > 0 ? fmt::format("; {} with fewer than 3 were omitted", tooFew) : ""));
  }
  if (!layout.jointPerRow && torn) raw.notes.emplace_back("Numbers split at decimal commas were rejoined.");
  return raw;
}

Result<RawStream> readUnderHeader(const Layout& layout, std::string_view text, std::string_view file) {
  RowReader row(text, file);
  if (!row.next()) return badFormat("{}: found an empty file, expected a header", file);
  LORICA_TRY(const Header header, readHeader(layout, row));
  return readRows(layout, header, row, file);
}

Result<RawStream> readNamedColumns(const Layout& layout, std::string_view text, std::string_view file) {
  RowReader row(text, file);
  if (!row.next()) return badFormat("{}: found an empty file, expected a header", file);
  LORICA_TRY(const Header header, readJointHeader(layout, row));
  Layout known = layout;
  known.unit = header.unit.value_or(0.001);
  LORICA_TRY(RawStream raw, readRows(known, header, row, file));
  if (header.unit) raw.unit = fmt::format("{:g} m per unit, as the header says", *header.unit);
  const double size = sizeOf(raw.rows);
  if (!header.unit && size > 0.0) {
    // People measure 0.3 m, of whom only the arms are seen, to 3 m, with their arms raised.
    constexpr std::array<std::pair<double, std::string_view>, 3> kUnits = {
        {{1.0, "metres"}, {0.01, "centimetres"}, {0.001, "millimetres"}}};
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) {
      return size / known.unit * u.first >= 0.3 && size / known.unit * u.first < 3.0;
    });
    if (unit == kUnits.end()) {
      return badFormat("{}: found people who measure {:.3g}, expected joints in metres, centimetres or millimetres",
                       file, size / known.unit);
    }
    known.unit = unit->first;
    RowReader again(text, file);
    again.next();
    LORICA_TRY(raw, readRows(known, header, again, file));
    raw.unit = fmt::format("{}, since people measure {:.4g}", unit->second, size / 0.001);
  }
  if (!header.time || header.time.called == "frame") {
    raw.secondsPerTick = 1.0 / 30.0;
    raw.notes.emplace_back("The file has no times: 30 frames per second were assumed.");
  }
  // States are 0, 1 and 2, confidences at most 1.
  const auto isState = [](const Observation& observed) {
    return std::any_of(observed.frame.joints.begin(), observed.frame.joints.end(),
                       [](const auto& j) { return j.confidence > 1.0; });
  };
  if (std::any_of(raw.rows.begin(), raw.rows.end(), isState)) {
    for (Observation& observed : raw.rows) {
      for (TrackedJoint& joint : observed.frame.joints) joint.confidence *= 0.5;
    }
  }
  const Vec3 upright = uprightOf(raw.rows);
  if (!(std::abs(upright.y()) > 0.7 * upright.norm())) {
    return badFormat("{}: found no heads above or below hips along y, expected y to point up or down", file);
  }
  if (upright.y() < 0.0) {
    flip(raw.rows, {-1.0, -1.0, 1.0});  // cameras have y down and x to their right
    raw.yDown = true;
  }
  return raw;
}

}  // namespace lorica::joints
