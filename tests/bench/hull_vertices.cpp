// What a hull with few vertices costs in volume: simplifyHull() beside progressive convex hull simplification (Jacobson
// 2026, arXiv 2604.14468), written here from the paper. Input: as for vhacd. Output: one CSV row for each mesh, count
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
#include <limits>
#include <optional>

namespace lorica::bench {
namespace {

constexpr double kFar = 1e4;    // a corner farther away, in widths, counts as one that does not exist
constexpr double kSame = 1e-7;  // half-spaces and corners closer than this, in widths, are one
constexpr double kNever = std::numeric_limits<double>::infinity();

/// In descending order of what they allow.
struct Limit {
  const char* name;
  int vertices;    ///< of ours
  int halfSpaces;  ///< of theirs; 0: as many vertices as ours
};
constexpr std::array<Limit, 5> kLimits = {{{"64 vertices", 64, 0},
                                           {"32 vertices", 32, 0},
                                           {"18 half-spaces", 11, 18},  // 11 vertices have at most 18 triangles
                                           {"16 vertices", 16, 0},
                                           {"8 vertices", 8, 0}}};

/// A convex polyhedron as the intersection of half-spaces, of which the cheapest are dropped one after the other. The
/// half-spaces are points of the dual, where dropping one takes a vertex from a convex hull.
class FewerHalfSpaces {
 public:
  explicit FewerHalfSpaces(const ConvexHull& hull) {
    // In coordinates where the hull is as wide in all directions: ratios of volumes stay, and flat hulls lose no
    // digits.
    for (const Vec3& p : hull.vertices) center_ += p / countOf(hull.vertices);
    Mat3 spread = Mat3::Zero();
    for (const Vec3& p : hull.vertices) spread += (p - center_) * (p - center_).transpose() / countOf(hull.vertices);
    SymmetricAxes axes = symmetricAxes(spread);
    if (axes.vectors.determinant() < 0.0) axes.vectors.col(0) *= -1.0;
    const Vec3 widths = axes.values.cwiseMax(1e-20 * axes.values.maxCoeff()).cwiseSqrt();
    hullFromOwn_ = axes.vectors * widths.asDiagonal();
    std::vector<Vec3> own;
    own.reserve(hull.vertices.size());
    for (const Vec3& p : hull.vertices) {
      own.push_back(widths.cwiseInverse().cwiseProduct(axes.vectors.transpose() * (p - center_)));
    }
    for (const Triangle& t : hull.triangles) {
      const Vec3 normal = (own[t[1]] - own[t[0]]).cross(own[t[2]] - own[t[0]]);
      const double length = normal.norm();
      if (length <= 1e-12) continue;  // a sliver's plane is unreliable; its neighbours bound the same region
      const Vec3 n = normal / length;
      double distance = 0.0;  // to the farthest point, so that slivers cut nothing off
      for (const Vec3& p : own) distance = std::max(distance, n.dot(p));
      const Vec3 dual = n / distance;
      const auto same = [&](const Vec3& d) { return (d - dual).norm() <= kSame * dual.norm(); };
      if (std::none_of(dual_.begin(), dual_.end(), same)) dual_.push_back(dual);
    }
    connect();
    cost_.assign(dual_.size(), 0.0);
    for (std::size_t i = 0; i < dual_.size(); ++i) cost_[i] = costOf(i);
  }

  /// Drops half-spaces until a limit is met. Limits come in descending order.
  ConvexHull reduced(const Limit& limit) {
    ConvexHull found = polyhedron();
    const auto met = [&] {
      if (limit.halfSpaces > 0) return countOf(dual_) <= limit.halfSpaces;
      return countOf(dual_) <= 2 * limit.vertices && countOf(found.vertices) <= limit.vertices;
    };
    while (!met() && step()) {
      if (countOf(dual_) <= 2 * limit.vertices) found = polyhedron();
    }
    return found;
  }

  /// Drops the half-space that adds the least volume. @return false if what is left would be unbounded
  bool step() {
    const std::size_t i = std::min_element(cost_.begin(), cost_.end()) - cost_.begin();
    if (dual_.size() <= 4 || cost_[i] == kNever) return false;
    std::vector<std::size_t> again = ring_[i];
    dual_.erase(dual_.begin() + static_cast<std::ptrdiff_t>(i));
    cost_.erase(cost_.begin() + static_cast<std::ptrdiff_t>(i));
    connect();
    for (std::size_t& j : again) j -= j > i ? 1 : 0;
    // What bounded nothing may bound now.
    for (std::size_t j = 0; j < cost_.size(); ++j) {
      if (cost_[j] == 0.0 || std::find(again.begin(), again.end(), j) != again.end()) cost_[j] = costOf(j);
    }
    return true;
  }

