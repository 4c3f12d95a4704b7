#include "capture/files/joint_csv.h"

#include "geometry/counts.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/line_scanner.h"
#include "geometry/new_file.h"
#include "geometry/text.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kFieldsBeforeJoints = 2;
constexpr int kFieldsPerJoint = 8;
constexpr int kFieldCount = kFieldsBeforeJoints + kBodyJointCount * kFieldsPerJoint;
constexpr std::array<std::string_view, kFieldsPerJoint> kJointFields = {"x",  "y",  "z",  "qx",
                                                                        "qy", "qz", "qw", "confidence"};

/// Larger positions are in another unit, most often millimetres; the limit also keeps later sums finite.
constexpr double kLargestCoordinate = 100.0;
/// Seconds since 1970 fit; microseconds since 1970 do not.
constexpr double kLargestTime = 1e12;
constexpr double kQuaternionTolerance = 0.01;
/// A quaternion this close to unit length is kept bit for bit, so that writing and reading change nothing.
constexpr double kUnitAlready = 1e-12;

std::string columnName(int column) {
  if (column == 0) return "time";
  if (column == 1) return "user";
  const int joint = (column - kFieldsBeforeJoints) / kFieldsPerJoint;
  const int field = (column - kFieldsBeforeJoints) % kFieldsPerJoint;
  return fmt::format("{}.{}", nameOf(static_cast<BodyJoint>(joint)), kJointFields[field]);
}

/// The file's text for use in an error message: quoted, short, printable.
std::string quoted(std::string_view text) {
  if (text.empty()) return "an empty field";
  std::string out = quotedWord(text);
  out.front() = out.back() = '"';
  return out;
}

