#include "export/rigid_colliders.h"

#include "acd/hull_budget.h"
#include "capture/retarget/proxy_skeleton.h"
#include "collision/live/attached_vertices.h"
#include "geometry/errors.h"
#include "geometry/parallel_progress.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace lorica {

namespace {

constexpr double kShareOfPart = 0.1;
constexpr double kShareOfBody = 1e-3;
constexpr std::size_t kPointsAtATime = 20000;  // of a hull
constexpr double kThickness = 1e-3;            // of a flat hull, of the character's height

/// Points that one bone moves together, as a triangle or alone.
struct Facet {
  std::vector<PointIndex> points;
  double area = 0.0;  // in the bind pose [m^2]
};

/// The points of one collider.
struct Group {
  JointIndex joint = 0;
  PartIndex part = -1;
  std::vector<PointIndex> points;
};

/// The sum of a facet's weights for each bone.
void addWeights(const Facet& facet, std::span<const LiftedPoint> lifted, std::span<double> weights) {
  for (const PointIndex p : facet.points) {
    for (const LiftedTerm& term : lifted[p]) weights[term.joint] += term.weight;
  }
}

JointIndex strongestOf(const Facet& facet, std::span<const LiftedPoint> lifted, std::vector<double>& scratch) {
  std::fill(scratch.begin(), scratch.end(), 0.0);
  addWeights(facet, lifted, scratch);
  return std::max_element(scratch.begin(), scratch.end()) - scratch.begin();
}

/// Divides the facets of a part among its bones.
std::vector<Group> groupByBone(std::span<const JointIndex> parents, PartIndex part, std::span<const Facet> facets,
                               std::span<const LiftedPoint> lifted, double leastShare) {
  std::vector<double> scratch(parents.size());
  std::vector<JointIndex> boneOf;
  std::vector<double> area(scratch.size(), 0.0);
  double all = 0.0;
  for (const Facet& facet : facets) {
    boneOf.push_back(strongestOf(facet, lifted, scratch));
    area[boneOf.back()] += facet.area;
    all += facet.area;
  }
  const JointIndex largest = std::max_element(area.begin(), area.end()) - area.begin();
  const auto kept = [&](JointIndex j) { return j == largest || area[j] >= std::max(leastShare * all, 1e-300); };
  const auto ownerOf = [&](JointIndex j) {
    while (j != kNoJoint && !kept(j)) j = parents[j];
    return j == kNoJoint ? largest : j;
  };
  std::vector<Group> groups(area.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    std::vector<PointIndex>& points = groups[ownerOf(boneOf[f])].points;
    points.insert(points.end(), facets[f].points.begin(), facets[f].points.end());
  }
  std::vector<Group> used;
  for (std::size_t j = 0; j < groups.size(); ++j) {
    std::vector<PointIndex>& points = groups[j].points;
    if (points.empty()) continue;
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    used.push_back({static_cast<JointIndex>(j), part, std::move(points)});
  }
  return used;
}

Facet facetOf(const Triangle& t, std::span<const Vec3> bind) {
  return {{t[0], t[1], t[2]}, 0.5 * areaNormal(bind, t).norm()};
}

/// The surface of each part and the vertices attached to it, by bones.
std::vector<Group> groupsOfParts(const Character& character, const Decomposition& decomposition,
                                 std::span<const LiftedPoint> lifted, std::span<const Vec3> bind) {
  const std::vector<std::vector<PointIndex>> attached = attachedVerticesOf(decomposition, lifted);
  const std::vector<JointIndex> parents = parentsOf(character);
  std::vector<Group> groups;
  for (std::size_t i = 0; i < decomposition.parts.size(); ++i) {
    const Part& part = decomposition.parts[i];
    std::vector<Facet> facets;
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      if (part.sourceTriangle[t] >= 0) facets.push_back(facetOf(part.triangles[t], bind));
    }
    for (const PointIndex p : attached[i]) facets.push_back({{p}, 0.0});
    for (Group& group : groupByBone(parents, i, facets, lifted, kShareOfPart)) {
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

/// The whole skin by bones.
std::vector<Group> groupsOfBody(const Character& character, std::span<const LiftedPoint> lifted,
                                std::span<const Vec3> bind) {
  const std::vector<PointIndex> first = firstAlike(lifted);
  std::vector<Facet> facets;
  for (const std::span triangles : {std::span(character.mesh.triangles), std::span(character.shown)}) {
    for (const Triangle& t : triangles) facets.push_back(facetOf({first[t[0]], first[t[1]], first[t[2]]}, bind));
  }
  return groupByBone(parentsOf(character), -1, facets, lifted, kShareOfBody);
}

/// Those of the group's points in all poses that are on the hull of what one bone carries back to the bind pose.
std::vector<Vec3> carriedPoints(const Group& group, std::span<const LiftedPoint> lifted, BonePoseView poses,
                                std::span<const Affine3> modelFromWorld, std::span<const Vec3> bind) {
  std::vector<Vec3> points;
  for (const PointIndex p : group.points) points.push_back(bind[p]);
  std::size_t onHull = 0;
  for (int k = 0; k < poses.poseCount(); ++k) {
    const Affine3& back = modelFromWorld[k * poses.jointCount + group.joint];
    for (const PointIndex p : group.points) points.push_back(back * positionOf(lifted[p], poses.pose(k)));
    // A hull costs less than twice as much of twice as many points, but memory is limited.
    if (points.size() < 2 * onHull + kPointsAtATime && k + 1 < poses.poseCount()) continue;
    const ConvexHull hull = convexHull(points);
    points = hull.vertices;
    onHull = points.size();
  }
  return points;
}

/// Gives flat points a thickness, since colliders are solids.
ConvexHull solidHull(std::vector<Vec3> points, double thickness) {
  ConvexHull hull = convexHull(points);
  if (!hull.degenerate()) return hull;
  const std::size_t count = points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = points[i];
    for (const Vec3& off : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
      points.push_back(p + thickness * off);
      points.push_back(p - thickness * off);
    }
  }
  return convexHull(points);
}

}  // namespace

std::vector<PointIndex> firstAlike(std::span<const LiftedPoint> lifted) {
  const auto key = [](const LiftedTerm& t) {
    return std::tuple(t.joint, t.weight, t.moment.x(), t.moment.y(), t.moment.z());
  };
  const auto less = [&](PointIndex a, PointIndex b) {
    return std::ranges::lexicographical_compare(lifted[a], lifted[b], {}, key, key);
  };
  std::vector<PointIndex> order(lifted.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, less);
  std::vector<PointIndex> first(lifted.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    first[order[i]] = i > 0 && !less(order[i - 1], order[i]) ? first[order[i - 1]] : order[i];
  }
  return first;
}

Result<std::vector<RigidCollider>> makeRigidColliders(const Character& character, const Decomposition& decomposition,
                                                      BonePoseView poses, const RigidColliderSettings& settings) {
  std::vector<Affine3> modelFromWorld;
  for (const Affine3& worldFromModel : poses.worldFromModel) {
    const double size = std::abs(worldFromModel.linear().determinant());
    if (!(size > 1e-12) || !std::isfinite(size)) {
      const JointIndex joint = modelFromWorld.size() % poses.jointCount;
      return unsupported("{}: joint '{}' is scaled to nothing in a pose; expected bones that keep their volume",
                         character.name, character.skeleton.joint(joint).name);
    }
    modelFromWorld.push_back(worldFromModel.inverse());
  }
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  std::vector<Vec3> bind;
  bind.reserve(lifted.size());
  for (const LiftedPoint& point : lifted) bind.push_back(bindPositionOf(point));
  const std::vector<Group> groups =
      settings.perBone ? groupsOfBody(character, lifted, bind) : groupsOfParts(character, decomposition, lifted, bind);

  std::vector<RigidCollider> colliders(groups.size());
  const bool finished = inParallel(groups.size(), settings.threads, settings.progress, [&](std::size_t i) {
    std::vector<Vec3> points = carriedPoints(groups[i], lifted, poses, modelFromWorld, bind);
    const ConvexHull hull = solidHull(points, 0.5 * kThickness * character.height);
    RigidCollider& collider = colliders[i];
    collider.joint = groups[i].joint;
    collider.part = groups[i].part;
    collider.capsule = capsuleAround(hull.vertices);
    BudgetedHull budgeted{{hull.vertices, hull.triangles}, hull.volume, 1.0};
    if (settings.budget.given()) budgeted = simplifyHull(hull, settings.budget);
    collider.hull = std::move(budgeted.mesh);
    collider.volume = budgeted.volume;
  });
  if (!finished) return cancelled();
  return colliders;
}

}  // namespace lorica
