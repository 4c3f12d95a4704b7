#include "capture/files/joint_stream_parts.h"
#include "capture/files/joint_stream_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

/// Detects the layout of a file from its header or from the number of values per row.
namespace lorica::joints {
namespace {

/// Rows to inspect: enough for one frame of MSR Action3D.
constexpr std::size_t kRowsLookedAt = kKinect1JointCount;

bool endsWithWord(std::string_view field, std::string_view word) {
  return field.size() >= word.size() && sameWord(field.substr(field.size() - word.size()), word);
}

std::optional<JointFormat> formatOfHeader(const RowReader& reader) {
  const auto fields = reader.fields();
  const auto has = [&](auto&& test) { return std::any_of(fields.begin(), fields.end(), test); };
  // Two of the three suffice: the format's own reader reports better what is wrong with the third.
  if (fields.size() > 5 &&
      sameWord(fields[0], "time") + sameWord(fields[1], "user") + sameWord(fields[2], "head.x") >= 2) {
    return sameWord(fields[5], "head.qx") ? JointFormat::kLorica : JointFormat::kNite2;
  }
  const bool time = has([](std::string_view f) { return f.size() >= 4 && sameWord(f.substr(0, 4), "time"); });
  const bool x = has([](std::string_view f) { return endsWithWord(f, "x"); });
  if (time && x && has([](std::string_view f) { return sameWord(f, "JointType"); })) return JointFormat::kKinect1Long;
  const auto isPositionX = [](std::string_view f) {
    return endsWithWord(f, "PositionX") || endsWithWord(f, "Position.X");
  };
  const bool relative = has([](std::string_view f) { return endsWithWord(f, "time"); });
  if ((time || relative) && std::count_if(fields.begin(), fields.end(), isPositionX) > 1)
    return JointFormat::kKinect2Wide;
  return std::nullopt;
}

/// Whether the row has the form "sec|kb,time,6,25,..."
bool isBodyRow(const RowReader& reader) {
  if (reader.delimiter() == Delimiter::kBlanks || reader.count() < 5) return false;
  const std::string_view tag = reader.field(0);
  if (tag.find('|') != std::string_view::npos) return true;
  const std::string_view bodies = reader.field(2);
  return bodies.size() == 1 && bodies[0] >= '1' && bodies[0] <= '6' && reader.field(3) == "25";
}

bool isNumberWithin(std::string_view field, double min, double max) {
  double value = 0.0;
  return readNumber(field, value) == NumberKind::kNumber && value >= min && value <= max;
}

enum class Fit : std::uint8_t { kNone, kFirst, kAll };

/// Whether the first rows match the format.
Fit fitOf(JointFormat format, std::string_view text, std::string_view file) {
  RowReader reader(text, file);
  std::size_t rows = 0;
  bool mayBeHeader = format == JointFormat::kNite2;
  for (; rows < kRowsLookedAt && reader.next(); ++rows) {
    if (std::exchange(mayBeHeader, false) && isWord(reader.field(0))) {
      --rows;
      continue;
    }
    bool fits = false;
    switch (format) {
      case JointFormat::kMsrAction3d:
        fits = reader.fit(4) && isNumberWithin(reader.field(3), 0.0, 1.0);
        break;
      case JointFormat::kUtKinect: {
        double number = 0.5;
        fits = reader.fit(61) && readNumber(reader.field(0), number) == NumberKind::kNumber &&
               number == std::floor(number);
        break;
      }
      case JointFormat::kKinect2Plain:
        fits = reader.fit(75);
        break;
      case JointFormat::kUiPrmd:
        fits = reader.fit(66);
        break;
      case JointFormat::kUpperBody:
        fits = reader.fit(18);
        break;
      case JointFormat::kNite2: {
        const bool plain = reader.fit(62);
        fits = plain || reader.fit(122);
        for (std::size_t j = 0; fits && j < kBodyJointCount; ++j) {
          fits = isNumberWithin(reader.field(2 + (plain ? 4 : 8) * j + 3), 0.0, 1.0);
        }
        break;
      }
      case JointFormat::kLorica:
      case JointFormat::kKinect2Bodies:
      case JointFormat::kKinect2Wide:
      case JointFormat::kKinect1Long:
        break;
    }
    for (std::size_t c = 0; fits && c < reader.count(); ++c) {
      double value = 0.0;
      fits = readNumber(reader.field(c), value) != NumberKind::kBad;
    }
    if (!fits) return rows == 0 ? Fit::kNone : reader.cutOff() ? Fit::kAll : Fit::kFirst;
  }
  return rows > 0 ? Fit::kAll : Fit::kNone;
}

std::string listed(const std::vector<JointFormat>& formats, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    text += i == 0 ? "" : i + 1 == formats.size() ? last : std::string_view(", ");
    text += nameOf(formats[i]);
  }
  return text;
}

}  // namespace

Result<JointFormat> detectFormat(std::string_view text, std::string_view file) {
  RowReader reader(text, file);
  if (!reader.next()) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: found an empty file, expected recorded joints", file)};
  }
  if (const std::optional<JointFormat> format = formatOfHeader(reader)) return *format;
  if (isBodyRow(reader)) return JointFormat::kKinect2Bodies;

  std::vector<JointFormat> fitting;
  std::vector<JointFormat> beginning;
  std::vector<JointFormat> all;
  all.reserve(kJointFormatCount);
  for (int i = 0; i < kJointFormatCount; ++i) {
    const auto format = static_cast<JointFormat>(i);
    all.push_back(format);
    const Fit fit = fitOf(format, text, file);
    if (fit == Fit::kAll) fitting.push_back(format);
    if (fit == Fit::kFirst) beginning.push_back(format);
  }
  if (fitting.size() == 1) return fitting.front();
  // The file probably has a bad row: reading it in this format reports which one.
  if (fitting.empty() && beginning.size() == 1) return beginning.front();
  if (fitting.empty()) {
    return Error{ErrorCode::kBadFormat,
                 fmt::format("{}: found a first row of {} fields starting with {}, expected recorded joints in a known "
                             "layout; if it is one, specify it with --format: {}",
                             file, reader.count(), quotedWord(reader.field(0)), listed(all, " or "))};
  }
  return Error{ErrorCode::kBadFormat,
               fmt::format("{}: found rows that match {}, expected a single match; specify the layout with --format",
                           file, listed(fitting, " and "))};
}

}  // namespace lorica::joints
