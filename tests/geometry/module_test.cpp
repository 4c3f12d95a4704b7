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
  EXPECT_NE(module.error().message.find("; install the Debian package lorica"), std::string::npos);
  EXPECT_NE(module.error().message.find("No such file"), std::string::npos) << module.error().message;
}

TEST(Module, NamesThePackageOfWhatIsMissing) {
  const auto missing = [](std::string library) { return packageOf(library + ": cannot open shared object file: No"); };
  EXPECT_EQ(missing("libopencv_videoio.so.406"), "libopencv-videoio406");
  EXPECT_EQ(missing("libopenvdb.so.10.0"), "libopenvdb10.0");
  EXPECT_EQ(missing("libIex-3_1.so.30"), "libIex-3-1-30");
  EXPECT_EQ(missing("liblorica_video.so"), "lorica");
  EXPECT_EQ(missing("/somewhere/else"), "");
  EXPECT_EQ(packageOf("liblorica_video.so: file too short"), "");
}

}  // namespace
}  // namespace lorica
