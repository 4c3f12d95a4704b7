#pragma once

/// A robot's file: what of it collides, and the file with other shapes in place of that. Internal: not installed.

#include "export/capsule.h"
#include "geometry/math.h"
#include "geometry/named_file.h"
#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// A body that moves as one. Of MJCF the first one is the world.
struct RobotLink {
  std::string name;
  int parent = -1;                                  ///< earlier in the list
  bool moves = false;                               ///< against its parent
  int weld = -1;                                    ///< the first of the links that move with it; see weldLinks()
  Isometry3 worldFromLink = Isometry3::Identity();  ///< in the rest pose [m]
};

/// A mesh that links collide with, in the coordinates of its file.
struct RobotMesh {
  std::string name;            ///< of its file, without folder and ending
  std::string where;           ///< that names it, for errors
  std::filesystem::path file;  ///< empty: `mesh` is in the robot's file
  TriMesh mesh = {};
};

/// A place where a link collides with a mesh.
struct RobotGeom {
  int link = 0;
  int mesh = 0;
  Affine3 geomFromMesh = Affine3::Identity();        ///< scale, which may mirror, and MJCF's reference of the mesh
  Isometry3 parentFromGeom = Isometry3::Identity();  ///< as the file has it
  Isometry3 linkFromParent = Isometry3::Identity();  ///< of frames between it and the link
  unsigned contype = 1, conaffinity = 1;             ///< two geoms collide if one's type meets the other's affinity
};

/// What takes the place of collision meshes: hulls, or capsules.
struct RobotShapes {
  std::vector<std::vector<TriMesh>> hulls;     ///< of each mesh, in its file's coordinates
  std::vector<std::vector<Capsule>> capsules;  ///< of each geom, in the geom's frame; empty if they are hulls
};

/// A file to be written.
struct RobotOutput {
  std::filesystem::path file;
  std::string content;
};

class RobotFile {
 public:
  virtual ~RobotFile() = default;

  std::vector<RobotLink> links;
  std::vector<RobotMesh> meshes;  ///< each file once
  std::vector<RobotGeom> geoms;
  std::set<std::pair<int, int>> excluded;      ///< links that pass through each other, the lower first
  std::vector<std::filesystem::path> sources;  ///< files that were read for it, meshes excepted
  std::vector<std::string> notes;

  /// The files with shapes instead of collision meshes: those that are changed and those that are new, the robot's
  /// last. To be called once. @param out  of the robot's file, in the folder of the original
  [[nodiscard]] virtual Result<std::vector<RobotOutput>> replaced(const std::filesystem::path& out,
                                                                  const RobotShapes& shapes) = 0;

  /// Counts what is written of the robot's own text, or says that it is too much.
  [[nodiscard]] Result<void> write(std::size_t copies, std::size_t bytes, const std::string& where);

 protected:
  /// The index of a mesh file in `meshes`, which gets it if it is new; or that there are too many.
  [[nodiscard]] Result<int> meshOf(const std::filesystem::path& file, const std::string& where);
  /// Adds a geom, or says that there are too many or that it has no volume.
  [[nodiscard]] Result<void> add(const RobotGeom& geom, const std::string& where);
  /// Fills in RobotLink::weld.
  void weldLinks();

 private:
  std::map<std::filesystem::path, int> meshOfFile_;
  std::size_t written_ = 0;  ///< [bytes]
};

struct RobotReading {
  PathTrust trust = PathTrust::kBeneath;
  std::map<std::string, std::filesystem::path> packages;  ///< folders of ROS packages
};

/// MJCF. https://mujoco.readthedocs.io/en/stable/XMLreference.html
///
/// Replaced are geoms of type `mesh` that collide: contype and conaffinity are not both 0, after defaults, or a pair
/// names them. Hulls are written as vertices into the file, with the scale and reference of the mesh, and MuJoCo puts
/// them where it puts the mesh. A geom stays, without collisions, where it gives its body mass or appearance, or where
/// its name is used. Models that it attaches are read as MuJoCo reads them, each with its own settings, defaults and
/// names; one that changes is written beside its own file, as OUT_NAME.
[[nodiscard]] Result<std::unique_ptr<RobotFile>> readMjcf(const std::filesystem::path& file,
                                                          const RobotReading& reading);

/// URDF. http://wiki.ros.org/urdf/XML
///
/// Every collision element of a mesh is written as often as the mesh has hulls, whose files are in OUT_meshes/.
[[nodiscard]] Result<std::unique_ptr<RobotFile>> readUrdf(const std::filesystem::path& file,
                                                          const RobotReading& reading);

}  // namespace lorica
