#include "geometry/result.h"

#include <gtest/gtest.h>

#include <memory>

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
