#include "capture/sensor/oni_records.h"
#include "capture/sensor/raw_depth.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Any bytes as a .bag or, by their beginning, as an .mkv: images or a sentence.
namespace {

using namespace lorica;

Result<void> readAll(const std::string& bytes) {
  static const GivenLens kLens = GivenLens::find("fov=60x45", {}).value();
  const bool bag = bytes.starts_with("#ROSBAG");
  std::shared_ptr<const OniBytes> memory = bytesInMemory(bytes);
  LORICA_TRY(RawDepth raw, bag ? readDepthBag(std::move(memory), "fuzz", kLens)
                               : readDepthMatroska(std::move(memory), "fuzz", kLens));
  LORICA_TRY(const std::unique_ptr<DepthRecording> recording, recordingOf(std::move(raw), "fuzz"));
  DepthFrame frame;
  double last = -1.0;
  for (int i = 0; i < recording->about().frameCount && i < 5; ++i) {
    LORICA_TRY_DO(recording->next(frame));
    LORICA_CHECK(frame.time >= last, "times fall");
    last = frame.time;
  }
  return {};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Result<void> read = readAll(std::string(reinterpret_cast<const char*>(data), size));
  LORICA_CHECK(read || read.error().message.starts_with("fuzz"), "an error that does not say where");
  return 0;
}
