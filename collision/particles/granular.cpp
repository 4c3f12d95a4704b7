#include "collision/particles/granular.h"

#include "collision/particles/particle_set.h"
#include "collision/particles/substep_kernel.h"
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

struct Granular::State {
  explicit State(const GranularSettings& wanted);

  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity);
  void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies);
  void sort(float seconds);
  void findNeighbours(const ParticleRow& fall);
  void stepContacts(float seconds);
  void touchBodies(float seconds);
  void pushOut(float seconds);
  void rouse(float seconds);

  GranularSettings settings;
  ParticleSet set;  // motions are displacements in a substep [m]; for w, see GrainPass
  std::vector<ParticleRow> goal, nextGoal;
  float diameter;
  float motionSeconds;  // of the substeps that the motions belong to
  std::vector<std::uint8_t> asleep, woken;
  bool anySleeps = false;
  double mass;  // of a grain [kg]
};

Granular::State::State(const GranularSettings& wanted)
    : settings(wanted),
      set(wanted.capacity, particleRoom(wanted.floor, wanted.walls, wanted.radius), wanted.radius, kMaxGrains),
      goal(set.position.size()),
      nextGoal(set.position.size()),
      diameter(2.0f * static_cast<float>(wanted.radius)),
      motionSeconds(static_cast<float>(wanted.substepSeconds)),
      asleep(set.position.size(), std::uint8_t{1}),
      woken(wanted.capacity),
      mass(wanted.density * (4.0 / 3.0) * std::numbers::pi * std::pow(wanted.radius, 3.0)) {}

std::size_t Granular::State::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  const Vec3f speed = velocity.cast<float>();
  const std::size_t added = set.add(positions, speed * motionSeconds, speed);
  std::fill_n(woken.begin() + (set.count - added), added, std::uint8_t{0});
  return added;
}

void Granular::State::step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  if (set.count == 0) return;
  const ParticleSet::Substeps substeps = set.beginFrame(parts, bodies, seconds, settings.substepSeconds);
  set.markAround(ParticleSet::Parts::kMoving, 2.0f * diameter, woken);
  set.rigid.markAround(set.grid, diameter, woken);
  const ParticleRow fall = fallOf(settings, substeps.seconds);
  for (int substep = 0; substep < substeps.count; ++substep) {
    if (substep % kGrainSubstepsPerSort == 0) {
      sort(substeps.seconds);
      findNeighbours(fall);
    }
    stepContacts(substeps.seconds);
    if (!set.rigid.empty()) {
      set.rigid.advance(substep);
      touchBodies(substeps.seconds);
    }
    if (substeps.pushes(substep)) {
      set.body.advance(substep);
      pushOut(substeps.seconds);
    }
    if (substep % kGrainSubstepsPerSort == kGrainSubstepsPerSort - 1 || substep == substeps.count - 1)
      rouse(substeps.seconds);
  }
  set.endFrame(bodies);
  set.publish(substeps.seconds);
}

// Sorts grains by their expected positions in the middle of the next substeps.
void Granular::State::sort(float seconds) {
  const float rate = seconds / motionSeconds;
  motionSeconds = seconds;
  set.forEach([&](std::size_t i) {
    ParticleRow& motion = set.motion[i];
    ParticleRow& position = set.position[i];
    if (woken[i] != 0) {
      motion.w = std::min(motion.w, kRoused);
      position.w = std::min(position.w, kRoused);
    }
    woken[i] = 0;
    motion = {rate * motion.x, rate * motion.y, rate * motion.z, motion.w};
    constexpr float kAhead = 0.5f * kGrainSubstepsPerSort;
    goal[i] = {position.x + kAhead * motion.x, position.y + kAhead * motion.y, position.z + kAhead * motion.z, 0.0f};
  });
  set.sort({goal.data(), set.count}, kGrainReach * diameter, 1, [&](std::size_t i, std::size_t from) {
    set.nextPosition[i] = set.position[from];
    set.nextMotion[i] = set.motion[from];
    asleep[i] = set.nextMotion[i].w >= kAsleep ? 1 : 0;
  });
  std::swap(set.position, set.nextPosition);
  std::swap(set.motion, set.nextMotion);
}

