#include "collision/particles/granular.h"

#include "collision/particles/granular_kernel.h"
#include "collision/particles/particle_ranges.h"
#include "geometry/result.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace lorica {
namespace {

constexpr int kSubstepsPerSort = 4;  // for which lists of neighbours are good
constexpr int kSubstepsPerPush = 2;
constexpr float kReach = 1.15f;         // of a list, in diameters
constexpr int kMostNeighbours = 24;     // twelve spheres touch one
constexpr float kRelaxation = 2.0f;     // of corrections, beside their mean
constexpr float kOpening = 0.12f;       // of overlaps [m/s]
constexpr float kDeep = 0.1f;           // an overlap that must go faster, in diameters, and by what share a substep
constexpr float kFastest = 1.0f;        // in a substep, in diameters
constexpr float kQuiet = 0.7f;          // of the way that gravity makes in a substep from rest
constexpr float kRousing = 2.5f;        // times that wakes sleeping neighbours
constexpr float kAsleep = 24.0f;        // substeps of being quiet
constexpr float kRoused = 16.0f;        // as if it had been quiet so long, when something near has moved
constexpr float kHeldOnBody = 0.0006f;  // a grain that rests on the body stays, though it be so far in it [m]

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
      place_(paddedCount(settings.capacity)),
      motion_(place_.size()),
      nextPlace_(place_.size()),
      nextMotion_(place_.size()),
      id_(settings.capacity),
      nextId_(settings.capacity),
      x_(place_.size()),
      y_(place_.size()),
      z_(place_.size()),
      asleep_(place_.size(), std::uint8_t{1}),
      woken_(settings.capacity),
      nearBody_(settings.capacity),
      grid_(settings.capacity),
      lists_(settings.capacity, kMostNeighbours),
      body_(settings.radius),
      places_(settings.capacity),
      velocities_(settings.capacity) {
  CHECK(settings.radius > 0.0 && settings.substepSeconds > 0.0, "grains have a size, and substeps a length");
  candidates_.reserve(settings.capacity);
  candidateOf_.reserve(settings.capacity);
}

std::size_t Granular::add(std::span<const Vec3f> places, const Vec3& velocity) {
  const std::size_t before = count_;
  const Vec3f way = velocity.cast<float>() * motionSeconds_;
  for (const Vec3f& given : places) {
    if (count_ == settings_.capacity) break;
    if (!given.allFinite()) continue;
    const Vec3f place = given.cwiseMax(room_.least).cwiseMin(room_.most);
    const std::size_t i = count_++;
    place_[i] = {place.x(), place.y(), place.z(), 0.0f};
    motion_[i] = {way.x(), way.y(), way.z(), 0.0f};
    id_[i] = static_cast<std::uint32_t>(i);
    woken_[i] = 0;
    places_[i] = place;
    velocities_[i] = velocity.cast<float>();
  }
  return count_ - before;
}

void Granular::step(std::span<const LivePart> parts, double seconds) {
  CHECK(seconds > 0.0 && std::isfinite(seconds), "grains cannot step back in time");
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
    // The body comes in every second substep and in the last.
    if ((substeps - substep) % kSubstepsPerPush == 1) {
      body_.advance(substep);
      pushOut(length);
    }
    if (substep % kSubstepsPerSort == kSubstepsPerSort - 1 || substep == substeps - 1) rouse(length);
  }
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      places_[id_[i]] = Vec3f(place_[i].x, place_[i].y, place_[i].z);
      velocities_[id_[i]] = Vec3f(motion_[i].x, motion_[i].y, motion_[i].z) / length;
    }
  });
}

// What a part leaves behind it, or comes to, may move.
void Granular::wakeAroundParts() {
  for (ParticleBody::Sweep box : body_.sweeps()) {
    if (!box.moves) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.least[axis] -= 2.0f * diameter_;
      box.most[axis] += 2.0f * diameter_;
    }
    grid_.visitRuns(box.least, box.most, [&](std::uint32_t first, std::uint32_t last) {
      std::fill(woken_.begin() + first, woken_.begin() + last, std::uint8_t{1});
    });
  }
}

