#include "skinning/import/vrm_springs.h"

#include "skinning/import/json_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {

namespace {

using Json = nlohmann::json;

constexpr double kLargestNumber = 1e6;           // of lengths and forces in a file
constexpr int kMostSkippedNodes = 1000;          // between two joints of a strand
constexpr double kVirtualTail = 0.07;            // of the last joint of a strand in VRM 0.x
constexpr int kMostCenterSteps = 1'000'000;      // from centres up to their roots, in all
constexpr std::size_t kMaxReferences = 100'000;  // from groups to colliders, and from chains to groups

/// The elements of a list; none if it is something else.
[[nodiscard]] const Json& listOf(const Json& object, const char* key) {
  static const Json kEmpty = Json::array();
  const Json& list = memberOf(object, key);
  return list.is_array() ? list : kEmpty;
}

/// One sentence for each kind of fault, with the number of them.
class FaultNotes {
 public:
  void add(const std::string& kind, const std::string& sentence) {
    const auto found =
        std::find_if(faults_.begin(), faults_.end(), [&](const Fault& fault) { return fault.kind == kind; });
    if (found != faults_.end()) {
      ++found->count;
    } else {
      faults_.push_back({kind, sentence, 1});
    }
  }
  void writeTo(std::vector<std::string>& notes) const {
    for (const Fault& fault : faults_) {
      notes.push_back(fault.count == 1 ? "springs: " + fault.sentence
                                       : fmt::format("springs: {} ({} more of this kind)", fault.sentence,
                                                     grouped(fault.count - 1)));
    }
  }

 private:
  struct Fault {
    std::string kind, sentence;
    std::uint64_t count;
  };
  std::vector<Fault> faults_;
};

class SpringReader {
 public:
  SpringReader(const GltfDocument& document, FileScene& scene)
      : document_(document),
        scene_(scene),
        out_(scene.springs),
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
    readConstraints();
    faults_.writeTo(scene_.notes);
  }

 private:
  [[nodiscard]] std::optional<int> indexIn(const Json& index, std::size_t count) const {
    if (!index.is_number_integer()) return std::nullopt;
    const auto value = index.get<std::int64_t>();
    if (value < 0 || value >= static_cast<std::int64_t>(count)) return std::nullopt;
    return static_cast<int>(value);
  }
  [[nodiscard]] std::optional<int> nodeIn(const Json& index, const std::string& who) {
    const std::optional<int> node = indexIn(index, scene_.nodes.size());
    if (!node) {
      faults_.add("node", fmt::format("{} refers to node {}, which does not exist: skipped", who, shown(index)));
    }
    return node;
  }
  [[nodiscard]] static std::string shown(const Json& value) {
    return value.is_structured() ? std::string(value.type_name()) : value.dump().substr(0, 24);
  }

  /// A number, brought into a range; a note if it was outside or is not a number.
  [[nodiscard]] double number(const Json& object, const char* key, double otherwise, double min, double max,
                              const std::string& who) {
    const Json& value = memberOf(object, key);
    if (value.is_null()) return otherwise;
    const double given = value.is_number() ? value.get<double>() : kInfinity;
    if (given >= min && given <= max) return given;
    const double used = value.is_number() && !std::isnan(given) ? std::clamp(given, min, max) : otherwise;
    faults_.add("number",
                fmt::format("{}: {} is {}, expected {} to {}: {} is used", who, key, shown(value), min, max, used));
    return used;
  }

  [[nodiscard]] Vec3 vectorOf(const Json& list, const char* key, const Vec3& otherwise, const std::string& who) {
    const Json& value = memberOf(list, key);
    if (value.is_null()) return otherwise;
    Vec3 v = otherwise;
    bool sound = value.is_array() && value.size() == 3;
    for (int i = 0; i < 3 && sound; ++i) {
      sound = value[static_cast<std::size_t>(i)].is_number();
      if (sound) v[i] = value[static_cast<std::size_t>(i)].get<double>();
    }
    if (sound && v.cwiseAbs().maxCoeff() <= kLargestNumber) return v;
    faults_.add("vector",
                fmt::format("{}: {} is not three numbers of at most {:g}: ignored", who, key, kLargestNumber));
    return otherwise;
  }

