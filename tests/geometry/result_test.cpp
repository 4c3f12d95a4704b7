#include "geometry/result.h"

#include "geometry/clock.h"
#include "geometry/json.h"
#include "geometry/math.h"
#include "geometry/random_numbers.h"
#include "geometry/text.h"
#include "tests/support/utf16.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::utf16;

Result<int> half(int n) {
  if (n % 2 != 0) return Error{ErrorCode::kInvalidArgument, "found 3, expected an even number"};
  return n / 2;
}

TEST(Result, HoldsAValueOrAnError) {
  EXPECT_TRUE(half(4));
  EXPECT_EQ(*half(4), 2);
  EXPECT_FALSE(half(3).ok());
  EXPECT_EQ(half(3).error().code, ErrorCode::kInvalidArgument);
  Result<std::unique_ptr<int>> owner(std::make_unique<int>(7));
  EXPECT_EQ(*std::move(owner).value(), 7);
  EXPECT_TRUE(Result<void>().ok());
}

TEST(ResultDeathTest, TheValueOfAFailureEndsTheProgramWithItsSentence) {
  EXPECT_DEATH((void)*half(3), "bug in Lorica: found 3, expected an even number");
  EXPECT_DEATH((void)half(3).value(), "found 3, expected an even number");
  EXPECT_DEATH((void)half(4).error(), "has a value");
  EXPECT_DEATH((void)Result<void>().error(), "succeeded");
}

const std::vector<std::string> kNames = {"--window", "--video", "--json"};

TEST(SimilarName, IsFoundThroughInsertionsDeletionsAndChanges) {
  EXPECT_EQ(didYouMean("--windw", kNames), "; did you mean \"--window\"?");
  EXPECT_EQ(didYouMean("--vvideo", kNames), "; did you mean \"--video\"?");
  EXPECT_EQ(didYouMean("--jsan", kNames), "; did you mean \"--json\"?");
  EXPECT_EQ(didYouMean("--WINDOW", kNames), "; did you mean \"--window\"?");
}

TEST(SimilarName, TwoSwappedLettersAreOneMistake) {
  const std::vector<std::string> names = {"play", "walk"};
  EXPECT_EQ(didYouMean("wlak", names), "; did you mean \"walk\"?");
  EXPECT_EQ(didYouMean("plya", names), "; did you mean \"play\"?");
}

TEST(SimilarName, OfEquallyNearOnesTheFirstIsTaken) {
  EXPECT_EQ(didYouMean("bat", std::vector<std::string>{"cat", "hat"}), "; did you mean \"cat\"?");
}

TEST(SimilarName, NothingIsSimilarToEverything) {
  EXPECT_EQ(didYouMean("--quarterstaff", kNames), "");
  EXPECT_EQ(didYouMean("--window", {}), "");
}

TEST(SimilarName, HugeNamesAreNotCompared) {
  const std::vector<std::string> huge = {std::string(100000, 'a')};
  EXPECT_EQ(didYouMean(std::string(100000, 'a'), huge), "");
  EXPECT_EQ(didYouMean("a", huge), "");
}

TEST(Utf16, BothOrdersWithAndWithoutAMark) {
  for (const bool little : {true, false}) {
    EXPECT_EQ(asUtf8(utf16(u"\ufeffH\u00e9\u20ac\U0001f600", little)), "H\u00e9\u20ac\U0001f600");
    EXPECT_EQ(asUtf8(utf16(u"HIERARCHY", little)), "HIERARCHY");
    EXPECT_TRUE(isUtf16(utf16(u"\ufeff", little)) && isUtf16(utf16(u"<", little)));
  }
}

TEST(Utf16, OtherTextStaysAsItIs) {
  for (const std::string text : {"", "H", "HIERARCHY", "\xef\xbb\xbfHIERARCHY", "\xc3\xa9"})
    EXPECT_TRUE(asUtf8(text) == text && !isUtf16(text)) << text;
}

