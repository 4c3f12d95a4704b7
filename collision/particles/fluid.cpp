#include "collision/particles/fluid.h"

#include "collision/particles/particle_set.h"
#include "collision/particles/standing_water.h"
#include "collision/particles/substep_kernel.h"
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

struct Fluid::State {
  explicit State(const FluidSettings& wanted);

  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity);
  void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies);
  void holdUp();
  void predict(float seconds, bool sorts);
  void keepVolume(float seconds);
  void findMotions(float seconds);
  void meetBodies();
  void pressBodies(float seconds);
  void touchBodies(float seconds);
  void pushOut(float seconds);
  /// That any particle can be from where it was sorted [m].
  [[nodiscard]] float farthest() const {
    return (1.0f + (kSubstepsPerSort - 1) * kFastest + kSubstepsPerSort * kLongestMove * settings.iterations) * spacing;
  }

  FluidSettings settings;
  ParticleSet set;  // motions are velocities [m/s]
  float spacing;
  FluidKernels kernels;
  std::vector<ParticleRow> before;  // positions in the previous substep
  std::vector<float> pressure, nextPressure;
  std::vector<float> lasting, nextLasting;  // its mean over time
  float pressureSeconds = 0.0f;             // of the substep that the pressures belong to
  StandingWater standing;
  std::vector<StandingWater::Solid> solids;
  std::vector<ParticleRow> lift, nextLift;  // see StandingWater
  double mass;                              // of a particle [kg]
  std::vector<ParticleRow> bodyWalls;       // see BodyTerms; all 0 where no body is near
  std::vector<float> bodyYielding;
  std::span<const ParticleBodies::Contact> contacts;
};

Fluid::State::State(const FluidSettings& wanted)
    : settings(wanted),
      set(wanted.capacity, particleRoom(wanted.floor, wanted.walls, 0.5 * wanted.spacing), 0.5 * wanted.spacing,
          kMaxNeighbours),
      spacing(wanted.spacing),
      kernels(makeKernels(wanted.spacing)),
      before(set.position.size()),
      pressure(set.position.size()),
      nextPressure(set.position.size()),
      lasting(set.position.size()),
      nextLasting(set.position.size()),
      standing(wanted.capacity, spacing, set.room.min - Vec3f::Constant(0.5f * spacing),
               set.room.max + Vec3f::Constant(0.5f * spacing)),
      lift(set.position.size()),
      nextLift(set.position.size()),
      mass(wanted.density * std::pow(wanted.spacing, 3.0)),
      bodyWalls(set.position.size()),
      bodyYielding(set.position.size()) {
  const Vec3f half(0.5f * spacing, 0.5f * spacing, 0.5f * spacing);
  kernels.min = rowOf(set.room.min - half);
  kernels.max = rowOf(set.room.max + half);
}

std::size_t Fluid::State::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  const Vec3f speed = velocity.cast<float>();
  const std::size_t added = set.add(positions, speed, speed);
  std::fill_n(pressure.begin() + (set.count - added), added, 0.0f);
  std::fill_n(lasting.begin() + (set.count - added), added, 0.0f);
  return added;
}

void Fluid::State::step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  if (set.count == 0) return;
  const ParticleSet::Substeps substeps = set.beginFrame(parts, bodies, seconds, settings.substepSeconds);
  holdUp();
  for (int substep = 0; substep < substeps.count; ++substep) {
    predict(substeps.seconds, substep % kSubstepsPerSort == 0);
    if (!set.rigid.empty()) {
      set.rigid.advance(substep);
      set.rigid.gather(set.grid, set.position, kernels.reach + spacing, farthest());
    }
    keepVolume(substeps.seconds);
    findMotions(substeps.seconds);
    if (!set.rigid.empty()) touchBodies(substeps.seconds);
    if (substeps.pushes(substep)) {
      set.body.advance(substep);
      pushOut(substeps.seconds);
    }
  }
  set.endFrame(bodies);
  set.publish(1.0f);
}

// A drop's own pressures cannot hold up a high column in few iterations. So nine tenths of the weight of standing water
// is taken off it for the frame; what it then lacks or has too much, they correct. All of the weight would leave
// nothing that brings drops back together.
void Fluid::State::holdUp() {
  solids.clear();
  const auto add = [&](const Vec3f& min, const Vec3f& max) { solids.push_back({min, max}); };
  for (const ParticleObstacle::Sweep& sweep : set.body.sweeps()) {
    add({sweep.min[0], sweep.min[1], sweep.min[2]}, {sweep.max[0], sweep.max[1], sweep.max[2]});
  }
  set.rigid.forBoxes(add);
  standing.find({set.position.data(), set.count}, settings.gravity.cast<float>(), solids);
  set.forEach([&](std::size_t i) { lift[i] = standing.lift(i, set.position[i]); });
}

