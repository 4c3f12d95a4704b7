#include "collision/particles/granular.h"

#include "collision/particles/granular_kernel.h"
#include "collision/particles/particle_ranges.h"
#include "geometry/result.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace lorica {
namespace {

constexpr int kSubstepsPerSort = 4;  // during which lists of neighbours stay valid
constexpr int kSubstepsPerPush = 2;
constexpr float kReach = 1.15f;      // of a list, in diameters
constexpr int kMaxNeighbours = 24;   // at most twelve equal spheres touch one
constexpr float kRelaxation = 2.0f;  // multiple of the mean correction
constexpr float kOpening = 0.12f;    // speed at which overlaps open [m/s]
constexpr float kDeep =
    0.1f;  // overlap beyond which it opens faster, in diameters, and the fraction of the excess per substep
constexpr float kFastest = 1.0f;        // max motion in a substep, in diameters
constexpr float kQuiet = 0.7f;          // of the displacement by gravity in a substep from rest
constexpr float kRousing = 2.5f;        // multiple of that displacement that wakes sleeping neighbours
constexpr float kAsleep = 24.0f;        // quiet substeps until a grain sleeps
constexpr float kRoused = 16.0f;        // quiet count after something near has moved
constexpr float kHeldOnBody = 0.0006f;  // a grain resting on the body stays if it is pushed by less than this [m]

/// A grain that moves less in a substep is held [m].
float quietWay(const GranularSettings& settings, float seconds) {
  return kQuiet * static_cast<float>(settings.gravity.norm()) * seconds * seconds;
}

}  // namespace

Granular::Granular(const GranularSettings& settings)
    : settings_(settings),
      room_(particleRoom(settings.floor, settings.walls, settings.radius)),
      diameter_(2.0f * static_cast<float>(settings.radius)),
      motionSeconds_(static_cast<float>(settings.substepSeconds)),
      position_(paddedCount(settings.capacity)),
      motion_(position_.size()),
      nextPosition_(position_.size()),
      nextMotion_(position_.size()),
      id_(settings.capacity),
      nextId_(settings.capacity),
      x_(position_.size()),
      y_(position_.size()),
      z_(position_.size()),
      asleep_(position_.size(), std::uint8_t{1}),
      woken_(settings.capacity),
      nearBody_(settings.capacity),
      grid_(settings.capacity),
      lists_(settings.capacity, kMaxNeighbours),
      body_(settings.radius),
      positions_(settings.capacity),
      velocities_(settings.capacity) {
  LORICA_CHECK(settings.radius > 0.0 && settings.substepSeconds > 0.0,
               "grain radius and substep length must be above 0");
  candidates_.reserve(settings.capacity);
  candidateOf_.reserve(settings.capacity);
}

std::size_t Granular::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  const std::size_t before = count_;
  const Vec3f way = velocity.cast<float>() * motionSeconds_;
  for (const Vec3f& given : positions) {
    if (count_ == settings_.capacity) break;
    if (!given.allFinite()) continue;
    const Vec3f position = given.cwiseMax(room_.min).cwiseMin(room_.max);
    const std::size_t i = count_++;
    position_[i] = {position.x(), position.y(), position.z(), 0.0f};
    motion_[i] = {way.x(), way.y(), way.z(), 0.0f};
    id_[i] = static_cast<std::uint32_t>(i);
    woken_[i] = 0;
    positions_[i] = position;
    velocities_[i] = velocity.cast<float>();
  }
  return count_ - before;
}

void Granular::step(std::span<const LivePart> parts, double seconds) {
  LORICA_CHECK(seconds > 0.0 && std::isfinite(seconds), "the length of a step of grains must be finite and above 0");
  if (count_ == 0) return;
  const int substeps = std::max(1, static_cast<int>(std::ceil(seconds / settings_.substepSeconds - 1e-6)));
  const auto length = static_cast<float>(seconds / substeps);
  body_.begin(parts, seconds, substeps);
  wakeAroundParts();
  for (int substep = 0; substep < substeps; ++substep) {
    if (substep % kSubstepsPerSort == 0) {
      sort(length);
      findNeighbours();
    }
    stepContacts(length);
    // The body is applied in every second substep and in the last.
    if ((substeps - substep) % kSubstepsPerPush == 1) {
      body_.advance(substep);
      pushOut(length);
    }
    if (substep % kSubstepsPerSort == kSubstepsPerSort - 1 || substep == substeps - 1) rouse(length);
  }
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      positions_[id_[i]] = Vec3f(position_[i].x, position_[i].y, position_[i].z);
      velocities_[id_[i]] = Vec3f(motion_[i].x, motion_[i].y, motion_[i].z) / length;
    }
  });
}

