#include "geometry/errors.h"
#include "skinning/look/picture_formats.h"
#include "skinning/look/picture_shrink.h"

#include <webp/decode.h>

namespace lorica {
namespace {

const std::uint8_t* dataOf(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

Error damaged(std::span<const std::byte> bytes, const std::string& name) {
  return badFormat("{}: a WebP picture of {} bytes that is damaged or cut off", name, bytes.size());
}

}  // namespace

Result<PictureClaim> webpClaim(std::span<const std::byte> bytes, const std::string& name) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(dataOf(bytes), bytes.size(), &features) != VP8_STATUS_OK) return damaged(bytes, name);
  if (features.has_animation != 0) return unsupported("{}: an animated WebP picture, expected a still one", name);
  PictureClaim claim{static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height), 0};
  // One copy in a lossless picture repeats at most 4096 pixels.
  claim.fewestBytes = std::uint64_t{claim.width} * claim.height / (4 * 4096);
  return claim;
}

Result<Picture> decodeWebp(std::span<const std::byte> bytes, const std::string& name, const PictureLimits& limits) {
  LORICA_TRY(const PictureClaim claim, webpClaim(bytes, name));
  LORICA_TRY_DO(checkClaim(claim, bytes.size(), name));
  Picture picture{static_cast<int>(claim.width), static_cast<int>(claim.height), {}};
  picture.rgba.resize(std::size_t{4} * claim.width * claim.height);
  if (WebPDecodeRGBAInto(dataOf(bytes), bytes.size(), picture.rgba.data(), picture.rgba.size(), 4 * picture.width) ==
      nullptr) {
    return damaged(bytes, name);
  }
  return shrunk(std::move(picture), limits.largestSide);
}

}  // namespace lorica
