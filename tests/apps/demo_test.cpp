#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <fstream>

namespace lorica::test {
namespace {

TEST(Demo, WindowWithoutDisplaySaysWhatToDo) {
  const TemporaryFolder folder;
  const CommandResult result = runLorica({"demo", "--window", "--out", folder.path() / "demo"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("DISPLAY"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("--headless"), std::string::npos) << result.err;
  EXPECT_TRUE(filesIn(folder.path()).empty());
}

TEST(Demo, DrawsToFilesAndStartsFromTheCacheTheSecondTime) {
  const TemporaryFolder folder;
  const std::filesystem::path cache = folder.path() / "cache";
  const std::filesystem::path pictures = folder.path() / "pictures";
  const std::vector<std::string> arguments = {"demo",  "--force", "--headless", "--seconds", "1",
                                              "--out", pictures,  "--json",     "-"};
  const CommandSurroundings surroundings = {.folder = folder.path(), .cache = cache};

  const CommandResult first = runLorica(arguments, surroundings);
  ASSERT_EQ(first.exitCode, 0) << first.err;
  const nlohmann::json json = first.json();
  EXPECT_EQ(json["fromCache"], false);
  EXPECT_EQ(json["parts"], 16);
  EXPECT_EQ(json["keyframes"], 12);
  EXPECT_EQ(json["frames"], 30);
  EXPECT_GT(json["stages"]["total"]["median"].get<double>(), 0.0);

  if (!json["renderer"].is_null()) {
    EXPECT_EQ(filesIn(pictures),
              (std::vector<std::string>{"contact_sheet.png", "demo.mp4", "hulls_1.png", "hulls_2.png", "hulls_3.png",
                                        "snapshot_1.png", "snapshot_2.png", "snapshot_3.png"}));
    const Result<Image> snapshot = readPng(pictures / "snapshot_1.png");
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->width, 1280);
    EXPECT_EQ(snapshot->height, 720);
    EXPECT_TRUE(readPng(pictures / "contact_sheet.png"));
    EXPECT_GT(std::filesystem::file_size(pictures / "demo.mp4"), 10000u);
  }

  // The cache holds one file, which the second run uses; the third run replaces it because it is damaged.
  const std::vector<std::string> cached = filesIn(cache / "lorica");
  ASSERT_EQ(cached.size(), 1u);
  const nlohmann::json second = runLorica(arguments, surroundings).json();
  EXPECT_EQ(second["fromCache"], true);
  EXPECT_EQ(second["hash"], json["hash"]);

  std::ofstream(cache / "lorica" / cached.front(), std::ios::binary) << "not a decomposition";
  const CommandResult third = runLorica(arguments, surroundings);
  EXPECT_EQ(third.exitCode, 0);
  EXPECT_NE(third.err.find("computed again"), std::string::npos) << third.err;
  EXPECT_EQ(third.json()["fromCache"], false);
  EXPECT_EQ(third.json()["hash"], json["hash"]);
}

TEST(Demo, AScenePlaysInItsPlaceWithItsOwnAvatarsOrWithOneThatKicks) {
  const TemporaryFolder folder;
  for (const auto& [scene, motion] : {std::pair{"dominoes", "walk"}, {"boxes", "punch_and_kick"}}) {
    const CommandResult demo = runLorica(
        {"demo", "--headless", "--seconds", "0.1", "--scene", scene, "--out", folder.path() / scene, "--json", "-"});
    ASSERT_EQ(demo.exitCode, 0) << demo.err;
    EXPECT_EQ(demo.json()["recording"], motion);
    EXPECT_TRUE(demo.json()["fromCache"].is_null());
  }
  const CommandResult missing = runLorica({"demo", "--headless", "--scene", "pond", "--out", folder.path() / "no"});
  EXPECT_EQ(missing.exitCode, 2);
  EXPECT_NE(missing.err.find("pond"), std::string::npos) << missing.err;
}

TEST(Demo, WithoutTheVideoModuleThereArePictures) {
  const TemporaryFolder folder;
  folder.write("liblorica_video.so", "");  // found first, but not a library
  const CommandSurroundings surroundings = {.folder = folder.path(), .libraries = folder.path()};
  const CommandResult demo =
      runLorica({"demo", "--headless", "--seconds", "0.2", "--out", "pictures", "--json", "-"}, surroundings);
  ASSERT_EQ(demo.exitCode, 0) << demo.err;
  if (demo.json()["renderer"].is_null()) return;
  EXPECT_TRUE(demo.json()["video"].is_null());
  EXPECT_NE(demo.err.find("writing MP4 needs liblorica_video.so"), std::string::npos) << demo.err;
  EXPECT_EQ(filesIn(folder.path() / "pictures"),
            (std::vector<std::string>{"contact_sheet.png", "hulls_1.png", "hulls_2.png", "hulls_3.png",
                                      "snapshot_1.png", "snapshot_2.png", "snapshot_3.png"}));

  const CommandResult film = runLorica({"snapshot", "walk", "--video", "walk.mp4"}, surroundings);
  EXPECT_EQ(film.exitCode, 2);
  EXPECT_NE(film.err.find("walk.mp4: writing MP4 needs liblorica_video.so"), std::string::npos) << film.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "walk.mp4"));
}

TEST(Demo, CacheThatCannotBeWrittenIsAWarning) {
  const TemporaryFolder folder;
  // XDG_CACHE_HOME is a file here.
  const CommandResult result = runLorica({"demo", "--headless", "--seconds", "0.1", "--out", "pictures"},
                                         {.folder = folder.path(), .cache = "/dev/null"});
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.err.find("warning: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("is not cached"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("16 convex parts"), std::string::npos) << result.out;
}

TEST(Demo, OutputFolderThatCannotBeMadeIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("occupied", "a file");
  const CommandResult result = runLorica({"demo", "--headless", "--seconds", "0.1", "--out", file},
                                         {.folder = folder.path(), .cache = folder.path() / "cache"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("occupied"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lorica::test
