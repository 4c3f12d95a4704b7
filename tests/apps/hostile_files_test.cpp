#include "geometry/files.h"
#include "geometry/sanitizer.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <filesystem>
#include <fstream>
#include <string>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

constexpr double kSeconds = 20.0;  // of a processor that any hostile file may take; it is 2 on an idle machine
constexpr long kMegabytes = 500;   // that any process may take, of this test program's so far

double secondsOf(const rusage& used) {
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/// Expects one sentence and exit status 2, soon and with little memory. @return the sentence
std::string expectRefused(const std::vector<std::string>& arguments, const CommandSurroundings& surroundings = {}) {
  struct rusage before {
  }, used{};
  ::getrusage(RUSAGE_CHILDREN, &before);
  const CommandResult result = runLorica(arguments, surroundings);
  ::getrusage(RUSAGE_CHILDREN, &used);
  const double seconds = secondsOf(used) - secondsOf(before);
  EXPECT_EQ(result.exitCode, 2) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_LT(result.err.size(), 1200u);
  EXPECT_LT(seconds, kSeconds);
  if (!kReservesAddresses) {
    EXPECT_LT(used.ru_maxrss / 1024, kMegabytes);
  }
  std::cout << "    " << seconds << " s, " << used.ru_maxrss / 1024 << " MB: " << result.err;
  return result.err;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string sceneWithMesh(const std::string& file) {
  return R"({"format": "lorica scene 1", "props": [{"shape": "mesh", "file": ")" + file + R"(", "at": [0, 1, 0]}]})";
}

void copyTo(const fs::path& folder, const fs::path& file) {
  fs::copy_file(file, folder / file.filename());
}

TEST(HostileFiles, CharactersThatBrokeTheReaderAreOneSentence) {
  LORICA_REQUIRE_DATASET(hostile, "hostile");
  int files = 0;
  for (const auto& entry : fs::directory_iterator(hostile)) {
    const std::string kind = entry.path().extension().string();
    if (kind != ".dae" && kind != ".fbx") continue;
    const std::string sentence = expectRefused({"info", entry.path()});
    EXPECT_TRUE(contains(sentence, "broken")) << sentence;
    ++files;
  }
  EXPECT_EQ(files, 5);
}

TEST(HostileFiles, AnArrayIsNotAsLongAsAnFbxFileSays) {
  LORICA_REQUIRE_DATASET(character, "characters/arnaud/arnaud.fbx");
  std::string bytes = readFile(character).value();
  // A binary array: type 'd' or 'i', its length, its encoding (0 or 1), its bytes.
  const TemporaryFolder folder;
  int changed = 0;
  for (std::size_t at = 27; at + 13 < bytes.size() && changed == 0; ++at) {
    const bool array = (bytes[at] == 'd' || bytes[at] == 'i') && bytes[at + 5] == 1 && bytes[at + 6] == 0 &&
                       bytes[at + 7] == 0 && bytes[at + 8] == 0 && bytes[at + 3] == 0 && bytes[at + 4] == 0 &&
                       bytes[at + 13] == 0x78;
    if (!array) continue;
    const std::uint32_t length = 300'000'000;
    std::memcpy(bytes.data() + at + 1, &length, sizeof length);
    ++changed;
  }
  ASSERT_EQ(changed, 1);
  (void)expectRefused({"info", folder.write("array.fbx", bytes)});
}

TEST(HostileFiles, ListsOfManyObjectsAreReadOnce) {
  const TemporaryFolder folder;
  std::string list = "{}";
  for (int i = 1; i < 490'000; ++i) list += ",{}";
  const fs::path scene = folder.write("many.json", R"({"format": "lorica scene 1", "props": [)" + list + "]}");
  const fs::path character = folder.write("c.glb", mannequinGlb(false));
  const fs::path map = folder.write("many_bones.json", R"({"lorica": "bone map 2", "bones": [)" + list + "]}");
  EXPECT_TRUE(contains(expectRefused({"info", scene}), "props[0].shape: found nothing"));
  EXPECT_TRUE(contains(expectRefused({"info", character, "--map", map}), "lorica is \"bone map 2\""));
}

TEST(HostileFiles, NamedPipesThatAFileNamesAreNotWaitedFor) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "fifo.obj").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder.path() / "fifo.bin").c_str(), 0600), 0);
  const fs::path scene = folder.write("fifo.json", sceneWithMesh("fifo.obj"));
  const fs::path character =
      folder.write("fifo.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "fifo.bin", "byteLength": 10}]})");
  EXPECT_TRUE(contains(expectRefused({"play", "walk", "--frames", "1", "--scene", scene}), "found a named pipe"));
  EXPECT_TRUE(contains(expectRefused({"info", character}), "found a named pipe"));
}

TEST(HostileFiles, TheFilesOfTheDatasetThatNameOthers) {
  LORICA_REQUIRE_DATASET(hostile, "hostile");
  const TemporaryFolder folder;
  for (const char* name : {"fifo.json", "fifo.gltf", "nul_passwd.json", "nul_secret.json"}) {
    copyTo(folder.path(), hostile / name);
  }
  ASSERT_EQ(::mkfifo((folder.path() / "fifo.obj").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder.path() / "fifo.bin").c_str(), 0600), 0);
  (void)folder.write("secret.txt", "the secret of this test\n");
  (void)expectRefused({"info", folder.path() / "fifo.gltf"});
  for (const char* name : {"fifo.json", "nul_passwd.json", "nul_secret.json"}) {
    const std::string sentence = expectRefused({"play", "walk", "--frames", "1", "--scene", folder.path() / name});
    EXPECT_FALSE(contains(sentence, "root:")) << sentence;
    EXPECT_FALSE(contains(sentence, "the secret")) << sentence;
  }
}

