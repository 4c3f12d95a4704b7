#include "collision/live/moving_hull_surface.h"

#include "collision/live/moving_hull_exact.h"

#include <algorithm>

namespace lorica {
namespace {

// The point with the largest measure, the first of equals; kNobody if none is above zero.
constexpr VertexIndex kNobody = -1;

template <class Measure>
VertexIndex farthest(std::span<const PointRow> points, const Measure& measure) {
  VertexIndex best = kNobody;
  double max = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double value = measure(points[i]);
    if (value > max) {
      max = value;
      best = i;
    }
  }
  return best;
}

double squared(const exact::Row& r) {
  return r.x * r.x + r.y * r.y + r.z * r.z;
}

}  // namespace

void HullStart::fit(std::size_t pointCount) {
  const std::size_t max = std::max<std::size_t>(4, 2 * pointCount);
  faces_.reserve(max);
  kept_.reserve(max);
  visible_.reserve(max);
}

std::span<const Triangle> HullStart::find(std::span<const PointRow> points) {
  if (!spanTetrahedron(points)) return {};
  const auto at = [&](VertexIndex i) -> const PointRow& { return points[i]; };
  while (true) {
    // If the origin is not strictly below a face, adding the point farthest above the face brings the hull nearer to
    // it.
    const auto wrong = std::find_if(faces_.begin(), faces_.end(),
                                    [&](const Triangle& t) { return exact::det(at(t[0]), at(t[1]), at(t[2])) <= 0.0; });
    if (wrong == faces_.end()) return faces_;
    const Triangle face = *wrong;
    const VertexIndex p =
        farthest(points, [&](const PointRow& q) { return exact::side(at(face[0]), at(face[1]), at(face[2]), q); });
    if (p == kNobody) return {};
    add(points, p);
  }
}

bool HullStart::spanTetrahedron(std::span<const PointRow> points) {
  const auto at = [&](VertexIndex i) -> const PointRow& { return points[i]; };
  const VertexIndex a = farthest(points, [](const PointRow& p) { return squared(exact::rowOf(p)); });
  if (a == kNobody) return false;
  const VertexIndex b = farthest(points, [&](const PointRow& p) { return squared(exact::between(at(a), p)); });
  if (b == kNobody) return false;
  const exact::Row ab = exact::between(at(a), at(b));
  VertexIndex c =
      farthest(points, [&](const PointRow& p) { return squared(exact::cross(ab, exact::between(at(a), p))); });
  if (c == kNobody) return false;
  const auto height = [&](const PointRow& p) { return exact::side(at(a), at(b), at(c), p); };
  VertexIndex d = farthest(points, [&](const PointRow& p) { return std::abs(height(p)); });
  if (d == kNobody) return false;
  if (height(at(d)) > 0.0) std::swap(c, d);  // the fourth point must be below the face of the first three
  faces_.assign({Triangle{a, b, c}, Triangle{a, d, b}, Triangle{b, d, c}, Triangle{c, d, a}});
  return true;
}

// Adds an outside point: faces that see it or contain it in their plane are removed, and a cone over their border is
// added. Coplanar faces are removed together, so no face without area can arise. There are few faces, so their border
// is found by comparing all of them.
void HullStart::add(std::span<const PointRow> points, VertexIndex p) {
  const auto at = [&](VertexIndex i) -> const PointRow& { return points[i]; };
  kept_.clear();
  visible_.clear();
  for (const Triangle& t : faces_) {
    const bool seen = exact::side(at(t[0]), at(t[1]), at(t[2]), at(p)) >= 0.0;
    (seen ? visible_ : kept_).push_back(t);
  }
  faces_.assign(kept_.begin(), kept_.end());
  for (const Triangle& t : visible_) {
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex from = t[i];
      const VertexIndex to = t[(i + 1) % 3];
      const bool border = std::any_of(kept_.begin(), kept_.end(), [&](const Triangle& k) {
        return (k[0] == to && k[1] == from) || (k[1] == to && k[2] == from) || (k[2] == to && k[0] == from);
      });
      if (border) faces_.push_back({from, to, p});
    }
  }
}

