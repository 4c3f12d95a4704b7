#include "geometry/sheets.h"

#include "geometry/counts.h"
#include "geometry/edge_table.h"
#include "geometry/triangle_tree.h"
#include "geometry/union_find.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace lorica {
namespace {

constexpr double kFoldedFlat = 0.03;   // radians between two triangles that lie on each other
constexpr double kWeakNormals = 0.03;  // of the strongest: directions in which normals do not fix an offset
constexpr double kMaxMiter = 2.0;      // of the offset of a face

/// A triangle at an edge.
struct Wing {
  std::int32_t triangle = 0;
  double angle = 0.0;  ///< around the edge
};

std::size_t sideOf(const Triangle& t, VertexIndex a, VertexIndex b) {
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexIndex from = t[i], to = t[(i + 1) % 3];
    if ((from == a && to == b) || (from == b && to == a)) return i;
  }
  return 0;
}

VertexIndex cornerBeyond(const Triangle& t, std::size_t side) {
  return t[(side + 2) % 3];
}

/// The triangles at an edge, by their angle around it.
std::vector<Wing> wingsOf(const TriMesh& mesh, VertexIndex from, std::span<const TriangleSide> sides) {
  const Vec3& origin = mesh.vertices[from];
  const Vec3 along = (mesh.vertices[sides[0].larger] - origin).stableNormalized();
  Vec3 right = Vec3::Zero(), up = Vec3::Zero();
  std::vector<Wing> wings;
  for (const TriangleSide& side : sides) {
    const Triangle& t = mesh.triangles[side.triangle];
    Vec3 beyond = mesh.vertices[cornerBeyond(t, sideOf(t, from, side.larger))] - origin;
    beyond -= beyond.dot(along) * along;
    if (right.isZero()) {
      right = beyond.stableNormalized();
      up = along.cross(right);
    }
    wings.push_back({side.triangle, std::atan2(beyond.dot(up), beyond.dot(right))});
  }
  return wings;
}

/// How far two wings are from continuing each other, 0 to pi.
double bendOf(const Wing& a, const Wing& b) {
  const double apart = std::abs(a.angle - b.angle);
  return std::abs(std::numbers::pi - apart);
}

/// The offset of a vertex at which all faces around it are offset by 1, as far as that can be had.
Vec3 miter(const Mat3& squares, const Vec3& sum) {
  const SymmetricAxes axes = symmetricAxes(squares);
  const double strongest = axes.values[2];
  if (!(strongest > 0.0)) return Vec3::Zero();
  Vec3 offset = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    if (axes.values[i] < kWeakNormals * strongest) continue;
    const Vec3 axis = axes.vectors.col(i);
    offset += axis.dot(sum) / axes.values[i] * axis;
  }
  const double length = offset.norm();
  return length > kMaxMiter ? Vec3(kMaxMiter / length * offset) : offset;
}

}  // namespace

