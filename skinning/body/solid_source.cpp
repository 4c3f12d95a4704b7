#include "skinning/body/solid_source.h"

#include "geometry/mesh_pieces.h"
#include "geometry/threads.h"
#include "geometry/tri_mesh.h"
#include "geometry/work_budgets.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

/// Patches of a surface: pieces whose triangles are connected by edges with exactly two triangles.
struct Patches {
  MeshPieces pieces;
  std::vector<double> areas;  ///< of each [m^2]
  std::size_t turned = 0;     ///< patches that were inside out
};

// An open patch is inside out if it bulges inward by more than this fraction of the volume of a ball of equal area.
constexpr double kPlain = 0.05;

double areaOf(const TriMesh& mesh, const Triangle& t) {
  return 0.5 * areaNormal(mesh.vertices, t).norm();
}

/// Divides a surface into patches and flips triangles so that those of one patch face the same way. Patches that are
/// clearly inside out are flipped outward: closed ones of negative volume, and open ones that bulge inward.
Patches orientPatches(TriMesh& mesh) {
  Patches result{findPieces(mesh), {}, 0};
  for (const std::vector<std::int32_t>& members : result.pieces.members) {
    double& area = result.areas.emplace_back(0.0);
    for (const std::int32_t t : members) area += areaOf(mesh, mesh.triangles[t]);
  }
  mesh.triangles = result.pieces.triangles;
  for (std::size_t p = 0; p < result.areas.size(); ++p) {
    const std::vector<std::int32_t>& members = result.pieces.members[p];
    const double area = result.areas[p];
    Vec3 center = Vec3::Zero();
    for (const std::int32_t t : members) {
      const Triangle& corners = mesh.triangles[t];
      const double share = area > 0.0 ? areaOf(mesh, corners) / (3.0 * area) : 0.0;
      for (const VertexIndex v : corners) center += share * mesh.vertices[v];
    }
    double volume = 0.0;
    for (const std::int32_t t : members) {
      const Triangle& c = mesh.triangles[t];
      const Vec3 a = mesh.vertices[c[0]] - center;
      const Vec3 b = mesh.vertices[c[1]] - center;
      volume += a.dot(b.cross(mesh.vertices[c[2]] - center)) / 6.0;
    }
    const double ball = area * std::sqrt(area) / (6.0 * std::sqrt(std::numbers::pi));
    if (volume >= (result.pieces.open[p] ? -kPlain * ball : 0.0)) continue;
    ++result.turned;
    for (const std::int32_t t : members) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  return result;
}

constexpr double kAside = 1e-4;   // of the box's diagonal: distance of test points in front of a triangle
constexpr double kLarge = 0.01;   // of the diagonal: larger triangles have four test points, others one in their middle
constexpr double kSheet = -0.25;  // mean winding number in front of a patch: 0 for skin, -1/2 for a free sheet
constexpr double kHidden = 0.5;   // winding number in front of a hidden triangle

constexpr double kVerticesAVoxelFace = 1.5;  // average over all orientations of the surface
constexpr double kMaxVertices = 14000.0;
constexpr double kMinVertices = 7000.0;
constexpr double kVoxelsAcross = 4.0;
constexpr double kThinShare = 0.05;  // of the surface: the thinnest parts are ignored up to this area

double areaOf(const std::array<Vec3, 3>& t) {
  return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
}

Vec3 middleOf(const std::array<Vec3, 3>& t) {
  return (t[0] + t[1] + t[2]) / 3.0;
}

/// Visits winding numbers just in front of a triangle: at its middle; for a large one also towards its corners.
template <typename Visit>
void askInFront(const SolidSource& source, const TriangleTree& tree, const std::array<Vec3, 3>& t, double diagonal,
                Visit&& visit) {
  const Vec3 front = kAside * diagonal * (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
  const Vec3 middle = middleOf(t);
  visit(source.windingAt(tree, middle + front));
  const double longest = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
  if (longest < kLarge * diagonal) return;
  for (const Vec3& corner : t) visit(source.windingAt(tree, 0.3 * middle + 0.7 * corner + front));
}

/// The thickness of the skin in each group of triangles.
std::vector<Thickness> thicknesses(const SolidSource& source, std::span<const std::int32_t> groupOfTriangle,
                                   std::size_t groups) {
  std::vector<Thickness> result(groups);
  std::vector<Vec3> sum(groups, Vec3::Zero());
  std::vector<Mat3> squares(groups, Mat3::Zero());
  const Vec3 origin = surfaceBounds(source.mesh).center();
  for (std::size_t k = 0; k < groupOfTriangle.size(); ++k) {
    if (source.roles[k] != TriangleRole::kSkin) continue;
    const std::size_t g = groupOfTriangle[k];
    const std::array<Vec3, 3> t = source.corners(k);
    const double area = areaOf(t);
    const Vec3 at = middleOf(t) - origin;
    result[g].area += area;
    sum[g] += area * at;
    // A long triangle is not a point: the mean of x x' over it is this weighted mean of its corners and its middle.
    for (const Vec3& corner : t) squares[g] += area / 12.0 * (corner - origin) * (corner - origin).transpose();
    squares[g] += 0.75 * area * at * at.transpose();
  }
  for (std::size_t g = 0; g < groups; ++g) {
    Thickness& size = result[g];
    if (!(size.area > 0.0)) continue;
    const Vec3 mean = sum[g] / size.area;
    const Mat3 spread = squares[g] / size.area - mean * mean.transpose();
    const Vec3 along = Eigen::SelfAdjointEigenSolver<Mat3>(spread, Eigen::EigenvaluesOnly).eigenvalues().cwiseMax(0.0);
    // On a circle the mean square of one coordinate is half the radius squared.
    size.min = 2.0 * std::sqrt(2.0 * along[0]);
    size.middle = 2.0 * std::sqrt(2.0 * along[1]);
    size.length = std::sqrt(12.0 * along[2]);  // along a rod it is a twelfth of the length squared
  }
  return result;
}

}  // namespace

std::array<Vec3, 3> SolidSource::corners(std::size_t triangle) const {
  const Triangle& t = mesh.triangles[triangle];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

double SolidSource::windingAt(const TriangleTree& solid, const Vec3& p) const {
  if (crowded()) return 0.0;
  std::size_t looked = 0;
  const double number = solid.windingNumber(p, &looked);
  looked_.fetch_add(looked, std::memory_order_relaxed);
  return number;
}

bool SolidSource::crowded() const {
  return looked_.load(std::memory_order_relaxed) > kMaxLooked + kMaxLookedEach * mesh.triangles.size();
}

SolidSource::SolidSource(const Character& character, const Limbs& known, Welded welded)
    : mesh(std::move(welded.mesh)), influences(std::move(welded.influences)), limbs(known) {
  const Patches patches = orientPatches(mesh);
  openEdges = patches.pieces.openEdges;
  nonManifoldEdges = patches.pieces.nonManifoldEdges;
  turnedPatches = patches.turned;
  turnedTriangles = patches.pieces.turned;
  const std::size_t count = mesh.triangles.size();
  const double diagonal = surfaceBounds(mesh).diagonal();

  jointOfTriangle.resize(count);
  parallelFor(count, [&](std::size_t k) {
    std::array<const std::vector<Influence>*, 3> lists{};
    for (std::size_t i = 0; i < 3; ++i) lists[i] = &influences[mesh.triangles[k][i]];
    const std::array<double, 3> shares{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};
    jointOfTriangle[k] = strongest(blended(lists, shares));
  });

  // Sheets first: they enclose nothing and must not affect the winding numbers of the rest.
  tree.emplace(mesh.vertices, mesh.triangles);
  roles.assign(count, TriangleRole::kSkin);
  std::vector<double> inFront(count, 0.0);
  parallelFor(count, [&](std::size_t k) {
    const int patch = patches.pieces.pieceOfTriangle[k];
    if (!patches.pieces.open[patch]) return;
    double sum = 0.0;
    int asked = 0;
    askInFront(*this, *tree, corners(k), diagonal, [&](double number) {
      sum += number;
      ++asked;
    });
    inFront[k] = sum / asked;
  });
  std::vector<double> meanInFront(patches.areas.size(), 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t p = patches.pieces.pieceOfTriangle[k];
    if (patches.areas[p] > 0.0) meanInFront[p] += areaOf(corners(k)) / patches.areas[p] * inFront[k];
  }
  double area = 0.0;
  double sheetArea = 0.0;
  for (std::size_t p = 0; p < meanInFront.size(); ++p) {
    area += patches.areas[p];
    if (meanInFront[p] >= kSheet) continue;
    sheetArea += patches.areas[p];
    ++sheetPatches;
  }
  onlySheets = sheetPatches == patches.areas.size();
  if (onlySheets) sheetPatches = 0;  // something must remain to build a body from
  if (sheetPatches > 0) {
    sheetShare = sheetArea / area;
    for (std::size_t k = 0; k < count; ++k) {
      if (meanInFront[patches.pieces.pieceOfTriangle[k]] < kSheet) roles[k] = TriangleRole::kSheet;
    }
    std::vector<Triangle> others;
    others.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      if (roles[k] != TriangleRole::kSheet) others.push_back(mesh.triangles[k]);
    }
    winding.emplace(mesh.vertices, others);
  } else {
    winding = tree;
  }

  parallelFor(count, [&](std::size_t k) {
    if (roles[k] == TriangleRole::kSheet) return;
    bool hidden = true;
    askInFront(*this, *winding, corners(k), diagonal, [&](double number) { hidden = hidden && number > kHidden; });
    if (hidden) roles[k] = TriangleRole::kHidden;
  });

  patchOfTriangle = patches.pieces.pieceOfTriangle;
  ofJoint = thicknesses(*this, jointOfTriangle, character.skeleton.jointCount());
  ofPatch = thicknesses(*this, patchOfTriangle, patches.areas.size());
}

double chooseResolution(const SolidSource& source) {
  std::vector<Thickness> limbs = source.ofJoint;
  std::stable_sort(limbs.begin(), limbs.end(), [](const Thickness& a, const Thickness& b) { return a.min < b.min; });
  double whole = 0.0;
  for (const Thickness& limb : limbs) whole += limb.area;
  if (!(whole > 0.0)) whole = surfaceArea(source.mesh.vertices, source.mesh.triangles);
  double passed = 0.0;
  double thin = 0.0;
  for (const Thickness& limb : limbs) {
    if (limb.area == 0.0) continue;
    thin = limb.min;
    passed += limb.area;
    if (passed >= kThinShare * whole) break;
  }
  const auto voxelFor = [&](double vertices) { return std::sqrt(kVerticesAVoxelFace * whole / vertices); };
  return std::clamp(thin / kVoxelsAcross, voxelFor(kMaxVertices), voxelFor(kMinVertices));
}

}  // namespace lorica
