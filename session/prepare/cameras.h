#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "collision/hulls/host.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/result.h"
#include "session/prepare/abandoned_work.h"

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>

namespace lorica {

/// The live depth source that the command line selects.
struct DepthOptions {
  std::string device;          ///< URI; empty = the first camera
  std::string driver;          ///< an additional OpenNI2 driver; empty = none
  bool virtualCamera = false;  ///< Lorica's driver, see docs/VIRTUAL_SENSOR.md
  std::string motion;          ///< motion of the virtual people; empty = as in $LORICA_VIRTUAL
  std::string stream;          ///< where another program sends images, see DepthStream; empty = none does
  std::string format;          ///< of images without headers, see parseBareDepth(); empty = they have headers

  /// Whether a certain camera was asked for.
  [[nodiscard]] bool asked() const { return virtualCamera || !device.empty() || !driver.empty() || !stream.empty(); }
};

/// The skeletons that NiTE 2 tracks with such a camera, see makeNiteSource().
/// @param library  libNiTE2.so
[[nodiscard]] Result<std::unique_ptr<SkeletonSource>> openNite(const DepthOptions& options, const std::string& library);

/// Rejects an address or a format of a depth stream that cannot be, before any work.
[[nodiscard]] Result<void> checkDepth(const DepthOptions& options);

/// Opens a real or virtual camera through OpenNI2, which a virtual one does not need, or waits for what is sent.
/// @return the source, or an error that says why there is none and what to do
[[nodiscard]] Result<std::unique_ptr<DepthSource>> openDepth(const DepthOptions& options);

/// Says what a stream is waited for from. @return the name of that work
[[nodiscard]] std::string tellWaiting(const DepthOptions& options, Host& host);

/// Runs work that calls openDepth(), which may not be possible to stop. If the work of this thread has a monitor and is
/// cancelled meanwhile, it is given up: its result counts no more, and main() ends with endWithoutIt().
/// @param work  owns what it uses; ends early if it is cancelled
/// @return its result, or kCancelled
template <class T>
[[nodiscard]] Result<T> openWaiting(const DepthOptions& options, Host& host, std::function<Result<T>()> work) {
  const Interrupt stops = [&] { return host.cancelled(); };
  const InterruptScope scope(&stops);
  const std::string label = tellWaiting(options, host);
  if (!host.inBackground()) return work();
  const Task opening(host, label, "");
  std::packaged_task<Result<T>()> task(std::move(work));
  std::future<Result<T>> result = task.get_future();
  std::thread(std::move(task)).detach();
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    if (!host.cancelled()) continue;
    noteAbandoned();
    return cancelled();
  }
  return result.get();
}

}  // namespace lorica
