#include "skinning/import/isolated_scene.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

/// Any bytes as the answer of a process that a hostile file has taken over. What is accepted is built, too.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  Result<FileScene> scene = isolated::decodeAnswer({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!scene) return 0;
  const Result<CharacterFile> file = makeCharacterFile(std::move(*scene), "fuzz");
  if (file && !file->character.mesh.vertices.empty()) {
    LORICA_CHECK(checkCharacter(file->character).ok(), "what is read passes checkCharacter()");
  }
  return 0;
}