TEST(Utf16, EveryPrefixAndHalvesOfPairsAreRead) {
  const std::string whole = utf16(u"\ufeffA\U0001f600B\xd800", true);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const std::string text = asUtf8(whole.substr(0, size));
    EXPECT_LE(text.size(), 3 * whole.size());
  }
  EXPECT_EQ(asUtf8(utf16(u"AB\xd800", true)), "AB");
}

TEST(Printable, KeepsTextAndEscapesTheRest) {
  EXPECT_EQ(printable("hero.glb: 12 'joints'"), "hero.glb: 12 'joints'");
  EXPECT_EQ(printable("Größe 身長 🦾"), "Größe 身長 🦾");
  EXPECT_EQ(printable("a\nb\r\t\x1b[2J\x7f"), "a\\x0ab\\x0d\\x09\\x1b[2J\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xC2\x9B"
                      "1m"),
            "\\xc2\\x9b1m")
      << "a control character of two bytes";
  EXPECT_EQ(printable("\xE8\xBA"), "\\xe8\\xba") << "the beginning of a character";
  EXPECT_EQ(printable("\xC0\xAF \xFF"), "\\xc0\\xaf \\xff") << "no UTF-8";
}

TEST(Printable, ReplacesTheMiddleOfLongText) {
  EXPECT_EQ(printable("0123456789", 10), "0123456789");
  EXPECT_EQ(printable("0123456789abcdefghij", 9), "012345 ... (11 bytes) ... hij");
  EXPECT_EQ(printable("長長長長", 6), "長 ... (9 bytes) ... ") << "no part of a character";
}

TEST(StartAndEnd, AreCutBetweenCharacters) {
  const std::string text = "aß長🦾b";  // 1, 2, 3, 4 and 1 bytes
  const std::vector<std::size_t> ends = {0, 1, 3, 6, 10, 11};
  for (std::size_t bytes = 0; bytes <= text.size() + 1; ++bytes) {
    std::size_t start = 0, end = 0;
    for (const std::size_t at : ends) {
      if (at <= bytes) start = at;
      if (text.size() - at <= bytes) end = std::max(end, text.size() - at);
    }
    EXPECT_EQ(firstBytes(text, bytes), text.substr(0, start)) << bytes;
    EXPECT_EQ(lastBytes(text, bytes), text.substr(text.size() - end)) << bytes;
  }
  const std::string none(9, '\x80');
  EXPECT_EQ(firstBytes(none, 7).size(), 7u) << "no UTF-8 has no characters";
  EXPECT_EQ(lastBytes(none, 7).size(), 7u);
}

TEST(Printable, IsOneLineAndStaysAsItIs) {
  RandomNumbers random(21);
  for (int round = 0; round < 2000; ++round) {
    std::string text(20, ' ');
    for (char& c : text) c = static_cast<char>(random.bits() >> 56U);
    const std::string once = printable(text);
    for (const char c : once) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) << once;
    EXPECT_EQ(printable(once), once);
  }
}

TEST(TimeLeft, OfEvenWorkIsWhatItTakes) {
  EXPECT_FALSE(timeLeft(0.1, 0.9, 1.0)) << "too early";
  EXPECT_FALSE(timeLeft(0.01, 0.99, 10.0)) << "too little";
  EXPECT_DOUBLE_EQ(timeLeft(0.3, 0.7, 3.0).value(), 7.0);
  EXPECT_DOUBLE_EQ(timeLeft(0.15, 0.35, 3.0).value(), 7.0) << "half of it was there already";
  EXPECT_FALSE(timeLeft(1.0, 0.0, 10.0));
  EXPECT_FALSE(timeLeft(0.0, 1.0, 10.0));
}

