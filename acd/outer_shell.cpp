#include "acd/outer_shell.h"

#include "geometry/counts.h"

#include <algorithm>

namespace lorica {

namespace {

constexpr double kReach = 100.0;    // limit of each coordinate of a vertex
constexpr double kOnEdge = 1e-8;    // body points closer to an edge than this do not constrain planes through it
constexpr double kSlack = 1e-7;     // allowed concavity of an edge: coplanar faces are common, but not exactly coplanar
constexpr double kSliver = 1e-6;    // height below which a triangle's plane is unreliable
constexpr int kSliverDepth = 3;     // how many consecutive slivers are skipped
constexpr double kSameCost = 1e-9;  // cost tolerance of candidates that are evaluated again

bool costsMore(const auto& x, const auto& y) {
  if (x.cost != y.cost) return x.cost > y.cost;
  return x.a != y.a ? x.a > y.a : x.b > y.b;
}

}  // namespace

OuterShell::OuterShell(const ConvexHull& start, std::span<const Vec3> body, const Vec3& center)
    : body_(body), center_(center), at_(start.vertices), ring_(at_.size()), changes_(at_.size()), count_(countOf(at_)) {
  // In the ring of v, a triangle (v, p, q) means that q follows p.
  std::vector<std::vector<std::array<Vertex, 2>>> follows(at_.size());
  for (const Triangle& t : start.triangles) {
    for (int i = 0; i < 3; ++i) follows[t[i]].push_back({t[(i + 1) % 3], t[(i + 2) % 3]});
  }
  for (std::size_t v = 0; v < at_.size(); ++v) {
    Vertex p = follows[v].front()[0];
    for (std::size_t i = 0; i < follows[v].size(); ++i) {
      ring_[v].push_back({p, false, {}});
      p = (*std::find_if(follows[v].begin(), follows[v].end(), [p](const auto& f) { return f[0] == p; }))[1];
    }
  }
}

std::size_t OuterShell::slot(Vertex from, Vertex to) const {
  const std::vector<Spoke>& ring = ring_[from];
  std::size_t i = 0;
  while (i < ring.size() && ring[i].to != to) ++i;
  LORICA_CHECK(i < ring.size(), "neighbourhood of shell vertices must be symmetric");
  return i;
}

OuterShell::Vertex OuterShell::next(Vertex from, Vertex to) const {
  return ring_[from][(slot(from, to) + 1) % ring_[from].size()].to;
}

const HalfSpace& OuterShell::tangent(Vertex from, Vertex to) {
  Spoke& spoke = ring_[from][slot(from, to)];
  if (spoke.known) return spoke.beyond;
  spoke.known = true;
  // Seen along the edge, the body spans an angle of less than 180 degrees that contains the center. The plane that
  // touches the body on its left side has the largest angle from the center.
  const Vec3& a = at_[from];
  const Vec3 along = (at_[to] - a).normalized();
  const Vec3 inward = (center_ - a - along * along.dot(center_ - a)).normalized();
  const Vec3 left = along.cross(inward);
  double touchInward = 1.0;
  double touchLeft = 0.0;
  for (const Vec3& p : body_) {
    const double pInward = inward.dot(p - a);
    const double pLeft = left.dot(p - a);
    if (pLeft <= 0.0 || touchInward * pLeft - touchLeft * pInward <= 0.0) continue;
    if (pInward * pInward + pLeft * pLeft <= kOnEdge * kOnEdge) continue;
    touchInward = pInward;
    touchLeft = pLeft;
  }
  const Vec3 normal = (touchInward * left - touchLeft * inward).normalized();
  spoke.beyond = {normal, normal.dot(a)};
  return spoke.beyond;
}

double OuterShell::fanVolume(std::span<const Vertex> link, const Vec3& apex) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < link.size(); ++i) {
    const Vec3& p = at_[link[i]];
    const Vec3& q = at_[link[(i + 1) % link.size()]];
    sum += (apex - center_).dot((p - center_).cross(q - center_));
  }
  return sum / 6.0;
}