Sheets findSheets(const TriMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  Sheets sheets;
  sheets.triangles = mesh.triangles;
  sheets.across.assign(count, {-1, -1, -1});
  const auto pair = [&](VertexIndex a, VertexIndex b, std::int32_t first, std::int32_t second) {
    sheets.across[first][sideOf(mesh.triangles[first], a, b)] = second;
    sheets.across[second][sideOf(mesh.triangles[second], a, b)] = first;
  };
  EdgeTable(mesh.vertices.size(), mesh.triangles).forEachEdge([&](VertexIndex v, std::span<const TriangleSide> sides) {
    if (sides.size() < 2) return;
    std::vector<Wing> wings = wingsOf(mesh, v, sides);
    const auto fits = [&](const Wing& a, const Wing& b) { return bendOf(a, b) < std::numbers::pi - kFoldedFlat; };
    if (wings.size() == 2) {
      if (fits(wings[0], wings[1])) pair(v, sides[0].larger, wings[0].triangle, wings[1].triangle);
      return;
    }
    // The best continuation first. Sorted by angle, a wing is compared with those just around the opposite side.
    std::sort(wings.begin(), wings.end(), [](const Wing& a, const Wing& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.triangle < b.triangle;
    });
    struct Match {
      double bend;
      std::size_t a, b;
    };
    std::vector<Match> matches;
    for (std::size_t a = 0; a < wings.size(); ++a) {
      const double opposite = wings[a].angle + (wings[a].angle > 0.0 ? -std::numbers::pi : std::numbers::pi);
      const std::size_t at = std::lower_bound(wings.begin(), wings.end(), opposite,
                                              [](const Wing& w, double angle) { return w.angle < angle; }) -
                             wings.begin();
      for (const std::size_t near : {at + wings.size() - 2, at + wings.size() - 1, at, at + 1}) {
        const std::size_t b = near % wings.size();
        if (b != a && fits(wings[a], wings[b])) {
          matches.push_back({bendOf(wings[a], wings[b]), std::min(a, b), std::max(a, b)});
        }
      }
    }
    std::sort(matches.begin(), matches.end(), [](const Match& x, const Match& y) {
      return x.bend != y.bend ? x.bend < y.bend : x.a != y.a ? x.a < y.a : x.b < y.b;
    });
    std::vector<bool> taken(wings.size(), false);
    for (const Match& m : matches) {
      if (taken[m.a] || taken[m.b]) continue;
      taken[m.a] = taken[m.b] = true;
      pair(v, sides[0].larger, wings[m.a].triangle, wings[m.b].triangle);
    }
  });

  // Turn triangles to face as their neighbours do.
  sheets.sheetOfTriangle.assign(count, -1);
  for (std::size_t start = 0; start < count; ++start) {
    if (sheets.sheetOfTriangle[start] >= 0) continue;
    const std::int32_t number = static_cast<std::int32_t>(sheets.count++);
    sheets.sheetOfTriangle[start] = number;
    double facing = 0.0;  // area that faces as in the input, less what does not
    std::vector<std::int32_t> walk{static_cast<std::int32_t>(start)};
    for (std::size_t next = 0; next < walk.size(); ++next) {
      const std::int32_t k = walk[next];
      const double area = areaNormal(mesh.vertices, mesh.triangles[k]).norm();
      facing += sheets.triangles[k] == mesh.triangles[k] ? area : -area;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t other = sheets.across[k][i];
        if (other < 0) continue;
        const VertexIndex from = sheets.triangles[k][i], to = sheets.triangles[k][(i + 1) % 3];
        Triangle& t = sheets.triangles[other];
        const std::size_t side = sideOf(t, from, to);
        const bool agrees = t[side] == to;
        if (sheets.sheetOfTriangle[other] < 0) {
          if (!agrees) {
            std::swap(t[1], t[2]);
            std::swap(sheets.across[other][0], sheets.across[other][2]);
          }
          sheets.sheetOfTriangle[other] = number;
          walk.push_back(other);
        } else if (!agrees) {  // one-sided
          sheets.across[other][side] = sheets.across[k][i] = -1;
        }
      }
    }
    for (const std::int32_t k : walk) {
      if (facing >= 0.0) continue;
      std::swap(sheets.triangles[k][1], sheets.triangles[k][2]);
      std::swap(sheets.across[k][0], sheets.across[k][2]);
    }
  }
  return sheets;
}

TriMesh wallsAround(const TriMesh& mesh, const Sheets& sheets, const std::vector<bool>& which, double thickness) {
  const std::size_t count = sheets.triangles.size();
  // The corners of a sheet around a vertex are one corner of the wall.
  UnionFind corners(3 * count);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t other = sheets.across[k][i];
      if (other < 0) continue;
      const std::size_t side =
          sideOf(sheets.triangles[other], sheets.triangles[k][i], sheets.triangles[k][(i + 1) % 3]);
      corners.unite(3 * k + i, 3 * other + (side + 1) % 3);
      corners.unite(3 * k + (i + 1) % 3, 3 * other + side);
    }
  }
  std::vector<VertexIndex> numberOf(3 * count, -1);
  std::vector<Mat3> squares;
  std::vector<Vec3> sums;
  TriMesh walls;
  std::vector<VertexIndex> origin;
  const auto cornerOf = [&](std::size_t k, std::size_t i) -> VertexIndex& { return numberOf[corners.find(3 * k + i)]; };
  for (std::size_t k = 0; k < count; ++k) {
    if (!which[k]) continue;
    const Triangle& t = sheets.triangles[k];
    const Vec3 normal = areaNormal(mesh.vertices, t).stableNormalized();
    for (std::size_t i = 0; i < 3; ++i) {
      VertexIndex& corner = cornerOf(k, i);
      if (corner < 0) {
        corner = countOf(origin);
        origin.push_back(t[i]);
        squares.push_back(Mat3::Zero());
        sums.push_back(Vec3::Zero());
      }
      const Vec3 to = (mesh.vertices[t[(i + 1) % 3]] - mesh.vertices[t[i]]).stableNormalized();
      const Vec3 back = (mesh.vertices[t[(i + 2) % 3]] - mesh.vertices[t[i]]).stableNormalized();
      const double angle = std::atan2(to.cross(back).norm(), to.dot(back));
      squares[corner] += angle * normal * normal.transpose();
      sums[corner] += angle * normal;
    }
  }
  const VertexIndex cornerCount = countOf(origin);
  walls.vertices.resize(2 * origin.size());
  for (std::size_t c = 0; c < origin.size(); ++c) {
    const Vec3 offset = 0.5 * thickness * miter(squares[c], sums[c]);
    walls.vertices[c] = mesh.vertices[origin[c]] + offset;
    walls.vertices[c + origin.size()] = mesh.vertices[origin[c]] - offset;
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (!which[k]) continue;
    const Triangle front{cornerOf(k, 0), cornerOf(k, 1), cornerOf(k, 2)};
    walls.triangles.push_back(front);
    walls.triangles.push_back({front[0] + cornerCount, front[2] + cornerCount, front[1] + cornerCount});
    for (std::size_t i = 0; i < 3; ++i) {
      if (sheets.across[k][i] >= 0) continue;
      const VertexIndex a = front[i], b = front[(i + 1) % 3];
      walls.triangles.push_back({b, a, a + cornerCount});
      walls.triangles.push_back({b, a + cornerCount, b + cornerCount});
    }
  }
  return walls;
}

