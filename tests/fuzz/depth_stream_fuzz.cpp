#include "capture/streams/depth_stream.h"
#include "geometry/result.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

/// Any bytes as a depth stream. The first byte says in what pieces they come, and whether the images have headers; what
/// is accepted is undone to a pinhole's images.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  if (size == 0) return 0;
  const std::size_t piece = 1 + data[0] / 2;
  std::optional<BareDepth> bare;
  if (data[0] % 2 != 0) {
    static const BareDepth kSmall = parseBareDepth("gray16be,20x16,fov=60x45").value();
    bare = kSmall;
  }
  DepthFrameParser parser(bare);
  std::optional<DepthRectifier> rectifier;
  DepthFrame frame;
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  while (!rest.empty()) {
    const std::span<std::byte> place = parser.wanted();
    LORICA_CHECK(!place.empty() && place.size() <= std::size_t{2} * 2048 * 2048, "nowhere to write, or too much");
    const std::size_t bytes = std::min({piece, place.size(), rest.size()});
    std::memcpy(place.data(), rest.data(), bytes);
    rest = rest.subspan(bytes);
    const Result<bool> whole = parser.got(bytes);
    if (!whole) {
      LORICA_CHECK(whole.error().message.starts_with("found "), "an error that does not say what was found");
      return 0;
    }
    if (!*whole) continue;
    const DepthLens& lens = parser.lens().value();
    if (!rectifier) rectifier = DepthRectifier::create(lens).value();
    (void)checkDepthUnit(lens, parser.image());
    rectifier->apply(parser.image(), frame.depthMm);
    const DepthCamera& camera = rectifier->camera();
    LORICA_CHECK(
        frame.depthMm.size() == static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height),
        "an image of another size");
  }
  (void)parser.restart();
  return 0;
}
