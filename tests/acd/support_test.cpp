#include "acd/support.h"

#include "acd/packed_numbers.h"
#include "geometry/convex_hull.h"
#include "tests/acd/hard_meshes.h"
#include "tests/support/meshes.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace lorica {
namespace {

using Numbers = std::vector<std::uint32_t>;

FloatPoints floats(std::span<const Vec3> points) {
  FloatPoints result;
  result.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.x[i] = static_cast<float>(points[i].x());
    result.y[i] = static_cast<float>(points[i].y());
    result.z[i] = static_cast<float>(points[i].z());
  }
  return result;
}

std::vector<Vec3> randomPoints(test::Dice& dice, int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(dice.inBox(1.0));
  return points;
}

Support supportOf(std::span<const Vec3> points, std::int32_t first = 0) {
  std::vector<std::int32_t> ids(points.size());
  std::iota(ids.begin(), ids.end(), 0);
  Support support;
  support.clear();
  include(support, floats(points), ids, first, nullptr);
  return support;
}

double enclosed(std::span<const Vec3> points) {
  return enclosedVolume(supportOf(points), floats(points), {});
}

/// The positive direction of each pair: a point's coordinates along it are those of the axes' unit points.
std::vector<Vec3f> directions() {
  const Support x = supportOf(std::array{Vec3(1, 0, 0)}), y = supportOf(std::array{Vec3(0, 1, 0)}),
                z = supportOf(std::array{Vec3(0, 0, 1)});
  std::vector<Vec3f> result;
  for (std::size_t i = 0; i < Support::kPairs; ++i) result.emplace_back(x.high[i], y.high[i], z.high[i]);
  return result;
}

void expectEqual(const Support& a, const Support& b) {
  test::expectSame(a, b, &Support::high, &Support::low, &Support::highest, &Support::lowest);
}

TEST(Support, OfNothingAndOfOnePoint) {
  const std::vector<Vec3> points = {{0.5, -2, 3}, {1, 1, 1}};
  Support empty;
  empty.clear();
  Support same = empty;
  include(same, floats(points), {}, 0, nullptr);
  include(same, empty);
  expectEqual(same, empty);
  for (std::size_t i = 0; i < Support::kPairs; ++i) EXPECT_LT(empty.high[i], empty.low[i]);

  const Support one = supportOf(std::span(points).first(1), 7);
  EXPECT_EQ(one.high, one.low);
  EXPECT_EQ(std::count(one.highest.begin(), one.highest.end(), 7), std::ssize(one.highest));
  EXPECT_EQ(one.lowest, one.highest);
  // The empty set adds nothing to another one, on either side.
  Support left = one, right = empty;
  include(left, empty);
  include(right, one);
  expectEqual(left, one);
  expectEqual(right, one);
}

TEST(Support, DirectionsAreSpreadEvenlyOverTheSphere) {
  const std::vector<Vec3f> all = directions();
  for (const Vec3f& d : all) EXPECT_NEAR(d.norm(), 1.0f, 1e-6f);
  // 46 pairs, then two copies.
  EXPECT_EQ(all[46], all[0]);
  EXPECT_EQ(all[47], all[0]);
  // Neighbours among 92 directions can be up to 23 degrees apart. These are at least 20, and no direction at all is
  // more than 14 degrees from one of them.
  const double degree = std::numbers::pi / 180.0;
  double narrowest = 9.0;
  for (std::size_t i = 0; i < 46; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      narrowest = std::min(narrowest, std::acos(std::abs(static_cast<double>(all[i].dot(all[j])))));
    }
  }
  EXPECT_GT(narrowest, 20.0 * degree);
  test::Dice dice(61);
  for (int trial = 0; trial < 10000; ++trial) {
    const Vec3f d = (dice.rotation() * Vec3::UnitX()).cast<float>();
    float nearest = 0.0f;
    for (const Vec3f& known : all) nearest = std::max(nearest, std::abs(d.dot(known)));
    EXPECT_GT(nearest, std::cos(14.0 * degree));
  }
}

