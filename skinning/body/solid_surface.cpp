#include "skinning/body/solid_surface.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mesh_repair.h"
#include "geometry/text.h"
#include "geometry/threads.h"
#include "skinning/body/level_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

constexpr int kBand = 3;                       // voxels around the triangles in which distances are computed
constexpr std::size_t kMaxVoxels = 48u << 20;  // 200 MB of distances
constexpr float kInsideLevel = 0.5f;           // winding number
constexpr float kBlocked = 0.6f;               // voxels: points nearer to a triangle than this block the flood fill
constexpr float kCore = 0.45f;                 // voxels: solid geometry has a point this deep nearby
constexpr int kLayer = 9;                      // voxels of 27 that a layer of one voxel fills
constexpr double kRod = 2.5;                   // voxels: limbs thinner than this in two directions are thickened
constexpr float kRodRadius = 0.6f;             // voxels around the triangles
constexpr double kTouch = 1.1;                 // voxels: limbs touch where the distances to both add up to at most this
constexpr float kRemoved = 0.3f;               // voxels: distance stored for a removed voxel
constexpr float kSlope = 8.0f;                 // voxels of distance per unit of winding number, across holes
constexpr double kCrumb = 2e-3;                // of the volume: smaller pieces are dropped
constexpr double kThinCrumb = 1e-6;            // of the volume, where thin things are kept
constexpr int kSurfaceRounds = 8;              // of smoothing; each has a step inward and one outward (Taubin 1995)
constexpr double kStepIn = 0.5;
constexpr double kStepOut = -0.53;
constexpr double kBehind = 0.25;        // voxels
constexpr double kSameDistance = 1e-6;  // voxels
constexpr double kCornerReach = 2.5;    // voxels: corners that stand out no farther are taken
constexpr int kBlock = 4;               // voxels: far from triangles, winding numbers are computed per block

Vec3 gridSizes(const Aabb& box, double voxel) {
  return ((box.max - box.min).array() / voxel + 2.0 * (kBand + 2)).ceil() + 1.0;
}

class Solid {
 public:
  Solid(const SolidSource& source, double voxel, bool keepThin) : source_(source), voxel_(voxel), keepThin_(keepThin) {}

  Result<SolidSurface> make() {
    LORICA_TRY_DO(layGrid());
    LORICA_TRY_DO(unsignedDistances(grid_, skin(), voxel_, kBand));
    wind();
    sign();
    dropThin();
    LORICA_TRY_DO(thickenRods());
    part();
    LORICA_TRY(TriMesh mesh, zeroSurface(grid_, voxel_));
    return finished(std::move(mesh));
  }

 private:
  Result<void> layGrid() {
    const Aabb box = surfaceBounds(source_.mesh);
    const Vec3 margin = Vec3::Constant((kBand + 2) * voxel_);
    const Vec3 sizes = gridSizes(box, voxel_);
    const double count = sizes.prod();
    if (!(count <= kMaxVoxels)) {
      return invalidArgument(
          "voxels of {:.4g} m: the character's box of {:.3g} x {:.3g} x {:.3g} m has more than {} "
          "of them, expected voxels of at least {:.3g} m",
          voxel_, box.max.x() - box.min.x(), box.max.y() - box.min.y(), box.max.z() - box.min.z(), kMaxVoxels,
          finestVoxel(source_.mesh));
    }
    for (std::size_t i = 0; i < 3; ++i) grid_.size[i] = sizes[i];
    grid_.origin = box.min - margin;
    grid_.values.assign(count, 0.0f);
    return {};
  }

  [[nodiscard]] Vec3 positionOf(int x, int y, int z) const { return grid_.origin + voxel_ * Vec3(x, y, z); }

  /// The triangles that may be on the surface.
  [[nodiscard]] TriMesh skin() const {
    TriMesh skin;
    skin.vertices = source_.mesh.vertices;
    for (std::size_t k = 0; k < source_.mesh.triangles.size(); ++k) {
      if (source_.roles[k] == TriangleRole::kSkin) skin.triangles.push_back(source_.mesh.triangles[k]);
    }
    if (skin.triangles.empty()) skin.triangles = source_.mesh.triangles;
    return skin;
  }

  /// Computes winding numbers: per voxel near triangles and across holes, elsewhere per block.
  void wind() {
    winding_.assign(grid_.values.size(), 0.0f);
    const auto blocks = [](int size) { return (size + kBlock - 1) / kBlock; };
    parallelFor(blocks(grid_.size[0]), [&](int bx) {
      for (int by = 0; by < blocks(grid_.size[1]); ++by) {
        for (int bz = 0; bz < blocks(grid_.size[2]); ++bz) windBlock({kBlock * bx, kBlock * by, kBlock * bz});
      }
    });
  }

