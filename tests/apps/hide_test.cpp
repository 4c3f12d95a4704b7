#include "tests/apps/mannequin_glb.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

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
struct Studio {
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
const Studio& studio() {
  static const Studio made;
  return made;
}

TEST(Hide, HullsAreThoseOfAFileWithoutTheMesh) {
  const auto hash = [](const fs::path& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"play", "wave", "--character", file, "--frames", "20"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return studio().json(arguments)["hash"].get<std::string>();
  };
  const std::string bare = hash(studio().bare, {});
  const std::string armed = hash(studio().armed, {});
  EXPECT_NE(armed, bare);
  EXPECT_EQ(hash(studio().armed, {"--hide", "Club"}), bare);
  EXPECT_EQ(hash(studio().armed, {"--hide", "cube.001"}), bare);
  EXPECT_EQ(hash(studio().armed, {}), armed) << "from the cache";

  const std::string own = studio().json({"play", studio().bare, "--clip", "Nod"})["hash"];
  EXPECT_EQ(studio().json({"play", studio().armed, "--clip", "Nod", "--hide", "Club"})["hash"], own);
}

TEST(Hide, PicturesAreThoseOfAFileWithoutTheMesh) {
  const auto picture = [](const fs::path& file, const std::vector<std::string>& more) {
    const fs::path out = studio().folder.path() / "one.png";
    std::vector<std::string> arguments = {"snapshot", "wave",    "--character", file, "--frame", "10",
                                          "--size",   "320x180", "-o",          out,  "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = studio().run(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? readFile(out).value() : "";
  };
  const std::string bare = picture(studio().bare, {});
  EXPECT_NE(picture(studio().armed, {}), bare);
  EXPECT_EQ(picture(studio().armed, {"--hide", "Club"}), bare);
}

TEST(Hide, DecomposeScoreAndLiveTakeItToo) {
  const fs::path hulls = studio().folder.path() / "hulls.obj";
  const auto decomposed = [&](const fs::path& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"decompose", file,           "--parts", "4",      "--keyframes",
                                          "2",         "--export-obj", hulls,     "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return studio().json(arguments)["hash"].get<std::string>();
  };
  EXPECT_EQ(decomposed(studio().armed, {"--hide", "Club"}), decomposed(studio().bare, {}));
  EXPECT_EQ(studio().json({"score", studio().armed, hulls, "--hide", "Club"})["score17"],
            studio().json({"score", studio().bare, hulls})["score17"]);
  EXPECT_EQ(studio().json({"live", "--virtual", "--character", studio().armed, "--hide", "Club", "--frames", "3",
                           "--headless"})["parts"],
            16);
}

TEST(Hide, ASessionIsReplayedWithoutTheMesh) {
  const fs::path session = studio().folder.path() / "s.lsession";
  const nlohmann::json made =
      studio().json({"record", session, "wave", "--character", studio().armed, "--hide", "Club", "--frames", "20"});
  const nlohmann::json again = studio().json({"replay", session});
  EXPECT_EQ(again["same"], true);
  EXPECT_EQ(again["replayed"], 20);
  EXPECT_EQ(again["hash"], made["hash"]);
}

TEST(Hide, InfoListsTheNames) {
  const CommandResult all = studio().run({"info", studio().armed});
  EXPECT_NE(all.out.find("  skin, Club (Cube.001)\n"), std::string::npos) << all.out;
  const nlohmann::json left = studio().json({"info", studio().armed, "--hide", "Club"});
  ASSERT_EQ(left["meshNames"].size(), 1u);
  EXPECT_EQ(left["meshNames"][0]["node"], "skin");
  EXPECT_EQ(left["triangles"], studio().json({"info", studio().bare})["triangles"]);
}

TEST(Hide, WrongNamesAreASentence) {
  const auto expectRefused = [](const std::vector<std::string>& arguments, const std::string& fragment) {
    const CommandResult result = studio().run(arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(fragment), std::string::npos) << result.err;
  };
  const std::string armed = studio().armed;
  expectRefused({"play", "wave", "--character", armed, "--hide", "Sword"},
                "hero.glb: no mesh named `Sword` to hide, expected one of skin, Club (Cube.001)");
  expectRefused({"decompose", armed, "--hide", "Club", "--hide", "skin"}, "every mesh is hidden");
  expectRefused({"play", armed, "--hide", "skin", "--hide", "Club"}, "every mesh is hidden");
  expectRefused({"record", "x.oni", "--virtual", "--hide", "Club"}, "--hide is for sessions");
  expectRefused({"play", "wave", "--hide", "Club"}, "mannequin: --hide is for character files");
}

}  // namespace
}  // namespace lorica::test
