#include "collision/particles/fluid.h"

#include "collision/particles/particle_ranges.h"
#include "geometry/result.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr double kReach = 1.7;       // of the kernels, in spacings
constexpr int kSubstepsPerSort = 2;  // during which lists of neighbours stay valid
constexpr float kListed = 1.06f;     // reach of the lists, as a multiple of the kernels'
constexpr int kSubstepsPerPush = 2;
constexpr int kRows = 3;               // of the grid: a run has a dozen particles, which fills most of a vector
constexpr int kMaxNeighbours = 64;     // at rest there are 18 to 30
constexpr double kSoftening = 0.02;    // of the sum of squared slopes at rest
constexpr float kRelaxation = 0.7f;    // fraction of the density error that a pressure corrects
constexpr float kKeptPressure = 0.6f;  // fraction kept from one substep to the next
constexpr float kLongestMove = 0.25f;  // of an iteration, in spacings
constexpr float kFastest = 5.0f;       // max motion in a substep, in spacings

/// Density 1 for particles on a cubic lattice.
FluidKernels makeKernels(double spacing) {
  const double reach = kReach * spacing;
  double sum = 0.0, squares = 0.0, behind = 0.0, slopeBehind = 0.0;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        const double r = spacing * std::sqrt(static_cast<double>(x * x + y * y + z * z));
        if (r >= reach) continue;
        const double left = reach * reach - r * r;
        sum += left * left * left;
        if (r > 0.0) squares += std::pow(reach - r, 4.0);
        if (y >= 0) continue;
        behind += left * left * left;
        slopeBehind -= (reach - r) * (reach - r) * y * spacing / r;
      }
    }
  }
  const double density = 1.0 / sum;
  // The slopes are those of a sharper kernel with the same integral that does not vanish where particles are close: the
  // factors are 315 / (64 pi reach^9) for the first, 45 / (pi reach^6) for the second.
  const double slope = density * (45.0 * 64.0 / 315.0) * reach * reach * reach;
  // A wall is half a spacing from the outermost particles, and counts as much fluid as the lattice would have there.
  const double q = 1.0 - 0.5 / kReach;
  const double wall = std::pow(q, 5.0) * (16.0 / 5.0 - q * (16.0 / 3.0 - q * (24.0 / 7.0 - q * (1.0 - q / 9.0))));
  const double wallSlope = std::pow(q, 4.0) * (1.0 / 6.0 - 2.0 / 15.0 * q);
  return {.reach = static_cast<float>(reach),
          .density = static_cast<float>(density),
          .ownDensity = static_cast<float>(density * std::pow(reach, 6.0)),
          .slope = static_cast<float>(slope),
          .relaxation = kRelaxation,
          .softening = static_cast<float>(kSoftening * slope * slope * squares),
          .wallDensity = static_cast<float>(density * behind / wall),
          .wallSlope = static_cast<float>(slope * slopeBehind / wallSlope),
          .min = {},
          .max = {}};
}

}  // namespace

Fluid::Fluid(const FluidSettings& settings)
    : settings_(settings),
      room_(particleRoom(settings.floor, settings.walls, 0.5 * settings.spacing)),
      spacing_(static_cast<float>(settings.spacing)),
      kernels_(makeKernels(settings.spacing)),
      position_(paddedCount(settings.capacity)),
      before_(position_.size()),
      motion_(position_.size()),
      nextPosition_(position_.size()),
      nextMotion_(position_.size()),
      id_(settings.capacity),
      nextId_(settings.capacity),
      x_(position_.size()),
      y_(position_.size()),
      z_(position_.size()),
      pressure_(position_.size()),
      nextPressure_(position_.size()),
      none_(position_.size()),
      nearBody_(settings.capacity),
      grid_(settings.capacity),
      lists_(settings.capacity, kMaxNeighbours),
      body_(0.5 * settings.spacing),
      positions_(settings.capacity),
      velocities_(settings.capacity) {
  LORICA_CHECK(settings.spacing > 0.0 && settings.substepSeconds > 0.0 && settings.iterations > 0,
               "particle spacing, substep length and iterations must be above 0");
  candidates_.reserve(settings.capacity);
  candidateOf_.reserve(settings.capacity);
  const float half = 0.5f * spacing_;
  kernels_.min = {room_.min.x() - half, room_.min.y() - half, room_.min.z() - half, 0.0f};
  kernels_.max = {room_.max.x() + half, room_.max.y() + half, room_.max.z() + half, 0.0f};
}

