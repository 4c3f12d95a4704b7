// What a character can do is found out before a closed body is made for it. A body that was made is in the cache, so
// that an empty cache shows that none was.

#include "tests/apps/run_command.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <sstream>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// The box of two bones, without one triangle; with its clip, or without.
std::string tornGlb(bool clip) {
  GlbWriter writer = smallCharacter();
  nlohmann::json& count = writer.document["accessors"][1]["count"];
  count = count.get<int>() - 3;
  if (!clip) writer.document.erase("animations");
  return writer.glb();
}

struct Studio {
  TemporaryFolder folder;
  fs::path torn = folder.write("torn.glb", tornGlb(true));
  fs::path still = folder.write("still.glb", tornGlb(false));
  CommandSurroundings surroundings{folder.path(), folder.path() / "cache", 0};

  [[nodiscard]] CommandResult run(const std::vector<std::string>& arguments) const {
    return runLorica(arguments, surroundings);
  }
  [[nodiscard]] std::ptrdiff_t bodies() const {
    const fs::path cache = surroundings.cache / "lorica";
    if (!fs::exists(cache)) return 0;
    const std::vector<std::string> names = filesIn(cache);
    return std::count_if(names.begin(), names.end(), [](const std::string& n) { return n.ends_with(".body"); });
  }
  void expectRefused(const std::vector<std::string>& arguments, const std::string& fragment) const {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_NE(result.err.find(fragment), std::string::npos) << "no `" << fragment << "` in: " << result.err;
    EXPECT_EQ(bodies(), 0) << arguments.front() << " made a body before it was refused";
  }
};

TEST(EarlyRefusal, NoBodyIsMadeForWhatTheCharacterCannotDo) {
  const Studio studio;
  const std::string torn = studio.torn;
  const std::string still = studio.still;
  studio.expectRefused({"play", "wave", "--character", torn}, "one of the character's own clips, bend");
  studio.expectRefused({"snapshot", "wave", "--character", torn, "-o", "x.png"}, "own clips");
  studio.expectRefused({"play", "wave", "--character", still}, "wave on still: ");
  studio.expectRefused({"play", torn, "--clip", "jump"}, "no clip named jump, expected one of bend");
  studio.expectRefused({"play", still, "--clip", "jump"}, "found no animation");
  studio.expectRefused({"decompose", still, "--motion", "wave"}, "wave on still: ");
  studio.expectRefused({"live", "--virtual", "--headless", "--character", torn}, "a person on torn: ");
  studio.expectRefused({"live", "--virtual", "--headless", "--character", torn}, "pass it with --map");
  studio.expectRefused({"record", "x.lsession", "--virtual", "--character", still}, "a person on still: ");
  studio.expectRefused({"play", torn, "--expression", "Joy=1"}, "has no expressions");
  EXPECT_FALSE(fs::exists(studio.folder.path() / "x.lsession"));
}

TEST(EarlyRefusal, NothingIsDecomposedForAStageOfWhichOneCannotPerform) {
  const Studio studio;
  const std::string stage = studio.folder.write("stage.json", R"({"format": "lorica scene 1", "avatars": [
    {"motion": "walk", "place": [-1, 0, 0]}, {"motion": "wave", "character": "still.glb", "place": [1, 0, 0]}]})");
  studio.expectRefused({"play", "--scene", stage}, "avatars[1]: wave on still: ");
  studio.expectRefused({"play", "walk,wave", "--character", "mannequin," + studio.still.string()}, "wave on still: ");
  studio.expectRefused({"snapshot", "walk", "--at", "99", "-o", "x.png"}, "--at 99: walk lasts from 0 to ");
  const fs::path cache = studio.surroundings.cache / "lorica";
  EXPECT_TRUE(!fs::exists(cache) || filesIn(cache).empty()) << "something was computed for the first avatar";
}

TEST(EarlyRefusal, WithoutARuntimeOfHeadsetsNothingIsLoadedForOne) {
  setenv("XR_RUNTIME_JSON", "/nonexistent/runtime.json", 1);
  for (const char* command : {"play walk", "live --virtual", "demo"}) {
    const Studio studio;
    std::istringstream words(command);
    std::vector<std::string> arguments(std::istream_iterator<std::string>(words), {});
    arguments.emplace_back("--vr");
    const CommandResult refused = studio.run(arguments);
    EXPECT_EQ(refused.exitCode, 2) << command;
    EXPECT_NE(refused.err.find("OpenXR"), std::string::npos) << refused.err;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_FALSE(fs::exists(studio.surroundings.cache / "lorica")) << command;
  }
  unsetenv("XR_RUNTIME_JSON");
}

TEST(EarlyRefusal, ABodyIsMadeOnceForWhatItCanDo) {
  const Studio studio;
  const CommandResult first = studio.run({"play", studio.torn, "--frames", "5", "--json", "-"});
  ASSERT_EQ(first.exitCode, 0) << first.err;
  EXPECT_EQ(studio.bodies(), 1);
  EXPECT_EQ(first.err.find("warning"), std::string::npos) << first.err;
  const CommandResult second = studio.run({"play", studio.torn, "--frames", "5", "--json", "-"});
  EXPECT_EQ(second.json()["hash"], first.json()["hash"]);
  const CommandResult info = studio.run({"info", studio.torn, "--json", "-"});
  EXPECT_EQ(info.json()["body"]["made"], true);
  EXPECT_EQ(studio.bodies(), 1) << "the same body";
  CommandSurroundings without = studio.surroundings;
  without.cache = studio.folder.path() / "another";
  EXPECT_EQ(runLorica({"info", studio.torn, "--json", "-"}, without).json(), info.json());
}

TEST(EarlyRefusal, TheMannequinIsNotDecomposedForAMotionThatItCannotPerform) {
  const Studio studio;
  studio.expectRefused({"play", studio.torn, "--character", "mannequin"}, "on mannequin: ");
  const fs::path cache = studio.surroundings.cache / "lorica";
  EXPECT_EQ(fs::exists(cache) ? filesIn(cache) : std::vector<std::string>(), std::vector<std::string>());
}

}  // namespace
}  // namespace lorica::test
