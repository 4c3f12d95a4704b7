#pragma once

#include "tests/support/background_process.h"
#include "tests/support/virtual_display.h"
#include "viewer/vr/headset_window.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica::test {

/// A pose of the headset's stage, as it is sent.
struct Told {
  Vec3 at = Vec3::Zero();
  Quat turned = Quat::Identity();
};
/// What Monado's remote devices are told: a head, what its eyes see, and two controllers.
struct ToldHeadset {
  Told head{{0.0, 1.6, 0.0}};
  EyeAngles angles;
  std::array<Told, 2> hands{Told{{-0.3, 1.2, -0.3}}, Told{{0.3, 1.2, -0.3}}};
  std::array<double, 2> triggers{};
  std::array<bool, 2> opens{};    ///< the button for the panel is pressed
  bool bare = false;              ///< hands without controllers
  std::array<double, 2> fists{};  ///< how far the fingers of bare hands are bent, 0 to 1
};

/// Monado with its remote devices, and a window whose scene they see. Where LORICA_MONADO, the command that starts the
/// service, is not set the test is skipped: scripts/test-vr sets it.
class MonadoHeadset : public ::testing::Test {
 public:
  void SetUp() override;
  void TearDown() override;
  void tell(const ToldHeadset& told) const;
  /// @param shownOn  a display, in whose window it shows what the eyes see; empty = nowhere
  void startService(const std::string& shownOn = {});
  void endService();
  void openWindow();
  /// The window and its display go, and nobody sees the next one.
  void openUnseen();

  ToldHeadset told;
  std::unique_ptr<HeadsetWindow> window;
  std::vector<std::string> said;  ///< by an unseen window

 private:
  std::optional<VirtualDisplay> display_;
  std::optional<BackgroundProcess> service_;
  int socket_ = -1;
};

}  // namespace lorica::test