void Granular::State::findNeighbours(const ParticleRow& fall) {
  anySleeps = std::memchr(asleep.data(), 1, set.count) != nullptr;
  set.lists.build(set.grid, set.x.data(), set.y.data(), set.z.data(), set.count, kGrainReach * diameter, asleep);

  // Grains that the body may touch, given the farthest that any can move before the next sorting.
  const float margin = (kGrainSubstepsPerSort * kFastestGrain + 1.0f) * diameter;
  const bool anyNear = set.markAround(ParticleSet::Parts::kAll, margin, set.nearBody);
  set.forEach([&](std::size_t i) {
    if (asleep[i] == 0 && set.nearBody[i] == 0) set.position[i].w = 0.0f;  // it no longer rests on the body
    goal[i] = endOf(set.position[i], set.motion[i], asleep[i] != 0, fall);
    if (asleep[i] == 0) return;
    // Sleeping grains are stored in both of the alternating buffers.
    set.nextPosition[i] = set.position[i];
    set.nextMotion[i] = set.motion[i];
    nextGoal[i] = goal[i];
  });
  set.candidateOf.clear();
  for (std::size_t i = 0; anyNear && i < set.count; ++i) {
    if (set.nearBody[i] != 0 && asleep[i] == 0) set.candidateOf.push_back(i);
    set.nearBody[i] = 0;
  }
}

void Granular::State::stepContacts(float seconds) {
  const GrainPass pass{set.position.data(),
                       set.motion.data(),
                       goal.data(),
                       set.nextPosition.data(),
                       set.nextMotion.data(),
                       nextGoal.data(),
                       asleep.data(),
                       fallOf(settings, seconds),
                       diameter,
                       static_cast<float>(settings.friction),
                       kGrainRelaxation,
                       kOpening * seconds,
                       kDeep * diameter,
                       kDeep,
                       kFastestGrain * diameter,
                       quietWay(settings, seconds),
                       kAsleep,
                       rowOf(set.room.min),
                       rowOf(set.room.max)};
  set.forBlocks([&](std::size_t begin, std::size_t end) { stepGrains(pass, set.lists, begin, end); });
  std::swap(set.position, set.nextPosition);
  std::swap(set.motion, set.nextMotion);
  std::swap(goal, nextGoal);
}

// A sleeping grain holds a rigid body as the ground does. One that is pressed down is carried by those below it.
void Granular::State::touchBodies(float seconds) {
  const auto radius = static_cast<float>(settings.radius);
  set.rigid.gather(set.grid, set.position, 2.0f * radius, (kGrainSubstepsPerSort * kFastestGrain + 1.0f) * diameter);
  const std::span<const ParticleBodies::Contact> contacts = set.rigid.find(set.position, kGrainTouching * radius);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const ParticleBodies::Contact& contact : contacts) {
      const ParticleRow& at = set.position[contact.particle];
      ParticleRow& motion = set.motion[contact.particle];
      const bool holds = asleep[contact.particle] != 0;
      const float deep = radius - contact.distance;
      const double carried = 1.0 + kCarrying * std::max(0.0f, -contact.normal.y());
      const double leaving = deep < 0.0f ? deep / seconds : holds ? std::min(kOpening, kDeep * deep / seconds) : 0.0f;
      const Vec3f velocity = vectorOf(motion) / seconds;
      const Vec3f change =
          set.rigid.collide(contact, at, velocity, holds ? 0.0 : 1.0 / (mass * carried), settings.friction, leaving);
      if (!holds) motion = rowOf(vectorOf(motion) + seconds * change, motion.w);
    }
  }
  set.rigid.follow();
  const ParticleRow fall = fallOf(settings, seconds);
  for (const ParticleBodies::Contact& contact : contacts) {
    if (asleep[contact.particle] != 0) continue;
    ParticleRow &at = set.position[contact.particle], &motion = set.motion[contact.particle];
    const Vec3f way = vectorOf(motion);
    const float length = way.norm(), deep = radius - contact.distance;
    if (length > kFastestGrain * diameter) motion = rowOf(kFastestGrain * diameter / length * way, motion.w);
    if (deep > 0.0f) at = rowOf(set.room.nearest(vectorOf(at) + std::min(deep, diameter) * contact.normal), at.w);
    goal[contact.particle] = endOf(at, motion, false, fall);
  }
}

