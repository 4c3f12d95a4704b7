#include "capture/files/joint_stream.h"

#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

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

namespace lorica {
namespace {

constexpr double kStep = 1.0 / 30.0;  ///< between frames of nobody [s]
constexpr double kLost = 0.5;         ///< longest gap in which a person counts as there [s]

Result<JointStream> parseLorica(std::string_view text, std::string_view name, const JointStreamSettings& settings) {
  LORICA_TRY(auto all, parseJointCsvOfAll(text, name));
  std::map<int, joints::WayMeter> ways;
  for (const std::vector<SkeletonFrame>& its : all) {
    joints::WayMeter& meter = ways[its.front().user];
    for (const SkeletonFrame& frame : its) meter.add(frame);
  }
  JointStream stream;
  stream.firstGuess.emplace_back("metres, Y up, the floor at y = 0, as the format says");
  LORICA_TRY(const int chosen, joints::choosePerson(ways, name, settings, stream));
  for (std::vector<SkeletonFrame>& its : all) {
    if (its.front().user == chosen) stream.frames = std::move(its);
  }
  return stream;
}

/// The text without what stands before a header that names joints: lines about the recording, and the # of a comment.
/// Lines keep their numbers. nullopt: nothing stands there.
std::optional<std::string> withoutPreamble(std::string_view text, std::string_view name) {
  constexpr int kMaxLines = 20;
  if (joints::isJson(text) || joints::isMarkerTable(text)) return std::nullopt;
  std::size_t begin = 0;
  bool anything = false;
  for (int line = 0; line < kMaxLines && begin < text.size(); ++line) {
    const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
    std::string_view header = text.substr(begin, end - begin);
    const std::size_t length = header.size();
    while (!header.empty() && (header[0] == '#' || header[0] == '%' || header[0] == ' ')) header.remove_prefix(1);
    joints::RowReader row(header, name);
    if (row.next() && joints::kindOfHeader(row)) {
      if (!anything && header.size() == length) return std::nullopt;
      return std::string(line, '\n') + std::string(text.substr(end - header.size()));
    }
    anything = anything || !header.empty();
    begin = text.substr(end).starts_with("\r\n") ? end + 2 : end + 1;
  }
  return std::nullopt;
}

Result<JointFormat> formatOf(std::string_view text, std::string_view name, const JointStreamSettings& settings) {
  if (settings.format) return *settings.format;
  return unlessStopped(joints::detectFormat(text, name));
}

/// "m01_s01_e01_positions.txt" and "m01_s01_e01_angles.txt" are in the same folder; either may be given.
Result<JointStream> readPair(const std::filesystem::path& file, std::string_view text,
                             const JointStreamSettings& settings) {
  constexpr std::string_view kPositions = "positions";
  constexpr std::string_view kAngles = "angles";
  const std::string name = file.filename().string();
  const bool isAngles = name.rfind(kAngles) != std::string::npos;
  const std::string_view mine = isAngles ? kAngles : kPositions;
  const std::size_t at = name.rfind(mine);
  if (at == std::string::npos) {
    return notFound(
        "{}: UI-PRMD stores positions and angles in two files: found neither \"positions\" nor \"angles\" in the file "
        "name, expected a name like m01_s01_e01_positions.txt",
        file.string());
  }
  std::string otherName = name;
  otherName.replace(at, mine.size(), isAngles ? kPositions : kAngles);
  const std::filesystem::path other = file.parent_path() / otherName;
  LORICA_TRY(std::string otherText, readFile(other));
  otherText = asUtf8(std::move(otherText));
  LORICA_TRY(joints::RawStream raw,
             unlessStopped(isAngles ? joints::readUiPrmd(otherText, other.string(), text, file.string())
                                    : joints::readUiPrmd(text, file.string(), otherText, other.string())));
  return joints::finish(std::move(raw), JointFormat::kUiPrmd, file.string(), settings);
}

/// Appends frames of nobody between two times, neither included.
void addNobody(double from, double to, std::vector<SkeletonFrame>& frames) {
  for (int i = 1; from + (i + 0.5) * kStep < to; ++i) {
    SkeletonFrame frame;
    frame.user = kNobody;
    frame.time = from + i * kStep;
    frames.push_back(frame);
  }
}

/// Fills the time in which a person is not there. @param begin, end  of everybody [s]
void fillAbsences(double begin, double end, std::vector<SkeletonFrame>& frames) {
  std::vector<SkeletonFrame> filled;
  double last = begin - kStep;
  for (SkeletonFrame& frame : frames) {
    if (frame.time - last > kLost || filled.empty()) addNobody(last, frame.time, filled);
    last = frame.time;
    filled.push_back(std::move(frame));
  }
  addNobody(last, std::max(end, last) + kStep, filled);
  frames = std::move(filled);
}

}  // namespace

Result<JointStream> readJointStream(const std::filesystem::path& file, const JointStreamSettings& settings) {
  LORICA_TRY(std::string text, readFile(file));
  text = asUtf8(std::move(text));
  if (std::optional<std::string> rest = withoutPreamble(text, file.string())) text = std::move(*rest);
  JointStreamSettings known = settings;
  LORICA_TRY(known.format, formatOf(text, file.string(), settings));
  if (known.format == JointFormat::kUiPrmd) return readPair(file, text, settings);
  return parseJointStream(text, file.string(), known);
}

Result<JointStream> parseJointStream(std::string_view text, std::string_view name,
                                     const JointStreamSettings& settings) {
  if (const std::optional<std::string> rest = withoutPreamble(text, name)) {
    return parseJointStream(*rest, name, settings);
  }
  LORICA_TRY(const JointFormat format, formatOf(text, name, settings));
  if (format == JointFormat::kLorica) return parseLorica(text, name, settings);
  const joints::Layout& layout = joints::layoutOf(format);
  if (layout.read == nullptr) {
    return unsupported(
        "{}: UI-PRMD needs a second file with angles: found text only, expected a positions file with its angles file "
        "beside it",
        name);
  }
  LORICA_TRY(joints::RawStream raw, unlessStopped(layout.read(layout, text, name)));
  return joints::finish(std::move(raw), format, name, settings);
}

Result<std::vector<JointStream>> readJointStreamOfAll(const std::filesystem::path& file,
                                                      const JointStreamSettings& settings) {
  LORICA_TRY(const JointStream one, readJointStream(file, settings));
  if (one.people.size() > kMaxRecordedPeople) {
    return invalidArgument("{}: found {} people, expected at most {}", file.string(), one.people.size(),
                           kMaxRecordedPeople);
  }
  std::vector<JointStream> all;
  JointStreamSettings known = settings;
  known.format = one.format;
  Vec3 middle = Vec3::Zero();
  double start = std::numeric_limits<double>::infinity();
  for (const int person : one.people) {
    known.person = person;
    LORICA_TRY(JointStream stream, readJointStream(file, known));
    middle += stream.origin / static_cast<double>(one.people.size());
    start = std::min(start, stream.start);
    all.push_back(std::move(stream));
  }
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (JointStream& stream : all) {
    const Vec3 moved(stream.origin.x() - middle.x(), 0.0, stream.origin.z() - middle.z());  // each on the floor
    for (SkeletonFrame& frame : stream.frames) {
      frame.time += stream.start - start;
      for (TrackedJoint& joint : frame.joints) {
        if (joint.confidence > 0.0) joint.position += moved;
      }
    }
    begin = std::min(begin, stream.frames.front().time);
    end = std::max(end, stream.frames.back().time);
  }
  for (JointStream& stream : all) fillAbsences(begin, end, stream.frames);
  return all;
}

}  // namespace lorica
