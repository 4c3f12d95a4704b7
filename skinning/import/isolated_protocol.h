#pragma once

#include "geometry/named_file.h"
#include "skinning/import/assimp_file.h"

#include <string>
#include <string_view>

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
