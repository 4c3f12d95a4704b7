#include "acd/cap.h"

#include "geometry/counts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace lorica {
namespace {

using Loop = std::vector<int>;

// Corners that may be looked at, besides so many for each of the border. Caps of real meshes need up to 80 for each.
// Beyond, any corner is clipped and any edge followed: the cap is closed, but its triangles may overlap.
constexpr std::int64_t kMostLooked = 100'000'000, kMostLookedEach = 500;
constexpr std::int64_t kAnAngle = 10;  // is as much work as so many corners

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Twice the signed area of a, b, c; positive when counter-clockwise.
double orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(b - a, c - a);
}

/// Corners of a ring in the cells of a grid, to find the corners in a small box without testing all.
class CornerGrid {
 public:
  explicit CornerGrid(std::span<const Vec2> corners) : cellOf_(corners.size()) {
    low_ = high_ = corners[0];
    for (const Vec2& p : corners) {
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
    side_ = std::max(1, static_cast<int>(std::sqrt(corners.size())));
    begin_.assign(side_ * side_ + 1, 0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      cellOf_[i] = cell(corners[i], 1) * side_ + cell(corners[i], 0);
      ++begin_[cellOf_[i] + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    end_.assign(begin_.begin(), begin_.end() - 1);
    corners_.resize(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) corners_[end_[cellOf_[i]]++] = i;
  }

  /// @param looked  grows by the corners that were looked at
  void remove(int corner, std::int64_t& looked) {
    std::size_t& end = end_[cellOf_[corner]];
    const auto first = corners_.begin() + begin_[cellOf_[corner]];
    const auto found = std::find(first, corners_.end(), corner);
    looked += found - first;
    std::iter_swap(found, corners_.begin() + --end);
  }

  /// Whether the predicate holds for any corner in the cells that overlap the box. Tests all corners in the box, and
  /// some near it. @param looked  grows by the corners and cells that were looked at
  template <typename Predicate>
  [[nodiscard]] bool anyNear(const Vec2& low, const Vec2& high, std::int64_t& looked, Predicate&& holds) const {
    const int right = cell(high, 0);
    const int top = cell(high, 1);
    for (int y = cell(low, 1); y <= top; ++y) {
      for (int x = cell(low, 0); x <= right; ++x) {
        const std::size_t c = y * side_ + x;
        looked += 1 + static_cast<std::int64_t>(end_[c] - begin_[c]);
        for (std::size_t i = begin_[c]; i < end_[c]; ++i) {
          if (holds(corners_[i])) return true;
        }
      }
    }
    return false;
  }

 private:
  [[nodiscard]] int cell(const Vec2& p, int axis) const {
    const double extent = high_[axis] - low_[axis];
    if (!(extent > 0.0)) return 0;
    return std::clamp(static_cast<int>((p[axis] - low_[axis]) / extent * side_), 0, side_ - 1);
  }

  Vec2 low_, high_;
  int side_ = 1;
  std::vector<std::size_t> cellOf_;  // of each corner
  std::vector<std::size_t> begin_;   // start of each cell in corners_
  std::vector<std::size_t> end_;     // end of each cell's remaining corners
  std::vector<int> corners_;
};

class CapTriangulator {
 public:
  CapTriangulator(std::span<const Vec2> vertices, std::span<const CapEdge> edges)
      : vertices_(vertices), most_(kMostLooked + kMostLookedEach * std::ssize(edges)) {
    traceLoops(edges);
  }

  std::vector<Triangle> run() {
    // Counter-clockwise loops bound a region; clockwise loops are holes in the smallest region that contains them.
    std::vector<double> area(loops_.size());
    for (std::size_t i = 0; i < loops_.size(); ++i) area[i] = signedArea(loops_[i]);
    std::vector<std::vector<std::size_t>> holesOf(loops_.size());
    std::vector<bool> isHole(loops_.size(), false);
    for (std::size_t h = 0; h < loops_.size(); ++h) {
      if (area[h] >= 0.0) continue;
      std::size_t best = loops_.size();
      for (std::size_t o = 0; o < loops_.size() && looked_ < most_; ++o) {
        ++looked_;
        if (area[o] <= -area[h] || !contains(loops_[o], loops_[h])) continue;
        if (best == loops_.size() || area[o] < area[best]) best = o;
      }
      if (best == loops_.size()) continue;  // clockwise loop in no region (crossing loops): filled
      isHole[h] = true;
      holesOf[best].push_back(h);
    }
    for (std::size_t o = 0; o < loops_.size(); ++o) {
      if (isHole[o]) continue;
      if (area[o] < 0.0) {
        // Clip the reversed loop, then flip the triangles.
        const std::size_t first = triangles_.size();
        clipEars(Loop(loops_[o].rbegin(), loops_[o].rend()));
        for (std::size_t t = first; t < triangles_.size(); ++t) std::swap(triangles_[t][1], triangles_[t][2]);
      } else {
        clipEars(withHoles(loops_[o], holesOf[o]));
      }
    }
    return std::move(triangles_);
  }

 private:
  [[nodiscard]] const Vec2& at(int v) const { return vertices_[v]; }

  // If several edges leave a vertex, take the first one clockwise from the incoming edge, which keeps the region on the
  // left: regions that touch at a vertex are separated there, and a hole that touches the border of its region becomes
  // part of the same loop.
  void traceLoops(std::span<const CapEdge> edges) {
    std::vector<int> order(edges.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return edges[a] < edges[b]; });
    std::vector<int> firstFrom(vertices_.size() + 1, 0);
    for (const CapEdge& e : edges) ++firstFrom[e[0] + 1];
    std::partial_sum(firstFrom.begin(), firstFrom.end(), firstFrom.begin());
    std::vector<int> firstFree = firstFrom;  // of each vertex: all edges before it are used
    std::vector<bool> used(edges.size(), false);
    for (int start : order) {
      if (used[start]) continue;
      Loop loop;
      int edge = start;
      while (!used[edge]) {
        used[edge] = true;
        const int from = edges[edge][0];
        const int here = edges[edge][1];
        loop.push_back(from);
        const auto turnTo = [&](int candidate) {
          looked_ += kAnAngle;
          return clockwiseTurn(at(from) - at(here), at(edges[candidate][1]) - at(here));
        };
        int next = edges[start][0] == here ? start : -1;
        double smallest = next < 0 ? 0.0 : turnTo(next);
        int& first = firstFree[here];
        while (first < firstFrom[here + 1] && used[order[first]]) ++first;
        for (int i = first; i < firstFrom[here + 1] && (next < 0 || looked_ < most_); ++i) {
          ++looked_;
          if (used[order[i]]) continue;
          const double turn = turnTo(order[i]);
          if (next < 0 || turn < smallest) {
            next = order[i];
            smallest = turn;
          }
        }
        if (next < 0) break;
        edge = next;
      }
      if (loop.size() >= 3) loops_.push_back(std::move(loop));
    }
  }

  /// Rises with the angle, from 0 to 4: no function of a C library, whose last bit differs from system to system.
  static double clockwiseTurn(const Vec2& from, const Vec2& to) {
    const double x = from.dot(to), y = -cross(from, to), size = std::abs(x) + std::abs(y);
    if (size == 0.0) return 4.0;
    if (x < 0.0) return 2.0 - y / size;
    return y > 0.0 ? y / size : 4.0 + y / size;
  }

  [[nodiscard]] double signedArea(const Loop& loop) const {
    double sum = 0.0;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += orientation(at(loop[0]), at(loop[i]), at(loop[i + 1]));
    return 0.5 * sum;
  }

  // Whether the inner loop is inside the outer one: tests the first inner vertex that is not an outer vertex.
  [[nodiscard]] bool contains(const Loop& outer, const Loop& inner) {
    for (int v : inner) {
      looked_ += std::ssize(outer);
      if (std::find(outer.begin(), outer.end(), v) != outer.end()) continue;
      const Vec2& p = at(v);
      bool inside = false;
      for (std::size_t i = 0, j = outer.size() - 1; i < outer.size(); j = i++) {
        const Vec2& a = at(outer[i]);
        const Vec2& b = at(outer[j]);
        if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
          inside = !inside;
        }
      }
      return inside;
    }
    return true;
  }

  // Joins holes to their region by bridges traversed in both directions, in order of decreasing maximum x (Held 2001).
  Loop withHoles(Loop ring, const std::vector<std::size_t>& holes) {
    struct Hole {
      const Loop* loop;
      std::size_t rightmost;
    };
    std::vector<Hole> sorted;
    for (std::size_t h : holes) {
      const Loop& loop = loops_[h];
      std::size_t best = 0;
      for (std::size_t i = 1; i < loop.size(); ++i) {
        if (at(loop[i]).x() > at(loop[best]).x()) best = i;
      }
      sorted.push_back({&loop, best});
    }
    std::stable_sort(sorted.begin(), sorted.end(), [&](const Hole& a, const Hole& b) {
      return at((*a.loop)[a.rightmost]).x() > at((*b.loop)[b.rightmost]).x();
    });
    for (const Hole& hole : sorted) {
      looked_ += std::ssize(ring);
      const std::size_t bridge =
          looked_ < most_ ? visibleFrom(ring, at((*hole.loop)[hole.rightmost])) : ring.size() - 1;
      Loop joined(ring.begin(), ring.begin() + bridge + 1);
      for (std::size_t i = 0; i <= hole.loop->size(); ++i) {
        joined.push_back((*hole.loop)[(hole.rightmost + i) % hole.loop->size()]);
      }
      joined.insert(joined.end(), ring.begin() + bridge, ring.end());
      ring = std::move(joined);
    }
    return ring;
  }

  // Finds the ring vertex for a bridge from p: follow the ray from p to the right to the nearest ring edge. The right
  // end of that edge is visible from p unless reflex vertices are in between; then the one closest in angle is visible.
  [[nodiscard]] std::size_t visibleFrom(const Loop& ring, const Vec2& p) const {
    double nearestX = std::numeric_limits<double>::infinity();
    std::size_t candidate = ring.size();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const std::size_t j = (i + 1) % ring.size();
      const Vec2& a = at(ring[i]);
      const Vec2& b = at(ring[j]);
      if ((a.y() > p.y()) == (b.y() > p.y()) && a.y() != p.y() && b.y() != p.y()) continue;
      if (std::min(a.y(), b.y()) > p.y() || std::max(a.y(), b.y()) < p.y()) continue;
      const double x =
          a.y() == b.y() ? std::max(a.x(), b.x()) : a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (x < p.x() || x >= nearestX) continue;
      nearestX = x;
      candidate = a.x() > b.x() ? i : j;
    }
    if (candidate == ring.size()) return nearestVertex(ring, p);
    const Vec2 hit(nearestX, p.y());
    const Vec2& end = at(ring[candidate]);
    const auto slopeTo = [&](const Vec2& q) { return std::abs(q.y() - p.y()) / std::max(q.x() - p.x(), 1e-300); };
    std::size_t best = candidate;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2& q = at(ring[i]);
      if (q == end || q.x() < p.x() || !inTriangle(p, hit, end, q)) continue;
      const Vec2& sofar = at(ring[best]);
      const double slope = slopeTo(q);
      const double bestSlope = slopeTo(sofar);
      if (slope < bestSlope || (slope == bestSlope && (q - p).squaredNorm() < (sofar - p).squaredNorm())) best = i;
    }
    return facing(ring, best, p);
  }

  // Bridges make a vertex occur more than once in a ring: returns the occurrence whose corner faces p.
  [[nodiscard]] std::size_t facing(const Loop& ring, std::size_t chosen, const Vec2& p) const {
    const Vec2& here = at(ring[chosen]);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (at(ring[i]) != here) continue;
      const Vec2 toPrevious = at(ring[(i + ring.size() - 1) % ring.size()]) - here;
      const Vec2 toNext = at(ring[(i + 1) % ring.size()]) - here;
      if (clockwiseTurn(toPrevious, p - here) < clockwiseTurn(toPrevious, toNext)) return i;
    }
    return chosen;
  }

  [[nodiscard]] std::size_t nearestVertex(const Loop& ring, const Vec2& p) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < ring.size(); ++i) {
      if ((at(ring[i]) - p).squaredNorm() < (at(ring[best]) - p).squaredNorm()) best = i;
    }
    return best;
  }

  static bool inTriangle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
    const double d0 = orientation(a, b, p);
    const double d1 = orientation(b, c, p);
    const double d2 = orientation(c, a, p);
    return (d0 >= 0.0 && d1 >= 0.0 && d2 >= 0.0) || (d0 <= 0.0 && d1 <= 0.0 && d2 <= 0.0);
  }

  // Ear clipping. If no true ear is left (crossing or degenerate loops), clips any convex corner, then any corner.
  void clipEars(const Loop& ring) {
    const int count = countOf(ring);
    if (count < 3) return;
    std::vector<int> previous(count), next(count);
    for (int i = 0; i < count; ++i) {
      previous[i] = (i + count - 1) % count;
      next[i] = (i + 1) % count;
    }
    const auto corner = [&](int i) { return orientation(at(ring[previous[i]]), at(ring[i]), at(ring[next[i]])); };
    std::vector<bool> reflex(count);
    for (int i = 0; i < count; ++i) reflex[i] = corner(i) <= 0.0;
    std::vector<Vec2> corners;
    corners.reserve(ring.size());
    for (int v : ring) corners.push_back(at(v));
    CornerGrid grid(corners);

    const auto isEar = [&](int i) {
      if (reflex[i]) return false;
      const Vec2& a = at(ring[previous[i]]);
      const Vec2& b = at(ring[i]);
      const Vec2& c = at(ring[next[i]]);
      const Vec2 low = a.cwiseMin(b).cwiseMin(c);
      const Vec2 high = a.cwiseMax(b).cwiseMax(c);
      return !grid.anyNear(low, high, looked_, [&](int j) {
        if (!reflex[j]) return false;
        const Vec2& p = at(ring[j]);
        if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) return false;
        return p != a && p != b && p != c && inTriangle(a, b, c, p);
      });
    };

    int remaining = count;
    int current = 0;
    int sinceLastEar = 0;
    int leniency = 0;  // 0 true ears, 1 convex corners, 2 any corner
    while (remaining > 3) {
      const bool take = looked_ >= most_ || (leniency == 0 ? isEar(current) : leniency == 1 ? !reflex[current] : true);
      ++looked_;
      if (!take) {
        current = next[current];
        if (++sinceLastEar > remaining) {
          ++leniency;
          sinceLastEar = 0;
        }
        continue;
      }
      emit(ring[previous[current]], ring[current], ring[next[current]]);
      const int before = previous[current];
      const int after = next[current];
      if (looked_ < most_) grid.remove(current, looked_);
      next[before] = after;
      previous[after] = before;
      reflex[before] = corner(before) <= 0.0;
      reflex[after] = corner(after) <= 0.0;
      --remaining;
      sinceLastEar = 0;
      leniency = 0;
      current = next[after];  // skip one corner, to avoid a fan around a single corner
    }
    emit(ring[previous[current]], ring[current], ring[next[current]]);
  }

  // Both ends of a bridge occur twice in a ring; a triangle with a repeated corner has no area and its sides cancel.
  void emit(int a, int b, int c) {
    if (a != b && b != c && c != a) triangles_.push_back({a, b, c});
  }

  std::span<const Vec2> vertices_;
  std::int64_t most_, looked_ = 0;  ///< corners that may be looked at, and were
  std::vector<Loop> loops_;
  std::vector<Triangle> triangles_;
};

}  // namespace

std::vector<Triangle> triangulateCap(std::span<const Vec2> vertices, std::span<const CapEdge> edges) {
  return CapTriangulator(vertices, edges).run();
}

}  // namespace lorica
