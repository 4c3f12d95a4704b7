#pragma once

#include "bake/file_layer.h"

#include <cerrno>
#include <functional>
#include <set>

namespace lorica::test {

/// A folder on a file server with faults: the real calls, and on demand what NFS does between them.
class FaultyFiles final : public FileLayer {
 public:
  int failRenames = 0;              ///< the next ones do nothing and return EIO
  int loseRenameAnswers = 0;        ///< the next ones are done and return ENOENT, like a repeated request
  int loseCreateAnswers = 0;        ///< the next ones are done and return EEXIST
  int createError = 0;              ///< of all: ENOSPC, EROFS
  std::set<std::string> notSeen{};  ///< paths that exist() and read() do not see yet: a stale listing
  std::function<void()> beforeRename{};

  [[nodiscard]] Result<std::string> read(const std::filesystem::path& file) override;
  [[nodiscard]] bool exists(const std::filesystem::path& file) override;
  [[nodiscard]] int create(const std::filesystem::path& file, std::string_view content) override;
  [[nodiscard]] int rename(const std::filesystem::path& from, const std::filesystem::path& to) override;
};

}  // namespace lorica::test
