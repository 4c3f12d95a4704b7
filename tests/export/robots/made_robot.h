#pragma once

#include "export/robots/robot_hulls.h"
#include "tests/support/datasets.h"

#include <filesystem>
#include <map>
#include <string>

namespace lorica::test {

/// A robot of MuJoCo in three files, with meshes: a torso that takes its mass from its geoms, among them a mesh that is
/// seen and collides; an arm with a mirrored mesh below a frame; a leg with a torus in another file. Its classes,
/// quotes, comments and spaces are of all kinds. @return robot.xml
std::filesystem::path writeMadeMjcf(const TemporaryFolder& folder);

/// A robot of MuJoCo that attaches others: robot.xml attaches a body of parts/arm.xml twice, a frame of it, and all of
/// it; that attaches a body of parts/hand.xml. All have compilers, defaults and folders of their own; the meshes are an
/// L, in two files, three scales and mirrored. @return robot.xml
std::filesystem::path writeAttachingMjcf(const TemporaryFolder& folder);

/// A robot of ROS with the same meshes: robot.urdf, one mesh of it in the package `made` in the folder itself.
std::filesystem::path writeMadeUrdf(const TemporaryFolder& folder);

/// Options for a robot in a folder, and its output there; nothing of the user's cache is used.
[[nodiscard]] RobotExportOptions madeOptions(const std::filesystem::path& robot, const std::string& output);

/// A mesh as a binary file of MuJoCo (.msh).
[[nodiscard]] std::string mshOf(const TriMesh& mesh);

/// All files below a folder, by name.
[[nodiscard]] std::map<std::string, std::string> contentOf(const std::filesystem::path& folder);

}  // namespace lorica::test
