#include "geometry/files.h"
#include "skinning/import/character_file.h"
#include "tests/skinning/import/glb_writer.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace lorica {
namespace {

/// The fuzzer's seeds and the crashes it once found: read or rejected, with the same result each time.
TEST(GltfCorpus, IsReadOrRefusedAndNothingElse) {
  const std::filesystem::path folder = test::recordingsFolder().parent_path() / "tests" / "fuzz" / "corpus" / "glb";
  int read = 0;
  int refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    const std::string content = test::valueOf(readFile(entry.path()));
    std::string glb = content;
    if (!glb.starts_with("glTF")) {  // JSON, a zero byte, binary
      const std::size_t zero = std::min(glb.find('\0'), glb.size());
      glb = test::glbOf(glb.substr(0, zero), zero < glb.size() ? glb.substr(zero + 1) : "");
    }
    const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(glb)), "corpus.glb");
    (file.ok() ? read : refused) += 1;
    if (file.ok() && !file->character.mesh.vertices.empty()) {
      EXPECT_TRUE(checkCharacter(file->character).ok());
    }
    // A file named as valid must stay valid.
    const std::string name = entry.path().filename().string();
    for (const char* sound : {"small", "random", "vrm", "datauri"}) {
      EXPECT_TRUE(file.ok() || !name.starts_with(sound)) << file.error().message;
    }
  }
  EXPECT_GT(read, 10);
}

}  // namespace
}  // namespace lorica
