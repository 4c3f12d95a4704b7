// How MovingHull removes a vertex and closes the hole.

#include "collision/live/moving_hull.h"
#include "collision/live/moving_hull_exact.h"

#include <algorithm>

namespace lorica {

using exact::det;

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