HullSurface::HullSurface(int pointCount) {
  const std::size_t max = std::max(4, 2 * pointCount - 4);
  faces_.reserve(max + kPadding + 1);
  opposites_.reserve(3 * faces_.capacity());
  twins_.reserve(3 * faces_.capacity());
  outOf_.resize(pointCount, kNone);
  touchMore();
}

// The vectors grow within their reserved capacity.
void HullSurface::touchMore() {
  constexpr std::size_t kMore = 4 * kPadding;
  const std::size_t size = std::min(faces_.size() + kMore, faces_.capacity());
  faces_.resize(size);
  opposites_.resize(3 * size);
  twins_.resize(3 * size, kNone);
}

void HullSurface::clear() {
  faceCount_ = 0;
  std::fill(outOf_.begin(), outOf_.end(), kNone);
}

std::size_t HullSurface::memory() const {
  return faces_.capacity() * sizeof(Triangle) +
         (opposites_.capacity() + twins_.capacity() + outOf_.capacity()) * sizeof(std::int32_t);
}

bool HullSurface::eraseFace(std::int32_t face) {
  const std::int32_t last = --faceCount_;
  if (face == last) return false;
  const auto [a, b, c] = faces_[last];
  setFace(face, a, b, c);
  for (int i = 0; i < 3; ++i) glue(3 * face + i, twin(3 * last + i));
  return true;
}

//        c                  c
//      /   \              / | \                    .
//     a --- b    becomes a  |  b
//      \   /              \ | /
//        d                  d
void HullSurface::flip(HalfEdge h) {
  const HalfEdge k = twin(h);
  const std::int32_t f = faceOf(h);
  const std::int32_t g = faceOf(k);
  const VertexIndex a = start(h), b = end(h), c = apex(h), d = apex(k);
  const HalfEdge bc = twin(next(h)), ca = twin(previous(h)), ad = twin(next(k)), db = twin(previous(k));
  setFace(f, a, d, c);
  setFace(g, d, b, c);
  glue(3 * f, ad);
  glue(3 * f + 1, 3 * g + 2);
  glue(3 * f + 2, ca);
  glue(3 * g, db);
  glue(3 * g + 1, bc);
}

void HullSurface::splitFace(std::int32_t face, VertexIndex p) {
  const auto [a, b, c] = faces_[face];
  const HalfEdge bc = twin(3 * face + 1), ca = twin(3 * face + 2);
  const std::int32_t second = addFace(b, c, p);
  const std::int32_t third = addFace(c, a, p);
  const HalfEdge ab = twin(3 * face);
  setFace(face, a, b, p);
  glue(3 * face, ab);
  glue(3 * second, bc);
  glue(3 * third, ca);
  glue(3 * face + 1, 3 * second + 2);
  glue(3 * second + 1, 3 * third + 2);
  glue(3 * third + 1, 3 * face + 2);
}

//        c                  c
//      /   \              / | \                    .
//     a --- b    becomes a--p--b
//      \   /              \ | /
//        d                  d
void HullSurface::splitEdge(HalfEdge h, VertexIndex p) {
  const HalfEdge k = twin(h);
  const std::int32_t f = faceOf(h);
  const std::int32_t g = faceOf(k);
  const VertexIndex a = start(h), b = end(h), c = apex(h), d = apex(k);
  const HalfEdge bc = twin(next(h)), ca = twin(previous(h)), ad = twin(next(k)), db = twin(previous(k));
  setFace(f, c, a, p);
  setFace(g, a, d, p);
  const std::int32_t third = addFace(d, b, p);
  const std::int32_t fourth = addFace(b, c, p);
  glue(3 * f, ca);
  glue(3 * g, ad);
  glue(3 * third, db);
  glue(3 * fourth, bc);
  glue(3 * f + 1, 3 * g + 2);
  glue(3 * g + 1, 3 * third + 2);
  glue(3 * third + 1, 3 * fourth + 2);
  glue(3 * fourth + 1, 3 * f + 2);
}

void HullSurface::replaceVertex(VertexIndex v, VertexIndex p) {
  const HalfEdge first = outOf(v);
  HalfEdge h = first;
  do {
    faces_[h / 3][h % 3] = p;
    opposites_[twin(next(h))] = p;
    h = turn(h);
  } while (h != first);
  outOf_[p] = first;
  forget(v);
}

}  // namespace lorica
