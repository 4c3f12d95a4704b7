#include "capture/sensor/oni_file.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Any bytes as an .oni recording. What is accepted must be sound, and each of its frames an image or a sentence.
namespace {

using namespace lorica;

void expectSentence(const Error& error) {
  LORICA_CHECK(error.message.rfind("fuzz", 0) == 0, "an error that does not say where");
  LORICA_CHECK(error.message.find("expected") != std::string::npos, "an error that does not say what was expected");
}

void readAll(OniFile& file, std::size_t size) {
  const OniInfo& info = file.info();
  LORICA_CHECK(info.frameCount > 0 && static_cast<std::size_t>(info.frameCount) <= size / 40, "more frames than bytes");
  LORICA_CHECK(info.end <= size && info.duration >= 0.0, "an end beyond the file, or a time before its begin");
  const DepthCamera& camera = info.camera;
  LORICA_CHECK(camera.width > 0 && camera.width <= 2048 && camera.height > 0 && camera.height <= 2048, "no size");
  LORICA_CHECK(camera.focalX() > 0.0 && camera.focalY() > 0.0, "no field of view");
  DepthFrame frame;
  double last = -1.0;
  for (int i = 0; i < info.frameCount && i < 20; ++i) {
    const Result<void> read = file.read(i, frame);
    LORICA_CHECK(frame.time > last, "times do not rise");
    last = frame.time;
    if (!read) {
      expectSentence(read.error());
      continue;
    }
    LORICA_CHECK(
        frame.depthMm.size() == static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height),
        "an image of another size");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Result<OniFile> file = OniFile::parse(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
  if (file) {
    readAll(*file, size);
  } else {
    expectSentence(file.error());
  }
  return 0;
}
