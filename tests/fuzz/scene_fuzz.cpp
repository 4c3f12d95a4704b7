#include "session/scenes/scene_file.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Any text as a scene. There are no files to name; what is accepted must be sound.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  SceneReading reading;
  reading.folder = "/nowhere";
  const Result<SceneFile> scene = parseScene(text, "fuzz", reading);
  if (!scene) {
    LORICA_CHECK(scene.error().message.rfind("fuzz", 0) == 0, "an error that does not name the file");
    LORICA_CHECK(scene.error().message.size() < 2000, "an error that repeats the file");
    return 0;
  }
  LORICA_CHECK(scene->props.size() <= 2000, "too many props");
  for (const Prop& prop : scene->props) {
    LORICA_CHECK(prop.worldFromProp.matrix().allFinite() && prop.halfExtents.allFinite(), "a prop nowhere");
    LORICA_CHECK(prop.mass >= 0.0 && prop.mass <= 1e4, "an impossible mass");
  }
  for (const SceneFile::Link& link : scene->links) {
    LORICA_CHECK(link.a >= 0 && link.a < static_cast<int>(scene->props.size()), "a link without a prop");
  }
  return 0;
}
