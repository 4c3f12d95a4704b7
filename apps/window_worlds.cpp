#include "apps/interrupt.h"
#include "apps/scenes.h"
#include "apps/window_loop_impl.h"

#include <thread>
#include <utility>

namespace lorica {
namespace {

constexpr std::chrono::milliseconds kPictureWait(30);

}  // namespace

/// In the first step sand and water may have to settle, which takes seconds: that runs beside the picture. Closing the
/// window and Cancel end it, and the session.
Result<bool> WindowLoop::stepSession() {
  if (started_ || !mustSettle(session_.world())) return session_.step();
  BackgroundWork<bool> stepping([&] { return stepAndSettle(session_); });
  for (;;) {
    if (std::optional<Result<bool>> stepped = stepping.take()) return std::move(*stepped);
    if (!window_.open() || window_.takeCancel()) closed_ = true;
    if (closed_ || interrupted()) stepping.cancel();
    progress_ = stepping.progress();
    WindowValues values;
    values.name = title_;
    values.duration = subject_.duration;
    values.loading = progress_.title();
    values.loaded = progress_.share;
    window_.show(Scene(), values);
    std::this_thread::sleep_for(kPictureWait);
  }
}

/// Opens the world of a scene at its start, in any thread.
std::function<Result<World>()> WindowLoop::worldOf(int scene) const {
  if (onlyWatched()) return subject_.worldAgain;
  const double gravity = kGravities[treatment_.gravity].factor;
  return [name = scenes_.arguments[scene], gravity, added = subject_.added]() -> Result<World> {
    Result<World> world = openScene(name, gravity);
    if (world) addProps(added, *world);
    return world;
  };
}

/// Opens a world and lets it settle beside the picture. The session goes on until takeWorld() puts it there.
/// @param scene  index; none = the present one, in which the session starts again
void WindowLoop::prepareWorld(std::optional<int> scene) {
  nextWorld_.reset();
  nextScene_ = scene;
  PartsOfAvatars parts = firstParts_;
  if (!subject_.sourcesAgain) parts = started_ ? partsOf(session_) : PartsOfAvatars();
  nextWorld_ = std::make_unique<BackgroundWork<World>>(
      [open = worldOf(scene.value_or(scenes_.present)), parts = std::move(parts)]() -> Result<World> {
        Result<World> world = open();
        if (world && !parts.empty()) settleAround(parts, *world);
        return world;
      });
}

Result<void> WindowLoop::takeWorld() {
  if (nextWorld_ == nullptr) return {};
  std::optional<Result<World>> world = nextWorld_->take();
  if (!world) return {};
  nextWorld_.reset();
  const std::optional<int> scene = std::exchange(nextScene_, std::nullopt);
  if (!*world) {
    seek_.reset();
    if (world->error().code != ErrorCode::kCancelled) window_.problem(world->error().message);
    return {};
  }
  if (!scene) return restartIn(std::move(**world));
  scenes_.present = *scene;
  const std::string& name = scenes_.arguments[*scene];
  if (subject_.sceneChosen) subject_.sceneChosen(name);
  if (subject_.opener != nullptr) subject_.opener->choseScene(name);
  hands_.forget();
  if (subject_.sourcesAgain) return restartIn(std::move(**world));
  session_.setWorld(std::move(**world));
  return {};
}

/// Shows how far the next world is, once that is known.
void WindowLoop::describeNextWorld(WindowValues& values) {
  if (nextWorld_ == nullptr) return;
  progress_ = nextWorld_->progress();
  if (progress_.label.empty()) return;
  values.loading = progress_.title();
  values.loaded = progress_.share;
}

/// Finds the parts of the first frame, around which particles settle, when body or motion have changed since: by a step
/// in a world of the same props without particles. Then the motion starts again in the present world.
Result<void> WindowLoop::findFirstParts() {
  LORICA_TRY(World other, worldOf(scenes_.present)());
  LORICA_TRY(std::vector<std::unique_ptr<PoseSource>> sources, this->sources());
  other.setParticles(ParticleSettings());
  World present = std::move(session_.world());
  session_.restart(std::move(sources), std::move(other));
  LORICA_TRY_DO(session_.step());
  firstParts_ = partsOf(session_);
  present.stepAvatars({}, 0.0);  // the avatars come back without sweeping
  return restartIn(std::move(present));
}

Result<void> WindowLoop::restart() {
  const Particles* particles = session_.world().particles();
  const bool known = !firstParts_.empty();
  if (particles != nullptr && particles->settings().settleSeconds > 0.0 && (started_ || known)) {
    if (subject_.sourcesAgain && !known) {
      LORICA_TRY_DO(findFirstParts());
    }
    prepareWorld(std::nullopt);
    return {};
  }
  LORICA_TRY(World world, worldOf(scenes_.present)());
  return restartIn(std::move(world));
}

}  // namespace lorica
