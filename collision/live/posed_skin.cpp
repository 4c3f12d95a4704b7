#include "collision/live/posed_skin.h"

#include "collision/live/clip_kernel.h"
#include "skinning/linear_blend.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lorica {
namespace {

constexpr std::size_t kGroup = 8;  ///< triangles
constexpr double kMargin = 1e-9;   ///< of balls, for rounding [m]
constexpr double kFarAway = 1e12;  ///< where balls of the padding are [m]

/// Sorts triangles so that each kGroup of them in turn lie close together.
void gather(std::span<std::int32_t> triangles, std::span<const Vec3> middles) {
  if (triangles.size() <= kGroup) {
    std::ranges::sort(triangles);  // libraries leave other orders behind
    return;
  }
  Aabb box;
  for (const std::int32_t t : triangles) box.extend(middles[t]);
  int axis = 0;
  (box.max - box.min).maxCoeff(&axis);
  const std::size_t half = (triangles.size() / 2 + kGroup - 1) / kGroup * kGroup;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
                   [&](std::int32_t a, std::int32_t b) {
                     return middles[a][axis] != middles[b][axis] ? middles[a][axis] < middles[b][axis] : a < b;
                   });
  gather(triangles.first(half), middles);
  gather(triangles.subspan(half), middles);
}

}  // namespace

void BallList::resize(std::size_t count) {
  const std::size_t padded = (count + kClipPadding - 1) / kClipPadding * kClipPadding;
  for (std::vector<double>* coordinate : {&x, &y, &z}) coordinate->assign(padded, kFarAway);
  radius.assign(padded, 0.0);
}

void BallList::set(std::size_t i, const Vec3& middle, double r) {
  x[i] = middle.x();
  y[i] = middle.y();
  z[i] = middle.z();
  radius[i] = r;
}

PosedSkin::PosedSkin(const Decomposition& decomposition, const Character& character) : character_(&character) {
  const TriMesh& mesh = character.mesh;
  LORICA_CHECK(decomposition.triangleCount == countOf(mesh.triangles), "the decomposition is of another mesh");
  std::vector<Vec3> middles;
  for (const auto& [a, b, c] : mesh.triangles) {
    middles.emplace_back((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0);
  }
  std::vector<Patch> patches;
  std::vector<VertexIndex> own(mesh.vertices.size());
  for (const Part& part : decomposition.parts) {
    Patch patch;
    patch.source = part.sourceTriangle;
    std::ranges::sort(patch.source);
    patch.source.erase(std::unique(patch.source.begin(), patch.source.end()), patch.source.end());
    std::erase(patch.source, -1);
    gather(patch.source, middles);
    for (const std::int32_t t : patch.source) {
      patch.vertices.insert(patch.vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
    std::ranges::sort(patch.vertices);
    patch.vertices.erase(std::unique(patch.vertices.begin(), patch.vertices.end()), patch.vertices.end());
    for (std::size_t v = 0; v < patch.vertices.size(); ++v) own[patch.vertices[v]] = static_cast<VertexIndex>(v);
    for (const std::int32_t t : patch.source) {
      const auto& [a, b, c] = mesh.triangles[t];
      patch.triangles.push_back({own[a], own[b], own[c]});
    }
    PosedPatch posed;
    posed.vertices.resize(patch.vertices.size());
    posed.balls.resize((patch.triangles.size() + kGroup - 1) / kGroup);
    posed_.push_back(std::move(posed));
    patches.push_back(std::move(patch));
  }
  patches_ = std::make_shared<const std::vector<Patch>>(std::move(patches));
  worldFromModel_.resize(character.jointFromModel.size(), Affine3::Identity());
}

void PosedSkin::update(std::span<const Affine3> worldFromModel) {
  LORICA_CHECK(worldFromModel.size() == worldFromModel_.size(), "one transform per joint");
  std::ranges::copy(worldFromModel, worldFromModel_.begin());
  for (PosedPatch& patch : posed_) patch.posed = false;
}

void PosedSkin::pose(PartIndex part) {
  const Patch& patch = (*patches_)[part];
  PosedPatch& posed = posed_[part];
  for (std::size_t v = 0; v < posed.vertices.size(); ++v) {
    posed.vertices[v] = skinLinearBlend(*character_, worldFromModel_, patch.vertices[v]);
  }
  for (std::size_t first = 0; first < patch.triangles.size(); first += kGroup) {
    const std::span<const Triangle> group =
        std::span(patch.triangles).subspan(first, std::min(kGroup, patch.triangles.size() - first));
    Aabb box;
    for (const Triangle& triangle : group) {
      for (const VertexIndex v : triangle) box.extend(posed.vertices[v]);
    }
    const Vec3 middle = box.center();
    double radiusSq = 0.0;
    for (const Triangle& triangle : group) {
      for (const VertexIndex v : triangle) radiusSq = std::max(radiusSq, (posed.vertices[v] - middle).squaredNorm());
    }
    posed.balls.set(first / kGroup, middle, std::sqrt(radiusSq) + kMargin);
  }
  posed.posed = true;
}

void PosedSkin::meet(PartIndex part, const Vec3& origin, const Vec3& direction, SkinHit& best) {
  if (!posed_[part].posed) pose(part);
  const Patch& patch = (*patches_)[part];
  const PosedPatch& posed = posed_[part];
  const auto meetTriangle = [&](std::size_t t) {
    // Moeller and Trumbore 1997.
    const auto& [i, j, k] = patch.triangles[t];
    const Vec3 corner = posed.vertices[i], ab = posed.vertices[j] - corner, ac = posed.vertices[k] - corner;
    const Vec3 across = direction.cross(ac), from = origin - corner;
    const double det = ab.dot(across);
    if (det == 0.0) return;
    const double u = from.dot(across) / det;
    if (!(u >= 0.0 && u <= 1.0)) return;
    const Vec3 q = from.cross(ab);
    const double v = direction.dot(q) / det, at = ac.dot(q) / det;
    if (!(v >= 0.0 && u + v <= 1.0 && at >= 0.0 && at < best.distance)) return;
    best.part = part;
    best.triangle = patch.source[t];
    best.weights = {1.0 - u - v, u, v};
    best.distance = at;
    best.position = origin + at * direction;
    best.normal = ab.cross(ac).normalized();
  };
  const BallList& list = posed.balls;
  const Balls balls{list.x, list.y, list.z, list.radius};
  for (std::size_t first = 0; first < list.x.size(); first += kMostBalls) {
    const std::size_t count = std::min(kMostBalls, list.x.size() - first);
    for (std::uint64_t near = ballsOnRay(balls, first, count, origin, direction, best.distance, 0.0); near != 0;
         near &= near - 1) {
      const std::size_t begin = kGroup * (first + static_cast<std::size_t>(std::countr_zero(near)));
      const std::size_t end = std::min(begin + kGroup, patch.triangles.size());
      for (std::size_t t = begin; t < end; ++t) meetTriangle(t);
    }
  }
}

}  // namespace lorica
