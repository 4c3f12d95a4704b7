#include "acd/decompose.h"

#include "acd/decomposer.h"
#include "acd/mesh_frame.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/flat_faces.h"
#include "geometry/mass_properties.h"
#include "geometry/threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace lorica {
namespace {

constexpr int kGridBits = 34;  // cells along the largest coordinate are 2 to this power, see inOwnFrame()

/// Removes cut points that no part needs any more, and renumbers the rest.
void dropUnusedCutPoints(Decomposition& decomposition) {
  const std::size_t vertexCount = decomposition.vertexCount;
  std::vector<bool> used(decomposition.pointCount(), false);
  for (const Part& part : decomposition.parts) {
    for (const PointIndex p : part.points) used[p] = true;
  }
  for (std::size_t c = decomposition.cutPoints.size(); c-- > 0;) {
    if (!used[vertexCount + c]) continue;
    used[decomposition.cutPoints[c].first] = true;
    used[decomposition.cutPoints[c].second] = true;
  }
  std::vector<PointIndex> numberOf(used.size());
  std::iota(numberOf.begin(), numberOf.begin() + decomposition.vertexCount, 0);
  std::vector<CutPoint> kept;
  kept.reserve(decomposition.cutPoints.size());
  for (std::size_t c = 0; c < decomposition.cutPoints.size(); ++c) {
    if (!used[vertexCount + c]) continue;
    numberOf[vertexCount + c] = decomposition.vertexCount + countOf(kept);
    CutPoint point = decomposition.cutPoints[c];
    point.first = numberOf[point.first];
    point.second = numberOf[point.second];
    kept.push_back(point);
  }
  decomposition.cutPoints = std::move(kept);
  const auto renumber = [&](PointIndex& p) { p = numberOf[p]; };
  for (Part& part : decomposition.parts) {
    for (Triangle& t : part.triangles) std::for_each(t.begin(), t.end(), renumber);
    std::for_each(part.points.begin(), part.points.end(), renumber);
  }
}

/// The keyframes in the mesh's own frame, rounded to a grid: turning a mesh changes its coordinates there by rounding
/// errors, which would decide between planes that are as good as each other. The parts are expressed in vertices, so
/// nothing has to be turned back.
std::vector<Vec3> inOwnFrame(const TriMesh& mesh, PoseView keyframes) {
  const Mat3 frame = frameOf(keyframes.keyframe(0), mesh.triangles);
  const Vec3 center = massProperties(keyframes.keyframe(0), mesh.triangles).center;
  std::vector<Vec3> own;
  own.reserve(keyframes.positions.size());
  double farthest = 0.0;
  for (const Vec3& p : keyframes.positions) {
    own.emplace_back(frame * (p - center));
    farthest = std::max(farthest, own.back().cwiseAbs().maxCoeff());
  }
  int exponent = 0;
  (void)std::frexp(1.1 * farthest, &exponent);  // a size that is no power of two for meshes of round size
  const double cell = std::ldexp(1.0, exponent - kGridBits);
  for (Vec3& p : own) {
    for (double& x : p) x = std::round(x / cell) * cell;
  }
  return own;
}

/// A rigid mesh as its surface alone decides: with as few triangles as its flat faces need, and vertices in the order
/// of their positions.
struct PlainMesh {
  TriMesh mesh;
  std::vector<VertexIndex> vertexOf;     // of the given mesh
  std::vector<std::int32_t> triangleOf;  // the same
};

PlainMesh plainMesh(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  PlainMesh plain;
  plain.vertexOf.resize(points.size());
  std::iota(plain.vertexOf.begin(), plain.vertexOf.end(), 0);
  std::stable_sort(plain.vertexOf.begin(), plain.vertexOf.end(), [&](VertexIndex a, VertexIndex b) {
    return std::lexicographical_compare(points[a].begin(), points[a].end(), points[b].begin(), points[b].end());
  });
  std::vector<VertexIndex> numberOf(points.size());
  for (std::size_t v = 0; v < points.size(); ++v) {
    numberOf[plain.vertexOf[v]] = v;
    plain.mesh.vertices.push_back(points[plain.vertexOf[v]]);
  }
  for (const Triangle& t : triangles) plain.mesh.triangles.push_back({numberOf[t[0]], numberOf[t[1]], numberOf[t[2]]});
  FlatFaces merged = mergeFlatFaces(plain.mesh);
  if (checkClosedTwoManifold({plain.mesh.vertices, merged.triangles})) {
    plain.mesh.triangles = std::move(merged.triangles);
    plain.triangleOf = std::move(merged.sources);
  } else {
    plain.triangleOf.resize(triangles.size());
    std::iota(plain.triangleOf.begin(), plain.triangleOf.end(), 0);
  }
  return plain;
}

/// In its own frame, which is that of the plain mesh too: of a symmetric one, the order of vertices and triangles would
/// decide where it points.
PlainMesh plainInOwnFrame(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  const PlainMesh given = plainMesh(points, triangles);
  PlainMesh plain = plainMesh(inOwnFrame(given.mesh, {given.mesh.vertices, countOf(points)}), given.mesh.triangles);
  for (VertexIndex& v : plain.vertexOf) v = given.vertexOf[v];
  for (std::int32_t& t : plain.triangleOf) t = given.triangleOf[t];
  return plain;
}

/// Expresses parts of a plain mesh in vertices and triangles of the mesh that it was made of.
void giveBack(const PlainMesh& plain, int triangleCount, Decomposition& decomposition) {
  const auto renumber = [&](PointIndex& p) {
    if (p < decomposition.vertexCount) p = plain.vertexOf[p];
  };
  decomposition.triangleCount = triangleCount;
  for (CutPoint& point : decomposition.cutPoints) {
    renumber(point.first);
    renumber(point.second);
  }
  for (Part& part : decomposition.parts) {
    for (Triangle& t : part.triangles) std::for_each(t.begin(), t.end(), renumber);
    for (std::int32_t& source : part.sourceTriangle) source = source < 0 ? source : plain.triangleOf[source];
    std::for_each(part.points.begin(), part.points.end(), renumber);
    std::sort(part.points.begin(), part.points.end());
  }
}

}  // namespace

