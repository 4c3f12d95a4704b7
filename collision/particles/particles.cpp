#include "collision/particles/particles.h"

#include "collision/particles/fluid.h"
#include "collision/particles/granular.h"
#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "geometry/result.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kApart = 1.02;  // spacing of new particles, in diameters
constexpr double kJitter = 0.02;
constexpr std::uint64_t kSeed = 20;
constexpr double kSettlingFrame = 1.0 / 30.0;

/// How many particles a box takes: along each axis, and in total.
struct Lattice {
  std::array<int, 3> counts{};
  int count = 0;
};

Lattice latticeIn(const ParticleSettings& settings, const ParticleSettings::Fill& fill) {
  Lattice lattice;
  const double step = 2.0 * settings.radius * kApart;
  double count = 1.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double along = std::clamp(std::floor(fill.size[axis] / step), 1.0, 1e5);
    lattice.counts[axis] = along;
    count *= along;
  }
  lattice.count = std::min<double>(count, fill.max);
  return lattice;
}

std::size_t countOf(const ParticleSettings& settings) {
  std::size_t count = 0;
  for (const ParticleSettings::Fill& fill : settings.fills) {
    count += latticeIn(settings, fill).count;
  }
  for (const ParticleSettings::Pour& pour : settings.pours) count += std::max(pour.count, 0);
  return std::clamp<std::size_t>(count, 1, kMaxParticles);
}

/// So that particles that are released one after the other are everywhere on the disc.
void shuffle(std::vector<Vec3f>& disc) {
  RandomNumbers random(kSeed);
  for (std::size_t i = disc.size(); i > 1; --i) std::swap(disc[i - 1], disc[random.bits() % i]);
}

}  // namespace

Particles::Particles(const ParticleSettings& settings, std::unique_ptr<ParticleSimulation> simulation)
    : settings_(settings), simulation_(std::move(simulation)) {}
Particles::~Particles() = default;
Particles::Particles(Particles&&) noexcept = default;
Particles& Particles::operator=(Particles&&) noexcept = default;

Result<Particles> Particles::create(const ParticleSettings& settings, std::span<const ParticleBody> bodies) {
  LORICA_TRY_DO(checkAboveZero("particle radius", settings.radius));
  for (const ParticleSettings::Pour& pour : settings.pours) {
    LORICA_TRY_DO(checkAboveZero("radius of a pour", pour.radius));
  }
  const std::size_t capacity = countOf(settings);
  std::unique_ptr<ParticleSimulation> simulation;
  if (settings.kind == ParticleSettings::Kind::kSand) {
    GranularSettings sand;
    sand.capacity = capacity;
    sand.radius = settings.radius;
    sand.friction = settings.friction;
    sand.gravity = settings.gravity;
    sand.floor = settings.floor;
    sand.walls = settings.walls;
    LORICA_TRY(Granular grains, Granular::create(sand));
    simulation = std::make_unique<Granular>(std::move(grains));
  } else {
    FluidSettings water;
    water.capacity = capacity;
    water.spacing = 2.0 * settings.radius;
    water.viscosity = settings.viscosity;
    water.gravity = settings.gravity;
    water.floor = settings.floor;
    water.walls = settings.walls;
    LORICA_TRY(Fluid fluid, Fluid::create(water));
    simulation = std::make_unique<Fluid>(std::move(fluid));
  }
  Particles made(settings, std::move(simulation));
  made.added_.reserve(capacity);
  for (const ParticleSettings::Fill& box : settings.fills) made.fill(box, bodies);
  made.sources_.resize(settings.pours.size());
  for (std::size_t i = 0; i < made.sources_.size(); ++i) {
    const double step = 2.0 * settings.radius * kApart, radius = settings.pours[i].radius;
    const int max = std::min(radius / step, 200.0);
    for (int z = -max; z <= max; ++z) {
      for (int x = -max; x <= max; ++x) {
        if (x * x + z * z > max * max) continue;
        made.sources_[i].disc.emplace_back(static_cast<float>(x * step), 0.0f, static_cast<float>(z * step));
      }
    }
    shuffle(made.sources_[i].disc);
  }
  return made;
}

