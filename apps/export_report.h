#pragma once

#include "apps/report.h"
#include "export/collider_fit.h"
#include "export/rigid_model.h"
#include "export/robots/robot_hulls.h"
#include "prepare/hull_export.h"
#include "prepare/subject.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace lorica {

/// Rigid colliders of a character and how well they fit.
struct RigidExport {
  std::vector<RigidCollider> colliders;
  int trainingPoses = 0;
  int heldOutPoses = 0;  ///< 0: there are none, the fit was measured in the training poses
  ColliderFits fits;
};

/// The report of `lorica export`, as text and as JSON.
struct ExportReport {
  ExportReport(const Subject& subject, const std::string& output);

  void add(const HullExport& hulls);
  void add(const RigidExport& rigid);
  void add(const RigidModel& model);
  void add(const RobotReport& robot);
  void addSprings(int shapes, int springs);
  void note(const std::vector<std::string>& sentences);

  Report text;
  nlohmann::ordered_json json;
};

/// "LeftHand_0", "LeftHand_1": the bone and the number of its hull, unique.
/// @return in the order of the colliders
[[nodiscard]] std::vector<std::string> colliderNames(const Character& character,
                                                     std::span<const RigidCollider> colliders);

/// The colliders in the bind pose.
[[nodiscard]] std::vector<NamedMesh> namedHulls(const Character& character, std::span<const RigidCollider> colliders);

}  // namespace lorica
