#include "skinning/import/bone_map.h"
#include "skinning/mannequin/mannequin.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

/// Any text as a bone map, applied to the mannequin.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  static const Skeleton mannequin = makeMannequin().skeleton;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Result<BoneMap> map = parseBoneMap(text, "fuzz");
  if (!map) {
    LORICA_CHECK(map.error().message.rfind("fuzz", 0) == 0, "an error that does not name the file");
    return 0;
  }
  const Result<Skeleton> mapped = applyBoneMap(mannequin, *map, "fuzz");
  if (mapped) LORICA_CHECK(mapped->jointCount() == mannequin.jointCount(), "joints got lost");
  return 0;
}
