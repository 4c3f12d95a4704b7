#include "acd/fewer_planes.h"

#include "acd/cut.h"
#include "geometry/counts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kSameHalfSpace = 1e-7;   // half-spaces and corners closer than this are one
constexpr double kTooSmall = 1e-12;       // twice the area below which a triangle has no reliable plane
constexpr double kNoCorner = 1e4;         // a corner farther away counts as one that does not exist
constexpr double kFaceReach = 100.0;      // faces are looked at so far from the origin
constexpr std::size_t kMostPlanes = 256;  // planes to drop from; of more, those that matter the least go at once
// Turning, as tangents of angles.
constexpr double kFirstTurn = 0.3, kLastTurn = 0.005;
constexpr int kMovedRounds = 8;                // in which each plane is turned
constexpr double kMovedGain = 1e-3;            // share of the volume that a round gains if there is another one
constexpr int kExchanges = 20;                 // of a plane
constexpr double kExchangeGain = 1e-4;         // share of the volume that an exchange gains
constexpr std::size_t kMostCuts = 20'000'000;  // of faces by planes, which take about a second

/// Half-spaces normal . x <= 1 around the origin, which are points of the dual: dropping one takes a vertex from a
/// convex hull.
std::vector<Vec3> dualOf(const ConvexHull& body) {
  std::vector<Vec3> dual;
  for (const Triangle& t : body.triangles) {
    const Vec3& a = body.vertices[t[0]];
    Vec3 normal = (body.vertices[t[1]] - a).cross(body.vertices[t[2]] - a);
    if (normal.dot(a) < 0.0) normal = -normal;  // axes may mirror
    const double length = normal.norm();
    if (length <= kTooSmall) continue;  // its neighbours bound the same region
    double offset = 0.0;
    for (const Vec3& p : body.vertices) offset = std::max(offset, normal.dot(p));
    const Vec3 found = normal / offset;
    const auto same = [&](const Vec3& d) {
      return (d - found).squaredNorm() <= kSameHalfSpace * kSameHalfSpace * found.squaredNorm();
    };
    if (std::ranges::none_of(dual, same)) dual.push_back(found);
  }
  return dual;
}

/// Where the planes of three half-spaces meet.
Vec3 cornerOf(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  return normal / normal.dot(a);
}

/// Drops the cheapest half-spaces one after the other.
class Dropping {
 public:
  explicit Dropping(std::vector<Vec3> dual) : dual_(std::move(dual)) {
    connect();
    cost_.assign(dual_.size(), 0.0);
    for (std::size_t i = 0; i < dual_.size(); ++i) cost_[i] = costOf(i);
  }

  [[nodiscard]] const std::vector<Vec3>& dual() const { return dual_; }

  /// Drops the half-space that adds the least volume. @return false if what is left would be unbounded
  bool step() {
    const std::size_t i = std::ranges::min_element(cost_) - cost_.begin();
    if (dual_.size() <= 4 || cost_[i] == kInfinity) return false;
    std::vector<std::size_t> again = ring_[i];
    dual_.erase(dual_.begin() + static_cast<std::ptrdiff_t>(i));
    cost_.erase(cost_.begin() + static_cast<std::ptrdiff_t>(i));
    connect();
    for (std::size_t& j : again) j -= j > i ? 1 : 0;
    // What bounded nothing may bound now.
    for (std::size_t j = 0; j < cost_.size(); ++j) {
      if (cost_[j] == 0.0 || std::ranges::find(again, j) != again.end()) cost_[j] = costOf(j);
    }
    return true;
  }

 private:
  void connect() {
    const ConvexHull hull = convexHull(dual_);
    ring_.assign(dual_.size(), {});
    faces_.clear();
    for (const Triangle& t : hull.triangles) {
      const auto at = [&](int k) { return hull.pointOfVertex[t[k]]; };
      faces_.push_back({at(0), at(1), at(2)});
      for (int k = 0; k < 3; ++k) ring_[at(k)].push_back(at((k + 1) % 3));
    }
  }

