#include "geometry/convex_hull.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace lorica {
namespace {

// Quickhull (Barber, Dobkin, Huhdanpaa 1996) with exact visibility.
//
// Points are snapped to an integer grid with 2^40 steps along the longest side of their box, a step of 1e-12 of it. On
// the grid an orientation determinant fits into 128 bits, so its sign is exact: a floating-point filter decides nearly
// all cases, the integer evaluation the rest. There are two thresholds:
//   - a point is added if it lies more than tolerance * diagonal above a face;
//   - a face is removed if the new point lies above it or exactly on its plane. This weak visibility removes coplanar
//     faces together, so zero-area faces cannot occur and the horizon is one simple loop.
// On a plane with very many points, such as the end of a fine cylinder, that would take quadratic time. There the faces
// that are exactly level stay, if the new point only adds a triangle to theirs: the hull is the same.
//
// Where points are level but for rounding, such as the end of a fine cylinder that was turned, the farthest point sees
// most of a plane's faces again and again. After too many faces the work begins again with the points in random order,
// which makes few faces of any points (Clarkson and Shor 1989). It does of points that are not level: should there be
// too many faces again, the points are joggled by less than the finest tolerance, and it begins for the last time.

constexpr double kFinest = 1e-10;  // fraction of the diagonal
constexpr int kGridBits = 40;
constexpr double kUnitRoundoff = 1.1102230246251565e-16;
constexpr int kNone = -1;
constexpr int kManyLevel = 64;                                         // faces on one plane with a new point
constexpr std::size_t kManyTests = 1 << 28;                            // of a point and a face
constexpr int kJoggle = 32;                                            // grid steps
constexpr std::size_t kManyFaces = 1'000'000, kManyFacesOfAPoint = 8;  // made on the way

using Int128 = __int128;

struct Face {
  std::array<int, 3> vertex{};
  std::array<int, 3> neighbour{};  // across the edge vertex[i] -> vertex[i + 1]
  Vec3 normal = Vec3::Zero();      // not normalized: (b - a) x (c - a) on the grid
  double filter = 0.0;             // error bound of normal . (p - a)
  double addThreshold = 0.0;       // add points whose determinant exceeds this
  int outside = kNone;             // head of the list of points above this face
  int farthest = kNone;
  double farthestValue = 0.0;
  int visitedBy = kNone;  // last search that tested the visibility of this face
  bool visible = false;
  bool alive = true;
};

/// Between visible faces and one that is not.
struct HorizonEdge {
  int from, to, beyond;
};

class HullBuilder {
 public:
  // Builds the hull's faces in faces_. Returns false if the points have no volume.
  bool build(std::span<const Vec3> points, double tolerance, bool verify) {
    points_ = points;
    tolerance_ = tolerance;
    verify_ = verify;
    if (points.size() < 4 || !snap() || !makeSimplex()) return false;
    const std::size_t most = kManyFaces + kManyFacesOfAPoint * points.size();
    if (!drain(most) && !addInRandomOrder(most)) {
      joggle();
      (void)addInRandomOrder(std::numeric_limits<std::size_t>::max());
    }
    if (verify) addMissed();
    return true;
  }

  [[nodiscard]] double volume() const {
    const Vec3& origin = points_[simplex_[0]];
    double sum = 0.0;
    for (const Face& f : faces_) {
      if (!f.alive) continue;
      sum += (point(f.vertex[0]) - origin).dot((point(f.vertex[1]) - origin).cross(point(f.vertex[2]) - origin));
    }
    return sum / 6.0;
  }

  [[nodiscard]] std::vector<VertexIndex> vertexIndices() {
    std::vector<VertexIndex> indices;
    std::vector<int>& seen = scratch_;  // all kNone between calls
    for (const Face& f : faces_) {
      if (!f.alive) continue;
      for (const int p : f.vertex) seen[p] = p;
    }
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (seen[p] == kNone) continue;
      indices.push_back(p);
      seen[p] = kNone;
    }
    return indices;
  }

  [[nodiscard]] ConvexHull extract() {
    ConvexHull hull;
    hull.volume = volume();
    std::vector<int>& vertexOfPoint = scratch_;  // all kNone between calls
    for (const Face& f : faces_) {
      if (!f.alive) continue;
      Triangle t;
      for (int i = 0; i < 3; ++i) {
        int& slot = vertexOfPoint[f.vertex[i]];
        if (slot == kNone) {
          slot = countOf(hull.vertices);
          hull.pointOfVertex.push_back(f.vertex[i]);
          hull.vertices.push_back(point(f.vertex[i]));
        }
        t[i] = slot;
      }
      hull.triangles.push_back(t);
    }
    for (VertexIndex p : hull.pointOfVertex) vertexOfPoint[p] = kNone;
    return hull;
  }

