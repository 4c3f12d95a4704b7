#include "export/engines.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(Engines, AreFoundByTheirNamesAlone) {
  EXPECT_EQ(engineNamed("unity")->maxVertices, 255);
  EXPECT_EQ(engineNamed("unreal")->prefix, "UCX_");
  EXPECT_FALSE(engineNamed("Unity"));
  EXPECT_FALSE(engineNamed(""));
  for (const Engine& engine : engines()) {
    EXPECT_FALSE(engine.source.empty()) << engine.name;
    EXPECT_TRUE(engine.maxVertices == 0 || engine.maxVertices >= 4) << engine.name;
  }
}

}  // namespace
}  // namespace lorica