// Applies gravity and moves the particles. In every second substep, sorts them by their new positions and finds their
// neighbours there.
void Fluid::State::predict(float seconds, bool sorts) {
  const Vec3f fall = settings.gravity.cast<float>() * seconds;
  const float fastest = kFastest * spacing / seconds;
  set.forEach([&](std::size_t i) {
    const Vec3f speed = vectorOf(set.motion[i]) + fall + kHeld * seconds * vectorOf(lift[i]);
    const float length = std::sqrt(speed.x() * speed.x() + speed.y() * speed.y() + speed.z() * speed.z());
    const float rate = length > fastest ? fastest / length * seconds : seconds;
    set.nextPosition[i] = rowOf(set.room.nearest(vectorOf(set.position[i]) + rate * speed));
  });
  if (!sorts) {
    std::swap(before, set.position);
    std::swap(set.position, set.nextPosition);
    return;
  }
  const float listed = kListed * kernels.reach;
  set.sort({set.nextPosition.data(), set.count}, listed, kRows, [&](std::size_t i, std::size_t from) {
    before[i] = set.position[from];
    nextPressure[i] = pressure[from];
    nextLasting[i] = lasting[from];
    nextLift[i] = lift[from];
  });
  std::swap(pressure, nextPressure);
  std::swap(lasting, nextLasting);
  std::swap(lift, nextLift);
  set.forEach([&](std::size_t i) { set.position[i] = {set.x[i], set.y[i], set.z[i], 0.0f}; });
  set.lists.build(set.grid, set.x.data(), set.y.data(), set.z.data(), set.count, listed, {});
}

// Pressures start from those of the previous substep.
void Fluid::State::keepVolume(float seconds) {
  const ParticleRow min = rowOf(set.room.min), max = rowOf(set.room.max);
  const float rate = pressureSeconds > 0.0f ? seconds / pressureSeconds : 0.0f;
  const float scale = rate * rate;  // pressures are in units of displacement
  const float share = std::min(1.0f, seconds / kLasting);
  pressureSeconds = seconds;
  // A pressure that is only partly kept yields to a column's weight; one that is kept entirely makes it swing. So where
  // standing water is not held up, the part that is lost is replaced by what lasts.
  set.forEach([&](std::size_t i) {
    const float mean = scale * (lasting[i] + share * (pressure[i] - lasting[i])), now = scale * pressure[i];
    lasting[i] = std::min(mean, now);
    const float held = lift[i].w, kept = kKeptPressure + held * (kKeptStanding - kKeptPressure);
    pressure[i] = kept * now + (1.0f - kKeptPressure) * (1.0f - held) * lasting[i];
  });
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    const float pressed = iteration == 0 ? 0.0f : 1.0f;
    BodyTerms terms;
    if (!set.rigid.empty()) {
      meetBodies();
      terms = {bodyWalls.data(), bodyYielding.data()};
    }
    set.forBlocks([&](std::size_t begin, std::size_t end) {
      findPressures(kernels, set.position.data(), set.lists, terms, begin, end, pressure.data(), pressed,
                    set.nextPosition.data());
    });
    set.forBlocks([&](std::size_t begin, std::size_t end) {
      movePressed(kernels, set.nextPosition.data(), set.lists, terms, min, max, kLongestMove * spacing, begin, end,
                  set.position.data());
    });
    if (!set.rigid.empty()) pressBodies(seconds);
  }
}

// A body's surface counts as a wall. Its mass is divided among the particles near it, so that all of them together do
// not push it farther than they should.
void Fluid::State::meetBodies() {
  contacts = set.rigid.find(set.position, kernels.reach);
  for (const ParticleBodies::Contact& contact : contacts) {
    const Wall wall = wallAt(kernels, contact.distance);
    ParticleRow& sum = bodyWalls[contact.particle];
    const Vec3f slope = wall.slope * contact.normal;
    sum = {sum.x + slope.x(), sum.y + slope.y(), sum.z + slope.z(), sum.w + wall.density};
    const double yielding = set.rigid.yielding(contact, set.position[contact.particle]);
    bodyYielding[contact.particle] +=
        static_cast<float>(mass * yielding * set.rigid.contactsOf(contact.body)) * wall.slope * wall.slope;
  }
}

