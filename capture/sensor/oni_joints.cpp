#include "capture/sensor/oni_joints.h"

#include "capture/files/joint_csv.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/new_file.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

}  // namespace

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

}  // namespace lorica
