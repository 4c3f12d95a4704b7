#include "apps/hull_export.h"

#include "acd/hull_budget.h"
#include "acd/transfer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

namespace lorica {

HullExport exportHulls(const Decomposition& decomposition, std::span<const Vec3> vertices, int maxVertices,
                       int threads) {
  std::vector<Vec3> points(static_cast<std::size_t>(decomposition.pointCount()));
  transfer(decomposition, vertices, points);
  const std::vector<ConvexHull> hulls = partHulls(decomposition, points);
  std::vector<BudgetedHull> exported(hulls.size());
  tbb::task_arena(threads).execute([&] {
    tbb::parallel_for(std::size_t{0}, hulls.size(), [&](std::size_t i) {
      const ConvexHull& hull = hulls[i];
      exported[i] = maxVertices > 0 ? simplifyHull(hull, maxVertices)
                                    : BudgetedHull{{hull.vertices, hull.triangles}, hull.volume, 1.0};
    });
  });

  HullExport result;
  result.objects.reserve(hulls.size());
  result.growth.reserve(hulls.size());
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    before += hulls[i].volume;
    after += exported[i].volume;
    result.growth.push_back(exported[i].growth);
    result.maxVertices = std::max(result.maxVertices, exported[i].mesh.vertices.size());
    result.maxVerticesBefore = std::max(result.maxVerticesBefore, hulls[i].vertices.size());
    result.objects.push_back({fmt::format("part_{}", i), std::move(exported[i].mesh)});
  }
  if (before > 0.0) result.totalGrowth = after / before;
  return result;
}

}  // namespace lorica
