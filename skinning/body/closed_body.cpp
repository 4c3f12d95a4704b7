#include "skinning/body/closed_body.h"

#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mesh_repair.h"
#include "geometry/small_faults.h"
#include "geometry/threads.h"
#include "geometry/triangle_tree.h"
#include "skinning/body/body_assembly.h"
#include "skinning/body/solid_source.h"
#include "skinning/body/solid_surface.h"
#include "skinning/body/transfer_weights.h"
#include "skinning/body/weld.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace lorica {
namespace {

constexpr double kInside = 0.5;  // winding number

/// The joint that moves a vertex most.
JointIndex strongestJoint(const Character& character, std::size_t vertex) {
  const auto begin = character.influences.begin() + character.influenceBegin[vertex];
  const auto end = character.influences.begin() + character.influenceBegin[vertex + 1];
  return std::max_element(begin, end, [](const Influence& a, const Influence& b) { return a.weight < b.weight; })
      ->joint;
}

/// The hulls of the vertices that each joint moves most.
std::map<JointIndex, ConvexHull> hullsOfJoints(const Character& character) {
  std::map<JointIndex, std::vector<Vec3>> points;
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    points[strongestJoint(character, v)].push_back(character.mesh.vertices[v]);
  }
  std::map<JointIndex, ConvexHull> hulls;
  for (const auto& [joint, own] : points) hulls[joint] = convexHull(own);
  return hulls;
}

constexpr int kSamples = 4096;

std::vector<double> distancesOutside(const TriangleTree& tree, std::span<const Vec3> points) {
  std::vector<double> distances(points.size(), 0.0);
  parallelFor(points.size(), [&](std::size_t i) {
    if (tree.windingNumber(points[i]) < kInside) distances[i] = tree.nearest(points[i]).distance;
  });
  return distances;
}

std::vector<double> distancesTo(const TriangleTree& tree, std::span<const Vec3> points) {
  std::vector<double> distances(points.size(), 0.0);
  parallelFor(points.size(), [&](std::size_t i) { distances[i] = tree.nearest(points[i]).distance; });
  return distances;
}

double meanOf(std::span<const double> values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? 0.0 : sum / values.size();
}

double largestOf(std::span<const double> values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

constexpr int kSteps = 5;
constexpr double kCoarsest = 0.125;  // largest voxel, relative to the character's longest side

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// Whether every shell encloses its own volume. Shells with overlapping boxes may overlap, so they do not qualify.
bool shellsApart(const TriMesh& mesh, const Components& shells) {
  if (shells.count == 1) return true;
  const std::size_t count = shells.count;
  std::vector<Aabb> boxes(count);
  std::vector<std::vector<Triangle>> triangles(count);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const std::size_t s = shells.componentOfTriangle[k];
    triangles[s].push_back(mesh.triangles[k]);
    for (const VertexIndex v : mesh.triangles[k]) boxes[s].extend(mesh.vertices[v]);
  }
  for (std::size_t a = 0; a < count; ++a) {
    if (signedVolume(mesh.vertices, triangles[a]) <= 0.0) return false;
    for (std::size_t b = 0; b < a; ++b) {
      const bool apart =
          (boxes[a].min.array() >= boxes[b].max.array()).any() || (boxes[b].min.array() >= boxes[a].max.array()).any();
      if (!apart) return false;
    }
  }
  return true;
}

class BodyMaker {
 public:
  BodyMaker(const Character& character, const BodySettings& settings) : character_(character), settings_(settings) {}

  Result<ClosedBody> run() {
    if (!step(0)) return cancelled();
    const Limbs limbs(character_);
    welded_ = weld(character_, limbs);
    if (welded_.mesh.triangles.empty()) {
      return badMesh("the character has {} vertices and {} triangles, expected a surface",
                     character_.mesh.vertices.size(), character_.mesh.triangles.size());
    }
    if (welded_.weldedVertices > 0) {
      note(fmt::format("{} welded to others at the same position",
                       counted(welded_.weldedVertices, "vertex was", "vertices were")));
    }
    if (welded_.droppedTriangles > 0) {
      note(counted(welded_.droppedTriangles, "triangle without area was dropped",
                   "triangles without area were dropped"));
    }
    if (!(surfaceArea(welded_.mesh.vertices, welded_.mesh.triangles) > 0.0)) {
      return badMesh("the character's {} triangles have no area, expected a surface", welded_.mesh.triangles.size());
    }
    body_.shells = connectedComponents(welded_.mesh.vertices.size(), welded_.mesh.triangles).count;
    if (settings_.keepClosed && keepAsItIs()) {
      (void)step(kSteps);
      return std::move(body_);
    }
    return make(limbs);
  }

 private:
  [[nodiscard]] bool step(int done) const { return !settings_.progress || settings_.progress(done, kSteps); }
  void note(std::string sentence) { body_.notes.push_back(std::move(sentence)); }

