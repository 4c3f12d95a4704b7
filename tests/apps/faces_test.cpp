#include "skinning/mannequin/mannequin.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// The cache is shared, so that each body is decomposed once.
struct Studio {
  TemporaryFolder folder;
  fs::path still = folder.write("still.glb", facesGlb(false));
  fs::path breathing = folder.write("breathing.glb", facesGlb(true));
  CommandSurroundings surroundings{folder.path()};

  [[nodiscard]] CommandResult run(std::vector<std::string> arguments) const {
    return runLorica(arguments, surroundings);
  }
};
const Studio& studio() {
  static const Studio made;
  return made;
}

bool noted(const nlohmann::json& notes, const std::string& part) {
  return std::any_of(notes.begin(), notes.end(), [&](const nlohmann::json& note) {
    return note.get<std::string>().find(part) != std::string::npos;
  });
}

constexpr const char* kGrown = "the hulls hold morph targets at their largest weights";

TEST(Faces, InfoListsTargetsAndExpressions) {
  const CommandResult said = studio().run({"info", studio().breathing});
  ASSERT_EQ(said.exitCode, 0) << said.err;
  EXPECT_NE(said.out.find("2, 2 of them move something; 1 clip move"), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("Belly, Frown"), std::string::npos);
  const nlohmann::json json = studio().run({"info", studio().breathing, "--json", "-"}).json();
  EXPECT_EQ(json["morphTargets"], 2);
  EXPECT_EQ(json["expressions"][0]["name"], "Belly");
  EXPECT_EQ(json["expressions"][0]["targets"]["Belly"], 1.0);
  EXPECT_EQ(json["lookAt"], "none");
  EXPECT_EQ(json["clips"].size(), 3u);
  EXPECT_TRUE(noted(json["body"]["notes"], kGrown));  // for the clip
}

TEST(Faces, HullsGrowOnlyForWhatLeavesThem) {
  const auto notes = [](const std::vector<std::string>& expressions) {
    std::vector<std::string> arguments = {"info", studio().still, "--json", "-"};
    arguments.insert(arguments.end(), expressions.begin(), expressions.end());
    const CommandResult said = studio().run(arguments);
    EXPECT_EQ(said.exitCode, 0) << said.err;
    return said.json()["body"]["notes"];
  };
  EXPECT_FALSE(noted(notes({}), kGrown));
  EXPECT_FALSE(noted(notes({"--expression", "Frown=1"}), kGrown));
  EXPECT_TRUE(noted(notes({"--expression", "belly=0.5"}), kGrown));
}

TEST(Faces, UnknownExpressionsAndWeightsAreRefusedInASentence) {
  const auto refused = [](const std::string& character, const std::string& expression) {
    const CommandResult said = studio().run({"play", "wave", "--character", character, "--expression", expression});
    EXPECT_EQ(said.exitCode, 2);
    return said.err;
  };
  EXPECT_NE(refused(studio().still, "Joy=1").find("no expression Joy, expected one of Belly, Frown"),
            std::string::npos);
  for (const char* wrong : {"Belly", "Belly=", "Belly=two", "Belly=1.5", "Belly=-1", "Belly=nan", "=1"}) {
    EXPECT_NE(refused(studio().still, wrong).find("expected"), std::string::npos) << wrong;
  }
  EXPECT_NE(refused("mannequin", "Belly=1").find("--expression is for character files"), std::string::npos);
}

TEST(Faces, ARecordedExpressionReplaysWithTheSameHulls) {
  const fs::path recorded = studio().folder.path() / "belly.lsession";
  const CommandResult played = studio().run({"play", "wave", "--character", studio().still, "--expression", "Belly=1",
                                             "--frames", "5", "--record", recorded, "--json", "-"});
  ASSERT_EQ(played.exitCode, 0) << played.err;
  const CommandResult again = studio().run({"replay", recorded, "--json", "-"});
  ASSERT_EQ(again.exitCode, 0) << again.err;
  EXPECT_EQ(again.json()["hash"], played.json()["hash"]);
  const CommandResult plain =
      studio().run({"play", "wave", "--character", studio().still, "--frames", "5", "--json", "-"});
  ASSERT_EQ(plain.exitCode, 0) << plain.err;
  EXPECT_NE(plain.json()["hash"], played.json()["hash"]);
}

TEST(Faces, AReplayPlaysTheClipsFace) {
  const fs::path& folder = studio().folder.path();
  const fs::path recorded = folder / "breathe.lsession";
  const CommandResult played =
      studio().run({"play", studio().breathing, "--clip", "Breathe", "--frames", "31", "--record", recorded,
                    "--snapshots", folder / "played", "--every", "30", "--camera", "side"});
  if (played.exitCode == 2 && played.err.find("OSMesa") != std::string::npos) GTEST_SKIP() << "no renderer";
  ASSERT_EQ(played.exitCode, 0) << played.err;
  const CommandResult again =
      studio().run({"replay", recorded, "--snapshots", folder / "again", "--every", "30", "--camera", "side"});
  ASSERT_EQ(again.exitCode, 0) << again.err;
  const auto picture = [&](const char* run, const char* file) { return readPng(folder / run / file).value().rgba; };
  EXPECT_EQ(picture("again", "frame_0030.png"), picture("played", "frame_0030.png"));
  EXPECT_NE(picture("played", "frame_0030.png"), picture("played", "frame_0000.png"));
}

/// Pictures from the side: the belly shows.
TEST(Faces, PicturesShowExpressionsAndClips) {
  const auto picture = [](std::vector<std::string> arguments) -> std::optional<Image> {
    const fs::path file = studio().folder.path() / "picture.png";
    arguments.insert(arguments.begin(), "snapshot");
    arguments.insert(arguments.end(), {"--show", "skin", "--size", "64x64", "--eye", "2.5,1,0", "--target", "0,1,0",
                                       "--force", "-o", file.string()});
    const CommandResult said = studio().run(arguments);
    if (said.exitCode == 2 && said.err.find("OSMesa") != std::string::npos) return std::nullopt;
    EXPECT_EQ(said.exitCode, 0) << said.err;
    Result<Image> image = readPng(file);
    EXPECT_TRUE(image.ok());
    return image ? std::optional(std::move(*image)) : std::nullopt;
  };
  const auto differ = [](const Image& a, const Image& b) {
    int pixels = 0;
    for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
      pixels += std::abs(int(a.rgba[i]) - int(b.rgba[i])) > 16 ? 1 : 0;
    }
    return pixels;
  };
  const std::string motion = studio().breathing.string();
  const std::vector<std::string> breathe = {motion, "--clip", "Breathe", "--at", "0"};
  const std::optional<Image> flat = picture(breathe);
  if (!flat) GTEST_SKIP() << "no renderer";
  const std::optional<Image> full = picture({motion, "--clip", "Breathe", "--at", "0.5"});
  const std::optional<Image> chosen = picture({motion, "--clip", "Breathe", "--at", "0", "--expression", "Belly=1"});
  ASSERT_TRUE(full && chosen);
  EXPECT_GT(differ(*flat, *full), 10);
  EXPECT_LE(differ(*full, *chosen), 2);
}

}  // namespace
}  // namespace lorica::test
