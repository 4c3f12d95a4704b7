#pragma once

#include "geometry/named_file.h"
#include "skinning/import/character_file.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/scene_readers.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// What the process that reads a file may use.
struct IsolationLimits {
  std::uint64_t cpuSeconds = 0;
  std::uint64_t memoryBytes = 0;  ///< beside the program itself; the result may have as many bytes
  std::uint64_t stackBytes = 0;
};

/// The limits for a file of this size.
[[nodiscard]] IsolationLimits isolationLimits(std::uint64_t fileBytes);

/// readAssimpScene() in another process.
[[nodiscard]] Result<FileScene> readIsolatedScene(std::span<const std::byte> bytes, const std::string& name,
                                                  AssimpFormat format, const NamedFiles& files,
                                                  const IsolatedReader& reader);

/// What AssimpSceneReader fills of a scene as bytes, to hand it from one process of this program to another. Numbers
/// keep their bits. Not a file format: both processes run the same program.
[[nodiscard]] std::string encodeScene(const FileScene& scene);

/// The scene of encodeScene(). The bytes may come from a process that a hostile file has taken over: every length is
/// checked against what is left, and every promise of FileScene before it is returned.
/// @param name  of the file, for messages
[[nodiscard]] Result<FileScene> decodeScene(std::string_view bytes, const std::string& name);

}  // namespace lorica

/// What IsolatedReader and serveIsolatedReader() tell each other. Both are one program.
namespace lorica::isolated {

/// Exit status of a reader that has used all its memory.
inline constexpr int kOutOfMemory = 3;

/// What precedes the bytes of the file in a question.
struct Head {
  AssimpFormat format = AssimpFormat::kFbx;
  std::string name;
  NamedFiles files;
};

[[nodiscard]] std::string encodeHead(AssimpFormat format, const std::string& name, const NamedFiles& files);
/// @param question  receives what follows the head: the bytes of the file
[[nodiscard]] Result<Head> decodeHead(std::string_view& question);

[[nodiscard]] std::string encodeAnswer(const Result<FileScene>& answer);
/// Nothing of the answer is believed unchecked, see decodeScene(). @param name  of the file, for messages
[[nodiscard]] Result<FileScene> decodeAnswer(std::string_view answer, const std::string& name);

}  // namespace lorica::isolated
