#include "tests/support/datasets.h"

#include <cstdlib>
#include <fstream>
#include <random>

namespace lorica::test {

std::filesystem::path dataset(std::string_view relative) {
  const std::filesystem::path root = LORICA_DATASETS;
  if (root.empty()) return {};
  const std::filesystem::path file = root / relative;
  return std::filesystem::exists(file) ? file : std::filesystem::path{};
}

std::filesystem::path sourceFile(std::string_view relative) {
  return std::filesystem::path(LORICA_SOURCE_DIR) / relative;
}

std::filesystem::path built(std::string_view relative) {
  static const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return folder / relative;
}

std::filesystem::path recordingsFolder() {
  return sourceFile("recordings");
}

TemporaryFolder::TemporaryFolder() {
  std::random_device random;
  do {
    path_ = std::filesystem::temp_directory_path() / ("lorica-test-" + std::to_string(random()));
  } while (!std::filesystem::create_directory(path_));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(std::string_view name, std::string_view content) const {
  const std::filesystem::path file = path_ / name;
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

}  // namespace lorica::test
