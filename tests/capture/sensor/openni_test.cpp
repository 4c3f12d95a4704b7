#include "capture/sensor/openni.h"

#include "capture/sensor/depth_recording.h"
#include "capture/sensor/oni_file.h"
#include "tests/capture/sensor/openni_test_driver.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

// A separate program without checks for leaks and mutex misuse: OpenNI2's drivers lose memory with each start, and its
// locks are unlocked more often than locked, and in any order. Races are checked.
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0";
}
extern "C" const char* __tsan_default_options() {
  return "report_mutex_bugs=0:detect_deadlocks=0";
}

namespace lorica {
namespace {

namespace fs = std::filesystem;

const fs::path kTestDriver = test::built("tests/capture/sensor/libopenni_test_driver.so");

/// OpenNI2 with the test driver, and a folder whose files are cameras.
class OpenNiTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(setenv("LORICA_TEST_CAMERAS", plug_.path().c_str(), 1), 0); }

  void plugIn(const std::string& name, const std::string& oddity = {}) {
    // Write to another folder first: the driver must not see a partial file.
    fs::rename(beside_.write(name, oddity), plug_.path() / name);
  }
  void unplug(const std::string& name) { fs::remove(plug_.path() / name); }

  static std::shared_ptr<OpenNi> start() { return test::valueOf(OpenNi::start({{kTestDriver}, {}})); }

  /// Reads until the wanted result. @return whether no error came instead
  static bool readUntil(DepthSource& source, DepthRead wanted, DepthFrame& frame) {
    for (;;) {
      const Result<DepthRead> read = source.next(frame);
      if (!read) ADD_FAILURE() << read.error().message;
      if (!read) return false;
      if (*read == wanted) return true;
    }
  }

  const test::TemporaryFolder plug_;
  const test::TemporaryFolder beside_;
};

void expectFrame(const DepthFrame& frame, int width, int height, bool turned = false) {
  ASSERT_EQ(frame.depthMm.size(), static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int first = turned ? width - 1 : 0;
  const int n = frame.depthMm[first] - 1000;
  for (int p = 0; p < width * height; ++p) {
    const int seen = turned ? (p / width) * width + width - 1 - p % width : p;
    ASSERT_EQ(frame.depthMm[p], test::openNiTestDepth(n, seen)) << "pixel " << p;
  }
}

TEST_F(OpenNiTest, ListsCamerasAndDrivers) {
  plugIn("a");
  const fs::path before = fs::current_path();
  const std::shared_ptr<OpenNi> openNi = start();
  EXPECT_EQ(fs::current_path(), before) << "OpenNI2 changes it";
  std::vector<OpenNiCamera> cameras = test::valueOf(openNi->cameras());
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_EQ(cameras[0].uri, "test/a");
  EXPECT_EQ(cameras[0].vendor, "Lorica");
  EXPECT_EQ(cameras[0].name, "Test camera");
  EXPECT_EQ(cameras[0].usbVendor, 0x1209);
  EXPECT_EQ(cameras[0].driver, kTestDriver.filename());
  const std::vector<OpenNiDriver>& drivers = openNi->drivers();
  ASSERT_FALSE(drivers.empty());
  EXPECT_EQ(drivers.back().file, fs::canonical(kTestDriver));
  EXPECT_FALSE(drivers.back().packaged);
  EXPECT_TRUE(drivers.front().packaged);
  for (const OpenNiDriver& driver : drivers) EXPECT_EQ(driver.problem, "") << driver.file;
}

TEST_F(OpenNiTest, GivesFramesOfTheWantedMode) {
  plugIn("a");
  const std::shared_ptr<OpenNi> openNi = start();
  std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  EXPECT_EQ(source->name(), "Lorica, Test camera (test/a)");
  EXPECT_EQ(source->camera(), (DepthCamera{640, 480, 1.0, 0.75}));
  DepthFrame frame;
  double last = -1.0;
  int lastNumber = -1;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
    expectFrame(frame, 640, 480);
    EXPECT_GT(frame.time, last);
    last = frame.time;
    const int number = frame.depthMm[0] - 1000;
    EXPECT_GT(number, lastNumber);
    lastNumber = number;
    EXPECT_NEAR(frame.time, 1.0 + 0.01 * number, 1e-9) << "the camera's own clock";
  }
}

