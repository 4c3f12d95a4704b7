#include "export/robots/robot.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/work_budgets.h"

#include <cmath>

namespace lorica {

Result<int> RobotFile::meshOf(const std::filesystem::path& file, const std::string& where) {
  const auto [found, isNew] = meshOfFile_.try_emplace(file.lexically_normal(), countOf(meshes));
  if (!isNew) return found->second;
  if (meshes.size() == kMaxRobotMeshes) {
    return badFormat("{}: found more than {} collision meshes, expected at most that", where, kMaxRobotMeshes);
  }
  meshes.push_back({file.stem().string(), where, found->first});
  return found->second;
}

Result<void> RobotFile::add(const RobotGeom& geom, const std::string& where) {
  if (geoms.size() == kMaxRobotGeoms) {
    return badFormat("{}: found more than {} shapes that collide, expected at most that", where, kMaxRobotGeoms);
  }
  const double volume = std::abs(geom.geomFromMesh.linear().determinant());
  if (!(volume > 0.0) || !std::isfinite(volume)) {
    return badFormat("{}: scale: found a mesh without volume, expected three numbers other than 0", where);
  }
  geoms.push_back(geom);
  return {};
}

Result<void> RobotFile::write(std::size_t copies, std::size_t bytes, const std::string& where) {
  written_ += copies * bytes;
  if (written_ <= kMaxFileBytes) return {};
  return badFormat("{}: with all copies the robot has more than {} MiB, expected at most that", where,
                   kMaxFileBytes >> 20);
}

void RobotFile::weldLinks() {
  for (std::size_t i = 0; i < links.size(); ++i) {
    RobotLink& link = links[i];
    link.weld = link.parent < 0 || link.moves ? static_cast<int>(i) : links[link.parent].weld;
  }
}

}  // namespace lorica
