#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace lorica {

/// The calls on the shared folder of a bake: those of the system, or in tests those of a file server with faults.
/// Numbers are errno, 0 = done.
class FileLayer {
 public:
  FileLayer() = default;
  virtual ~FileLayer() = default;
  FileLayer(const FileLayer&) = delete;
  FileLayer& operator=(const FileLayer&) = delete;

  /// The content of a file; kNotFound if there is none.
  [[nodiscard]] virtual Result<std::string> read(const std::filesystem::path& file);
  [[nodiscard]] virtual bool exists(const std::filesystem::path& file);
  /// Writes a new file. Of several processes that create the same one, one succeeds; the others get EEXIST.
  [[nodiscard]] virtual int create(const std::filesystem::path& file, std::string_view content);
  /// Writes over the start of a file that exists, without another file for a moment.
  [[nodiscard]] virtual int overwrite(const std::filesystem::path& file, std::string_view content);
  [[nodiscard]] virtual int rename(const std::filesystem::path& from, const std::filesystem::path& to);
  [[nodiscard]] virtual int createFolders(const std::filesystem::path& folder);
  /// Makes a symbolic link, or replaces one; anything else at its place stays, and is EEXIST.
  [[nodiscard]] virtual int link(const std::filesystem::path& target, const std::filesystem::path& link);
  /// Removes a folder with nothing in it; others stay.
  virtual void removeEmpty(const std::filesystem::path& folder);
  /// Removes a file, or a folder with all that is in it. What is not there is removed already.
  virtual int remove(const std::filesystem::path& path);
};

}  // namespace lorica
