#include "collision/live/moving_hull.h"

#include "collision/live/extent_kernel.h"
#include "collision/live/moving_hull_exact.h"
#include "geometry/counts.h"
#include "geometry/result.h"

#include <algorithm>
#include <numeric>

namespace lorica {

using exact::det;
using exact::side;

MovingHull::Scratch& MovingHull::scratchOfThisThread() {
  thread_local Scratch scratch;
  return scratch;
}

void MovingHull::Scratch::fit(std::size_t pointCount) {
  const std::size_t maxFaces = std::max<std::size_t>(4, 2 * pointCount);
  if (isNear.size() >= maxFaces) return;
  start.fit(pointCount);
  doubts.resize(maxFaces);
  queue.reserve(3 * maxFaces);
  queued.resize(3 * maxFaces);
  turned.reserve(maxFaces);
  pierced.reserve(maxFaces);
  near.reserve(maxFaces);
  isNear.resize(maxFaces);
  unsettled.reserve(pointCount);
  link.reserve(pointCount);
  cuts.reserve(pointCount);
}

MovingHull::MovingHull(int pointCount) : surface_(pointCount) {
  LORICA_CHECK(pointCount > 0, "a hull needs at least one point");
  const std::size_t n = pointCount;
  scratchOfThisThread().fit(n);
  vertices_.reserve(n);
  inside_.resize(n + kPassWidth);
  slot_.resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    const VertexIndex id = p;
    slot_[p] = id;
    inside_[p] = {id, id, id, id};
  }
  insideCount_ = n;

  // Without common divisor, and not near simple fractions of the count.
  stride_ = std::max<std::size_t>(1, (n * 618) / 1000);
  while (std::gcd(stride_, n) != 1) ++stride_;
}

// Visits all points once, with neighbours far apart.
template <class Visit>
void MovingHull::visitScrambled(const Visit& visit) const {
  const std::size_t n = slot_.size();
  for (std::size_t i = 0, p = 0; i < n; ++i, p = (p + stride_) % n) visit(static_cast<VertexIndex>(p));
}

void MovingHull::update(std::span<const PointRow> points) {
  LORICA_CHECK(points.size() == slot_.size(), "the number of points must be that of the constructor");
  points_ = points;
  counts_ = {};
  scratch_ = &scratchOfThisThread();
  scratch_->fit(points.size());
  if (!flat() && repair()) return;
  if (!build()) startOver();
}

void MovingHull::fetch() const {
  const std::size_t count = surface_.faceCount();
  lorica::fetch(std::as_bytes(surface_.faces()));
  lorica::fetch(std::as_bytes(std::span(surface_.opposites(), 3 * count)));
  lorica::fetch(std::as_bytes(std::span(inside_).first(insideCount_)));
  lorica::fetch(std::as_bytes(std::span(vertices_)));
}

double MovingHull::volume() const {
  return sumOfDeterminants(points_.data(), faces().data(), surface_.faceCount()) / 6.0;
}

std::size_t MovingHull::memory() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof(*this) + surface_.memory() + bytes(vertices_) + bytes(inside_) + bytes(slot_);
}

bool MovingHull::repair() {
  // Turned faces come first: everything else assumes that s sees the whole surface from inside.
  constexpr int kRounds = 8;
  scanFaces();
  for (int round = 0; !scratch_->turned.empty(); ++round) {
    if (round == kRounds || !turnFaces()) return false;
    lookAgain();
  }
  // All faces may look outwards on a surface that winds around s twice, like a star pentagon.
  if (scratch_->pierced.size() != 1) return false;
  return legalise() && checkCertificates();
}

