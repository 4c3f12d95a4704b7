// How MovingHull finds and repairs faces whose outside no longer points away from the origin s.

#include "collision/live/moving_hull.h"
#include "collision/live/moving_hull_exact.h"
#include "geometry/counts.h"

#include <algorithm>

namespace lorica {

using exact::det;
using exact::side;

// Whether the direction (e, e^2, 1) for an infinitesimal e lies in the cone of a face that looks outwards. It is never
// on an edge: an edge's plane through s would need a normal of zero.
bool MovingHull::isPierced(std::int32_t face) const {
  const Triangle& t = faces()[face];
  for (std::size_t i = 0; i < 3; ++i) {
    const exact::Row n = exact::cross(exact::rowOf(at(t[i])), exact::rowOf(at(t[(i + 1) % 3])));
    const double first = n.z != 0.0 ? n.z : n.x != 0.0 ? n.x : n.y;
    if (first < 0.0) return false;
  }
  return true;
}

// Queues concave edges and lists turned and pierced faces.
void MovingHull::scanFaces() {
  scratch_->turned.clear();
  scratch_->pierced.clear();
  const int found = findDoubtfulFaces(points_.data(), faces().data(), surface_.opposites(), surface_.faceCount(),
                                      scratch_->doubts.data());
  for (const std::int32_t doubt : std::span(scratch_->doubts).first(found)) {
    const std::int32_t face = doubt / kFaceBits;
    const Triangle& t = faces()[face];
    const PointRow &a = at(t[0]), &b = at(t[1]), &c = at(t[2]);
    if ((doubt & kMayBeTurned) != 0 && det(a, b, c) <= 0.0) {
      scratch_->turned.push_back(face);
      continue;
    }
    if ((doubt & kMayBePierced) != 0 && isPierced(face)) scratch_->pierced.push_back(face);
    for (int edge = 0; edge < 3; ++edge) {
      if ((doubt & kEdgeMayBeConcave << edge) == 0) continue;
      // A concave edge is in doubt from both its faces; one of them is enough.
      const HalfEdge h = 3 * face + edge;
      if (h < surface_.twin(h) && side(a, b, c, at(surface_.opposite(h))) > 0.0) queueEdge(h);
    }
  }
}

// Updates these lists after some faces were changed: all edges of such faces are in the queue.
void MovingHull::lookAgain() {
  scratch_->near.clear();
  for (const HalfEdge h : scratch_->queue) {
    if (h >= 3 * surface_.faceCount()) continue;
    for (const std::int32_t face : {HullSurface::faceOf(h), HullSurface::faceOf(surface_.twin(h))}) {
      if (scratch_->isNear[face] != 0) continue;
      scratch_->isNear[face] = 1;
      scratch_->near.push_back(face);
    }
  }
  std::erase_if(scratch_->pierced,
                [&](std::int32_t face) { return face >= surface_.faceCount() || scratch_->isNear[face] != 0; });
  scratch_->turned.clear();
  for (const std::int32_t face : scratch_->near) {
    scratch_->isNear[face] = 0;
    if (faceDet(face) <= 0.0) {
      scratch_->turned.push_back(face);
    } else if (isPierced(face)) {
      scratch_->pierced.push_back(face);
    }
  }
}

bool MovingHull::turnFaces() {
  counts_.turnedFaces += countOf(scratch_->turned);
  if (scratch_->turned.size() > 8 + static_cast<std::size_t>(surface_.faceCount()) / 8) return false;
  for (const std::int32_t face : scratch_->turned) {
    if (face < surface_.faceCount() && faceDet(face) <= 0.0 && !turnFace(face)) return false;
  }
  return true;
}

bool MovingHull::turnFace(std::int32_t face) {
  // Usually a corner has slipped over the edge opposite to it.
  for (HalfEdge h = 3 * face; h < 3 * face + 3; ++h) {
    const HalfEdge k = surface_.twin(h);
    const VertexIndex a = surface_.start(h), b = surface_.end(h), c = surface_.apex(h), d = surface_.apex(k);
    if (surface_.hasThreeEdges(h) || surface_.hasThreeEdges(k)) continue;  // two faces would lie back to back
    if (det(at(a), at(d), at(c)) <= 0.0 || det(at(d), at(b), at(c)) <= 0.0) continue;
    surface_.flip(h);
    ++counts_.flips;
    queueFace(HullSurface::faceOf(h));
    queueFace(HullSurface::faceOf(k));
    return true;
  }
  // Otherwise remove a corner if its hole can be closed properly, trying first the one with most turned faces.
  Triangle corners = faces()[face];
  std::array<int, 3> turned{};
  for (std::size_t i = 0; i < 3; ++i) turned[i] = turnedAround(corners[i]);
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{0}}) {
    if (turned[i + 1] <= turned[i]) continue;
    std::swap(turned[i], turned[i + 1]);
    std::swap(corners[i], corners[i + 1]);
  }
  for (const VertexIndex v : corners) {
    if (takeOut(v, Link::kSimple, {v, v, v})) return true;
  }
  return false;
}

