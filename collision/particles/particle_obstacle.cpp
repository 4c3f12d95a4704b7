#include "collision/particles/particle_obstacle.h"
#include "geometry/threads.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kFastestPart = 25.0;  // as in World [m/s]
constexpr double kOutside = 1e-5;      // distance beyond a surface after leaving along a ray [m]
constexpr std::size_t kTouchesAtOnce = 64;

void extend(ParticleObstacle::Sweep& bounds, const LivePart& part, const Isometry3& worldFromPart) {
  for (const Vec3& v : part.shape.vertices) {
    const Vec3f p = (worldFromPart * v).cast<float>();
    for (std::size_t i = 0; i < 3; ++i) {
      bounds.min[i] = std::min(bounds.min[i], p[i]);
      bounds.max[i] = std::max(bounds.max[i], p[i]);
    }
  }
}

constexpr ParticleObstacle::Sweep kNowhere{{1e9f, 1e9f, 1e9f}, {-1e9f, -1e9f, -1e9f}, false};

}  // namespace

Isometry3 between(const Isometry3& from, const Isometry3& to, double fraction) {
  const Quat a(from.linear());
  Quat b(to.linear());
  if (a.dot(b) < 0.0) b.coeffs() = -b.coeffs();
  Quat turned;
  turned.coeffs() = (1.0 - fraction) * a.coeffs() + fraction * b.coeffs();
  turned.normalize();
  Isometry3 result = Isometry3::Identity();
  result.linear() = turned.toRotationMatrix();
  result.translation() = (1.0 - fraction) * from.translation() + fraction * to.translation();
  return result;
}

ParticleRoom particleRoom(bool floor, const std::optional<Aabb>& walls, double radius) {
  ParticleRoom room;
  const float away = radius;
  if (floor) room.min.y() = away;
  if (walls) {
    for (const Eigen::Index axis : {0, 2}) {
      room.min[axis] = static_cast<float>(walls->min[axis]) + away;
      room.max[axis] = std::max(room.min[axis], static_cast<float>(walls->max[axis]) - away);
    }
  }
  return room;
}

ParticleObstacle::ParticleObstacle(double radius)
    : radius_(radius), push_(ParticlePush::create({.radius = radius}).value()) {}

void ParticleObstacle::begin(std::span<const LivePart> parts, double seconds, int substeps) {
  substeps_ = substeps;
  done_ = 0;
  substepSeconds_ = seconds / substeps;
  parts_.resize(parts.size());
  motions_.resize(parts.size());
  sweeps_.clear();
  sweeps_.reserve(parts.size());
  faces_.clear();
  planes_.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    LivePart& own = parts_[i];
    const LivePart& part = parts[i];
    // Copies only what is needed: the previous frame's data is not used here.
    own.shape.vertices.assign(part.shape.vertices.begin(), part.shape.vertices.end());
    own.shape.triangles.assign(part.shape.triangles.begin(), part.shape.triangles.end());
    if (!part.worldFromPart.matrix().allFinite() || !part.previousWorldFromPart.matrix().allFinite()) {
      own.shape.vertices.clear();
      own.shape.triangles.clear();
      motions_[i] = Motion();
      faces_.emplace_back();
      continue;
    }
    takeFaces(part);
    own.reshaped = part.reshaped;
    own.trust = part.trust;
    Motion& motion = motions_[i];
    motion.from = part.previousWorldFromPart;
    motion.to = part.worldFromPart;
    const double way = (motion.to.translation() - motion.from.translation()).norm();
    if (way > kFastestPart * seconds) motion.from = motion.to;
    own.worldFromPart = motion.from;
    Sweep sweep = kNowhere;
    sweep.moves = part.reshaped || part.worldFromPart.matrix() != part.previousWorldFromPart.matrix();
    extend(sweep, part, part.previousWorldFromPart);
    extend(sweep, part, motion.to);
    if (sweep.min[0] <= sweep.max[0]) sweeps_.push_back(sweep);
  }
}

