#include "skinning/import/gltf_parts.h"

#include "geometry/counts.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "skinning/import/json_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using Json = nlohmann::json;

constexpr double kLargestNumber = 1e6;  // of lengths and forces in a file

/// Values of springs and constraints, brought into their ranges, and what was wrong with them. In all of these `who`
/// names the object that they belong to.
class VrmValues {
 public:
  explicit VrmValues(const FileScene& scene) : scene_(scene) {}

  /// Keeps one sentence for each kind of fault, with the number of them.
  void addFault(const std::string& kind, const std::string& sentence) {
    const auto found =
        std::find_if(faults_.begin(), faults_.end(), [&](const Fault& fault) { return fault.kind == kind; });
    if (found != faults_.end()) {
      ++found->count;
    } else {
      faults_.push_back({kind, sentence});
    }
  }

  void writeFaultsTo(std::vector<std::string>& notes) const {
    for (const Fault& fault : faults_) {
      notes.push_back(fault.count == 1 ? "springs: " + fault.sentence
                                       : fmt::format("springs: {} ({} more of this kind)", fault.sentence,
                                                     grouped(fault.count - 1)));
    }
  }

  /// For messages.
  [[nodiscard]] static std::string shown(const Json& value) {
    return value.is_structured() ? std::string(value.type_name()) : std::string(firstBytes(value.dump(), 24));
  }

  [[nodiscard]] std::optional<int> nodeIn(const Json& index, const std::string& who) {
    const std::optional<int> node = indexIn(index, scene_.nodes.size());
    if (!node) addFault("node", fmt::format("{} refers to node {}, which does not exist: skipped", who, shown(index)));
    return node;
  }

  [[nodiscard]] double number(const Json& object, const char* key, double otherwise, double min, double max,
                              const std::string& who) {
    const Json& value = memberOf(object, key);
    if (value.is_null()) return otherwise;
    const double given = value.is_number() ? value.get<double>() : kInfinity;
    if (given >= min && given <= max) return given;
    const double used = value.is_number() && !std::isnan(given) ? std::clamp(given, min, max) : otherwise;
    addFault("number",
             fmt::format("{}: {} is {}, expected {} to {}: {} is used", who, key, shown(value), min, max, used));
    return used;
  }

  [[nodiscard]] Vec3 vectorOf(const Json& list, const char* key, const Vec3& otherwise, const std::string& who) {
    const Json& value = memberOf(list, key);
    if (value.is_null()) return otherwise;
    Vec3 v = otherwise;
    bool sound = value.is_array() && value.size() == 3;
    for (int i = 0; i < 3 && sound; ++i) {
      sound = value[i].is_number();
      if (sound) v[i] = value[i].get<double>();
    }
    if (sound && v.cwiseAbs().maxCoeff() <= kLargestNumber) return v;
    addFault("vector", fmt::format("{}: {} is not three numbers of at most {:g}: ignored", who, key, kLargestNumber));
    return otherwise;
  }

  /// Vectors of VRM 0.x have Unity's axes, whose z is opposite to glTF's.
  [[nodiscard]] Vec3 unityVectorOf(const Json& object, const char* key, const Vec3& otherwise, const std::string& who) {
    const Json& value = memberOf(object, key);
    if (value.is_null()) return otherwise;
    const auto part = [&](const char* axis) { return number(value, axis, 0.0, -kLargestNumber, kLargestNumber, who); };
    return {part("x"), part("y"), -part("z")};
  }

 private:
  struct Fault {
    std::string kind, sentence;
    std::uint64_t count = 1;
  };
  const FileScene& scene_;
  std::vector<Fault> faults_;
};