bool MovingHull::build() {
  counts_.rebuilds = 1;
  const std::span<const Triangle> first = scratch_->start.find(points_);
  if (first.empty()) return false;

  // Last frame's vertices are likely to be vertices again; the others are then inside immediately.
  scratch_->unsettled.clear();
  for (const bool wasVertex : {true, false}) {
    visitScrambled([&](VertexIndex p) {
      if (isVertex(p) == wasVertex) scratch_->unsettled.push_back(p);
    });
  }
  startOver();
  for (const Triangle& t : first) {
    const std::int32_t face = surface_.addFace(t[0], t[1], t[2]);
    for (HalfEdge h = 3 * face; h < 3 * face + 3; ++h) {
      for (HalfEdge g = 0; g < 3 * face; ++g) {
        if (surface_.start(g) == surface_.end(h) && surface_.end(g) == surface_.start(h)) surface_.glue(h, g);
      }
    }
  }
  visitScrambled([&](VertexIndex p) {
    if (isVertex(p)) becomeVertex(p);
  });
  return settleAll();
}

// Removes all faces and vertices. Certificates stay: they prove nothing now but serve as hints for the search. The same
// holds for a vertex's neighbours, which are likely to be near again even after a large motion.
void MovingHull::startOver() {
  while (!scratch_->queue.empty()) {
    scratch_->queued[scratch_->queue.back()] = 0;
    scratch_->queue.pop_back();
  }
  while (!vertices_.empty()) {
    const VertexIndex v = vertices_.back();
    const HalfEdge out = surface_.outOf(v);
    const HalfEdge onward = surface_.turn(surface_.turn(out));
    becomeInside(v, {surface_.end(out), surface_.apex(out), surface_.end(onward)});
  }
  surface_.clear();
}

double MovingHull::faceDet(std::int32_t face) const {
  const Triangle& t = surface_.faces()[face];
  return det(at(t[0]), at(t[1]), at(t[2]));
}

// Each flip adds volume to the solid and each removed vertex stays out, so this ends.
bool MovingHull::legalise() {
  while (!scratch_->queue.empty()) {
    const HalfEdge h = scratch_->queue.back();
    scratch_->queue.pop_back();
    scratch_->queued[h] = 0;
    if (h >= 3 * surface_.faceCount()) continue;
    const HalfEdge k = surface_.twin(h);
    const VertexIndex a = surface_.start(h), b = surface_.end(h), c = surface_.apex(h), d = surface_.apex(k);
    if (side(at(a), at(b), at(c), at(d)) <= 0.0) continue;
    // Seen from s, the quadrilateral a d b c has at most one non-convex corner, a or b. If both were non-convex, the
    // edge would be convex: consider the tetrahedron of s and the other three corners.
    if (det(at(a), at(d), at(c)) <= 0.0) {
      if (!takeOut(a, Link::kSeenFromVertex, {d, b, c})) return false;
    } else if (det(at(d), at(b), at(c)) <= 0.0) {
      if (!takeOut(b, Link::kSeenFromVertex, {a, d, c})) return false;
    } else {
      surface_.flip(h);
      ++counts_.flips;
      const std::int32_t f = HullSurface::faceOf(h);
      const std::int32_t g = HullSurface::faceOf(k);
      queueConcave(f, 3 * f, 3 * f + 2);
      queueConcave(g, 3 * g, 3 * g + 1);
    }
  }
  return true;
}

bool MovingHull::holds(const HullCertificate& certificate) const {
  const auto [ia, ib, ic, ip] = certificate;
  const PointRow &a = at(ia), &b = at(ib), &c = at(ic), &p = at(ip);
  return det(a, b, c) > 0.0 && det(a, b, p) >= 0.0 && det(b, c, p) >= 0.0 && det(c, a, p) >= 0.0 &&
         side(a, b, c, p) <= 0.0;
}

bool MovingHull::checkCertificates() {
  scratch_->unsettled.clear();
  const int found = findDoubtfulCertificates(points_.data(), inside_.data(), insideCount_, scratch_->doubts.data());
  for (const std::int32_t doubt : std::span(scratch_->doubts).first(found)) {
    const HullCertificate& certificate = inside_[doubt];
    if (!holds(certificate)) scratch_->unsettled.push_back(certificate.point);
  }
  counts_.failedCertificates = countOf(scratch_->unsettled);
  return settleAll();
}