TEST_F(OpenNiTest, WaitsATenthOfASecond) {
  plugIn("a", "slow");
  const std::shared_ptr<OpenNi> openNi = start();
  std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  DepthFrame frame;
  EXPECT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
  EXPECT_TRUE(readUntil(*source, DepthRead::kWaiting, frame));
  EXPECT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
}

TEST_F(OpenNiTest, OddCamerasGiveTheSameKindOfFrames) {
  plugIn("mirrored", "mirrored");
  plugIn("small", "small");
  plugIn("tenths", "tenths");
  const std::shared_ptr<OpenNi> openNi = start();
  DepthFrame frame;
  {
    const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open("test/mirrored"));
    ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
    expectFrame(frame, 640, 480, true);
  }
  {
    const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open("test/small"));
    EXPECT_EQ(source->camera().width, 320) << "nearer to 640 than 160";
    ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
    expectFrame(frame, 320, 240);
  }
  {
    const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open("test/tenths"));
    ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
    const int n = (frame.depthMm[0] * 10 - 1000);
    EXPECT_NEAR(frame.depthMm[1000], test::openNiTestDepth(n, 1000) / 10.0, 12.0);
  }
}

TEST_F(OpenNiTest, TheFirstCameraThatGivesDepthIsTaken) {
  plugIn("a", "no depth");
  plugIn("b");
  const std::shared_ptr<OpenNi> openNi = start();
  const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  EXPECT_EQ(source->name(), "Lorica, Test camera (test/b)");
  const Result<std::unique_ptr<DepthSource>> none = openNi->open("test/a");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("provides no depth"), std::string::npos) << none.error().message;
}

TEST_F(OpenNiTest, CamerasThatAreNotThereAreSentences) {
  const std::shared_ptr<OpenNi> openNi = start();
  const Result<std::unique_ptr<DepthSource>> any = openNi->open();
  ASSERT_FALSE(any);
  EXPECT_EQ(any.error().code, ErrorCode::kNotFound);
  const Result<std::unique_ptr<DepthSource>> named = openNi->open("test/x");
  ASSERT_FALSE(named);
  EXPECT_NE(named.error().message.find("test/x"), std::string::npos) << named.error().message;
  plugIn("y", "broken");
  while (openNi->cameras()->empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const Result<std::unique_ptr<DepthSource>> broken = openNi->open("test/y");
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().message.find("cannot be opened"), std::string::npos) << broken.error().message;
}

TEST_F(OpenNiTest, AnUnpluggedCameraComesBack) {
  plugIn("a");
  const std::shared_ptr<OpenNi> openNi = start();
  const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  DepthFrame frame;
  double last = -1.0;
  for (const char* back : {"a", "another socket", "a"}) {
    ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
    EXPECT_GT(frame.time, last);
    last = frame.time;
    for (const fs::directory_entry& file : fs::directory_iterator(plug_.path())) fs::remove(file);
    ASSERT_TRUE(readUntil(*source, DepthRead::kUnplugged, frame));
    last = frame.time;
    const DepthRead still = test::valueOf(source->next(frame));
    EXPECT_EQ(still, DepthRead::kUnplugged);
    EXPECT_EQ(frame.time, last) << "unchanged";
    plugIn(back);
    ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
    expectFrame(frame, 640, 480);
    EXPECT_GT(frame.time, last + 0.09) << "includes the time without a camera";
    last = frame.time;
  }
}

TEST_F(OpenNiTest, ACameraThatReturnsWithOtherImagesIsASentence) {
  plugIn("a");
  const std::shared_ptr<OpenNi> openNi = start();
  const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  DepthFrame frame;
  ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
  unplug("a");
  ASSERT_TRUE(readUntil(*source, DepthRead::kUnplugged, frame));
  plugIn("a", "small");
  Result<DepthRead> read = DepthRead::kUnplugged;
  while (read) read = source->next(frame);
  EXPECT_NE(read.error().message.find("returned with images of 320 x 240, expected 640 x 480"), std::string::npos)
      << read.error().message;
}

TEST_F(OpenNiTest, ARecordingThatDoesNotStartLeavesNoFile) {
  plugIn("a");
  const std::shared_ptr<OpenNi> openNi = start();
  const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  const fs::path folder = beside_.path() / "no folder";
  EXPECT_FALSE(DepthRecorder::start(*source, folder / "body.oni"));
  EXPECT_FALSE(fs::exists(folder));
  // Afterwards another one can start, and it keeps what a killed program left.
  beside_.write("body.part.oni", "found");
  const std::unique_ptr<DepthRecorder> recorder =
      test::valueOf(DepthRecorder::start(*source, beside_.path() / "body.oni"));
  EXPECT_EQ(recorder->found(), beside_.path() / "body.found-1.oni");
  EXPECT_EQ(fs::file_size(beside_.path() / "body.found-1.oni"), 5u);
}

