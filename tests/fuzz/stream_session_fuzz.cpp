// Packets of the VMC protocol from several senders, with a session of the mannequin behind the receiver. Each begins
// with a byte that names its sender and the time since the one before, and its length in two bytes.
#include "acd/decompose.h"
#include "capture/streams/bone_stream.h"
#include "capture/streams/vmc_receiver.h"
#include "session/scenes/demo_scene.h"
#include "session/session.h"
#include "session/stream_pose_source.h"
#include "skinning/mannequin/mannequin.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace {

using namespace lorica;

constexpr int kMaxSteps = 12;  // of a session, for one input

/// The packets of an input, as VmcStream would hear them; it waits for nothing.
class FuzzedStream final : public BoneStream {
 public:
  explicit FuzzedStream(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool wait(double /*seconds*/, BoneFrame& frame) override {
    while (bytes_.size() >= 3) {
      const std::size_t length = std::min<std::size_t>(bytes_[1] | bytes_[2] << 8, bytes_.size() - 3);
      now_ += 0.005 * (bytes_[0] >> 2);
      const std::uint64_t sender = bytes_[0] & 3;
      const std::span<const std::byte> packet = std::as_bytes(bytes_.subspan(3, length));
      bytes_ = bytes_.subspan(3 + length);
      if (!follower_.take(packet, sender, now_)) continue;
      frame = follower_.receiver().frame();
      return true;
    }
    ended_ = true;
    return false;
  }
  [[nodiscard]] bool ready() const override { return !ended_; }
  [[nodiscard]] bool ended() const override { return ended_; }
  [[nodiscard]] double now() const override { return now_; }

 private:
  std::span<const std::uint8_t> bytes_;
  VmcFollower follower_;
  double now_ = 0.0;
  bool ended_ = false;
};

Decomposition fourParts(const Character& character) {
  DecomposeSettings settings;
  settings.maxParts = 4;
  const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
  return decompose(character.mesh, bindPose, settings).value();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Character character = makeMannequin();
  static const Decomposition parts = fourParts(character);
  auto source = makeStreamPoseSource(character, std::make_unique<FuzzedStream>(std::span(data, size))).value();
  Session session = Session::create(character, parts, std::move(source), makeDemoWorld(kDemoSeed)).value();
  for (int step = 0; step < kMaxSteps; ++step) {
    const Result<bool> more = session.step();
    LORICA_CHECK(more.ok(), "a stream has no errors");
    if (!*more) break;
    for (const Affine3& joint : session.worldFromJoint()) {
      LORICA_CHECK(joint.matrix().allFinite(), "a joint nowhere");
    }
  }
  return 0;
}
