#include "session/part_masses.h"

#include "acd/transfer.h"
#include "geometry/mass_properties.h"

#include <cmath>

namespace lorica {

std::vector<double> partMasses(const Decomposition& decomposition, const Character& character) {
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, character.mesh.vertices, points);
  std::vector<double> masses;
  masses.reserve(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    masses.push_back(kBodyDensity * std::abs(massProperties(points, part.triangles).volume));
  }
  return masses;
}

}  // namespace lorica
