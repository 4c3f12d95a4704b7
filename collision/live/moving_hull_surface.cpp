#include "collision/live/moving_hull_surface.h"

#include <algorithm>

namespace lorica {

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
