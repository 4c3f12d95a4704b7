#pragma once

#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "geometry/result.h"

#include <filesystem>
#include <memory>
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
  std::string temporary_;                // empty = there is none
  int descriptor_ = -1;
  std::unique_ptr<AtHardStop> cleaning_;
};

}  // namespace lorica