bool MovingHull::settleAll() {
  return std::all_of(scratch_->unsettled.begin(), scratch_->unsettled.end(),
                     [&](VertexIndex p) { return isVertex(p) || settle(p); });
}

// A vertex that may be near a point.
VertexIndex MovingHull::hintFor(VertexIndex p) const {
  const HullCertificate& last = inside_[slot_[p]];
  for (const VertexIndex v : {last.a, last.b, last.c}) {
    if (isVertex(v)) return v;
  }
  // Of a few vertices, approximately the one with the nearest direction.
  constexpr std::size_t kTries = 12;
  const std::size_t step = 1 + vertices_.size() / kTries;
  const PointRow& q = at(p);
  const auto towards = [&](VertexIndex v) { return at(v).x * q.x + at(v).y * q.y + at(v).z * q.z; };
  VertexIndex nearest = vertices_.front();
  for (std::size_t i = step; i < vertices_.size(); i += step) {
    if (towards(vertices_[i]) > towards(nearest)) nearest = vertices_[i];
  }
  return nearest;
}

// Gives a point a new certificate, or makes it a vertex if it is outside.
bool MovingHull::settle(VertexIndex p) {
  const Position position = locate(p, hintFor(p));
  const Triangle t = faces()[position.face];
  if (side(at(t[0]), at(t[1]), at(t[2]), at(p)) <= 0.0) {
    inside_[slot_[p]] = {t[0], t[1], t[2], p};
    return true;
  }
  ++counts_.insertions;
  becomeVertex(p);
  const int zeros = (position.ab == 0.0) + (position.bc == 0.0) + (position.ca == 0.0);
  const HalfEdge first = 3 * position.face;
  if (zeros == 0) {
    surface_.splitFace(position.face, p);
  } else if (zeros == 1) {
    surface_.splitEdge(position.ab == 0.0 ? first : position.bc == 0.0 ? first + 1 : first + 2, p);
  } else {
    // Straight above a corner. The corner goes inside, because it lies between s and p.
    const VertexIndex v = position.ab != 0.0 ? t[2] : position.bc != 0.0 ? t[0] : t[1];
    surface_.replaceVertex(v, p);
    const Triangle& over = faces()[position.face];
    becomeInside(v, over);
  }
  // Edges at a point put on top of a face or an edge are convex; at one on top of a vertex they need not be.
  const HalfEdge out = surface_.outOf(p);
  HalfEdge h = out;
  do {
    const HalfEdge rim = HullSurface::next(h);
    queueConcave(HullSurface::faceOf(h), rim, zeros == 2 ? h : rim);
    h = surface_.turn(h);
  } while (h != out);
  return legalise();
}

