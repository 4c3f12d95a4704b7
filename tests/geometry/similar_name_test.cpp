#include "geometry/text.h"

#include <gtest/gtest.h>

#include <vector>

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
