#pragma once

/// A robot of MuJoCo as it is read and written: its model, those that it attaches, and where. Internal: not installed.

#include "export/robots/mjcf_tree.h"
#include "export/robots/robot.h"
#include "export/robots/xml_text.h"
#include "geometry/math.h"
#include "geometry/result.h"

#include <deque>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// A mesh asset.
struct MjcfAsset {
  int mesh = -1;        ///< in RobotFile::meshes; -1: it has no faces to divide
  std::string rawName;  ///< for the names of its hulls
  XmlEdits placed;      ///< scale, refpos and refquat as they hold, of its hulls too
  Affine3 geomFromMesh = Affine3::Identity();
  MjcfElement element = {};
  std::string file = {};  ///< as it is named; empty: the mesh is in the element, or made by MuJoCo
};

/// A body or frame that may be attached.
struct MjcfSubtree {
  MjcfElement element;
  std::string childclass;  ///< that holds around it
};

/// A model: each file once, however often it is attached.
struct MjcfModel {
  MjcfTree tree;
  std::filesystem::path file;
  std::map<std::string, MjcfAsset> assets = {};
  std::vector<MjcfElement> pairs = {}, excludes = {};
  std::set<std::string> paired = {};                            ///< names of geoms in pairs
  std::map<std::string, int> attached = {};                     ///< models by the names that they have here
  std::vector<std::pair<MjcfElement, int>> attachedFiles = {};  ///< the elements that name their files
  std::map<std::string, MjcfSubtree> subtrees = {};             ///< "body arm", "frame tool"
  std::vector<MjcfElement> attaches = {};
};

/// Where a model is: the robot itself, or attached in a model, perhaps in itself.
struct MjcfPlace {
  int model = 0;
  int around = -1;     ///< the place of the model that it is attached in; earlier in the list
  std::string prefix;  ///< of its names there
  std::string whole;   ///< of its names in the robot
};

/// A geom that is replaced, in one place.
struct MjcfGeom {
  MjcfElement element;
  std::string name, asset;  ///< in its model
  int place = 0;
  bool drawn = false;   ///< in a group that is drawn
  bool weighs = false;  ///< it has a mass if its body takes mass from geoms
};

struct MjcfBody {
  std::string massFrom = "auto";                ///< inertiafromgeom of its model
  bool inertial = false;                        ///< has its mass from the file
  std::set<std::pair<int, std::string>> shown;  ///< model and mesh: what it draws and does not collide with
};

struct MjcfRobot {
  std::deque<MjcfModel> models;    ///< the first one is the robot's
  std::vector<int> attachedFirst;  ///< the models, each behind those that it attaches
  std::vector<MjcfPlace> places;
  std::vector<MjcfBody> bodies;  ///< as links
  std::vector<MjcfGeom> geoms;   ///< as RobotFile::geoms

  [[nodiscard]] int modelAt(int place) const { return places[place].model; }
  /// Calls visit(model, prefix) for the model at a place and those around it: what its names are preceded by there.
  template <typename Visit>
  void forEachAround(int place, const Visit& visit) const {
    for (std::string prefix; place >= 0; place = places[place].around) {
      visit(places[place].model, prefix);
      prefix.insert(0, places[place].prefix);
    }
  }
};

/// The robot's files with shapes in place of the meshes of its geoms: those that changed, the robot's last.
/// To be called once. @param robot  gets notes
[[nodiscard]] Result<std::vector<RobotOutput>> mjcfWithShapes(MjcfRobot& mjcf, RobotFile& robot,
                                                              const RobotShapes& shapes,
                                                              const std::filesystem::path& out);

}  // namespace lorica
