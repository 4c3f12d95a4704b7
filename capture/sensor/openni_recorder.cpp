#include "capture/sensor/oni_file.h"
#include "capture/sensor/openni_library.h"
#include "geometry/errors.h"
#include "geometry/hard_stop.h"
#include "geometry/new_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// OpenNI2's packer uses a table that all recorders share.
std::atomic<bool> g_recording = false;

/// Holds g_recording. One at a time.
class OnlyRecording {
 public:
  OnlyRecording() : first_(!g_recording.exchange(true)) {}
  ~OnlyRecording() {
    if (first_) g_recording = false;
  }
  OnlyRecording(const OnlyRecording&) = delete;
  OnlyRecording& operator=(const OnlyRecording&) = delete;
  [[nodiscard]] bool first() const { return first_; }

 private:
  bool first_;
};

class Recorder final : public OpenNiRecorder {
 public:
  Recorder(OpenNiSource& source, fs::path target, fs::path beside)
      : library_(source.library()), target_(std::move(target)), beside_(std::move(beside)) {}
  ~Recorder() override {
    stop();
    if (lock_ >= 0) ::close(lock_);
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  [[nodiscard]] bool isTheOnlyOne() const { return only_.first(); }
  [[nodiscard]] const std::optional<fs::path>& found() const override { return found_; }

  /// No file is left on failure.
  Result<void> begin(OpenNiSource& source) {
    LORICA_TRY(std::optional<fs::path> found, keepFound(beside_));
    found_ = std::move(found);
    // OpenNI2 would crash on a file that it cannot create; it empties one that is there.
    LORICA_TRY(const int created, createPart(beside_));
    lock_ = created;
    const AtHardStop cleaning([this] { ::unlink(beside_.c_str()); });
    Result<void> begun = record(source);
    if (!begun) {
      discard();
      return begun;
    }
    waitForBegin();
    return {};
  }

  Result<void> record(OpenNiSource& source) {
    const OpenNiApi& api = library_.api();
    try {
      if (api.createRecorder(beside_.c_str(), &handle_) != ONI_STATUS_OK) {
        handle_ = nullptr;
        return library_.failure(fmt::format("{}: cannot be written", beside_.string()));
      }
      if (api.recorderAttach(handle_, source.stream(), 0) != ONI_STATUS_OK ||
          api.recorderStart(handle_) != ONI_STATUS_OK) {
        return library_.failure(fmt::format("{}: {} cannot be recorded", beside_.string(), source.name()));
      }
    } catch (...) {
      return unwritable("{}: OpenNI2's recorder failed", beside_.string());
    }
    return {};
  }

  /// OpenNI2 starts recording in a separate thread and drops earlier frames. Recording has started once the
  /// corresponding record is in the file. If this takes too long, the first images are lost, which is not an error.
  void waitForBegin() const {
    constexpr std::string_view kDataBegin("NIR\0\x08\0\0\0", 8);
    constexpr auto kStep = std::chrono::milliseconds(2);
    for (int step = 0; step < 1000; ++step) {
      std::string head(1 << 16, '\0');
      std::ifstream file(beside_, std::ios::binary);
      file.read(head.data(), head.size());
      const bool begun = head.find(kDataBegin) != std::string::npos;
      std::this_thread::sleep_for(kStep);
      if (begun) return;
    }
  }

  Result<int> finish() override {
    stop();
    int frames = 0;
    std::uint64_t end = 0;
    {
      LORICA_TRY(const OniFile file, OniFile::open(beside_));
      if (file.info().cutOff) {
        return unwritable("{}: the recording has no end record: is the disk full?", beside_.string());
      }
      frames = file.info().frameCount;
      end = file.info().end;
    }
    // The recorder appends as many zeros to the file as the recording has bytes.
    std::error_code error;
    fs::resize_file(beside_, end, error);
    if (!error) fs::rename(beside_, target_, error);
    if (error) {
      return unwritable("{}: cannot be written: {}; the recording is {}", target_.string(), error.message(),
                        beside_.string());
    }
    return frames;
  }

  void discard() override {
    stop();
    std::error_code ignored;
    fs::remove(beside_, ignored);
  }

 private:
  void stop() {
    if (handle_ == nullptr) return;
    try {
      library_.api().recorderStop(handle_);
      (void)library_.api().recorderDestroy(&handle_);  // waits until everything is written
    } catch (...) {
      std::fprintf(stderr, "lorica: %s: OpenNI2's recorder failed\n", beside_.c_str());
    }
    handle_ = nullptr;
  }

  OnlyRecording only_;
  OpenNiLibrary& library_;
  fs::path target_;
  fs::path beside_;
  std::optional<fs::path> found_;
  int lock_ = -1;  ///< descriptor of the file, see createPart()
  OniRecorderHandle handle_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<OpenNiRecorder>> OpenNiRecorder::start(DepthSource& source, const fs::path& file) {
  auto* const camera = dynamic_cast<OpenNiSource*>(&source);
  if (camera == nullptr) {
    return unsupported("{}: not an OpenNI2 camera, expected one to record", source.name());
  }
  if (camera->stream() == nullptr) {
    return notFound("{}: is unplugged, expected a connected camera to record", source.name());
  }
  fs::path beside = file;
  beside.replace_extension(".part.oni");
  auto recorder = std::make_unique<Recorder>(*camera, file, beside);
  if (!recorder->isTheOnlyOne())
    return invalidArgument("a recording is already in progress, expected only one at a time");
  LORICA_TRY_DO(recorder->begin(*camera));
  return std::unique_ptr<OpenNiRecorder>(std::move(recorder));
}

}  // namespace lorica