// Grains near a moving part, at its old and new position, may move.
void Granular::wakeAroundParts() {
  for (ParticleObstacle::Sweep box : body_.sweeps()) {
    if (!box.moves) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.min[axis] -= 2.0f * diameter_;
      box.max[axis] += 2.0f * diameter_;
    }
    grid_.visitRuns(box.min, box.max, [&](std::uint32_t first, std::uint32_t last) {
      std::fill(woken_.begin() + first, woken_.begin() + last, std::uint8_t{1});
    });
  }
}

// Sorts grains by their expected positions in the middle of the next substeps.
void Granular::sort(float seconds) {
  const float rate = seconds / motionSeconds_;
  motionSeconds_ = seconds;
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ParticleRow& motion = motion_[i];
      if (woken_[i] != 0) {
        motion.w = std::min(motion.w, kRoused);
        position_[i].w = std::min(position_[i].w, kRoused);
      }
      woken_[i] = 0;
      motion = {rate * motion.x, rate * motion.y, rate * motion.z, motion.w};
      constexpr float kAhead = 0.5f * kSubstepsPerSort;
      nextPosition_[i] = {position_[i].x + kAhead * motion.x, position_[i].y + kAhead * motion.y,
                          position_[i].z + kAhead * motion.z, 0.0f};
    }
  });
  grid_.sort({nextPosition_.data(), count_}, kReach * diameter_);
  const std::uint32_t* order = grid_.order().data();
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ParticleRow& ahead = nextPosition_[order[i]];
      x_[i] = ahead.x;
      y_[i] = ahead.y;
      z_[i] = ahead.z;
      nextMotion_[i] = motion_[order[i]];
      nextId_[i] = id_[order[i]];
      asleep_[i] = nextMotion_[i].w >= kAsleep ? 1 : 0;
    }
  });
  std::swap(motion_, nextMotion_);
  std::swap(id_, nextId_);
  // Sleeping grains are stored in both of the alternating buffers.
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) nextPosition_[i] = position_[order[i]];
  });
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      position_[i] = nextPosition_[i];
      nextMotion_[i] = motion_[i];
    }
  });
}

void Granular::findNeighbours() {
  lists_.build(grid_, x_.data(), y_.data(), z_.data(), count_, kReach * diameter_, asleep_);

  // Grains that the body may touch, given the farthest that any can move before the next sorting.
  const float margin = (kSubstepsPerSort * kFastest + 1.0f) * diameter_;
  candidateOf_.clear();
  for (ParticleObstacle::Sweep box : body_.sweeps()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.min[axis] -= margin;
      box.max[axis] += margin;
    }
    grid_.visitRuns(box.min, box.max, [&](std::uint32_t first, std::uint32_t last) {
      std::fill(nearBody_.begin() + first, nearBody_.begin() + last, std::uint8_t{1});
    });
  }
  for (std::size_t i = 0; i < count_; ++i) {
    if (asleep_[i] == 0) {
      if (nearBody_[i] != 0) {
        candidateOf_.push_back(static_cast<std::uint32_t>(i));
      } else {
        position_[i].w = 0.0f;  // it no longer rests on the body
      }
    }
    nearBody_[i] = 0;
  }
}

void Granular::stepContacts(float seconds) {
  const Vec3f fall = settings_.gravity.cast<float>() * (seconds * seconds);
  const GrainPass pass{position_.data(),
                       motion_.data(),
                       nextPosition_.data(),
                       nextMotion_.data(),
                       asleep_.data(),
                       {fall.x(), fall.y(), fall.z(), 0.0f},
                       diameter_,
                       static_cast<float>(settings_.friction),
                       kRelaxation,
                       kOpening * seconds,
                       kDeep * diameter_,
                       kDeep,
                       kFastest * diameter_,
                       quietWay(settings_, seconds),
                       kAsleep,
                       {room_.min.x(), room_.min.y(), room_.min.z(), 0.0f},
                       {room_.max.x(), room_.max.y(), room_.max.z(), 0.0f}};
  const std::size_t blocks = (count_ + kParticleBlock - 1) / kParticleBlock;
  forRanges(blocks, kParticlesAtOnce / kParticleBlock,
            [&](std::size_t begin, std::size_t end) { stepGrains(pass, lists_, begin, end); });
  std::swap(position_, nextPosition_);
  std::swap(motion_, nextMotion_);
}

