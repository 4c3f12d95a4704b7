#include "capture/files/bvh_text.h"

#include "geometry/interrupt.h"
#include "geometry/line_scanner.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace lorica {
namespace {

constexpr std::size_t kMaxJoints = 10000;
/// A file that names more channels for one joint repeats itself.
constexpr std::size_t kMaxChannelsOfAJoint = 12;
/// Larger numbers are neither centimetres nor degrees; the limit keeps later sums finite.
constexpr double kLargestNumber = 1e9;
/// Range of plausible frame durations [s].
constexpr double kShortestFrame = 0.0005;
constexpr double kLongestFrame = 2.0;
constexpr double kUsualFrame = 1.0 / 30.0;

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}
bool isLineEnd(char c) {
  return c == '\n' || c == '\r';
}
bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

/// @param expected  in lower case
bool sameWord(std::string_view word, std::string_view expected) {
  return word.size() == expected.size() && lowerCase(word) == expected;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// Parses numbers of the usual form, "-12.3456". Exact: digits and power of ten are exact in a double, and one division
/// rounds once. Advances the cursor past the number; for any other form returns false and leaves the cursor unchanged.
bool readPlainNumber(const char*& cursor, const char* end, double& value) {
  static constexpr std::array<double, 19> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8, 1e9,
                                                          1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18};
  constexpr std::uint64_t kLargestExact = std::uint64_t{1} << 53;
  const char* at = cursor;
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;
  const char* first = at;
  while (at != end && isDigit(*at)) digits = 10 * digits + static_cast<std::uint64_t>(*at++ - '0');
  std::ptrdiff_t count = at - first;
  std::ptrdiff_t decimals = 0;
  if (at != end && *at == '.') {
    first = ++at;
    while (at != end && isDigit(*at)) digits = 10 * digits + static_cast<std::uint64_t>(*at++ - '0');
    decimals = at - first;
    count += decimals;
  }
  if (count == 0 || count > 18 || digits > kLargestExact || (at != end && !isBlank(*at))) return false;
  const double size = static_cast<double>(digits) / kPowersOfTen[decimals];
  value = negative ? -size : size;
  cursor = at;
  return true;
}

/// Iterates over the words of a text and tracks the line number. Lines end with \n, \r\n or \r. If the work is stopped
/// the text ends there.
class Words {
 public:
  Words(std::string_view text, std::string_view name)
      : cursor_(text.data()), end_(text.data() + text.size()), name_(name) {}

  /// Returns the next word on any line; a brace is a word of its own. Empty at the end of the text.
  std::string_view next() {
    if (interrupt_.stopped()) end_ = cursor_;
    while (!atEnd() && isBlank(*cursor_)) step();
    return take();
  }
  /// Returns the next word on this line; empty at the end of the line.
  std::string_view nextOnLine() {
    skipBlanksOnLine();
    if (atEnd() || isLineEnd(*cursor_)) return {};
    return take();
  }
  /// Returns the rest of this line up to a brace, trimmed.
  std::string_view restOfLine() {
    const char* begin = cursor_;
    while (!atEnd() && !isLineEnd(*cursor_) && *cursor_ != '{') ++cursor_;
    return trimmed({begin, static_cast<std::size_t>(cursor_ - begin)});
  }
  /// Reads a plain number on this line; returns false and reads nothing for anything else.
  bool plainNumber(double& value) {
    if (interrupt_.stopped()) end_ = cursor_;
    skipBlanksOnLine();
    return readPlainNumber(cursor_, end_, value);
  }
  [[nodiscard]] bool atLineEnd() {
    skipBlanksOnLine();
    return atEnd() || isLineEnd(*cursor_);
  }
  /// Advances to the next line that has a word. @return false at the end of the text
  bool nextLine() {
    if (workStopped()) end_ = cursor_;
    while (!atEnd() && isBlank(*cursor_)) step();
    return !atEnd();
  }
  [[nodiscard]] bool atEnd() const { return cursor_ == end_; }
  [[nodiscard]] std::size_t line() const { return line_; }

  [[nodiscard]] Error fail(std::size_t line, const std::string& message) const {
    return {ErrorCode::kBadFormat, fmt::format("{}, line {}: {}", name_, line, message)};
  }
  [[nodiscard]] Error found(std::string_view word, std::string_view expected) const {
    if (word.empty()) {
      return fail(line_,
                  fmt::format("{}, expected {}", atEnd() ? "the file ends here" : "the line ends here", expected));
    }
    return fail(line_, fmt::format("found {}, expected {}", quotedWord(word), expected));
  }

