#include "skinning/import/gltf_document.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <utility>
#include <vector>

namespace lorica {
namespace {

using nlohmann::json;

TEST(GltfTypes, AnEmptyDocumentHasNoFault) {
  EXPECT_TRUE(checkGltfTypes(json::object(), "a.gltf"));
  EXPECT_TRUE(checkGltfTypes({{"nodes", json::array()}, {"scenes", {{{"nodes", json::array()}}}}}, "a.gltf"));
}

TEST(GltfTypes, WhatIsNotReadMayBeAnything) {
  EXPECT_TRUE(checkGltfTypes({{"materials", 5}, {"nodes", {{{"name", 7}, {"camera", "x"}}}}}, "a.gltf"));
}

TEST(GltfTypes, TheFirstFaultIsToldWithItsPlace) {
  const std::vector<std::pair<json, const char*>> faults = {
      {{{"scene", 0.5}}, "a.gltf: /scene: 0.5, expected a whole number from 0 on"},
      {{{"accessors", {{{"bufferView", "0"}}}}},
       "a.gltf: /accessors/0/bufferView: a text, expected a whole number from 0 on"},
      {{{"accessors", {{{"bufferView", -1}}}}},
       "a.gltf: /accessors/0/bufferView: -1, expected a whole number from 0 on"},
      {{{"accessors", "none"}}, "a.gltf: /accessors: a text, expected a list or object"},
      {{{"bufferViews", {1}}}, "a.gltf: /bufferViews/0: 1, expected an object"},
      {{{"accessors", {{{"normalized", 1}}}}}, "a.gltf: /accessors/0/normalized: 1, expected true or false"},
      {{{"nodes", {json::object(), {{"children", {3, nullptr}}}}}},
       "a.gltf: /nodes/1/children/1: null, expected a whole number from 0 on"},
      {{{"nodes", {{{"scale", {1, "1", 1}}}}}}, "a.gltf: /nodes/0/scale/1: a text, expected a number"},
      {{{"meshes", {{{"primitives", {{{"attributes", {{"POSITION", true}}}}}}}}}},
       "a.gltf: /meshes/0/primitives/0/attributes/POSITION: true, expected a whole number from 0 on"},
      {{{"animations", {{{"channels", {{{"sampler", 0}, {"target", {{"path", json::array()}}}}}}}}}},
       "a.gltf: /animations/0/channels/0/target/path: a list or object, expected a text"},
      {{{"animations", {{{"channels", {{{"target", {{"path", "scale"}}}}}}}}}},
       "a.gltf: /animations/0/channels/0: has no sampler, expected a whole number from 0 on"},
  };
  for (const auto& [document, sentence] : faults) {
    const Result<void> checked = checkGltfTypes(document, "a.gltf");
    ASSERT_FALSE(checked) << document;
    EXPECT_EQ(checked.error().message, sentence);
    EXPECT_EQ(checked.error().code, ErrorCode::kBadFormat);
  }
}

}  // namespace
}  // namespace lorica