  /// Keeps the surface if it is closed and solid. @return whether it was kept
  bool keepAsItIs() {
    TriMesh mesh = welded_.mesh;
    const bool turned = signedVolume(mesh.vertices, mesh.triangles) < 0.0;
    if (turned) {
      for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    Result<MeshRepair> repaired = repairClosedMesh(mesh);
    if (!repaired || !checkClosedTwoManifold(repaired->mesh)) return false;
    const Components shells = connectedComponents(repaired->mesh.vertices.size(), repaired->mesh.triangles);
    if (!shellsApart(repaired->mesh, shells)) {
      note(fmt::format("its {} closed shells may overlap, so one surface was built around them", shells.count));
      return false;
    }
    if (turned) note("the surface was inside out and was flipped");
    if (repaired->changed()) note(repaired->summary());
    if (welded_.mixedVertices > 0) {
      note(fmt::format("at {} the welded vertices had different weights: their mean is used",
                       counted(welded_.mixedVertices, "position", "positions")));
    }
    body_.nonManifoldEdges = repaired->nonManifoldEdges;
    body_.shells = shells.count;
    body_.character = bonesOf(character_);
    for (std::size_t v = 0; v < repaired->mesh.vertices.size(); ++v) {
      const VertexOrigin& origin = repaired->origin[v];
      const std::array<const std::vector<Influence>*, 2> lists{&welded_.influences[origin.first],
                                                               &welded_.influences[origin.second]};
      const std::array<double, 2> shares{0.5, 0.5};
      appendVertex(body_.character, repaired->mesh.vertices[v],
                   origin.first == origin.second ? *lists[0] : blended(lists, shares));
    }
    body_.character.mesh.triangles = std::move(repaired->mesh.triangles);
    body_.bodyVertices = countOf(body_.character.mesh.vertices);
    return true;
  }

  Result<ClosedBody> make(const Limbs& limbs) {
    body_.made = true;
    Welded original = welded_;
    if (const std::size_t duplicates = dropDuplicates(original.mesh.triangles); duplicates > 0) {
      note(counted(duplicates, "duplicate triangle was ignored", "duplicate triangles were ignored"));
    }
    const SolidSource source(character_, limbs, std::move(original));
    if (source.crowded()) return crowded(source);
    tell(source);
    if (!step(1)) return cancelled();

    body_.resolution = settings_.resolution > 0.0 ? settings_.resolution : chooseResolution(source);
    // Too fine for the thinnest in any case: an eighth of what the grid may have is enough.
    const double finest = finestVoxel(source.mesh);
    if (settings_.resolution <= 0.0 && body_.resolution < finest) body_.resolution = 2.0 * finest;
    const Aabb box = boundsOf(character_.mesh.vertices);
    const double coarsest = kCoarsest * (box.max - box.min).maxCoeff();
    if (settings_.resolution > coarsest) {
      return invalidArgument(
          "body resolution {:.4g} m: expected at most {:.4g} m, an eighth of the character's longest side",
          settings_.resolution, coarsest);
    }
    Result<SolidSurface> made = solidSurface(source, body_.resolution, settings_.keepThin);
    if (source.crowded()) return crowded(source);
    LORICA_TRY(const SolidSurface solid, std::move(made));
    tell(solid);
    if (!step(2)) return cancelled();

    const std::vector<std::vector<Influence>> weights = transferWeights(solid.mesh, source, body_.resolution);
    if (!step(3)) return cancelled();

    body_.character = assembleBody(character_, solid.mesh, weights);
    body_.bodyVertices = countOf(weights);
    const std::vector<Affine3> bind(character_.jointFromModel.size(), Affine3::Identity());
    body_.distances = distancesInPose(body_, bind);
    (void)step(kSteps);  // the body is complete: cancelling has no effect any more
    return std::move(body_);
  }

  static Error crowded(const SolidSource& source) {
    return badMesh("its {} triangles lie inside each other in too many layers to tell what is inside",
                   source.mesh.triangles.size());
  }

  void tell(const SolidSource& source) {
    body_.openEdges = source.openEdges;
    body_.nonManifoldEdges = source.nonManifoldEdges;
    body_.onlySheets = source.onlySheets;
    if (source.turnedPatches > 0) {
      note(counted(source.turnedPatches, "piece was inside out and was flipped",
                   "pieces were inside out and were flipped"));
    }
    if (source.turnedTriangles > 0) {
      note(counted(source.turnedTriangles, "triangle was oriented against its neighbours and was flipped",
                   "triangles were oriented against their neighbours and were flipped"));
    }
    if (source.sheetPatches > 0) {
      note(fmt::format("{} no volume ({:.1f} % of the surface): covered by the hulls, not decomposed",
                       counted(source.sheetPatches, "open sheet encloses", "open sheets enclose"),
                       100.0 * source.sheetShare));
    }
  }

  void tell(const SolidSurface& solid) {
    note(fmt::format("a closed surface of {} vertices in {} was built with voxels of {:.4g} m",
                     solid.mesh.vertices.size(), counted(solid.pieces, "piece", "pieces"), body_.resolution));
    if (solid.droppedPieces > 0) {
      note(fmt::format("{} too small to be parts: covered by the hulls, not decomposed",
                       counted(solid.droppedPieces, "loose piece is", "loose pieces are")));
    }
    if (solid.thinVoxels > 0) {
      note(fmt::format("geometry thinner than {:.4g} m is covered by the hulls, not decomposed", body_.resolution));
    }
    if (solid.rodTriangles > 0) note("limbs too thin for the voxels were thickened");
    if (solid.partedVoxels > 0) {
      note(fmt::format("limbs that touch in the bind pose were separated at {}",
                       counted(solid.partedVoxels, "voxel", "voxels")));
    }
  }

  const Character& character_;
  const BodySettings& settings_;
  Welded welded_;
  ClosedBody body_;
};

}  // namespace

