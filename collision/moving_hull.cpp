#include "collision/moving_hull.h"

#include "collision/moving_hull_exact.h"
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
  const std::size_t mostFaces = std::max<std::size_t>(4, 2 * pointCount);
  if (isNear.size() >= mostFaces) return;
  start.fit(pointCount);
  doubts.resize(mostFaces);
  queue.reserve(3 * mostFaces);
  queued.resize(3 * mostFaces);
  turned.reserve(mostFaces);
  pierced.reserve(mostFaces);
  near.reserve(mostFaces);
  isNear.resize(mostFaces);
  unsettled.reserve(pointCount);
  link.reserve(pointCount);
  cuts.reserve(pointCount);
}

MovingHull::MovingHull(int pointCount) : surface_(pointCount) {
  CHECK(pointCount > 0, "a hull needs points");
  const auto n = static_cast<std::size_t>(pointCount);
  scratchOfThisThread().fit(n);
  vertices_.reserve(n);
  inside_.resize(n + kPassWidth);
  slot_.resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    const auto id = static_cast<VertexIndex>(p);
    slot_[p] = id;
    inside_[p] = {id, id, id, id};
  }
  insideCount_ = n;

  // A permutation by a stride without common divisor, far from simple fractions of the count.
  scrambled_.reserve(n);
  std::size_t stride = std::max<std::size_t>(1, (n * 618) / 1000);
  while (std::gcd(stride, n) != 1) ++stride;
  for (std::size_t i = 0, p = 0; i < n; ++i, p = (p + stride) % n) scrambled_.push_back(static_cast<VertexIndex>(p));
}

void MovingHull::update(std::span<const PointRow> points) {
  CHECK(points.size() == slot_.size(), "as many points as the hull was made for");
  points_ = points;
  counts_ = {};
  scratch_ = &scratchOfThisThread();
  scratch_->fit(points.size());
  if (!flat() && repair()) return;
  if (!build()) startOver();
}

double MovingHull::volume() const {
  double sum = 0.0;
  for (const Triangle& t : faces()) sum += det(at(t[0]), at(t[1]), at(t[2]));
  return sum / 6.0;
}

std::size_t MovingHull::memory() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof(*this) + surface_.memory() + bytes(vertices_) + bytes(inside_) + bytes(slot_) + bytes(scrambled_);
}

VertexIndex MovingHull::support(const Vec3& direction, VertexIndex startHint) const {
  const auto along = [&](VertexIndex p) {
    const PointRow& q = at(p);
    return direction.x() * q.x + direction.y() * q.y + direction.z() * q.z;
  };
  const auto higherOf = [&](VertexIndex a, VertexIndex b) { return along(b) > along(a) ? b : a; };
  if (flat()) return std::accumulate(scrambled_.begin(), scrambled_.end(), startHint, higherOf);
  VertexIndex best = isVertex(startHint) ? startHint : vertices_.front();
  double most = along(best);
  while (true) {
    const HalfEdge first = surface_.outOf(best);
    VertexIndex higher = best;
    HalfEdge h = first;
    do {
      const VertexIndex candidate = surface_.end(h);
      const double value = along(candidate);
      if (value > most) {
        most = value;
        higher = candidate;
      }
      h = surface_.turn(h);
    } while (h != first);
    if (higher != best) {
      best = higher;
      continue;
    }
    // The edges of a vertex span the cone in which the hull lies, so that nothing is higher. That is not so within a
    // flat face that looks the other way; then, and only then, is this place lower than s.
    if (most > 0.0) return best;
    return std::accumulate(vertices_.begin(), vertices_.end(), best, higherOf);
  }
}

bool MovingHull::repair() {
  // Faces that lost their side come first: all else takes for granted that s sees the whole surface from inside.
  constexpr int kRounds = 8;
  scanFaces();
  for (int round = 0; !scratch_->turned.empty(); ++round) {
    if (round == kRounds || !turnFaces()) return false;
    lookAgain();
  }
  // All faces may look outwards on a surface that winds round s twice, like a star pentagon.
  if (scratch_->pierced.size() != 1) return false;
  return legalise() && checkCertificates();
}

