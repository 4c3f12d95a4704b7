#pragma once

#include "capture/skeleton_frame.h"

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Reads and checks all of a file in Lorica's joint CSV format (recordings/FORMAT.md), including the rows of every
/// user.
/// @return frames of one user in time order, at least one: the user with the most frames, or the first of them in the
/// file if several have as many; or an error with file, line, column, found and expected
[[nodiscard]] Result<std::vector<SkeletonFrame>> readJointCsv(const std::filesystem::path& file);

/// Reads joint CSV text in memory. @param name  name of the text in error messages
[[nodiscard]] Result<std::vector<SkeletonFrame>> parseJointCsv(std::string_view text, std::string_view name);

/// Returns the frames of every user, users in order of first appearance, frames in time order.
[[nodiscard]] Result<std::vector<std::vector<SkeletonFrame>>> parseJointCsvOfAll(std::string_view text,
                                                                                 std::string_view name);

/// Writes joint CSV, completely or not at all. Reading it back gives bit-identical numbers, except for quaternions
/// whose length differs from 1 by more than 1e-12: these are normalised on reading.
/// @param frames  at least one; rejected if readJointCsv would reject the file
[[nodiscard]] Result<void> writeJointCsv(const std::filesystem::path& file, std::span<const SkeletonFrame> frames);

/// The header line and the line of one frame, each with its line end, for writing frames as they arrive. The frame is
/// not checked.
[[nodiscard]] std::string jointCsvHeader();
/// One frame as a line, without its end.
[[nodiscard]] std::string jointCsvRow(const SkeletonFrame& frame);

/// A SkeletonSource that reads from frames in memory.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeRecordedSource(std::vector<SkeletonFrame> frames);

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

/// The motions that ship with Lorica, without noise: recordings/NAME.csv. Programs have them whether or not that folder
/// is installed.
inline constexpr std::array<std::string_view, 6> kShippedMotions = {
    "walk", "wave", "jumping_jacks", "squat_and_reach", "punch_and_kick", "turn_around"};

/// The text of such a file; empty if no motion has the name.
[[nodiscard]] std::string_view shippedText(std::string_view name);
/// Its frames. @param name  one of kShippedMotions
[[nodiscard]] std::vector<SkeletonFrame> shippedFrames(std::string_view name);

}  // namespace lorica