bool OuterShell::restrict(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 normal = (q - p).cross(r - p);
  const double length = normal.norm();
  if (length <= kSliver * std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()})) return false;
  halfSpaces_.push_back({normal / length, normal.dot(p) / length - kSlack});
  return true;
}

bool OuterShell::keepBelowFace(Vertex a, Vertex b, int depth) {
  const Vertex c = next(a, b);
  if (restrict(at_[b], at_[a], at_[c])) return true;
  // The plane of a sliver is unreliable: the faces behind it bound the same region.
  return depth > 0 && keepBelowFace(c, b, depth - 1) && keepBelowFace(a, c, depth - 1);
}

std::optional<Vec3> OuterShell::bestApex(std::span<const Vertex> link) {
  halfSpaces_.clear();
  Vec3 area = Vec3::Zero();
  const std::size_t n = link.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vertex a = link[i];
    const Vertex b = link[(i + 1) % n];
    const Vertex c = link[(i + 2) % n];
    if ((at_[b] - at_[a]).squaredNorm() <= kSliver * kSliver) return {};
    area += (at_[a] - center_).cross(at_[b] - center_);
    // The new face must keep the body inside; the edge of the link and the new edge to b must be convex.
    halfSpaces_.push_back(tangent(a, b));
    if (!keepBelowFace(b, a, kSliverDepth)) return {};
    restrict(at_[a], at_[b], at_[c]);
  }
  const std::optional<Vec3> apex = minimizeLinear(area, halfSpaces_, kReach);
  if (!apex) return {};
  // Reject the apex if, due to rounding, a face is on the wrong side of the center.
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = at_[link[i]];
    const Vec3& q = at_[link[(i + 1) % n]];
    if ((*apex - center_).dot((p - center_).cross(q - center_)) < 0.0) return {};
  }
  return apex;
}

std::vector<OuterShell::Vertex> OuterShell::linkOfVertex(Vertex v) const {
  std::vector<Vertex> link;
  link.reserve(ring_[v].size());
  for (const Spoke& s : ring_[v]) link.push_back(s.to);
  return link;
}

std::vector<OuterShell::Vertex> OuterShell::linkOfEdge(Vertex a, Vertex b) const {
  std::vector<Vertex> link;
  const std::vector<Spoke>& ra = ring_[a];
  const std::vector<Spoke>& rb = ring_[b];
  const std::size_t ia = slot(a, b);
  const std::size_t ib = slot(b, a);
  link.reserve(ra.size() + rb.size() - 4);
  // a's neighbours without b; then b's without a and the two common ones.
  for (std::size_t i = 1; i < ra.size(); ++i) link.push_back(ra[(ia + i) % ra.size()].to);
  for (std::size_t i = 2; i + 1 < rb.size(); ++i) link.push_back(rb[(ib + i) % rb.size()].to);
  return link;
}

std::optional<OuterShell::Placement> OuterShell::placementFor(Vertex a, Vertex b) {
  const std::vector<Vertex> link = linkOfEdge(a, b);
  // With more than two common neighbours the surface would become non-manifold.
  for (std::size_t i = 0; i < link.size(); ++i) {
    if (std::find(link.begin() + i + 1, link.end(), link[i]) != link.end()) return {};
  }
  if (link.size() < 3) return {};
  const std::optional<Vec3> apex = bestApex(link);
  if (!apex) return {};
  // Current volume of both stars: that of a, and that of b without the two shared triangles.
  const double before = fanVolume(linkOfVertex(a), at_[a]) + fanVolume(linkOfVertex(b), at_[b]);
  const Vertex c = next(a, b);
  const Vertex d = next(b, a);
  const auto cone = [this](Vertex p, Vertex q, Vertex r) {
    return (at_[p] - center_).dot((at_[q] - center_).cross(at_[r] - center_)) / 6.0;
  };
  const double shared = cone(a, b, c) + cone(b, a, d);
  return Placement{*apex, fanVolume(link, *apex) - (before - shared)};
}