Result<ClosedBody> makeBody(const Character& character, const BodySettings& settings) {
  if (!(settings.resolution >= 0.0) || !std::isfinite(settings.resolution) || settings.threads < 0) {
    return invalidArgument("body resolution {} m, threads {}: expected both >= 0", settings.resolution,
                           settings.threads);
  }
  LORICA_TRY_DO(checkCharacter(character));
  return withThreads(settings.threads, [&] { return BodyMaker(character, settings).run(); });
}

BodyDistances distancesInPose(const ClosedBody& body, std::span<const Affine3> worldFromModel) {
  BodyDistances result;
  if (!body.made) return result;
  const Character& character = body.character;
  std::vector<Vec3> posed(character.mesh.vertices.size());
  skinLinearBlend(character, worldFromModel, posed);
  const std::size_t bodyCount = body.bodyVertices;
  const std::span<const Vec3> bodyVertices = std::span(posed).first(bodyCount);
  const std::size_t shownCount = posed.size() - bodyCount - body.reachedVertices;
  const std::span<const Vec3> shownVertices = std::span(posed).subspan(bodyCount, shownCount);

  const TriangleTree bodyTree(posed, character.mesh.triangles);
  const TriangleTree shownTree(posed, character.shown);
  result.farthestOutside = largestOf(distancesOutside(bodyTree, shownVertices));
  result.meanOutside = meanOf(distancesOutside(bodyTree, spreadPoints(posed, character.shown, kSamples)));
  const std::vector<double> spread = distancesTo(shownTree, spreadPoints(posed, character.mesh.triangles, kSamples));
  result.meanToOriginal = meanOf(spread);
  result.farthestToOriginal = std::max(largestOf(spread), largestOf(distancesTo(shownTree, bodyVertices)));
  return result;
}

int coverReached(ClosedBody& body, const Character& character, std::span<const ReachedPosition> reached) {
  if (reached.empty()) return 0;

  // 1. How far each position is outside of what holds it anyway.
  Character& made = body.character;
  const TriangleTree tree(made.mesh.vertices, made.mesh.triangles);
  const std::map<JointIndex, ConvexHull> hulls = hullsOfJoints(made);
  std::vector<double> outside(reached.size(), 0.0);
  parallelFor(reached.size(), [&](std::size_t i) {
    const Vec3& p = reached[i].position;
    const auto hull = hulls.find(strongestJoint(character, reached[i].vertex));
    const bool solid = hull != hulls.end() && !hull->second.degenerate();
    const double ofHull = solid ? largestViolation(hull->second, std::span(&p, 1)) : kInfinity;
    if (ofHull < kReachTolerance || tree.windingNumber(p) >= kInside) return;
    outside[i] = std::min(ofHull, tree.nearest(p).distance);
  });

  // 2. Those that are far enough become vertices.
  int added = 0;
  double farthest = 0.0;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (outside[i] < kReachTolerance) continue;
    const std::size_t v = reached[i].vertex;
    made.mesh.vertices.push_back(reached[i].position);
    made.influences.insert(made.influences.end(), character.influences.begin() + character.influenceBegin[v],
                           character.influences.begin() + character.influenceBegin[v + 1]);
    made.influenceBegin.push_back(made.influences.size());
    farthest = std::max(farthest, outside[i]);
    ++added;
  }
  body.reachedVertices += added;
  if (added > 0) {
    body.notes.push_back(
        fmt::format("the hulls hold morph targets at their largest weights: {} positions up to {:.0f} mm outside the "
                    "body were added",
                    added, 1000.0 * farthest));
  }
  return added;
}

}  // namespace lorica