// What particles were moved by a body's surface, they push the body.
void Fluid::State::pressBodies(float seconds) {
  for (const ParticleBodies::Contact& contact : contacts) {
    const ParticleRow& at = set.position[contact.particle];
    const Vec3f way = -at.w * wallAt(kernels, contact.distance).slope * contact.normal;
    set.rigid.push(contact, at, mass / seconds * way.cast<double>());
    bodyWalls[contact.particle] = {};
    bodyYielding[contact.particle] = 0.0f;
  }
  set.rigid.follow();
}

// Particles that are too fast for the pressure to hold them off, and those that the surface drags along.
void Fluid::State::touchBodies(float seconds) {
  const float touching = kTouching * spacing;
  for (const ParticleBodies::Contact& contact : set.rigid.find(set.position, spacing)) {
    ParticleRow &at = set.position[contact.particle], &motion = set.motion[contact.particle];
    Vec3f velocity = vectorOf(motion);
    velocity += set.rigid.drag(contact, at, velocity, mass, kDrag * settings.viscosity);
    const double leaving = std::min(0.0f, (touching - contact.distance) / seconds);
    velocity += set.rigid.collide(contact, at, velocity, 1.0 / mass, 0.0, leaving);
    motion = rowOf(velocity);
    if (contact.distance >= touching) continue;
    at = rowOf(set.room.nearest(vectorOf(at) + (touching - contact.distance) * contact.normal));
  }
  set.rigid.follow();
}

// Velocities are what the particles moved, made more alike by viscosity.
void Fluid::State::findMotions(float seconds) {
  set.forEach([&](std::size_t i) {
    const ParticleRow &to = set.position[i], &from = before[i];
    set.motion[i] = {(to.x - from.x) / seconds, (to.y - from.y) / seconds, (to.z - from.z) / seconds, 0.0f};
  });
  set.forBlocks([&](std::size_t begin, std::size_t end) {
    blendMotions(kernels, set.position.data(), set.motion.data(), set.lists, static_cast<float>(settings.viscosity),
                 begin, end, set.nextMotion.data());
  });
  std::swap(set.motion, set.nextMotion);
}

void Fluid::State::pushOut(float seconds) {
  if (!set.markAround(ParticleSet::Parts::kAll, farthest(), set.nearBody)) return;
  set.candidates.clear();
  set.candidateOf.clear();
  for (std::size_t i = 0; i < set.count; ++i) {
    if (set.nearBody[i] == 0) continue;
    set.nearBody[i] = 0;
    set.candidates.push_back(vectorOf(set.position[i]));
    set.candidateOf.push_back(i);
  }
  const float fastest = kFastest * spacing / seconds;
  for (const ParticleTouch& touch : set.body.push(set.candidates, set.room)) {
    const std::size_t i = set.candidateOf[touch.particle];
    Vec3f velocity = vectorOf(set.motion[i]);
    velocity += velocityChange(touch, velocity);
    const float speed = velocity.norm();
    if (speed > fastest) velocity *= fastest / speed;
    set.position[i] = rowOf(set.candidates[touch.particle]);
    set.motion[i] = rowOf(velocity);
  }
}

Result<Fluid> Fluid::create(const FluidSettings& settings) {
  LORICA_TRY_DO(checkAboveZero("particle spacing", settings.spacing));
  LORICA_TRY_DO(checkAboveZero("length of substeps", settings.substepSeconds));
  LORICA_TRY_DO(checkAboveZero("number of iterations", settings.iterations));
  return Fluid(std::make_unique<State>(settings));
}
Fluid::Fluid(std::unique_ptr<State> state) : state_(std::move(state)) {}
Fluid::~Fluid() = default;
Fluid::Fluid(Fluid&&) noexcept = default;
Fluid& Fluid::operator=(Fluid&&) noexcept = default;

std::size_t Fluid::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  return state_->add(positions, velocity);
}

void Fluid::step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies) {
  state_->step(parts, seconds, bodies);
}

std::span<const Vec3f> Fluid::positions() const {
  return {state_->set.positions.data(), state_->set.count};
}

std::span<const Vec3f> Fluid::velocities() const {
  return {state_->set.velocities.data(), state_->set.count};
}

const FluidSettings& Fluid::settings() const {
  return state_->settings;
}

}  // namespace lorica
