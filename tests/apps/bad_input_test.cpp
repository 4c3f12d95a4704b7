#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "tests/apps/mesh_text.h"
#include "tests/apps/run_command.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lorica::test {
namespace {

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
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWalk);
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

struct WrongOption {
  std::vector<std::string> arguments;
  std::vector<std::string> fragments;
};

TEST(BadOption, JsonOntoAnotherFileOfTheCommandIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path mesh = folder.write("mesh.off", kTetrahedronOff);
  expectRefused(runLorica({"decompose", mesh, "--json", folder.path() / "." / "mesh.off"}), {"--json", "overwritten"});
  expectRefused(runLorica({"info", mesh, "--json", mesh}), {"--json", "overwritten"});
  expectRefused(runLorica({"score", mesh, folder.path() / "parts.obj", "--json", mesh}), {"--json", "overwritten"});
  expectRefused(runLorica({"decompose", mesh, "-o", folder.path() / "a.lorica", "--json", folder.path() / "a.lorica"}),
                {"--json", "overwritten"});
  expectRefused(runLorica({"decompose", mesh, "-o", folder.path() / "a.lorica", "--json", "/dev/null"}),
                {"--json", "/dev/null"});
  EXPECT_EQ(*readFile(mesh), kTetrahedronOff);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.lorica"));
}

TEST(BadOption, IsRefusedInASentence) {
  const TemporaryFolder folder;
  const std::string mesh = writeObj(folder, "l.obj", makeLShape());
  const std::vector<WrongOption> wrong = {
      {{"decompose", mesh, "--parts", "0"}, {"--parts", "`0`", "from 1"}},
      {{"decompose", mesh, "--parts", "-3"}, {"--parts", "`-3`", "from 1"}},
      {{"decompose", mesh, "--parts", "many"}, {"--parts", "`many`"}},
      {{"decompose", mesh, "--parts", "3.5"}, {"--parts", "`3.5`"}},
      {{"decompose", mesh, "--parts", "99999999999"}, {"--parts", "`99999999999`"}},
      {{"decompose", mesh, "--candidates", "0"}, {"--candidates", "`0`"}},
      {{"decompose", mesh, "--orientations", "0"}, {"--orientations", "`0`"}},
      {{"decompose", mesh, "--max-error", "0"}, {"--max-error", "`0`", "above 0", "5%"}},
      {{"decompose", mesh, "--max-error", "5"}, {"--max-error", "`5`", "below 1", "did you mean \"5%\"?"}},
      {{"decompose", mesh, "--max-concavity", "1"}, {"--max-concavity", "`1`", "below 1"}},
      {{"decompose", mesh, "--max-error", "%"}, {"--max-error", "`%`"}},
      {{"decompose", mesh, "--max-error", "5%%"}, {"--max-error", "`5%%`"}},
      {{"decompose", mesh, "--max-error", "inf"}, {"--max-error", "`inf`"}},
      {{"decompose", mesh, "--max-distance", "-1"}, {"--max-distance", "`-1`", "above 0"}},
      {{"decompose", mesh, "--max-distance", "1m"}, {"--max-distance", "`1m`"}},
      {{"decompose", mesh, "--preset", "best"}, {"best", "paper, fast, quality"}},
      {{"decompose", mesh, "--threads", "0"}, {"--threads", "`0`"}},
      {{"decompose", mesh, "--keyframes", "3"}, {"--keyframes", "l.obj", "characters"}},
      {{"decompose", mesh, "--motion", "walk"}, {"--motion", "l.obj", "characters"}},
      {{"decompose", "mannequin", "--keyframes", "100000"}, {"--keyframes", "100000"}},
      {{"decompose", mesh, "-o", "/nowhere/l.lorica"}, {"--output", "/nowhere"}},
      {{"decompose", mesh, "-o", "l.obj"}, {"--output", ".lorica"}},
      {{"decompose", mesh, "--export-obj", mesh}, {"--export-obj", "overwritten"}},
      {{"decompose", mesh, "--json", "/nowhere/l.json"}, {"--json", "/nowhere"}},
      {{"decompose", mesh, "--prats", "3"}, {"--prats"}},
      {{"decompose"}, {"INPUT"}},
      {{"score", mesh}, {"PARTS.obj"}},
      {{"snapshot", "walk", "--at", "1s"}, {"--at", "found `1s`, expected a number"}},
      {{"snapshot", "walk", "--at", "1,5s"}, {"--at", "found `5s`, expected a number"}},
      {{"snapshot", "walk", "--frame", "x"}, {"--frame", "found `x`, expected a whole number"}},
      {{"play", "walk", "--character", "godzilla"}, {"godzilla", "mannequin"}},
      {{"play", "walk", "--every", "5"}, {"--every", "--snapshots"}},
      {{"play", "walk", "--frames", "0"}, {"--frames", "`0`"}},
      {{"demo", "--seconds", "-1"}, {"--seconds", "`-1`"}},
      {{"demo", "--seconds", "nan"}, {"--seconds", "`nan`"}},
      {{"demo", "--window", "--headless"}, {"--window", "--headless"}},
      {{"info", "nothing.txt"}, {"nothing.txt"}},
      {{"info", "wlak"}, {"wlak", "did you mean \"walk\"?"}},
      {{"play", "walk", "--scene", "bowlin"}, {"bowlin", "did you mean \"bowling\"?"}},
      {{"contacts"}, {"the motion is missing", "lorica contacts walk.bvh -o walk.npz"}},
      {{"contacts", "walk"}, {"-o FILE is missing"}},
      {{"live", "me.oni"}, {"me.oni: unexpected argument; `lorica play me.oni`"}},
      {{"serve", "walk", "--key", "none.pem"}, {"--key requires --certificate"}},
  };
  for (const WrongOption& option : wrong) {
    SCOPED_TRACE(option.arguments.front() + " ... " + option.arguments.back());
    expectRefused(runLorica(option.arguments), option.fragments);
  }
  EXPECT_EQ(filesIn(folder.path()), std::vector<std::string>{"l.obj"});
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

}  // namespace
}  // namespace lorica::test
