#include "tests/apps/hands.h"

#include "geometry/files.h"
#include "tests/support/background_process.h"
#include "tests/support/virtual_display.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace lorica::test {
namespace {

/// Of one run, before it is given up: under sanitizers a body takes more than a minute to make. ctest's limit is above.
constexpr unsigned kMaxSeconds = 200;

constexpr std::string_view kGivenUp = "given up: the window did not do what was waited for\n";

/// So many equal pictures in a row take longer than a frame of a session.
constexpr int kAtRest = 5;

/// Escape closes a list or the help first.
[[noreturn]] void closeWindow() {
  execlp("xdotool", "xdotool", "key", "Escape", "key", "Escape", nullptr);
  _exit(127);
}

}  // namespace

int differing(const Image& a, const Image& b) {
  if (a.rgba.size() != b.rgba.size()) return -1;
  int count = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    const auto apart = [&](std::size_t c) { return std::abs(int{a.rgba[i + c]} - int{b.rgba[i + c]}) > 12; };
    count += apart(0) || apart(1) || apart(2) ? 1 : 0;
  }
  return count;
}

Hands::Hands(const TemporaryFolder& folder, std::string window) : folder_(folder), window_(std::move(window)) {
  surroundings.folder = folder.path();
}

void Hands::run(const std::string& command) {
  std::fprintf(stderr, "+ %s\n", command.c_str());
  if (std::system(command.c_str()) == 0) return;
  std::fprintf(stderr, "failed\n");
  closeWindow();
}

std::filesystem::path Hands::file(int n) const {
  char name[32];
  std::snprintf(name, sizeof name, "lorica-%03d.png", n);
  return folder_.path() / name;
}

/// The window gives a picture the first unused number.
Image Hands::shoot(int n, const std::string& key) const {
  std::filesystem::remove(file(n));
  run("xdotool key " + key);
  for (;;) {  // there may only be the first part of it yet
    if (Result<Image> read = readPng(file(n)); read.ok()) return std::move(read).value();
    usleep(5000);
  }
}

void Hands::handled() {
  steps_.push_back([this, n = pictures_ + 1] {
    for (int i = 0; i < 3; ++i) (void)shoot(n, "p");
    std::filesystem::remove(file(n));
  });
}

void Hands::picture(const std::string& key) {
  pictureWhen([](const Image&) { return true; }, key);
}

void Hands::pictureWhen(const std::function<bool(const Image&)>& wanted, const std::string& key) {
  steps_.push_back([this, wanted, key, n = ++pictures_] {
    while (!wanted(shoot(n, key))) continue;
  });
}

void Hands::pictureUnlike(int earlier, int pixels, const std::string& key) {
  pictureWhen([=, this](const Image& now) { return differing(pictureNumber(earlier), now) > pixels; }, key);
}

void Hands::pictureAtRest(const std::string& key) {
  pictureWhen(
      [first = Image(), equal = 0](const Image& now) mutable {
        if (differing(first, now) != 0) {
          first = now;
          equal = 0;
        }
        return ++equal == kAtRest;
      },
      key);
}

void Hands::work() const {
  std::signal(SIGALRM, [](int) {
    (void)!write(STDERR_FILENO, kGivenUp.data(), kGivenUp.size());
    closeWindow();
  });
  alarm(kMaxSeconds);
  run("xdotool search --sync --onlyvisible --name '" + window_ + "' > window");
  setenv("w", std::to_string(std::atol(readFile("window").value().c_str())).c_str(), 1);
  run("xdotool windowfocus --sync $w");
  for (const std::function<void()>& step : steps_) step();
  closeWindow();
}

CommandResult Hands::runWith(const std::vector<std::string>& arguments) {
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder_.path())) {
    if (entry.path().filename().string().starts_with("lorica-")) std::filesystem::remove(entry.path());
  }
  const VirtualDisplay display;
  EXPECT_TRUE(display.ready());
  surroundings.display = display.name();
  const std::filesystem::path log = folder_.path() / "hands.log";
  const BackgroundProcess hands(
      [this] {
        std::filesystem::current_path(folder_.path());
        work();
      },
      log);
  const CommandResult result = runLorica(arguments, surroundings);
  said_ = readFile(log).value();
  EXPECT_EQ(said_.find(kGivenUp), std::string::npos) << said_;
  return result;
}

Image Hands::pictureNumber(int n) const {
  const Result<Image> read = readPng(file(n));
  EXPECT_TRUE(read.ok()) << read.error().message << '\n' << said_;
  return read.ok() ? read.value() : Image{};
}

}  // namespace lorica::test
