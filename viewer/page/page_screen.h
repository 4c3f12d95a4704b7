#pragma once

#include "viewer/page/server.h"
#include "viewer/player/run.h"
#include "viewer/renderer/screen.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <deque>
#include <string>
#include <vector>

namespace lorica {

/// What a VRM file says against giving it to others, as everybody who sees the page gets it; empty = nothing.
/// https://github.com/vrm-c/vrm-specification: VRMC_vrm-1.0/meta.md and `meta` in 0.0/README.md
/// @param document  the glTF document
[[nodiscard]] std::string vrmLicence(const nlohmann::ordered_json& document);

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
  void show(const Scene& scene, const WindowValues& values) override;
  void rest(double seconds) override;
  [[nodiscard]] Asked& asked() override { return window_ ? window_->asked() : Screen::asked(); }
  [[nodiscard]] std::vector<Change> takeChanges() override;
  void chooseFiles() override;
  [[nodiscard]] bool takeCancel() override;
  [[nodiscard]] HandAim aim(int hand) const override;
  [[nodiscard]] Camera camera() const override { return window_ ? window_->camera() : camera_; }
  [[nodiscard]] std::span<const HeadsetPose> headsets() override;
  void setWearer(const WearerState& state) override;
  void setCamera(const Camera& camera) override;
  void addTimes(std::span<const TimedStage> stages) override;
  void notice(std::string sentence, double seconds) override;
  void problem(std::string sentence) override;
  void setTitle(const std::string& title) override;
  [[nodiscard]] bool personal() const override { return window_ != nullptr; }

 private:
  void receive();
  void perform(const ClientMessage& message);
  void send(const std::string& notice, bool problem);
  /// A hand of a client that holds something, or pressed for it.
  struct ClientHand {
    int client = 0;  ///< 0 = it is free
    int hand = 0;
    HandAim aim;

    [[nodiscard]] bool isOf(const ClientMessage& message) const {
      return client == message.client && hand == message.change.hand;
    }
  };
  ClientHand* handFor(const ClientMessage& press);
  [[nodiscard]] std::string controlsOf(const Controls& controls) const;
  [[nodiscard]] std::string stateOf(const WindowValues& values) const;

  PageServer& server_;
  Screen* window_;
  Camera camera_;
  std::vector<HeadsetPose> headsets_, givenHeadsets_;
  const Run* present_ = nullptr;  // that began last
  std::uint32_t run_ = 0;
  std::vector<ClientMessage> messages_;
  std::deque<Change> throws_;  // that wait for their turns
  std::array<ClientHand, World::kMaxHands> hands_;
  std::vector<TimedStage> times_;
  std::uint64_t shownChanges_ = 0;
  std::uint32_t shownRun_ = 0;
  int shownClients_ = 0;
  unsigned shownLayers_ = 0;
  double stateTime_ = -1.0, shapesTime_ = -1.0;  // when they were sent [s]
};

}  // namespace lorica
