#include "capture/files/joint_stream.h"

#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream_parts.h"
#include "geometry/files.h"

#include <fmt/format.h>

#include <array>
#include <map>

namespace lorica {
namespace {

constexpr std::array<std::string_view, kJointFormatCount> kFormatNames = {
    "lorica",       "msr-action3d",  "utkinect", "kinect2-bodies", "kinect2-wide",
    "kinect1-long", "kinect2-plain", "ui-prmd",  "upper-body",     "nite2"};

Result<JointStream> parseLorica(std::string_view text, std::string_view name, const JointStreamSettings& settings) {
  Result<std::vector<std::vector<SkeletonFrame>>> all = parseJointCsvOfAll(text, name);
  if (!all) return all.error();
  std::map<int, joints::WayMeter> ways;
  for (const std::vector<SkeletonFrame>& its : *all) {
    joints::WayMeter& meter = ways[its.front().user];
    for (const SkeletonFrame& frame : its) meter.add(frame);
  }
  JointStream stream;
  stream.people.reserve(ways.size());
  for (const auto& [person, meter] : ways) stream.people.push_back(person);
  const Result<int> chosen = joints::choosePerson(ways, name, settings);
  if (!chosen) return chosen.error();
  for (std::vector<SkeletonFrame>& its : *all) {
    if (its.front().user == *chosen) stream.frames = std::move(its);
  }
  if (!settings.person && ways.size() > 1) {
    stream.notes.push_back(
        fmt::format("The file has {} people; person {} moves most and was selected.", ways.size(), *chosen));
  }
  return stream;
}

Result<joints::RawStream> parseAs(JointFormat format, std::string_view text, std::string_view name) {
  switch (format) {
    case JointFormat::kMsrAction3d:
      return joints::parseMsrAction3d(text, name);
    case JointFormat::kUtKinect:
      return joints::parseUtKinect(text, name);
    case JointFormat::kKinect2Bodies:
      return joints::parseKinect2Bodies(text, name);
    case JointFormat::kKinect2Wide:
      return joints::parseKinect2Wide(text, name);
    case JointFormat::kKinect1Long:
      return joints::parseKinect1Long(text, name);
    case JointFormat::kKinect2Plain:
      return joints::parseKinect2Plain(text, name);
    case JointFormat::kUpperBody:
      return joints::parseUpperBody(text, name);
    case JointFormat::kNite2:
      return joints::parseNite2(text, name);
    case JointFormat::kLorica:
    case JointFormat::kUiPrmd:
      break;
  }
  return Error{
      ErrorCode::kUnsupported,
      fmt::format("{}: UI-PRMD needs a second file with angles: found text only, expected a positions file with "
                  "its angles file beside it",
                  name)};
}

Result<JointFormat> formatOf(std::string_view text, std::string_view name, const JointStreamSettings& settings) {
  if (settings.format) return *settings.format;
  return joints::detectFormat(text, name);
}

/// "m01_s01_e01_positions.txt" and "m01_s01_e01_angles.txt" are in the same folder; either may be given.
Result<JointStream> readUiPrmd(const std::filesystem::path& file, std::string_view text,
                               const JointStreamSettings& settings) {
  constexpr std::string_view kPositions = "positions";
  constexpr std::string_view kAngles = "angles";
  const std::string name = file.filename().string();
  const bool isAngles = name.rfind(kAngles) != std::string::npos;
  const std::string_view mine = isAngles ? kAngles : kPositions;
  const std::string_view others = isAngles ? kPositions : kAngles;
  const std::size_t at = name.rfind(mine);
  if (at == std::string::npos) {
    return Error{
        ErrorCode::kNotFound,
        fmt::format(
            "{}: UI-PRMD stores positions and angles in two files: found neither \"positions\" nor \"angles\" in "
            "the file name, expected a name like m01_s01_e01_positions.txt",
            file.string())};
  }
  std::string otherName = name;
  otherName.replace(at, mine.size(), others);
  const std::filesystem::path other = file.parent_path() / otherName;
  const Result<std::string> otherText = readFile(other);
  if (!otherText) return otherText.error();
  Result<joints::RawStream> raw = isAngles ? joints::parseUiPrmd(*otherText, other.string(), text, file.string())
                                           : joints::parseUiPrmd(text, file.string(), *otherText, other.string());
  if (!raw) return raw.error();
  return joints::finish(std::move(*raw), JointFormat::kUiPrmd, file.string(), settings);
}

}  // namespace

std::string_view nameOf(JointFormat format) {
  return kFormatNames[static_cast<std::size_t>(format)];
}

std::optional<JointFormat> jointFormatNamed(std::string_view name) {
  for (std::size_t i = 0; i < kFormatNames.size(); ++i) {
    if (kFormatNames[i] == name) return static_cast<JointFormat>(i);
  }
  return std::nullopt;
}

Result<JointStream> readJointStream(const std::filesystem::path& file, const JointStreamSettings& settings) {
  const Result<std::string> text = readFile(file);
  if (!text) return text.error();
  const Result<JointFormat> format = formatOf(*text, file.string(), settings);
  if (!format) return format.error();
  if (*format == JointFormat::kUiPrmd) return readUiPrmd(file, *text, settings);
  JointStreamSettings known = settings;
  known.format = *format;
  return parseJointStream(*text, file.string(), known);
}

Result<JointStream> parseJointStream(std::string_view text, std::string_view name,
                                     const JointStreamSettings& settings) {
  const Result<JointFormat> format = formatOf(text, name, settings);
  if (!format) return format.error();
  if (*format == JointFormat::kLorica) return parseLorica(text, name, settings);
  Result<joints::RawStream> raw = parseAs(*format, text, name);
  if (!raw) return raw.error();
  return joints::finish(std::move(*raw), *format, name, settings);
}

}  // namespace lorica