// Walks along the arc from a vertex to the point's direction. Seen from s, the arc leaves each face that it enters
// through an edge of the face's third corner, so one product per step decides where it continues.
//
//      L ----- q       The arc enters over the edge from L to R. If q is on its right, it leaves between q and L,
//       \     /        otherwise between R and q.
//        \  /
//         R
MovingHull::Position MovingHull::locate(VertexIndex p, VertexIndex from) const {
  const PointRow& point = at(p);
  const exact::Row across = exact::cross(exact::rowOf(point), exact::rowOf(at(from)));
  const auto rightOfArc = [&](VertexIndex q) { return exact::dot(across, exact::rowOf(at(q))); };
  const auto edge = [&](HalfEdge h) { return det(at(surface_.start(h)), at(surface_.end(h)), point); };

  // The face at the vertex in which the arc starts: its second corner is on the right and its third is not.
  const HalfEdge out = surface_.outOf(from);
  HalfEdge h = out;
  double first = rightOfArc(surface_.end(h));
  double second = 0.0;
  if (first >= 0.0) {
    while ((second = rightOfArc(surface_.apex(h))) >= 0.0) {
      h = surface_.turn(h);
      first = second;
      if (h == out) break;
    }
  } else {
    do {
      second = first;
      h = HullSurface::next(surface_.twin(h));
      first = rightOfArc(surface_.end(h));
    } while (first < 0.0 && h != out);
  }
  HalfEdge rim = HullSurface::next(h);
  double beyond = edge(rim);
  if (beyond >= 0.0) {
    if (first >= 0.0 && second <= 0.0) return positionAt(h, first, beyond, -second);
  } else {
    for (int step = 0; step < surface_.faceCount(); ++step) {
      const HalfEdge entry = surface_.twin(rim);
      const bool right = rightOfArc(surface_.apex(entry)) >= 0.0;
      rim = right ? HullSurface::previous(entry) : HullSurface::next(entry);
      const double entered = -beyond;
      beyond = edge(rim);
      if (beyond < 0.0) continue;
      const double beside = edge(right ? HullSurface::next(entry) : HullSurface::previous(entry));
      if (beside < 0.0) break;
      return right ? positionAt(entry, entered, beside, beyond) : positionAt(entry, entered, beyond, beside);
    }
  }
  // There is no arc only if the point's direction is exactly opposite to the vertex.
  for (std::int32_t face = 0; face < surface_.faceCount(); ++face) {
    const Position position{face, edge(3 * face), edge(3 * face + 1), edge(3 * face + 2)};
    if (position.ab >= 0.0 && position.bc >= 0.0 && position.ca >= 0.0) return position;
  }
  LORICA_CHECK(false, "the faces of a star-shaped surface must cover all directions");
  return {};
}

// The position in the face of h, given the values at h, the next half-edge and the previous one.
MovingHull::Position MovingHull::positionAt(HalfEdge h, double beside, double besideNext, double besidePrevious) {
  const std::int32_t face = HullSurface::faceOf(h);
  switch (h - 3 * face) {
    case 0:
      return {face, beside, besideNext, besidePrevious};
    case 1:
      return {face, besidePrevious, beside, besideNext};
    default:
      return {face, besideNext, besidePrevious, beside};
  }
}

// Removes a point from inside_; the surface must contain it.
void MovingHull::becomeVertex(VertexIndex p) {
  std::int32_t& slot = slot_[p];
  const HullCertificate last = inside_[--insideCount_];
  inside_[slot] = last;
  slot_[last.point] = slot;
  slot = countOf(vertices_);
  vertices_.push_back(p);
}

// Removes a point from vertices_.
void MovingHull::becomeInside(VertexIndex p, const Triangle& certificate) {
  std::int32_t& slot = slot_[p];
  const VertexIndex last = vertices_.back();
  vertices_[slot] = last;
  slot_[last] = slot;
  vertices_.pop_back();
  slot = insideCount_;
  inside_[insideCount_++] = {certificate[0], certificate[1], certificate[2], p};
}

// Most edges beside a change are convex; these are not queued.
void MovingHull::queueConcave(std::int32_t face, HalfEdge h, HalfEdge k) {
  const Triangle& t = faces()[face];
  const PointRow& a = at(t[0]);
  const exact::Row normal = exact::cross(exact::between(a, at(t[1])), exact::between(a, at(t[2])));
  const auto above = [&](HalfEdge edge) {
    return exact::dot(normal, exact::between(a, at(surface_.opposite(edge)))) > 0.0;
  };
  if (above(h)) queueEdge(h);
  if (k != h && above(k)) queueEdge(k);
}

void MovingHull::queueEdge(HalfEdge h) {
  h = std::min(h, surface_.twin(h));
  std::uint8_t& queued = scratch_->queued[h];
  if (queued != 0) return;
  queued = 1;
  scratch_->queue.push_back(h);
}

void MovingHull::queueFace(std::int32_t face) {
  for (HalfEdge h = 3 * face; h < 3 * face + 3; ++h) queueEdge(h);
}

}  // namespace lorica
