#include "tests/bake/faulty_files.h"

namespace lorica::test {

Result<std::string> FaultyFiles::read(const std::filesystem::path& file) {
  if (notSeen.contains(file)) return Error{ErrorCode::kNotFound, file.string() + ": not seen yet"};
  return FileLayer::read(file);
}

bool FaultyFiles::exists(const std::filesystem::path& file) {
  return !notSeen.contains(file) && FileLayer::exists(file);
}

int FaultyFiles::create(const std::filesystem::path& file, std::string_view content) {
  if (createError != 0) return createError;
  const int error = FileLayer::create(file, content);
  return error == 0 && loseCreateAnswers-- > 0 ? EEXIST : error;
}

int FaultyFiles::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (beforeRename) beforeRename();
  if (failRenames-- > 0) return EIO;
  const int error = FileLayer::rename(from, to);
  return error == 0 && loseRenameAnswers-- > 0 ? ENOENT : error;
}

}  // namespace lorica::test