double narrowestGap(const TriMesh& mesh, const std::vector<bool>& which, double upTo) {
  constexpr double kSpacing = 2.0;  // of upTo: samples of a large triangle
  constexpr int kMaxRows = 64;      // of samples in a triangle
  constexpr std::size_t kMaxSamples = 200000;
  constexpr double kOpposite = -0.97;  // cosine between the sides of a gap, as seen from its middle
  constexpr double kIgnored = 0.01;    // of the area: near the edge where two sides meet there is no gap
  constexpr int kMaxSteps = 16;
  struct Sample {
    Vec3 at, normal;
    double area;
    std::int32_t triangle;
  };
  const auto forEachTriangle = [&](auto&& visit) {
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const Triangle& t = mesh.triangles[k];
      const Vec3 normal = areaNormal(mesh.vertices, t).stableNormalized();
      if (!which[k] || normal.isZero()) continue;
      const std::array<Vec3, 3> p{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
      const double longest = std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()});
      const int rows = std::clamp(static_cast<int>(std::ceil(longest / (kSpacing * upTo))), 1, kMaxRows);
      visit(k, p, normal, rows);
    }
  };
  std::size_t all = 0;
  double area = 0.0;
  forEachTriangle([&](std::size_t k, const auto&, const Vec3&, int rows) {
    all += rows * (rows + 1) / 2;
    area += 0.5 * areaNormal(mesh.vertices, mesh.triangles[k]).norm();
  });
  if (all == 0) return upTo;
  const std::size_t stride = (all + kMaxSamples - 1) / kMaxSamples;
  std::vector<Sample> samples;
  samples.reserve(all / stride + 1);
  int left = 0;  // samples before the next one that is taken, from the start of a row
  forEachTriangle([&](std::size_t k, const std::array<Vec3, 3>& p, const Vec3& normal, int rows) {
    const double share = areaNormal(mesh.vertices, mesh.triangles[k]).norm() / (rows * (rows + 1));
    for (int i = 0; i < rows; ++i) {
      for (; left < rows - i; left += static_cast<int>(stride)) {
        const double a = (i + 1.0 / 3.0) / rows, b = (left + 1.0 / 3.0) / rows;
        samples.push_back({p[0] + a * (p[1] - p[0]) + b * (p[2] - p[0]), normal, share, static_cast<std::int32_t>(k)});
      }
      left -= rows - i;
    }
  });
  const auto adjacent = [&](std::int32_t a, std::int32_t b) {
    return std::ranges::any_of(mesh.triangles[a], [&](VertexIndex v) {
      return std::ranges::find(mesh.triangles[b], v) != mesh.triangles[b].end();
    });
  };
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  std::vector<double> gaps(2 * samples.size(), upTo);
  for (std::size_t s = 0; s < gaps.size(); ++s) {
    const Sample& sample = samples[s / 2];
    const Vec3 normal = s % 2 == 0 ? sample.normal : Vec3(-sample.normal);
    // Shrink a ball that touches the sample until nothing else is in it.
    double radius = 0.5 * upTo;
    for (int step = 0; step < kMaxSteps; ++step) {
      const Vec3 center = sample.at + radius * normal;
      const TriangleTree::Hit hit = tree.nearest(center);
      if (hit.distance >= 0.999 * radius) break;  // nothing else is in it
      const std::array<Vec3, 3>& c = tree.corners(hit);
      const Vec3 touched = hit.shares[0] * c[0] + hit.shares[1] * c[1] + hit.shares[2] * c[2];
      const Vec3 apart = touched - sample.at;
      const double ahead = apart.dot(normal);
      if (!(ahead > 1e-9 * upTo)) break;
      radius = std::min(0.999 * radius, 0.5 * apart.squaredNorm() / ahead);
      const Vec3 middle = sample.at + radius * normal;
      const double cosine = -normal.dot((touched - middle).stableNormalized());
      if (cosine <= kOpposite && !adjacent(sample.triangle, hit.triangle)) gaps[s] = std::min(gaps[s], 2.0 * radius);
    }
  }
  std::vector<std::size_t> order(gaps.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return gaps[a] < gaps[b]; });
  double passed = 0.0;
  for (const std::size_t s : order) {
    passed += 0.5 * samples[s / 2].area;
    if (passed > kIgnored * area) return gaps[s];
  }
  return upTo;
}

