#pragma once

#include "collision/hulls/host.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/result.h"
#include "session/prepare/abandoned_work.h"
#include "viewer/renderer/screen.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {

/// How far work is, from what it tells its host. Stages and tasks may be nested; a task within a task is not counted.
class WorkShare {
 public:
  void beginStage(double from, double to);
  void endStage();
  /// How many tasks a stage has is not known before, so each takes most of what remains of it.
  /// @param whole  it is all that there is
  void beginTask(bool whole = false);
  void report(int done, int total, double share = -1.0);

  /// Of the whole work, 0 to 1; never decreases.
  [[nodiscard]] double share() const { return share_; }
  /// What tasks have reported of it; the rest of the share was skipped, since it was there already.
  [[nodiscard]] double worked() const { return worked_; }

 private:
  // Shares at the ends of a stage, and what had been worked when it began.
  struct Span {
    double from = 0.0, to = 1.0, worked = 0.0;
  };
  std::vector<Span> outer_;  // stages around the present one
  Span stage_;
  double taskFrom_ = 0.0, taskTo_ = 1.0;
  double share_ = 0.0, worked_ = 0.0;
};

/// The host of work in a thread of its own: another thread sees how far it is and may cancel it.
class MonitoredHost final : public Host {
 public:
  struct Progress {
    std::string label;   ///< the task: "Decomposing mannequin"; empty = not known yet
    double share = 0.0;  ///< of the whole work that is done, 0 to 1; never decreases

    /// For a window: `label`, or "Loading".
    [[nodiscard]] std::string_view title() const { return label.empty() ? std::string_view("Loading") : label; }
  };

  /// @param parent  gets warnings and says too whether to stop; outlives this one
  explicit MonitoredHost(Host& parent);

  void beginTask(const std::string& label, const std::string& unit) override;
  void report(int done, int total, double share) override;
  void beginStage(double from, double to, const std::string& name) override;
  void endStage() override;
  [[nodiscard]] bool cancelled() const override { return cancelled_ || parent_.cancelled(); }
  [[nodiscard]] bool inBackground() const override { return true; }
  void tell(const std::string& sentence) override { parent_.tell(sentence); }
  void warn(const std::string& sentence) override { parent_.warn(sentence); }

  // For the other thread.
  [[nodiscard]] Progress progress() const;
  void cancel() { cancelled_ = true; }
  /// Whether cancel() was called.
  [[nodiscard]] bool stopped() const { return cancelled_; }

 private:
  void publish();

  Host& parent_;
  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;
  Progress progress_;
  WorkShare work_;  // of the working thread only
};

/// Work in another thread that reports how far it is and can be cancelled: what it reads asks, see workStopped().
template <class T>
class BackgroundWork {
 public:
  /// Starts it. @param host  outlives the work, also if that is abandoned
  /// @param work  should end soon after its host is cancelled; what it returns then does not count
  BackgroundWork(Host& host, std::function<Result<T>(Host&)> work) : monitor_(std::make_shared<MonitoredHost>(host)) {
    std::packaged_task<Result<T>()> task([monitor = monitor_, work = std::move(work)]() -> Result<T> {
      const Interrupt stops = [&] { return monitor->cancelled(); };
      const InterruptScope scope(&stops);
      Result<T> done = work(*monitor);
      if (monitor->stopped()) return cancelled();
      return done;
    });
    result_ = task.get_future();
    thread_ = std::thread(std::move(task));
  }
  /// Cancels and waits, unless abandon() came before.
  ~BackgroundWork() {
    cancel();
    if (thread_.joinable()) thread_.join();
  }
  BackgroundWork(const BackgroundWork&) = delete;
  BackgroundWork& operator=(const BackgroundWork&) = delete;

  [[nodiscard]] MonitoredHost::Progress progress() const { return monitor_->progress(); }
  /// It ends soon, with kCancelled.
  void cancel() { monitor_->cancel(); }
  /// Cancels and waits for a moment only: then the work is given up, see abandoned_work.h. It must own what it uses.
  void abandon() {
    cancel();
    if (!thread_.joinable() || !result_.valid() || result_.wait_for(kMoment) == std::future_status::ready) return;
    noteAbandoned();
    thread_.detach();
  }
  /// The result, once; none while it runs.
  [[nodiscard]] std::optional<Result<T>> take() {
    if (!result_.valid() || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
    return result_.get();
  }

 private:
  static constexpr std::chrono::milliseconds kMoment{100};
  std::shared_ptr<MonitoredHost> monitor_;
  std::future<Result<T>> result_;
  std::thread thread_;
};

/// Loads what a session needs while a screen shows how far that is. Files that are dropped meanwhile are requested
/// after that.
/// @param load  runs in another thread
/// @return what was loaded; none if the user closed the screen or cancelled; kCancelled if the host says so
template <class T>
[[nodiscard]] Result<std::optional<T>> loadOnScreen(Screen& screen, Host& host, std::function<Result<T>(Host&)> load) {
  BackgroundWork<T> loading(host, std::move(load));
  while (screen.open()) {
    if (screen.takeCancel()) break;
    if (host.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
    if (std::optional<Result<T>> loaded = loading.take()) {
      if (!*loaded) return loaded->error();
      return std::optional<T>(std::move(**loaded));
    }
    const MonitoredHost::Progress progress = loading.progress();
    WindowValues values;
    values.loading = progress.title();
    values.loaded = progress.share;
    screen.show(Scene(), values);
    screen.rest(0.03);
  }
  return std::optional<T>();
}

}  // namespace lorica
