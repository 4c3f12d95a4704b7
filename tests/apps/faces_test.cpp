#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
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
  EXPECT_FALSE(noted(json["body"]["notes"], kGrown)) << "the hulls follow the clip";
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

/// The mannequin in a coat of one material; if asked for, with a club in its right hand: a closed box whose mesh is
/// called Cube.001 and its node Club.
std::string heroGlb(bool armed) {
  GlbWriter writer = mannequinWriter(false);
  writer.document["meshes"][0]["primitives"][0]["material"] = writer.add("materials", {{"name", "wool"}});
  if (!armed) return writer.glb();
  const JointIndex hand = makeMannequin().skeleton.jointOf(HumanBone::kRightHand);
  const TriMesh box = makeBox(Vec3(-0.6, 0.1, -0.05), Vec3(-0.1, 0.2, 0.05));
  const int positions = writer.positions(box.vertices);
  const int indices = writer.triangles(box.triangles);
  const int mesh = writer.add(
      "meshes", {{"name", "Cube.001"},
                 {"primitives", {{{"indices", indices}, {"material", 0}, {"attributes", {{"POSITION", positions}}}}}}});
  const int node = writer.add("nodes", {{"name", "Club"}, {"mesh", mesh}});
  writer.document["nodes"][static_cast<std::size_t>(hand)]["children"].push_back(node);
  return writer.glb();
}

/// The same file name in two folders, so that reports are the same too. The cache is shared, so that what is hidden
/// must be in its keys.
struct Armoury {
  TemporaryFolder folder;
  fs::path armed = write("armed", heroGlb(true));
  fs::path bare = write("bare", heroGlb(false));
  CommandSurroundings surroundings{folder.path()};

  [[nodiscard]] fs::path write(const std::string& name, const std::string& glb) const {
    fs::create_directory(folder.path() / name);
    return folder.write(name + "/hero.glb", glb);
  }
  [[nodiscard]] CommandResult run(const std::vector<std::string>& arguments) const {
    return runLorica(arguments, surroundings);
  }
  [[nodiscard]] nlohmann::json json(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--json", "-"});
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? result.json() : nlohmann::json();
  }
};
const Armoury& armoury() {
  static const Armoury made;
  return made;
}

TEST(Hide, HullsAreThoseOfAFileWithoutTheMesh) {
  const auto hash = [](const fs::path& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"play", "wave", "--character", file, "--frames", "20"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return armoury().json(arguments)["hash"].get<std::string>();
  };
  const std::string bare = hash(armoury().bare, {});
  const std::string armed = hash(armoury().armed, {});
  EXPECT_NE(armed, bare);
  EXPECT_EQ(hash(armoury().armed, {"--hide", "Club"}), bare);
  EXPECT_EQ(hash(armoury().armed, {"--hide", "cube.001"}), bare);
  EXPECT_EQ(hash(armoury().armed, {}), armed) << "from the cache";

  const std::string own = armoury().json({"play", armoury().bare, "--clip", "Nod"})["hash"];
  EXPECT_EQ(armoury().json({"play", armoury().armed, "--clip", "Nod", "--hide", "Club"})["hash"], own);
}

TEST(Hide, PicturesAreThoseOfAFileWithoutTheMesh) {
  const auto picture = [](const fs::path& file, const std::vector<std::string>& more) {
    const fs::path out = armoury().folder.path() / "one.png";
    std::vector<std::string> arguments = {"snapshot", "wave",    "--character", file, "--frame", "10",
                                          "--size",   "320x180", "-o",          out,  "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = armoury().run(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? readFile(out).value() : "";
  };
  const std::string bare = picture(armoury().bare, {});
  EXPECT_NE(picture(armoury().armed, {}), bare);
  EXPECT_EQ(picture(armoury().armed, {"--hide", "Club"}), bare);
}

TEST(Hide, DecomposeScoreAndLiveTakeItToo) {
  const fs::path hulls = armoury().folder.path() / "hulls.obj";
  const auto decomposed = [&](const fs::path& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"decompose", file,           "--parts", "4",      "--keyframes",
                                          "2",         "--export-obj", hulls,     "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return armoury().json(arguments)["hash"].get<std::string>();
  };
  EXPECT_EQ(decomposed(armoury().armed, {"--hide", "Club"}), decomposed(armoury().bare, {}));
  EXPECT_EQ(armoury().json({"score", armoury().armed, hulls, "--hide", "Club"})["score17"],
            armoury().json({"score", armoury().bare, hulls})["score17"]);
  EXPECT_EQ(armoury().json({"live", "--virtual", "--character", armoury().armed, "--hide", "Club", "--frames", "3",
                            "--headless"})["parts"],
            16);
}

TEST(Hide, ASessionIsReplayedWithoutTheMesh) {
  const fs::path session = armoury().folder.path() / "s.lsession";
  const nlohmann::json made =
      armoury().json({"record", session, "wave", "--character", armoury().armed, "--hide", "Club", "--frames", "20"});
  const nlohmann::json again = armoury().json({"replay", session});
  EXPECT_EQ(again["same"], true);
  EXPECT_EQ(again["replayed"], 20);
  EXPECT_EQ(again["hash"], made["hash"]);
}

TEST(Hide, InfoListsTheNames) {
  const CommandResult all = armoury().run({"info", armoury().armed});
  EXPECT_NE(all.out.find("  skin, Club (Cube.001)\n"), std::string::npos) << all.out;
  const nlohmann::json left = armoury().json({"info", armoury().armed, "--hide", "Club"});
  ASSERT_EQ(left["meshNames"].size(), 1u);
  EXPECT_EQ(left["meshNames"][0]["node"], "skin");
  EXPECT_EQ(left["triangles"], armoury().json({"info", armoury().bare})["triangles"]);
}

TEST(Hide, WrongNamesAreASentence) {
  const auto expectRefused = [](const std::vector<std::string>& arguments, const std::string& fragment) {
    const CommandResult result = armoury().run(arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(fragment), std::string::npos) << result.err;
  };
  const std::string armed = armoury().armed;
  expectRefused({"play", "wave", "--character", armed, "--hide", "Sword"},
                "hero.glb: no mesh named `Sword` to hide, expected one of skin, Club (Cube.001)");
  expectRefused({"decompose", armed, "--hide", "Club", "--hide", "skin"}, "every mesh is hidden");
  expectRefused({"play", armed, "--hide", "skin", "--hide", "Club"}, "every mesh is hidden");
  expectRefused({"record", "x.oni", "--virtual", "--hide", "Club"}, "--hide is for sessions");
  expectRefused({"play", "wave", "--hide", "Club"}, "mannequin: --hide is for character files");
}

}  // namespace
}  // namespace lorica::test