Result<Decomposition> decompose(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings) {
  if (settings.maxParts < 0 || settings.candidateEdges < 0 || settings.planesPerEdge < 0 || settings.threads < 0) {
    return invalidArgument("parts {}, candidate edges {}, planes per edge {}, threads {}: expected 0 or more of each",
                           settings.maxParts, settings.candidateEdges, settings.planesPerEdge, settings.threads);
  }
  if (!(settings.maxError >= 0.0 && settings.maxDistance >= 0.0 && settings.maxConcavity >= 0.0)) {
    return invalidArgument("max error {}, max distance {}, max concavity {}: expected 0 or more of each",
                           settings.maxError, settings.maxDistance, settings.maxConcavity);
  }
  if (keyframes.vertexCount != countOf(mesh.vertices) || keyframes.keyframeCount() < 1 ||
      keyframes.positions.size() % mesh.vertices.size() != 0) {
    return invalidArgument("{} keyframe positions for a mesh of {} vertices: expected a positive multiple",
                           keyframes.positions.size(), mesh.vertices.size());
  }
  if (settings.rigid && keyframes.keyframeCount() > 1) {
    return invalidArgument("{} keyframes of a rigid mesh, expected one", keyframes.keyframeCount());
  }
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    TriMesh posed;
    posed.vertices.assign(keyframes.keyframe(k).begin(), keyframes.keyframe(k).end());
    posed.triangles = mesh.triangles;
    if (Result<void> checked = checkClosedTwoManifold(posed); !checked) {
      Error error = checked.error();
      if (keyframes.keyframeCount() > 1) error.message = fmt::format("keyframe {}: {}", k, error.message);
      return error;
    }
  }
  std::optional<PlainMesh> plain;
  std::vector<Vec3> own;
  if (settings.rigid) {
    plain = plainInOwnFrame(keyframes.positions, mesh.triangles);
  } else {
    own = inOwnFrame(mesh, keyframes);
  }
  Result<Decomposition> result = withThreads(settings.threads, [&] {
    return plain ? cutAndMerge(plain->mesh, {plain->mesh.vertices, keyframes.vertexCount}, settings)
                 : cutAndMerge(mesh, {own, keyframes.vertexCount}, settings);
  });
  if (result && plain) giveBack(*plain, countOf(mesh.triangles), *result);
  if (result) dropUnusedCutPoints(*result);
  return result;
}

}  // namespace lorica
