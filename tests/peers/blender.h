#pragma once

#include "geometry/math.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lorica::test {

/// How to get Blender if it is missing; empty if it is there.
[[nodiscard]] std::string missingForBlender();

/// An animated file that Blender opens.
struct BlenderJob {
  std::filesystem::path file;  ///< .glb or .bvh
  std::vector<double> frames;  ///< [s] in a .glb, frame numbers from 0 in a .bvh
};

/// World positions of bones and objects by their names, which Blender cuts to 63 bytes and numbers if they repeat, in
/// the file's units (of a .bvh: metres), Y up.
using BlenderJoints = std::multimap<std::string, Vec3>;

/// @return for each job and each of its frames what Blender makes of it; the test fails if Blender does
[[nodiscard]] std::vector<std::vector<BlenderJoints>> openWithBlender(const std::vector<BlenderJob>& jobs);

}  // namespace lorica::test
