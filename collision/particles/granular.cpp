#include "collision/particles/granular.h"

#include "geometry/result.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <numbers>

namespace lorica {
namespace {

constexpr int kGrainSubstepsPerSort = 4;  // during which lists of neighbours stay valid
constexpr float kGrainReach = 1.15f;      // of a list, in diameters
constexpr int kMaxGrains = 24;            // at most twelve equal spheres touch one
constexpr float kGrainRelaxation = 2.0f;  // multiple of the mean correction
constexpr float kOpening = 0.12f;         // speed at which overlaps open [m/s]
constexpr float kDeep = 0.1f;          // overlap beyond which it opens faster, in diameters; and that share per substep
constexpr float kFastestGrain = 1.0f;  // max motion in a substep, in diameters
constexpr float kQuiet = 0.7f;         // of the displacement by gravity in a substep from rest
constexpr float kRousing = 2.5f;       // multiple of that displacement that wakes sleeping neighbours
constexpr float kAsleep = 24.0f;       // quiet substeps until a grain sleeps
constexpr float kRoused = 16.0f;       // quiet count after something near has moved
constexpr float kGrainTouching = 1.15f;  // distance at which rigid bodies are met, in radii
constexpr double kCarrying = 30.0;       // a grain that is pressed down counts as this many: others carry it
constexpr int kSweeps = 4;               // over the contacts with rigid bodies
constexpr float kHeldOnBody = 0.0006f;   // a grain resting on the body stays if it is pushed by less than this [m]

/// A grain that moves less in a substep is held [m].
float quietWay(const GranularSettings& settings, float seconds) {
  return kQuiet * static_cast<float>(settings.gravity.norm()) * seconds * seconds;
}

/// What gravity adds to a motion in a substep [m].
ParticleRow fallOf(const GranularSettings& settings, float seconds) {
  return rowOf(settings.gravity.cast<float>() * (seconds * seconds));
}

}  // namespace

Granular::Granular(const GranularSettings& wanted)
    : ParticleSimulation(
          {wanted.capacity, particleRoom(wanted.floor, wanted.walls, wanted.radius), wanted.radius, kMaxGrains}),
      settings_(wanted),
      goal_(set_.position.size()),
      nextGoal_(set_.position.size()),
      diameter_(2.0f * static_cast<float>(wanted.radius)),
      motionSeconds_(static_cast<float>(wanted.substepSeconds)),
      asleep_(set_.position.size(), std::uint8_t{1}),
      woken_(wanted.capacity),
      mass_(wanted.density * (4.0 / 3.0) * std::numbers::pi * std::pow(wanted.radius, 3.0)) {}

std::size_t Granular::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  const Vec3f speed = velocity.cast<float>();
  const std::size_t added = set_.add(positions, speed * motionSeconds_, speed);
  std::fill_n(woken_.begin() + (set_.count - added), added, std::uint8_t{0});
  return added;
}

void Granular::step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  if (set_.count == 0) return;
  const ParticleSet::Substeps substeps = set_.beginFrame(parts, bodies, seconds, settings_.substepSeconds);
  set_.markAround(ParticleSet::Parts::kMoving, 2.0f * diameter_, woken_);
  set_.rigid.markAround(set_.grid, diameter_, woken_);
  const ParticleRow fall = fallOf(settings_, substeps.seconds);
  for (int substep = 0; substep < substeps.count; ++substep) {
    if (substep % kGrainSubstepsPerSort == 0) {
      sort(substeps.seconds);
      findNeighbours(fall);
    }
    stepContacts(substeps.seconds);
    if (!set_.rigid.empty()) {
      set_.rigid.advance(substep);
      touchBodies(substeps.seconds);
    }
    if (substeps.pushes(substep)) {
      set_.body.advance(substep);
      pushOut(substeps.seconds);
    }
    if (substep % kGrainSubstepsPerSort == kGrainSubstepsPerSort - 1 || substep == substeps.count - 1)
      rouse(substeps.seconds);
  }
  set_.endFrame(bodies);
  set_.publish(substeps.seconds);
}

// Sorts grains by their expected positions in the middle of the next substeps.
void Granular::sort(float seconds) {
  const float rate = seconds / motionSeconds_;
  motionSeconds_ = seconds;
  set_.forEach([&](std::size_t i) {
    ParticleRow& motion = set_.motion[i];
    ParticleRow& position = set_.position[i];
    if (woken_[i] != 0) {
      motion.w = std::min(motion.w, kRoused);
      position.w = std::min(position.w, kRoused);
    }
    woken_[i] = 0;
    motion = {rate * motion.x, rate * motion.y, rate * motion.z, motion.w};
    constexpr float kAhead = 0.5f * kGrainSubstepsPerSort;
    goal_[i] = {position.x + kAhead * motion.x, position.y + kAhead * motion.y, position.z + kAhead * motion.z, 0.0f};
  });
  set_.sort({goal_.data(), set_.count}, kGrainReach * diameter_, 1, [&](std::size_t i, std::size_t from) {
    set_.nextPosition[i] = set_.position[from];
    set_.nextMotion[i] = set_.motion[from];
    asleep_[i] = set_.nextMotion[i].w >= kAsleep ? 1 : 0;
  });
  std::swap(set_.position, set_.nextPosition);
  std::swap(set_.motion, set_.nextMotion);
}

