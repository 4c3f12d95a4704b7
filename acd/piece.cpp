#include "acd/piece.h"

#include "geometry/convex_hull.h"
#include "geometry/threads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lorica {
namespace {

// Points closer to a plane than this are on it, relative to the diagonal of the mesh in that keyframe.
constexpr double kOnPlane = 1e-9;
// Files with 6 digits and 32-bit numbers leave positions inexact by up to half of this share of the diagonal.
constexpr double kNoise = 1e-5;
// A part whose hull volume exceeds its own by less than this share of the mesh's volume counts as convex.
constexpr double kConvex = 1e-9;
// Rounding error of a distance from a plane, relative to the largest coordinate: matters far from the origin.
constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();

/// The same triangle with its smallest index first.
Triangle canonical(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// Whether a part differs from its hull by no more than noise: the volume between them is that of a layer as thin, and
/// no concave edge is deeper. Volume alone would miss a small deep notch.
bool convexButForNoise(const Piece& piece, std::size_t k, const CutContext& context) {
  const std::vector<Vec3> corners = hullPointsOf({&piece}, k, context);
  const Vec3 side = boundsOf(corners).max - boundsOf(corners).min;
  const double area = 2.0 * (side.x() * side.y() + side.y() * side.z() + side.z() * side.x());
  if (piece.error(k) > context.noise[k] * area) return false;
  const std::vector<ConcaveEdge> deepest = deepestConcaveEdges(
      piece.creases, context.mesh.triangles, context.normals[k], context.points[k], convexHull(corners), 1, 0.0);
  return deepest.empty() || deepest.front().depth <= context.noise[k];
}

}  // namespace

CutContext::CutContext(const TriMesh& closedMesh, PoseView keyframes) : mesh(closedMesh) {
  for (int k = 0; k < keyframes.keyframeCount(); ++k) {
    const std::span<const Vec3> frame = keyframes.keyframe(k);
    points.emplace_back(frame.begin(), frame.end());
    normals.push_back(unitNormals(mesh.triangles, frame));
    const Aabb box = boundsOf(frame);
    const double largest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
    onPlane.push_back(kOnPlane * box.diagonal() + kRounding * largest);
    noise.push_back(kNoise * box.diagonal());
    meshVolume.push_back(signedVolume(frame, mesh.triangles));
  }
}

void CutContext::addCutPoints(std::span<const CutPoint> added) {
  for (std::vector<Vec3>& frame : points) {
    for (const CutPoint& c : added) {
      frame.push_back(c.lambda * frame[c.first] + (1.0 - c.lambda) * frame[c.second]);
    }
  }
  cutPoints.insert(cutPoints.end(), added.begin(), added.end());
}

double Piece::totalError() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < volume.size(); ++k) sum += error(k);
  return sum;
}

std::size_t Piece::worstKeyframe() const {
  std::size_t worst = 0;
  for (std::size_t k = 1; k < volume.size(); ++k) {
    if (error(k) > error(worst)) worst = k;
  }
  return worst;
}

double Piece::totalHullVolume() const {
  return std::accumulate(hullVolume.begin(), hullVolume.end(), 0.0);
}

Piece measure(Part part, const CutContext& context) {
  Piece w;
  w.part = std::move(part);
  w.volume.resize(context.keyframeCount());
  w.hullVolume.resize(context.keyframeCount());
  w.hullPoints.resize(context.keyframeCount());
  parallelFor(context.keyframeCount() + 1, [&](std::size_t k) {
    if (k == context.keyframeCount()) {
      w.creases = creasesOf(w.part);
      return;
    }
    thread_local std::vector<Vec3> own;
    own.clear();
    for (PointIndex p : w.part.points) own.push_back(context.points[k][p]);
    const HullOutline outline = convexHullOutline(own);
    w.hullVolume[k] = outline.volume;
    w.hullPoints[k].reserve(outline.points.size());
    for (VertexIndex v : outline.points) w.hullPoints[k].push_back(w.part.points[v]);
    w.volume[k] = signedVolume(context.points[k], w.part.triangles);
  });
  for (std::size_t k = 0; k < context.keyframeCount(); ++k) {
    w.convex.push_back(w.error(k) <= kConvex * std::abs(context.meshVolume[k]) || convexButForNoise(w, k, context));
  }
  return w;
}

std::vector<Vec3> hullPointsOf(std::initializer_list<const Piece*> pieces, std::size_t keyframe,
                               const CutContext& context) {
  std::vector<Vec3> points;
  for (const Piece* piece : pieces) {
    for (const PointIndex p : piece->hullPoints[keyframe]) points.push_back(context.points[keyframe][p]);
  }
  return points;
}

bool overlap(const Aabb& a, const Aabb& b, double margin) {
  return ((a.min.array() - margin) <= b.max.array()).all() && ((b.min.array() - margin) <= a.max.array()).all();
}

std::vector<Aabb> boxesOf(const Piece& piece, const CutContext& context) {
  std::vector<Aabb> boxes(context.keyframeCount());
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    for (const PointIndex p : piece.hullPoints[k]) boxes[k].extend(context.points[k][p]);
  }
  return boxes;
}

Part unite(std::span<const Part* const> parts) {
  // A cap triangle and its reverse cancel one for one: a part may contain one of them twice.
  std::vector<Triangle> caps;
  for (const Part* part : parts) {
    for (std::size_t i = 0; i < part->triangles.size(); ++i) {
      if (part->sourceTriangle[i] < 0) caps.push_back(canonical(part->triangles[i]));
    }
  }
  std::sort(caps.begin(), caps.end());
  std::vector<std::int32_t> takenOut(caps.size(), 0);  // counted at the first of several equal triangles
  Part whole;
  for (const Part* part : parts) {
    for (std::size_t i = 0; i < part->triangles.size(); ++i) {
      const Triangle& t = part->triangles[i];
      if (part->sourceTriangle[i] < 0) {
        const auto [own, ownEnd] = std::equal_range(caps.begin(), caps.end(), canonical(t));
        const auto [other, otherEnd] = std::equal_range(caps.begin(), caps.end(), canonical({t[0], t[2], t[1]}));
        std::int32_t& count = takenOut[own - caps.begin()];
        if (count < std::min(ownEnd - own, otherEnd - other)) {
          ++count;
          continue;
        }
      }
      whole.triangles.push_back(t);
      whole.sourceTriangle.push_back(part->sourceTriangle[i]);
    }
  }
  whole.points = pointsUsedBy(whole.triangles);
  return whole;
}

}  // namespace lorica