std::optional<double> parseNumber(std::string_view text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Reads one file: tracks the current row and composes error messages.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  Result<std::vector<std::vector<SkeletonFrame>>> read(std::string_view text) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
    if (text.empty()) return badFormat("{}: found an empty file, expected a header line", file_);

    for (line_ = 1; !text.empty(); ++line_) {
      const std::size_t end = text.find('\n');
      if (workStopped()) return cancelled();
      std::string_view row = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      if (!row.empty() && row.back() == '\r') row.remove_suffix(1);
      LORICA_TRY_DO(line_ == 1 ? readHeader(row) : readRow(row));
    }
    if (users_.empty()) return badFormat("{}: found a header and no rows, expected at least one frame", file_);
    std::vector<std::vector<SkeletonFrame>> people;
    people.reserve(users_.size());
    for (User& user : users_) people.push_back(std::move(user.frames));
    return people;
  }

 private:
  struct User {
    std::vector<SkeletonFrame> frames;
    int lastLine = 0;
  };

  /// "walk.csv, line 7, column 12 (neck.x): found ..., expected ..."; columns count from 1.
  [[nodiscard]] Error badField(int column, const std::string& found, std::string_view expected) const {
    return badFormat("{}, line {}, column {} ({}): found {}, expected {}", file_, line_, column + 1, columnName(column),
                     found, expected);
  }
  [[nodiscard]] Error badField(int column, std::string_view expected) const {
    return badField(column, quoted(field(column)), expected);
  }

  /// @param range  in words
  [[nodiscard]] Result<double> number(int column, double min, double max, std::string_view range) const {
    const std::optional<double> value = parseNumber(field(column));
    if (!value) return badField(column, "a number");
    if (*value < min || *value > max) return badField(column, range);
    return *value;
  }

  Result<void> readHeader(std::string_view row) {
    split(row);
    for (int column = 0; column < kFieldCount; ++column) {
      const std::string expected = columnName(column);
      if (column >= countOf(fields_)) {
        return badFormat("{}, line 1: found {}, expected {}; column {}, \"{}\", is missing", file_,
                         counted(std::ssize(fields_), "column"), kFieldCount, column + 1, expected);
      }
      if (field(column) != expected) {
        return badFormat("{}, line 1, column {}: found {}, expected \"{}\"", file_, column + 1, quoted(field(column)),
                         expected);
      }
    }
    if (fields_.size() > kFieldCount) {
      return badFormat("{}, line 1, column {}: found {}, expected the line to end after {} columns", file_,
                       kFieldCount + 1, quoted(field(kFieldCount)), kFieldCount);
    }
    return {};
  }

  Result<void> readRow(std::string_view row) {
    split(row);
    if (fields_.size() != kFieldCount) {
      return badFormat("{}, line {}: found {}, expected {} fields", file_, line_,
                       row.empty() ? "an empty line" : counted(std::ssize(fields_), "field"), kFieldCount);
    }
    SkeletonFrame frame;
    LORICA_TRY(frame.time, number(0, -kLargestTime, kLargestTime, "seconds within +-1e12"));
    const std::string_view user = field(1);
    const auto [end, status] = std::from_chars(user.data(), user.data() + user.size(), frame.user);
    if (status != std::errc{} || end != user.data() + user.size()) return badField(1, "a whole number");
    for (int j = 0; j < kBodyJointCount; ++j) {
      LORICA_TRY(frame.joints[j], readJoint(kFieldsBeforeJoints + j * kFieldsPerJoint));
    }
    return append(frame);
  }

  Result<TrackedJoint> readJoint(int firstColumn) const {
    TrackedJoint joint;
    for (int axis = 0; axis < 3; ++axis) {
      LORICA_TRY(joint.position[axis],
                 number(firstColumn + axis, -kLargestCoordinate, kLargestCoordinate, "metres within +-100"));
    }
    LORICA_TRY(joint.orientation, readOrientation(firstColumn + 3));
    LORICA_TRY(joint.confidence, number(firstColumn + kFieldsPerJoint - 1, 0.0, 1.0, "a confidence from 0 to 1"));
    return joint;
  }

  Result<std::optional<Quat>> readOrientation(int firstColumn) const {
    int emptyFields = 0;
    for (int i = 0; i < 4; ++i) emptyFields += field(firstColumn + i).empty() ? 1 : 0;
    if (emptyFields == 4) return std::optional<Quat>{};

    Quat q;
    for (int i = 0; i < 4; ++i) {
      const int column = firstColumn + i;
      if (field(column).empty()) return badField(column, "all four quaternion fields or none");
      LORICA_TRY(q.coeffs()[i], number(column, -kInfinity, kInfinity, {}));
    }
    const double length = q.coeffs().stableNorm();
    if (!(std::abs(length - 1.0) <= kQuaternionTolerance)) {
      return badField(firstColumn, fmt::format("a quaternion of length {:.4g}", length),
                      fmt::format("length 1 +- {:g}", kQuaternionTolerance));
    }
    if (std::abs(length - 1.0) > kUnitAlready) q.coeffs() /= length;
    return std::optional<Quat>(q);
  }

  Result<void> append(const SkeletonFrame& frame) {
    const auto [entry, isNew] = indexOfUser_.try_emplace(frame.user, users_.size());
    if (isNew) users_.emplace_back();
    User& user = users_[entry->second];
    if (!user.frames.empty() && frame.time <= user.frames.back().time) {
      return badField(0, fmt::format("more than {} (line {}): time must increase for user {}", user.frames.back().time,
                                     user.lastLine, frame.user));
    }
    user.frames.push_back(frame);
    user.lastLine = line_;
    return {};
  }

  void split(std::string_view row) {
    fields_.clear();
    for (std::size_t begin = 0;;) {
      const std::size_t comma = row.find(',', begin);
      fields_.push_back(row.substr(begin, comma - begin));
      if (comma == std::string_view::npos) return;
      begin = comma + 1;
    }
  }

  [[nodiscard]] std::string_view field(int column) const { return fields_[column]; }

  std::string file_;
  int line_ = 0;
  std::vector<std::string_view> fields_;
  std::vector<User> users_;  ///< in order of first appearance
  std::map<int, std::size_t> indexOfUser_;
};

