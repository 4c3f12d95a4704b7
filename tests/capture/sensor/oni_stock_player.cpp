// Plays the first images of an .oni recording with the stock OpenNI2 and writes its depth frames unchanged to a file:
// the time [us], the number of bytes, the bytes, all in native byte order. A separate program, because the stock player
// crashes. Arguments: recording, output file, max number of frames.

#include <OpenNI.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

// Leaks and lock usage of OpenNI2 are not checked by our tests.
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0";
}
extern "C" const char* __tsan_default_options() {
  return "report_mutex_bugs=0:detect_deadlocks=0";
}

int main(int argc, char** argv) {
  if (argc != 4 || openni::OpenNI::initialize() != openni::STATUS_OK) return 2;
  openni::Device device;
  openni::VideoStream depth;
  if (device.open(argv[1]) != openni::STATUS_OK || depth.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
    std::fprintf(stderr, "%s\n", openni::OpenNI::getExtendedError());
    return 3;
  }
  device.getPlaybackControl()->setRepeatEnabled(false);
  device.getPlaybackControl()->setSpeed(-1.0f);
  const int count = std::min(device.getPlaybackControl()->getNumberOfFrames(depth), std::atoi(argv[3]));
  std::FILE* out = std::fopen(argv[2], "wb");
  if (out == nullptr || depth.start() != openni::STATUS_OK) return 4;
  for (int i = 0; i < count; ++i) {
    openni::VideoFrameRef frame;
    if (depth.readFrame(&frame) != openni::STATUS_OK) return 5;
    const std::uint64_t numbers[2] = {frame.getTimestamp(), static_cast<std::uint64_t>(frame.getDataSize())};
    std::fwrite(numbers, sizeof numbers, 1, out);
    std::fwrite(frame.getData(), 1, static_cast<std::size_t>(frame.getDataSize()), out);
  }
  // Exit without closing anything: closing crashes the player.
  std::_Exit(std::fclose(out) == 0 ? 0 : 6);
}
