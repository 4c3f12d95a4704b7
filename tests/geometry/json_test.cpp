#include "geometry/json.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
