#include "skinning/import/vrm_constraints.h"

#include "geometry/work_budgets.h"

#include <fmt/format.h>

#include <utility>

namespace lorica {
namespace {

using Json = nlohmann::json;

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

}  // namespace

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

}  // namespace lorica