 private:
  [[nodiscard]] const Vec3& point(int i) const { return points_[i]; }
  [[nodiscard]] const Vec3& grid(int i) const { return grid_[i]; }

  bool snap() {
    const Aabb box = boundsOf(points_);
    const double extent = (box.max - box.min).maxCoeff();
    if (!(extent > 0.0) || !std::isfinite(extent)) return false;
    // A power of two: snapping only drops bits, and axis-aligned planes stay planes.
    const double scale = std::ldexp(1.0, kGridBits - 1 - std::ilogb(extent));
    grid_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vec3 p = (points_[i] - box.min) * scale;
      grid_[i] = Vec3(std::nearbyint(p.x()), std::nearbyint(p.y()), std::nearbyint(p.z()));
    }
    diagonal_ = box.diagonal() * scale;
    next_.resize(points_.size());
    faceOf_.assign(points_.size(), kNone);
    scratch_.resize(points_.size(), kNone);
    return true;
  }

  // Finds four points that span a volume: the farthest pair of the axis extremes, then the point farthest from their
  // line, then the point farthest from the plane of these three.
  bool makeSimplex() {
    faces_.clear();
    searches_ = 0;
    free_.clear();
    pending_.clear();
    near_.clear();
    const int count = countOf(points_);
    std::array<int, 6> extreme{};
    for (int i = 1; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        if (grid(i)[axis] < grid(extreme[2 * axis])[axis]) extreme[2 * axis] = i;
        if (grid(i)[axis] > grid(extreme[2 * axis + 1])[axis]) extreme[2 * axis + 1] = i;
      }
    }
    double best = 0.0;
    for (int i : extreme) {
      for (int j : extreme) {
        const double distanceSq = (grid(i) - grid(j)).squaredNorm();
        if (distanceSq > best) {
          best = distanceSq;
          simplex_[0] = i;
          simplex_[1] = j;
        }
      }
    }
    if (best == 0.0) return false;
    const Vec3 a = grid(simplex_[0]);
    const Vec3 direction = (grid(simplex_[1]) - a).normalized();
    best = 0.0;
    for (int i = 0; i < count; ++i) {
      const double distanceSq = (grid(i) - a).cross(direction).squaredNorm();
      if (distanceSq > best) {
        best = distanceSq;
        simplex_[2] = i;
      }
    }
    if (std::sqrt(best) <= kFinest * diagonal_) return false;
    const Vec3 normal = direction.cross(grid(simplex_[2]) - a).normalized();
    best = 0.0;
    double side = 0.0;
    for (int i = 0; i < count; ++i) {
      const double distance = normal.dot(grid(i) - a);
      if (std::abs(distance) > best) {
        best = std::abs(distance);
        side = distance;
        simplex_[3] = i;
      }
    }
    if (best <= kFinest * diagonal_) return false;
    if (side > 0.0) std::swap(simplex_[1], simplex_[2]);  // puts the fourth point below the face 0 1 2

    const auto [p, q, r, s] = simplex_;
    const std::array<int, 4> f = {newFace(p, q, r), newFace(p, s, q), newFace(q, s, r), newFace(r, s, p)};
    faces_[f[0]].neighbour = {f[1], f[2], f[3]};
    faces_[f[1]].neighbour = {f[3], f[2], f[0]};
    faces_[f[2]].neighbour = {f[1], f[3], f[0]};
    faces_[f[3]].neighbour = {f[2], f[1], f[0]};
    created_.assign(f.begin(), f.end());
    prepareTests();
    for (int i = 0; i < count; ++i) assign(i);
    for (int face : created_) {
      if (faces_[face].outside != kNone) pending_.push_back(face);
    }
    return true;
  }

  int newFace(int a, int b, int c) {
    int index;
    if (free_.empty()) {
      index = countOf(faces_);
      faces_.emplace_back();
    } else {
      index = free_.back();
      free_.pop_back();
      faces_[index] = Face();
    }
    Face& f = faces_[index];
    f.vertex = {a, b, c};
    const Vec3 ab = grid(b) - grid(a);
    const Vec3 ac = grid(c) - grid(a);
    f.normal = ab.cross(ac);
    // The product of two lengths is at most half the sum of their squares.
    f.filter = 12.0 * kUnitRoundoff * (ab.squaredNorm() + ac.squaredNorm()) * diagonal_;
    f.addThreshold = tolerance_ * diagonal_ * f.normal.norm();
    return index;
  }

  [[nodiscard]] double determinant(const Face& f, int p) const { return f.normal.dot(grid(p) - grid(f.vertex[0])); }

  [[nodiscard]] Int128 exactDeterminant(const Face& f, int p) const {
    const Vec3& a = grid(f.vertex[0]);
    const auto difference = [&](int i) {
      const Vec3 d = grid(i) - a;  // integers below 2^41: exact
      return std::array<Int128, 3>{static_cast<std::int64_t>(d.x()), static_cast<std::int64_t>(d.y()),
                                   static_cast<std::int64_t>(d.z())};
    };
    const auto u = difference(f.vertex[1]);
    const auto v = difference(f.vertex[2]);
    const auto w = difference(p);
    return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2];
  }

  /// 1 if a point is above a face, 0 if exactly on its plane, -1 below.
  [[nodiscard]] int sideOf(int p, const Face& f) const {
    const double value = determinant(f, p);
    if (value > f.filter) return 1;
    if (value < -f.filter) return -1;
    const Int128 exact = exactDeterminant(f, p);
    return exact > 0 ? 1 : exact < 0 ? -1 : 0;
  }

  [[nodiscard]] bool collinear(int a, int b, int p) const {
    const Vec3 u = grid(b) - grid(a), v = grid(p) - grid(a);  // integers below 2^41: exact
    const auto product = [](double x, double y) -> Int128 {
      return static_cast<Int128>(static_cast<std::int64_t>(x)) * static_cast<std::int64_t>(y);
    };
    return product(u.y(), v.z()) == product(u.z(), v.y()) && product(u.z(), v.x()) == product(u.x(), v.z()) &&
           product(u.x(), v.y()) == product(u.y(), v.x());
  }

  [[nodiscard]] bool coplanar(const Face& a, const Face& b) const {
    return std::all_of(b.vertex.begin(), b.vertex.end(), [&](int p) { return exactDeterminant(a, p) == 0; });
  }

  /// Finds the faces that are visible from an apex, from a seed on, and the horizon around them. @param level  whether
  /// faces that the apex is level with are visible @return false if they are and there are more than `maxLevel`
  bool findVisible(int seed, int apex, bool level, int maxLevel) {
    const int search = ++searches_;
    visible_.assign(1, seed);
    horizon_.clear();
    faces_[seed].visitedBy = search;
    faces_[seed].visible = true;
    int levelFaces = 0;
    for (std::size_t i = 0; i < visible_.size(); ++i) {
      const Face& f = faces_[visible_[i]];
      for (int e = 0; e < 3; ++e) {
        Face& other = faces_[f.neighbour[e]];
        if (other.visitedBy != search) {
          other.visitedBy = search;
          const int side = sideOf(apex, other);
          other.visible = side > 0 || (level && side == 0);
          if (level && side == 0 && ++levelFaces > maxLevel) return false;
          if (other.visible) visible_.push_back(f.neighbour[e]);
        }
        if (!other.visible) horizon_.push_back({f.vertex[e], f.vertex[(e + 1) % 3], f.neighbour[e]});
      }
    }
    return true;
  }

  /// Whether level faces can stay: the apex makes no flat triangle, adds at most one to each plane, and leaves every
  /// vertex a corner.
  [[nodiscard]] bool levelFacesCanStay(int apex) const {
    std::vector<const HorizonEdge*> level;
    for (const HorizonEdge& h : horizon_) {
      if (sideOf(apex, faces_[h.beyond]) != 0) continue;
      if (collinear(h.from, h.to, apex)) return false;
      for (const HorizonEdge* other : level) {
        if (coplanar(faces_[other->beyond], faces_[h.beyond]) || !staysCorner(*other, h, apex) ||
            !staysCorner(h, *other, apex)) {
          return false;
        }
      }
      level.push_back(&h);
    }
    return true;
  }

  /// Whether the vertex between two edges of the horizon, if there is one, stays a corner. It lies on an edge to the
  /// apex if the apex is level with all its faces beyond them. Searched from both ends: a plane may have many.
  [[nodiscard]] bool staysCorner(const HorizonEdge& before, const HorizonEdge& after, int apex) const {
    const int v = before.to;
    if (v != after.from) return true;
    for (int low = before.beyond, high = after.beyond;;) {
      const Face &l = faces_[low], &h = faces_[high];
      if (sideOf(apex, l) != 0 || sideOf(apex, h) != 0) return true;
      const auto placeIn = [v](const Face& f) {
        return std::find(f.vertex.begin(), f.vertex.end(), v) - f.vertex.begin();
      };
      if (low == high) return false;
      low = l.neighbour[(placeIn(l) + 2) % 3];
      if (low == high) return false;
      high = h.neighbour[placeIn(h)];
    }
  }

  // Copies the data of the new faces that assign() reads into contiguous memory.
  void prepareTests() {
    tests_.clear();
    for (int index : created_) {
      const Face& f = faces_[index];
      tests_.push_back({f.normal, f.normal.dot(grid(f.vertex[0])), f.addThreshold - f.filter, index});
    }
  }

  // Adds a point to the list of the first face in tests_ that it lies above by more than the threshold.
  void assign(int p) {
    const Vec3 at = grid(p);
    bool barelyAbove = false;
    for (const FaceTest& test : tests_) {
      double value = test.normal.dot(at) - test.offset;
      if (value < test.limit) {
        barelyAbove |= value > 0.0;
        continue;
      }
      Face& f = faces_[test.face];
      if (value <= f.addThreshold + f.filter) {
        value = exactDeterminant(f, p);
        if (value <= f.addThreshold) {
          barelyAbove |= value > 0.0;
          continue;
        }
      }
      next_[p] = f.outside;
      faceOf_[p] = test.face;
      f.outside = p;
      if (value > f.farthestValue) {
        f.farthestValue = value;
        f.farthest = p;
      }
      return;
    }
    // The point is above a new face by less than the tolerance, but may be farther above an old one: addMissed()
    // checks it again.
    faceOf_[p] = kNone;
    if (barelyAbove && verify_) near_.push_back(p);
  }

  /// Adds all points above faces. @return false if that makes more new faces than `most`
  bool drain(std::size_t most = std::numeric_limits<std::size_t>::max()) {
    for (std::size_t made = 0; !pending_.empty();) {
      const int face = pending_.back();
      pending_.pop_back();
      if (!faces_[face].alive || faces_[face].outside == kNone) continue;
      if (made > most) return false;
      addPoint(face, faces_[face].farthest);
      made += created_.size();
    }
    return true;
  }

  /// Adds all points, from the beginning. @return false if that makes more new faces than `most`
  bool addInRandomOrder(std::size_t most) {
    (void)makeSimplex();
    std::vector<std::pair<std::uint64_t, int>> order(points_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = {randomBits(1, i), static_cast<int>(i)};
    std::sort(order.begin(), order.end());
    std::size_t made = 0;
    for (const auto& [random, p] : order) {
      if (faceOf_[p] == kNone) continue;
      if (made > most) return false;
      addPoint(std::exchange(faceOf_[p], kNone), p);
      made += created_.size();
      pending_.clear();
    }
    return true;
  }

  /// Moves all points by less than the finest tolerance.
  void joggle() {
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        grid_[i][axis] += static_cast<double>(randomBits(2 + axis, i) % (2 * kJoggle + 1)) - kJoggle;
      }
    }
  }

  void addPoint(int seed, int apex) {
    if (!findVisible(seed, apex, true, kManyLevel)) {
      (void)findVisible(seed, apex, false, 0);
      if (!levelFacesCanStay(apex)) (void)findVisible(seed, apex, true, std::numeric_limits<int>::max());
    }

    // Connect the apex to each horizon edge with a new face; consecutive faces share a horizon vertex.
    created_.clear();
    for (const HorizonEdge& h : horizon_) {
      const int face = newFace(h.from, h.to, apex);
      created_.push_back(face);
      faces_[face].neighbour[0] = h.beyond;
      Face& beyond = faces_[h.beyond];
      for (int e = 0; e < 3; ++e) {
        if (beyond.vertex[e] == h.to && beyond.vertex[(e + 1) % 3] == h.from) beyond.neighbour[e] = face;
      }
      scratch_[h.from] = face;
    }
    for (std::size_t i = 0; i < horizon_.size(); ++i) {
      const int following = scratch_[horizon_[i].to];
      LORICA_CHECK(following != kNone, "the horizon of an exactly computed visible region must be a closed loop");
      faces_[created_[i]].neighbour[1] = following;
      faces_[following].neighbour[2] = created_[i];
    }
    for (const HorizonEdge& h : horizon_) scratch_[h.from] = kNone;

    // Reassign the points of the removed faces; those that no new face sees are inside.
    prepareTests();
    for (int index : visible_) {
      int p = faces_[index].outside;
      faces_[index].outside = kNone;
      faces_[index].alive = false;
      while (p != kNone) {
        const int following = next_[p];
        if (p != apex) assign(p);
        p = following;
      }
    }
    free_.insert(free_.end(), visible_.begin(), visible_.end());
    for (int face : created_) {
      if (faces_[face].outside != kNone) pending_.push_back(face);
    }
  }

  // Checks again the points that were dropped when barely above one face: they may be well above another one.
  void addMissed() {
    std::vector<int> candidates;
    std::swap(candidates, near_);
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    if (candidates.size() * faces_.size() > kManyTests) {
      std::vector<std::array<Vec3, 3>> corners;
      std::vector<int> alive;
      for (std::size_t i = 0; i < faces_.size(); ++i) {
        const auto& [a, b, c] = faces_[i].vertex;
        if (!faces_[i].alive) continue;
        corners.push_back({grid(a), grid(b), grid(c)});
        alive.push_back(i);
      }
      const TriangleTree surface(std::move(corners), TriangleTree::Use::kDistances);
      const double within = tolerance_ * diagonal_;
      std::erase_if(candidates, [&](int p) {
        const TriangleTree::Hit hit = surface.nearest(grid(p), within);
        return hit.distance <= within || determinant(faces_[alive[hit.triangle]], p) <= 0.0;
      });
    }
    for (int p : candidates) {
      for (std::size_t i = 0; i < faces_.size(); ++i) {
        const Face& f = faces_[i];
        if (!f.alive || determinant(f, p) <= f.addThreshold + f.filter) continue;
        addPoint(i, p);
        drain();
        break;
      }
    }
  }

  struct FaceTest {
    Vec3 normal;
    double offset, limit;
    int face;
  };
  std::span<const Vec3> points_;
  std::vector<Vec3> grid_;
  std::vector<Face> faces_;
  std::vector<int> free_, pending_, next_, faceOf_, scratch_, visible_, created_, near_;
  std::vector<HorizonEdge> horizon_;
  std::vector<FaceTest> tests_;
  std::array<int, 4> simplex_{};
  double diagonal_ = 0.0;
  double tolerance_ = kFinest;
  bool verify_ = false;
  int searches_ = 0;
};