/// Items of random work that take up to twice as long as the others.
TEST(TimeLeft, IsRightWithinAFactorOfTwoAndNeverNothing) {
  RandomNumbers random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> seconds;
    double all = 0.0, now = 0.0;
    for (int item = 0; item < 100; ++item) all += seconds.emplace_back(random.between(5.0, 10.0));
    for (int item = 0; item < 100; ++item) {
      for (int step = 0; step < 4; ++step, now += 0.25 * seconds[static_cast<std::size_t>(item)]) {
        const std::optional<double> left = timeLeft(item / 100.0, 1.0 - item / 100.0, now);
        if (item < 10 || item >= 95) continue;  // of the last few, one that is half done counts much
        ASSERT_TRUE(left.has_value());
        EXPECT_LT(*left, 2.0 * (all - now));
        EXPECT_GT(*left, 0.5 * (all - now));
      }
    }
  }
}

TEST(TimeLeft, IsSaidAsRoughlyAsItIsKnown) {
  EXPECT_EQ(roughly(0.01), "some seconds");
  EXPECT_EQ(roughly(12.0), "about 10 seconds");
  EXPECT_EQ(roughly(54.9), "about 50 seconds");
  EXPECT_EQ(roughly(60.0), "about a minute");
  EXPECT_EQ(roughly(170.0), "about 3 minutes");
  EXPECT_EQ(roughly(3600.0), "about an hour");
  EXPECT_EQ(roughly(9000.0), "about 3 hours");
}

