#include "skinning/import/bone_map.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace lorica {

namespace {

using MapJson = nlohmann::ordered_json;

constexpr std::string_view kFormat = "bone map 1";
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;  ///< a map of a hundred thousand joints is smaller

[[nodiscard]] Error bad(std::string_view name, std::string_view what) {
  return badFormat("{}: {}", name, what);
}

/// Text that JSON can store: bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string validUtf8(const std::string& bytes) {
  const std::string quoted = MapJson(bytes).dump(-1, ' ', false, MapJson::error_handler_t::replace);
  return MapJson::parse(quoted).get<std::string>();
}

[[nodiscard]] std::vector<std::string> boneNames() {
  std::vector<std::string> names;
  names.reserve(kHumanBoneCount);
  for (int bone = 0; bone < kHumanBoneCount; ++bone) names.emplace_back(nameOf(static_cast<HumanBone>(bone)));
  return names;
}

/// Names and paths of a skeleton's joints, as a map may write them.
class JointNames {
 public:
  explicit JointNames(const Skeleton& skeleton) : skeleton_(skeleton) {
    names_.reserve(skeleton.joints().size());
    for (const Joint& joint : skeleton.joints()) names_.push_back(validUtf8(joint.name));
    for (std::size_t i = 0; i < names_.size(); ++i) jointsOf_[names_[i]].push_back(i);
  }

  [[nodiscard]] std::span<const std::string> all() const { return names_; }

  /// All joints that this text may mean: those of that name, else those at the end of that path.
  [[nodiscard]] std::vector<JointIndex> find(std::string_view text) const {
    const auto named = jointsOf_.find(std::string(text));
    if (named != jointsOf_.end()) return named->second;
    std::vector<JointIndex> found;
    if (text.find('/') == std::string_view::npos) return found;
    for (JointIndex joint = 0; joint < skeleton_.jointCount(); ++joint) {
      if (endsWay(joint, text)) found.push_back(joint);
    }
    return found;
  }

  /// The shortest text that means only this joint. It has at most eight names, which bounds the work for files in which
  /// all joints have one name.
  [[nodiscard]] std::string textFor(JointIndex joint) const {
    std::string text = name(joint);
    const std::vector<JointIndex>& namesakes = jointsOf_.at(text);
    const auto isShared = [&] {
      return std::any_of(namesakes.begin(), namesakes.end(),
                         [&](JointIndex other) { return other != joint && endsWay(other, text); });
    };
    JointIndex above = skeleton_.joint(joint).parent;
    for (int names = 1; names < 8 && above != kNoJoint && isShared(); ++names) {
      text = fmt::format("{}/{}", name(above), text);
      above = skeleton_.joint(above).parent;
    }
    return text;
  }

 private:
  [[nodiscard]] const std::string& name(JointIndex joint) const { return names_[joint]; }

  [[nodiscard]] bool endsWay(JointIndex joint, std::string_view text) const {
    while (joint != kNoJoint && text.ends_with(name(joint))) {
      text.remove_suffix(name(joint).size());
      if (text.empty()) return true;
      if (text.back() != '/') return false;
      text.remove_suffix(1);
      joint = skeleton_.joint(joint).parent;
    }
    return false;
  }

  const Skeleton& skeleton_;
  std::vector<std::string> names_;
  std::map<std::string, std::vector<JointIndex>> jointsOf_;
};

}  // namespace

Result<BoneMap> readBoneMap(const std::filesystem::path& file) {
  LORICA_TRY(const std::string text, readFile(file, NamedBy::kUser, kMaxBytes));
  return parseBoneMap(text, file.string());
}

