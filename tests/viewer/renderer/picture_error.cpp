#include "tests/viewer/renderer/picture_error.h"

#include "viewer/pictures/image_files.h"

#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

constexpr int kTolerance = 40;  // per channel

const std::uint8_t* pixel(const Image& image, int x, int y) {
  return image.rgba.data() + (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)) * 4;
}

fs::path goldenFile(const std::string& name) {
  return sourceFile("tests/data/golden") / (name + ".png");
}

}  // namespace

int differenceNearby(const Image& a, const Image& b, int x, int y) {
  const std::uint8_t* wanted = pixel(a, x, y);
  int smallest = 255;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, b.height - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, b.width - 1); ++u) {
      const std::uint8_t* found = pixel(b, u, v);
      int greatest = 0;
      for (int c = 0; c < 3; ++c) greatest = std::max(greatest, std::abs(wanted[c] - found[c]));
      smallest = std::min(smallest, greatest);
    }
  }
  return smallest;
}

PictureError pictureError(const Image& a, const Image& b) {
  PictureError error;
  if (a.width != b.width || a.height != b.height || a.rgba.empty()) return error;
  error.shown = a;
  int wrong = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      std::uint8_t* out = error.shown.rgba.data() + (pixel(a, x, y) - a.rgba.data());
      const auto grey = static_cast<std::uint8_t>((out[0] + out[1] + out[2]) / 6 + 64);
      const bool bad = differenceNearby(a, b, x, y) > kTolerance || differenceNearby(b, a, x, y) > kTolerance;
      wrong += bad;
      out[0] = bad ? 255 : grey;
      out[1] = out[2] = bad ? 0 : grey;
    }
  }
  error.wrong = static_cast<double>(wrong) / (static_cast<double>(a.width) * a.height);
  return error;
}

Image readGolden(const std::string& name) {
  Result<Image> golden = readPng(goldenFile(name));
  if (golden) return std::move(golden).value();
  ADD_FAILURE() << golden.error().message;
  return {};
}

void expectGolden(const std::string& name, const Image& picture) {
  if (const char* renew = std::getenv("LORICA_RENEW_GOLDEN"); renew != nullptr && std::string(renew) == "1") {
    const Result<void> written = writePng(goldenFile(name), picture);
    EXPECT_TRUE(written) << written.error().message;
    return;
  }
  const Image golden = readGolden(name);
  if (golden.rgba.empty()) return;
  const PictureError error = pictureError(picture, golden);
  if (error.wrong <= kMaxWrong) return;
  const fs::path kept = built("golden_failed") / (name + ".png");
  std::error_code ignored;
  fs::create_directories(kept.parent_path(), ignored);
  const std::vector<Image> all = {golden, picture, error.shown};
  const std::vector<std::string> labels = {"expected", "found", "wholly wrong in red"};
  const bool saved = writePng(kept, contactSheet(all, labels, 3)).ok();
  ADD_FAILURE() << name << ": " << 100.0 * error.wrong << " % of the pixels are wrong, at most " << 100.0 * kMaxWrong
                << " % are allowed; " << (saved ? "see " : "could not save ") << kept.string();
}

}  // namespace lorica::test