/// Applies the checks of readJointCsv to frames in memory.
Result<void> checkFrames(std::span<const SkeletonFrame> frames) {
  if (frames.empty()) return invalidArgument("found no frames to write, expected at least one");
  std::map<int, double> lastTimeOfUser;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const SkeletonFrame& frame = frames[f];
    if (!(std::abs(frame.time) <= kLargestTime)) {
      return invalidArgument("frame {}, time: found {}, expected seconds within +-1e12", f, frame.time);
    }
    const auto [last, isNew] = lastTimeOfUser.try_emplace(frame.user, frame.time);
    if (!isNew && frame.time <= last->second) {
      return invalidArgument("frame {}, time: found {}, expected more than {}: time must increase for user {}", f,
                             frame.time, last->second, frame.user);
    }
    last->second = frame.time;
    for (int j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& joint = frame.joints[j];
      const std::string_view name = nameOf(static_cast<BodyJoint>(j));
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(joint.position[axis]) <= kLargestCoordinate) continue;
        return invalidArgument("frame {}, {}.{}: found {}, expected metres within +-{:g}", f, name, "xyz"[axis],
                               joint.position[axis], kLargestCoordinate);
      }
      if (joint.orientation && !(std::abs(joint.orientation->coeffs().stableNorm() - 1.0) <= kQuaternionTolerance)) {
        return invalidArgument("frame {}, {}: found a quaternion of length {:.4g}, expected length 1 +- {:g}", f, name,
                               joint.orientation->coeffs().stableNorm(), kQuaternionTolerance);
      }
      if (!(joint.confidence >= 0.0 && joint.confidence <= 1.0)) {
        return invalidArgument("frame {}, {}.confidence: found {}, expected 0 to 1", f, name, joint.confidence);
      }
    }
  }
  return {};
}

class RecordedSource final : public SkeletonSource {
 public:
  explicit RecordedSource(std::vector<SkeletonFrame> frames) : frames_(std::move(frames)) {}

  Result<std::optional<SkeletonFrame>> next() override {
    if (next_ == frames_.size()) return std::optional<SkeletonFrame>{};
    return std::optional<SkeletonFrame>(frames_[next_++]);
  }

 private:
  std::vector<SkeletonFrame> frames_;
  std::size_t next_ = 0;
};

}  // namespace

Result<std::vector<SkeletonFrame>> readJointCsv(const std::filesystem::path& file) {
  LORICA_TRY(const std::string text, readFile(file));
  return parseJointCsv(text, file.string());
}

