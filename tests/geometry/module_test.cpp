#include "geometry/module.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(Module, OneThatIsNotThereIsASentence) {
  const Result<const void*> module = loadModule("of_that_name_there_is_none", "symbol", "doing this");
  ASSERT_FALSE(module.ok());
  EXPECT_EQ(module.error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(module.error().message.find("doing this needs liblorica_of_that_name_there_is_none.so"), 0u)
      << module.error().message;
  EXPECT_NE(module.error().message.find("No such file"), std::string::npos) << module.error().message;
}

}  // namespace
}  // namespace lorica