  /// The polyhedron in the hull's own coordinates. Corners that nearly coincide are one.
  [[nodiscard]] ConvexHull polyhedron() const {
    std::vector<Vec3> corners;
    for (const Triangle& t : faces_) {
      const Vec3 corner = cornerOf(dual_[t[0]], dual_[t[1]], dual_[t[2]]);
      const auto same = [&](const Vec3& c) { return (c - corner).norm() <= 1e3 * kSame; };
      if (std::none_of(corners.begin(), corners.end(), same)) corners.push_back(corner);
    }
    for (Vec3& corner : corners) corner = center_ + hullFromOwn_ * corner;
    return convexHull(corners);
  }

 private:
  /// Where the planes of three points of the dual meet.
  static Vec3 cornerOf(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 normal = (b - a).cross(c - a);
    return normal / normal.dot(a);
  }

  void connect() {
    const ConvexHull hull = convexHull(dual_);
    ring_.assign(dual_.size(), {});
    faces_.clear();
    for (const Triangle& t : hull.triangles) {
      const auto at = [&](int k) { return static_cast<VertexIndex>(hull.pointOfVertex[t[k]]); };
      faces_.push_back({at(0), at(1), at(2)});
      for (int k = 0; k < 3; ++k) ring_[at(k)].push_back(at((k + 1) % 3));
    }
  }

  /// The volume that is added without a half-space: the corners of what is left that lie beyond it, and its own.
  [[nodiscard]] double costOf(std::size_t i) const {
    if (ring_[i].empty()) return 0.0;  // it bounds nothing
    // Only its neighbours matter, and enough of the others that the middle is among them; all, should that not do.
    std::vector<Vec3> some;
    for (const std::size_t j : ring_[i]) some.push_back(dual_[j]);
    for (int d = 0; d < 27; ++d) {
      const Vec3 direction(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1);
      std::size_t best = i == 0 ? 1 : 0;
      for (std::size_t j = 0; j < dual_.size(); ++j) {
        if (j != i && direction.dot(dual_[j]) > direction.dot(dual_[best])) best = j;
      }
      some.push_back(dual_[best]);
    }
    if (const double cost = costBeyond(i, some); cost < kNever) return cost;
    some = dual_;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(i));
    return costBeyond(i, some);
  }

  [[nodiscard]] double costBeyond(std::size_t i, std::span<const Vec3> others) const {
    std::vector<Vec3> region;
    const ConvexHull rest = convexHull(others);
    if (rest.degenerate()) return kNever;
    for (const Triangle& t : rest.triangles) {
      const Vec3 corner = cornerOf(rest.vertices[t[0]], rest.vertices[t[1]], rest.vertices[t[2]]);
      // Unbounded if the middle is not inside the dual, where each face would have it below.
      const Vec3 normal = (rest.vertices[t[1]] - rest.vertices[t[0]]).cross(rest.vertices[t[2]] - rest.vertices[t[0]]);
      if (normal.dot(rest.vertices[t[0]]) <= 0.0 || !(corner.norm() < kFar)) return kNever;
      if (dual_[i].dot(corner) > 1.0) region.push_back(corner);
    }
    if (region.empty()) return 0.0;
    for (const Triangle& t : faces_) {
      const auto own = static_cast<VertexIndex>(i);
      if (t[0] == own || t[1] == own || t[2] == own) region.push_back(cornerOf(dual_[t[0]], dual_[t[1]], dual_[t[2]]));
    }
    return convexHull(region).volume;
  }

  Mat3 hullFromOwn_;
  Vec3 center_ = Vec3::Zero();
  std::vector<Vec3> dual_;
  std::vector<Triangle> faces_;
  std::vector<std::vector<std::size_t>> ring_;
  std::vector<double> cost_;
};

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
    std::optional<FewerHalfSpaces> other;
    for (std::size_t i = 0; i < kLimits.size(); ++i) {
      const Limit& limit = kLimits[i];
      const BudgetedHull ours = simplifyHull(hull, limit.vertices);
      ConvexHull theirs = hull;
      if (limit.halfSpaces > 0 || countOf(hull.vertices) > limit.vertices) {
        if (!other) other.emplace(hull);
        theirs = other->reduced(limit);
      }
      sums[i].ours += ours.volume;
      sums[i].theirs += theirs.volume;
      sums[i].hulls += hull.volume;
      const double outside = largestViolation(theirs, hull.vertices) / boundsOf(hull.vertices).diagonal();
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
  std::string folder, table;
  std::vector<std::string> only;
  CLI::App app("Encloses the parts of meshes in hulls with few vertices, by two methods: CSV on standard output.");
  app.add_option("FOLDER", folder, "Meshes (.off, .obj, .ply, .stl)")->required()->check(CLI::ExistingDirectory);
  app.add_option("TABLE", table, "CSV: mesh name, then part counts; see vhacd_counts.csv")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--only", only, "Only these meshes of the table, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  CLI11_PARSE(app, argc, argv);
  const lorica::Result<std::vector<BenchmarkMesh>> meshes = readBenchmark(folder, table, only);
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