Result<BoneMap> parseBoneMap(std::string_view text, std::string_view name) {
  if (text.size() > kMaxBytes) {
    return bad(name, fmt::format("{} bytes, expected at most {}", text.size(), kMaxBytes));
  }
  LORICA_TRY(const MapJson json, parseWrittenJson(text, name));
  if (!json.is_object() || !json.contains("lorica") || !json["lorica"].is_string()) {
    return bad(name, fmt::format("not a bone map, expected an object with \"lorica\": \"{}\"", kFormat));
  }
  const std::string format = json["lorica"].get<std::string>();
  if (format != kFormat) return bad(name, fmt::format("lorica is \"{}\", expected \"{}\"", format, kFormat));
  const std::vector<std::string> known = {"lorica", "character", "bones", "unsure", "unusedJoints"};
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    return bad(name, fmt::format("unknown key \"{}\"{}", key, didYouMean(key, known)));
  }
  if (!json.contains("bones") || !json["bones"].is_object()) {
    return bad(name, "bones is missing, expected an object with a joint name for each bone");
  }

  BoneMap map;
  if (json.contains("character")) {
    if (!json["character"].is_string()) return bad(name, "character is not a string, expected a file name");
    map.character = json["character"].get<std::string>();
  }
  for (const auto& [key, value] : json["bones"].items()) {
    const std::optional<HumanBone> bone = humanBoneNamed(key);
    if (!bone) return bad(name, fmt::format("bones: \"{}\" is not a bone{}", key, didYouMean(key, boneNames())));
    if (value.is_null()) continue;
    if (!value.is_string() || value.get<std::string>().empty()) {
      return bad(name, fmt::format("bones: {} is {}, expected a joint name or null", key,
                                   value.is_string() ? "an empty string" : std::string("a") + " " + value.type_name()));
    }
    map.jointOf[ordinalOf(*bone)] = value.get<std::string>();
  }
  return map;
}

Result<void> writeBoneMap(const std::filesystem::path& file, const Skeleton& skeleton, std::string_view character,
                          std::span<const BoneDoubt> doubts) {
  const JointNames names(skeleton);
  MapJson json;
  json["lorica"] = kFormat;
  json["character"] = validUtf8(std::string(character));
  json["bones"] = MapJson::object();
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    const JointIndex joint = skeleton.jointOf(bone);
    MapJson& slot = json["bones"][std::string(nameOf(bone))];
    if (joint != kNoJoint) slot = names.textFor(joint);
  }
  for (const BoneDoubt& doubt : doubts) {
    for (const HumanBone bone : doubt.bones) {
      MapJson& reason = json["unsure"][std::string(nameOf(bone))];
      reason = reason.is_null() ? doubt.reason : reason.get<std::string>() + "; " + doubt.reason;
    }
  }
  json["unusedJoints"] = MapJson::array();
  for (JointIndex joint = 0; joint < skeleton.jointCount(); ++joint) {
    if (!skeleton.joint(joint).bone) json["unusedJoints"].push_back(names.textFor(joint));
  }
  return writeFileAtomically(file, json.dump(2) + "\n");
}

Result<Skeleton> applyBoneMap(const Skeleton& skeleton, const BoneMap& map, std::string_view name) {
  const JointNames names(skeleton);
  HumanoidGuess bones;
  bones.jointOf.fill(kNoJoint);
  bones.by = "a bone map";
  std::map<JointIndex, HumanBone> boneOf;
  for (int i = 0; i < kHumanBoneCount; ++i) {
    const auto bone = static_cast<HumanBone>(i);
    const std::string& text = map.jointOf[ordinalOf(bone)];
    if (text.empty()) continue;
    const std::vector<JointIndex> found = names.find(text);
    if (found.empty()) {
      return notFound("{}: {}: the character has no joint \"{}\"{}", name, nameOf(bone), text,
                      didYouMean(text, names.all()));
    }
    if (found.size() > 1) {
      return bad(name, fmt::format("{}: {} joints are named \"{}\", expected one: write \"{}\" or \"{}\"", nameOf(bone),
                                   found.size(), text, names.textFor(found[0]), names.textFor(found[1])));
    }
    const auto [other, isNew] = boneOf.emplace(found[0], bone);
    if (!isNew) {
      return bad(name, fmt::format("the joint \"{}\" is both {} and {}, expected one bone", text, nameOf(other->second),
                                   nameOf(bone)));
    }
    bones.jointOf[ordinalOf(bone)] = found[0];
  }

  for (const auto& [joint, bone] : boneOf) {
    std::optional<HumanBone> above = parentBone(bone);
    while (above && bones[*above] == kNoJoint) above = parentBone(*above);
    if (!above) continue;
    JointIndex ancestor = skeleton.joint(joint).parent;
    while (ancestor != kNoJoint && ancestor != bones[*above]) ancestor = skeleton.joint(ancestor).parent;
    if (ancestor != kNoJoint) continue;
    return bad(name, fmt::format("{} is \"{}\", which is not below \"{}\", the {}", nameOf(bone),
                                 map.jointOf[ordinalOf(bone)], map.jointOf[ordinalOf(*above)], nameOf(*above)));
  }
  return withBones(skeleton, bones);
}

}  // namespace lorica
