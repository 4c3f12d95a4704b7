#include "acd/packed_numbers.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace lorica {
namespace {

using Numbers = std::vector<std::uint32_t>;

std::string packed(const Numbers& values) {
  std::string bytes;
  appendPacked(values, bytes);
  return bytes;
}

TEST(PackedNumbers, LayoutIsAsDocumented) {
  // Lengths 1, 2, 3, 4 minus 1 in two bits each, lowest first: 0b11100100; then 0b00 for the fifth number.
  EXPECT_EQ(packed({5, 0x0102, 0x030405, 0x06070809, 0xFF}),
            std::string("\xE4\x00\x05\x02\x01\x05\x04\x03\x09\x08\x07\x06\xFF", 13));
  EXPECT_EQ(packed({}), "");
}

TEST(PackedNumbers, AnyNumbersAndCountsComeBack) {
  std::mt19937 random(7);
  for (std::size_t count = 0; count < 70; ++count) {
    Numbers values(count);
    for (std::uint32_t& value : values) value = random() >> (random() % 32);
    // With and without bytes after the numbers.
    for (const std::string& after : {std::string(), std::string("\xFF\xFF"), std::string(40, '\xFF')}) {
      const std::string bytes = packed(values) + after;
      Numbers read(count, 1);
      const auto taken = unpack(bytes, read);
      ASSERT_TRUE(taken);
      EXPECT_EQ(*taken, bytes.size() - after.size());
      EXPECT_EQ(read, values);
    }
  }
}

TEST(PackedNumbers, BytesThatEndTooSoonAreRefused) {
  const Numbers values = {1, 70000, 3, 400, 5, 1u << 30, 7};
  const std::string bytes = packed(values);
  Numbers read(values.size());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    // A copy of exactly this size, so that a sanitizer detects reads beyond its end.
    const std::vector<char> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_FALSE(unpack({cut.data(), cut.size()}, read)) << length;
  }
}

TEST(PackedNumbers, BitsWithoutANumberAreRefused) {
  std::string bytes = packed({1, 2, 3});
  Numbers read(3);
  bytes[0] = static_cast<char>(0x40);
  EXPECT_FALSE(unpack(bytes + "abcdef", read));
}

TEST(Zigzag, SmallDifferencesOfEitherSignBecomeSmallNumbers) {
  EXPECT_EQ(zigzag(0), 0u);
  EXPECT_EQ(zigzag(0u - 1u), 1u);
  EXPECT_EQ(zigzag(1), 2u);
  EXPECT_EQ(zigzag(0u - 2u), 3u);
  for (const std::uint32_t value : {0u, 1u, 77u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu}) {
    EXPECT_EQ(unzigzag(zigzag(value)), value);
    EXPECT_EQ(zigzag(unzigzag(value)), value);
  }
}

}  // namespace
}  // namespace lorica
