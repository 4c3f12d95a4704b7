#pragma once

#include "geometry/files.h"
#include "tests/apps/run_command.h"
#include "tests/support/background_script.h"
#include "tests/support/datasets.h"
#include "tests/support/virtual_display.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

namespace lorica::test {

/// Presses keys in a window of the command while it runs.
class Hands {
 public:
  explicit Hands(const TemporaryFolder& folder) : folder_(folder) {
    // Whatever goes wrong, the window is closed.
    script_ << "trap 'xdotool key Escape key Escape' EXIT\ntrap 'exit 1' TERM\nset -e\nw=$(xdotool search --sync "
               "--name '^Lorica: ')\n"
            << "xdotool windowfocus --sync $w\n"
            << "await() { i=0; while [ ! -s $1 ] && [ $i -lt 400 ]; do sleep 0.05; i=$((i+1)); done; sleep 0.1; }\n";
  }
  void press(const std::string& keys) { script_ << "xdotool key " << keys << '\n'; }
  void mouse(const std::string& what) { script_ << "xdotool " << what << '\n'; }
  /// Takes a picture after all previous input was processed and drawn.
  void picture(const std::string& key = "p") {
    char name[32];
    std::snprintf(name, sizeof name, "lorica-%03d.png", ++pictures_);
    script_ << "xdotool key " << key << "\nawait " << name << '\n';
  }
  void line(const std::string& command) { script_ << command << '\n'; }
  void sleep(const std::string& seconds) { script_ << "sleep " << seconds << '\n'; }

  /// Runs the script in parallel with the command, until the command has ended.
  CommandResult runWith(const std::vector<std::string>& arguments, const VirtualDisplay& display) {
    script_ << "xdotool key Escape\n";
    const std::filesystem::path file = folder_.write("hands.sh", script_.str());
    const BackgroundScript hands(file, kMostSeconds, folder_.path() / "hands.log");
    CommandSurroundings surroundings;
    surroundings.folder = folder_.path();
    surroundings.display = display.name();
    const CommandResult result = runLorica(arguments, surroundings);
    said_ = readFile(folder_.path() / "hands.log").value();
    return result;
  }
  /// What the script did and said in the last run.
  [[nodiscard]] const std::string& said() const { return said_; }
  [[nodiscard]] Image pictureNumber(int n) const {
    char name[32];
    std::snprintf(name, sizeof name, "lorica-%03d.png", n);
    const Result<Image> read = readPng(folder_.path() / name);
    EXPECT_TRUE(read.ok()) << read.error().message;
    return read.ok() ? read.value() : Image{};
  }

 private:
  static constexpr int kMostSeconds = 180;  ///< of a script: under sanitizers a body takes more than a minute to make

  const TemporaryFolder& folder_;
  std::ostringstream script_;
  std::string said_;
  int pictures_ = 0;
};

struct Blob {
  int count = 0;
  double x = 0.0, y = 0.0;  // its centroid [pixels]
};

/// The pixels of the red box.
inline Blob redIn(const Image& image) {
  Blob blob;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.rgba.data() + (static_cast<std::ptrdiff_t>(y) * image.width + x) * 4;
      if (p[0] < 90 || p[1] > p[0] / 2 || p[2] > p[0] / 2) continue;
      ++blob.count;
      blob.x += x;
      blob.y += y;
    }
  }
  if (blob.count > 0) blob.x /= blob.count, blob.y /= blob.count;
  return blob;
}

inline int differing(const Image& a, const Image& b) {
  if (a.rgba.size() != b.rgba.size()) return -1;
  int count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    const auto apart = [&](std::size_t c) { return std::abs(int{a.rgba[i + c]} - int{b.rgba[i + c]}) > 12; };
    count += apart(0) || apart(1) || apart(2) ? 1 : 0;
  }
  return count;
}

/// A recording that ships with Lorica.
inline std::filesystem::path shipped(const std::string& name) {
  return recordingsFolder() / name;
}

class WindowPlay : public ::testing::Test {
 protected:
  void SetUp() override {
    LORICA_REQUIRE_KEYS();
    display_.emplace();
    ASSERT_TRUE(display_->ready());
    body_ = folder_.path() / "body.lorica";
    const CommandResult made = runLorica({"decompose", "mannequin", "--parts", "5", "--keyframes", "2", "-o", body_});
    ASSERT_EQ(made.exitCode, 0) << made.err;
  }

  TemporaryFolder folder_;
  std::optional<VirtualDisplay> display_;
  std::filesystem::path body_;
};

}  // namespace lorica::test
