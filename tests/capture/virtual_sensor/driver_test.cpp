#include "capture/sensor/oni_file.h"
#include "capture/streams/depth_stream.h"
#include "capture/virtual_sensor/virtual_script.h"
#include "geometry/descriptor.h"
#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "tests/support/datasets.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

extern char** environ;

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// OpenNI2 with our driver and its own driver for files: a folder of links.
class StagedClient {
 public:
  StagedClient() {
    const fs::path library = fs::canonical(LORICA_OPENNI2_LIBRARY);
    const fs::path drivers = folder_.path() / "OpenNI2" / "Drivers";
    fs::create_directories(drivers);
    fs::create_symlink(library, folder_.path() / "libOpenNI2.so.0");
    fs::create_symlink(test::built("lib/lorica/OpenNI2/Drivers/libLoricaSensor.so.0"),
                       drivers / "libLoricaSensor.so.0");
    fs::create_symlink(library.parent_path() / "OpenNI2" / "Drivers" / "libOniFile.so.0", drivers / "libOniFile.so.0");
  }

  [[nodiscard]] fs::path path(const char* name) const { return folder_.path() / name; }

  /// @return its exit status, or 1000 plus the signal that ended it
  int run(const std::string& script, std::vector<std::string> arguments,
          const std::vector<std::string>& more = {}) const {
    arguments.insert(arguments.begin(), test::built("driver_client"));
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    std::vector<std::string> variables = {"LORICA_VIRTUAL=" + script, "LD_LIBRARY_PATH=" + folder_.path().string()};
    variables.insert(variables.end(), more.begin(), more.end());
    std::vector<char*> environment;
    for (char** variable = environ; *variable != nullptr; ++variable) {
      if (std::string(*variable).rfind("LD_LIBRARY_PATH=", 0) != 0) environment.push_back(*variable);
    }
    for (std::string& variable : variables) environment.push_back(variable.data());
    environment.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, path("output").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    pid_t child = 0;
    const int problem = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environment.data());
    posix_spawn_file_actions_destroy(&actions);
    if (problem != 0) return -1;
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

 private:
  test::TemporaryFolder folder_;
};

/// Renders the expected image of the driver at a time.
class Expected {
 public:
  explicit Expected(const std::string& script)
      : sensor_(makeVirtualSensor(parseVirtualScript(script).value()).value()) {}
  const std::vector<std::uint16_t>& at(double time) {
    sensor_.render(static_cast<std::uint64_t>(std::lround(30.0 * time)), frame_);
    return frame_.depthMm;
  }

 private:
  VirtualSensor sensor_;
  DepthFrame frame_;
};

TEST(Driver, TheStockLibraryGivesTheVirtualSensorsOwnFrames) {
  const StagedClient client;
  const std::string script = "motion=wave,turn_around seed=5";
  ASSERT_EQ(client.run(script, {"frames", "30", client.path("frames").string()}), 0);
  const std::string frames = readFile(client.path("frames")).value();
  constexpr std::size_t kBytes = 640 * 480 * 2;
  ASSERT_EQ(frames.size(), 30 * (16 + kBytes));
  Expected expected(script);
  double last = -1.0;
  for (std::size_t i = 0; i < 30; ++i) {
    const char* at = frames.data() + i * (16 + kBytes);
    const double time = 1e-6 * static_cast<double>(loadBytes<std::uint64_t>(at, std::endian::native));
    ASSERT_GT(time, last);
    last = time;
    const auto* pixels = reinterpret_cast<const std::uint16_t*>(at + 16);
    ASSERT_TRUE(std::equal(pixels, pixels + 640 * 480, expected.at(time).begin())) << "frame at " << time;
  }
}