// Grains in the order of where they will be in the middle of the next substeps.
void Granular::sort(float seconds) {
  const float rate = seconds / motionSeconds_;
  motionSeconds_ = seconds;
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ParticleRow& motion = motion_[i];
      if (woken_[i] != 0) {
        motion.w = std::min(motion.w, kRoused);
        place_[i].w = std::min(place_[i].w, kRoused);
      }
      woken_[i] = 0;
      motion = {rate * motion.x, rate * motion.y, rate * motion.z, motion.w};
      constexpr float kAhead = 0.5f * kSubstepsPerSort;
      nextPlace_[i] = {place_[i].x + kAhead * motion.x, place_[i].y + kAhead * motion.y,
                       place_[i].z + kAhead * motion.z, 0.0f};
    }
  });
  grid_.sort({nextPlace_.data(), count_}, kReach * diameter_);
  const std::uint32_t* order = grid_.order().data();
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ParticleRow& ahead = nextPlace_[order[i]];
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
  // Sleepers are in both of the buffers that take turns.
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) nextPlace_[i] = place_[order[i]];
  });
  forRanges(count_, kParticlesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      place_[i] = nextPlace_[i];
      nextMotion_[i] = motion_[i];
    }
  });
}

void Granular::findNeighbours() {
  lists_.build(grid_, x_.data(), y_.data(), z_.data(), count_, kReach * diameter_, asleep_);

  // Whom the body may touch, as far as all can go until they are sorted again.
  const float margin = (kSubstepsPerSort * kFastest + 1.0f) * diameter_;
  candidateOf_.clear();
  for (ParticleBody::Sweep box : body_.sweeps()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.least[axis] -= margin;
      box.most[axis] += margin;
    }
    grid_.visitRuns(box.least, box.most, [&](std::uint32_t first, std::uint32_t last) {
      std::fill(nearBody_.begin() + first, nearBody_.begin() + last, std::uint8_t{1});
    });
  }
  for (std::size_t i = 0; i < count_; ++i) {
    if (asleep_[i] == 0) {
      if (nearBody_[i] != 0) {
        candidateOf_.push_back(static_cast<std::uint32_t>(i));
      } else {
        place_[i].w = 0.0f;  // it rests on the body no more
      }
    }
    nearBody_[i] = 0;
  }
}

void Granular::stepContacts(float seconds) {
  const Vec3f fall = settings_.gravity.cast<float>() * (seconds * seconds);
  const GrainPass pass{place_.data(),
                       motion_.data(),
                       nextPlace_.data(),
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
                       {room_.least.x(), room_.least.y(), room_.least.z(), 0.0f},
                       {room_.most.x(), room_.most.y(), room_.most.z(), 0.0f}};
  const std::size_t blocks = (count_ + kParticleBlock - 1) / kParticleBlock;
  forRanges(blocks, kParticlesAtOnce / kParticleBlock,
            [&](std::size_t begin, std::size_t end) { stepGrains(pass, lists_, begin, end); });
  std::swap(place_, nextPlace_);
  std::swap(motion_, nextMotion_);
}

// The body has the last word: it moves as it will.
void Granular::pushOut(float seconds) {
  if (candidateOf_.empty()) return;
  candidates_.clear();
  const Vec3f fall = settings_.gravity.cast<float>() * (seconds * seconds);
  constexpr float kWays = 0.5f * kSubstepsPerPush * (kSubstepsPerPush + 1);
  for (const std::uint32_t i : candidateOf_) {
    Vec3f place(place_[i].x, place_[i].y, place_[i].z);
    // What rests on the body did not fall. Would it, if the body were not there?
    if (place_[i].w > 0.0f) place += kWays * fall;
    candidates_.push_back(place);
  }
  const float quiet = quietWay(settings_, seconds);
  const std::span<const ParticleTouch> touches = body_.push(candidates_, room_);
  std::size_t next = 0;
  for (std::size_t c = 0; c < candidateOf_.size(); ++c) {
    ParticleRow& row = place_[candidateOf_[c]];
    ParticleRow& motion = motion_[candidateOf_[c]];
    const Vec3f& place = candidates_[c];
    const bool touched = next < touches.size() && touches[next].particle == c;
    Vec3f way(motion.x, motion.y, motion.z);
    if (row.w > 0.0f) way += static_cast<float>(kSubstepsPerPush) * fall;
    if (!touched) {
      if (row.w > 0.0f) {
        const Vec3f inRoom = place.cwiseMax(room_.least).cwiseMin(room_.most);
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
    // Friction holds it: it does not creep down by what it would have fallen.
    const Vec3f off = place - Vec3f(row.x, row.y, row.z);
    if (rests && row.w > 0.0f && off.norm() < kHeldOnBody) {
      row.w = count;
    } else {
      row = {place.x(), place.y(), place.z(), count};
    }
  }
}

// What moves wakes those that sleep beside it.
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
