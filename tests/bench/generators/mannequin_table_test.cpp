#include "geometry/files.h"
#include "tests/bench/generators/mannequin_surface.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(MannequinTable, IsWhatTheGeneratorMakes) {
  const Result<std::string> shipped = readFile(sourceFile("skinning/mannequin/mannequin.bin"));
  ASSERT_TRUE(shipped) << shipped.error().message;
  EXPECT_TRUE(*shipped == mannequinTable())
      << "make it again: build/bench/make_mannequin skinning/mannequin/mannequin.bin";
}

}  // namespace
}  // namespace lorica::test