TEST(Support, EqualsOneByOneInEveryDirection) {
  test::Dice dice(62);
  const std::vector<Vec3f> all = directions();
  for (const int count : {1, 2, 3, 15, 16, 17, 200}) {
    const std::vector<Vec3> points = randomPoints(dice, count);
    const FloatPoints cloud = floats(points);
    // Every other point, named by its number plus 1000.
    std::vector<std::int32_t> ids;
    for (std::int32_t id = 0; id < count; id += 2) ids.push_back(id);
    Support support;
    support.clear();
    include(support, cloud, ids, 1000, nullptr);
    for (std::size_t i = 0; i < Support::kPairs; ++i) {
      constexpr float kFar = std::numeric_limits<float>::infinity();
      std::pair<float, std::int32_t> high{-kFar, -1}, low{kFar, -1};
      for (const std::int32_t id : ids) {
        const float value = all[i].x() * cloud.x[id] + all[i].y() * cloud.y[id] + all[i].z() * cloud.z[id];
        if (value > high.first) high = {value, id + 1000};
        if (value < low.first) low = {value, id + 1000};
      }
      EXPECT_EQ(std::pair(support.high[i], support.highest[i]), high);
      EXPECT_EQ(std::pair(support.low[i], support.lowest[i]), low);
    }
  }
}

TEST(Support, OfAUnionIsTheUnionOfSupports) {
  test::Dice dice(64);
  const std::vector<Vec3> points = randomPoints(dice, 300);
  const Support whole = supportOf(points), second = supportOf(std::span(points).subspan(200), 200);
  Support joined = supportOf(std::span(points).first(200));
  Support bounded = joined;
  include(joined, second);
  expectEqual(joined, whole);
  // Directions in which the second half is not beyond the first may be skipped.
  std::vector<std::int32_t> ids(100);
  std::iota(ids.begin(), ids.end(), 200);
  include(bounded, floats(points), ids, 0, &second);
  expectEqual(bounded, whole);
}

TEST(EnclosedVolume, IsZeroWithoutThickness) {
  const std::vector<Vec3> corners = {{1, 2, 3}, {2, 2, 3}, {1, 3, 3}, {3, 5, 3}};
  for (const std::size_t count : {1u, 2u, 3u, 4u}) EXPECT_EQ(enclosed(std::span(corners).first(count)), 0.0) << count;
}

TEST(EnclosedVolume, OfSimpleSolidsInClosedForm) {
  const std::vector<Vec3> tetrahedron = test::makeTetrahedron().vertices;
  EXPECT_NEAR(enclosed(tetrahedron), 1.0 / 6.0, 1e-7);
  const std::vector<Vec3> octahedron = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  EXPECT_NEAR(enclosed(octahedron), 4.0 / 3.0, 1e-6);
  std::vector<Vec3> box = test::makeBox({0, 0, 0}, {2, 3, 4}).vertices;
  box.push_back({1, 1, 1});  // inside: adds nothing
  EXPECT_NEAR(enclosed(box), 24.0, 1e-4);

  // Far from the origin the volume is the same, up to the rounding of coordinates; enlarged it grows as a cube.
  for (Vec3& v : box) v += Vec3(1000.3, -2000.7, 500.1);
  EXPECT_NEAR(enclosed(box), 24.0, 1e-2);
  for (Vec3& v : box) v *= 0.5;
  EXPECT_NEAR(enclosed(box), 3.0, 1e-2);
}

TEST(EnclosedVolume, IsMostOfASphere) {
  test::Dice dice(65);
  std::vector<Vec3> sphere = randomPoints(dice, 100000);
  for (Vec3& p : sphere) p.normalize();
  const double share = enclosed(sphere) / (4.0 / 3.0 * std::numbers::pi);
  EXPECT_LT(share, 1.0);
  EXPECT_GT(share, 0.92);
}

TEST(EnclosedVolume, IsThatOfTheSupportPointsAlone) {
  test::Dice dice(63);
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<Vec3> points = randomPoints(dice, 100);
    const double volume = enclosed(points);
    EXPECT_LE(volume, convexHullVolume(points) * (1.0 + 1e-5)) << "trial " << trial;

    // The same in two lists, of which the second continues the numbers of the first.
    const auto first = std::span(points).first(60), second = std::span(points).subspan(60);
    Support support = supportOf(first);
    include(support, supportOf(second, 60));
    EXPECT_EQ(enclosedVolume(support, floats(first), floats(second)), volume);

    // Points that no direction names do not count.
    const Support all = supportOf(points);
    std::vector<Vec3> named;
    for (std::int32_t id = 0; id < 100; ++id) {
      const bool is = std::count(all.highest.begin(), all.highest.end(), id) > 0 ||
                      std::count(all.lowest.begin(), all.lowest.end(), id) > 0;
      if (is) named.push_back(points[id]);
    }
    EXPECT_LT(named.size(), points.size());
    EXPECT_NEAR(enclosed(named), volume, 1e-12);
  }
}

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
