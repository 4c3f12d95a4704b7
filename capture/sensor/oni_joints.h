#pragma once

#include "capture/skeleton_frame.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace lorica {

/// Writes joints as they arrive to a joint CSV (recordings/FORMAT.md) beside a recording. Each row is passed to the
/// system before add() returns, so a killed program loses none.
class JointCsvWriter {
 public:
  /// Creates a file beside `file`, named x.part.csv. It can be read at any time. If a killed program left such a file
  /// behind, it is kept as x.found-1.csv.
  [[nodiscard]] static Result<JointCsvWriter> create(const std::filesystem::path& file);
  JointCsvWriter(JointCsvWriter&& other) noexcept;
  JointCsvWriter& operator=(JointCsvWriter&&) = delete;
  /// Rows that were written but not finished stay in x.part.csv.
  ~JointCsvWriter();

  /// The file that a killed program left behind, under its new name.
  [[nodiscard]] const std::optional<std::filesystem::path>& found() const { return found_; }
  /// @return an error if the format cannot represent the frame, which is then left out, or if the disk is full
  [[nodiscard]] Result<void> add(const SkeletonFrame& frame);
  /// Renames the file to its final name. @return number of rows; if 0, no file is left
  [[nodiscard]] Result<int> finish();

 private:
  JointCsvWriter(std::filesystem::path target, std::filesystem::path beside, int descriptor);
  Result<void> write(const std::string& text);

  std::filesystem::path target_;
  std::filesystem::path beside_;
  std::optional<std::filesystem::path> found_;
  int descriptor_;
  int rows_ = 0;
  std::map<int, double> lastTimes_;  ///< of each user
};

}  // namespace lorica