int MovingHull::turnedAround(VertexIndex v) const {
  int count = 0;
  const HalfEdge first = surface_.outOf(v);
  HalfEdge h = first;
  do {
    count += faceDet(HullSurface::faceOf(h)) <= 0.0 ? 1 : 0;
    h = surface_.turn(h);
  } while (h != first);
  return count;
}

// Removes a vertex and triangulates the hole by cutting ears off its link, as seen from s.
bool MovingHull::takeOut(VertexIndex v, Link link, const Triangle& certificate) {
  if (vertices_.size() <= 4) return false;
  scratch_->link.clear();
  const HalfEdge first = surface_.outOf(v);
  HalfEdge h = first;
  do {
    const HalfEdge rim = HullSurface::next(h);
    if (surface_.opposite(rim) == v) return false;  // while faces are turned, parts of the surface may lie back to back
    const std::int32_t i = scratch_->link.size();
    scratch_->link.push_back({surface_.start(rim), surface_.twin(rim), HullSurface::faceOf(h), i - 1, i + 1});
    h = surface_.turn(h);
  } while (h != first && scratch_->link.size() < vertices_.size());
  const std::int32_t corners = scratch_->link.size();
  if (h != first || corners < 3) return false;
  scratch_->link.front().before = corners - 1;
  scratch_->link.back().after = 0;
  if (!planCuts(v, link, corners)) return false;

  // Make the planned cuts in the memory of the faces around the vertex; two of these are left over.
  for (std::size_t i = 0; i < scratch_->link.size(); ++i) {
    scratch_->link[i].before = i == 0 ? scratch_->link.size() - 1 : i - 1;
    scratch_->link[i].after = i + 1 == scratch_->link.size() ? 0 : i + 1;
  }
  std::size_t used = 0;
  for (const std::int32_t tip : scratch_->cuts) {
    const Scratch::Corner& corner = scratch_->link[tip];
    Scratch::Corner& before = scratch_->link[corner.before];
    Scratch::Corner& after = scratch_->link[corner.after];
    const std::int32_t face = scratch_->link[used++].face;
    surface_.setFace(face, before.vertex, corner.vertex, after.vertex);
    surface_.glue(3 * face, before.rim);
    surface_.glue(3 * face + 1, corner.rim);
    if (used + 2 == scratch_->link.size()) {
      surface_.glue(3 * face + 2, after.rim);
    } else {
      before.rim = 3 * face + 2;
      before.after = corner.after;
      after.before = corner.before;
    }
  }
  for (std::size_t i = 0; i < used; ++i) queueFace(scratch_->link[i].face);
  std::int32_t spare = scratch_->link[used].face;
  std::int32_t other = scratch_->link[used + 1].face;
  if (spare < other) std::swap(spare, other);
  for (const std::int32_t gone : {spare, other}) {
    // The face that moves may have had edges in the queue under its old number.
    if (surface_.eraseFace(gone)) queueFace(gone);
  }
  surface_.forget(v);
  becomeInside(v, certificate);
  ++counts_.deletions;
  return true;
}

bool MovingHull::planCuts(VertexIndex v, Link link, int corners) {
  scratch_->cuts.clear();
  std::int32_t tip = 0;
  int refused = 0;
  for (int left = corners; left > 3;) {
    Scratch::Corner& corner = scratch_->link[tip];
    if (isEar(v, link, corner.before, tip, corner.after)) {
      scratch_->cuts.push_back(tip);
      scratch_->link[corner.before].after = corner.after;
      scratch_->link[corner.after].before = corner.before;
      --left;
      refused = 0;
    } else if (++refused > left) {
      return false;
    }
    tip = corner.after;
  }
  const Scratch::Corner& corner = scratch_->link[tip];
  scratch_->cuts.push_back(tip);
  return det(at(scratch_->link[corner.before].vertex), at(corner.vertex), at(scratch_->link[corner.after].vertex)) >
         0.0;
}

// An ear's outside points away from s, and cutting it leaves a link of the same kind. If the vertex sees its whole
// link, it must not lie strictly within the ear. It may lie on the ear's border, as in a square whose diagonals cross
// at the vertex.
bool MovingHull::isEar(VertexIndex v, Link link, int before, int tip, int after) const {
  const VertexIndex ib = scratch_->link[before].vertex;
  const VertexIndex it = scratch_->link[tip].vertex;
  const VertexIndex ia = scratch_->link[after].vertex;
  const PointRow &b = at(ib), &t = at(it), &a = at(ia);
  if (det(b, t, a) <= 0.0) return false;
  if (link == Link::kSeenFromVertex) return det(b, a, at(v)) >= 0.0;
  return std::none_of(scratch_->link.begin(), scratch_->link.end(), [&](const Scratch::Corner& corner) {
    const VertexIndex q = corner.vertex;
    return q != ib && q != it && q != ia && det(b, t, at(q)) >= 0.0 && det(t, a, at(q)) >= 0.0 &&
           det(a, b, at(q)) >= 0.0;
  });
}

}  // namespace lorica
