#pragma once

#include "collision/live/live_part.h"
#include "collision/live/ray_query.h"

#include <span>
#include <vector>

namespace lorica::test {

/// A hull in world space, and a ball around it that spares rays which miss it.
struct SlowHull {
  ConvexHull hull;
  Vec3 middle = Vec3::Zero();
  double radius = 0.0;
};
[[nodiscard]] std::vector<SlowHull> slowHulls(std::span<const LivePart> parts);

/// The nearest hit by asking every triangle of every hull; directions are unit vectors.
[[nodiscard]] HullHit slowNearest(std::span<const std::vector<SlowHull>> bodies, const HullRay& ray);

/// The same as the slow answer, to 1e-9 m; or past an edge: the slow answer for a ray 1e-9 m aside.
enum class Agreement { kSame, kGrazing, kDifferent };
[[nodiscard]] Agreement compare(std::span<const std::vector<SlowHull>> bodies, const HullRay& ray, const HullHit& fast,
                                const HullHit& slow);

/// The nearest triangle from either side by asking all. @param posed  vertices of the mesh
[[nodiscard]] SkinHit slowNearestOnSkin(std::span<const Vec3> posed, std::span<const Triangle> triangles,
                                        const HullRay& ray);

}  // namespace lorica::test