/// "X", "PositiveX" or "NegativeX"; nothing leaves the axis as it is.
[[nodiscard]] bool readAxis(const Json& name, Vec3& axis) {
  if (name.is_null()) return true;
  if (!name.is_string()) return false;
  const std::string& text = name.get_ref<const std::string&>();
  for (int i = 0; i < 3; ++i) {
    const char letter = 'X' + i;
    if (text == std::string(1, letter) || text == std::string("Positive") + letter) {
      axis = Vec3::Unit(i);
      return true;
    }
    if (text == std::string("Negative") + letter) {
      axis = -Vec3::Unit(i);
      return true;
    }
  }
  return false;
}

void readConstraint(int node, const Json& from, const std::string& who, VrmValues& values,
                    std::vector<NodeConstraint>& constraints) {
  NodeConstraint constraint;
  constraint.joint = node;
  const Json* settings = nullptr;
  for (const auto& [key, kind] :
       {std::pair("roll", NodeConstraint::Kind::kRoll), std::pair("aim", NodeConstraint::Kind::kAim),
        std::pair("rotation", NodeConstraint::Kind::kRotation)}) {
    if (settings != nullptr || !memberOf(from, key).is_object()) continue;
    settings = &memberOf(from, key);
    constraint.kind = kind;
  }
  if (settings == nullptr) {
    values.addFault("kind", fmt::format("{} is neither roll, aim nor rotation: skipped", who));
    return;
  }
  const std::optional<int> source = values.nodeIn(memberOf(*settings, "source"), who);
  if (!source) return;
  const char* axisKey = constraint.kind == NodeConstraint::Kind::kAim ? "aimAxis" : "rollAxis";
  if (!readAxis(memberOf(*settings, axisKey), constraint.axis)) {
    values.addFault("axis", fmt::format("{}: {} is {}, which is no axis: X is used", who, axisKey,
                                        VrmValues::shown(memberOf(*settings, axisKey))));
  }
  constraint.source = *source;
  constraint.weight = values.number(*settings, "weight", 1.0, 0.0, 1.0, who);
  constraints.push_back(constraint);
}

/// Reads VRMC_node_constraint 1.0; faulty ones are skipped.
void readVrmConstraints(const GltfDocument& document, VrmValues& values, std::vector<NodeConstraint>& constraints) {
  for (const auto& [node, extension] : document.nodeConstraints) {
    const std::string who = fmt::format("constraint of node {}", node);
    if (constraints.size() == kMaxNodeConstraints) {
      values.addFault("constraints",
                      fmt::format("more than {} constraints: the rest is skipped", grouped(kMaxNodeConstraints)));
      return;
    }
    readConstraint(node, memberOf(extension, "constraint"), who, values, constraints);
  }
}

constexpr int kMaxSkippedNodes = 1000;           // between two joints of a strand
constexpr double kVirtualTail = 0.07;            // of the last joint of a strand in VRM 0.x
constexpr int kMaxCenterSteps = 1'000'000;       // from centres up to their roots, in all
constexpr std::size_t kMaxReferences = 100'000;  // from groups to colliders, and from chains to groups

class SpringReader {
 public:
  SpringReader(const GltfDocument& document, FileScene& scene)
      : document_(document),
        scene_(scene),
        out_(scene.springs),
        values_(scene),
        swings_(scene.nodes.size(), 0),
        chainOf_(scene.nodes.size(), 0) {}

  void read() {
    // A file may have both; the newer one is meant for readers that know it.
    const Json& springs1 = memberOf(document_.extensions, "VRMC_springBone");
    const Json& springs0 = memberOf(memberOf(document_.extensions, "VRM"), "secondaryAnimation");
    if (springs1.is_object()) {
      readColliders1(springs1);
      readChains1(springs1);
    } else if (springs0.is_object()) {
      readColliders0(springs0);
      readChains0(springs0);
    }
    readVrmConstraints(document_, values_, out_.constraints);
    values_.writeFaultsTo(scene_.notes);
  }

 private:
  [[nodiscard]] bool mayAddCollider() {
    if (out_.colliders.size() < kMaxSpringColliders) return true;
    values_.addFault("colliders",
                     fmt::format("more than {} colliders: the rest is skipped", grouped(kMaxSpringColliders)));
    return false;
  }
  [[nodiscard]] bool mayAddReference() {
    if (++references_ <= kMaxReferences) return true;
    values_.addFault("references",
                     fmt::format("more than {} references to colliders: the rest is skipped", grouped(kMaxReferences)));
    return false;
  }

