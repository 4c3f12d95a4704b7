#include "skinning/import/vrm.h"

#include "geometry/counts.h"
#include "skinning/import/json_values.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <utility>

namespace lorica {

namespace {

using Json = nlohmann::json;

/// VRM 1.0 renamed the bones of the thumb, and only those.
[[nodiscard]] std::string nameIn1(const std::string& nameIn0) {
  static const std::array<std::array<const char*, 2>, 4> kThumbs = {{{"leftThumbProximal", "leftThumbMetacarpal"},
                                                                     {"leftThumbIntermediate", "leftThumbProximal"},
                                                                     {"rightThumbProximal", "rightThumbMetacarpal"},
                                                                     {"rightThumbIntermediate", "rightThumbProximal"}}};
  for (const auto& [in0, in1] : kThumbs) {
    if (nameIn0 == in0) return in1;
  }
  return nameIn0;
}

class BoneList {
 public:
  explicit BoneList(FileScene& scene) : scene_(scene), taken_(scene.nodes.size(), 0) {}

  void add(const std::string& name, const Json& node) {
    const std::optional<HumanBone> bone = humanBoneNamed(name);
    if (!bone) return;  // eyes and jaw
    const bool known =
        node.is_number_integer() && node.get<std::int64_t>() >= 0 && node.get<std::int64_t>() < countOf(scene_.nodes);
    if (!known) {
      scene_.notes.push_back(
          fmt::format("VRM: bone {} refers to node {}, which does not exist: skipped", name, node.dump()));
      return;
    }
    const auto index = node.get<std::size_t>();
    bool& has = has_[ordinalOf(*bone)];
    if (has || taken_[index] != 0) {
      scene_.notes.push_back(
          fmt::format("VRM: bone {} or its node {} is listed twice: the first is used", name, index));
      return;
    }
    has = true;
    taken_[index] = 1;
    scene_.bones.emplace_back(*bone, static_cast<int>(index));
  }

 private:
  FileScene& scene_;
  std::array<bool, kHumanBoneCount> has_{};
  std::vector<char> taken_;
};

}  // namespace

void readVrm(const Json& extensions, FileScene& scene) {
  BoneList bones(scene);
  for (const auto& [extension, format] :
       {std::pair("VRMC_vrm", "VRM 1.0"), std::pair("VRMC_vrm_animation", "VRM animation 1.0")}) {
    const Json& vrm = memberOf(extensions, extension);
    if (!vrm.is_object()) continue;
    scene.format = format;
    const Json& list = memberOf(memberOf(vrm, "humanoid"), "humanBones");
    if (!list.is_object()) return;
    for (const auto& [name, bone] : list.items()) bones.add(name, memberOf(bone, "node"));
    return;
  }
  if (const Json& vrm = memberOf(extensions, "VRM"); vrm.is_object()) {
    scene.format = "VRM 0.x";
    scene.modelFromFileAxes = Quat(0.0, 0.0, 1.0, 0.0);  // 180 degrees about Y
    scene.notes.emplace_back("VRM 0.x faces -Z: rotated to face +Z");
    const Json& list = memberOf(memberOf(vrm, "humanoid"), "humanBones");
    if (!list.is_array()) return;
    for (const Json& bone : list) {
      const Json& name = memberOf(bone, "bone");
      if (name.is_string()) bones.add(nameIn1(name.get<std::string>()), memberOf(bone, "node"));
    }
  }
}

}  // namespace lorica