void OuterShell::propose(Vertex a, Vertex b) {
  if (a > b) std::swap(a, b);
  const std::optional<Placement> found = placementFor(a, b);
  if (!found) return;
  candidates_.push_back({found->volume, a, b, changes_[a], changes_[b]});
  std::push_heap(candidates_.begin(), candidates_.end(), [](const auto& x, const auto& y) { return costsMore(x, y); });
}

void OuterShell::forget(Vertex v) {
  for (Spoke& s : ring_[v]) {
    s.known = false;
    ring_[s.to][slot(s.to, v)].known = false;
  }
}

void OuterShell::collapse(Vertex a, Vertex b, const Vec3& position) {
  const std::vector<Vertex> link = linkOfEdge(a, b);
  for (const Vertex v : link) {
    std::vector<Spoke>& ring = ring_[v];
    bool toA = false;
    for (const Spoke& s : ring) toA |= s.to == a;
    if (toA) std::erase_if(ring, [b](const Spoke& s) { return s.to == b; });
    for (Spoke& s : ring) {
      if (s.to == b) s.to = a;
    }
  }
  ring_[b].clear();
  ring_[a].clear();
  for (const Vertex v : link) ring_[a].push_back({v, false, {}});
  at_[a] = position;
  --count_;
  forget(a);
}

bool OuterShell::collapseTo(int maxVertices) {
  candidates_.clear();
  for (Vertex a = 0; a < countOf(ring_); ++a) {
    for (const Vertex b : linkOfVertex(a)) {
      if (a < b) propose(a, b);
    }
  }
  while (count_ > maxVertices) {
    if (candidates_.empty()) return false;
    std::pop_heap(candidates_.begin(), candidates_.end(), [](const auto& x, const auto& y) { return costsMore(x, y); });
    const Candidate cheapest = candidates_.back();
    candidates_.pop_back();
    const auto [cost, a, b, changeA, changeB] = cheapest;
    if (changes_[a] != changeA || changes_[b] != changeB) continue;  // outdated: proposed again since
    // A face beyond the link may have changed: evaluate again.
    const std::optional<Placement> now = placementFor(a, b);
    if (!now) continue;
    if (now->volume > cost + kSameCost) {
      propose(a, b);
      continue;
    }
    collapse(a, b, now->position);
    const std::vector<Vertex> link = linkOfVertex(a);
    ++changes_[a];
    ++changes_[b];
    for (const Vertex v : link) ++changes_[v];
    for (const Vertex v : link) {
      for (const Vertex w : linkOfVertex(v)) {
        const bool fromBoth = std::find(link.begin(), link.end(), w) != link.end();
        if (!fromBoth || v < w) propose(v, w);
      }
    }
  }
  return true;
}

void OuterShell::relax(int maxRounds, double share) {
  for (int round = 0; round < maxRounds; ++round) {
    double volume = 0.0;
    double gained = 0.0;
    for (Vertex v = 0; v < countOf(ring_); ++v) {
      if (ring_[v].empty()) continue;
      const std::vector<Vertex> link = linkOfVertex(v);
      const double before = fanVolume(link, at_[v]);
      volume += before / 3.0;  // each triangle belongs to three fans
      const std::optional<Vec3> apex = bestApex(link);
      if (!apex) continue;
      const double gain = before - fanVolume(link, *apex);
      if (gain <= 0.0) continue;
      gained += gain;
      at_[v] = *apex;
      forget(v);
    }
    if (gained <= share * volume) return;
  }
}

std::vector<Vec3> OuterShell::vertices() const {
  std::vector<Vec3> alive;
  for (std::size_t v = 0; v < ring_.size(); ++v) {
    if (!ring_[v].empty()) alive.push_back(at_[v]);
  }
  return alive;
}

}  // namespace lorica