TEST(HostileFiles, LargeFilesAreNotRead) {
  const TemporaryFolder folder;
  for (const char* name : {"large.off", "large.obj", "large.ply", "large.stl", "large.glb", "large.fbx", "large.dae",
                           "large.bvh", "large.csv", "large.lorica"}) {
    const fs::path file = folder.write(name, "");
    fs::resize_file(file, std::uintmax_t{40'000'000'000});
    EXPECT_TRUE(contains(expectRefused({"info", file}), "40000000000 bytes, expected at most")) << name;
  }
  for (const char* name : {"large.lsession", "large.json"}) {
    const fs::path file = folder.write(name, "");
    fs::resize_file(file, std::uintmax_t{3'000'000'000});
    const bool session = file.extension() == ".lsession";
    EXPECT_TRUE(contains(
        session ? expectRefused({"replay", file}) : expectRefused({"play", "walk", "--frames", "1", "--scene", file}),
        "3000000000 bytes, expected at most"));
  }
}

TEST(HostileFiles, MemoryThatIsNotAllowedIsASentence) {
  if (kReservesAddresses) GTEST_SKIP() << "no limit of memory holds under this sanitizer";
  const TemporaryFolder folder;
  const std::string out = folder.path() / "o.lorica";
  const std::vector<std::vector<std::string>> commands = {
      {"decompose", "mannequin", "--parts", "4", "-o", out},
      {"play", "walk", "--frames", "2", "--record", folder.path() / "o.lsession"},
      {"snapshot", "walk", "--frame", "1", "-o", folder.path() / "o.png"},
      {"export", "mannequin", folder.path() / "o.glb"}};
  for (std::vector<std::string> command : commands) {
    command.insert(command.end(), {"--memory", "64M", "--threads", "1"});
    EXPECT_TRUE(contains(expectRefused(command, {.folder = ".", .cache = "/dev/null"}),
                         "needs more than the 64 MB of memory that it may take; --memory SIZE"))
        << command[0];
    EXPECT_EQ(filesIn(folder.path()), std::vector<std::string>()) << command[0];
  }
  for (const char* size : {"much", "0G", "1M"}) {
    const CommandResult refused = runLorica({"info", "mannequin", "--memory", size});
    EXPECT_EQ(refused.exitCode, 2);
    EXPECT_TRUE(contains(refused.err, "expected a size such as 500M or 8G, at least 64M")) << refused.err;
  }
  EXPECT_EQ(runLorica({"info", "mannequin", "--memory", "1G"}).exitCode, 0);
}

TEST(HostileFiles, AScenesMeshesAreInItsFolderUnlessItIsTrusted) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "own");
  (void)folder.write("mesh.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  for (const std::string& name : {std::string("../mesh.off"), (folder.path() / "mesh.off").string()}) {
    const fs::path scene = folder.write("own/scene.json", sceneWithMesh(name));
    const std::vector<std::string> play = {"play", "walk", "--frames", "1", "--scene", scene};
    EXPECT_TRUE(contains(expectRefused(play), "--trust-paths"));
    std::vector<std::string> trusted = play;
    trusted.push_back("--trust-paths");
    const CommandResult played = runLorica(trusted);
    EXPECT_EQ(played.exitCode, 0) << played.err;
  }
}

TEST(HostileFiles, APipeThatTheUserNamesIsRead) {
  const TemporaryFolder folder;
  const fs::path off =
      folder.write("mesh.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const fs::path pipe = folder.path() / "pipe.off";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string feed = "cat '" + off.string() + "' > '" + pipe.string() + "' &";
  ASSERT_EQ(std::system(feed.c_str()), 0);
  const nlohmann::json result = jsonOf({"info", pipe});
}

TEST(HostileFiles, ASessionReadsOnlyWhatIsInItsFolderOrShips) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "own");
  const fs::path body = mannequinBody(folder);
  const fs::path session = folder.path() / "s.lsession";
  const CommandResult recorded =
      runLorica({"record", session, "walk", "--frames", "5", "--scene", "bowling", "--decomposition", body});
  ASSERT_EQ(recorded.exitCode, 0) << recorded.err;

  // Beside its decomposition it runs from any folder, with the shipped scene.
  CommandSurroundings elsewhere;
  elsewhere.folder = "/";
  const CommandResult beside = runLorica({"replay", session}, elsewhere);
  EXPECT_EQ(beside.exitCode, 0) << beside.err;

  // One that names a file outside does not, unless it is trusted or gets the file.
  const fs::path inner = folder.path() / "own/s.lsession";
  ASSERT_EQ(runLorica({"record", inner, "walk", "--frames", "5", "--decomposition", body}).exitCode, 0);
  const std::string sentence = expectRefused({"replay", inner});
  EXPECT_TRUE(contains(sentence, "--decomposition")) << sentence;
  EXPECT_TRUE(contains(sentence, "--trust-paths")) << sentence;
  EXPECT_EQ(runLorica({"replay", inner, "--decomposition", body}).exitCode, 0);
  EXPECT_EQ(runLorica({"replay", inner, "--trust-paths"}).exitCode, 0);
}

TEST(HostileFiles, CtrlCEndsTheReadingOfACharacterAtOnce) {
  LORICA_REQUIRE_DATASET(hostile, "hostile");
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [](const RunningCommand& command) {  // the process that reads it was started
    const std::string id = std::to_string(command.process);
    std::string child;
    return static_cast<bool>(std::ifstream("/proc/" + id + "/task/" + id + "/children") >> child);
  };
  const CommandResult result = runLorica({"info", hostile / "controllercycle.dae"}, surroundings);
  EXPECT_TRUE(result.exitCode == 130 || result.exitCode == 2) << result.err;
}

}  // namespace
}  // namespace lorica::test
