// Uses the virtual camera through the stock OpenNI2, like any other program. A separate program, because OpenNI2's set
// of drivers depends on where it was loaded from.
//
//   driver_client frames COUNT OUT   writes COUNT frames: time [us], number of bytes, the bytes
//   driver_client record COUNT ONI   records COUNT frames
//   driver_client cycle COUNT        opens and closes COUNT times, with a frame each; every tenth time all of OpenNI2
//   driver_client unplug SECONDS     reads frames and reports when the camera disappears and returns

#include <OpenNI.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>

// Leaks of OpenNI2 are not checked by our tests.
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0";
}

namespace {

/// Of the camera: as CLIENT_URI says; if it is empty, the first.
const char* uri() {
  const char* given = std::getenv("CLIENT_URI");
  return given == nullptr ? "lorica://virtual" : *given == '\0' ? openni::ANY_DEVICE : given;
}

int fail(const char* what) {
  std::fprintf(stderr, "%s: %s\n", what, openni::OpenNI::getExtendedError());
  return 1;
}

bool read(openni::VideoStream& stream, openni::VideoFrameRef& frame) {
  openni::VideoStream* streams[1] = {&stream};
  int ready = -1;
  return openni::OpenNI::waitForAnyStream(streams, 1, &ready, 60000) == openni::STATUS_OK &&
         stream.readFrame(&frame) == openni::STATUS_OK && frame.isValid();
}

/// A camera that is closed as OpenNI2 requires: the stream before the device.
struct Camera {
  openni::Device device;
  openni::VideoStream depth;
  bool open() {
    return device.open(uri()) == openni::STATUS_OK && depth.create(device, openni::SENSOR_DEPTH) == openni::STATUS_OK;
  }
  void close() {
    depth.stop();
    depth.destroy();
    device.close();
  }
};

int frames(int count, const char* path) {
  Camera camera;
  if (!camera.open()) return fail("open");
  const openni::VideoMode mode = camera.depth.getVideoMode();
  int crop[4] = {};
  const bool asExpected =
      mode.getResolutionX() == 640 && mode.getResolutionY() == 480 && mode.getFps() == 30 &&
      mode.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_1_MM && !camera.depth.getMirroringEnabled() &&
      !camera.depth.getCropping(&crop[0], &crop[1], &crop[2], &crop[3]) && camera.depth.getMaxPixelValue() == 10000 &&
      camera.depth.getHorizontalFieldOfView() > 1.0F && camera.depth.setVideoMode(mode) == openni::STATUS_OK &&
      camera.depth.setMirroringEnabled(false) == openni::STATUS_OK &&
      camera.depth.setMirroringEnabled(true) != openni::STATUS_OK;
  if (!asExpected) return fail("properties");
  std::FILE* out = std::fopen(path, "wb");
  if (out == nullptr || camera.depth.start() != openni::STATUS_OK) return fail("start");
  for (int i = 0; i < count; ++i) {
    openni::VideoFrameRef frame;
    if (!read(camera.depth, frame)) return fail("read");
    const std::uint64_t numbers[2] = {frame.getTimestamp(), static_cast<std::uint64_t>(frame.getDataSize())};
    std::fwrite(numbers, sizeof numbers, 1, out);
    std::fwrite(frame.getData(), 1, static_cast<std::size_t>(frame.getDataSize()), out);
  }
  camera.close();
  return std::fclose(out) == 0 ? 0 : 1;
}

int record(int count, const char* path) {
  Camera camera;
  if (!camera.open()) return fail("open");
  openni::Recorder recorder;
  if (recorder.create(path) != openni::STATUS_OK || recorder.attach(camera.depth) != openni::STATUS_OK ||
      recorder.start() != openni::STATUS_OK || camera.depth.start() != openni::STATUS_OK) {
    return fail("record");
  }
  for (int i = 0; i < count; ++i) {
    openni::VideoFrameRef frame;
    if (!read(camera.depth, frame)) return fail("read");
  }
  camera.depth.stop();
  recorder.stop();
  recorder.destroy();
  camera.close();
  return 0;
}

int cycle(int count) {
  for (int i = 0; i < count; ++i) {
    if (i % 10 == 9) {
      openni::OpenNI::shutdown();
      if (openni::OpenNI::initialize() != openni::STATUS_OK) return fail("initialize");
    }
    Camera camera;
    openni::VideoFrameRef frame;
    if (!camera.open() || camera.depth.start() != openni::STATUS_OK || !read(camera.depth, frame)) return fail("cycle");
    frame.release();
    camera.close();
  }
  return 0;
}

struct Plugs : openni::OpenNI::DeviceConnectedListener, openni::OpenNI::DeviceDisconnectedListener {
  std::atomic<int> came{0}, went{0};
  void onDeviceConnected(const openni::DeviceInfo* info) override {
    if (std::strcmp(info->getUri(), uri()) == 0) ++came;
  }
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    if (std::strcmp(info->getUri(), uri()) == 0) ++went;
  }
};

int unplug(int seconds) {
  Plugs plugs;
  openni::OpenNI::addDeviceConnectedListener(&plugs);
  openni::OpenNI::addDeviceDisconnectedListener(&plugs);
  auto camera = std::make_unique<Camera>();
  openni::VideoFrameRef frame;
  if (!camera->open() || camera->depth.start() != openni::STATUS_OK || !read(camera->depth, frame)) return fail("open");
  const std::uint64_t before = frame.getTimestamp();
  frame.release();
  const auto wait = [&](const std::atomic<int>& count) {
    for (int i = 0; i < 100 * seconds && count == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return count > 0;
  };
  if (!wait(plugs.went)) return fail("never disconnected");
  camera->close();
  openni::Device gone;
  if (gone.open(uri()) == openni::STATUS_OK) return fail("opened while unplugged");
  if (!wait(plugs.came)) return fail("never reconnected");
  camera = std::make_unique<Camera>();
  if (!camera->open() || camera->depth.start() != openni::STATUS_OK || !read(camera->depth, frame))
    return fail("again");
  const std::uint64_t after = frame.getTimestamp();
  frame.release();
  camera->close();
  std::printf("%llu %llu\n", static_cast<unsigned long long>(before), static_cast<unsigned long long>(after));
  openni::OpenNI::removeDeviceConnectedListener(&plugs);
  openni::OpenNI::removeDeviceDisconnectedListener(&plugs);
  return plugs.went == 1 && plugs.came == 1 ? 0 : fail("disconnected or reconnected more than once");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  if (openni::OpenNI::initialize() != openni::STATUS_OK) return fail("initialize");
  const std::string mode = argv[1];
  const int count = std::atoi(argv[2]);
  int result = 2;
  if (mode == "frames" && argc == 4) result = frames(count, argv[3]);
  if (mode == "record" && argc == 4) result = record(count, argv[3]);
  if (mode == "cycle") result = cycle(count);
  if (mode == "unplug") result = unplug(count);
  openni::OpenNI::shutdown();
  return result;
}
