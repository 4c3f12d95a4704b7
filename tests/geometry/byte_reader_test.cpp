#include "geometry/byte_reader.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace lorica {
namespace {

template <typename T>
std::string bytesOf(std::initializer_list<T> numbers) {
  std::string bytes;
  for (const T number : numbers) appendLittleEndian(number, bytes);
  return bytes;
}

TEST(ByteReader, ReadsNumbersInOrderAndSaysWhatIsLeft) {
  const std::string bytes = bytesOf<std::uint32_t>({7, 0xFFFFFFFFu}) + bytesOf<double>({-0.5}) + "abc";
  ByteReader reader(bytes);
  EXPECT_EQ(reader.take<std::uint32_t>(), 7u);
  EXPECT_EQ(reader.take<std::int32_t>(), -1);
  EXPECT_EQ(reader.take<double>(), -0.5);
  EXPECT_EQ(reader.left(), 3u);
  EXPECT_EQ(reader.takeText(2), "ab");
  EXPECT_EQ(reader.rest(), "c");
  EXPECT_TRUE(reader.ok());
}

TEST(ByteReader, EveryTruncationFailsAtItsByteAndReadsNothingBeyond) {
  const std::string whole = bytesOf<std::uint32_t>({1, 2, 3});
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::vector<char> exact(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    ByteReader reader({exact.data(), exact.size()}, 0, "x");
    for (int i = 0; i < 3; ++i) (void)reader.take<std::uint32_t>("a number");
    EXPECT_FALSE(reader.ok());
    const std::size_t at = length / 4 * 4;
    EXPECT_EQ(reader.error().message, "x: byte " + std::to_string(at) + ": expected a number (4 bytes), " +
                                          std::to_string(length - at) + " bytes are left");
    EXPECT_EQ(reader.take<std::uint32_t>("another"), 0u) << "after a failure every number is 0";
  }
}

TEST(ByteReader, RangesAndCountsAreChecked) {
  const auto whyNot = [](const std::string& bytes, auto read) {
    ByteReader reader(bytes, 0, "x");
    read(reader);
    return reader.ok() ? std::string() : reader.error().message;
  };
  const auto index = [](ByteReader& r) { (void)r.takeIndex("an index", 0, 5); };
  EXPECT_EQ(whyNot(bytesOf<std::int32_t>({4}), index), "");
  EXPECT_NE(whyNot(bytesOf<std::int32_t>({5}), index), "");
  EXPECT_NE(whyNot(bytesOf<std::int32_t>({-1}), index), "");
  const auto finite = [](ByteReader& r) { (void)r.takeFinite("a length"); };
  EXPECT_EQ(whyNot(bytesOf<double>({1e300}), finite), "");
  EXPECT_NE(whyNot(bytesOf<double>({std::numeric_limits<double>::infinity()}), finite), "");
  // A count whose entries cannot be in the remaining bytes.
  const auto count = [](ByteReader& r) { EXPECT_LE(r.takeCount("the number of points", 8), 1u); };
  EXPECT_EQ(whyNot(bytesOf<std::uint32_t>({1}) + "12345678", count), "");
  EXPECT_NE(whyNot(bytesOf<std::uint32_t>({2}) + "12345678", count), "");
  EXPECT_NE(whyNot(bytesOf<std::uint32_t>({0xFFFFFFFFu}) + "12345678", count), "");
}

}  // namespace
}  // namespace lorica
