#pragma once

#include "tests/support/background_process.h"
#include "tests/support/virtual_display.h"
#include "viewer/vr/headset_window.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>

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
  void startService();
  void endService();

  ToldHeadset told;
  std::unique_ptr<HeadsetWindow> window;

 private:
  std::optional<VirtualDisplay> display_;
  std::optional<BackgroundProcess> service_;
  int socket_ = -1;
};

}  // namespace lorica::test