 private:
  void skipBlanksOnLine() {
    while (!atEnd() && isBlank(*cursor_) && !isLineEnd(*cursor_)) ++cursor_;
  }
  void step() {
    const char c = *cursor_++;
    if (c == '\n' || (c == '\r' && (atEnd() || *cursor_ != '\n'))) ++line_;
  }
  std::string_view take() {
    const char* begin = cursor_;
    if (!atEnd() && (*cursor_ == '{' || *cursor_ == '}')) {
      ++cursor_;
    } else {
      while (!atEnd() && !isBlank(*cursor_) && *cursor_ != '{' && *cursor_ != '}') ++cursor_;
    }
    return {begin, static_cast<std::size_t>(cursor_ - begin)};
  }

  const char* cursor_;
  const char* end_;
  std::string_view name_;
  std::size_t line_ = 1;
  SparseInterrupt interrupt_;  // of words
};

class Parser {
 public:
  Parser(std::string_view text, std::string_view name) : bytes_(text.size()), words_(text, name) {}

  Result<BvhText> parse() {
    LORICA_TRY_DO(parseHierarchy());
    LORICA_TRY_DO(parseMotionHead());
    LORICA_TRY_DO(parseRows());
    if (commas_ > 0)
      out_.notes.push_back(counted(commas_, "number has", "numbers have") +
                           " a decimal comma, read as a decimal point");
    return std::move(out_);
  }

 private:
  /// Parses a word as a number: with exponent, leading plus, decimal comma, or a comma after it.
  std::optional<double> numberOf(std::string_view word) {
    if (!word.empty() && word.back() == ',') word.remove_suffix(1);
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    std::array<char, 64> repaired{};
    const std::size_t comma = word.find(',');
    if (comma != std::string_view::npos) {
      if (word.size() > repaired.size() || word.find('.') != std::string_view::npos) return std::nullopt;
      std::copy(word.begin(), word.end(), repaired.begin());
      repaired[comma] = '.';
      word = {repaired.data(), word.size()};
    }
    double value = 0.0;
    if (!parseReal(word, value) || std::abs(value) > kLargestNumber) return std::nullopt;
    if (comma != std::string_view::npos) ++commas_;
    return value;
  }

  static constexpr std::string_view kANumber = "a number between -1e9 and 1e9";

