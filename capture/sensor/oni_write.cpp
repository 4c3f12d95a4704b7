#include "capture/sensor/depth_recording.h"
#include "capture/sensor/oni_depth_codec.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"
#include "geometry/new_file.h"

#include <algorithm>
#include <cmath>
#include <memory>

// The records that docs/SENSORS.md has in a table, of one device and one depth stream. How many frames there will be is
// known, so nothing is written twice.

namespace lorica {
namespace {

constexpr std::uint32_t kOniDevice = 1, kOniDepth = 2;  // types of nodes, here their numbers, too
constexpr int kLargestOni = 2048;                       // pixels a side, as it is read

template <typename... T>
std::string oniNumbers(T... values) {
  std::string bytes;
  (appendLittleEndian(values, bytes), ...);
  return bytes;
}

std::string oniText(std::string_view text) {
  return oniNumbers(static_cast<std::uint32_t>(text.size() + 1)).append(text) + '\0';
}

std::string oniRecord(std::uint32_t type, std::uint32_t node, std::string_view fields, std::string_view payload = {}) {
  constexpr std::uint32_t kHead = 28;
  return std::string("NIR\0", 4) + oniNumbers(type, node, static_cast<std::uint32_t>(kHead + fields.size()),
                                              static_cast<std::uint32_t>(payload.size()), std::uint64_t{0})
                                       .append(fields)
                                       .append(payload);
}

std::string oniNode(std::uint32_t type, OniCodec codec, std::string_view name, std::uint32_t frames, std::uint64_t from,
                    std::uint64_t to) {
  return oniRecord(
      13, type,
      oniText(name) + oniNumbers(type, static_cast<std::uint32_t>(codec), frames, from, to, std::uint64_t{0}));
}

std::string oniProperty(std::uint32_t type, std::uint32_t node, std::string_view name, const std::string& value) {
  return oniRecord(type, node, oniText(name) + oniNumbers(static_cast<std::uint32_t>(value.size())) + value);
}

std::string oniNumber(std::string_view name, std::uint64_t value) {
  return oniProperty(3, kOniDepth, name, oniNumbers(value));
}

}  // namespace

Result<void> writeOni(DepthRecording& recording, const std::filesystem::path& file,
                      const std::function<bool(int)>& progress) {
  const DepthCamera& camera = recording.camera();
  if (camera.width > kLargestOni || camera.height > kLargestOni) {
    return unsupported("{}: found images of {} x {}, expected at most {} pixels a side for .oni", recording.name(),
                       camera.width, camera.height, kLargestOni);
  }
  const auto microseconds = [](double time) { return static_cast<std::uint64_t>(std::llround(1e6 * time)); };
  const DepthRecordingInfo& about = recording.about();
  const std::uint64_t last = microseconds(about.duration);
  const auto frames = static_cast<std::uint32_t>(about.frameCount);
  const auto width = static_cast<std::uint32_t>(camera.width), height = static_cast<std::uint32_t>(camera.height);
  const double rate = about.duration > 0.0 ? (frames - 1) / about.duration : 30.0;

  LORICA_TRY(const std::unique_ptr<NewFile> out, NewFile::create(file));
  const std::string device = about.device.empty() ? about.format : about.device;
  LORICA_TRY_DO(out->write(
      "NI10" + oniNumbers(std::uint8_t{1}, std::uint8_t{0}, std::uint16_t{1}, std::uint32_t{0}, last, kOniDepth) +
      oniNode(kOniDevice, OniCodec::kRaw, "Device", 0, 0, 0) + oniProperty(5, kOniDevice, "DeviceName", device + '\0') +
      oniRecord(9, kOniDevice, {}) + oniNode(kOniDepth, OniCodec::kTable, "Depth", frames, 0, last) +
      oniNumber("oniRequiredFrameSize", std::uint64_t{2} * width * height) + oniNumber("xnIsGenerating", 1) +
      oniNumber("xnDeviceMaxDepth", 65535) +
      oniProperty(6, kOniDepth, "xnMapOutputMode",
                  oniNumbers(width, height, static_cast<std::uint32_t>(std::clamp(std::lround(rate), 1L, 1000L)))) +
      oniNumber("xnPixelFormat", 4) + oniNumber("oniPixelFormat", 100) +
      oniProperty(6, kOniDepth, "xnFOV", oniNumbers(camera.horizontalFov, camera.verticalFov)) +
      oniNumber("Cropping", 1) + oniProperty(6, kOniDepth, "xnCropping", std::string(12, '\0')) +
      oniNumber("xnMirror", 0) + oniRecord(9, kOniDepth, {}) +
      oniRecord(8, kOniDepth, oniNumbers(~std::uint32_t{0}, ~std::uint64_t{0}))));

  recording.seek(0);
  DepthFrame frame;
  double begin = 0.0;
  for (std::uint32_t number = 1; number <= frames; ++number) {
    LORICA_TRY_DO(recording.next(frame));
    if (number == 1) begin = frame.time;
    LORICA_TRY_DO(out->write(oniRecord(10, kOniDepth, oniNumbers(microseconds(frame.time - begin), number),
                                       packOniDepth(OniCodec::kTable, frame.depthMm))));
    if (progress && !progress(static_cast<int>(number))) return cancelled();
  }
  LORICA_TRY_DO(out->write(oniRecord(7, kOniDepth, {}) + oniRecord(11, 0, {})));
  return out->finish();
}

}  // namespace lorica