// Applied last: the body's motion is given and cannot be changed by grains.
void Granular::pushOut(float seconds) {
  if (candidateOf_.empty()) return;
  candidates_.clear();
  const Vec3f fall = settings_.gravity.cast<float>() * (seconds * seconds);
  constexpr float kWays = 0.5f * kSubstepsPerPush * (kSubstepsPerPush + 1);
  for (const std::uint32_t i : candidateOf_) {
    Vec3f position(position_[i].x, position_[i].y, position_[i].z);
    // Gravity was not applied to a grain resting on the body. Apply it here to see whether the body still supports it.
    if (position_[i].w > 0.0f) position += kWays * fall;
    candidates_.push_back(position);
  }
  const float quiet = quietWay(settings_, seconds);
  const std::span<const ParticleTouch> touches = body_.push(candidates_, room_);
  std::size_t next = 0;
  for (std::size_t c = 0; c < candidateOf_.size(); ++c) {
    ParticleRow& row = position_[candidateOf_[c]];
    ParticleRow& motion = motion_[candidateOf_[c]];
    const Vec3f& position = candidates_[c];
    const bool touched = next < touches.size() && touches[next].particle == c;
    Vec3f way(motion.x, motion.y, motion.z);
    if (row.w > 0.0f) way += static_cast<float>(kSubstepsPerPush) * fall;
    if (!touched) {
      if (row.w > 0.0f) {
        const Vec3f inRoom = position.cwiseMax(room_.min).cwiseMin(room_.max);
        row = {inRoom.x(), inRoom.y(), inRoom.z(), 0.0f};
        motion = {way.x(), way.y(), way.z(), 0.0f};
      }
      continue;
    }
    const Vec3f velocity = way / seconds;
    way = (velocity + velocityChange(touches[next++], velocity, static_cast<float>(settings_.friction))) * seconds;
    const float length = way.norm();
    if (length > kFastest * diameter_) way *= kFastest * diameter_ / length;
    const bool rests = length < quiet;
    const float count = rests ? std::min(row.w + kSubstepsPerPush, kAsleep) : 0.0f;
    if (rests) way.setZero();
    motion = {way.x(), way.y(), way.z(), count};
    // Friction holds the grain: it does not creep by the distance that it would have fallen.
    const Vec3f off = position - Vec3f(row.x, row.y, row.z);
    if (rests && row.w > 0.0f && off.norm() < kHeldOnBody) {
      row.w = count;
    } else {
      row = {position.x(), position.y(), position.z(), count};
    }
  }
}

// Moving grains wake sleeping neighbours.
void Granular::rouse(float seconds) {
  const float rousing = kRousing * quietWay(settings_, seconds);
  const std::size_t blocks = (count_ + kParticleBlock - 1) / kParticleBlock;
  forRanges(blocks, kParticlesAtOnce / kParticleBlock, [&](std::size_t firstBlock, std::size_t lastBlock) {
    for (std::size_t block = firstBlock; block < lastBlock; ++block) {
      const std::size_t last = std::min(count_, (block + 1) * kParticleBlock);
      for (std::size_t i = block * kParticleBlock; i < last; ++i) {
        const ParticleRow& way = motion_[i];
        if (asleep_[i] != 0 || way.x * way.x + way.y * way.y + way.z * way.z < rousing * rousing) continue;
        const std::uint32_t* slots = lists_.slots(block) + i % kParticleBlock;
        for (int s = 0; s < lists_.slotCount(block); ++s) {
          const std::uint32_t other = slots[static_cast<std::size_t>(s) * kParticleBlock];
          if ((other & NeighbourLists::kMarked) == 0) continue;
          std::atomic_ref<std::uint8_t>(woken_[other & ~NeighbourLists::kMarked]).store(1, std::memory_order_relaxed);
        }
      }
    }
  });
}

std::size_t Granular::awakeCount() const {
  return static_cast<std::size_t>(std::count_if(motion_.begin(), motion_.begin() + static_cast<std::ptrdiff_t>(count_),
                                                [](const ParticleRow& motion) { return motion.w < kAsleep; }));
}

}  // namespace lorica
