#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lorica::test {

/// A file of the third-party data (CMake option LORICA_DATASETS); empty if it is absent.
[[nodiscard]] std::filesystem::path dataset(std::string_view relative);

/// A file or folder of the source tree.
[[nodiscard]] std::filesystem::path sourceFile(std::string_view relative);

/// A program, module or folder of the build: "lorica". Paths are asked for here and are no compile definitions, with
/// which ccache would have nothing for a tree that lies elsewhere.
[[nodiscard]] std::filesystem::path built(std::string_view relative);

/// Folder of the recordings that ship with Lorica.
[[nodiscard]] std::filesystem::path recordingsFolder();

/// A temporary folder, removed when this goes out of scope.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Writes a file into the folder and returns its path.
  std::filesystem::path write(std::string_view name, std::string_view content) const;

 private:
  std::filesystem::path path_;
};

}  // namespace lorica::test

/// Skips the test with a message if a third-party file is absent. Declares `const std::filesystem::path name`.
#define LORICA_REQUIRE_DATASET(name, relative)                          \
  const std::filesystem::path name = ::lorica::test::dataset(relative); \
  if (name.empty()) GTEST_SKIP() << relative << " is absent: pass -DLORICA_DATASETS=<folder> to CMake"