std::size_t Fluid::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  const std::size_t before = count_;
  const Vec3f speed = velocity.cast<float>();
  for (const Vec3f& given : positions) {
    if (count_ == settings_.capacity) break;
    if (!given.allFinite()) continue;
    const Vec3f position = given.cwiseMax(room_.min).cwiseMin(room_.max);
    const std::size_t i = count_++;
    position_[i] = {position.x(), position.y(), position.z(), 0.0f};
    motion_[i] = {speed.x(), speed.y(), speed.z(), 0.0f};
    id_[i] = static_cast<std::uint32_t>(i);
    pressure_[i] = 0.0f;
    positions_[i] = position;
    velocities_[i] = speed;
  }
  return count_ - before;
}

void Fluid::step(std::span<const LivePart> parts, double seconds) {
  LORICA_CHECK(seconds > 0.0 && std::isfinite(seconds), "the length of a fluid step must be finite and above 0");
  if (count_ == 0) return;
  const int substeps = std::max(1, static_cast<int>(std::ceil(seconds / settings_.substepSeconds - 1e-6)));
  const auto length = static_cast<float>(seconds / substeps);
  body_.begin(parts, seconds, substeps);
  for (int substep = 0; substep < substeps; ++substep) {
    predict(length, substep % kSubstepsPerSort == 0);
    keepVolume(length);
    forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        motion_[i] = {(position_[i].x - before_[i].x) / length, (position_[i].y - before_[i].y) / length,
                      (position_[i].z - before_[i].z) / length, 0.0f};
      }
    });
    const std::size_t blocks = (count_ + kParticleBlock - 1) / kParticleBlock;
    forRanges(blocks, kParticlesAtOnce / kParticleBlock, [&](std::size_t begin, std::size_t end) {
      blendMotions(kernels_, position_.data(), motion_.data(), lists_, static_cast<float>(settings_.viscosity), begin,
                   end, nextMotion_.data());
    });
    std::swap(motion_, nextMotion_);
    // The body is applied in every second substep and in the last.
    if ((substeps - substep) % kSubstepsPerPush == 1) {
      body_.advance(substep);
      pushOut(length);
    }
  }
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      positions_[id_[i]] = Vec3f(position_[i].x, position_[i].y, position_[i].z);
      velocities_[id_[i]] = Vec3f(motion_[i].x, motion_[i].y, motion_[i].z);
    }
  });
}

// Applies gravity and moves the particles. In every second substep, sorts them by their new positions and finds their
// neighbours there.
void Fluid::predict(float seconds, bool sorts) {
  const Vec3f fall = settings_.gravity.cast<float>() * seconds;
  const float fastest = kFastest * spacing_ / seconds;
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f speed = Vec3f(motion_[i].x, motion_[i].y, motion_[i].z) + fall;
      const float length = std::sqrt(speed.x() * speed.x() + speed.y() * speed.y() + speed.z() * speed.z());
      const float rate = length > fastest ? fastest / length * seconds : seconds;
      const Vec3f to = (Vec3f(position_[i].x, position_[i].y, position_[i].z) + rate * speed)
                           .cwiseMax(room_.min)
                           .cwiseMin(room_.max);
      nextPosition_[i] = {to.x(), to.y(), to.z(), 0.0f};
    }
  });
  if (!sorts) {
    std::swap(before_, position_);
    std::swap(position_, nextPosition_);
    return;
  }
  const float listed = kListed * kernels_.reach;
  grid_.sort({nextPosition_.data(), count_}, listed, kRows);
  const std::uint32_t* order = grid_.order().data();
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ParticleRow& to = nextPosition_[order[i]];
      x_[i] = to.x;
      y_[i] = to.y;
      z_[i] = to.z;
      before_[i] = position_[order[i]];
      nextId_[i] = id_[order[i]];
      nextPressure_[i] = pressure_[order[i]];
    }
  });
  std::swap(id_, nextId_);
  std::swap(pressure_, nextPressure_);
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) position_[i] = {x_[i], y_[i], z_[i], 0.0f};
  });
  lists_.build(grid_, x_.data(), y_.data(), z_.data(), count_, listed, none_);
}