void ParticleObstacle::takeFaces(const LivePart& part) {
  Faces& faces = faces_.emplace_back();
  faces.first = planes_.size();
  for (const Triangle& t : part.shape.triangles) {
    const Vec3 area = areaNormal(part.shape.vertices, t);
    const double length = area.norm();
    if (!(length > 1e-12)) continue;
    const Vec3 normal = area / length;
    planes_.push_back({normal, normal.dot(part.shape.vertices[t[0]]) + radius_});
  }
  faces.end = planes_.size();
  for (const Vec3& v : part.shape.vertices) faces.box.extend(v);
}

void ParticleObstacle::advance(int substep) {
  const double fraction = static_cast<double>(substep + 1) / substeps_;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    LivePart& part = parts_[i];
    part.previousWorldFromPart = part.worldFromPart;
    part.worldFromPart =
        substep + 1 == substeps_ ? motions_[i].to : between(motions_[i].from, motions_[i].to, fraction);
  }
  push_.prepare(parts_, (substep + 1 - done_) * substepSeconds_, done_ > 0);
  done_ = substep + 1;
}

std::span<const ParticleTouch> ParticleObstacle::push(std::span<Vec3f> positions, const ParticleRoom& room) {
  const std::span<const ParticleTouch> touches = push_.push(positions);
  parallelRanges(touches.size(), kTouchesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Vec3f& position = positions[touches[t].particle];
      const Vec3f inRoom = room.nearest(position);
      if (inRoom != position) position = wayOut(inRoom, room);
    }
  });
  return touches;
}

/// Length of a ray from inside a part to the outside; 0 if it starts outside.
double ParticleObstacle::exitOf(const Faces& faces, const Vec3& from, const Vec3& along) const {
  if (((from - faces.box.min).array() < -radius_).any() || ((from - faces.box.max).array() > radius_).any()) return 0.0;
  double exit = 1e9;
  for (std::size_t p = faces.first; p < faces.end; ++p) {
    const Plane& plane = planes_[p];
    const double depth = plane.offset - plane.normal.dot(from);
    if (depth <= 0.0) return 0.0;
    const double rate = plane.normal.dot(along);
    if (rate * exit > depth) exit = depth / rate;
  }
  return exit;
}

// A ray leaves a convex hull only once, so following it out of one hull after the other ends outside of all of them.
Vec3f ParticleObstacle::wayOut(const Vec3f& position, const ParticleRoom& room) const {
  static constexpr std::array<std::array<double, 3>, 21> kWays{
      {{0, 1, 0},       {1, 0, 0},      {-1, 0, 0},      {0, 0, 1},     {0, 0, -1},     {0.6, 0, 0.8},
       {0.6, 0, -0.8},  {-0.6, 0, 0.8}, {-0.6, 0, -0.8}, {0.8, 0, 0.6}, {0.8, 0, -0.6}, {-0.8, 0, 0.6},
       {-0.8, 0, -0.6}, {0.6, 0.8, 0},  {-0.6, 0.8, 0},  {0, 0.8, 0.6}, {0, 0.8, -0.6}, {0.8, 0.6, 0},
       {-0.8, 0.6, 0},  {0, 0.6, 0.8},  {0, 0.6, -0.8}}};
  const Vec3 from = position.cast<double>();
  double shortest = 1e9;
  Vec3 best = from;
  for (const std::array<double, 3>& way : kWays) {
    const Vec3 direction(way[0], way[1], way[2]);
    double length = 0.0;
    bool inside = true;
    for (std::size_t round = 0; inside && round <= parts_.size() && length < shortest; ++round) {
      inside = false;
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (faces_[i].first == faces_[i].end) continue;
        const Isometry3& worldFromPart = parts_[i].worldFromPart;
        const Mat3 turn = worldFromPart.linear().transpose();
        const Vec3 at = turn * (from + length * direction - worldFromPart.translation());
        const double exit = exitOf(faces_[i], at, turn * direction);
        if (exit == 0.0) continue;
        length += exit + kOutside;
        inside = true;
      }
    }
    if (length >= shortest) continue;
    const Vec3 end = from + length * direction;
    const Vec3f rounded = end.cast<float>();
    if (rounded != room.nearest(rounded)) continue;
    shortest = length;
    best = end;
  }
  return best.cast<float>();
}

}  // namespace lorica