TEST_F(OpenNiTest, AHundredOpensAndCloses) {
  plugIn("a", "small");
  DepthFrame frame;
  for (int starts = 0; starts < 4; ++starts) {
    const std::shared_ptr<OpenNi> openNi = start();
    for (int i = 0; i < 25; ++i) {
      const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
      if (i % 2 == 0) {
        ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
      }
    }
  }
}

TEST_F(OpenNiTest, OpenNiIsSharedAndItsDriversAreFixed) {
  const std::shared_ptr<OpenNi> one = start();
  EXPECT_EQ(one, start());
  const Result<std::shared_ptr<OpenNi>> other = OpenNi::start();
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("other drivers"), std::string::npos) << other.error().message;
}

TEST_F(OpenNiTest, WithoutTheDriverItsCamerasAreNotSeen) {
  plugIn("a");
  for (int i = 0; i < 2; ++i) {
    {
      const std::shared_ptr<OpenNi> with = start();
      EXPECT_EQ(with->cameras()->size(), 1u);
    }
    const std::shared_ptr<OpenNi> without = test::valueOf(OpenNi::start());
    EXPECT_EQ(without->cameras()->size(), 0u);
  }
}

TEST_F(OpenNiTest, DriversThatAreNoneAreSentences) {
  const auto problem = [](const OpenNiSettings& settings) {
    const Result<std::shared_ptr<OpenNi>> openNi = OpenNi::start(settings);
    return openNi ? "it started" : openNi.error().message;
  };
  EXPECT_NE(problem({{beside_.path() / "no.so"}, {}}).find("no such file"), std::string::npos);
  EXPECT_NE(problem({{beside_.write("text.so", "a text")}, {}}).find("cannot be loaded"), std::string::npos);
  EXPECT_NE(problem({{"/lib/x86_64-linux-gnu/libm.so.6"}, {}}).find("oniDriverCreate"), std::string::npos);
  EXPECT_NE(problem({{}, beside_.write("libOpenNI2.so.0", "no library")}).find("cannot be loaded"), std::string::npos);
  EXPECT_NE(start(), nullptr) << "a valid one works afterwards";
}

TEST_F(OpenNiTest, RecordsEveryFrameToTheLastBit) {
  plugIn("a", "slow");  // an image every 0.3 s: none is missed on a busy machine either
  const std::shared_ptr<OpenNi> openNi = start();
  const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  DepthFrame frame;
  ASSERT_TRUE(readUntil(*source, DepthRead::kFrame, frame));
  const fs::path path = beside_.path() / "body.oni";
  std::vector<DepthFrame> given;
  {
    std::unique_ptr<DepthRecorder> recorder = test::valueOf(DepthRecorder::start(*source, path));
    EXPECT_FALSE(DepthRecorder::start(*source, path)) << "its file is locked";
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(readUntil(*recorder, DepthRead::kFrame, frame));
      given.push_back(frame);
    }
    recorder->stop();
    while (test::valueOf(recorder->next(frame)) == DepthRead::kFrame) given.push_back(frame);
    EXPECT_EQ(test::valueOf(recorder->finish()), std::ssize(given)) << "each image is given, late or not";
  }
  EXPECT_FALSE(fs::exists(beside_.path() / "body.part.oni"));
  OniFile file = test::valueOf(OniFile::open(path));
  EXPECT_EQ(file.info().end, fs::file_size(path));
  EXPECT_FALSE(file.info().cutOff);
  ASSERT_EQ(file.info().frameCount, std::ssize(given));
  EXPECT_EQ(file.info().camera, (DepthCamera{640, 480, 1.0, 0.75}));
  EXPECT_FALSE(file.info().mirrored);
  int lastNumber = -1;
  for (int i = 0; i < file.info().frameCount; ++i) {
    ASSERT_TRUE(file.read(i, frame));
    expectFrame(frame, 640, 480);
    EXPECT_EQ(frame.depthMm, given[i].depthMm);
    EXPECT_NEAR(frame.time, given[i].time - given[0].time, 1e-6);
    const int number = frame.depthMm[0] - 1000;
    if (i > 0) {
      EXPECT_EQ(number, lastNumber + 1) << "no frame is lost";
    }
    lastNumber = number;
  }
  // Once more, as long as is asked.
  const std::unique_ptr<DepthRecorder> again = test::valueOf(DepthRecorder::start(*source, path, {3, 0.0}));
  int images = 0;
  while (test::valueOf(again->next(frame)) != DepthRead::kEnd) images += frame.time > given.back().time ? 1 : 0;
  EXPECT_GE(images, 3);
  EXPECT_EQ(test::valueOf(again->finish()), 3);
  EXPECT_EQ(test::valueOf(OniFile::open(path)).info().frameCount, 3);
}