void Granular::findNeighbours(const ParticleRow& fall) {
  anySleeps_ = std::memchr(asleep_.data(), 1, set_.count) != nullptr;
  set_.lists.build(set_.grid, set_.x.data(), set_.y.data(), set_.z.data(), set_.count, kGrainReach * diameter_,
                   asleep_);

  // Grains that the body may touch, given the farthest that any can move before the next sorting.
  const float margin = (kGrainSubstepsPerSort * kFastestGrain + 1.0f) * diameter_;
  const bool anyNear = set_.markAround(ParticleSet::Parts::kAll, margin, set_.nearBody);
  set_.forEach([&](std::size_t i) {
    if (asleep_[i] == 0 && set_.nearBody[i] == 0) set_.position[i].w = 0.0f;  // it no longer rests on the body
    goal_[i] = endOf(set_.position[i], set_.motion[i], asleep_[i] != 0, fall);
    if (asleep_[i] == 0) return;
    // Sleeping grains are stored in both of the alternating buffers.
    set_.nextPosition[i] = set_.position[i];
    set_.nextMotion[i] = set_.motion[i];
    nextGoal_[i] = goal_[i];
  });
  set_.candidateOf.clear();
  for (std::size_t i = 0; anyNear && i < set_.count; ++i) {
    if (set_.nearBody[i] != 0 && asleep_[i] == 0) set_.candidateOf.push_back(i);
    set_.nearBody[i] = 0;
  }
}

void Granular::stepContacts(float seconds) {
  const GrainPass pass{set_.position.data(),
                       set_.motion.data(),
                       goal_.data(),
                       set_.nextPosition.data(),
                       set_.nextMotion.data(),
                       nextGoal_.data(),
                       asleep_.data(),
                       fallOf(settings_, seconds),
                       diameter_,
                       static_cast<float>(settings_.friction),
                       kGrainRelaxation,
                       kOpening * seconds,
                       kDeep * diameter_,
                       kDeep,
                       kFastestGrain * diameter_,
                       quietWay(settings_, seconds),
                       kAsleep,
                       rowOf(set_.room.min),
                       rowOf(set_.room.max)};
  set_.forBlocks([&](std::size_t begin, std::size_t end) { stepGrains(pass, set_.lists, begin, end); });
  std::swap(set_.position, set_.nextPosition);
  std::swap(set_.motion, set_.nextMotion);
  std::swap(goal_, nextGoal_);
}

// A sleeping grain holds a rigid body as the ground does. One that is pressed down is carried by those below it.
void Granular::touchBodies(float seconds) {
  const auto radius = static_cast<float>(settings_.radius);
  set_.rigid.gather(set_.grid, set_.position, 2.0f * radius,
                    (kGrainSubstepsPerSort * kFastestGrain + 1.0f) * diameter_);
  const std::span<const ParticleBodies::Contact> contacts = set_.rigid.find(set_.position, kGrainTouching * radius);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const ParticleBodies::Contact& contact : contacts) {
      const ParticleRow& at = set_.position[contact.particle];
      ParticleRow& motion = set_.motion[contact.particle];
      const bool holds = asleep_[contact.particle] != 0;
      const float deep = radius - contact.distance;
      const double carried = 1.0 + kCarrying * std::max(0.0f, -contact.normal.y());
      const double leaving = deep < 0.0f ? deep / seconds : holds ? std::min(kOpening, kDeep * deep / seconds) : 0.0f;
      const Vec3f velocity = vectorOf(motion) / seconds;
      const Vec3f change =
          set_.rigid.collide(contact, at, velocity, holds ? 0.0 : 1.0 / (mass_ * carried), settings_.friction, leaving);
      if (!holds) motion = rowOf(vectorOf(motion) + seconds * change, motion.w);
    }
  }
  set_.rigid.follow();
  const ParticleRow fall = fallOf(settings_, seconds);
  for (const ParticleBodies::Contact& contact : contacts) {
    if (asleep_[contact.particle] != 0) continue;
    ParticleRow &at = set_.position[contact.particle], &motion = set_.motion[contact.particle];
    const Vec3f way = vectorOf(motion);
    const float length = way.norm(), deep = radius - contact.distance;
    if (length > kFastestGrain * diameter_) motion = rowOf(kFastestGrain * diameter_ / length * way, motion.w);
    if (deep > 0.0f) at = rowOf(set_.room.nearest(vectorOf(at) + std::min(deep, diameter_) * contact.normal), at.w);
    goal_[contact.particle] = endOf(at, motion, false, fall);
  }
}

