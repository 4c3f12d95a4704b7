#include "viewer/renderer/overlay_mesh.h"

#include "geometry/counts.h"
#include "viewer/renderer/scene.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// An edge is fully visible if its faces differ by more than the second angle, and invisible below the first [rad].
// Hulls of round limbs have hundreds of edges of 10 degrees and less, which would obscure the shape.
constexpr double kFlatAngle = 0.28;
constexpr double kCrispAngle = 0.70;
constexpr double kOutlineStrength = 0.85;

std::int8_t packSigned(double x) {
  return std::lround(127.0 * std::clamp(x, -1.0, 1.0));
}
std::uint8_t packUnit(double x) {
  return std::lround(255.0 * std::clamp(x, 0.0, 1.0));
}

std::array<std::uint8_t, 4> packColor(const Vec3f& c, double opacity) {
  return {packUnit(c.x()), packUnit(c.y()), packUnit(c.z()), packUnit(opacity)};
}

constexpr double kShallow = 0.02;  // parts that reach less deep into a static body only touch it [m]

bool isFinite(const LivePart& part) {
  const std::vector<Vec3>& vertices = part.shape.vertices;
  return !part.shape.degenerate() && part.worldFromPart.matrix().allFinite() &&
         std::all_of(vertices.begin(), vertices.end(), [](const Vec3& v) { return v.allFinite(); });
}

/// Half the sides of a prop's bounding box in its own frame.
Vec3 halfSides(const Prop& prop) {
  const Vec3& half = prop.halfExtents;
  if (prop.shape == PropShape::kSphere) return Vec3::Constant(half.x());
  const bool round = prop.shape == PropShape::kCapsule || prop.shape == PropShape::kCylinder;
  return round ? Vec3(half.x(), half.y(), half.x()) : half;
}

/// Whether the boxes around a part and a prop, along the prop's axes, overlap by more than a touch.
bool reachesInto(const LivePart& part, const Prop& prop) {
  const auto propFromPart = prop.worldFromProp.inverse() * part.worldFromPart;
  Aabb box;
  for (const Vec3& v : part.shape.vertices) box.extend(propFromPart * v);
  const Vec3 half = halfSides(prop);
  const Vec3 deepest = (box.max + half).cwiseMin(half - box.min);
  return deepest.minCoeff() > kShallow;
}

bool reachesIntoAny(const LivePart& part, std::span<const Prop> props) {
  return std::any_of(props.begin(), props.end(),
                     [&](const Prop& prop) { return prop.mass == 0.0 && reachesInto(part, prop); });
}

}  // namespace

const std::vector<OverlayVertex>& OverlayMesh::insides(std::span<const HullFigure> figures, std::span<const Prop> props,
                                                       const Vec3& eye) {
  insideVertices_.clear();
  for (const HullFigure& figure : figures) {
    const std::span<const LivePart> parts = figure.parts;
    for (int i = 0; i < countOf(parts); ++i) {
      if (!isFinite(parts[i]) || !reachesIntoAny(parts[i], props)) continue;
      const ConvexHull hull = worldHull(parts[i]);
      const Vec3f color = partColor(figure.colorOf(i));
      append(insideVertices_, hull.vertices, hull.triangles, {color, 0.30f * color, 0.22, 0.0, 0.75, 0.0},
             figure.opacity, eye);
    }
  }
  return insideVertices_;
}

const std::vector<OverlayVertex>& OverlayMesh::hulls(std::span<const HullFigure> figures, const Vec3& eye) {
  hullVertices_.clear();
  order_.clear();
  for (std::size_t f = 0; f < figures.size(); ++f) {
    for (int i = 0; i < countOf(figures[f].parts); ++i) {
      const LivePart& part = figures[f].parts[i];
      if (!isFinite(part)) continue;
      const Vec3 center = part.worldFromPart * boundsOf(part.shape.vertices).center();
      order_.push_back({-(center - eye).squaredNorm(), f, i});
    }
  }
  std::sort(order_.begin(), order_.end());
  for (const auto& [nearness, figure, part] : order_) {
    const ConvexHull hull = worldHull(figures[figure].parts[part]);
    const Vec3f color = partColor(figures[figure].colorOf(part));
    append(hullVertices_, hull.vertices, hull.triangles, {color, 0.30f * color, 0.26, 0.10, 0.90, 0.28},
           figures[figure].opacity, eye);
  }
  return hullVertices_;
}

