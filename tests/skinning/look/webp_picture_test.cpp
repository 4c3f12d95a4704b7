#include "tests/skinning/look/picture_samples.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <webp/encode.h>

#include <cstdlib>

namespace lorica::test {
namespace {

std::string webpOf(const Picture& picture, bool lossless) {
  std::uint8_t* bytes = nullptr;
  const std::size_t size =
      lossless ? WebPEncodeLosslessRGBA(picture.rgba.data(), picture.width, picture.height, 4 * picture.width, &bytes)
               : WebPEncodeRGBA(picture.rgba.data(), picture.width, picture.height, 4 * picture.width, 90.0F, &bytes);
  std::string file(reinterpret_cast<const char*>(bytes), size);
  WebPFree(bytes);
  return file;
}

TEST(WebpPicture, LosslessOnesAreExactAndLossyOnesClose) {
  Picture picture = smoothPicture(37, 21);
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 255;
  EXPECT_EQ(valueOf(decoded(webpOf(picture, true))).rgba, picture.rgba);
  const Picture lossy = valueOf(decoded(webpOf(picture, false)));
  ASSERT_EQ(lossy.rgba.size(), picture.rgba.size());
  int farthest = 0;
  for (std::size_t i = 0; i < lossy.rgba.size(); ++i) {
    farthest = std::max(farthest, std::abs(int{lossy.rgba[i]} - int{picture.rgba[i]}));
  }
  EXPECT_LE(farthest, 40);
}

TEST(WebpPicture, ItsSizeIsKnownAndLimited) {
  const std::string file = webpOf(smoothPicture(64, 32), true);
  const PictureSize size = valueOf(readPictureSize(exactBytes(file), "a"));
  EXPECT_EQ(size.width, 64);
  EXPECT_EQ(size.height, 32);
  EXPECT_EQ(valueOf(decoded(file, 16)).width, 16);
}

TEST(WebpPicture, EveryTruncatedPrefixIsRefused) {
  const std::string file = webpOf(smoothPicture(16, 16), true);
  for (std::size_t length = 12; length + 1 < file.size(); ++length) {
    EXPECT_FALSE(decoded(file.substr(0, length)).ok()) << length;
  }
  expectRefused(decoded("RIFF....WEBPVP8 "), ErrorCode::kBadFormat, "a WebP picture of 16 bytes that is damaged");
}

}  // namespace
}  // namespace lorica::test