  /// The volume that is added without a half-space: the corners of what is left that lie beyond it, and its own.
  [[nodiscard]] double costOf(std::size_t i) const {
    if (ring_[i].empty()) return 0.0;  // it bounds nothing
    // Only its neighbours matter, and enough of the others that the origin is among them; all, should that not do.
    std::vector<Vec3> some;
    for (const std::size_t j : ring_[i]) some.push_back(dual_[j]);
    for (int d = 0; d < 27; ++d) {
      const Vec3 direction = Eigen::Vector3i(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1).cast<double>();
      std::size_t best = i == 0 ? 1 : 0;
      for (std::size_t j = 0; j < dual_.size(); ++j) {
        if (j != i && direction.dot(dual_[j]) > direction.dot(dual_[best])) best = j;
      }
      some.push_back(dual_[best]);
    }
    if (const double cost = costBeyond(i, some); cost < kInfinity) return cost;
    some = dual_;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(i));
    return costBeyond(i, some);
  }

  [[nodiscard]] double costBeyond(std::size_t i, std::span<const Vec3> others) const {
    std::vector<Vec3> region;
    const ConvexHull rest = convexHull(others);
    if (rest.degenerate()) return kInfinity;
    for (const Triangle& t : rest.triangles) {
      const Vec3 &a = rest.vertices[t[0]], &b = rest.vertices[t[1]], &c = rest.vertices[t[2]];
      const Vec3 corner = cornerOf(a, b, c);
      // Unbounded if the origin is not inside the dual, where each face would have it below.
      if ((b - a).cross(c - a).dot(a) <= 0.0 || !(corner.norm() < kNoCorner)) return kInfinity;
      if (dual_[i].dot(corner) > 1.0) region.push_back(corner);
    }
    if (region.empty()) return 0.0;
    for (const Triangle& t : faces_) {
      if (std::ranges::find(t, static_cast<VertexIndex>(i)) == t.end()) continue;
      region.push_back(cornerOf(dual_[t[0]], dual_[t[1]], dual_[t[2]]));
    }
    return convexHullVolume(region);
  }

  std::vector<Vec3> dual_;
  std::vector<Triangle> faces_;
  std::vector<std::vector<std::size_t>> ring_;
  std::vector<double> cost_;
};

/// Lowers the volume of a polyhedron around a body by other planes, as many as before.
class Moving {
 public:
  /// @param body  must outlive this object
  Moving(std::span<const Vec3> dual, std::span<const Vec3> body) : body_(body) {
    for (const Vec3& d : dual) planes_.push_back({d.normalized(), 1.0 / d.norm()});
  }

  void run() {
    turnAll();
    for (int i = 0; i < kExchanges && exchange(); ++i) continue;
  }

  [[nodiscard]] std::vector<Vec3> dual() const {
    std::vector<Vec3> dual;
    for (const Plane& plane : planes_) dual.push_back(plane.normal / plane.offset);
    return dual;
  }

 private:
  void turnAll() {
    for (int round = 0; round < kMovedRounds; ++round) {
      double before = 0.0, gained = 0.0;
      for (std::size_t i = 0; i < planes_.size(); ++i) {
        if (cuts_ > kMostCuts) return;
        const auto [from, to] = turn(i);
        before = std::max(before, from);
        gained += from - to;
      }
      if (gained <= kMovedGain * before) return;
    }
  }

