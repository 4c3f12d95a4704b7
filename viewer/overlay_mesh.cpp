#include "viewer/overlay_mesh.h"

#include "viewer/scene.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// An edge shows fully above the second angle between its faces and not at all below the first [rad]. Hulls of round
// limbs have hundreds of edges of 10 degrees and less, which would bury the shape.
constexpr double kFlatAngle = 0.21;
constexpr double kCrispAngle = 0.62;

std::array<std::int8_t, 4> packedNormal(const Vec3& n) {
  const auto pack = [](double x) { return static_cast<std::int8_t>(std::lround(127.0 * std::clamp(x, -1.0, 1.0))); };
  return {pack(n.x()), pack(n.y()), pack(n.z()), 0};
}

std::array<std::uint8_t, 4> packedColor(const Vec3f& c, std::uint8_t alpha) {
  const auto pack = [](float x) { return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(x, 0.0f, 1.0f))); };
  return {pack(c.x()), pack(c.y()), pack(c.z()), alpha};
}

}  // namespace

const std::vector<OverlayVertex>& OverlayMesh::hulls(std::span<const LivePart> parts, const Vec3& eye) {
  hullVertices_.clear();
  order_.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ConvexHull& hull = parts[i].hull;
    if (hull.degenerate()) continue;
    Aabb box;
    bool finite = true;
    for (const Vec3& v : hull.vertices) {
      box.extend(v);
      finite = finite && v.allFinite();
    }
    if (finite) order_.emplace_back(-(box.center() - eye).squaredNorm(), static_cast<PartIndex>(i));
  }
  std::sort(order_.begin(), order_.end());
  for (const auto& [distance, part] : order_) appendHull(parts[static_cast<std::size_t>(part)].hull, part, eye);
  return hullVertices_;
}

void OverlayMesh::appendHull(const ConvexHull& hull, PartIndex part, const Vec3& eye) {
  const std::size_t count = hull.triangles.size();
  const auto corner = [&](std::size_t triangle, std::size_t k) -> const Vec3& {
    return hull.vertices[static_cast<std::size_t>(hull.triangles[triangle][k])];
  };
  faceNormals_.resize(count);
  halfEdges_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    faceNormals_[i] = (corner(i, 1) - corner(i, 0)).cross(corner(i, 2) - corner(i, 0)).stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(hull.triangles[i][(k + 1) % 3]);
      const auto b = static_cast<std::uint32_t>(hull.triangles[i][(k + 2) % 3]);
      halfEdges_.push_back({(static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b),
                            static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k)});
    }
  }

  // Sorted by their vertices, both halves of an edge are neighbours; a half without partner is a border and crisp.
  std::sort(halfEdges_.begin(), halfEdges_.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
  });
  strengths_.assign(count, {255, 255, 255, 0});
  for (std::size_t i = 0; i + 1 < halfEdges_.size(); ++i) {
    const HalfEdge& a = halfEdges_[i];
    const HalfEdge& b = halfEdges_[i + 1];
    if (a.key != b.key) continue;
    const double cosine = std::clamp(faceNormals_[a.triangle].dot(faceNormals_[b.triangle]), -1.0, 1.0);
    const double t = std::clamp((std::acos(cosine) - kFlatAngle) / (kCrispAngle - kFlatAngle), 0.0, 1.0);
    const auto strength = static_cast<std::uint8_t>(std::lround(255.0 * t));
    strengths_[a.triangle][a.edge] = strength;
    strengths_[b.triangle][b.edge] = strength;
    ++i;
  }

  const std::array<std::uint8_t, 4> color = packedColor(partColor(part), 0);
  for (const bool looksHere : {false, true}) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((faceNormals_[i].dot(eye - corner(i, 0)) > 0.0) != looksHere) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        hullVertices_.push_back({corner(i, k).cast<float>(), packedNormal(faceNormals_[i]), color, strengths_[i]});
      }
    }
  }
}

const std::vector<OverlayVertex>& OverlayMesh::bones(const Skeleton& skeleton,
                                                     std::span<const Affine3> worldFromJoint) {
  boneVertices_.clear();
  CHECK(worldFromJoint.size() == static_cast<std::size_t>(skeleton.jointCount()),
        "scene.worldFromJoint does not fit the skeleton");
  for (JointIndex i = 0; i < skeleton.jointCount(); ++i) {
    const JointIndex parent = skeleton.joint(i).parent;
    if (parent == kNoJoint) continue;
    appendBone(worldFromJoint[static_cast<std::size_t>(parent)].translation(),
               worldFromJoint[static_cast<std::size_t>(i)].translation());
  }
  return boneVertices_;
}

void OverlayMesh::appendBone(const Vec3& head, const Vec3& tail) {
  const Vec3 along = tail - head;
  const double length = along.norm();
  if (!(length > 1e-6) || !std::isfinite(length)) return;
  //      waist at 0.15 of the length, four corners around it
  //  head <>------- tail
  const Vec3 z = along / length;
  const Vec3 x = z.unitOrthogonal();
  const Vec3 y = z.cross(x);
  const double width = std::clamp(0.09 * length, 0.003, 0.025);
  const Vec3 waist = head + 0.15 * along;
  const std::array<Vec3, 4> around = {waist + width * x, waist + width * y, waist - width * x, waist - width * y};
  const std::array<std::uint8_t, 4> color = packedColor({0.90f, 0.86f, 0.74f}, 255);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3& a = around[k];
    const Vec3& b = around[(k + 1) % 4];
    const std::array<std::array<Vec3, 3>, 2> faces = {{{a, b, tail}, {b, a, head}}};
    for (const auto& face : faces) {
      const Vec3 normal = (face[1] - face[0]).cross(face[2] - face[0]).stableNormalized();
      for (const Vec3& corner : face) {
        boneVertices_.push_back({corner.cast<float>(), packedNormal(normal), color, {255, 255, 255, 0}});
      }
    }
  }
}

}  // namespace lorica