Result<std::vector<SkeletonFrame>> parseJointCsv(std::string_view text, std::string_view name) {
  LORICA_TRY(auto people, parseJointCsvOfAll(text, name));
  // On a tie, the first one.
  auto max =
      std::max_element(people.begin(), people.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return std::move(*max);
}

Result<std::vector<std::vector<SkeletonFrame>>> parseJointCsvOfAll(std::string_view text, std::string_view name) {
  return Reader(std::string(name)).read(text);
}

std::string jointCsvHeader() {
  std::string text;
  for (int column = 0; column < kFieldCount; ++column) {
    if (column > 0) text += ',';
    text += columnName(column);
  }
  text += '\n';
  return text;
}

std::string jointCsvRow(const SkeletonFrame& frame) {
  // fmt writes a double as the shortest text that reads back as the same bits, in any locale.
  std::string text = fmt::format("{},{}", frame.time, frame.user);
  for (const TrackedJoint& joint : frame.joints) {
    text += fmt::format(",{},{},{}", joint.position.x(), joint.position.y(), joint.position.z());
    if (joint.orientation) {
      const Quat& q = *joint.orientation;
      text += fmt::format(",{},{},{},{}", q.x(), q.y(), q.z(), q.w());
    } else {
      text += ",,,,";
    }
    text += fmt::format(",{}", joint.confidence);
  }
  text += '\n';
  return text;
}

Result<void> writeJointCsv(const std::filesystem::path& file, std::span<const SkeletonFrame> frames) {
  if (const Result<void> checked = checkFrames(frames); !checked) {
    return Error{checked.error().code, fmt::format("{}: {}", file.string(), checked.error().message)};
  }
  std::string text = jointCsvHeader();
  for (const SkeletonFrame& frame : frames) text += jointCsvRow(frame);
  return writeFileAtomically(file, text);
}

std::unique_ptr<SkeletonSource> makeRecordedSource(std::vector<SkeletonFrame> frames) {
  return std::make_unique<RecordedSource>(std::move(frames));
}

Result<JointCsvWriter> JointCsvWriter::create(const fs::path& file) {
  fs::path beside = file;
  beside.replace_extension(".part.csv");
  LORICA_TRY(std::optional<fs::path> found, keepFound(beside));
  LORICA_TRY(const int descriptor, createPart(beside));
  JointCsvWriter writer(file, beside, descriptor);
  writer.found_ = std::move(found);
  LORICA_TRY_DO(writer.write(jointCsvHeader()));
  return writer;
}

JointCsvWriter::JointCsvWriter(fs::path target, fs::path beside, int descriptor)
    : target_(std::move(target)), beside_(std::move(beside)), descriptor_(descriptor) {}

JointCsvWriter::JointCsvWriter(JointCsvWriter&& other) noexcept
    : target_(std::move(other.target_)),
      beside_(std::move(other.beside_)),
      found_(std::move(other.found_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      rows_(other.rows_),
      lastTimes_(std::move(other.lastTimes_)) {}

JointCsvWriter::~JointCsvWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> JointCsvWriter::write(const std::string& text) {
  LORICA_CHECK(descriptor_ >= 0, "joints cannot be added to a finished file");
  // Usually in one piece, so that a killed program leaves no partial row.
  const int error = writeAll(descriptor_, text);
  return error == 0 ? Result<void>() : unwritable(beside_, error);
}

Result<void> JointCsvWriter::add(const SkeletonFrame& frame) {
  const auto last = lastTimes_.find(frame.user);
  if (last != lastTimes_.end() && !(frame.time > last->second)) {
    return invalidArgument("{}: found a frame of user {} at {} s after one at {} s, expected increasing times",
                           beside_.string(), frame.user, frame.time, last->second);
  }
  // Check with the reader: a single row that it rejects would make the whole file unreadable.
  static const std::string kHeader = jointCsvHeader();
  const std::string row = jointCsvRow(frame);
  LORICA_TRY_DO(parseJointCsv(kHeader + row, beside_.string()));
  LORICA_TRY_DO(write(row));
  lastTimes_[frame.user] = frame.time;
  ++rows_;
  return {};
}

Result<int> JointCsvWriter::finish() {
  if (::close(std::exchange(descriptor_, -1)) != 0) return unwritable(beside_, errno);
  std::error_code error;
  if (rows_ == 0) {
    fs::remove(beside_, error);
    return 0;
  }
  fs::rename(beside_, target_, error);
  if (error) return unwritable(target_, error.value());
  return rows_;
}

// See CMakeLists.txt.
std::span<const std::uint8_t> walkFile();
std::span<const std::uint8_t> waveFile();
std::span<const std::uint8_t> jumpingJacksFile();
std::span<const std::uint8_t> squatAndReachFile();
std::span<const std::uint8_t> punchAndKickFile();
std::span<const std::uint8_t> turnAroundFile();

std::string_view shippedText(std::string_view name) {
  constexpr std::array kFiles = {walkFile,          waveFile,         jumpingJacksFile,
                                 squatAndReachFile, punchAndKickFile, turnAroundFile};
  const auto found = std::ranges::find(kShippedMotions, name);
  if (found == kShippedMotions.end()) return {};
  const std::span<const std::uint8_t> bytes = kFiles[found - kShippedMotions.begin()]();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<SkeletonFrame> shippedFrames(std::string_view name) {
  return parseJointCsv(shippedText(name), name).value();
}

}  // namespace lorica
