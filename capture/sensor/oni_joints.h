#pragma once

#include "capture/skeleton_frame.h"

#include <filesystem>
#include <map>
#include <string>

namespace lorica {

/// Joints as they come, into a joint CSV (recordings/FORMAT.md) that lies beside a recording. Each row is with the
/// system before add() returns, so a program that is killed loses none.
class JointCsvWriter {
 public:
  /// Begins a file beside `file`, named x.part.csv. It can be read at any time.
  [[nodiscard]] static Result<JointCsvWriter> create(const std::filesystem::path& file);
  JointCsvWriter(JointCsvWriter&& other) noexcept;
  JointCsvWriter& operator=(JointCsvWriter&&) = delete;
  /// What was written and not finished stays in x.part.csv.
  ~JointCsvWriter();

  /// @return an error when the format has no place for such a frame, which is then left out, or the disk is full
  [[nodiscard]] Result<void> add(const SkeletonFrame& frame);
  /// Gives the file its name. @return number of rows; where it is 0 there is no file
  [[nodiscard]] Result<int> finish();

 private:
  JointCsvWriter(std::filesystem::path target, std::filesystem::path beside, int descriptor);
  Result<void> write(const std::string& text);

  std::filesystem::path target_;
  std::filesystem::path beside_;
  int descriptor_;
  int rows_ = 0;
  std::map<int, double> lastTimes_;  ///< of each user
};

}  // namespace lorica
