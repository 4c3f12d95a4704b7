#include "capture/sensor/openni_library.h"

#include "geometry/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <tuple>

namespace lorica {
namespace {

constexpr int kWaitMs = 100;
constexpr int kLargestMode = 2048;

bool isDepth(OniPixelFormat format) {
  return format == ONI_PIXEL_FORMAT_DEPTH_1_MM || format == ONI_PIXEL_FORMAT_DEPTH_100_UM;
}

/// Distance from the wanted mode, 640 x 480 at 30 Hz in millimetres; less is better.
std::tuple<int, int, int> farFromWanted(const OniVideoMode& mode) {
  return {std::abs(mode.resolutionX - 640) + std::abs(mode.resolutionY - 480), std::abs(mode.fps - 30),
          mode.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_1_MM ? 0 : 1};
}

/// The best of a sensor's modes; nullopt if it has no depth.
std::optional<OniVideoMode> chooseMode(const OniSensorInfo& sensor) {
  std::optional<OniVideoMode> best;
  for (int i = 0; i < sensor.numSupportedVideoModes; ++i) {
    const OniVideoMode& mode = sensor.pSupportedVideoModes[i];
    if (isDepth(mode.pixelFormat) && (!best || farFromWanted(mode) < farFromWanted(*best))) best = mode;
  }
  return best;
}

}  // namespace

Result<std::unique_ptr<OpenNiSource>> OpenNiSource::open(std::shared_ptr<OpenNiLibrary> library,
                                                         const OpenNiCamera& camera) {
  std::unique_ptr<OpenNiSource> source(new OpenNiSource(std::move(library), camera));
  LORICA_TRY_DO(source->open());
  return source;
}

std::string OpenNiSource::name() const {
  return fmt::format("{}, {} ({})", which_.vendor, which_.name, which_.uri);
}

Result<void> OpenNiSource::open() {
  Result<DepthCamera> camera = unreadable(name() + ": its driver failed");
  try {
    camera = setUp();
  } catch (...) {  // drivers written in C++ may throw
  }
  if (!camera) {
    close();
    return camera.error();
  }
  if (known_ && !(*camera == camera_)) {
    close();
    return unsupported("{}: returned with images of {} x {}, expected {} x {}", name(), camera->width, camera->height,
                       camera_.width, camera_.height);
  }
  camera_ = *camera;
  known_ = true;
  clock_.restart();
  return {};
}

Result<DepthCamera> OpenNiSource::setUp() {
  const OpenNiApi& api = library_->api();
  if (api.deviceOpen(which_.uri.c_str(), &device_) != ONI_STATUS_OK) {
    device_ = nullptr;
    return library_->failure(name() + ": cannot be opened");
  }
  const OniSensorInfo* sensor = api.sensorInfo(device_, ONI_SENSOR_DEPTH);
  if (sensor == nullptr) return unsupported(name() + ": provides no depth");
  if (api.createStream(device_, ONI_SENSOR_DEPTH, &stream_) != ONI_STATUS_OK) {
    stream_ = nullptr;
    return library_->failure(name() + ": provides no depth");
  }
  // A camera that rejects a mode keeps its own, which is checked below.
  if (const std::optional<OniVideoMode> wanted = chooseMode(*sensor)) {
    (void)api.setProperty(stream_, ONI_STREAM_PROPERTY_VIDEO_MODE, &*wanted, sizeof *wanted);
  }
  OniVideoMode mode{};
  int size = sizeof mode;
  const bool known = api.getProperty(stream_, ONI_STREAM_PROPERTY_VIDEO_MODE, &mode, &size) == ONI_STATUS_OK;
  if (!known || !isDepth(mode.pixelFormat) || mode.resolutionX < 1 || mode.resolutionX > kLargestMode ||
      mode.resolutionY < 1 || mode.resolutionY > kLargestMode) {
    return unsupported("{}: found images of {} x {} in pixel format {}, expected depth of up to 2048 x 2048", name(),
                       mode.resolutionX, mode.resolutionY, static_cast<int>(mode.pixelFormat));
  }
  tenths_ = mode.pixelFormat == ONI_PIXEL_FORMAT_DEPTH_100_UM;

  OniBool mirroring = 0;
  (void)api.setProperty(stream_, ONI_STREAM_PROPERTY_MIRRORING, &mirroring, sizeof mirroring);
  size = sizeof mirroring;
  mirrors_ =
      api.getProperty(stream_, ONI_STREAM_PROPERTY_MIRRORING, &mirroring, &size) == ONI_STATUS_OK && mirroring != 0;

  DepthCamera camera;
  camera.width = mode.resolutionX;
  camera.height = mode.resolutionY;
  const auto angle = [&](int property, double& value) {
    float read = 0.0F;
    int bytes = sizeof read;
    if (api.getProperty(stream_, property, &read, &bytes) == ONI_STATUS_OK && read > 0.1F && read < 3.0F) value = read;
  };
  angle(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, camera.horizontalFov);
  angle(ONI_STREAM_PROPERTY_VERTICAL_FOV, camera.verticalFov);

  if (api.streamStart(stream_) != ONI_STATUS_OK) return library_->failure(name() + ": cannot be started");
  return camera;
}

void OpenNiSource::close() {
  const OpenNiApi& api = library_->api();
  try {
    // A stream accesses its device when destroyed. (The player of .oni files requires the other order; it is not used
    // here.)
    if (stream_ != nullptr) {
      api.streamStop(stream_);
      api.streamDestroy(stream_);
    }
    if (device_ != nullptr) (void)api.deviceClose(device_);
  } catch (...) {
    std::fprintf(stderr, "lorica: %s: its driver failed on closing\n", name().c_str());
  }
  stream_ = nullptr;
  device_ = nullptr;
}

Result<bool> OpenNiSource::comeBack() {
  const Result<std::vector<OpenNiCamera>> cameras = library_->cameras();
  if (!cameras) return false;
  const auto is = [this](const OpenNiCamera& c) { return c.uri == which_.uri; };
  // At another USB port the camera has another URI.
  const auto isLike = [this](const OpenNiCamera& c) {
    return c.vendor == which_.vendor && c.name == which_.name && c.usbVendor == which_.usbVendor &&
           c.usbProduct == which_.usbProduct;
  };
  auto found = std::find_if(cameras->begin(), cameras->end(), is);
  if (found == cameras->end()) found = std::find_if(cameras->begin(), cameras->end(), isLike);
  if (found == cameras->end() || library_->isGone(found->uri)) return false;
  which_ = *found;
  const Result<void> opened = open();
  if (!opened && opened.error().code == ErrorCode::kUnsupported) return opened.error();
  return opened.ok();  // a camera that was just plugged in may not be ready yet
}

Result<DepthRead> OpenNiSource::next(DepthFrame& frame) {
  if (stream_ == nullptr) {
    LORICA_TRY(const bool back, comeBack());
    if (!back) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kWaitMs));
      return DepthRead::kUnplugged;
    }
  }
  const OpenNiApi& api = library_->api();
  try {
    int which = 0;
    const OniStatus waited =
        library_->isGone(which_.uri) ? ONI_STATUS_NO_DEVICE : api.wait(&stream_, 1, &which, kWaitMs);
    if (waited != ONI_STATUS_OK) {
      if (!library_->isGone(which_.uri)) return DepthRead::kWaiting;
      close();
      return DepthRead::kUnplugged;
    }
    OniFrame* read = nullptr;
    if (api.readFrame(stream_, &read) != ONI_STATUS_OK || read == nullptr) return DepthRead::kWaiting;
    const Result<void> copied = copy(*read, frame);
    api.frameRelease(read);
    if (!copied) return copied.error();
    return DepthRead::kFrame;
  } catch (...) {
    return unreadable(name() + ": its driver failed");
  }
}

Result<void> OpenNiSource::copy(const OniFrame& from, DepthFrame& to) {
  const std::size_t width = camera_.width;
  const std::size_t height = camera_.height;
  const std::size_t stride = std::max(from.stride, 0);
  if (from.width != camera_.width || from.height != camera_.height || stride < 2 * width || from.data == nullptr ||
      from.dataSize < 0 || static_cast<std::size_t>(from.dataSize) < stride * (height - 1) + 2 * width) {
    return badFormat("{}: found an image of {} x {} in {} bytes, expected {} x {}", name(), from.width, from.height,
                     from.dataSize, camera_.width, camera_.height);
  }
  to.depthMm.resize(width * height);
  for (std::size_t row = 0; row < height; ++row) {
    std::uint16_t* out = to.depthMm.data() + row * width;
    std::memcpy(out, static_cast<const char*>(from.data) + row * stride, 2 * width);
    if (mirrors_) std::reverse(out, out + width);
  }
  if (tenths_) {
    for (std::uint16_t& depth : to.depthMm) depth = (depth + 5) / 10;
  }

  to.time = clock_.timeOf(1e-6 * from.timestamp);
  return {};
}

}  // namespace lorica