void Particles::fill(const ParticleSettings::Fill& fill, std::span<const ParticleBody> bodies) {
  const Lattice lattice = latticeIn(settings_, fill);
  const double step = 2.0 * settings_.radius * kApart;
  RandomNumbers random(kSeed);
  added_.clear();
  for (int i = 0; i < lattice.count; ++i) {
    const int x = i % lattice.counts[0], z = i / lattice.counts[0] % lattice.counts[2];
    const int y = i / lattice.counts[0] / lattice.counts[2];
    Vec3 position = step * Vec3(x - 0.5 * (lattice.counts[0] - 1), y - 0.5 * (lattice.counts[1] - 1),
                                z - 0.5 * (lattice.counts[2] - 1));
    // Exactly stacked grains would stand as columns.
    for (Eigen::Index axis = 0; axis < 3; ++axis) position[axis] += kJitter * step * random.between(-0.5, 0.5);
    added_.push_back((fill.middle + position).cast<float>());
  }
  // Each body looks at the places around it: all pairs of 300,000 places and 2,000 bodies would take half a minute.
  std::vector<std::uint8_t> taken(added_.size());
  for (const ParticleBody& body : bodies) {
    const Isometry3& pose = body.from.worldFromBody;
    const Vec3 far = extentOf(body, pose.linear().transpose().cast<float>()).cast<double>() +
                     Vec3::Constant(settings_.radius + kJitter * step);
    std::array<int, 3> first{}, last{};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double middle = (pose.translation()[axis] - fill.middle[axis]) / step + 0.5 * (lattice.counts[axis] - 1);
      const double end = lattice.counts[axis];
      first[axis] = std::clamp(std::floor(middle - far[axis] / step), 0.0, end);
      last[axis] = std::clamp(std::ceil(middle + far[axis] / step) + 1.0, 0.0, end);
    }
    const auto rowAt = [&](int y, int z) { return (std::size_t(y) * lattice.counts[2] + z) * lattice.counts[0]; };
    for (int y = first[1]; y < last[1] && rowAt(y, 0) < taken.size(); ++y) {
      for (int z = first[2]; z < last[2] && rowAt(y, z) < taken.size(); ++z) {
        const std::size_t row = rowAt(y, z);
        for (std::size_t i = row + first[0]; i < std::min(row + last[0], taken.size()); ++i) {
          if (taken[i] == 0 && isWithin(body, added_[i], static_cast<float>(settings_.radius))) taken[i] = 1;
        }
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i] == 0) added_[kept++] = added_[i];
  }
  added_.resize(kept);
  simulation_->add(added_, Vec3::Zero());
}

void Particles::pour(std::size_t index, double seconds) {
  const ParticleSettings::Pour& pour = settings_.pours[index];
  Source& source = sources_[index];
  const double waiting = source.due;  // of the next particle: the part of it that was due before
  source.due = std::min<double>(source.due + pour.rate * seconds, pour.count - source.poured);
  const int count = source.due;
  if (count <= 0) return;
  source.due -= count;
  const double layer = 2.0 * settings_.radius * kApart;
  RandomNumbers random(kSeed + source.poured);
  const auto positions = countOf(source.disc);
  // Evenly in time. A particle that is released later in the frame begins it where it falls to the disc from: a frame's
  // particles are thus as far from each other, and from those of other frames, as the speed at any height asks for.
  for (int i = 0; i < count; ++i) {
    const double later = (i + 1 - waiting) / pour.rate;
    Vec3 offset = source.disc[(source.poured + i) % positions].cast<double>();
    offset.x() += layer * kJitter * random.between(-0.5, 0.5);
    offset.z() += layer * kJitter * random.between(-0.5, 0.5);
    offset += -later * pour.velocity + 0.5 * later * later * settings_.gravity;
    const int below = i / positions;  // layers that are full
    if (below > 0) offset.y() = std::max(offset.y(), layer * below);
    const Vec3f position = (pour.middle + offset).cast<float>();
    simulation_->add(std::span(&position, 1), pour.velocity - later * settings_.gravity);
  }
  source.poured += count;
}

void Particles::move(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  for (std::size_t i = 0; i < sources_.size(); ++i) pour(i, seconds);
  simulation_->step(parts, seconds, bodies);
}

bool Particles::settle(std::span<const LivePart> parts, std::span<const ParticleBody> bodies) {
  if (settled()) return true;
  settled_ = true;
  std::vector<LivePart> still(parts.begin(), parts.end());
  for (LivePart& part : still) {
    part.previousWorldFromPart = part.worldFromPart;
    part.reshaped = false;
  }
  std::vector<ParticleBody> held(bodies.begin(), bodies.end());
  for (ParticleBody& body : held) {
    body.from.velocity = body.from.angularVelocity = body.inverseInertia = Vec3::Zero();
    body.to = body.from;
    body.inverseMass = 0.0;
  }
  const int frames = std::ceil(settings_.settleSeconds / kSettlingFrame - 1e-6);
  for (int frame = 1; frame <= frames; ++frame) {
    move(still, kSettlingFrame, held);
    if (settlingWatch_ && !settlingWatch_(frame, frames)) return false;
  }
  return true;
}

void Particles::step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  if (settle(parts, bodies)) move(parts, seconds, bodies);
}

std::span<const Vec3f> Particles::positions() const {
  return simulation_->positions();
}

std::span<const Vec3f> Particles::velocities() const {
  return simulation_->velocities();
}

}  // namespace lorica