  /// Drops each plane in turn, the cheapest first, and cuts off a corner instead. @return whether the volume fell
  bool exchange() {
    const std::vector<Plane> before = planes_;
    const double volume = lookWithout(planes_.size());
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < planes_.size(); ++i) order.emplace_back(lookWithout(i), i);
    std::ranges::sort(order);
    for (const auto& [without, i] : order) {
      if (cuts_ > kMostCuts) return false;
      const double found = lookWithout(i);
      std::vector<Vec3> corners;
      for (const std::vector<Vec3>& face : faces_) corners.insert(corners.end(), face.begin(), face.end());
      // Of the planes that touch the body below a corner, the one that cuts off most.
      Plane best = before[i];
      double least = found;
      for (const Vec3& corner : corners) {
        const Plane plane = touching(corner.normalized());
        const double with = volumeWith(plane);
        if (with >= least) continue;
        least = with;
        best = plane;
      }
      if (least < found) {
        planes_[i] = best;
        turnAll();
        if (lookWithout(planes_.size()) < (1.0 - kExchangeGain) * volume) return true;
      }
      planes_ = before;
    }
    return false;
  }

  [[nodiscard]] Plane touching(const Vec3& normal) const {
    Plane plane{normal, -kInfinity};
    for (const Vec3& p : body_) plane.offset = std::max(plane.offset, normal.dot(p));
    return plane;
  }

  /// Turns a plane while that lowers the volume: in eight directions, by less once none of them helps.
  /// @return the volumes before and after
  std::pair<double, double> turn(std::size_t i) {
    static constexpr double kDiagonal = 0.7071067811865476;
    static constexpr std::array<std::pair<double, double>, 8> kDirections = {{{1, 0},
                                                                              {-1, 0},
                                                                              {0, 1},
                                                                              {0, -1},
                                                                              {kDiagonal, kDiagonal},
                                                                              {-kDiagonal, -kDiagonal},
                                                                              {kDiagonal, -kDiagonal},
                                                                              {-kDiagonal, kDiagonal}}};
    (void)lookWithout(i);
    const double before = volumeWith(planes_[i]);
    double volume = before;
    for (double angle = kFirstTurn; angle >= kLastTurn;) {
      const Vec3 normal = planes_[i].normal, u = normal.unitOrthogonal(), v = normal.cross(u);
      bool better = false;
      for (const auto& [x, y] : kDirections) {
        const Plane plane = touching((normal + angle * (x * u + y * v)).normalized());
        const double found = volumeWith(plane);
        if (found >= volume) continue;
        volume = found;
        planes_[i] = plane;
        better = true;
        break;
      }
      if (!better) angle *= 0.5;
    }
    return {before, volume};
  }

  /// Finds the faces of what all half-spaces but one have in common. @return its volume
  double lookWithout(std::size_t left) {
    faces_.resize(planes_.size());
    double volume = 0.0;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      faces_[i].clear();
      if (i == left) continue;
      findFace(planes_[i], left, faces_[i]);
      volume += coneOf(planes_[i], faces_[i]);
    }
    left_ = left;
    return volume;
  }

  /// The volume of that below one more plane.
  double volumeWith(const Plane& plane) {
    findFace(plane, left_, face_);
    cuts_ += planes_.size();
    double volume = coneOf(plane, face_);
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      face_ = faces_[i];
      keepBelow(face_, plane, scratch_);
      volume += coneOf(planes_[i], face_);
    }
    return volume;
  }

  /// What all half-spaces but one leave of a plane.
  void findFace(const Plane& plane, std::size_t left, std::vector<Vec3>& face) {
    const Vec3 u = kFaceReach * plane.normal.unitOrthogonal(), v = plane.normal.cross(u),
               middle = plane.offset * plane.normal;
    face.assign({middle + u + v, middle - u + v, middle - u - v, middle + u - v});
    cuts_ += planes_.size();
    for (std::size_t j = 0; j < planes_.size() && face.size() >= 3; ++j) {
      if (j != left && &planes_[j] != &plane) keepBelow(face, planes_[j], scratch_);
    }
  }

  /// The volume between a face and the origin.
  static double coneOf(const Plane& plane, std::span<const Vec3> face) {
    Vec3 doubled = Vec3::Zero();
    for (std::size_t p = 2; p < face.size(); ++p) doubled += (face[p - 1] - face[0]).cross(face[p] - face[0]);
    return plane.offset * doubled.dot(plane.normal) / 6.0;
  }

  std::span<const Vec3> body_;
  std::vector<Plane> planes_;
  std::vector<std::vector<Vec3>> faces_;  ///< without one of the planes
  std::size_t left_ = 0;                  ///< that one
  std::size_t cuts_ = 0;                  ///< of faces by planes so far
  std::vector<Vec3> face_, scratch_;
};

/// What all half-spaces have in common. Corners that nearly coincide are one.
ConvexHull polyhedron(std::span<const Vec3> dual) {
  std::vector<Vec3> corners;
  const ConvexHull hull = convexHull(dual);
  for (const Triangle& t : hull.triangles) {
    const Vec3 corner = cornerOf(hull.vertices[t[0]], hull.vertices[t[1]], hull.vertices[t[2]]);
    if (!(corner.norm() < kNoCorner)) return {};
    const auto same = [&](const Vec3& c) { return (c - corner).norm() <= 1e3 * kSameHalfSpace; };
    if (std::ranges::none_of(corners, same)) corners.push_back(corner);
  }
  return convexHull(corners);
}

}  // namespace

int planesOf(const ConvexHull& body) {
  return countOf(dualOf(body));
}

ConvexHull fewerPlanes(const ConvexHull& body, int maxPlanes, int maxVertices, bool turned) {
  std::vector<Vec3> dual = dualOf(body);
  for (double tolerance = 1e-4; turned && dual.size() > kMostPlanes && tolerance < 0.01; tolerance *= 1.5) {
    std::vector<Vec3> outer;
    for (const VertexIndex i : convexHullOutline(dual, tolerance).points) outer.push_back(dual[i]);
    dual = std::move(outer);
  }
  Dropping dropping(std::move(dual));
  const auto few = [&](const ConvexHull& found) { return maxVertices == 0 || countOf(found.vertices) <= maxVertices; };
  ConvexHull best;
  while (best.degenerate()) {
    if (countOf(dropping.dual()) <= maxPlanes) {
      ConvexHull found = polyhedron(dropping.dual());
      if (few(found)) best = std::move(found);
    }
    if (best.degenerate() && !dropping.step()) return {};
  }
  if (!turned) return best;
  Moving moving(dropping.dual(), body.vertices);
  moving.run();
  if (ConvexHull found = polyhedron(moving.dual()); few(found) && found.volume < best.volume) best = std::move(found);
  return best;
}

}  // namespace lorica
