#include "collision/particles/particles.h"
#include "session/prepare/scenes.h"
#include "viewer/player/run_loop.h"

#include <utility>

namespace lorica {
namespace {

constexpr double kPictureWait = 0.03;  // [s]

}  // namespace

/// In the first step sand and water may have to settle, which takes seconds: that runs beside the picture. Closing the
/// window and Cancel end it, and the session.
Result<bool> RunLoop::stepSession() {
  if (started_ || !mustSettle(session_.world())) return session_.step();
  if (screen_ == nullptr) return stepAndSettle(session_, host_);
  BackgroundWork<bool> stepping(host_, [&](Host& host) { return stepAndSettle(session_, host); });
  for (;;) {
    if (std::optional<Result<bool>> stepped = stepping.take()) return std::move(*stepped);
    if (!screen_->open() || screen_->takeCancel()) closed_ = true;
    if (closed_ || host_.cancelled()) stepping.cancel();
    progress_ = stepping.progress();
    WindowValues values;
    values.name = title_;
    values.duration = run_.duration();
    values.loading = progress_.title();
    values.loaded = progress_.share;
    values.changes = changes_;
    screen_->show(Scene(), values);
    screen_->rest(kPictureWait);
  }
}

/// Opens the world of a scene at its start, in any thread.
std::function<Result<World>(Host&)> RunLoop::worldOf(int scene) const {
  if (onlyWatched()) return [this](Host& host) { return run_.worldAgain(host); };
  const double gravity = kGravities[treatment_.gravity].factor;
  return [name = scenes_.arguments[scene], gravity, added = run_.cast.added,
          scale = run_.cast.propScale](Host& host) -> Result<World> {
    Result<World> world = openScene(name, gravity, host, scale);
    if (world) addProps(added, *world);
    return world;
  };
}

/// Opens a world and lets it settle beside the picture. The session goes on until takeWorld() puts it there.
/// @param scene  index; none = the present one, in which the session starts again
void RunLoop::prepareWorld(std::optional<int> scene) {
  nextWorld_.reset();
  nextScene_ = scene;
  PartsOfAvatars parts = firstParts_;
  if (!run_.restartable()) parts = started_ ? partsOf(session_) : PartsOfAvatars();
  nextWorld_ = std::make_unique<BackgroundWork<World>>(
      host_, [open = worldOf(scene.value_or(scenes_.present)), parts = std::move(parts)](Host& host) -> Result<World> {
        Result<World> world = open(host);
        if (world && !parts.empty()) settleAround(parts, *world, host);
        return world;
      });
}

Result<void> RunLoop::takeWorld() {
  if (nextWorld_ == nullptr) return {};
  std::optional<Result<World>> world = nextWorld_->take();
  if (!world) return {};
  nextWorld_.reset();
  const std::optional<int> scene = std::exchange(nextScene_, std::nullopt);
  if (!*world) {
    seek_.reset();
    if (world->error().code != ErrorCode::kCancelled) screen_->problem(world->error().message);
    return {};
  }
  if (!scene) return restartIn(std::move(**world));
  scenes_.present = *scene;
  const std::string& name = scenes_.arguments[*scene];
  run_.sceneChosen(name, host_);
  if (shown_.opener != nullptr) shown_.opener->choseScene(name);
  hands_.forget();
  ++changes_;
  if (run_.restartable()) return restartIn(std::move(**world));
  session_.setWorld(std::move(**world));
  return {};
}

/// Shows how far the next world is, once that is known.
void RunLoop::describeNextWorld(WindowValues& values) {
  if (nextWorld_ == nullptr) return;
  progress_ = nextWorld_->progress();
  if (progress_.label.empty()) return;
  values.loading = progress_.title();
  values.loaded = progress_.share;
}

/// Finds the parts of the first frame, around which particles settle, when body or motion have changed since: by a step
/// in a world of the same props without particles. Then the motion starts again in the present world.
Result<void> RunLoop::findFirstParts() {
  LORICA_TRY(World other, worldOf(scenes_.present)(host_));
  LORICA_TRY(std::vector<std::unique_ptr<PoseSource>> sources, this->sources());
  LORICA_TRY_DO(other.setParticles(ParticleSettings()));
  World present = std::move(session_.world());
  session_.restart(std::move(sources), std::move(other));
  LORICA_TRY_DO(session_.step());
  firstParts_ = partsOf(session_);
  present.stepAvatars({}, 0.0);  // the avatars come back without sweeping
  return restartIn(std::move(present));
}

Result<void> RunLoop::restart() {
  const Particles* particles = session_.world().particles();
  const bool known = !firstParts_.empty();
  if (particles != nullptr && particles->settings().settleSeconds > 0.0 && (started_ || known)) {
    if (run_.restartable() && !known) {
      LORICA_TRY_DO(findFirstParts());
    }
    prepareWorld(std::nullopt);
    return {};
  }
  LORICA_TRY(World world, worldOf(scenes_.present)(host_));
  return restartIn(std::move(world));
}

}  // namespace lorica
