// Pictures of avatars beside those of three.js with three-vrm. Figures and pictures are kept in the build folder.
#include "tests/peers/bare_picture.h"
#include "tests/peers/peer.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <fstream>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Likeness;
using test::MaskedPicture;

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

}  // namespace
}  // namespace lorica
