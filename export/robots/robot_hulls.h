#pragma once

#include "collision/hulls/host.h"
#include "export/export_source.h"
#include "geometry/result.h"

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// Which robot, and what its collision meshes become.
struct RobotExportOptions {
  /// The robot's file, .xml (MJCF) or .urdf; of each of its meshes how it is read and divided. `parts` and
  /// `maxConcavity` of 0 mean at most kExportParts of a concavity of at most kRobotConcavity.
  ExportSourceOptions source;
  std::filesystem::path output;  ///< of the same kind and in the same folder, since what it names is found from there
  std::vector<std::string> packages;  ///< folders of ROS packages: "NAME=FOLDER"
  HullBudget budget;                  ///< of each hull
  bool capsules = false;              ///< instead of hulls, each around one
  bool replace = false;               ///< files that are there already
};

inline constexpr std::array<const char*, 8> kRobotHeadings = {"link", "shapes",  "litres of mesh",   "one hull",
                                                              "now",  "covered", "stands off, mean", "worst"};

inline constexpr double kRobotConcavity = 0.05;  ///< as `lorica decompose` has it for a mesh

/// What became of the meshes that a link collides with. Lengths and volumes in the robot's units.
struct RobotLinkReport {
  std::string name;
  int meshes = 0, shapes = 0;
  /// Of the meshes; of the hulls of whole meshes, which engines use instead; of what replaces them now.
  std::array<double, 3> volumes = {};
  double covered = 1.0;  ///< share of the meshes' volume that is in a shape
  /// Of the shapes' surface from the mesh, where it is outside mesh and other shapes: mean and largest.
  std::array<double, 2> standOff = {};

  /// As text, for a table with kRobotHeadings.
  [[nodiscard]] std::vector<std::string> cells() const;
};

struct RobotReport {
  std::vector<RobotLinkReport> links;                            ///< those that collide with meshes
  std::size_t files = 0;                                         ///< that were written
  std::size_t meshes = 0;                                        ///< that were divided: a mirror image is no other one
  std::vector<std::pair<std::string, std::string>> newContacts;  ///< see newContacts()
  std::vector<std::string> notes;
};

/// Whether a file is a robot's by its name: .urdf, or .xml.
[[nodiscard]] bool isRobotFile(const std::filesystem::path& file);

/// Reads a robot, divides each mesh that it collides with once, and writes it with hulls or capsules in their place.
/// Everything else stays byte for byte, masses and inertias too. All files are written, or none.
[[nodiscard]] Result<RobotReport> exportRobot(const RobotExportOptions& options, Host& host);

}  // namespace lorica
