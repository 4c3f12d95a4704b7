#pragma once

#include "tests/apps/hands.h"
#include "tests/support/datasets.h"
#include "tests/support/virtual_display.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lorica::test {

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

/// A recording that ships with Lorica.
inline std::filesystem::path shipped(const std::string& name) {
  return recordingsFolder() / name;
}

class WindowPlay : public ::testing::Test {
 protected:
  void SetUp() override {
    LORICA_REQUIRE_KEYS();
    body_ = mannequinBody(folder_);
  }

  TemporaryFolder folder_;
  std::filesystem::path body_;
};

}  // namespace lorica::test