TEST(Driver, TheStockRecorderRecordsItAndNothingIsLost) {
  const StagedClient client;
  const std::string script = "motion=wave pace=fast noise=mild";
  ASSERT_EQ(client.run(script, {"record", "10", client.path("body.oni").string()}), 0);
  Result<std::unique_ptr<OniFile>> source = openOni(client.path("body.oni"));
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_GE((*source)->info().frameCount, 10);
  EXPECT_NEAR((*source)->camera().horizontalFov, DepthCamera{}.horizontalFov, 1e-6);
  EXPECT_FALSE((*source)->info().mirrored);
  Expected expected(script);
  DepthFrame frame;
  for (int i = 0; i < (*source)->info().frameCount; ++i) {
    ASSERT_EQ((*source)->next(frame).value(), DepthRead::kFrame);
    EXPECT_NEAR(frame.time, i / 30.0, 2e-6);  // every frame from the first one on
    ASSERT_EQ(frame.depthMm, expected.at(frame.time)) << "frame " << i;
  }
}

TEST(Driver, WhatAnotherProgramSendsIsACamera) {
  signal(SIGPIPE, SIG_IGN);
  const DepthLens lens = DepthLens::pinhole(640, 480, 1.1, 0.8);
  const auto imageOf = [](std::uint16_t number) {
    std::vector<std::uint16_t> image(640 * 480);
    for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint16_t>(1000 + number + i % 4000);
    return image;
  };
  for (const bool named : {true, false}) {  // by its address, or as the first camera
    const StagedClient client;
    const std::string pipe = client.path("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::thread sender([&] {
      const Descriptor out(open(pipe.c_str(), O_WRONLY | O_CLOEXEC));
      int error = 0;
      for (int sent = 0; error == 0; ++sent) {
        const auto number = static_cast<std::uint16_t>(sent % 4000);
        const auto header = depthHeaderOf(lens, sent / 30.0);
        const std::vector<std::uint16_t> image = imageOf(number);
        std::string bytes(reinterpret_cast<const char*>(header.data()), header.size());
        error = writeAll(out.get(), bytes.append(reinterpret_cast<const char*>(image.data()), 2 * image.size()));
      }
    });
    const std::vector<std::string> variables = {named ? "CLIENT_URI=lorica://depth/" + pipe : "CLIENT_URI=",
                                                named ? "LORICA_DEPTH=" : "LORICA_DEPTH=" + pipe};
    EXPECT_EQ(client.run("", {"frames", "5", client.path("frames").string()}, variables), 0);
    sender.join();
    const std::string frames = readFile(client.path("frames")).value();
    constexpr std::size_t kBytes = 640 * 480 * 2;
    ASSERT_EQ(frames.size(), 5 * (16 + kBytes));
    double last = -1.0;
    for (std::size_t i = 0; i < 5; ++i) {
      const char* at = frames.data() + i * (16 + kBytes);
      const double time = 1e-6 * static_cast<double>(loadBytes<std::uint64_t>(at, std::endian::native));
      EXPECT_GT(time, last);
      last = time;
      const auto* pixels = reinterpret_cast<const std::uint16_t*>(at + 16);
      const std::vector<std::uint16_t> expected = imageOf(static_cast<std::uint16_t>(pixels[0] - 1000));
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), pixels)) << "frame " << i;
    }
  }
}

TEST(Driver, AHundredOpensAndCloses) {
  const StagedClient client;
  EXPECT_EQ(client.run("pace=fast noise=none", {"cycle", "100"}), 0);
}

TEST(Driver, UnpluggedTheCameraGoesAndComesBack) {
  const StagedClient client;
  ASSERT_EQ(client.run("unplug=1:5", {"unplug", "60"}), 0);
  unsigned long long before = 0, after = 0;
  ASSERT_EQ(std::sscanf(readFile(client.path("output")).value().c_str(), "%llu %llu", &before, &after), 2);
  EXPECT_LT(before, 1000000U);
  EXPECT_GE(after, 5000000U);  // its clock continues
}

TEST(Driver, ABadScriptIsRefusedWithoutACrash) {
  const StagedClient client;
  EXPECT_EQ(client.run("motion=flying", {"frames", "1", client.path("frames").string()}), 1);
  EXPECT_EQ(client.run("motion=absent.csv", {"frames", "1", client.path("frames").string()}), 1);
}

}  // namespace
}  // namespace lorica