  void windBlock(const std::array<int, 3>& begin) {
    std::array<int, 3> end{};
    for (std::size_t i = 0; i < 3; ++i) end[i] = std::min(begin[i] + kBlock, grid_.size[i]);
    const auto each = [&](auto&& visit) {
      for (int x = begin[0]; x < end[0]; ++x) {
        for (int y = begin[1]; y < end[1]; ++y) {
          for (int z = begin[2]; z < end[2]; ++z) visit(x, y, z);
        }
      }
    };
    bool near = false;
    each([&](int x, int y, int z) { near = near || grid_.at(x, y, z) < kBand - 0.5f; });
    float middle = 0.0f;
    if (!near) {
      const Vec3 at = 0.5 * (positionOf(begin[0], begin[1], begin[2]) + positionOf(end[0] - 1, end[1] - 1, end[2] - 1));
      middle = source_.windingAt(*source_.winding, at);
      near = std::abs(middle - kInsideLevel) < 0.3f;
    }
    each([&](int x, int y, int z) {
      winding_[grid_.index(x, y, z)] =
          near ? static_cast<float>(source_.windingAt(*source_.winding, positionOf(x, y, z))) : middle;
    });
  }

  /// Makes the distances signed: negative inside.
  void sign() {
    // Flood fill from outside along free voxels; voxels not reached are inside.
    std::vector<std::uint8_t> reached(grid_.values.size(), 0);
    std::vector<std::array<int, 3>> walk{{0, 0, 0}};  // a corner of the box is outside
    reached[0] = 1;
    while (!walk.empty()) {
      const std::array<int, 3> at = walk.back();
      walk.pop_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          std::array<int, 3> to = at;
          to[axis] += step;
          if (to[axis] < 0 || to[axis] >= grid_.size[axis]) continue;
          const std::size_t i = grid_.index(to[0], to[1], to[2]);
          if (reached[i] != 0 || grid_.values[i] < kBlocked || winding_[i] > kInsideLevel) continue;
          reached[i] = 1;
          walk.push_back(to);
        }
      }
    }
    for (std::size_t i = 0; i < grid_.values.size(); ++i) {
      const float distance = grid_.values[i];
      const bool wound = winding_[i] > kInsideLevel;
      const bool enclosed = !wound && distance >= kBlocked && reached[i] == 0;
      if (enclosed) {
        ++result_.enclosedVoxels;
        grid_.values[i] = -distance;
      } else {
        // Across a hole no triangle is near; there the winding number defines the surface.
        const float held = std::min(distance, kSlope * std::abs(winding_[i] - kInsideLevel));
        grid_.values[i] = wound ? -held : held;
      }
    }
  }

  /// Removes geometry without a deeper point nearby, which would become ragged: sheets with two sides, blades, hair
  /// tips.
  void dropThin() {
    std::vector<std::uint8_t> kept(grid_.values.size(), 0);
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = grid_.values[i] <= -kCore ? 1 : 0;
    for (int round = 0; round < 2; ++round) {
      for (std::size_t axis = 0; axis < 3; ++axis) spread(kept, axis);
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (grid_.values[i] < 0.0f && kept[i] == 0) takeOut(i);
    }
    // Remove layers of one voxel, which remain at the borders of sheets.
    std::vector<std::size_t> layers;
    for (int x = 1; x + 1 < grid_.size[0]; ++x) {
      for (int y = 1; y + 1 < grid_.size[1]; ++y) {
        for (int z = 1; z + 1 < grid_.size[2]; ++z) {
          if (grid_.at(x, y, z) < 0.0f && solidAround(x, y, z) <= kLayer) layers.push_back(grid_.index(x, y, z));
        }
      }
    }
    for (const std::size_t i : layers) takeOut(i);
  }

  void takeOut(std::size_t voxel) {
    grid_.values[voxel] = kRemoved;
    ++result_.thinVoxels;
  }

  /// Number of solid voxels in the block of 27 around a voxel, including itself.
  [[nodiscard]] int solidAround(int x, int y, int z) const {
    int count = 0;
    for (int i = x - 1; i <= x + 1; ++i) {
      for (int j = y - 1; j <= y + 1; ++j) {
        for (int k = z - 1; k <= z + 1; ++k) count += grid_.at(i, j, k) < 0.0f ? 1 : 0;
      }
    }
    return count;
  }

  /// Sets each voxel whose neighbour along an axis is set.
  void spread(std::vector<std::uint8_t>& set, std::size_t axis) const {
    const std::array<std::size_t, 3> strides{static_cast<std::size_t>(grid_.size[1]) * grid_.size[2],
                                             static_cast<std::size_t>(grid_.size[2]), 1};
    const std::size_t stride = strides[axis];
    // The outermost voxels are far from everything, so wrapping around there is harmless.
    std::vector<std::uint8_t> wider = set;
    for (std::size_t i = stride; i + stride < set.size(); ++i) wider[i] |= set[i - stride] | set[i + stride];
    set = std::move(wider);
  }

  /// Adds solid around the triangles of thin rods that have none.
  Result<void> thickenRods() {
    TriMesh rods;
    rods.vertices = source_.mesh.vertices;
    for (std::size_t k = 0; k < source_.mesh.triangles.size(); ++k) {
      if (source_.roles[k] == TriangleRole::kHidden || (!keepThin_ && !source_.isSkin(k))) continue;
      const Thickness& limb = source_.ofJoint[source_.jointOfTriangle[k]];
      const Thickness& piece = source_.ofPatch[source_.patchOfTriangle[k]];
      const bool rod =
          limb.middle < kRod * voxel_ || (piece.middle < kRod * voxel_ && piece.length > kRod * voxel_);  // not a rivet
      if ((rod && !isInSolid(k, false)) || (keepThin_ && !isInSolid(k, true))) {
        rods.triangles.push_back(source_.mesh.triangles[k]);
      }
    }
    if (rods.triangles.empty()) return {};
    result_.rodTriangles = rods.triangles.size();
    VoxelGrid distances = grid_;
    LORICA_TRY_DO(unsignedDistances(distances, rods, voxel_, kBand));
    for (std::size_t i = 0; i < grid_.values.size(); ++i) {
      grid_.values[i] = std::min(grid_.values[i], distances.values[i] - kRodRadius);
    }
    return {};
  }

  /// Whether solid is near a triangle's middle and corners: several voxels around the nearest one, or barely: a corner
  /// of the cell just behind.
  [[nodiscard]] bool isInSolid(std::size_t triangle, bool barely) const {
    const std::array<Vec3, 3> t = source_.corners(triangle);
    const Vec3 behind = kBehind * (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
    const auto near = [&](const Vec3& p) {
      const Vec3 at = (p - grid_.origin) / voxel_;
      if (barely) return hasSolidCorner((at - behind).array().floor().cast<int>());
      const Eigen::Vector3i voxel = at.array().round().cast<int>();
      return solidAround(voxel.x(), voxel.y(), voxel.z()) > kLayer;
    };
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    return near(middle) && std::all_of(t.begin(), t.end(), [&](const Vec3& corner) {
             return near(0.2 * middle + 0.8 * corner) && near(0.6 * middle + 0.4 * corner);
           });
  }

  /// Whether a corner of the cell that begins at a voxel is solid.
  [[nodiscard]] bool hasSolidCorner(const Eigen::Vector3i& at) const {
    for (int i = 0; i < 8; ++i) {
      if (grid_.at(at.x() + (i & 1), at.y() + (i >> 1 & 1), at.z() + (i >> 2)) < 0.0f) return true;
    }
    return false;
  }

  /// Removes voxels where two limbs touch.
  void part() {
    std::vector<std::size_t> counts(grid_.size[0], 0);
    parallelFor(grid_.size[0], [&](int x) {
      std::vector<std::pair<JointIndex, double>> near;  // distance of each joint's skin
      for (int y = 0; y < grid_.size[1]; ++y) {
        for (int z = 0; z < grid_.size[2]; ++z) {
          float& value = grid_.values[grid_.index(x, y, z)];
          if (value >= kRemoved) continue;
          const Vec3 at = positionOf(x, y, z);
          near.clear();
          source_.tree->forEachWithin(at, kTouch * voxel_, [&](std::int32_t t, double distance) {
            if (source_.roles[t] == TriangleRole::kSheet) return;
            const JointIndex joint = source_.jointOfTriangle[t];
            const auto known = std::find_if(near.begin(), near.end(), [&](const auto& n) { return n.first == joint; });
            if (known == near.end()) {
              near.emplace_back(joint, distance);
            } else {
              known->second = std::min(known->second, distance);
            }
          });
          bool touch = false;
          for (std::size_t a = 0; a < near.size(); ++a) {
            for (std::size_t b = 0; b < a; ++b) {
              touch = touch || (near[a].second + near[b].second <= kTouch * voxel_ &&
                                source_.limbs.apart(near[a].first, near[b].first, at));
            }
          }
          if (!touch) continue;
          value = kRemoved;
          ++counts[x];
        }
      }
    });
    for (const std::size_t count : counts) result_.partedVoxels += count;
  }

  /// Drops tiny pieces and bubbles, and turns the rest into a two-manifold.
  Result<SolidSurface> finished(TriMesh mesh) {
    const Error nothing{
        ErrorCode::kBadMesh,
        fmt::format("the {} nothing thicker than {:.4g} m, expected a body",
                    counted(std::ssize(source_.mesh.triangles), "triangle encloses", "triangles enclose"), voxel_)};
    if (mesh.triangles.empty()) return nothing;
    if (signedVolume(mesh.vertices, mesh.triangles) < 0.0) {
      for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    const Components pieces = connectedComponents(mesh.vertices.size(), mesh.triangles);
    std::vector<std::vector<Triangle>> trianglesOf(pieces.count);
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      trianglesOf[pieces.componentOfTriangle[k]].push_back(mesh.triangles[k]);
    }
    std::vector<double> volumes;
    double whole = 0.0;
    for (const std::vector<Triangle>& piece : trianglesOf) {
      volumes.push_back(signedVolume(mesh.vertices, piece));
      whole += volumes.back();
    }
    TriMesh kept;
    std::vector<VertexIndex> numberOf(mesh.vertices.size(), -1);
    for (std::size_t p = 0; p < trianglesOf.size(); ++p) {
      if (volumes[p] < (keepThin_ ? kThinCrumb : kCrumb) * whole) {
        if (volumes[p] > 0.0) ++result_.droppedPieces;
        continue;
      }
      ++result_.pieces;
      for (Triangle t : trianglesOf[p]) {
        for (VertexIndex& v : t) {
          VertexIndex& number = numberOf[v];
          if (number < 0) {
            number = countOf(kept.vertices);
            kept.vertices.push_back(mesh.vertices[v]);
          }
          v = number;
        }
        kept.triangles.push_back(t);
      }
    }
    if (kept.triangles.empty()) return nothing;
    LORICA_TRY(MeshRepair repaired, repairClosedMesh(kept));
    result_.mesh = std::move(repaired.mesh);
    smooth(result_.mesh);
    if (keepThin_) takeCorners(result_.mesh);
    return std::move(result_);
  }

  /// Moves vertices of the surface to those of the triangles that are just outside: those that voxels round off.
  void takeCorners(TriMesh& mesh) const {
    struct Move {
      double distance = 0.0;  // in steps
      VertexIndex from = -1;
    };
    const TriangleTree tree(mesh.vertices, mesh.triangles);
    std::vector<Move> moves(source_.mesh.vertices.size());
    parallelFor(moves.size(), [&](std::size_t v) {
      const Vec3& corner = source_.mesh.vertices[v];
      const TriangleTree::Hit hit = tree.nearest(corner, kCornerReach * voxel_, [](std::int32_t) { return true; });
      if (hit.triangle < 0 || tree.windingNumber(corner) > kInsideLevel) return;
      Eigen::Index nearest = 0;
      hit.shares.maxCoeff(&nearest);
      // In steps, so that rounding does not choose between corners that are as far.
      moves[v] = {std::round(hit.distance / (kSameDistance * voxel_)), mesh.triangles[hit.triangle][nearest]};
    });
    std::vector<std::size_t> order;
    for (std::size_t v = 0; v < moves.size(); ++v) {
      if (moves[v].from >= 0) order.push_back(v);
    }
    std::ranges::stable_sort(order,
                             [&](std::size_t a, std::size_t b) { return moves[a].distance > moves[b].distance; });
    std::vector<bool> moved(mesh.vertices.size());
    for (const std::size_t v : order) {
      const VertexIndex from = moves[v].from;
      if (moved[from]) continue;
      mesh.vertices[from] = source_.mesh.vertices[v];
      moved[from] = true;
    }
  }

  /// Smooths the grid's steps out of the surface.
  static void smooth(TriMesh& mesh) {
    std::vector<Vec3> sum(mesh.vertices.size());
    std::vector<int> count(mesh.vertices.size());
    for (int round = 0; round < 2 * kSurfaceRounds; ++round) {
      std::fill(sum.begin(), sum.end(), Vec3::Zero());
      std::fill(count.begin(), count.end(), 0);
      for (const Triangle& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
          sum[t[i]] += mesh.vertices[t[(i + 1) % 3]];
          ++count[t[i]];
        }
      }
      const double step = round % 2 == 0 ? kStepIn : kStepOut;
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (count[v] > 0) mesh.vertices[v] += step * (sum[v] / count[v] - mesh.vertices[v]);
      }
    }
  }

  const SolidSource& source_;
  double voxel_;
  bool keepThin_;
  VoxelGrid grid_;
  std::vector<float> winding_;
  SolidSurface result_;
};

}  // namespace

double finestVoxel(const TriMesh& mesh) {
  constexpr double kCoarser = 1.02;
  const Aabb box = surfaceBounds(mesh);
  double voxel = (box.max - box.min).maxCoeff() / kMaxVoxels;
  while (voxel > 0.0 && gridSizes(box, voxel).prod() > kMaxVoxels) voxel *= kCoarser;
  return voxel * kCoarser;  // margin for rounding
}

Result<SolidSurface> solidSurface(const SolidSource& source, double voxel, bool keepThin) {
  return Solid(source, voxel, keepThin).make();
}

}  // namespace lorica
