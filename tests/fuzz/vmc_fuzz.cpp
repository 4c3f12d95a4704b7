// Packets of the VMC protocol, several in one input: each begins with its length in two bytes. What is received poses a
// character in one input of sixteen, because that takes far longer than receiving.
#include "capture/retarget/stream_retarget.h"
#include "capture/streams/vmc_receiver.h"
#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>

namespace {

bool isFinite(const lorica::Pose& pose) {
  return std::all_of(pose.begin(), pose.end(), [](const lorica::JointTransform& joint) {
    return joint.translation.allFinite() && joint.rotation.coeffs().allFinite();
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const lorica::Skeleton skeleton = lorica::makeMannequin().skeleton;
  static const lorica::StreamRetargeter fresh = *lorica::StreamRetargeter::create(skeleton);
  lorica::VmcReceiver receiver;
  std::optional<lorica::StreamRetargeter> retargeter;
  if (lorica::contentHash({reinterpret_cast<const char*>(data), size}) % 16 == 0) retargeter = fresh;
  lorica::Pose pose = lorica::restPose(skeleton);
  double time = 0.0;
  while (size >= 2) {
    const std::size_t length = std::min<std::size_t>(data[0] | data[1] << 8, size - 2);
    const std::span packet(reinterpret_cast<const std::byte*>(data + 2), length);
    time += 0.01;
    if (receiver.take(packet, time) && retargeter) {
      retargeter->apply(receiver.frame().pose, time, receiver.frame().tracking, pose);
      if (!isFinite(pose)) std::abort();
    }
    data += 2 + length;
    size -= 2 + length;
  }
  return 0;
}
