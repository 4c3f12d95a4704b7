#include "tests/peers/bare_picture.h"
#include "tests/peers/likeness.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <vector>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Likeness;
using test::MaskedPicture;
using Color = std::array<int, 3>;

// Pictures of avatars beside those of three.js with three-vrm. Figures and pictures are kept in the build folder.

class PeerLook : public testing::TestWithParam<const char*> {};

TEST_P(PeerLook, IsThatOfThreeVrm) {
  const json shots = test::readShots(GetParam());
  LORICA_REQUIRE_DATASET(path, shots.at("character").get<std::string>());
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_STUDIO(studio, "");
  Result<CharacterFile> file = readCharacterFile(path);
  ASSERT_TRUE(file.ok()) << file.error().message;
  Result<MadeAvatar> avatar = makeAvatar(file.value().character, file.value().look);
  ASSERT_TRUE(avatar.ok()) << avatar.error().message;
  EXPECT_TRUE(avatar.value().notes.empty()) << avatar.value().notes.front();
  const test::Sitter sitter = {std::move(file).value(), avatar.value().avatar};
  const fs::path folder = test::built("peers/pictures") / GetParam();
  fs::create_directories(folder);
  json figures;
  for (const auto& [name, shot] : test::shootWithPeer(path, shots)) {
    const MaskedPicture ours = test::drawBare(*studio, sitter, shot.facts["options"]);
    const Likeness like = test::likenessOf(ours, {shot.picture, shot.mask});
    EXPECT_GE(like.silhouettes, 0.99) << name;
    EXPECT_LE(like.wrong, 0.03) << name;
    figures[name] = {{"silhouettesPercent", 100.0 * like.silhouettes},
                     {"whollyWrongPercent", 100.0 * like.wrong},
                     {"meanDifference", like.meanDifference}};
    std::printf("%s %s: silhouettes %.2f %% alike, %.2f %% wholly wrong, mean difference %.1f of 255\n", GetParam(),
                name.c_str(), 100.0 * like.silhouettes, 100.0 * like.wrong, like.meanDifference);
    const std::vector<Image> sheet = {ours.picture, shot.picture, like.shown};
    const std::vector<std::string> labels = {"Lorica", "three-vrm", "difference"};
    EXPECT_TRUE(writePng(folder / (name + ".png"), contactSheet(sheet, labels, 3)));
  }
  std::ofstream(folder / "figures.json") << figures.dump(1) << "\n";
}

INSTANTIATE_TEST_SUITE_P(, PeerLook,
                         testing::Values("godette", "cesiumman", "fox", "greenman", "barbarian", "mage", "robot"),
                         [](const auto& each) { return std::string(each.param); });

/// A square of one colour, 40 pixels wide with its left side at x, in a white picture of 100 x 60.
MaskedPicture square(int x, Color color) {
  MaskedPicture made;
  made.picture = {100, 60, std::vector<std::uint8_t>(100 * 60 * 4, 255)};
  made.mask = {100, 60, std::vector<std::uint8_t>(100 * 60 * 4, 0)};
  for (int v = 10; v < 50; ++v) {
    for (int u = x; u < x + 40; ++u) {
      const std::size_t at = static_cast<std::size_t>(v * 100 + u) * 4;
      for (std::size_t c = 0; c < 3; ++c) {
        made.picture.rgba[at + c] = static_cast<std::uint8_t>(color[c]);
        made.mask.rgba[at + c] = 255;
      }
    }
  }
  return made;
}

TEST(Likeness, APictureIsLikeItself) {
  const Likeness same = likenessOf(square(20, {90, 0, 200}), square(20, {90, 0, 200}));
  EXPECT_EQ(same.silhouettes, 1.0);
  EXPECT_EQ(same.wrong, 0.0);
  EXPECT_EQ(same.meanDifference, 0.0);
}

TEST(Likeness, SilhouettesAreIntersectionOverUnion) {
  const Likeness moved = likenessOf(square(20, {90, 0, 200}), square(30, {90, 0, 200}));
  EXPECT_DOUBLE_EQ(moved.silhouettes, 30.0 / 50.0);
  EXPECT_EQ(moved.wrong, 0.0);
  EXPECT_EQ(likenessOf(square(0, {0, 0, 0}), square(50, {0, 0, 0})).silhouettes, 0.0);
}

TEST(Likeness, OneChannelMakesAPixelWhollyWrong) {
  EXPECT_EQ(likenessOf(square(20, {90, 0, 200}), square(20, {138, 48, 248})).wrong, 0.0);
  const Likeness wrong = likenessOf(square(20, {90, 0, 200}), square(20, {90, 49, 200}));
  EXPECT_EQ(wrong.wrong, 1.0);
  EXPECT_NEAR(wrong.meanDifference, 49.0 / 3.0, 1e-9);
}

TEST(Likeness, ALineMayMoveByAPixelButNotByTwo) {
  const auto withLine = [](int x) {
    MaskedPicture made = square(20, {200, 200, 200});
    for (int v = 10; v < 50; ++v) {
      for (std::size_t c = 0; c < 3; ++c) made.picture.rgba[static_cast<std::size_t>(v * 100 + x) * 4 + c] = 0;
    }
    return made;
  };
  EXPECT_EQ(likenessOf(withLine(40), withLine(41)).wrong, 0.0);
  EXPECT_DOUBLE_EQ(likenessOf(withLine(40), withLine(42)).wrong, 2.0 / 40.0);
  EXPECT_DOUBLE_EQ(likenessOf(withLine(40), square(20, {200, 200, 200})).wrong, 1.0 / 40.0);
}

TEST(Likeness, PicturesOfDifferentSizesAreNotAlike) {
  MaskedPicture small = square(20, {0, 0, 0});
  small.picture.width = small.mask.width = 50;
  EXPECT_EQ(likenessOf(small, square(20, {0, 0, 0})).wrong, 1.0);
  EXPECT_EQ(likenessOf({}, {}).silhouettes, 0.0);
}

}  // namespace
}  // namespace lorica::test
