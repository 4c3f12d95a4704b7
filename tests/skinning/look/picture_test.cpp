#include "skinning/look/picture.h"

#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/work_budgets.h"
#include "skinning/look/picture_shrink.h"
#include "tests/skinning/look/picture_samples.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>
#include <set>
#include <thread>

namespace lorica::test {
namespace {

std::string withSize(std::string png, std::uint32_t width, std::uint32_t height) {
  std::string size;
  for (const std::uint32_t side : {width, height}) {
    for (int shift = 24; shift >= 0; shift -= 8) size += static_cast<char>(side >> shift);
  }
  return png.substr(0, 8) + pngChunk("IHDR", size + png.substr(24, 5)) + png.substr(33);
}

TEST(Picture, OtherTypesAreNamed) {
  const auto padded = [](std::string_view head) { return std::string(head) + std::string(60, '\0'); };
  expectRefused(decoded(padded({"\xabKTX 20\xbb\r\n\x1a\n", 12})), ErrorCode::kUnsupported,
                "a KTX2 picture, expected a PNG, JPEG or WebP picture");
  expectRefused(decoded(padded({"sB\x13\0", 4})), ErrorCode::kUnsupported, "a Basis picture");
  expectRefused(decoded(padded({"\0\0\0\x1c"
                                "ftypavif",
                                12})),
                ErrorCode::kUnsupported, "an AVIF picture");
  expectRefused(decoded(padded("GIF89a")), ErrorCode::kUnsupported, "a GIF picture");
  expectRefused(decoded(padded("BM")), ErrorCode::kUnsupported, "a BMP picture");
  expectRefused(decoded("<svg/>"), ErrorCode::kUnsupported, "begins with the bytes 3c 73 76 67, expected a PNG");
  expectRefused(decoded("\n"), ErrorCode::kUnsupported, "begins with the bytes 0a, expected");
  expectRefused(decoded({}), ErrorCode::kUnsupported, "no bytes, expected");
}

TEST(Picture, TheNameDoesNotMatter) {
  const std::string png = pngOf(smoothPicture(3, 3));
  EXPECT_TRUE(decodePicture(exactBytes(png), "photo.jpg").ok());
}

TEST(Picture, NegativeLimitIsRefused) {
  expectRefused(decoded(pngOf(smoothPicture(3, 3)), -1), ErrorCode::kInvalidArgument, "-1 pixels, expected 0 or more");
}

TEST(Picture, FalseSizesAreRefusedBeforeAnythingIsAllocated) {
  const std::string file = pngOf(smoothPicture(8, 8));
  ASSERT_TRUE(decoded(withSize(file, 8, 8)).ok());
  const AllocationWatch watch;
  expectRefused(decoded(withSize(file, 0, 8)), ErrorCode::kBadFormat, "0 x 8 pixels, expected 1 to 16384");
  expectRefused(decoded(withSize(file, 8, 0)), ErrorCode::kBadFormat, "8 x 0 pixels");
  expectRefused(decoded(withSize(file, 65535, 65535)), ErrorCode::kUnsupported, "65535 x 65535 pixels");
  expectRefused(decoded(withSize(file, 0xffffffff, 0xffffffff)), ErrorCode::kUnsupported, "4294967295 x 4294967295");
  expectRefused(decoded(withSize(file, 16385, 1)), ErrorCode::kUnsupported, "expected 1 to 16384 on each side");
  expectRefused(decoded(withSize(file, 16384, 4097)), ErrorCode::kUnsupported, "at most 67108864 in all");
  expectRefused(decoded(withSize(file, 8192, 8192)), ErrorCode::kBadFormat, "expected at least 260111");
  EXPECT_LT(watch.largest(), 10'000U);
}

TEST(Picture, TheLargestPictureIsRead) {
  PngSample sample{8192, 8192, 0, 1, false, {}, {}};
  sample.samples.resize(std::size_t{8192} * 8192, 1);
  const std::string file = pngOf(sample);
  const AllocationWatch watch;
  const Picture picture = valueOf(decoded(file, 64));
  EXPECT_EQ(picture.rgba, std::vector<std::uint8_t>(64 * 64 * 4, 255));
  EXPECT_LE(watch.largest(), 8192U * 4);  // one row
}

/// The fuzzer's seeds and what it once broke.
TEST(Picture, CorpusIsReadOrRefused) {
  const std::filesystem::path folder = recordingsFolder().parent_path() / "tests" / "fuzz" / "corpus" / "picture";
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    const std::string content = valueOf(readFile(entry.path()));
    const Result<Picture> picture = decoded(content);
    EXPECT_EQ(picture.ok(), entry.path().filename() != "overflowing-size.png");
    if (picture) ++read;
  }
  EXPECT_EQ(read, 12);
}

std::vector<std::string> someFiles() {
  std::vector<std::string> files;
  for (int i = 0; i < 9; ++i) {
    files.push_back(pngOf(noisePicture(20 + i, 30, static_cast<std::uint32_t>(i))));
    files.push_back(jpegOf(smoothPicture(64, 16 + i), JpegKind::kProgressive, JpegChroma::kQuarter));
  }
  files[4].resize(50);
  return files;
}

TEST(Pictures, AnyNumberOfThreadsGivesTheSameInOrder) {
  const std::vector<std::string> files = someFiles();
  std::vector<EncodedPicture> encoded;
  for (std::size_t i = 0; i < files.size(); ++i) {
    encoded.push_back({std::as_bytes(std::span(files[i])), "picture " + std::to_string(i)});
  }
  for (const int threads : {0, 1, 2, 5}) {
    std::set<std::thread::id> workers;
    int last = 0;
    const auto progress = [&](int done, int count) {
      EXPECT_EQ(done, ++last);
      EXPECT_EQ(count, static_cast<int>(files.size()));
      workers.insert(std::this_thread::get_id());
      return true;
    };
    const auto pictures = decodePictures(encoded, {12, threads, progress});
    EXPECT_EQ(last, static_cast<int>(files.size()));
    if (threads > 0) {
      EXPECT_LE(workers.size(), static_cast<std::size_t>(threads));
    }
    ASSERT_EQ(pictures.size(), files.size());
    for (std::size_t i = 0; i < files.size(); ++i) {
      const Result<Picture> alone = decodePicture(encoded[i].bytes, encoded[i].name, 12);
      ASSERT_EQ(pictures[i].ok(), alone.ok());
      EXPECT_EQ(alone.ok(), i != 4);
      if (alone) {
        EXPECT_EQ(pictures[i]->rgba, alone->rgba);
      } else {
        EXPECT_EQ(pictures[i].error().message, alone.error().message);
      }
    }
  }
  EXPECT_TRUE(decodePictures({}, {}).empty());
}

TEST(Pictures, ThoseBeyondTheBudgetOfPixelsAreNotDecoded) {
  // Claims of 8192 x 8192 pixels, which are damaged: what is decoded says so.
  const PngSample one = {1, 1, 0, 8, false, {0}, pngChunk("tEXt", std::string(70'000, 'x'))};
  std::string large = pngOf(one);
  large.replace(16, 8, std::string("\0\0\x20\0\0\0\x20\0", 8));
  std::vector<EncodedPicture> encoded;
  const std::size_t fitting = kMaxStoredTexels / (std::uint64_t{8192} * 8192);
  for (std::size_t i = 0; i <= fitting; ++i) encoded.push_back({std::as_bytes(std::span(large)), "picture"});
  const std::string beyond = "picture: with it, the pictures have 603979776 pixels";
  const auto pictures = decodePictures(encoded, {64, 1});
  for (std::size_t i = 0; i <= fitting; ++i) {
    ASSERT_FALSE(pictures[i].ok());
    EXPECT_EQ(pictures[i].error().message.starts_with(beyond), i == fitting) << pictures[i].error().message;
  }
}

TEST(Pictures, ThoseThatAreTooLargeTogetherOrForTheirBytesAreReducedToFit) {
  // One of 8192 x 512 pixels, and others that only claim to have as many as are left.
  const std::string sound = pngOf(Picture{8192, 512, std::vector<std::uint8_t>(std::size_t{8192} * 512 * 4, 9)});
  const auto claiming = [](std::uint32_t height, std::size_t bytes) {
    return withSize(pngOf(PngSample{1, 1, 0, 8, false, {0}, pngChunk("tEXt", std::string(bytes, 'x'))}), 8192, height);
  };
  struct Row {
    std::uint64_t most;  ///< texels
    std::size_t bytes;   ///< of each other picture
  };
  for (const Row& row : {Row{1U << 25, 70'000}, Row{kMaxKeptTexels, kMaxKeptTexels / 32}}) {
    for (const std::uint32_t more : {0U, 1U}) {
      std::vector<std::string> files = {sound};
      auto rows = static_cast<std::uint32_t>(row.most / 8192 - 512) + more;
      for (; rows > 8192; rows -= 8192) files.push_back(claiming(8192, row.bytes));
      files.push_back(claiming(rows, row.bytes));
      std::vector<EncodedPicture> encoded;
      for (const std::string& file : files) encoded.push_back({std::as_bytes(std::span(file)), "picture"});
      const auto pictures = decodePictures(encoded, {});
      ASSERT_TRUE(pictures[0].ok()) << pictures[0].error().message;
      EXPECT_EQ(pictures[0]->width, more == 0 ? 8192 : 4096) << row.most;
    }
  }
}

TEST(Pictures, CancelLeavesTheRest) {
  const std::vector<std::string> files = someFiles();
  std::vector<EncodedPicture> encoded;
  for (const std::string& file : files) encoded.push_back({std::as_bytes(std::span(file)), "picture"});
  int calls = 0;
  const auto pictures = decodePictures(encoded, {0, 1, [&](int done, int) {
                                                   ++calls;
                                                   return done < 3;
                                                 }});
  EXPECT_EQ(calls, 3);
  const auto cancelled = std::ranges::count_if(
      pictures, [](const Result<Picture>& p) { return !p && p.error().code == ErrorCode::kCancelled; });
  EXPECT_EQ(cancelled, static_cast<std::ptrdiff_t>(files.size()) - 3);
}

TEST(Pictures, EveryThreadAsksTheInterruptOfWhoReads) {
  const std::vector<std::string> files = someFiles();
  std::vector<EncodedPicture> encoded;
  for (const std::string& file : files) encoded.push_back({std::as_bytes(std::span(file)), "picture"});
  const Interrupt stops = [] { return true; };
  const InterruptScope scope(&stops);
  for (const Result<Picture>& picture : decodePictures(encoded, {})) {
    ASSERT_FALSE(picture);
    EXPECT_EQ(picture.error().code, ErrorCode::kCancelled);
  }
}

/// The picture files inside a GLB.
std::vector<std::string_view> picturesIn(std::string_view glb) {
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    std::memcpy(&n, &glb[at], 4);
    return n;
  };
  const auto document = nlohmann::json::parse(glb.substr(20, number(12)));
  const std::string_view binary = glb.substr(20 + number(12) + 8);
  std::vector<std::string_view> files;
  for (const auto& image : document.value("images", nlohmann::json::array())) {
    const auto& view = document["bufferViews"][image["bufferView"].get<std::size_t>()];
    files.push_back(binary.substr(view.value("byteOffset", std::size_t{0}), view["byteLength"].get<std::size_t>()));
  }
  return files;
}

TEST(SharedCharacters, EveryPictureIsDecoded) {
  int count = 0;
  for (const char* name :
       {"godette/Godette_vrm_v4.vrm", "cesiumman/CesiumMan.glb", "fox/Fox.glb", "greenman/greenman.glb",
        "kaykit/Barbarian.glb", "kaykit/Mage.glb", "raylib_robot/robot.glb"}) {
    LORICA_REQUIRE_DATASET(path, std::string("characters/") + name);
    const std::string glb = valueOf(readFile(path));
    for (const std::string_view file : picturesIn(glb)) {
      const Result<Picture> picture = decoded(file);
      ASSERT_TRUE(picture.ok()) << name << ": " << picture.error().message;
      EXPECT_GE(std::min(picture->width, picture->height), 8) << name;
      const Result<Picture> small = decoded(file, 100);
      ASSERT_TRUE(small.ok()) << name << ": " << small.error().message;
      EXPECT_LE(std::max(small->width, small->height), 100) << name;
      for (std::size_t cut = 1; cut <= 16; ++cut) EXPECT_FALSE(decoded(file.substr(0, file.size() * cut / 17)).ok());
      ++count;
    }
  }
  EXPECT_GE(count, 10);
}

/// Length that two intervals share.
double shared(double from, double to, double otherFrom, double otherTo) {
  return std::max(0.0, std::min(to, otherTo) - std::max(from, otherFrom));
}

/// One pixel of a reduced picture, from the definition: a sum over all stored pixels.
std::array<double, 4> meanOver(const Picture& picture, PictureSize to, int column, int row) {
  std::array<double, 3> weighted{}, plain{};
  double alpha = 0.0, area = 0.0;
  const double across = static_cast<double>(picture.width) / to.width;
  const double down = static_cast<double>(picture.height) / to.height;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double part =
          shared(column * across, (column + 1) * across, x, x + 1) * shared(row * down, (row + 1) * down, y, y + 1);
      const std::uint8_t* pixel = &picture.rgba[(static_cast<std::size_t>(y) * picture.width + x) * 4];
      for (std::size_t c = 0; c < 3; ++c) {
        weighted[c] += part * pixel[3] * pixel[c];
        plain[c] += part * pixel[c];
      }
      alpha += part * pixel[3];
      area += part;
    }
  }
  std::array<double, 4> mean{0.0, 0.0, 0.0, alpha / area};
  for (std::size_t c = 0; c < 3; ++c) mean[c] = alpha > 0.0 ? weighted[c] / alpha : plain[c] / area;
  return mean;
}

TEST(PictureShrink, SizesKeepProportions) {
  const auto expectSize = [](PictureSize from, int side, int width, int height) {
    const PictureSize to = limitedSize(from, side);
    EXPECT_EQ(to.width, width);
    EXPECT_EQ(to.height, height);
  };
  expectSize({4096, 2048}, 1024, 1024, 512);
  expectSize({100, 300}, 150, 50, 150);
  expectSize({100, 300}, 0, 100, 300);
  expectSize({100, 300}, 300, 100, 300);
  expectSize({100, 300}, 1, 1, 1);
  expectSize({16384, 1}, 16383, 16383, 1);
  expectSize({16384, 3}, 100, 100, 1);
  expectSize({7, 5}, 3, 3, 2);
}

TEST(PictureShrink, EqualsTheMeanOverEachArea) {
  std::mt19937 random(18);
  for (int i = 0; i < 60; ++i) {
    const auto size = [&] { return static_cast<int>(1 + random() % 40); };
    const PictureSize from{size(), size()};
    const PictureSize to{static_cast<int>(1 + random() % static_cast<unsigned int>(from.width)),
                         static_cast<int>(1 + random() % static_cast<unsigned int>(from.height))};
    SCOPED_TRACE(testing::Message() << from.width << " x " << from.height << " to " << to.width << " x " << to.height);
    Picture picture = noisePicture(from.width, from.height, random());
    for (std::size_t p = 3; p < picture.rgba.size(); p += 4) {
      if (random() % 3 == 0) picture.rgba[p] = 0;
    }
    PictureShrink shrink(from, to);
    const auto rowBytes = static_cast<std::size_t>(from.width) * 4;
    for (std::size_t y = 0; y < static_cast<std::size_t>(from.height); ++y) {
      shrink.add(std::span(picture.rgba).subspan(y * rowBytes, rowBytes));
    }
    const Picture small = shrink.take();
    ASSERT_EQ(small.width, to.width);
    ASSERT_EQ(small.height, to.height);
    for (int row = 0; row < to.height; ++row) {
      for (int column = 0; column < to.width; ++column) {
        const auto mean = meanOver(picture, to, column, row);
        for (std::size_t c = 0; c < 4; ++c) {
          EXPECT_NEAR(small.rgba[(static_cast<std::size_t>(row) * to.width + column) * 4 + c], mean[c], 0.5 + 1e-9);
        }
      }
    }
  }
}

TEST(PictureShrink, TransparentPixelsGiveNoColour) {
  const Picture picture{2, 2, {255, 0, 0, 0, 0, 0, 200, 255, 255, 0, 0, 0, 0, 0, 200, 255}};
  EXPECT_EQ(shrunk(picture, 1).rgba, (std::vector<std::uint8_t>{0, 0, 200, 128}));
  // Without any alpha the colours remain: a material may ignore alpha.
  const Picture clear{2, 1, {100, 50, 0, 0, 200, 50, 0, 0}};
  EXPECT_EQ(shrunk(clear, 1).rgba, (std::vector<std::uint8_t>{150, 50, 0, 0}));
}

TEST(PictureShrink, TheLargestSumsFit) {
  const Picture white{kMaxPictureSide, 4096, std::vector<std::uint8_t>(std::size_t{kMaxPictureSide} * 4096 * 4, 255)};
  for (const std::uint8_t value : shrunk(white, 3).rgba) EXPECT_EQ(value, 255);
}

TEST(PictureShrink, OneColourStaysTheSame) {
  Picture picture{33, 47, {}};
  for (int i = 0; i < 33 * 47; ++i) picture.rgba.insert(picture.rgba.end(), {1, 77, 254, 3});
  for (int side = 1; side <= 47; ++side) {
    const Picture small = shrunk(picture, side);
    EXPECT_EQ(small.height, side);
    for (std::size_t i = 0; i < small.rgba.size(); ++i) EXPECT_EQ(small.rgba[i], picture.rgba[i % 4]);
  }
}

}  // namespace
}  // namespace lorica::test