// Applied last: the body's motion is given and cannot be changed by grains.
void Granular::State::pushOut(float seconds) {
  if (set.candidateOf.empty()) return;
  set.candidates.clear();
  const Vec3f fall = settings.gravity.cast<float>() * (seconds * seconds);
  constexpr float kWays = 0.5f * ParticleSet::Substeps::kPerPush * (ParticleSet::Substeps::kPerPush + 1);
  for (const std::uint32_t i : set.candidateOf) {
    Vec3f position = vectorOf(set.position[i]);
    // Gravity was not applied to a grain resting on the body. Apply it here to see whether the body still supports it.
    if (set.position[i].w > 0.0f) position += kWays * fall;
    set.candidates.push_back(position);
  }
  const float quiet = quietWay(settings, seconds);
  const std::span<const ParticleTouch> touches = set.body.push(set.candidates, set.room);
  std::size_t next = 0;
  for (std::size_t c = 0; c < set.candidateOf.size(); ++c) {
    const auto aim = [&] {
      goal[set.candidateOf[c]] =
          endOf(set.position[set.candidateOf[c]], set.motion[set.candidateOf[c]], false, rowOf(fall));
    };
    ParticleRow& row = set.position[set.candidateOf[c]];
    ParticleRow& motion = set.motion[set.candidateOf[c]];
    const Vec3f& position = set.candidates[c];
    const bool touched = next < touches.size() && touches[next].particle == c;
    Vec3f way = vectorOf(motion);
    if (row.w > 0.0f) way += static_cast<float>(ParticleSet::Substeps::kPerPush) * fall;
    if (!touched) {
      if (row.w > 0.0f) {
        row = rowOf(set.room.nearest(position));
        motion = rowOf(way);
        aim();
      }
      continue;
    }
    const Vec3f velocity = way / seconds;
    way = (velocity + velocityChange(touches[next++], velocity, static_cast<float>(settings.friction))) * seconds;
    const float length = way.norm();
    if (length > kFastestGrain * diameter) way *= kFastestGrain * diameter / length;
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
void Granular::State::rouse(float seconds) {
  if (!anySleeps) return;
  const float rousing = kRousing * quietWay(settings, seconds);
  set.forBlocks([&](std::size_t firstBlock, std::size_t lastBlock) {
    for (std::size_t block = firstBlock; block < lastBlock; ++block) {
      const std::size_t last = std::min(set.count, (block + 1) * kParticleBlock);
      for (std::size_t i = block * kParticleBlock; i < last; ++i) {
        const ParticleRow& way = set.motion[i];
        if (asleep[i] != 0 || way.x * way.x + way.y * way.y + way.z * way.z < rousing * rousing) continue;
        const std::uint32_t* slots = set.lists.slots(block) + i % kParticleBlock;
        for (int s = 0; s < set.lists.slotCount(block); ++s) {
          const std::uint32_t other = slots[s * kParticleBlock];
          if (asleep[other] != 0) std::atomic_ref<std::uint8_t>(woken[other]).store(1, std::memory_order_relaxed);
        }
      }
    }
  });
}

Result<Granular> Granular::create(const GranularSettings& settings) {
  LORICA_TRY_DO(checkAboveZero("grain radius", settings.radius));
  LORICA_TRY_DO(checkAboveZero("length of substeps", settings.substepSeconds));
  return Granular(std::make_unique<State>(settings));
}
Granular::Granular(std::unique_ptr<State> state) : state_(std::move(state)) {}
Granular::~Granular() = default;
Granular::Granular(Granular&&) noexcept = default;
Granular& Granular::operator=(Granular&&) noexcept = default;

std::size_t Granular::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  return state_->add(positions, velocity);
}

void Granular::step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  state_->step(parts, seconds, bodies);
}

std::span<const Vec3f> Granular::positions() const {
  return {state_->set.positions.data(), state_->set.count};
}

std::span<const Vec3f> Granular::velocities() const {
  return {state_->set.velocities.data(), state_->set.count};
}

const GranularSettings& Granular::settings() const {
  return state_->settings;
}

std::size_t Granular::awakeCount() const {
  const std::span<const ParticleRow> motions = std::span(state_->set.motion).first(state_->set.count);
  return std::count_if(motions.begin(), motions.end(), [](const ParticleRow& motion) { return motion.w < kAsleep; });
}

}  // namespace lorica
