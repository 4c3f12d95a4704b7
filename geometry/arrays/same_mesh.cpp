#include "geometry/arrays/same_mesh.h"

#include "geometry/counts.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

namespace lorica {
namespace {

constexpr VertexIndex kNone = -1;

/// The third corner of the triangle at the left of each directed edge.
class Corners {
 public:
  explicit Corners(std::span<const Triangle> triangles, std::size_t vertexCount) : degrees_(vertexCount, 0) {
    third_.reserve(3 * triangles.size());
    for (const Triangle& t : triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        manifold_ = third_.emplace(key(t[i], t[(i + 1) % 3]), t[(i + 2) % 3]).second && manifold_;
        ++degrees_[t[i]];
      }
    }
  }
  /// Whether no two triangles are at the left of one edge.
  [[nodiscard]] bool manifold() const { return manifold_; }
  [[nodiscard]] VertexIndex left(VertexIndex from, VertexIndex to) const {
    const auto found = third_.find(key(from, to));
    return found == third_.end() ? kNone : found->second;
  }
  /// How many triangles each corner has.
  [[nodiscard]] std::array<int, 3> degrees(const Triangle& t) const {
    return {degrees_[t[0]], degrees_[t[1]], degrees_[t[2]]};
  }

 private:
  static std::uint64_t key(VertexIndex from, VertexIndex to) {
    return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
  }
  std::unordered_map<std::uint64_t, VertexIndex> third_;
  std::vector<int> degrees_;
  bool manifold_ = true;
};

/// Which point is which, as far as that is known.
struct Pairs {
  std::vector<VertexIndex> there, back;  // of the first mesh in the other, and the reverse
  std::vector<VertexIndex> made;         // of the first mesh, in order

  /// @return whether that agrees with what is known
  bool join(VertexIndex a, VertexIndex b) {
    if (there[a] == b && back[b] == a) return true;
    if (there[a] != kNone || back[b] != kNone) return false;
    there[a] = b;
    back[b] = a;
    made.push_back(a);
    return true;
  }
  void undo(std::size_t count) {
    for (; made.size() > count; made.pop_back()) {
      back[there[made.back()]] = kNone;
      there[made.back()] = kNone;
    }
  }
};

/// Follows the edges from a triangle of which it is known which it is in the other mesh.
bool follow(const Corners& mesh, const Corners& other, const Triangle& from, const Triangle& to, Pairs& pairs,
            std::size_t& steps) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!pairs.join(from[i], to[i])) return false;
  }
  std::vector<Triangle> open = {from};
  while (!open.empty()) {
    const Triangle t = open.back();
    open.pop_back();
    for (std::size_t i = 0; i < 3; ++i) {
      if (steps-- == 0) return false;
      const VertexIndex a = t[(i + 1) % 3], b = t[i];
      const VertexIndex c = mesh.left(a, b), found = other.left(pairs.there[a], pairs.there[b]);
      if ((c == kNone) != (found == kNone)) return false;
      if (c == kNone) continue;
      const bool known = pairs.there[c] != kNone;
      if (!pairs.join(c, found)) return false;
      if (!known) open.push_back({a, b, c});
    }
  }
  return true;
}

/// Where the triangles are in the same order, and only the points are not.
bool joinInOrder(std::span<const Triangle> wanted, std::span<const Triangle> other, Pairs& pairs) {
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!pairs.join(wanted[i][c], other[i][c])) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<std::vector<VertexIndex>> sameMesh(std::span<const Triangle> wanted, std::span<const Vec3> near,
                                                 const TriMesh& other) {
  const std::size_t points = near.size();
  if (other.vertices.size() != points || other.triangles.size() != wanted.size()) return std::nullopt;
  Pairs pairs{std::vector<VertexIndex>(points, kNone), std::vector<VertexIndex>(points, kNone), {}};
  if (!joinInOrder(wanted, other.triangles, pairs)) {
    pairs.undo(0);
    const Corners first(wanted, points), second(other.triangles, points);
    if (!first.manifold() || !second.manifold()) return std::nullopt;
    std::size_t steps = kMaxUnionSteps;
    std::map<std::array<int, 3>, std::vector<Triangle>> alike;  // triangles of the other, however they are turned
    for (const Triangle& t : other.triangles) {
      for (const Triangle& turn : {t, Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[0], t[1]}}) {
        alike[second.degrees(turn)].push_back(turn);
      }
    }
    // The rarest triangle of each piece is tried first: fewest others look like it.
    const Components pieces = connectedComponents(points, wanted);
    std::vector<const Triangle*> seeds(pieces.count, nullptr);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Triangle*& seed = seeds[pieces.componentOfTriangle[i]];
      const auto count = [&](const Triangle& t) { return alike[first.degrees(t)].size(); };
      if (seed == nullptr || count(wanted[i]) < count(*seed)) seed = &wanted[i];
    }
    for (const Triangle* seed : seeds) {
      std::vector<std::pair<double, Triangle>> candidates;
      for (const Triangle& t : alike[first.degrees(*seed)]) {
        if (pairs.back[t[0]] != kNone) continue;
        double apart = 0.0;
        for (std::size_t c = 0; c < 3; ++c) apart += (near[(*seed)[c]] - other.vertices[t[c]]).squaredNorm();
        candidates.emplace_back(apart, t);
      }
      std::ranges::sort(candidates);
      const std::size_t known = pairs.made.size();
      const bool found = std::ranges::any_of(candidates, [&](const auto& candidate) {
        if (follow(first, second, *seed, candidate.second, pairs, steps)) return true;
        pairs.undo(known);
        return false;
      });
      if (!found) return std::nullopt;
    }
  }
  // Points without triangles keep their order.
  auto free = std::ranges::find(pairs.back, kNone);
  for (VertexIndex& there : pairs.there) {
    if (there != kNone) continue;
    there = static_cast<VertexIndex>(free - pairs.back.begin());
    free = std::find(free + 1, pairs.back.end(), kNone);
  }
  return std::move(pairs.there);
}

}  // namespace lorica
