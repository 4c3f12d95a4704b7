#include "viewer/window.h"

#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/viewer/pictures.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace lorica {
namespace {

bool installed(const std::string& program) {
  return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
}

/// A virtual X server of its own while this lives; DISPLAY points to it.
class VirtualDisplay {
 public:
  VirtualDisplay() {
    int ends[2];
    if (pipe(ends) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      close(ends[0]);
      const std::string fd = std::to_string(ends[1]);
      execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "800x600x24", "-nolisten", "tcp", nullptr);
      _exit(127);
    }
    close(ends[1]);
    // The server writes its number when it is ready, or closes the pipe when it fails.
    std::string number;
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number += c;
    close(ends[0]);
    if (!number.empty()) setenv("DISPLAY", (":" + number).c_str(), 1);
    ready_ = !number.empty();
  }
  ~VirtualDisplay() {
    unsetenv("DISPLAY");
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
  [[nodiscard]] bool ready() const { return ready_; }

 private:
  pid_t pid_ = -1;
  bool ready_ = false;
};

struct Box {
  TriMesh mesh = test::makeBox({-0.3, 0.6, -0.3}, {0.3, 1.4, 0.3});
  std::vector<LivePart> parts = {test::boxPart({-0.5, 0.5, -0.5}, {0.5, 1.5, 0.5})};
  Scene scene;
  Box() {
    scene.vertices = mesh.vertices;
    scene.triangles = mesh.triangles;
    scene.parts = parts;
  }
};

TEST(Window, WithoutDisplayItSaysWhatToDo) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  EXPECT_FALSE(displayAvailable());
  const Result<Window> window = Window::create("test", 320, 240);
  ASSERT_FALSE(window.ok());
  EXPECT_EQ(window.error().code, ErrorCode::kNoDisplay);
  EXPECT_NE(window.error().message.find("without --window"), std::string::npos) << window.error().message;
}

TEST(Window, ADisplayThatIsNotThereIsAnErrorToo) {
  unsetenv("WAYLAND_DISPLAY");
  setenv("DISPLAY", ":54321", 1);
  EXPECT_TRUE(displayAvailable());
  const Result<Window> window = Window::create("test", 320, 240);
  unsetenv("DISPLAY");
  ASSERT_FALSE(window.ok());
  EXPECT_EQ(window.error().code, ErrorCode::kNoDisplay);
}

TEST(Window, ImpossibleSizesAreRefused) {
  EXPECT_EQ(Window::create("test", 0, 240).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(Window::create("test", 320, -1).error().code, ErrorCode::kInvalidArgument);
}

TEST(Window, OpensShowsFramesAndClosesBesideAnOffscreenContext) {
  if (!installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed (Debian package xvfb)";
  const VirtualDisplay display;
  ASSERT_TRUE(display.ready());
  const Box box;
  for (int turn = 0; turn < 2; ++turn) {  // a second window after the first one is gone
    Result<Window> window = Window::create("Lorica test", 320, 240);
    ASSERT_TRUE(window.ok()) << window.error().message;
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(window->open());
      EXPECT_TRUE(window->wantsStep());
      window->show(box.scene, "frame");
    }
  }
  LORICA_REQUIRE_STUDIO(studio, "");
  const Image image = studio->draw(box.scene, {}, test::frontCamera(), 64, 48);
  EXPECT_NE(test::pixelAt(image, 32, 24), test::pixelAt(image, 0, 0));
}

TEST(Window, KeysAndMouseChangeWhatIsDrawn) {
  if (!installed("Xvfb") || !installed("xdotool")) {
    GTEST_SKIP() << "Xvfb or xdotool is not installed (Debian packages xvfb, xdotool)";
  }
  const VirtualDisplay display;
  ASSERT_TRUE(display.ready());
  const test::TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());  // where screenshots go
  const Box box;
  {
    Result<Window> window = Window::create("Lorica test", 320, 240);
    ASSERT_TRUE(window.ok()) << window.error().message;
    const auto frames = [&](int n) {
      for (int i = 0; i < n; ++i) {
        window->show(box.scene, "");
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    };
    frames(2);
    const auto send = [&](const std::string& what) {
      const std::string command =
          "xdotool search --sync --name 'Lorica test' windowfocus --sync " + what + " > /dev/null 2>&1";
      EXPECT_EQ(std::system(command.c_str()), 0) << command;
      frames(5);
    };
    const auto picture = [&](const char* name) {
      send("key p");
      const Result<Image> read = readPng(name);
      EXPECT_TRUE(read.ok()) << read.error().message;
      return read.ok() ? read.value() : Image{};
    };
    const Image first = picture("lorica-001.png");
    EXPECT_EQ(first.width, 320);
    send("key 2");  // hulls off
    const Image second = picture("lorica-002.png");
    EXPECT_GT(test::differingPixels(first, second, 8), 500);
    send("mousemove --window %1 100 100 mousedown 1 mousemove --window %1 160 110 mouseup 1");
    const Image third = picture("lorica-003.png");
    EXPECT_GT(test::differingPixels(second, third, 8), 500);
    send("key r");
    EXPECT_EQ(picture("lorica-004.png").rgba, second.rgba) << "the camera is back at its start";

    EXPECT_TRUE(window->wantsStep());
    send("key space");
    EXPECT_FALSE(window->wantsStep()) << "paused";
    send("key n");
    EXPECT_TRUE(window->wantsStep()) << "one step";
    EXPECT_FALSE(window->wantsStep());
    EXPECT_TRUE(window->open());
    send("key Escape");
    EXPECT_FALSE(window->open());
  }
  std::filesystem::current_path(before);
}

}  // namespace
}  // namespace lorica