TEST_F(OpenNiTest, WhatAKilledProgramRecordedCanBePlayed) {
  plugIn("a");
  const fs::path path = beside_.path() / "body.oni";
  const pid_t child = fork();
  if (child == 0) {
    (void)setenv("TMPDIR", beside_.path().c_str(), 1);  // leftover files are removed with the test
    const Result<std::shared_ptr<OpenNi>> openNi = OpenNi::start({{kTestDriver}, {}});
    if (!openNi) _exit(1);
    const Result<std::unique_ptr<DepthSource>> source = (*openNi)->open();
    if (!source) _exit(2);
    const Result<std::unique_ptr<DepthRecorder>> recorder = DepthRecorder::start(**source, path);
    if (!recorder) _exit(3);
    DepthFrame frame;
    for (;;) (void)(*recorder)->next(frame);
  }
  int status = 0;
  for (bool enough = false; !enough;) {
    ASSERT_EQ(waitpid(child, &status, WNOHANG), 0) << "it ended by itself: " << WEXITSTATUS(status);
    const Result<OniFile> soFar = OniFile::open(beside_.path() / "body.part.oni");
    enough = soFar && soFar->info().frameCount > 5;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  OniFile file = test::valueOf(OniFile::open(beside_.path() / "body.part.oni"));
  EXPECT_TRUE(file.info().cutOff);
  EXPECT_GT(file.info().frameCount, 5);
  DepthFrame frame;
  for (int i = 0; i < file.info().frameCount; ++i) {
    ASSERT_TRUE(file.read(i, frame));
    expectFrame(frame, 640, 480);
  }
}

TEST_F(OpenNiTest, UnpluggingWhileRecordingKeepsWhatWasRecorded) {
  plugIn("a");
  const std::shared_ptr<OpenNi> openNi = start();
  const std::unique_ptr<DepthSource> source = test::valueOf(openNi->open());
  std::unique_ptr<DepthRecorder> recorder = test::valueOf(DepthRecorder::start(*source, beside_.path() / "body.oni"));
  DepthFrame frame;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(readUntil(*recorder, DepthRead::kFrame, frame));
  unplug("a");
  ASSERT_TRUE(readUntil(*recorder, DepthRead::kUnplugged, frame));
  EXPECT_GE(test::valueOf(recorder->finish()), 5);
}

/// What cannot be read any more ends the recording, and what came before is given and kept.
TEST_F(OpenNiTest, AnErrorOfTheSourceComesAfterItsImages) {
  class Failing final : public DepthSource {
   public:
    [[nodiscard]] const DepthCamera& camera() const override { return camera_; }
    [[nodiscard]] std::string name() const override { return "failing"; }
    Result<DepthRead> next(DepthFrame& frame) override {
      if (++images_ > 3) return Error{ErrorCode::kBadFormat, "the cable broke"};
      frame.time = images_;
      frame.depthMm.assign(48, static_cast<std::uint16_t>(images_));
      return DepthRead::kFrame;
    }

   private:
    DepthCamera camera_{8, 6, 1.0, 0.8};
    int images_ = 0;
  } source;
  const std::unique_ptr<DepthRecorder> recorder =
      test::valueOf(DepthRecorder::start(source, beside_.path() / "body.oni"));
  DepthFrame frame;
  Result<DepthRead> read = DepthRead::kWaiting;
  int images = 0;
  for (; read; read = recorder->next(frame)) images += *read == DepthRead::kFrame ? 1 : 0;
  EXPECT_EQ(images, 3);
  EXPECT_EQ(read.error().message, "the cable broke");
  EXPECT_EQ(test::valueOf(recorder->finish()), 3);
  EXPECT_EQ(test::valueOf(OniFile::open(beside_.path() / "body.oni")).info().frameCount, 3);
}

}  // namespace
}  // namespace lorica