std::string nested(int levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

std::string members(int count) {
  std::string text = "{";
  for (int i = 0; i < count; ++i) text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":[{\"a\":1}]";
  return text + "}";
}

std::string refusalOf(const std::string& text, const JsonLimits& limits) {
  const Result<nlohmann::json> json = parseJson(text, "x", limits);
  return json ? "" : json.error().message;
}

TEST(Json, IsReadUpToItsLimits) {
  const JsonLimits limits{3, 5};
  struct Row {
    std::string text;
    std::string refusal;
  };
  const std::vector<Row> rows = {
      {nested(3), ""},
      {nested(4), "x: its JSON nests deeper than 3 levels"},
      {"{\"a\": \"[[[[[[\\\"[[[\"}", ""},
      {members(5), ""},
      {members(6), "x: its JSON has an object of more than 5 members"},
  };
  for (const Row& row : rows) EXPECT_EQ(refusalOf(row.text, limits), row.refusal) << row.text;
  EXPECT_TRUE(refusalOf("{\"a\": }", limits).starts_with("x: its JSON is broken: ")) << refusalOf("{\"a\": }", limits);
}

std::string listOf(const std::string& one, std::size_t count) {
  std::string text = "[" + one;
  while (--count > 0) text += "," + one;
  return text + "]";
}

TEST(Json, EmptyObjectsAreReadUpToTheirLimitOrOneForEveryEightBytes) {
  for (const std::string one : {"{}", "[]", "\"\""}) {
    EXPECT_EQ(refusalOf(listOf(one, 99), {2, 5, 100}), "") << one;
    EXPECT_EQ(refusalOf(listOf(one, 100), {2, 5, 100}), "x: its JSON has more than 100 lists, objects and texts");
    EXPECT_EQ(refusalOf(listOf(one + "       ", 1'000), {2, 5, 100}), "") << "a long text may have more";
  }
  EXPECT_EQ(refusalOf(listOf("{\"a\": 1}", 99), {2, 5, 100}), "") << "names are no texts of their own";
  EXPECT_EQ(refusalOf(listOf("-1", 1'000), {2, 5, 100}), "") << "nor are numbers";
  EXPECT_EQ(refusalOf(listOf("{}", JsonLimits().holders), {}),
            "x: its JSON has more than 500000 lists, objects and texts");
}

TEST(Json, AMillionBracketsAndManyMembersAreRefused) {
  EXPECT_EQ(refusalOf(nested(1'000'000), {}), "x: its JSON nests deeper than 64 levels");
  EXPECT_EQ(refusalOf(members(100'001), {}), "x: its JSON has an object of more than 100000 members");
}

TEST(Json, CommentsHideNothing) {
  const JsonLimits limits{2, 5};
  for (const std::string hidden : {"// \"\n", "/* \" */", "/*/ \" */", "/**/"}) {
    EXPECT_FALSE(checkJson(hidden + nested(3), limits).ok()) << hidden;
    EXPECT_TRUE(checkJson(hidden + nested(2), limits).ok()) << hidden;
  }
  for (const char* open : {"/*", "//", "/", "\"", "\"\\"}) EXPECT_TRUE(checkJson(open, limits).ok()) << open;
}

TEST(RandomNumbers, AreThoseOfSplitMix64) {
  // The published values for seed 1234567: https://rosettacode.org/wiki/Pseudo-random_numbers/Splitmix64
  RandomNumbers random(1234567);
  for (const std::uint64_t expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                       4593380528125082431u, 16408922859458223821u}) {
    EXPECT_EQ(random.bits(), expected);
  }
}

TEST(RandomNumbers, FillTheUnitIntervalEvenly) {
  RandomNumbers random(3);
  double sum = 0.0, sumOfUnits = 0.0;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const double a = random.unit(), b = randomUnit(3, i);
    ASSERT_TRUE(a >= 0.0 && a < 1.0 && b >= 0.0 && b < 1.0);
    sum += a;
    sumOfUnits += b;
  }
  // The standard deviation of the mean of 10,000 is 0.0029.
  EXPECT_NEAR(sum / 10'000, 0.5, 0.015);
  EXPECT_NEAR(sumOfUnits / 10'000, 0.5, 0.015);
}

TEST(Aabb, IsEmptyUntilAPointIsAdded) {
  Aabb box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.diagonal(), 0.0);
  box.extend(Vec3(1, 2, 3));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.diagonal(), 0.0);
  EXPECT_EQ(box.center(), Vec3(1, 2, 3));
}

TEST(Aabb, HoldsTheMinAndMaxOfEachAxis) {
  const std::vector<Vec3> points = {{1, -2, 3}, {-1, 5, 0}, {0, 0, -6}};
  const Aabb box = boundsOf(points);
  EXPECT_EQ(box.min, Vec3(-1, -2, -6));
  EXPECT_EQ(box.max, Vec3(1, 5, 3));
  EXPECT_EQ(box.center(), Vec3(0, 1.5, -1.5));
  EXPECT_DOUBLE_EQ(box.diagonal(), Vec3(2, 7, 9).norm());
  EXPECT_TRUE(boundsOf({}).empty());
}

TEST(RotationBetween, TurnsOneDirectionOntoTheOtherByTheShortestWay) {
  const Vec3 from(0.3, -2.0, 0.7);
  for (const Vec3& to : {Vec3(1, 0, 0), Vec3(0.3, -2.0, 0.7), Vec3(-0.3, 2.0, -0.7), Vec3(5, 5, -1)}) {
    const Quat turn = rotationBetween(from, to);
    EXPECT_NEAR((turn * from.normalized() - to.normalized()).norm(), 0.0, 1e-12) << to.transpose();
    const double angle = std::acos(std::clamp(from.normalized().dot(to.normalized()), -1.0, 1.0));
    EXPECT_NEAR(Quat::Identity().angularDistance(turn), angle, 1e-7) << to.transpose();
    const Eigen::Quaternionf single = rotationBetween(Vec3f(from.cast<float>()), Vec3f(to.cast<float>()));
    EXPECT_NEAR((single * from.normalized().cast<float>() - to.normalized().cast<float>()).norm(), 0.0F, 1e-5F);
  }
}

TEST(SymmetricAxes, OfAMatrixMadeOfKnownOnes) {
  const Mat3 known = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 values(-2.0, 0.5, 7.0);  // ascending
  const SymmetricAxes axes = symmetricAxes(known * values.asDiagonal() * known.transpose());
  EXPECT_NEAR((axes.values - values).norm(), 0.0, 1e-12);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::abs(axes.vectors.col(i).dot(known.col(i))), 1.0, 1e-12) << i;
  }
}

}  // namespace
}  // namespace lorica