  Result<Vec3> parseOffset() {
    Vec3 offset = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = words_.next();
      const std::optional<double> value = numberOf(word);
      if (!value) return words_.found(word, fmt::format("the {} of an offset", "xyz"[axis]));
      offset[axis] = *value;
    }
    return offset;
  }

  Result<void> parseChannels(BvhJoint& joint) {
    const std::string_view word = words_.next();
    std::int64_t count = 0;
    if (!parseInteger(word, count) || count < 0 || count > static_cast<std::int64_t>(kMaxChannelsOfAJoint)) {
      return words_.found(word, fmt::format("a channel count from 0 to {}", kMaxChannelsOfAJoint));
    }
    if (!joint.channels.empty()) return words_.fail(words_.line(), "found a second CHANNELS, expected only one");
    static constexpr std::array<std::string_view, 6> kNames = {"xposition", "yposition", "zposition",
                                                               "xrotation", "yrotation", "zrotation"};
    joint.firstChannel = out_.channelCount;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::string_view channel = words_.next();
      std::size_t kind = 0;
      while (kind < kNames.size() && !sameWord(channel, kNames[kind])) ++kind;
      if (kind == kNames.size()) {
        return words_.found(channel, fmt::format("channel {} of {}, for example Xposition or Zrotation", i + 1, count));
      }
      joint.channels.push_back(static_cast<BvhChannel>(kind));
    }
    out_.channelCount += joint.channels.size();
    return {};
  }

  /// Parses ROOT, JOINT and End Site. The stack holds the joint of each open block, or kEndSite.
  Result<void> parseHierarchy() {
    constexpr int kEndSite = -2;
    std::vector<int> open;
    std::string_view word = words_.next();
    if (word.substr(0, 3) == "\xef\xbb\xbf") word.remove_prefix(3);
    if (word.empty()) return words_.found(word, "HIERARCHY");
    if (!sameWord(word, "hierarchy")) return words_.found(word, "HIERARCHY at the start of a BVH file");
    for (;;) {
      word = words_.next();
      const bool inside = !open.empty();
      const bool inEndSite = inside && open.back() == kEndSite;
      if (!inside && sameWord(word, "motion")) break;
      if ((!inside && sameWord(word, "root")) || (inside && !inEndSite && sameWord(word, "joint"))) {
        if (out_.joints.size() == kMaxJoints) {
          return words_.fail(words_.line(),
                             fmt::format("found joint {}, expected at most {}", kMaxJoints + 1, kMaxJoints));
        }
        BvhJoint joint;
        joint.parent = inside ? open.back() : -1;
        joint.name = std::string(words_.restOfLine());
        if (joint.name.empty()) joint.name = fmt::format("joint{}", out_.joints.size() + 1);
        open.push_back(static_cast<int>(out_.joints.size()));
        out_.joints.push_back(std::move(joint));
        if (const std::string_view brace = words_.next(); brace != "{") return words_.found(brace, "{");
      } else if (inside && !inEndSite && (sameWord(word, "end") || sameWord(word, "endsite"))) {
        words_.restOfLine();  // "Site", or a name that some writers add
        if (const std::string_view brace = words_.next(); brace != "{") return words_.found(brace, "{");
        out_.endSites.emplace_back(open.back(), Vec3::Zero());
        open.push_back(kEndSite);
      } else if (inside && sameWord(word, "offset")) {
        LORICA_TRY((inEndSite ? out_.endSites.back().second : out_.joints[open.back()].offset), parseOffset());
      } else if (inside && !inEndSite && sameWord(word, "channels")) {
        LORICA_TRY_DO(parseChannels(out_.joints[open.back()]));
      } else if (inside && word == "}") {
        open.pop_back();
      } else if (inEndSite) {
        return words_.found(word, "OFFSET or } of the end site");
      } else if (inside) {
        return words_.found(word, fmt::format("OFFSET, CHANNELS, JOINT, End Site or }} of the joint {}",
                                              quotedWord(out_.joints[open.back()].name)));
      } else {
        return words_.found(word, "ROOT or MOTION");
      }
    }
    if (out_.joints.empty()) return words_.fail(words_.line(), "found MOTION before any ROOT, expected a ROOT");
    if (out_.channelCount == 0)
      return words_.fail(words_.line(), "found no CHANNELS, expected them on at least one joint");
    return {};
  }

  /// Parses "Frames: 12" and "Frame Time: 0.03" in either order, with or without blanks around the colons, or without
  /// colons.
  Result<void> parseMotionHead() {
    bool hasTime = false;
    while (!promisedFrames_ || !hasTime) {
      // A word in front of a colon, and what follows the colon in the same word.
      const auto split = [&](std::string_view& behind) {
        const std::string_view word = words_.next();
        const std::size_t colon = word.find(':');
        behind = colon == std::string_view::npos ? std::string_view() : word.substr(colon + 1);
        return word.substr(0, colon);
      };
      std::string_view value;
      const std::string_view word = split(value);
      const bool count = sameWord(word, "frames");
      if (!count && !sameWord(word, "frame")) return words_.found(word, "\"Frames:\" and \"Frame Time:\"");
      while (value.empty() && !words_.atEnd()) {
        const std::string_view next = split(value);
        if (value.empty() && !next.empty() && !sameWord(next, "time")) value = next;
      }
      const std::optional<double> number = numberOf(value);
      if (count) {
        if (!number) return words_.found(value, "the number of frames");
        promisedFrames_ = *number;
        continue;
      }
      hasTime = true;
      if (!number && !sameWord(value, "nan") && !sameWord(value, "inf")) {
        return words_.found(value, "the frame time in seconds");
      }
      out_.frameSeconds = number.value_or(0.0);
      if (out_.frameSeconds >= kShortestFrame && out_.frameSeconds <= kLongestFrame) continue;
      out_.notes.push_back(fmt::format("a frame time of {} s is replaced by 1/30 s (plausible: {} to {} s)",
                                       quotedWord(value), kShortestFrame, kLongestFrame));
      out_.frameSeconds = kUsualFrame;
    }
    return {};
  }

  static bool isNan(std::string_view word) {
    if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
    return sameWord(word.substr(0, 3), "nan");
  }

  /// An unknown channel keeps its last known value; before the first known value it gets that value; else 0.
  void fillUnknown() {
    std::size_t filled = 0;
    std::vector<double>& values = out_.values;
    for (std::size_t c = 0; c < out_.channelCount; ++c) {
      std::size_t i = c;
      while (i < values.size() && std::isnan(values[i])) i += out_.channelCount;
      double last = i < values.size() ? values[i] : 0.0;
      for (i = c; i < values.size(); i += out_.channelCount) {
        if (std::isnan(values[i])) {
          values[i] = last;
          ++filled;
        }
        last = values[i];
      }
    }
    if (filled > 0) {
      out_.notes.push_back(counted(filled, "number is NaN: its channel keeps the last known value",
                                   "numbers are NaN: their channels keep the last known value"));
    }
  }

  Result<void> tooManyJoints() const {
    return words_.fail(words_.line(), fmt::format("found {} joints in at least {} frames, expected numbers for them: "
                                                  "too many for a file of {} bytes",
                                                  out_.joints.size(), out_.frameCount, bytes_));
  }

  /// Parses one row per frame. If the first row has another length, frames may span several lines and only the total
  /// must fit.
  Result<void> parseRows() {
    const std::size_t channels = out_.channelCount;
    std::vector<double>& values = out_.values;
    // A number takes at least two bytes, whatever the header declares.
    const std::size_t max = bytes_ / 2;
    values.reserve(static_cast<std::size_t>(
        std::clamp(*promisedFrames_ * static_cast<double>(channels), 0.0, static_cast<double>(max))));
    bool wrapped = false;
    std::size_t rowLine = 0;
    std::size_t missing = 0;  // in the last row
    while (words_.nextLine()) {
      const std::size_t before = values.size();
      if (missing > 0) {
        return words_.fail(rowLine, fmt::format("found {}, expected {}: one per channel",
                                                counted(std::int64_t(channels - missing), "number"), channels));
      }
      rowLine = words_.line();
      while (!words_.atLineEnd()) {
        double value = 0.0;
        if (!words_.plainNumber(value)) {
          const std::string_view word = words_.nextOnLine();
          if (word.front() == '\x1a' || word.front() == '\0') break;  // end-of-text marker of old editors
          const std::optional<double> number = isNan(word) ? kUnknown : numberOf(word);
          if (!number) {
            return words_.fail(rowLine, fmt::format("found {} in column {}, expected {}", quotedWord(word),
                                                    values.size() - before + 1, kANumber));
          }
          value = *number;
        } else if (std::abs(value) > kLargestNumber) {
          return words_.fail(
              rowLine, fmt::format("found {} in column {}, expected {}", value, values.size() - before + 1, kANumber));
        }
        values.push_back(value);
      }
      const std::size_t found = values.size() - before;
      if (before == 0 && found != channels && found > 0 && words_.nextLine()) {
        wrapped = true;
        firstRow_ = found;
        firstRowLine_ = rowLine;
      }
      if (!wrapped) {
        if (found > channels) {
          return words_.fail(rowLine, fmt::format("found {}, expected {}: one per channel",
                                                  counted(std::int64_t(found), "number"), channels));
        }
        missing = found == 0 ? 0 : channels - found;
      }
      out_.frameCount = values.size() / channels;
      if (out_.frameCount * out_.joints.size() > bytes_) return tooManyJoints();
    }
    if (wrapped) {
      missing = (channels - values.size() % channels) % channels;
      const double frames = static_cast<double>(values.size()) / static_cast<double>(channels);
      if (std::abs(frames - *promisedFrames_) > 1.0) {
        return words_.fail(firstRowLine_, fmt::format("found {}, expected {}: one per channel",
                                                      counted(std::int64_t(firstRow_), "number"), channels));
      }
      out_.notes.push_back("frames span several lines");
    }
    if (out_.frameCount == 0) {
      return words_.fail(words_.line(), fmt::format("the file ends here, expected a frame of {}",
                                                    counted(std::int64_t(channels), "number")));
    }
    if (missing > 0) {
      out_.notes.push_back(
          fmt::format("line {}: the last frame lacks {} of {} numbers and is omitted", rowLine, missing, channels));
    }
    values.resize(out_.frameCount * channels);
    fillUnknown();
    if (static_cast<double>(out_.frameCount) != *promisedFrames_) {
      out_.notes.push_back(fmt::format("the header declares {} frame{}, the file has {}", *promisedFrames_,
                                       *promisedFrames_ == 1.0 ? "" : "s", out_.frameCount));
    }
    return {};
  }

  std::size_t bytes_;
  Words words_;
  BvhText out_;
  static constexpr std::optional<double> kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::optional<double> promisedFrames_;
  std::size_t commas_ = 0;
  std::size_t firstRow_ = 0;
  std::size_t firstRowLine_ = 0;
};

}  // namespace

Result<BvhText> parseBvhText(std::string_view text, std::string_view name) {
  return unlessStopped(Parser(text, name).parse());
}

}  // namespace lorica