  /// Vectors of VRM 0.x have Unity's axes, whose z is opposite to glTF's.
  [[nodiscard]] Vec3 unityVectorOf(const Json& object, const char* key, const Vec3& otherwise, const std::string& who) {
    const Json& value = memberOf(object, key);
    if (value.is_null()) return otherwise;
    const auto part = [&](const char* axis) { return number(value, axis, 0.0, -kLargestNumber, kLargestNumber, who); };
    return {part("x"), part("y"), -part("z")};
  }

  [[nodiscard]] bool roomForCollider() {
    if (out_.colliders.size() < kMaxSpringColliders) return true;
    faults_.add("colliders", fmt::format("more than {} colliders: the rest is skipped", grouped(kMaxSpringColliders)));
    return false;
  }
  [[nodiscard]] bool roomForReference() {
    if (++references_ <= kMaxReferences) return true;
    faults_.add("references",
                fmt::format("more than {} references to colliders: the rest is skipped", grouped(kMaxReferences)));
    return false;
  }

  void readColliders0(const Json& springs) {
    const Json& groups = listOf(springs, "colliderGroups");
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::string who = fmt::format("collider group {}", g);
      std::vector<int>& group = out_.colliderGroups.emplace_back();
      const std::optional<int> node = nodeIn(memberOf(groups[g], "node"), who);
      if (!node) continue;
      for (const Json& from : listOf(groups[g], "colliders")) {
        if (!roomForCollider() || !roomForReference()) return;
        SpringCollider collider;
        collider.joint = *node;
        collider.offset = unityVectorOf(from, "offset", Vec3::Zero(), who);
        collider.radius = number(from, "radius", 0.0, 0.0, kLargestNumber, who);
        group.push_back(static_cast<int>(out_.colliders.size()));
        out_.colliders.push_back(collider);
      }
    }
  }

  void readColliders1(const Json& springs) {
    const Json& colliders = listOf(springs, "colliders");
    std::vector<int> newIndex(colliders.size(), -1);
    for (std::size_t c = 0; c < colliders.size(); ++c) {
      const std::string who = fmt::format("collider {}", c);
      const std::optional<int> node = nodeIn(memberOf(colliders[c], "node"), who);
      if (!node) continue;
      if (!roomForCollider()) break;
      SpringCollider collider;
      collider.joint = *node;
      const Json& extended =
          memberOf(memberOf(memberOf(colliders[c], "extensions"), "VRMC_springBone_extended_collider"), "shape");
      if (!readShape(extended, who, collider) && !readShape(memberOf(colliders[c], "shape"), who, collider)) {
        faults_.add("shape", fmt::format("{} has no shape that is known: skipped", who));
        continue;
      }
      newIndex[c] = static_cast<int>(out_.colliders.size());
      out_.colliders.push_back(collider);
    }
    for (const Json& from : listOf(springs, "colliderGroups")) {
      const std::string who = fmt::format("collider group {}", out_.colliderGroups.size());
      std::vector<int>& group = out_.colliderGroups.emplace_back();
      for (const Json& index : listOf(from, "colliders")) {
        if (!roomForReference()) return;
        const std::optional<int> collider = indexIn(index, newIndex.size());
        if (!collider) {
          faults_.add("collider",
                      fmt::format("{} refers to collider {}, which does not exist: skipped", who, shown(index)));
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
      collider.offset = vectorOf(from, "offset", Vec3::Zero(), who);
      collider.tail = vectorOf(from, "tail", Vec3::Zero(), who);
      collider.radius = number(from, "radius", 0.0, 0.0, kLargestNumber, who);
    };
    if (const Json& sphere = memberOf(shape, "sphere"); sphere.is_object()) {
      readRound(sphere, SpringColliderShape::kSphere, SpringColliderShape::kInsideSphere);
    } else if (const Json& capsule = memberOf(shape, "capsule"); capsule.is_object()) {
      readRound(capsule, SpringColliderShape::kCapsule, SpringColliderShape::kInsideCapsule);
    } else if (const Json& plane = memberOf(shape, "plane"); plane.is_object()) {
      collider.shape = SpringColliderShape::kPlane;
      collider.offset = vectorOf(plane, "offset", Vec3::Zero(), who);
      collider.normal = vectorOf(plane, "normal", Vec3::UnitZ(), who);
    } else {
      return false;
    }
    return true;
  }

  /// Settings that both versions have, under the same names but one.
  [[nodiscard]] SpringJoint settingsOf(const Json& from, const char* stiffness, const std::string& who) {
    SpringJoint joint;
    joint.stiffness = number(from, stiffness, joint.stiffness, 0.0, kLargestNumber, who);
    joint.gravityPower = number(from, "gravityPower", joint.gravityPower, -kLargestNumber, kLargestNumber, who);
    joint.dragForce = number(from, "dragForce", joint.dragForce, 0.0, 1.0, who);
    joint.hitRadius = number(from, "hitRadius", joint.hitRadius, 0.0, kLargestNumber, who);
    return joint;
  }

  void readChains0(const Json& springs) {
    const Json& groups = listOf(springs, "boneGroups");
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::string who = fmt::format("spring group {}", g);
      SpringJoint settings = settingsOf(groups[g], "stiffiness", who);  // the format's own spelling
      settings.gravityDir = scene_.modelFromFileAxes * unityVectorOf(groups[g], "gravityDir", settings.gravityDir, who);
      SpringChain chain;
      // -1 stands for none here.
      if (const Json& center = memberOf(groups[g], "center"); center.is_number() && center != -1) {
        chain.center = nodeIn(center, who + ": its centre").value_or(kNoJoint);
      }
      readGroupsOf(groups[g], who, chain);
      for (const Json& root : listOf(groups[g], "bones")) {
        const std::optional<int> node = nodeIn(root, who);
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
      const Vec3 place = scene_.nodes[node].local.translation;
      joint.tail = children.empty() ? Vec3(place.stableNormalized() * kVirtualTail)
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
        chain.center = nodeIn(center, who + ": its centre").value_or(kNoJoint);
      }
      readGroupsOf(spring, who, chain);
      const Json& joints = listOf(spring, "joints");
      for (std::size_t j = 0; j + 1 < joints.size(); ++j) {
        const std::optional<int> head = nodeIn(memberOf(joints[j], "node"), who);
        const std::optional<int> end = nodeIn(memberOf(joints[j + 1], "node"), who);
        if (!head || !end) break;
        const std::optional<Vec3> tail = tailOf(*head, *end);
        if (!tail) {
          faults_.add("order", fmt::format("{}: node {} is not below node {}: the rest of the strand is skipped", who,
                                           *end, *head));
          break;
        }
        SpringJoint joint = settingsOf(joints[j], "stiffness", who);
        joint.gravityDir = scene_.modelFromFileAxes * vectorOf(joints[j], "gravityDir", joint.gravityDir, who);
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
    for (int skipped = 0; end != -1 && skipped <= kMostSkippedNodes; ++skipped) {
      if (end == head) return skipped > 0 ? std::optional(tail) : std::nullopt;
      tail = scene_.nodes[end].parentFromNode() * tail;
      end = scene_.nodes[end].parent;
    }
    return std::nullopt;
  }

  void readGroupsOf(const Json& from, const std::string& who, SpringChain& chain) {
    for (const Json& index : listOf(from, "colliderGroups")) {
      if (!roomForReference()) return;
      if (const std::optional<int> group = indexIn(index, out_.colliderGroups.size())) {
        chain.colliderGroups.push_back(*group);
      } else {
        faults_.add("group",
                    fmt::format("{} refers to collider group {}, which does not exist: skipped", who, shown(index)));
      }
    }
  }

  void addJoint(const SpringJoint& joint, const std::string& who, SpringChain& chain) {
    const auto node = static_cast<std::size_t>(joint.joint);
    if (swings_[node] != 0) {
      faults_.add("twice", fmt::format("{}: node {} '{}' swings already: the first one counts", who, node,
                                       scene_.nodes[node].name));
    } else if (springs_ == kMaxSprings) {
      faults_.add("springs", fmt::format("more than {} joints: the rest does not swing", grouped(kMaxSprings)));
    } else if (!joint.tail.allFinite() || !(joint.tail.norm() > 0.0)) {
      faults_.add("tail", fmt::format("{}: node {} '{}' has no length, so it cannot swing: skipped", who, node,
                                      scene_.nodes[node].name));
    } else {
      swings_[node] = 1;
      ++springs_;
      chain.joints.push_back(joint);
    }
  }

  void addChain(SpringChain chain, const std::string& who) {
    if (chain.joints.empty()) return;
    const int number = static_cast<int>(out_.chains.size()) + 1;
    for (const SpringJoint& joint : chain.joints) chainOf_[joint.joint] = number;
    for (int node = chain.center; node != -1; node = scene_.nodes[node].parent) {
      const bool swings = chainOf_[node] == number && node != chain.center;
      if (!swings && ++centerSteps_ <= kMostCenterSteps) continue;
      faults_.add("center",
                  fmt::format("{}: its centre, node {}, swings with it or is too deep: ignored", who, chain.center));
      chain.center = kNoJoint;
      break;
    }
    std::size_t colliders = 0;
    for (const int group : chain.colliderGroups) colliders += out_.colliderGroups[group].size();
    if (pairs_ + colliders * chain.joints.size() > kMaxSpringPairs) {
      faults_.add("pairs", fmt::format("{} and those before it make more than {} pairs of a joint and a collider: it "
                                       "collides with nothing",
                                       who, grouped(kMaxSpringPairs)));
      chain.colliderGroups.clear();
      colliders = 0;
    }
    pairs_ += colliders * chain.joints.size();
    out_.chains.push_back(std::move(chain));
  }

  void readConstraints() {
    for (const auto& [node, extension] : document_.nodeConstraints) {
      const std::string who = fmt::format("constraint of node {}", node);
      if (out_.constraints.size() == kMaxNodeConstraints) {
        faults_.add("constraints",
                    fmt::format("more than {} constraints: the rest is skipped", grouped(kMaxNodeConstraints)));
        return;
      }
      readConstraint(static_cast<int>(node), memberOf(extension, "constraint"), who);
    }
  }

  void readConstraint(int node, const Json& from, const std::string& who) {
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
      faults_.add("kind", fmt::format("{} is neither roll, aim nor rotation: skipped", who));
      return;
    }
    const std::optional<int> source = nodeIn(memberOf(*settings, "source"), who);
    if (!source) return;
    const char* axisKey = constraint.kind == NodeConstraint::Kind::kAim ? "aimAxis" : "rollAxis";
    if (!readAxis(memberOf(*settings, axisKey), constraint.axis)) {
      faults_.add("axis", fmt::format("{}: {} is {}, which is no axis: X is used", who, axisKey,
                                      shown(memberOf(*settings, axisKey))));
    }
    constraint.source = *source;
    constraint.weight = number(*settings, "weight", 1.0, 0.0, 1.0, who);
    out_.constraints.push_back(constraint);
  }

  /// "X", "PositiveX" or "NegativeX"; nothing leaves the axis as it is.
  [[nodiscard]] static bool readAxis(const Json& name, Vec3& axis) {
    if (name.is_null()) return true;
    if (!name.is_string()) return false;
    const std::string& text = name.get_ref<const std::string&>();
    for (int i = 0; i < 3; ++i) {
      const char letter = static_cast<char>('X' + i);
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

  const GltfDocument& document_;
  FileScene& scene_;
  SpringBones& out_;
  FaultNotes faults_;
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