namespace {

/// Cells of a cube around a surface.
class CellGrid {
 public:
  static constexpr int kCells = 64;  // along each side, with two to spare around the surface
  enum State : std::uint8_t { kUnknown, kBlocked, kReached };

  explicit CellGrid(const TriMesh& mesh) : state_(std::size_t{kCells} * kCells * kCells, kUnknown) {
    for (int size = 1; size <= kCells; size *= 2) {
      const std::size_t across = kCells / size;
      full_.emplace_back(across * across * across, false);
    }
    const Aabb box = surfaceBounds(mesh);
    edge_ = (box.max - box.min).maxCoeff() / (kCells - 4);
    origin_ = box.center() - 0.5 * kCells * edge_ * Vec3::Ones();
    for (const Triangle& t : mesh.triangles) {
      (void)block({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, {0, 0, 0}, kCells);
    }
    flood();
  }

  [[nodiscard]] double edge() const { return edge_; }
  [[nodiscard]] State at(const Vec3& p) const {
    const Vec3 cell = ((p - origin_) / edge_).array().floor();
    if ((cell.array() < 0.0).any() || (cell.array() >= kCells).any()) return kReached;
    return State(state_[index(cell.cast<int>())]);
  }
  [[nodiscard]] bool sealsSomething() const { return std::ranges::find(state_, kUnknown) != state_.end(); }

 private:
  using Cell = Eigen::Vector3i;
  [[nodiscard]] static std::size_t index(const Cell& c) {
    return (static_cast<std::size_t>(c.x()) * kCells + c.y()) * kCells + c.z();
  }

  /// Blocks the cells whose circumscribed balls a triangle touches. @return whether all of these cells are blocked
  bool block(const std::array<Vec3, 3>& t, const Cell& from, int size) {
    if (size == 1 && state_[index(from)] == kBlocked) return true;
    std::vector<bool>& full = full_[std::countr_zero(static_cast<unsigned>(size))];
    const int across = kCells / size;
    const std::size_t node =
        (static_cast<std::size_t>(from.x() / size) * across + from.y() / size) * across + from.z() / size;
    if (full[node]) return true;
    const Vec3 center = origin_ + edge_ * (from.cast<double>() + Vec3::Constant(0.5 * size));
    const double radius = 0.5 * std::numbers::sqrt3 * size * edge_;
    if (nearestOnTriangle(center, t).first > radius * radius) return false;
    if (size == 1) {
      state_[index(from)] = kBlocked;
      return full[node] = true;
    }
    const int half = size / 2;
    bool all = true;
    for (int i = 0; i < 8; ++i) all = block(t, from + half * Cell(i & 1, (i >> 1) & 1, i >> 2), half) && all;
    full[node] = all;
    return all;
  }

  void flood() {
    std::vector<Cell> walk{Cell::Zero()};
    state_[0] = kReached;
    while (!walk.empty()) {
      const Cell at = walk.back();
      walk.pop_back();
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          Cell to = at;
          to[axis] += step;
          if (to[axis] < 0 || to[axis] >= kCells || state_[index(to)] != kUnknown) continue;
          state_[index(to)] = kReached;
          walk.push_back(to);
        }
      }
    }
  }

  std::vector<std::uint8_t> state_;
  std::vector<std::vector<bool>> full_;  // for cubes of 1, 2, 4 ... cells: all are blocked
  double edge_ = 0.0;
  Vec3 origin_ = Vec3::Zero();
};

}  // namespace

std::vector<bool> aroundSealedSpace(const TriMesh& mesh) {
  std::vector<bool> sealed(mesh.triangles.size(), false);
  const CellGrid grid(mesh);
  if (!grid.sealsSomething()) return sealed;
  for (std::size_t k = 0; k < sealed.size(); ++k) {
    const Triangle& t = mesh.triangles[k];
    const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    const Vec3 normal = areaNormal(mesh.vertices, t).stableNormalized();
    for (const double side : {1.0, -1.0}) {
      for (int step = 1; step <= 6; ++step) {
        const CellGrid::State state = grid.at(middle + side * 0.5 * step * grid.edge() * normal);
        if (state == CellGrid::kBlocked) continue;
        sealed[k] = sealed[k] || state == CellGrid::kUnknown;
        break;
      }
    }
  }
  return sealed;
}

}  // namespace lorica
