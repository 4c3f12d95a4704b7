#include "capture/sensor/oni_depth_codec.h"

#include "geometry/random_numbers.h"
#include "tests/capture/sensor/oni_writer.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lorica {
namespace {

constexpr OniCodec kCodecs[] = {OniCodec::kRaw, OniCodec::kPacked, OniCodec::kTable};

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Surfaces with edges, holes and uniform walls, so that every packing mode occurs.
std::vector<std::uint16_t> someDepths(RandomNumbers& random, std::size_t count, double rough) {
  std::vector<std::uint16_t> depths(count);
  double depth = 2000.0;
  for (std::uint16_t& d : depths) {
    const double dice = random.unit();
    if (dice < 0.05 * rough) depth = random.between(400.0, 9000.0);
    if (dice > 1.0 - rough) depth += random.between(-9.0, 9.0);
    d = dice > 0.4 && dice < 0.4 + 0.1 * rough ? std::uint16_t{0} : static_cast<std::uint16_t>(depth);
  }
  return depths;
}

TEST(OniDepthCodec, BytesMeanWhatTheFormatSays) {
  // 1000; 1000 + 1 and + 6; + 0 and a difference of -20; two pairs alike; 0x1234; 0x1235 alone.
  const std::string packed("\xe8\x03\x50\x6f\xac\xe2\xff\x12\x34\x5d", 10);
  const std::vector<std::uint16_t> expected = {1000, 1001, 1007, 1007, 1027, 1027, 1027, 1027, 1027, 0x1234, 0x1235};
  std::vector<std::uint16_t> depths(expected.size());
  OniDepthDecoder decoder;
  const Result<void> decoded = decoder.decode(OniCodec::kPacked, bytesOf(packed), depths);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(depths, expected);
}

TEST(OniDepthCodec, UnpackingUndoesPacking) {
  RandomNumbers random(7);
  OniDepthDecoder decoder;
  for (const OniCodec codec : kCodecs) {
    for (const std::size_t count : {1, 2, 3, 30, 31, 32, 33, 1000, 1001}) {
      for (const double rough : {0.0, 0.02, 0.3, 1.0}) {
        const std::vector<std::uint16_t> depths = someDepths(random, count, rough);
        std::vector<std::uint16_t> read(count, 1);
        const Result<void> decoded = decoder.decode(codec, bytesOf(test::packOniDepth(codec, depths)), read);
        ASSERT_TRUE(decoded) << decoded.error().message;
        ASSERT_EQ(read, depths) << count << " pixels, roughness " << rough;
      }
    }
  }
}

TEST(OniDepthCodec, ImagesOfAnotherSizeAreRefused) {
  RandomNumbers random(8);
  OniDepthDecoder decoder;
  for (const OniCodec codec : kCodecs) {
    const std::string packed = test::packOniDepth(codec, someDepths(random, 100, 0.3));
    std::vector<std::uint16_t> fewer(99);
    std::vector<std::uint16_t> more(101);
    EXPECT_FALSE(decoder.decode(codec, bytesOf(packed), fewer));
    EXPECT_FALSE(decoder.decode(codec, bytesOf(packed), more));
    EXPECT_FALSE(decoder.decode(codec, {}, fewer));
  }
}

TEST(OniDepthCodec, ValuesBeyondTheTableAreRefused) {
  // One entry, 700. The second pixel refers to entry 1, as a value and as a difference.
  std::vector<std::uint16_t> depths(2);
  OniDepthDecoder decoder;
  EXPECT_TRUE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\1\0\xbc\2\0\0\x6d", 7)), depths));
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\1\0\xbc\2\0\0\xff\0\1", 9)), depths));
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\1\0\xbc\2\0\0\x5d", 7)), depths));
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\0\0\0\0", 4)), depths)) << "an empty table";
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\xff\xff\0\0", 4)), depths))
      << "a truncated table";
}

TEST(OniDepthCodec, AnyBytesGiveAnImageOrASentence) {
  RandomNumbers random(9);
  OniDepthDecoder decoder;
  std::vector<std::uint16_t> depths(64);
  int images = 0;
  for (int i = 0; i < 20000; ++i) {
    const OniCodec codec = kCodecs[i % 3];
    std::string packed = test::packOniDepth(codec, someDepths(random, 64, 0.5));
    for (int flips = 1 + static_cast<int>(3.0 * random.unit()); flips > 0; --flips) {
      packed[random.bits() % packed.size()] ^= static_cast<char>(1 + random.bits() % 255);
    }
    if (i % 7 == 0) packed.resize(random.bits() % packed.size());
    // Heap blocks of exactly this size, so that a sanitizer detects any read beyond them.
    const std::vector<std::uint8_t> exact(packed.begin(), packed.end());
    const Result<void> decoded = decoder.decode(codec, exact, depths);
    if (decoded) ++images;
    if (!decoded) {
      EXPECT_NE(decoded.error().message.find("expected"), std::string::npos) << decoded.error().message;
    }
  }
  EXPECT_GT(images, 1000) << "mostly flipped depths";
  EXPECT_LT(images, 19000);
}

}  // namespace
}  // namespace lorica