void OverlayMesh::findEdges(std::span<const Triangle> triangles) {
  halfEdges_.clear();
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = triangles[i][k], b = triangles[i][(k + 1) % 3];
      halfEdges_.push_back({std::min(a, b) << 32 | std::max(a, b), i});
    }
  }
  // After sorting by vertices, the two halves of an edge are adjacent.
  std::sort(halfEdges_.begin(), halfEdges_.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.key != b.key ? a.key < b.key : a.triangle < b.triangle;
  });
  edges_.clear();
  for (std::size_t i = 0; i + 1 < halfEdges_.size(); i += 2) {
    if (halfEdges_[i].key != halfEdges_[i + 1].key) {  // open edge: does not occur in hulls
      --i;
      continue;
    }
    const std::uint32_t f = halfEdges_[i].triangle, g = halfEdges_[i + 1].triangle;
    const double cosine = std::clamp(faceNormals_[f].dot(faceNormals_[g]), -1.0, 1.0);
    double strength = std::clamp((std::acos(cosine) - kFlatAngle) / (kCrispAngle - kFlatAngle), 0.0, 1.0);
    const bool outline = (facing_[f] > 0.0) != (facing_[g] > 0.0);
    if (outline) strength = std::max(strength, kOutlineStrength);
    if (strength <= 0.02) continue;
    edges_.push_back({static_cast<VertexIndex>(halfEdges_[i].key >> 32),
                      static_cast<VertexIndex>(halfEdges_[i].key & 0xffffffffu), strength,
                      facing_[f] <= 0.0 && facing_[g] <= 0.0});
  }
}

void OverlayMesh::append(std::vector<OverlayVertex>& out, std::span<const Vec3> vertices,
                         std::span<const Triangle> triangles, const Look& look, double opacity, const Vec3& eye) {
  faceNormals_.resize(triangles.size());
  facing_.resize(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Vec3& a = vertices[triangles[i][0]];
    faceNormals_[i] = (vertices[triangles[i][1]] - a).cross(vertices[triangles[i][2]] - a).stableNormalized();
    facing_[i] = faceNormals_[i].dot((eye - a).stableNormalized());
  }
  findEdges(triangles);

  for (const bool behind : {true, false}) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if ((facing_[i] <= 0.0) != behind) continue;
      // Like glass, a face at a grazing angle is more opaque.
      const double grazing = 1.0 - std::abs(facing_[i]);
      const double alpha = opacity * (behind ? look.farFace : look.nearFace * (1.0 + grazing * grazing));
      const Vec3& n = faceNormals_[i];
      for (const VertexIndex v : triangles[i]) {
        const Vec3f p = vertices[v].cast<float>();
        out.push_back(
            {p, p, {packSigned(n.x()), packSigned(n.y()), packSigned(n.z()), 0}, packColor(look.face, alpha)});
      }
    }
    for (const Edge& edge : edges_) {
      if (edge.behind != behind) continue;
      const Vec3f a = vertices[edge.first].cast<float>();
      const Vec3f b = vertices[edge.second].cast<float>();
      const auto color = packColor(look.edge, opacity * edge.strength * (behind ? look.farEdge : look.nearEdge));
      //  a+ --- b-     seen from b, the sides are swapped
      //  a- --- b+
      const OverlayVertex aPlus = {a, b, {127, 0, 0, 127}, color}, aMinus = {a, b, {127, 0, 0, -127}, color};
      const OverlayVertex bPlus = {b, a, {-127, 0, 0, 127}, color}, bMinus = {b, a, {-127, 0, 0, -127}, color};
      for (const OverlayVertex& v : {aPlus, aMinus, bPlus, aPlus, bPlus, bMinus}) out.push_back(v);
    }
  }
}

const std::vector<OverlayVertex>& OverlayMesh::bones(const Skeleton& skeleton, std::span<const Affine3> worldFromJoint,
                                                     const Vec3& eye, float opacity, bool further) {
  if (!further) boneVertices_.clear();
  LORICA_CHECK(worldFromJoint.size() == static_cast<std::size_t>(skeleton.jointCount()),
               "scene.worldFromJoint does not match the skeleton");
  //      waist at 0.15 of the length, four corners around it
  //  head <>------- tail
  constexpr std::array<Triangle, 8> kOctahedron = {
      {{2, 3, 1}, {3, 4, 1}, {4, 5, 1}, {5, 2, 1}, {3, 2, 0}, {4, 3, 0}, {5, 4, 0}, {2, 5, 0}}};
  const Look look = {Vec3f(0.055f, 0.085f, 0.15f), Vec3f(0.45f, 0.62f, 0.85f), 1.0, 1.0, 0.9, 0.0};
  const auto places = [&](JointIndex joint) {  // the hips, or above them
    JointIndex up = skeleton.jointOf(HumanBone::kHips);
    while (up != kNoJoint && up != joint) up = skeleton.joint(up).parent;
    return up == joint;
  };
  for (JointIndex i = 0; i < skeleton.jointCount(); ++i) {
    const JointIndex parent = skeleton.joint(i).parent;
    if (parent == kNoJoint || places(i)) continue;
    const Vec3 head = worldFromJoint[parent].translation();
    const Vec3 tail = worldFromJoint[i].translation();
    const double length = (tail - head).norm();
    if (!(length > 1e-6) || !std::isfinite(length)) continue;
    const Vec3 z = (tail - head) / length;
    const double width = std::clamp(0.09 * length, 0.003, 0.025);
    const Vec3 x = width * z.unitOrthogonal();
    const Vec3 y = z.cross(x);
    const Vec3 waist = head + 0.15 * (tail - head);
    const std::array<Vec3, 6> corners = {head, tail, waist + x, waist + y, waist - x, waist - y};
    append(boneVertices_, corners, kOctahedron, look, opacity, eye);
  }
  return boneVertices_;
}

}  // namespace lorica
