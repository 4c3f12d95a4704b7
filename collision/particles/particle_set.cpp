#include "collision/particles/particle_set.h"

#include "geometry/errors.h"
#include "geometry/result.h"

#include <algorithm>
#include <cmath>

namespace lorica {

Result<void> checkAboveZero(std::string_view what, double value) {
  if (value > 0.0 && std::isfinite(value)) return {};
  return invalidArgument("particles: {}: found {:g}, expected a number above 0", what, value);
}

ParticleSet::ParticleSet(std::size_t capacity, const ParticleRoom& bounds, double radius, int maxNeighbours)
    : room(bounds),
      position(paddedCount(capacity)),
      motion(position.size()),
      nextPosition(position.size()),
      nextMotion(position.size()),
      id(capacity),
      nextId(capacity),
      x(position.size()),
      y(position.size()),
      z(position.size()),
      nearBody(capacity),
      grid(capacity),
      lists(capacity, maxNeighbours),
      body(radius),
      positions(capacity),
      velocities(capacity) {
  candidates.reserve(capacity);
  candidateOf.reserve(capacity);
}

std::size_t ParticleSet::add(std::span<const Vec3f> given, const Vec3f& ownMotion, const Vec3f& velocity) {
  const std::size_t before = count;
  for (const Vec3f& wanted : given) {
    if (count == positions.size()) break;
    if (!wanted.allFinite()) continue;
    const std::size_t i = count++;
    positions[i] = room.nearest(wanted);
    velocities[i] = velocity;
    position[i] = rowOf(positions[i]);
    motion[i] = rowOf(ownMotion);
    id[i] = i;
  }
  return count - before;
}

ParticleSet::Substeps ParticleSet::beginFrame(std::span<const LivePart> parts, std::span<ParticleBody> bodies,
                                              double seconds, double maxSubstepSeconds) {
  LORICA_CHECK(seconds > 0.0 && std::isfinite(seconds), "the length of a particle step must be finite and above 0");
  Substeps substeps;
  substeps.count = std::max(1, static_cast<int>(std::ceil(seconds / maxSubstepSeconds - 1e-6)));
  substeps.seconds = seconds / substeps.count;
  body.begin(parts, seconds, substeps.count);
  rigid.begin(bodies, seconds, substeps.count);
  return substeps;
}

void ParticleSet::endFrame(std::span<ParticleBody> bodies) {
  rigid.finish();
  for (ParticleBody& met : bodies) {
    if (!met.pushed) continue;
    Isometry3& to = met.to.worldFromBody;
    const Vec3 half = extentOf(met, to.linear().transpose().cast<float>()).cast<double>();
    for (const Eigen::Index axis : {0, 2}) {
      const double from = met.from.worldFromBody.translation()[axis], low = room.min[axis], high = room.max[axis];
      if (from < low || from > high) continue;
      double &place = to.translation()[axis], &speed = met.to.velocity[axis];
      const double held = std::clamp(place, std::min(from, low + half[axis]), std::max(from, high - half[axis]));
      if (held != place) speed = held > place ? std::max(speed, 0.0) : std::min(speed, 0.0);
      place = held;
    }
  }
}

bool ParticleSet::markAround(Parts which, float margin, std::vector<std::uint8_t>& flags) const {
  bool any = false;
  for (ParticleObstacle::Sweep box : body.sweeps()) {
    if (which == Parts::kMoving && !box.moves) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.min[axis] -= margin;
      box.max[axis] += margin;
    }
    grid.visitRuns(box.min, box.max, [&](std::uint32_t first, std::uint32_t last) {
      std::fill(flags.begin() + first, flags.begin() + last, std::uint8_t{1});
      any = true;
    });
  }
  return any;
}

void ParticleSet::publish(float motionSeconds) {
  forEach([&](std::size_t i) {
    positions[id[i]] = vectorOf(position[i]);
    velocities[id[i]] = vectorOf(motion[i]) / motionSeconds;
  });
}

}  // namespace lorica