// Pressures start from those of the previous substep: the pressure that supports a column of water takes many substeps
// to build up.
void Fluid::keepVolume(float seconds) {
  const std::size_t blocks = (count_ + kParticleBlock - 1) / kParticleBlock;
  const std::size_t atOnce = kParticlesAtOnce / kParticleBlock;
  const ParticleRow min{room_.min.x(), room_.min.y(), room_.min.z(), 0.0f};
  const ParticleRow max{room_.max.x(), room_.max.y(), room_.max.z(), 0.0f};
  const float rate = pressureSeconds_ > 0.0f ? seconds / pressureSeconds_ : 0.0f;
  const float kept = kKeptPressure * rate * rate;  // pressures are in units of displacement
  pressureSeconds_ = seconds;
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) pressure_[i] *= kept;
  });
  for (int iteration = 0; iteration < settings_.iterations; ++iteration) {
    const float pressed = iteration == 0 ? 0.0f : 1.0f;
    forRanges(blocks, atOnce, [&](std::size_t begin, std::size_t end) {
      findPressures(kernels_, position_.data(), lists_, begin, end, pressure_.data(), pressed, nextPosition_.data());
    });
    forRanges(blocks, atOnce, [&](std::size_t begin, std::size_t end) {
      movePressed(kernels_, nextPosition_.data(), lists_, min, max, kLongestMove * spacing_, begin, end,
                  position_.data());
    });
  }
}

void Fluid::pushOut(float seconds) {
  // The farthest that any particle can move since the sorting.
  const float margin = (1.0f + (kSubstepsPerSort - 1) * kFastest +
                        kSubstepsPerSort * kLongestMove * static_cast<float>(settings_.iterations)) *
                       spacing_;
  bool any = false;
  for (ParticleObstacle::Sweep box : body_.sweeps()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.min[axis] -= margin;
      box.max[axis] += margin;
    }
    grid_.visitRuns(box.min, box.max, [&](std::uint32_t first, std::uint32_t last) {
      std::fill(nearBody_.begin() + first, nearBody_.begin() + last, std::uint8_t{1});
      any = true;
    });
  }
  if (!any) return;
  candidates_.clear();
  candidateOf_.clear();
  for (std::size_t i = 0; i < count_; ++i) {
    if (nearBody_[i] == 0) continue;
    nearBody_[i] = 0;
    candidates_.emplace_back(position_[i].x, position_[i].y, position_[i].z);
    candidateOf_.push_back(static_cast<std::uint32_t>(i));
  }
  const float fastest = kFastest * spacing_ / seconds;
  for (const ParticleTouch& touch : body_.push(candidates_, room_)) {
    const std::size_t i = candidateOf_[touch.particle];
    const Vec3f& position = candidates_[touch.particle];
    Vec3f velocity(motion_[i].x, motion_[i].y, motion_[i].z);
    velocity += velocityChange(touch, velocity);
    const float speed = velocity.norm();
    if (speed > fastest) velocity *= fastest / speed;
    position_[i] = {position.x(), position.y(), position.z(), 0.0f};
    motion_[i] = {velocity.x(), velocity.y(), velocity.z(), 0.0f};
  }
}

}  // namespace lorica
