// What a hull with few vertices or planes costs in volume: simplifyHull() beside progressive convex hull simplification
// (Jacobson 2026, arXiv 2604.14468). Input: as for vhacd. Output: one CSV row for each mesh, count
// and number of vertices, then means on lines that start with #.

#include "acd/decompose.h"
#include "acd/hull_budget.h"
#include "acd/transfer.h"
#include "geometry/counts.h"
#include "tests/bench/benchmark_table.h"
#include "tests/bench/measure.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica::bench {
namespace {

/// In descending order of what they allow.
struct Limit {
  const char* name;
  HullBudget budget;
};
constexpr std::array<Limit, 5> kLimits = {{{"64 vertices", {64}},
                                           {"32 vertices", {32}},
                                           {"18 half-spaces", {0, 18}},
                                           {"16 vertices", {16}},
                                           {"8 vertices", {8}}}};

struct Sum {
  double ours = 0.0, theirs = 0.0, hulls = 0.0;  ///< volumes
  double outside = 0.0;  ///< how far the points of a hull lie outside theirs, share of the diagonal
};

Result<std::string> measure(const BenchmarkMesh& wanted, int parts) {
  const Result<TriMesh> mesh = readRepaired(wanted.file);
  if (!mesh) return mesh.error();
  DecomposeSettings settings;
  settings.maxParts = parts;
  const Result<Timed> made = timeDecompose(*mesh, {mesh->vertices, countOf(mesh->vertices)}, settings, 1);
  if (!made) return made.error();
  std::vector<Vec3> points(static_cast<std::size_t>(made->decomposition.pointCount()));
  transfer(made->decomposition, mesh->vertices, points);
  std::vector<Sum> sums(kLimits.size());
  for (const ConvexHull& hull : partHulls(made->decomposition, points)) {
    if (hull.degenerate()) continue;
    for (std::size_t i = 0; i < kLimits.size(); ++i) {
      const auto& [vertices, planes, turnPlanes] = kLimits[i].budget;
      const BudgetedHull ours = simplifyHull(hull, kLimits[i].budget);
      // A convex body with so many vertices has at most 2 V - 4 planes.
      const BudgetedHull theirs = simplifyHull(hull, {vertices, planes > 0 ? planes : 2 * vertices - 4, false});
      sums[i].ours += ours.volume;
      sums[i].theirs += theirs.volume;
      sums[i].hulls += hull.volume;
      const ConvexHull around = convexHull(theirs.mesh.vertices);
      const double outside = largestViolation(around, hull.vertices) / boundsOf(hull.vertices).diagonal();
      sums[i].outside = std::max(sums[i].outside, outside);
    }
  }
  std::string rows;
  for (std::size_t i = 0; i < kLimits.size(); ++i) {
    const Sum& s = sums[i];
    rows += fmt::format("{},{},{},{:.5f},{:.5f},{:.1e}\n", wanted.name, parts, kLimits[i].name, s.ours / s.hulls - 1.0,
                        s.theirs / s.hulls - 1.0, s.outside);
  }
  return rows;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  using namespace lorica::bench;
  Benchmark benchmark;
  CLI::App app("Encloses the parts of meshes in hulls with few vertices, by two methods: CSV on standard output.");
  addBenchmark(app, benchmark);
  CLI11_PARSE(app, argc, argv);
  const lorica::Result<std::vector<BenchmarkMesh>> meshes = readBenchmark(benchmark);
  if (!meshes) return fail(meshes.error());
  fmt::print("mesh,parts,limit,growth,pchs_growth,pchs_outside\n");
  for (const BenchmarkMesh& mesh : *meshes) {
    for (const int parts : mesh.counts) {
      const lorica::Result<std::string> rows = inOwnProcess([&] { return measure(mesh, parts); });
      if (!rows) return fail(rows.error());
      fmt::print("{}", *rows);
      std::fflush(stdout);
    }
  }
  return 0;
}