bool MovingHull::build() {
  counts_.rebuilds = 1;
  const std::span<const Triangle> first = scratch_->start.find(points_);
  if (first.empty()) return false;

  // Last frame's vertices are likely to be vertices again, and then the others are inside at once.
  scratch_->unsettled.clear();
  for (const VertexIndex p : scrambled_) {
    if (isVertex(p)) scratch_->unsettled.push_back(p);
  }
  for (const VertexIndex p : scrambled_) {
    if (!isVertex(p)) scratch_->unsettled.push_back(p);
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
  for (const VertexIndex p : scrambled_) {
    if (isVertex(p)) becomeVertex(p);
  }
  return settleAll();
}

// Leaves no faces and no vertices. Certificates stay: they hold nothing now, but tell where to look.
void MovingHull::startOver() {
  surface_.clear();
  while (!scratch_->queue.empty()) {
    scratch_->queued[static_cast<std::size_t>(scratch_->queue.back())] = 0;
    scratch_->queue.pop_back();
  }
  while (!vertices_.empty()) {
    const VertexIndex v = vertices_.back();
    becomeInside(v, {v, v, v});
  }
}

double MovingHull::faceDet(std::int32_t face) const {
  const Triangle& t = surface_.faces()[static_cast<std::size_t>(face)];
  return det(at(t[0]), at(t[1]), at(t[2]));
}

// Each flip adds volume to the solid and each vertex that is taken out stays out, so this ends.
bool MovingHull::legalise() {
  while (!scratch_->queue.empty()) {
    const HalfEdge h = scratch_->queue.back();
    scratch_->queue.pop_back();
    scratch_->queued[static_cast<std::size_t>(h)] = 0;
    if (h >= 3 * surface_.faceCount()) continue;
    const HalfEdge k = surface_.twin(h);
    const VertexIndex a = surface_.start(h), b = surface_.end(h), c = surface_.apex(h), d = surface_.apex(k);
    if (side(at(a), at(b), at(c), at(d)) <= 0.0) continue;
    // Seen from s, the quadrilateral a d b c has at most one corner that is not convex, a or b: with s and the other
    // three corners as a tetrahedron, the edge would be convex if both were.
    if (det(at(a), at(d), at(c)) <= 0.0) {
      if (!takeOut(a, Link::kSeenFromVertex, {d, b, c})) return false;
    } else if (det(at(d), at(b), at(c)) <= 0.0) {
      if (!takeOut(b, Link::kSeenFromVertex, {a, d, c})) return false;
    } else {
      surface_.flip(h);
      ++counts_.flips;
      const std::int32_t f = HullSurface::faceOf(h);
      const std::int32_t g = HullSurface::faceOf(k);
      for (const HalfEdge outer : {3 * f, 3 * f + 2, 3 * g, 3 * g + 1}) queueEdge(outer);
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
  const int found =
      findDoubtfulCertificates(points_.data(), inside_.data(), static_cast<int>(insideCount_), scratch_->doubts.data());
  for (const std::int32_t doubt : std::span(scratch_->doubts).first(static_cast<std::size_t>(found))) {
    const HullCertificate& certificate = inside_[static_cast<std::size_t>(doubt)];
    if (!holds(certificate)) scratch_->unsettled.push_back(certificate.point);
  }
  counts_.failedCertificates = static_cast<int>(scratch_->unsettled.size());
  return settleAll();
}

bool MovingHull::settleAll() {
  return std::all_of(scratch_->unsettled.begin(), scratch_->unsettled.end(),
                     [&](VertexIndex p) { return isVertex(p) || settle(p); });
}

// A face that may be near a point.
std::int32_t MovingHull::hintFor(VertexIndex p) const {
  const HullCertificate& last = inside_[static_cast<std::size_t>(slot_[static_cast<std::size_t>(p)])];
  for (const VertexIndex v : {last.a, last.b, last.c}) {
    if (isVertex(v)) return HullSurface::faceOf(surface_.outOf(v));
  }
  // Of a few vertices, that whose direction is nearest, or about so.
  constexpr std::size_t kTries = 12;
  const std::size_t step = 1 + vertices_.size() / kTries;
  const PointRow& q = at(p);
  const auto towards = [&](VertexIndex v) { return at(v).x * q.x + at(v).y * q.y + at(v).z * q.z; };
  VertexIndex nearest = vertices_.front();
  for (std::size_t i = step; i < vertices_.size(); i += step) {
    if (towards(vertices_[i]) > towards(nearest)) nearest = vertices_[i];
  }
  return HullSurface::faceOf(surface_.outOf(nearest));
}

// Gives a point a new certificate, or makes it a vertex where it is outside.
bool MovingHull::settle(VertexIndex p) {
  const Place place = locate(p, hintFor(p));
  const Triangle t = faces()[static_cast<std::size_t>(place.face)];
  if (side(at(t[0]), at(t[1]), at(t[2]), at(p)) <= 0.0) {
    inside_[static_cast<std::size_t>(slot_[static_cast<std::size_t>(p)])] = {t[0], t[1], t[2], p};
    return true;
  }
  ++counts_.insertions;
  becomeVertex(p);
  const int zeros = (place.ab == 0.0) + (place.bc == 0.0) + (place.ca == 0.0);
  const HalfEdge first = 3 * place.face;
  if (zeros == 0) {
    surface_.splitFace(place.face, p);
  } else if (zeros == 1) {
    surface_.splitEdge(place.ab == 0.0 ? first : place.bc == 0.0 ? first + 1 : first + 2, p);
  } else {
    // Straight above a corner, which goes inside: it lies between s and p.
    const VertexIndex v = place.ab != 0.0 ? t[2] : place.bc != 0.0 ? t[0] : t[1];
    surface_.replaceVertex(v, p);
    const Triangle& over = faces()[static_cast<std::size_t>(place.face)];
    becomeInside(v, over);
  }
  // Edges at a point that was put on top of a face or an edge are convex; at one on top of a vertex they need not be.
  const HalfEdge out = surface_.outOf(p);
  HalfEdge h = out;
  do {
    queueEdge(HullSurface::next(h));
    if (zeros == 2) queueEdge(h);
    h = surface_.turn(h);
  } while (h != out);
  return legalise();
}

// Walks from face to face towards the point's direction. On a convex surface each step reaches a plane that the ray
// from s meets earlier, so only coplanar faces could make it turn in a circle; then all faces are looked at.
MovingHull::Place MovingHull::locate(VertexIndex p, std::int32_t hint) const {
  const PointRow& point = at(p);
  const auto edge = [&](HalfEdge h) { return det(at(surface_.start(h)), at(surface_.end(h)), point); };
  std::array<double, 3> beside{};
  HalfEdge first = 3 * hint;
  double besideFirst = edge(first);
  const auto cross = [&](HalfEdge h, double besideIt) {
    first = surface_.twin(h);
    besideFirst = -besideIt;
  };
  if (besideFirst < 0.0) cross(first, besideFirst);
  for (int step = 0; step < surface_.faceCount(); ++step) {
    const HalfEdge second = HullSurface::next(first);
    const double besideSecond = edge(second);
    if (besideSecond < 0.0) {
      cross(second, besideSecond);
      continue;
    }
    const HalfEdge third = HullSurface::next(second);
    const double besideThird = edge(third);
    if (besideThird < 0.0) {
      cross(third, besideThird);
      continue;
    }
    const std::int32_t face = HullSurface::faceOf(first);
    beside[static_cast<std::size_t>(first - 3 * face)] = besideFirst;
    beside[static_cast<std::size_t>(second - 3 * face)] = besideSecond;
    beside[static_cast<std::size_t>(third - 3 * face)] = besideThird;
    return {face, beside[0], beside[1], beside[2]};
  }
  for (std::int32_t face = 0; face < surface_.faceCount(); ++face) {
    for (std::size_t i = 0; i < 3; ++i) beside[i] = edge(3 * face + static_cast<HalfEdge>(i));
    if (beside[0] >= 0.0 && beside[1] >= 0.0 && beside[2] >= 0.0) return {face, beside[0], beside[1], beside[2]};
  }
  CHECK(false, "the faces of a star-shaped surface cover all directions");
  return {};
}

// Takes a point from its place in inside_; the surface must hold it.
void MovingHull::becomeVertex(VertexIndex p) {
  std::int32_t& slot = slot_[static_cast<std::size_t>(p)];
  const HullCertificate last = inside_[--insideCount_];
  inside_[static_cast<std::size_t>(slot)] = last;
  slot_[static_cast<std::size_t>(last.point)] = slot;
  slot = static_cast<std::int32_t>(vertices_.size());
  vertices_.push_back(p);
}

// Takes a point from its place in vertices_.
void MovingHull::becomeInside(VertexIndex p, const Triangle& certificate) {
  std::int32_t& slot = slot_[static_cast<std::size_t>(p)];
  const VertexIndex last = vertices_.back();
  vertices_[static_cast<std::size_t>(slot)] = last;
  slot_[static_cast<std::size_t>(last)] = slot;
  vertices_.pop_back();
  slot = static_cast<std::int32_t>(insideCount_);
  inside_[insideCount_++] = {certificate[0], certificate[1], certificate[2], p};
}

void MovingHull::queueEdge(HalfEdge h) {
  h = std::min(h, surface_.twin(h));
  std::uint8_t& queued = scratch_->queued[static_cast<std::size_t>(h)];
  if (queued != 0) return;
  queued = 1;
  scratch_->queue.push_back(h);
}

void MovingHull::queueFace(std::int32_t face) {
  for (HalfEdge h = 3 * face; h < 3 * face + 3; ++h) queueEdge(h);
}

}  // namespace lorica
