#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

/// Finds the fields of a row: by the table, or by the names in a header.
namespace lorica::joints {
namespace {

constexpr int kMaxJoints = 64;

struct Unit {
  std::string_view words;
  double value;  ///< [m], [s]
};
constexpr std::array<Unit, 3> kLengths = {{{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}}};
constexpr std::array<Unit, 5> kTimes = {{{"s sec secs seconds sek sekunden", 1.0},
                                         {"ms msec millis milliseconds millisekunden", 1e-3},
                                         {"us usec micros microseconds", 1e-6},
                                         {"ns nsec nanoseconds", 1e-9},
                                         {"100ns", 1e-7}}};

struct Words {
  char field;  ///< as in Layout
  std::string_view words;
};
/// What follows a joint's name, or stands before it.
constexpr std::array<Words, 6> kFields = {{
    {'s', "trackingstate state status"},
    {'c', "confidencelevel confidence conf visibility vis likelihood probability prob score tracked"},
    {'x', "x"},
    {'y', "y"},
    {'z', "z"},
    {'c', "v"},
}};
/// Columns without a joint in their names.
constexpr std::array<Words, 4> kAlone = {{
    {'j',
     "joint jointtype jointname jointid jointindex jointidx jointnumber jointno landmark landmarkname landmarkid "
     "landmarkindex landmarkidx landmarknumber keypoint keypointname keypointid keypointindex keypointidx bodypart"},
    {'q', "rotationw rotationx rotationy rotationz"},
    {'n', "frame frameid framenumber frameno framenum frameindex frameidx"},
    {'u',
     "bodyid skeletonid trackingid trackid userid user personid personindex person playerid player subjectid subject "
     "poseid bodyindex body skeleton skeletonindex userindex actor id"},
}};
/// What programs put around a joint's name.
constexpr std::string_view kAround =
    "world pose landmarks landmark jointtype joints joint keypoints keypoint kpt kp lm skeleton body marker position "
    "pos location translation coordinate coord camera sensor 3d";

/// What a header calls a column.
struct Name {
  char field = 0;  ///< as in Layout; 0: none of them
  std::optional<SensorJoint> joint = {};
  int number = -1;  ///< of the joint, if it has no name
  bool world = false, landmark = false;
  std::optional<double> unit = {};  ///< [m], [s], if the name holds one: "head_x[mm]", "time_us"
};

/// Finds the joint in the rest of a name. @return false if there is another word; the rest may be empty
bool findJoint(std::string_view rest, Name& name) {
  while (!rest.empty()) {
    if (rest.size() <= 2 && std::all_of(rest.begin(), rest.end(), [](char c) { return c >= '0' && c <= '9'; })) {
      name.number = rest.size() == 1 ? rest[0] - '0' : 10 * (rest[0] - '0') + rest[1] - '0';
      return true;
    }
    name.joint = sensorJointCalled(rest);
    if (name.joint) return true;
    const std::string_view around =
        firstWord(kAround, [&](std::string_view word) { return rest.starts_with(word) || rest.ends_with(word); });
    if (around.empty()) return false;
    name.world = name.world || around == "world";
    name.landmark = name.landmark || around.starts_with("landmark") || around == "pose" || around == "lm";
    rest = rest.starts_with(around) ? rest.substr(around.size()) : rest.substr(0, rest.size() - around.size());
  }
  return true;
}

Name nameOf(std::string_view column) {
  constexpr std::size_t kLongestName = 100;  // of a joint in any log; what is longer would be searched again and again
  if (column.size() > kLongestName) return {};
  std::string whole = plainName(column);
  Name name;
  for (const Words& alone : kAlone) {
    if (!firstWord(alone.words, [&](std::string_view word) { return whole == word; }).empty()) return {alone.field};
  }
  if (const std::optional<double> unit = unitOfTime(whole)) {
    return {.field = 't', .unit = *unit > 0.0 ? unit : std::nullopt};
  }
  std::string_view plain = whole;
  for (const Unit& length : kLengths) {
    if (!plain.ends_with(length.words) || plain.size() == length.words.size()) continue;
    const char axis = plain[plain.size() - length.words.size() - 1];
    if ((axis < 'x' || axis > 'z') && length.words == "m") continue;
    plain.remove_suffix(length.words.size());
    name.unit = length.value;
    break;
  }
  for (const bool behind : {true, false}) {
    for (const Words& field : kFields) {
      Name found;
      const auto fits = [&](std::string_view word) {
        if (behind ? !plain.ends_with(word) : !plain.starts_with(word)) return false;
        found = {.field = field.field, .unit = name.unit};
        const std::string_view rest = behind ? plain.substr(0, plain.size() - word.size()) : plain.substr(word.size());
        return findJoint(rest, found) && (behind || found.joint || found.number >= 0);
      };
      if (!firstWord(field.words, fits).empty()) return found;
    }
  }
  return {};
}

bool hasPosition(const JointColumns& columns) {
  return columns.position[0] || columns.position[1];
}

/// The columns of a header, by what their names say.
struct Header {
  Columns columns;
  std::vector<JointColumns> named, world, numbered, unnamed;
  bool landmarks = false;  ///< numbers are of landmarks
  std::string fields;      ///< of the columns without a joint
  std::vector<std::optional<double>> units;
  std::optional<Error> problem;
};

/// Puts numbered joints in the order of the sensor that numbers as many.
void nameNumbered(Header& header) {
  std::vector<JointColumns>& numbered = header.numbered;
  if (numbered.empty()) return;
  std::set<int> numbers;
  for (const JointColumns& columns : numbered) numbers.insert(columns.number);
  const Numbering numbering = numberingOf(numbers, header.landmarks);
  if (numbering.order.joints.empty()) return;
  for (JointColumns& columns : numbered) {
    columns.joint = numbering.jointOf(columns.number);
    if (columns.joint != SensorJoint::kOther) header.named.push_back(std::move(columns));
  }
  header.columns.notes.push_back(
      fmt::format("The columns number joints: they were taken in {}'s order.", numbering.order.sensor));
}

/// In files without ankles the joint at the end of the leg is called foot.
void nameAnkles(std::vector<JointColumns>& joints) {
  const auto has = [&](SensorJoint joint) {
    return std::any_of(joints.begin(), joints.end(), [&](const auto& j) { return j.joint == joint; });
  };
  using enum SensorJoint;
  if (has(kAnkleLeft) || has(kAnkleRight)) return;
  for (JointColumns& columns : joints) {
    if (columns.joint == kFootLeft) columns.joint = kAnkleLeft;
    if (columns.joint == kFootRight) columns.joint = kAnkleRight;
  }
}

Result<void> checkNamed(const RowReader& row, const std::vector<std::optional<double>>& units, Columns& columns) {
  std::optional<Column> first;
  for (const JointColumns& joint : columns.joints) {
    for (const Column& axis : joint.position) {
      if (!axis) continue;
      if (!first) first = axis;
      if (units[axis.at] != units[first->at]) return row.badField(axis.at, axis.called, "one unit of length");
    }
  }
  if (first) columns.unit = units[first->at];
  for (const JointColumns& joint : columns.joints) {
    if (joint.lacks() < 0) continue;
    return row.fail(fmt::format("found '{}' without {}, expected x, y and z of each joint",
                                joint.position[joint.lacks() == 0 ? 1 : 0].called, "xyz"[joint.lacks()]));
  }
  if (countOf(columns.joints) >= kFewestNamedJoints) return {};
  return row.fail(fmt::format("found a header that names {}, expected at least {}",
                              counted(std::ssize(columns.joints), "joint"), kFewestNamedJoints));
}

Result<void> checkWide(const RowReader& row, const Columns& columns) {
  if (!columns.time) return row.fail("found a header without a Time column, expected one");
  if (columns.joints.size() < 2) {
    return row.fail("found a header without PositionX columns, expected one for each joint");
  }
  for (int g = 0; g < countOf(columns.joints); ++g) {
    const JointColumns& joint = columns.joints[g];
    if (!joint.name) {
      return row.fail(fmt::format("found no Joint column for joint {}, expected one for each joint", g + 1));
    }
    if (joint.lacks() < 0) continue;
    return row.fail(fmt::format("found no Position{} column for joint {}, expected one for each joint",
                                "XYZ"[joint.lacks()], g + 1));
  }
  return {};
}

/// Which columns may be torn at decimal commas: in wide rows all but the joints' names and states; in long rows the
/// numbers before the name and the position, if they are all there is.
void findTorn(std::string_view fields, Columns& columns) {
  if (columns.kind == JointFormat::kKinect2Wide) {
    for (int c = 0; c < columns.count; ++c)
      columns.torn[c] = std::string_view("xyzq").find(fields[c]) != std::string_view::npos;
    return;
  }
  if (columns.kind != JointFormat::kKinect1Long) return;
  const int name = columns.joints[0].name.at;
  const auto& [x, y, z] = columns.joints[0].position;
  const bool inOrder = 0 < name && name < x.at && y.at == x.at + 1 && z.at == x.at + 2 && columns.count == x.at + 3;
  for (int c = 0; c < columns.count; ++c) columns.torn[c] = inOrder && (c < name || c >= x.at);
}

/// What the columns are; a column that may be read in two ways is a problem.
Header headerOf(const RowReader& row) {
  Header header;
  Columns& columns = header.columns;
  columns.count = row.count();
  std::map<std::string, int> timesSeen;
  const auto ofJoint = [](std::vector<JointColumns>& all, std::optional<SensorJoint> joint, int number) {
    const auto isIt = [&](const JointColumns& j) { return j.joint == joint && j.number == number; };
    const auto at = std::find_if(all.begin(), all.end(), isIt);
    return at != all.end() ? &*at : &all.emplace_back(JointColumns{joint, number});
  };
  for (int c = 0; c < columns.count; ++c) {
    const Name name = nameOf(row.field(c));
    const bool unnamed = !name.joint && name.number < 0;
    header.fields += unnamed && name.field != 0 ? name.field : ' ';
    header.units.push_back(name.unit);
    const Column column{c, std::string(row.field(c))};
    if (name.field == 't' && (!columns.time || (name.unit && !columns.tick))) {
      columns.time = {c, "time"};
      columns.tick = name.unit;
    }
    if (name.field == 'n' && !columns.frame) columns.frame = {c, "frame"};
    if (name.field == 'u' && !columns.person) columns.person = column;
    if (std::string_view("sjcxyz").find(name.field) == std::string_view::npos || name.joint == SensorJoint::kOther)
      continue;
    JointColumns* joint = nullptr;
    if (name.joint) {
      joint = ofJoint(name.world ? header.world : header.named, name.joint, -1);
    } else if (name.number >= 0) {
      joint = ofJoint(header.numbered, {}, name.number);
      header.landmarks = header.landmarks || name.landmark;
    } else {
      const int index = timesSeen[plainName(row.field(c))]++;
      if (index >= kMaxJoints) continue;
      if (index >= countOf(header.unnamed)) header.unnamed.resize(index + 1);
      joint = &header.unnamed[index];
    }
    if (name.field == 'j') joint->name = column;
    if (name.field == 's' && unnamed) joint->state = column;
    if ((name.field == 'c' || (name.field == 's' && !unnamed)) && !joint->confidence) joint->confidence = column;
    if (name.field < 'x') continue;
    Column& axis = joint->position[name.field - 'x'];
    if (axis && !unnamed && !header.problem) header.problem = row.badField(c, axis.called, "one column for this");
    axis = column;
  }
  nameNumbered(header);
  // Rows of positions that nothing else names: "frame, id, x, y, z".
  const bool rows = header.unnamed.size() == 1 && hasPosition(header.unnamed[0]) && !header.unnamed[0].name;
  if (rows && header.named.empty() && sameWord(columns.person.called, "id"))
    header.unnamed[0].name = std::exchange(columns.person, {});
  for (std::vector<JointColumns>* all : {&header.named, &header.world}) {
    std::erase_if(*all, [](const JointColumns& j) { return !hasPosition(j); });
  }
  std::erase_if(header.unnamed, [](const JointColumns& j) { return !hasPosition(j) && !j.name; });
  const int named = countOf(header.named) + countOf(header.world);
  const bool naming = !header.unnamed.empty() && header.unnamed[0].name && hasPosition(header.unnamed[0]);
  columns.kind = named >= kFewestNamedJoints || !naming ? JointFormat::kNamedColumns
                 : header.unnamed.size() > 1            ? JointFormat::kKinect2Wide
                                                        : JointFormat::kKinect1Long;
  return header;
}

}  // namespace

std::optional<double> unitOfTime(std::string_view plain) {
  const auto unitOf = [](std::string_view word) -> std::optional<double> {
    if (word.empty()) return 0.0;
    for (const Unit& unit : kTimes) {
      if (!firstWord(unit.words, [&](std::string_view known) { return known == word; }).empty()) return unit.value;
    }
    return std::nullopt;
  };
  for (const std::string_view word : {"timestamp", "timespan", "datetime", "time", "elapsed", "clock", "zeitstempel",
                                      "zeit", "temps", "tiempo", "tempo"}) {
    const std::size_t at = plain.rfind(word);
    if (at == std::string_view::npos) continue;
    return plain == "timestamps" ? 0.0 : unitOf(plain.substr(at + word.size()));  // many, or in seconds
  }
  if (plain == "t" || plain == "ts") return 0.0;
  if (plain.size() > 2 && plain.starts_with('t') && unitOf(plain.substr(1))) return unitOf(plain.substr(1));
  return plain.size() > 1 ? unitOf(plain) : std::nullopt;
}

int JointColumns::lacks() const {
  for (int axis = 0; axis < 3; ++axis) {
    if (!position[axis]) return axis;
  }
  return -1;
}

Columns columnsOf(const Layout& layout, bool withMore) {
  const std::string fields = std::string(layout.fields) + std::string(withMore ? layout.more : "");
  Columns columns;
  columns.kind = layout.format;
  columns.count = layout.count(withMore);
  columns.tick = layout.tick;
  for (int c = 0; c < countOf(layout.before); ++c) {
    const char field = layout.before[c];
    (field == 'u' ? columns.person : columns.time) = {c, field == 'u' ? "user" : field == 'n' ? "frame" : "time"};
  }
  for (int j = 0; j < countOf(layout.order); ++j) {
    JointColumns& joint = columns.joints.emplace_back(JointColumns{layout.order[j]});
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
  return columns;
}

std::optional<JointFormat> kindOfHeader(const RowReader& row) {
  const Header header = headerOf(row);
  const JointFormat kind = header.columns.kind;
  const bool named = kind == JointFormat::kNamedColumns;
  const bool timed = header.columns.time || (header.columns.frame && kind == JointFormat::kKinect1Long);
  if (named ? std::max(header.named.size(), header.world.size()) < kFewestNamedJoints : !timed) return std::nullopt;
  return kind;
}

Result<Columns> columnsOf(const RowReader& row, JointFormat kind) {
  Header header = headerOf(row);
  if (header.problem) return *header.problem;
  Columns columns = std::move(header.columns);
  columns.kind = kind;
  columns.torn.resize(columns.count);
  if (kind == JointFormat::kNamedColumns) {
    // Of two positions of each joint, those in the world are measured and those in the image are not.
    const bool world = countOf(header.world) >= kFewestNamedJoints;
    columns.joints = world ? header.world : header.named;
    for (JointColumns& joint : columns.joints) {
      for (const JointColumns& other : header.named) {
        if (!joint.confidence && other.joint == joint.joint) joint.confidence = other.confidence;
      }
    }
    LORICA_TRY_DO(checkNamed(row, header.units, columns));
    nameAnkles(columns.joints);
    return columns;
  }
  columns.joints = std::move(header.unnamed);
  if (kind == JointFormat::kKinect2Wide) {
    LORICA_TRY_DO(checkWide(row, columns));
  } else {
    const bool usual = columns.joints.size() == 1 && columns.joints[0].name && columns.joints[0].lacks() < 0;
    if (!usual || !(columns.time || columns.frame)) {
      return row.fail("found another header, expected the columns Time, JointType, X, Y and Z");
    }
  }
  findTorn(header.fields, columns);
  return columns;
}

}  // namespace lorica::joints
