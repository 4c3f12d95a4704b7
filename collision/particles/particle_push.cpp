#include "collision/particles/particle_push.h"

#include "collision/particles/particle_push_grid.h"
#include "collision/particles/particle_push_hulls.h"
#include "collision/particles/particle_push_kernel.h"
#include "geometry/errors.h"
#include "geometry/result.h"
#include "geometry/threads.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// Particles processed at once: many, so that cells have several, but enough chunks for all threads.
constexpr std::size_t kSmallestChunk = 4096, kLargestChunk = 32768, kChunks = 16;
/// Min number of cells in the box of all hulls. More take longer to build; with fewer, each has more planes.
constexpr double kFewestCells = 500.0;
constexpr double kMaxCells = 10000.0;
constexpr double kParticlesOfCell = 8.0;

}  // namespace

struct ParticlePush::State {
  explicit State(const ParticlePushSettings& wanted)
      : settings(wanted), arena(wanted.threads > 0 ? wanted.threads : tbb::task_arena::automatic) {}

  ParticlePushSettings settings;
  tbb::task_arena arena;
  PushHulls hulls;
  PushGrid grid;
  double cells = 0.0;    ///< of the grid, approximately; 0: it is not built yet
  std::size_t room = 0;  ///< capacity of `touches`
  /// Each chunk writes at the index of its first particle, so only memory that is written is ever touched.
  std::unique_ptr<ParticleTouch[]> touches;
  std::vector<std::size_t> countOfChunk;
  std::vector<PushScratch> scratch;  ///< of each thread
};

Result<ParticlePush> ParticlePush::create(const ParticlePushSettings& settings) {
  if (settings.radius >= 0.0 && std::isfinite(settings.radius)) return ParticlePush(std::make_unique<State>(settings));
  return invalidArgument("found a particle radius of {:g} m, expected 0 or more", settings.radius);
}
ParticlePush::ParticlePush(std::unique_ptr<State> state) : state_(std::move(state)) {}
ParticlePush::~ParticlePush() = default;
ParticlePush::ParticlePush(ParticlePush&&) noexcept = default;
ParticlePush& ParticlePush::operator=(ParticlePush&&) noexcept = default;

void ParticlePush::prepare(std::span<const LivePart> parts, double seconds, bool again) {
  LORICA_CHECK(seconds > 0.0, "the time between frames must be above 0");
  state_->hulls.prepare(parts, seconds, state_->settings.radius, again);
  state_->cells = 0.0;
}

std::span<const ParticleTouch> ParticlePush::push(std::span<Vec3f> positions) {
  State& s = *state_;
  LORICA_CHECK(positions.size() <= std::numeric_limits<std::uint32_t>::max(),
               "the number of particles must fit in 32 bits");
  if (s.hulls.hulls().empty() || positions.empty()) return {};
  const double cells = std::clamp(positions.size() / kParticlesOfCell, kFewestCells, kMaxCells);
  if (s.cells < 0.5 * cells) {
    s.cells = cells;
    s.grid.build(s.hulls, cells);
  }
  const std::size_t size = std::clamp(positions.size() / kChunks, kSmallestChunk, kLargestChunk);
  const std::size_t chunks = (positions.size() + size - 1) / size;
  if (s.room < positions.size()) {
    s.room = positions.size();
    s.touches = std::make_unique_for_overwrite<ParticleTouch[]>(s.room);
  }
  s.countOfChunk.resize(std::max(s.countOfChunk.size(), chunks));

  const bool alone = s.settings.threads == 1 || chunks == 1;
  s.scratch.resize(std::max<std::size_t>(s.scratch.size(), alone ? 1 : s.arena.max_concurrency()));
  for (PushScratch& own : s.scratch) own.reserveRows(std::min(size, positions.size()), s.grid.lists.size());
  const auto work = [&](std::size_t chunk) {
    const std::size_t first = chunk * size;
    s.countOfChunk[chunk] =
        pushParticles(s.hulls, s.grid, positions[first].data(), std::min(size, positions.size() - first),
                      static_cast<std::uint32_t>(first),
                      s.scratch[alone ? 0 : tbb::this_task_arena::current_thread_index()], s.touches.get() + first);
  };
  if (alone) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) work(chunk);
  } else {
    s.arena.execute([&] { parallelFor(chunks, work); });
  }

  std::size_t count = s.countOfChunk[0];
  for (std::size_t chunk = 1; chunk < chunks; ++chunk) {
    const ParticleTouch* from = s.touches.get() + chunk * size;
    std::copy(from, from + s.countOfChunk[chunk], s.touches.get() + count);
    count += s.countOfChunk[chunk];
  }
  return {s.touches.get(), count};
}

Vec3f velocityChange(const ParticleTouch& touch, const Vec3f& velocity, float friction) {
  const Vec3f relative = velocity - touch.surfaceVelocity;
  const float along = relative.dot(touch.normal);
  if (!(along < 0.0F)) return Vec3f::Zero();
  const Vec3f sliding = relative - along * touch.normal;
  const float speed = sliding.norm();
  const float stopped = speed > 0.0F ? std::min(friction * -along / speed, 1.0F) : 0.0F;
  return -along * touch.normal - stopped * sliding;
}

}  // namespace lorica
