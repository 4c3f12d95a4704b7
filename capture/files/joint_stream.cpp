#include "capture/files/joint_stream.h"

#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <limits>
#include <utility>

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
  return joints::detectFormat(text, name);
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
  LORICA_TRY(joints::RawStream raw, isAngles ? joints::readUiPrmd(otherText, other.string(), text, file.string())
                                             : joints::readUiPrmd(text, file.string(), otherText, other.string()));
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
  LORICA_TRY(joints::RawStream raw, layout.read(layout, text, name));
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
