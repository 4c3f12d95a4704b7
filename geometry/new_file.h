#pragma once

#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "geometry/result.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// A file that is written piece by piece, but completely or not at all: a temporary file in the same folder, which
/// finish() renames to the target. Without that, nothing is left of it. Internal: not installed.
class NewFile {
 public:
  [[nodiscard]] static Result<std::unique_ptr<NewFile>> create(const std::filesystem::path& file,
                                                               NamedBy by = NamedBy::kUser);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Appends a piece.
  [[nodiscard]] Result<void> write(std::string_view piece);
  /// Flushes the file and renames it. Nothing can be written afterwards.
  [[nodiscard]] Result<void> finish();

 private:
  NewFile(std::filesystem::path file, std::filesystem::path target);
  [[nodiscard]] Error failed(int error);

  std::filesystem::path file_, target_;  // as named, and what is replaced
  std::filesystem::path temporary_;      // empty = there is none
  int descriptor_ = -1;
  std::unique_ptr<AtHardStop> cleaning_;
};

/// Makes place for a new file NAME.part.EXTENSION that is written while something is recorded: one that a killed
/// program left behind is renamed to NAME.found-1.EXTENSION, or the next free number.
/// @return its new name, nothing if there was none, or an error: another program is writing to it (it holds a lock, see
///         createPart()), or the folder is not writable
[[nodiscard]] Result<std::optional<std::filesystem::path>> keepFound(const std::filesystem::path& part);

/// Creates such a file, locked until its descriptor is closed, for appending.
/// @return the descriptor, or an error: it exists, or the folder is not writable
[[nodiscard]] Result<int> createPart(const std::filesystem::path& part);

}  // namespace lorica
