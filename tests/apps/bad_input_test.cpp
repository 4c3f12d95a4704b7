#include "capture/files/joint_csv.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <utility>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// Expects one error message that starts with the program's name, exit code 2, and no standard output.
void expectRefused(const CommandResult& result, const std::vector<std::string>& fragments) {
  EXPECT_EQ(result.exitCode, 2) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.rfind("lorica: ", 0), 0u) << result.err;
  for (const std::string& fragment : fragments) {
    EXPECT_NE(result.err.find(fragment), std::string::npos) << "no `" << fragment << "` in: " << result.err;
  }
}

/// Decomposes with all kinds of output and expects that no file is left, not even a temporary one.
void expectMeshRefused(const TemporaryFolder& folder, const std::filesystem::path& mesh,
                       std::vector<std::string> fragments, const std::vector<std::string>& options = {}) {
  const std::vector<std::string> before = filesIn(folder.path());
  fragments.push_back(mesh.filename());
  std::vector<std::string> arguments = {"decompose",    mesh,
                                        "--parts",      "4",
                                        "-o",           folder.path() / "out.lorica",
                                        "--export-obj", folder.path() / "out.obj",
                                        "--json",       folder.path() / "out.json"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  expectRefused(runLorica(arguments), fragments);
  EXPECT_EQ(filesIn(folder.path()), before);
}

constexpr const char* kTetrahedronOff = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

struct Refused {
  std::string name, content;
  std::vector<std::string> fragments;  ///< of the sentence, beside the file's name
};

TEST(BadMesh, IsNamedWithTheLine) {
  const TemporaryFolder folder;
  expectMeshRefused(folder, folder.path() / "missing.off", {});
  expectRefused(runLorica({"decompose", folder.path()}), {"folder"});
  expectRefused(runLorica({"decompose", "manequin"}), {"manequin", "mannequin"});
  const std::vector<Refused> meshes = {
      {"empty.off", "", {}},
      {"empty.obj", "", {}},
      {"empty.ply", "", {}},
      {"empty.stl", "", {}},
      {"body.max", "a scene of another program", {".off"}},
      {"range.off", replaced(kTetrahedronOff, "3 1 2 3", "3 1 2 4"), {"line 10", "4"}},
      {"text.off", replaced(kTetrahedronOff, "0 1 0\n", "0 one 0\n"), {"line 5", "one"}},
      {"nan.off", replaced(kTetrahedronOff, "0 1 0\n", "0 nan 0\n"), {"line 5"}},
  };
  for (const Refused& mesh : meshes) {
    SCOPED_TRACE(mesh.name);
    expectMeshRefused(folder, folder.write(mesh.name, mesh.content), mesh.fragments);
  }
}

// What is open or not a two-manifold gets a closed body, see mesh_input_test.cpp, unless that is forbidden.
TEST(BadMesh, OpenMeshNamesAnEdgeIfNoBodyMayBeMade) {
  const TemporaryFolder folder;
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  mesh.triangles.resize(10);
  expectMeshRefused(folder, writeObj(folder, "open.obj", mesh), {"edge"}, {"--body", "never"});
}

TEST(BadMesh, NonManifoldMeshNamesAnEdgeIfNoBodyMayBeMade) {
  const TemporaryFolder folder;
  // A box with a fin: three triangles meet at one edge, and nothing closes the fin.
  TriMesh mesh = makeBox({0, 0, 0}, {1, 1, 1});
  const auto [a, b, c] = mesh.triangles.front();
  mesh.vertices.emplace_back(3, 3, 3);
  mesh.triangles.push_back({b, a, static_cast<VertexIndex>(mesh.vertices.size() - 1)});
  expectMeshRefused(folder, writeObj(folder, "fin.obj", mesh), {"edge"}, {"--body", "never"});
}

/// Four frames of a walk as CSV: a header and four rows.
std::string shortRecording() {
  const TemporaryFolder folder;
  std::vector<SkeletonFrame> frames = shippedFrames("walk");
  frames.resize(4);
  const std::filesystem::path file = folder.path() / "walk.csv";
  EXPECT_TRUE(writeJointCsv(file, frames));
  return readFile(file).value();
}

/// Start and end of a line, counted from 1, without its line feed.
std::pair<std::size_t, std::size_t> lineIn(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
  return {begin, text.find('\n', begin)};
}

/// The recording with one field of one line changed; both counted from 1.
std::string withField(std::string text, int line, int column, const std::string& value) {
  std::size_t begin = lineIn(text, line).first;
  for (int i = 1; i < column; ++i) begin = text.find(',', begin) + 1;
  const std::size_t end = text.find(',', begin);
  return text.replace(begin, end - begin, value);
}

TEST(BadRecording, TheUnchangedOneIsFine) {
  const TemporaryFolder folder;
  EXPECT_EQ(runLorica({"info", folder.write("walk.csv", shortRecording())}).exitCode, 0);
}

TEST(BadRecording, IsNamedWithLineAndColumn) {
  expectRefused(runLorica({"play", "/nowhere/walk.csv"}), {"/nowhere/walk.csv"});
  expectRefused(runLorica({"play", "wlak"}), {"wlak", "walk", "punch_and_kick", "did you mean \"walk\"?"});
  const std::string good = shortRecording();
  const auto [begin, end] = lineIn(good, 3);
  const std::size_t comma = good.rfind(',', end);
  const std::vector<Refused> recordings = {
      {"two.csv", "1,2\n3,4\n", {"begins with '1'", "--format"}},
      {"empty.csv", "", {"empty"}},
      {"header.csv", withField(good, 1, 2, "person"), {"line 1", "person", "user"}},
      {"rows.csv", good.substr(0, lineIn(good, 1).second + 1), {"row"}},
      {"short.csv", std::string(good).erase(comma, end - comma), {"line 3", "121", "122"}},
      {"text.csv", withField(good, 4, 3, "abc"), {"line 4", "column 3", "abc", "head.x"}},
      {"nan.csv", withField(good, 2, 4, "nan"), {"line 2", "column 4", "nan"}},
      {"time.csv", withField(good, 4, 1, "-5"), {"line 4", "-5"}},
  };
  for (const Refused& recording : recordings) {
    SCOPED_TRACE(recording.name);
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.write(recording.name, recording.content);
    const std::vector<std::string> before = filesIn(folder.path());
    const CommandResult result =
        runLorica({"play", file, "--snapshots", folder.path() / "pictures", "--json", folder.path() / "report.json"});
    expectRefused(result, recording.fragments);
    expectRefused(result, {recording.name});
    EXPECT_EQ(filesIn(folder.path()), before);
  }
}

TEST(BadDecomposition, OfAnotherMeshDamagedOrInsteadOfHullsIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = writeObj(folder, "l.obj", makeLShape());
  const std::filesystem::path file = folder.path() / "l.lorica";
  ASSERT_EQ(runLorica({"decompose", mesh, "-o", file}).exitCode, 0);
  expectRefused(runLorica({"play", "walk", "--decomposition", file}), {"l.lorica", "l.obj", "mannequin"});
  expectRefused(runLorica({"score", mesh, file}), {"l.lorica", "decomposition", "--export-obj"});
  std::string content = readFile(file).value();
  content[content.size() / 2] ^= 1;
  const std::filesystem::path damaged = folder.write("damaged.lorica", content);
  expectRefused(runLorica({"info", damaged}), {"damaged.lorica"});
  expectRefused(runLorica({"play", "walk", "--decomposition", damaged}), {"damaged.lorica"});
}

/// Shells do not expand a home folder inside a word.
TEST(Options, AHomeFolderInAValueIsTheUsers) {
  const TemporaryFolder folder;
  const std::string before = environment("HOME");
  setenv("HOME", folder.path().c_str(), 1);
  const CommandResult result = runLorica({"info", "mannequin", "--json=~/report.json"});
  setenv("HOME", before.c_str(), 1);
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_EQ(filesIn(folder.path()), std::vector<std::string>{"report.json"});
}

// What a character can do is found out before a closed body is made for it. A body that was made is in the cache, so
// that an empty cache shows that none was.

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
  const TemporaryFolder manifests;
  const fs::path pipe = manifests.path() / "pipe.json";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string folder = manifests.path().string();
  for (const auto& [command, manifest] : {std::pair<const char*, std::string>("play walk", "/nonexistent/runtime.json"),
                                          {"live --virtual", "/nonexistent/runtime.json"},
                                          {"demo", "/nonexistent/runtime.json"},
                                          {"play walk", pipe.string()},
                                          {"play walk", "/dev/zero"},
                                          {"play walk", folder}}) {
    setenv("XR_RUNTIME_JSON", manifest.c_str(), 1);
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
  EXPECT_EQ(jsonOf({"info", studio.torn}, without), info.json());
}

TEST(EarlyRefusal, TheMannequinIsNotDecomposedForAMotionThatItCannotPerform) {
  const Studio studio;
  studio.expectRefused({"play", studio.torn, "--character", "mannequin"}, "on mannequin: ");
  const fs::path cache = studio.surroundings.cache / "lorica";
  EXPECT_EQ(fs::exists(cache) ? filesIn(cache) : std::vector<std::string>(), std::vector<std::string>());
}

}  // namespace
}  // namespace lorica::test
