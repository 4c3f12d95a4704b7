#include "collision/particles/fluid.h"

#include "collision/particles/fluid_kernel.h"
#include "collision/particles/particle_set.h"
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

}  // namespace

struct Fluid::State {
  explicit State(const FluidSettings& wanted);

  std::size_t add(std::span<const Vec3f> positions, const Vec3& velocity);
  void step(std::span<const LivePart> parts, double seconds);
  void predict(float seconds, bool sorts);
  void keepVolume(float seconds);
  void findMotions(float seconds);
  void pushOut(float seconds);

  FluidSettings settings;
  ParticleSet set;  // motions are velocities [m/s]
  float spacing;
  FluidKernels kernels;
  std::vector<ParticleRow> before;  // positions in the previous substep
  std::vector<float> pressure, nextPressure;
  float pressureSeconds = 0.0f;    // of the substep that the pressures belong to
  std::vector<std::uint8_t> none;  // excludes no particle from the lists
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
      none(set.position.size()) {
  LORICA_CHECK(settings.spacing > 0.0 && settings.substepSeconds > 0.0 && settings.iterations > 0,
               "particle spacing, substep length and iterations must be above 0");
  const Vec3f half(0.5f * spacing, 0.5f * spacing, 0.5f * spacing);
  kernels.min = rowOf(set.room.min - half);
  kernels.max = rowOf(set.room.max + half);
}

std::size_t Fluid::State::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  const Vec3f speed = velocity.cast<float>();
  const std::size_t added = set.add(positions, speed, speed);
  std::fill_n(pressure.begin() + (set.count - added), added, 0.0f);
  return added;
}

void Fluid::State::step(std::span<const LivePart> parts, double seconds) {
  if (set.count == 0) return;
  const ParticleSet::Substeps substeps = set.beginFrame(parts, seconds, settings.substepSeconds);
  for (int substep = 0; substep < substeps.count; ++substep) {
    predict(substeps.seconds, substep % kSubstepsPerSort == 0);
    keepVolume(substeps.seconds);
    findMotions(substeps.seconds);
    if (substeps.pushes(substep)) {
      set.body.advance(substep);
      pushOut(substeps.seconds);
    }
  }
  set.publish(1.0f);
}

// Applies gravity and moves the particles. In every second substep, sorts them by their new positions and finds their
// neighbours there.
void Fluid::State::predict(float seconds, bool sorts) {
  const Vec3f fall = settings.gravity.cast<float>() * seconds;
  const float fastest = kFastest * spacing / seconds;
  set.forEach([&](std::size_t i) {
    const Vec3f speed = vectorOf(set.motion[i]) + fall;
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
  set.sort(listed, kRows, [&](std::size_t i, std::size_t from) {
    before[i] = set.position[from];
    nextPressure[i] = pressure[from];
  });
  std::swap(pressure, nextPressure);
  set.forEach([&](std::size_t i) { set.position[i] = {set.x[i], set.y[i], set.z[i], 0.0f}; });
  set.lists.build(set.grid, set.x.data(), set.y.data(), set.z.data(), set.count, listed, none);
}

// Pressures start from those of the previous substep: the pressure that supports a column of water takes many substeps
// to build up.
void Fluid::State::keepVolume(float seconds) {
  const ParticleRow min = rowOf(set.room.min), max = rowOf(set.room.max);
  const float rate = pressureSeconds > 0.0f ? seconds / pressureSeconds : 0.0f;
  const float kept = kKeptPressure * rate * rate;  // pressures are in units of displacement
  pressureSeconds = seconds;
  set.forEach([&](std::size_t i) { pressure[i] *= kept; });
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    const float pressed = iteration == 0 ? 0.0f : 1.0f;
    set.forBlocks([&](std::size_t begin, std::size_t end) {
      findPressures(kernels, set.position.data(), set.lists, begin, end, pressure.data(), pressed,
                    set.nextPosition.data());
    });
    set.forBlocks([&](std::size_t begin, std::size_t end) {
      movePressed(kernels, set.nextPosition.data(), set.lists, min, max, kLongestMove * spacing, begin, end,
                  set.position.data());
    });
  }
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
  // The farthest that any particle can move since the sorting.
  const float margin =
      (1.0f + (kSubstepsPerSort - 1) * kFastest + kSubstepsPerSort * kLongestMove * settings.iterations) * spacing;
  if (!set.markAround(ParticleSet::Parts::kAll, margin, set.nearBody)) return;
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

Fluid::Fluid(const FluidSettings& settings) : state_(std::make_unique<State>(settings)) {}
Fluid::~Fluid() = default;
Fluid::Fluid(Fluid&&) noexcept = default;
Fluid& Fluid::operator=(Fluid&&) noexcept = default;

std::size_t Fluid::add(std::span<const Vec3f> positions, const Vec3& velocity) {
  return state_->add(positions, velocity);
}

void Fluid::step(std::span<const LivePart> parts, double seconds) {
  state_->step(parts, seconds);
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