// One builder per thread, to reuse its memory between calls.
thread_local HullBuilder builder;

}  // namespace

ConvexHull convexHull(std::span<const Vec3> points) {
  if (builder.build(points, kFinest, true)) return builder.extract();
  ConvexHull flat;
  for (std::size_t i = 0; i < points.size(); ++i) {
    flat.pointOfVertex.push_back(i);
    flat.vertices.push_back(points[i]);
  }
  return flat;
}

double convexHullVolume(std::span<const Vec3> points, double tolerance) {
  return builder.build(points, tolerance, false) ? builder.volume() : 0.0;
}

HullOutline convexHullOutline(std::span<const Vec3> points, double tolerance) {
  if (builder.build(points, tolerance, false)) return {builder.vertexIndices(), builder.volume()};
  HullOutline flat{std::vector<VertexIndex>(points.size()), 0.0};
  std::iota(flat.points.begin(), flat.points.end(), 0);
  return flat;
}

double largestViolation(const ConvexHull& hull, std::span<const Vec3> points) {
  const double diagonal = boundsOf(hull.vertices).diagonal();
  double worst = 0.0;
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3 ab = hull.vertices[t[1]] - a;
    const Vec3 ac = hull.vertices[t[2]] - a;
    const Vec3 normal = ab.cross(ac);
    const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    // The plane of a sliver is numerically meaningless; its neighbours across the long edges bound the same region.
    if (normal.norm() <= 1e-7 * diagonal * longest) continue;
    const Vec3 unit = normal.normalized();
    for (const Vec3& p : points) worst = std::max(worst, unit.dot(p - a));
  }
  return worst;
}

}  // namespace lorica
