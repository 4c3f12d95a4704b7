#pragma once

#include "apps/cast.h"
#include "apps/work_monitor.h"

#include <future>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Avatars, a scene and mesh files that become props in it.
struct CastRequest {
  PlaybackInputOptions input;
  BodyOptions body;
  std::string scene;                ///< see openScene()
  std::vector<std::string> meshes;  ///< files
};

/// What was loaded, ready for a session.
struct LoadedCast {
  CastRequest request;
  OpenedCast opened;
  std::vector<Prop> added;  ///< of the request's meshes, which are in the world of `opened` already
};

/// Loads in another thread: reads, decomposes, opens the scene.
class CastLoading {
 public:
  /// @param attempts  the first that can be loaded is; if none can, the error of the first counts
  CastLoading(std::vector<CastRequest> attempts, int threads);
  /// Cancels and waits.
  ~CastLoading();
  CastLoading(const CastLoading&) = delete;
  CastLoading& operator=(const CastLoading&) = delete;

  [[nodiscard]] WorkMonitor::Progress progress() const { return monitor_.progress(); }
  /// The loading ends soon, with kCancelled.
  void cancel() { monitor_.cancel(); }
  /// The result, once; none while it loads.
  [[nodiscard]] std::optional<Result<LoadedCast>> take();

 private:
  WorkMonitor monitor_;
  std::future<Result<LoadedCast>> result_;
};

/// Adds props to a world, as they are.
void addProps(std::span<const Prop> props, World& world);

}  // namespace lorica