  void readColliders0(const Json& springs) {
    const Json& groups = listOf(springs, "colliderGroups");
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::string who = fmt::format("collider group {}", g);
      std::vector<int>& group = out_.colliderGroups.emplace_back();
      const std::optional<int> node = values_.nodeIn(memberOf(groups[g], "node"), who);
      if (!node) continue;
      for (const Json& from : listOf(groups[g], "colliders")) {
        if (!mayAddCollider() || !mayAddReference()) return;
        SpringCollider collider;
        collider.joint = *node;
        collider.offset = values_.unityVectorOf(from, "offset", Vec3::Zero(), who);
        collider.radius = values_.number(from, "radius", 0.0, 0.0, kLargestNumber, who);
        group.push_back(countOf(out_.colliders));
        out_.colliders.push_back(collider);
      }
    }
  }

  void readColliders1(const Json& springs) {
    const Json& colliders = listOf(springs, "colliders");
    std::vector<int> newIndex(colliders.size(), -1);
    for (std::size_t c = 0; c < colliders.size(); ++c) {
      const std::string who = fmt::format("collider {}", c);
      const std::optional<int> node = values_.nodeIn(memberOf(colliders[c], "node"), who);
      if (!node) continue;
      if (!mayAddCollider()) break;
      SpringCollider collider;
      collider.joint = *node;
      const Json& extended =
          memberOf(memberOf(memberOf(colliders[c], "extensions"), "VRMC_springBone_extended_collider"), "shape");
      if (!readShape(extended, who, collider) && !readShape(memberOf(colliders[c], "shape"), who, collider)) {
        values_.addFault("shape", fmt::format("{} has no shape that is known: skipped", who));
        continue;
      }
      newIndex[c] = countOf(out_.colliders);
      out_.colliders.push_back(collider);
    }
    for (const Json& from : listOf(springs, "colliderGroups")) {
      const std::string who = fmt::format("collider group {}", out_.colliderGroups.size());
      std::vector<int>& group = out_.colliderGroups.emplace_back();
      for (const Json& index : listOf(from, "colliders")) {
        if (!mayAddReference()) return;
        const std::optional<int> collider = indexIn(index, newIndex.size());
        if (!collider) {
          values_.addFault("collider", fmt::format("{} refers to collider {}, which does not exist: skipped", who,
                                                   VrmValues::shown(index)));
        } else if (newIndex[*collider] != -1) {
          group.push_back(newIndex[*collider]);
        }
      }
    }
  }

  /// @return false if it is none of the known shapes
  [[nodiscard]] bool readShape(const Json& shape, const std::string& who, SpringCollider& collider) {
    const auto readRound = [&](const Json& from, SpringColliderShape outside, SpringColliderShape inside) {
      const Json& kept = memberOf(from, "inside");
      collider.shape = kept.is_boolean() && kept.get<bool>() ? inside : outside;
      collider.offset = values_.vectorOf(from, "offset", Vec3::Zero(), who);
      collider.tail = values_.vectorOf(from, "tail", Vec3::Zero(), who);
      collider.radius = values_.number(from, "radius", 0.0, 0.0, kLargestNumber, who);
    };
    if (const Json& sphere = memberOf(shape, "sphere"); sphere.is_object()) {
      readRound(sphere, SpringColliderShape::kSphere, SpringColliderShape::kInsideSphere);
    } else if (const Json& capsule = memberOf(shape, "capsule"); capsule.is_object()) {
      readRound(capsule, SpringColliderShape::kCapsule, SpringColliderShape::kInsideCapsule);
    } else if (const Json& plane = memberOf(shape, "plane"); plane.is_object()) {
      collider.shape = SpringColliderShape::kPlane;
      collider.offset = values_.vectorOf(plane, "offset", Vec3::Zero(), who);
      collider.normal = values_.vectorOf(plane, "normal", Vec3::UnitZ(), who);
    } else {
      return false;
    }
    return true;
  }

  /// Settings that both versions have, under the same names but one.
  [[nodiscard]] SpringJoint settingsOf(const Json& from, const char* stiffness, const std::string& who) {
    SpringJoint joint;
    joint.stiffness = values_.number(from, stiffness, joint.stiffness, 0.0, kLargestNumber, who);
    joint.gravityPower = values_.number(from, "gravityPower", joint.gravityPower, -kLargestNumber, kLargestNumber, who);
    joint.dragForce = values_.number(from, "dragForce", joint.dragForce, 0.0, 1.0, who);
    joint.hitRadius = values_.number(from, "hitRadius", joint.hitRadius, 0.0, kLargestNumber, who);
    return joint;
  }

  void readChains0(const Json& springs) {
    const Json& groups = listOf(springs, "boneGroups");
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::string who = fmt::format("spring group {}", g);
      SpringJoint settings = settingsOf(groups[g], "stiffiness", who);  // the format's own spelling
      settings.gravityDir =
          scene_.modelFromFileAxes * values_.unityVectorOf(groups[g], "gravityDir", settings.gravityDir, who);
      SpringChain chain;
      // -1 stands for none here.
      if (const Json& center = memberOf(groups[g], "center"); center.is_number() && center != -1) {
        chain.center = values_.nodeIn(center, who + ": its centre").value_or(kNoJoint);
      }
      readGroupsOf(groups[g], who, chain);
      for (const Json& root : listOf(groups[g], "bones")) {
        const std::optional<int> node = values_.nodeIn(root, who);
        if (!node) continue;
        chain.name = scene_.nodes[*node].name;
        chain.joints.clear();
        addBelow(*node, settings, who, chain);
        addChain(chain, who);
      }
    }
  }

  /// Every node from a root down swings; the tail is its first child, or a virtual point.
  void addBelow(int root, const SpringJoint& settings, const std::string& who, SpringChain& chain) {
    std::vector<int> stack = {root};
    while (!stack.empty()) {
      const int node = stack.back();
      stack.pop_back();
      const std::vector<int>& children = document_.model.nodes[node].children;
      SpringJoint joint = settings;
      joint.joint = node;
      joint.tail = children.empty() ? Vec3(scene_.nodes[node].local.translation.stableNormalized() * kVirtualTail)
                                    : scene_.nodes[children.front()].local.translation;
      addJoint(joint, who, chain);
      stack.insert(stack.end(), children.rbegin(), children.rend());
    }
  }

  void readChains1(const Json& springs) {
    for (const Json& spring : listOf(springs, "springs")) {
      const std::string who = fmt::format("spring {}", springCount_++);
      SpringChain chain;
      if (const Json& name = memberOf(spring, "name"); name.is_string()) chain.name = name.get<std::string>();
      if (const Json& center = memberOf(spring, "center"); !center.is_null()) {
        chain.center = values_.nodeIn(center, who + ": its centre").value_or(kNoJoint);
      }
      readGroupsOf(spring, who, chain);
      const Json& joints = listOf(spring, "joints");
      for (std::size_t j = 0; j + 1 < joints.size(); ++j) {
        const std::optional<int> head = values_.nodeIn(memberOf(joints[j], "node"), who);
        const std::optional<int> end = values_.nodeIn(memberOf(joints[j + 1], "node"), who);
        if (!head || !end) break;
        const std::optional<Vec3> tail = tailOf(*head, *end);
        if (!tail) {
          values_.addFault("order", fmt::format("{}: node {} is not below node {}: the rest of the strand is skipped",
                                                who, *end, *head));
          break;
        }
        SpringJoint joint = settingsOf(joints[j], "stiffness", who);
        joint.gravityDir = scene_.modelFromFileAxes * values_.vectorOf(joints[j], "gravityDir", joint.gravityDir, who);
        joint.joint = *head;
        joint.tail = *tail;
        addJoint(joint, who, chain);
      }
      addChain(chain, who);
    }
  }

  /// Position of a node in the frame of one above it, at rest.
  [[nodiscard]] std::optional<Vec3> tailOf(int head, int end) const {
    Vec3 tail = Vec3::Zero();
    for (int skipped = 0; end != -1 && skipped <= kMaxSkippedNodes; ++skipped) {
      if (end == head) return skipped > 0 ? std::optional(tail) : std::nullopt;
      tail = scene_.nodes[end].parentFromNode() * tail;
      end = scene_.nodes[end].parent;
    }
    return std::nullopt;
  }

  void readGroupsOf(const Json& from, const std::string& who, SpringChain& chain) {
    for (const Json& index : listOf(from, "colliderGroups")) {
      if (!mayAddReference()) return;
      if (const std::optional<int> group = indexIn(index, out_.colliderGroups.size())) {
        chain.colliderGroups.push_back(*group);
      } else {
        values_.addFault("group", fmt::format("{} refers to collider group {}, which does not exist: skipped", who,
                                              VrmValues::shown(index)));
      }
    }
  }

  void addJoint(const SpringJoint& joint, const std::string& who, SpringChain& chain) {
    const std::size_t node = joint.joint;
    if (swings_[node] != 0) {
      values_.addFault("twice", fmt::format("{}: node {} '{}' swings already: the first one counts", who, node,
                                            scene_.nodes[node].name));
    } else if (springs_ == kMaxSprings) {
      values_.addFault("springs", fmt::format("more than {} joints: the rest does not swing", grouped(kMaxSprings)));
    } else if (!joint.tail.allFinite() || !(joint.tail.norm() > 0.0)) {
      values_.addFault("tail", fmt::format("{}: node {} '{}' has no length, so it cannot swing: skipped", who, node,
                                           scene_.nodes[node].name));
    } else {
      swings_[node] = 1;
      ++springs_;
      chain.joints.push_back(joint);
    }
  }

  void addChain(SpringChain chain, const std::string& who) {
    if (chain.joints.empty()) return;
    const int number = countOf(out_.chains) + 1;
    for (const SpringJoint& joint : chain.joints) chainOf_[joint.joint] = number;
    for (int node = chain.center; node != -1; node = scene_.nodes[node].parent) {
      const bool swings = chainOf_[node] == number && node != chain.center;
      if (!swings && ++centerSteps_ <= kMaxCenterSteps) continue;
      values_.addFault(
          "center", fmt::format("{}: its centre, node {}, swings with it or is too deep: ignored", who, chain.center));
      chain.center = kNoJoint;
      break;
    }
    std::size_t colliders = 0;
    for (const int group : chain.colliderGroups) colliders += out_.colliderGroups[group].size();
    if (pairs_ + colliders * chain.joints.size() > kMaxSpringPairs) {
      values_.addFault("pairs",
                       fmt::format("{} and those before it make more than {} pairs of a joint and a collider: it "
                                   "collides with nothing",
                                   who, grouped(kMaxSpringPairs)));
      chain.colliderGroups.clear();
      colliders = 0;
    }
    pairs_ += colliders * chain.joints.size();
    out_.chains.push_back(std::move(chain));
  }

  const GltfDocument& document_;
  FileScene& scene_;
  SpringBones& out_;
  VrmValues values_;
  std::vector<char> swings_;  // per node
  std::vector<int> chainOf_;  // per node: 1 + index in out_.chains, or 0
  int centerSteps_ = 0;
  std::size_t springs_ = 0;
  std::size_t springCount_ = 0;
  std::size_t pairs_ = 0;
  std::size_t references_ = 0;
};

}  // namespace

void readVrmSprings(const GltfDocument& document, FileScene& scene) {
  SpringReader(document, scene).read();
}

}  // namespace lorica