// Applied last: the body's motion is given and cannot be changed by grains.
void Granular::pushOut(float seconds) {
  if (set_.candidateOf.empty()) return;
  set_.candidates.clear();
  const Vec3f fall = settings_.gravity.cast<float>() * (seconds * seconds);
  constexpr float kWays = 0.5f * ParticleSet::Substeps::kPerPush * (ParticleSet::Substeps::kPerPush + 1);
  for (const std::uint32_t i : set_.candidateOf) {
    Vec3f position = vectorOf(set_.position[i]);
    // Gravity was not applied to a grain resting on the body. Apply it here to see whether the body still supports it.
    if (set_.position[i].w > 0.0f) position += kWays * fall;
    set_.candidates.push_back(position);
  }
  const float quiet = quietWay(settings_, seconds);
  const std::span<const ParticleTouch> touches = set_.body.push(set_.candidates, set_.room);
  std::size_t next = 0;
  for (std::size_t c = 0; c < set_.candidateOf.size(); ++c) {
    const auto aim = [&] {
      goal_[set_.candidateOf[c]] =
          endOf(set_.position[set_.candidateOf[c]], set_.motion[set_.candidateOf[c]], false, rowOf(fall));
    };
    ParticleRow& row = set_.position[set_.candidateOf[c]];
    ParticleRow& motion = set_.motion[set_.candidateOf[c]];
    const Vec3f& position = set_.candidates[c];
    const bool touched = next < touches.size() && touches[next].particle == c;
    Vec3f way = vectorOf(motion);
    if (row.w > 0.0f) way += static_cast<float>(ParticleSet::Substeps::kPerPush) * fall;
    if (!touched) {
      if (row.w > 0.0f) {
        row = rowOf(set_.room.nearest(position));
        motion = rowOf(way);
        aim();
      }
      continue;
    }
    const Vec3f velocity = way / seconds;
    way = (velocity + velocityChange(touches[next++], velocity, static_cast<float>(settings_.friction))) * seconds;
    const float length = way.norm();
    if (length > kFastestGrain * diameter_) way *= kFastestGrain * diameter_ / length;
    const bool rests = length < quiet;
    const float count = rests ? std::min(row.w + ParticleSet::Substeps::kPerPush, kAsleep) : 0.0f;
    if (rests) way.setZero();
    motion = rowOf(way, count);
    // Friction holds the grain: it does not creep by the distance that it would have fallen.
    const Vec3f off = position - vectorOf(row);
    if (rests && row.w > 0.0f && off.norm() < kHeldOnBody) {
      row.w = count;
    } else {
      row = rowOf(position, count);
    }
    aim();
  }
}

// Moving grains wake sleeping neighbours.
void Granular::rouse(float seconds) {
  if (!anySleeps_) return;
  const float rousing = kRousing * quietWay(settings_, seconds);
  set_.forBlocks([&](std::size_t firstBlock, std::size_t lastBlock) {
    for (std::size_t block = firstBlock; block < lastBlock; ++block) {
      const std::size_t last = std::min(set_.count, (block + 1) * kParticleBlock);
      for (std::size_t i = block * kParticleBlock; i < last; ++i) {
        const ParticleRow& way = set_.motion[i];
        if (asleep_[i] != 0 || way.x * way.x + way.y * way.y + way.z * way.z < rousing * rousing) continue;
        const std::uint32_t* slots = set_.lists.slots(block) + i % kParticleBlock;
        for (int s = 0; s < set_.lists.slotCount(block); ++s) {
          const std::uint32_t other = slots[s * kParticleBlock];
          if (asleep_[other] != 0) std::atomic_ref<std::uint8_t>(woken_[other]).store(1, std::memory_order_relaxed);
        }
      }
    }
  });
}

Result<Granular> Granular::create(const GranularSettings& settings) {
  LORICA_TRY_DO(checkAboveZero("grain radius", settings.radius));
  LORICA_TRY_DO(checkAboveZero("length of substeps", settings.substepSeconds));
  return Granular(settings);
}

std::size_t Granular::awakeCount() const {
  const std::span<const ParticleRow> motions = std::span(set_.motion).first(set_.count);
  return std::count_if(motions.begin(), motions.end(), [](const ParticleRow& motion) { return motion.w < kAsleep; });
}

}  // namespace lorica
