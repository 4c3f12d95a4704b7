#pragma once

#include "export/rigid_model.h"

#include <filesystem>
#include <string>

namespace lorica {

enum class MjcfMotion {
  kJoints,  ///< bodies hang on each other by hinges; the first one is free
  kMocap    ///< every body is placed from outside, as mocap_pos and mocap_quat
};

/// A model for MuJoCo: metres, Z up, facing +X, lying where the bind pose is. Meshes are in the file. Hulls of
/// overlapping bodies do not collide with each other. https://mujoco.readthedocs.io/en/stable/XMLreference.html
[[nodiscard]] std::string formatMjcf(const RigidModel& model, MjcfMotion motion);

/// Writes it, completely or not at all.
[[nodiscard]] Result<void> writeMjcf(const std::filesystem::path& file, const RigidModel& model, MjcfMotion motion);

/// A file next to a URDF.
struct UrdfMesh {
  std::string name;  ///< relative to the URDF: "hero_meshes/Hips_hull_0.stl"
  std::string content;
};

/// A robot for ROS: metres, Z up, facing +X (REP 103). URDF has no joint of several axes: hinges after the first one
/// have a link of a gram between them. Meshes are files next to it. http://wiki.ros.org/urdf/XML
/// @param folder  of the meshes, relative
[[nodiscard]] std::string formatUrdf(const RigidModel& model, const std::string& folder);
[[nodiscard]] std::vector<UrdfMesh> urdfMeshes(const RigidModel& model, const std::string& folder);

/// The folder of the meshes of FILE.urdf: FILE_meshes, in plain letters.
[[nodiscard]] std::filesystem::path urdfFolder(const std::filesystem::path& file);

/// Writes FILE.urdf, and its meshes in FILE_meshes/. If anything cannot be written, a folder that this call made is
/// removed. Meshes there that only an earlier FILE.urdf named are removed.
[[nodiscard]] Result<void> writeUrdf(const std::filesystem::path& file, const RigidModel& model);

}  // namespace lorica
