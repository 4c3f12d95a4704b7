#include "collision/particles/fluid.h"

#include "geometry/result.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr double kReach = 1.7;         // of the kernels, in spacings
constexpr int kSubstepsPerSort = 2;    // during which lists of neighbours stay valid
constexpr float kListed = 1.06f;       // reach of the lists, as a multiple of the kernels'
constexpr int kRows = 3;               // of the grid: a run has a dozen particles, which fills most of a vector
constexpr int kMaxNeighbours = 64;     // at rest there are 18 to 30
constexpr double kSoftening = 0.02;    // of the sum of squared slopes at rest
constexpr float kRelaxation = 0.7f;    // fraction of the density error that a pressure corrects
constexpr float kKeptPressure = 0.6f;  // fraction kept from one substep to the next; the rest is kept as its ...
constexpr float kLasting = 0.5f;       // ... mean of about so long, and at most as much as there was [s]
constexpr float kKeptStanding = 0.4f;  // instead, in standing water
constexpr float kHeld = 0.9f;          // of the weight, by the pressures of standing water
constexpr float kLongestMove = 0.25f;  // of an iteration, in spacings
constexpr float kFastest = 5.0f;       // max motion in a substep, in spacings
constexpr float kTouching = 0.3f;      // distance that centres keep from rigid bodies, in spacings
constexpr double kDrag = 0.5;          // along a rigid body, multiple of the viscosity

/// Density 1 for particles on a cubic lattice.
FluidKernels makeKernels(double spacing) {
  const double reach = kReach * spacing;
  double sum = 0.0, squares = 0.0, behind = 0.0, slopeBehind = 0.0;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        const double r = spacing * std::sqrt(x * x + y * y + z * z);
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

/// What a rigid body's surface adds at a distance, as a wall does: see substep_kernel.cpp.
struct Wall {
  float density, slope;
};
Wall wallAt(const FluidKernels& k, float distance) {
  const float q = std::clamp(1.0f - distance / k.reach, 0.0f, 1.0f), q4 = q * q * q * q;
  const float sum = 16.0f / 5.0f + q * (-16.0f / 3.0f + q * (24.0f / 7.0f + q * (-1.0f + q / 9.0f)));
  return {k.wallDensity * q4 * q * sum, k.wallSlope * q4 * (1.0f / 6.0f - q * (2.0f / 15.0f))};
}

}  // namespace

Fluid::Fluid(const FluidSettings& wanted)
    : ParticleSimulation({wanted.capacity, particleRoom(wanted.floor, wanted.walls, 0.5 * wanted.spacing),
                          0.5 * wanted.spacing, kMaxNeighbours}),
      settings_(wanted),
      spacing_(wanted.spacing),
      kernels_(makeKernels(wanted.spacing)),
      before_(set_.position.size()),
      pressure_(set_.position.size()),
      nextPressure_(set_.position.size()),
      lasting_(set_.position.size()),
      nextLasting_(set_.position.size()),
      standing_(wanted.capacity, spacing_, set_.room.min - Vec3f::Constant(0.5f * spacing_),
                set_.room.max + Vec3f::Constant(0.5f * spacing_)),
      lift_(set_.position.size()),
      nextLift_(set_.position.size()),
      mass_(wanted.density * std::pow(wanted.spacing, 3.0)),
      bodyWalls_(set_.position.size()),
      bodyYielding_(set_.position.size()) {
  const Vec3f half(0.5f * spacing_, 0.5f * spacing_, 0.5f * spacing_);
  kernels_.min = rowOf(set_.room.min - half);
  kernels_.max = rowOf(set_.room.max + half);
}

std::size_t Fluid::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  const Vec3f speed = velocity.cast<float>();
  const std::size_t added = set_.add(positions, speed, speed);
  std::fill_n(pressure_.begin() + (set_.count - added), added, 0.0f);
  std::fill_n(lasting_.begin() + (set_.count - added), added, 0.0f);
  return added;
}

void Fluid::step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  if (set_.count == 0) return;
  const ParticleSet::Substeps substeps = set_.beginFrame(parts, bodies, seconds, settings_.substepSeconds);
  holdUp();
  for (int substep = 0; substep < substeps.count; ++substep) {
    predict(substeps.seconds, substep % kSubstepsPerSort == 0);
    if (!set_.rigid.empty()) {
      set_.rigid.advance(substep);
      set_.rigid.gather(set_.grid, set_.position, kernels_.reach + spacing_, farthest());
    }
    keepVolume(substeps.seconds);
    findMotions(substeps.seconds);
    if (!set_.rigid.empty()) touchBodies(substeps.seconds);
    if (substeps.pushes(substep)) {
      set_.body.advance(substep);
      pushOut(substeps.seconds);
    }
  }
  set_.endFrame(bodies);
  set_.publish(1.0f);
}

