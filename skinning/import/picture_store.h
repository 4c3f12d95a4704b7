#pragma once

#include "geometry/named_file.h"
#include "skinning/import/file_scene.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>

namespace lorica {

/// Collects the pictures of a file's materials, still encoded. A picture that is not available becomes -1 and a note.
///
/// Other files are read only where NamedFiles finds them, each once. Pictures from the file's own bytes
/// may have `allowance` bytes together, since a small file may refer to the same bytes many times.
class PictureStore {
 public:
  /// @param files  where other files are searched; an empty folder: other files are not read
  PictureStore(NamedFiles files, std::size_t allowance, FileScene& scene, CountedNotes& notes)
      : files_(std::move(files)), allowance_(allowance), scene_(scene), notes_(notes) {}

  /// @param name  for messages: "image 3 'hair'"
  /// @return index into FileScene::pictures, or -1
  [[nodiscard]] int addBytes(const std::string& name, std::span<const std::byte> bytes);

  /// Reads a URI as in glTF: a data URI, or a percent-encoded relative path.
  [[nodiscard]] int addUri(const std::string& name, const std::string& uri);

  /// Reads a path as FBX and COLLADA have it. These name a file on their author's machine: if the path does not lead to
  /// a file in the folder, the file of the same name beside the character is used, with a note.
  [[nodiscard]] int addPath(const std::string& name, const std::string& path);

  /// Notes why a picture is not available. @return -1
  int refuse(const std::string& name, const std::string& why);

 private:
  [[nodiscard]] int addFile(const std::string& name, const std::string& relative);

  NamedFiles files_;
  std::size_t allowance_;
  FileScene& scene_;
  CountedNotes& notes_;
  std::map<std::filesystem::path, int> known_;  ///< by their paths
};

}  // namespace lorica
