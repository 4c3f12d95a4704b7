#pragma once

#include "player/run.h"
#include "serve/server.h"
#include "viewer/renderer/screen.h"

#include <array>
#include <deque>
#include <string>
#include <vector>

namespace lorica {

/// A screen whose people watch through a server, beside a window or without one. Clients throw, drag and choose as
/// people at a window do, in the order in which they ask for it. Each has two hands; as many of all clients hold
/// something at a time as the world has hands.
class PageScreen final : public Screen {
 public:
  /// @param window  another screen, which is shown and controlled as well; null = none
  PageScreen(PageServer& server, Screen* window) : server_(server), window_(window) {}

  /// Tells clients of a run that begins: its characters and where to look from.
  /// @param run  must outlive this screen, or the next call
  /// @param host  is warned of each character whose licence does not let it be given to others, before it is
  [[nodiscard]] Result<void> begin(const Run& run, Host& host);

  [[nodiscard]] bool open() const override { return window_ == nullptr || window_->open(); }
  [[nodiscard]] bool wantsStep() override;
  void show(const Scene& scene, const WindowValues& values) override;
  void rest(double seconds) override;
  [[nodiscard]] WindowRequests takeRequests() override;
  void chooseFiles() override;
  [[nodiscard]] bool takeCancel() override;
  [[nodiscard]] HandAim aim(int hand) const override;
  [[nodiscard]] Camera camera() const override { return window_ ? window_->camera() : camera_; }
  [[nodiscard]] std::span<const HeadsetPose> headsets() override;
  void tell(const HeadsetNews& news) override;
  void setCamera(const Camera& camera) override;
  void addTimes(std::span<const TimedStage> stages) override;
  void notice(std::string sentence, double seconds) override;
  void problem(std::string sentence) override;
  void setTitle(const std::string& title) override;
  [[nodiscard]] bool personal() const override { return window_ != nullptr; }
  [[nodiscard]] const WindowChoices& choices() const override { return window_ ? window_->choices() : choices_; }
  void setChoices(const WindowChoices& choices) override;

 private:
  void hear();
  void say(const std::string& sentence, bool problem);
  void obey(const Wish& wish, WindowRequests& requests);
  /// A hand of a client that holds something, or pressed for it.
  struct ClientHand {
    int client = 0;  ///< 0 = it is free
    int hand = 0;
    HandAim aim;

    [[nodiscard]] bool isOf(const Wish& wish) const { return client == wish.client && hand == wish.hand; }
  };
  ClientHand* handFor(const Wish& press, const WindowRequests& requests);
  [[nodiscard]] std::string stateOf(const WindowValues& values) const;

  PageServer& server_;
  Screen* window_;
  WindowChoices choices_;  // without a window
  Camera camera_;
  std::vector<HeadsetPose> headsets_, toldHeadsets_;
  const Run* present_ = nullptr;  // that began last
  std::uint32_t run_ = 0;
  std::vector<Wish> heard_;
  std::deque<Wish> waiting_;
  std::array<ClientHand, World::kMaxHands> hands_;
  std::vector<std::string> characters_, motions_, recents_;  // as the state listed them
  int scenes_ = 0, clips_ = 0, people_ = 0, maxParts_ = 0;
  std::vector<TimedStage> times_;
  std::uint64_t shownChanges_ = 0;
  std::uint32_t shownRun_ = 0;
  int shownClients_ = 0;
  unsigned shownLayers_ = 0;
  double stateTime_ = -1.0, shapesTime_ = -1.0;  // when they were told [s]
};

}  // namespace lorica