// A drop's own pressures cannot hold up a high column in few iterations. So nine tenths of the weight of standing
// water is taken off it for the frame; what it then lacks or has too much, they correct. All of the weight would leave
// nothing that brings drops back together.
void Fluid::holdUp() {
  solids_.clear();
  const auto add = [&](const Vec3f& min, const Vec3f& max) { solids_.push_back({min, max}); };
  for (const ParticleObstacle::Sweep& sweep : set_.body.sweeps()) {
    add({sweep.min[0], sweep.min[1], sweep.min[2]}, {sweep.max[0], sweep.max[1], sweep.max[2]});
  }
  set_.rigid.forBoxes(add);
  standing_.find({set_.position.data(), set_.count}, settings_.gravity.cast<float>(), solids_);
  set_.forEach([&](std::size_t i) { lift_[i] = standing_.lift(i, set_.position[i]); });
}

// Applies gravity and moves the particles. In every second substep, sorts them by their new positions and finds their
// neighbours there.
void Fluid::predict(float seconds, bool sorts) {
  const Vec3f fall = settings_.gravity.cast<float>() * seconds;
  const float fastest = kFastest * spacing_ / seconds;
  set_.forEach([&](std::size_t i) {
    const Vec3f speed = vectorOf(set_.motion[i]) + fall + kHeld * seconds * vectorOf(lift_[i]);
    const float length = std::sqrt(speed.x() * speed.x() + speed.y() * speed.y() + speed.z() * speed.z());
    const float rate = length > fastest ? fastest / length * seconds : seconds;
    set_.nextPosition[i] = rowOf(set_.room.nearest(vectorOf(set_.position[i]) + rate * speed));
  });
  if (!sorts) {
    std::swap(before_, set_.position);
    std::swap(set_.position, set_.nextPosition);
    return;
  }
  const float listed = kListed * kernels_.reach;
  set_.sort({set_.nextPosition.data(), set_.count}, listed, kRows, [&](std::size_t i, std::size_t from) {
    before_[i] = set_.position[from];
    nextPressure_[i] = pressure_[from];
    nextLasting_[i] = lasting_[from];
    nextLift_[i] = lift_[from];
  });
  std::swap(pressure_, nextPressure_);
  std::swap(lasting_, nextLasting_);
  std::swap(lift_, nextLift_);
  set_.forEach([&](std::size_t i) { set_.position[i] = {set_.x[i], set_.y[i], set_.z[i], 0.0f}; });
  set_.lists.build(set_.grid, set_.x.data(), set_.y.data(), set_.z.data(), set_.count, listed, {});
}

// Pressures start from those of the previous substep.
void Fluid::keepVolume(float seconds) {
  const ParticleRow min = rowOf(set_.room.min), max = rowOf(set_.room.max);
  const float rate = pressureSeconds_ > 0.0f ? seconds / pressureSeconds_ : 0.0f;
  const float scale = rate * rate;  // pressures are in units of displacement
  const float share = std::min(1.0f, seconds / kLasting);
  pressureSeconds_ = seconds;
  // A pressure that is only partly kept yields to a column's weight; one that is kept entirely makes it swing. So
  // where standing water is not held up, the part that is lost is replaced by what lasts.
  set_.forEach([&](std::size_t i) {
    const float mean = scale * (lasting_[i] + share * (pressure_[i] - lasting_[i])), now = scale * pressure_[i];
    lasting_[i] = std::min(mean, now);
    const float held = lift_[i].w, kept = kKeptPressure + held * (kKeptStanding - kKeptPressure);
    pressure_[i] = kept * now + (1.0f - kKeptPressure) * (1.0f - held) * lasting_[i];
  });
  for (int iteration = 0; iteration < settings_.iterations; ++iteration) {
    const float pressed = iteration == 0 ? 0.0f : 1.0f;
    BodyTerms terms;
    if (!set_.rigid.empty()) {
      meetBodies();
      terms = {bodyWalls_.data(), bodyYielding_.data()};
    }
    set_.forBlocks([&](std::size_t begin, std::size_t end) {
      findPressures(kernels_, set_.position.data(), set_.lists, terms, begin, end, pressure_.data(), pressed,
                    set_.nextPosition.data());
    });
    set_.forBlocks([&](std::size_t begin, std::size_t end) {
      movePressed(kernels_, set_.nextPosition.data(), set_.lists, terms, min, max, kLongestMove * spacing_, begin, end,
                  set_.position.data());
    });
    if (!set_.rigid.empty()) pressBodies(seconds);
  }
}

// A body's surface counts as a wall. Its mass is divided among the particles near it, so that all of them together do
// not push it farther than they should.
void Fluid::meetBodies() {
  contacts_ = set_.rigid.find(set_.position, kernels_.reach);
  for (const ParticleBodies::Contact& contact : contacts_) {
    const Wall wall = wallAt(kernels_, contact.distance);
    ParticleRow& sum = bodyWalls_[contact.particle];
    const Vec3f slope = wall.slope * contact.normal;
    sum = {sum.x + slope.x(), sum.y + slope.y(), sum.z + slope.z(), sum.w + wall.density};
    const double yielding = set_.rigid.yielding(contact, set_.position[contact.particle]);
    bodyYielding_[contact.particle] +=
        static_cast<float>(mass_ * yielding * set_.rigid.contactsOf(contact.body)) * wall.slope * wall.slope;
  }
}

// What particles were moved by a body's surface, they push the body.
void Fluid::pressBodies(float seconds) {
  for (const ParticleBodies::Contact& contact : contacts_) {
    const ParticleRow& at = set_.position[contact.particle];
    const Vec3f way = -at.w * wallAt(kernels_, contact.distance).slope * contact.normal;
    set_.rigid.push(contact, at, mass_ / seconds * way.cast<double>());
    bodyWalls_[contact.particle] = {};
    bodyYielding_[contact.particle] = 0.0f;
  }
  set_.rigid.follow();
}

// Particles that are too fast for the pressure to hold them off, and those that the surface drags along.
void Fluid::touchBodies(float seconds) {
  const float touching = kTouching * spacing_;
  for (const ParticleBodies::Contact& contact : set_.rigid.find(set_.position, spacing_)) {
    ParticleRow &at = set_.position[contact.particle], &motion = set_.motion[contact.particle];
    Vec3f velocity = vectorOf(motion);
    velocity += set_.rigid.drag(contact, at, velocity, mass_, kDrag * settings_.viscosity);
    const double leaving = std::min(0.0f, (touching - contact.distance) / seconds);
    velocity += set_.rigid.collide(contact, at, velocity, 1.0 / mass_, 0.0, leaving);
    motion = rowOf(velocity);
    if (contact.distance >= touching) continue;
    at = rowOf(set_.room.nearest(vectorOf(at) + (touching - contact.distance) * contact.normal));
  }
  set_.rigid.follow();
}

// Velocities are what the particles moved, made more alike by viscosity.
void Fluid::findMotions(float seconds) {
  set_.forEach([&](std::size_t i) {
    const ParticleRow &to = set_.position[i], &from = before_[i];
    set_.motion[i] = {(to.x - from.x) / seconds, (to.y - from.y) / seconds, (to.z - from.z) / seconds, 0.0f};
  });
  set_.forBlocks([&](std::size_t begin, std::size_t end) {
    blendMotions(kernels_, set_.position.data(), set_.motion.data(), set_.lists,
                 static_cast<float>(settings_.viscosity), begin, end, set_.nextMotion.data());
  });
  std::swap(set_.motion, set_.nextMotion);
}

void Fluid::pushOut(float seconds) {
  if (!set_.markAround(ParticleSet::Parts::kAll, farthest(), set_.nearBody)) return;
  set_.candidates.clear();
  set_.candidateOf.clear();
  for (std::size_t i = 0; i < set_.count; ++i) {
    if (set_.nearBody[i] == 0) continue;
    set_.nearBody[i] = 0;
    set_.candidates.push_back(vectorOf(set_.position[i]));
    set_.candidateOf.push_back(i);
  }
  const float fastest = kFastest * spacing_ / seconds;
  for (const ParticleTouch& touch : set_.body.push(set_.candidates, set_.room)) {
    const std::size_t i = set_.candidateOf[touch.particle];
    Vec3f velocity = vectorOf(set_.motion[i]);
    velocity += velocityChange(touch, velocity);
    const float speed = velocity.norm();
    if (speed > fastest) velocity *= fastest / speed;
    set_.position[i] = rowOf(set_.candidates[touch.particle]);
    set_.motion[i] = rowOf(velocity);
  }
}

float Fluid::farthest() const {
  return (1.0f + (kSubstepsPerSort - 1) * kFastest + kSubstepsPerSort * kLongestMove * settings_.iterations) * spacing_;
}

Result<Fluid> Fluid::create(const FluidSettings& settings) {
  LORICA_TRY_DO(checkAboveZero("particle spacing", settings.spacing));
  LORICA_TRY_DO(checkAboveZero("length of substeps", settings.substepSeconds));
  LORICA_TRY_DO(checkAboveZero("number of iterations", settings.iterations));
  return Fluid(settings);
}

}  // namespace lorica
