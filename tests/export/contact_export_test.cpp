#include "export/contact_export.h"

#include "acd/decomposition_file.h"
#include "export/engines.h"
#include "export/mesh_export.h"
#include "geometry/files.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

namespace lorica::test {
namespace {

/// Reports that it is cancelled after some frames.
class Impatient final : public Host {
 public:
  explicit Impatient(int frames) : left_(frames) {}
  void report(int /*done*/, int /*total*/, double /*share*/) override { --left_; }
  [[nodiscard]] bool cancelled() const override { return left_ <= 0; }

 private:
  int left_;
};

class ContactExport : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    DecompositionFile content;
    content.decomposition = eightParts();
    content.source = "mannequin";
    content.meshHash = topologyHash(makeMannequin().mesh);
    ASSERT_TRUE(writeDecomposition(folder_->path() / "body.lorica", content).ok());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  [[nodiscard]] static ContactRequest request(const std::string& motion) {
    ContactRequest asked;
    asked.cast.motion = motion;
    asked.cast.body.decomposition = (folder_->path() / "body.lorica").string();
    return asked;
  }
  [[nodiscard]] static std::string file(const char* name) { return (folder_->path() / name).string(); }
  [[nodiscard]] static std::vector<std::string> names() {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_->path())) {
      found.push_back(entry.path().filename().string());
    }
    std::ranges::sort(found);
    return found;
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(ContactExport, LinesOfJsonAreTheRows) {
  Host host;
  const ContactLabels kept = findContacts(request("wave"), host).value();
  const ContactLabels written = writeContacts(request("wave"), file("wave.jsonl"), host).value();
  EXPECT_EQ(written.rowCount, kept.rows.size());
  EXPECT_EQ(written.standing, kept.standing);
  const std::string text = readFile(file("wave.jsonl")).value();
  EXPECT_FALSE(has(text, "-0,")) << "a zero has no sign";
  std::istringstream lines(text);
  std::size_t i = 0;
  for (std::string line; std::getline(lines, line); ++i) {
    const nlohmann::json found = nlohmann::json::parse(line);
    const ContactRow& row = kept.rows[i];
    EXPECT_EQ(found["frame"], row.frame);
    EXPECT_EQ(found["time"], row.time);
    EXPECT_EQ(found["bone"], kept.bones[row.bone]);
    EXPECT_EQ(found["other_avatar"].is_null(), row.otherAvatar < 0);
    EXPECT_NEAR(found["depth"], row.depth, 1e-6);
    EXPECT_EQ(found["kind"], row.kind == ContactKind::kFloor ? "floor" : "self");
    EXPECT_EQ(found["phase"].is_null(), row.foot == ContactFoot::kNone);
    EXPECT_EQ(found["normal"].size(), 3U);
  }
  EXPECT_EQ(i, kept.rows.size());
  EXPECT_GT(i, 300U);
  EXPECT_GT(kept.overlaps, 0U);
}

TEST_F(ContactExport, TheSameInputGivesTheSameBytes) {
  Host host;
  for (const char* ending : {".npz", ".csv", ".jsonl"}) {
    const std::string first = file("first") + ending, second = file("second") + ending;
    ASSERT_TRUE(writeContacts(request("walk,wave"), first, host).ok());
    ASSERT_TRUE(writeContacts(request("walk,wave"), second, host).ok());
    const std::string bytes = readFile(first).value();
    EXPECT_EQ(bytes, readFile(second).value()) << ending;
    EXPECT_GT(bytes.size(), 10'000U);
    std::filesystem::remove(first);
    std::filesystem::remove(second);
  }
}

/// A file's name may hold any bytes, and notes begin with it.
TEST_F(ContactExport, NotesAreTextWhateverBytesANameHas) {
  ContactLabels labels;
  labels.notes = {"caf\xe9: has no clips", "\xc3\xa9"};
  const auto found = [&](const NamedArray& array) -> Result<void> {
    if (array.name != "notes") return {};
    EXPECT_EQ(array.type, "<U18");
    EXPECT_EQ(array.bytes.substr(0, 20), std::string("c\0\0\0a\0\0\0f\0\0\0\xfd\xff\0\0:\0\0\0", 20));
    EXPECT_EQ(array.bytes.substr(18 * 4, 8), std::string("\xe9\0\0\0\0\0\0\0", 8));
    return {};
  };
  EXPECT_TRUE(forEachArray(labels, found).ok());
}

TEST_F(ContactExport, BadRequestsLeaveNothingBehind) {
  const std::vector<std::string> before = names();
  Host host;
  const auto sentence = [&](const ContactRequest& asked, const std::string& to, Host& by) {
    const Result<ContactLabels> made = writeContacts(asked, to, by);
    return made ? std::string("written") : made.error().message;
  };
  EXPECT_EQ(sentence(request("wave"), "out.xlsx", host),
            "out.xlsx: found the extension `.xlsx`, expected .npz (numpy), .csv or .jsonl");
  ContactRequest far = request("wave");
  far.near = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sentence(far, file("a.csv"), host), "near: found nan m, expected 0 to 1 m");
  for (const char* name : {"a.csv", "a.npz", "a.jsonl"}) {
    ContactRequest few = request("wave");
    few.mostRows = 100;
    const std::string said = sentence(few, file(name), host);
    EXPECT_TRUE(has(said, "wave: found more than 100 rows in "));
    Impatient impatient(20);
    EXPECT_EQ(sentence(request("wave"), file(name), impatient), "cancelled");
    EXPECT_TRUE(has(sentence(request("nowhere.bvh"), file(name), host), "nowhere.bvh"));
  }
  EXPECT_EQ(names(), before);
}

TEST_F(ContactExport, AMotionWithoutAFloorIsSaidToBe) {
  Host host;
  const auto notesOf = [&](const ContactRequest& asked) { return valueOf(findContacts(asked, host)).notes; };
  EXPECT_EQ(notesOf(request("walk")), std::vector<std::string>());
  ContactRequest floating = request("");
  const auto staged = [&](const char* place) {
    return folder_->write("stage.json",
                          fmt::format(R"({{"format": "lorica scene 1", "props": [], "floor": {}}})", place));
  };
  floating.cast.scene = staged(R"(true, "avatars": [{"motion": "walk", "place": [0, 1, 0]}])");
  EXPECT_EQ(notesOf(floating),
            std::vector<std::string>{"avatar 0: stays 0.99 m above the floor, expected a motion whose "
                                     "floor is y = 0: no foot stands"});
  floating.cast.scene = staged(R"(true, "avatars": [{"motion": "walk", "place": [0, -1, 0]}])");
  EXPECT_EQ(notesOf(floating),
            std::vector<std::string>{"avatar 0: goes 1.01 m below the floor, expected a motion whose "
                                     "floor is y = 0"});
  floating.cast.scene = staged(R"(false, "avatars": [{"motion": "walk"}])");
  EXPECT_EQ(notesOf(floating), std::vector<std::string>{"the scene has no floor: found no contacts with one"});
  std::filesystem::remove(folder_->path() / "stage.json");
}

std::vector<NamedMesh> twoSolids() {
  TriMesh box = test::makeBox(Vec3(-1.0, 0.0, 2.0), Vec3(0.25, 1.0 / 3.0, 3.0));
  return {{"box of a hand", std::move(box)}, {"tetrahedron", test::makeTetrahedron()}};
}

class MeshFormat : public testing::TestWithParam<const char*> {};

TEST_P(MeshFormat, IsReadBackToNineDigitsWhereverItIs) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / (std::string("hulls") + GetParam());
  for (const Vec3& away : {Vec3(0.0, 0.0, 0.0), Vec3(5e6, -3.0, 0.0)}) {
    std::vector<NamedMesh> solids = twoSolids();
    for (NamedMesh& solid : solids) {
      for (Vec3& p : solid.mesh.vertices) p += away;
    }
    ASSERT_TRUE(writeMeshes(file, solids).ok());
    TriMesh read = readMesh(file).value();
    EXPECT_EQ(read.triangles.size(), 16U);
    EXPECT_EQ(read.vertices.size(), 12U);
    for (Vec3& p : read.vertices) p -= away;
    EXPECT_NEAR(signedVolume(read.vertices, read.triangles), 1.25 / 3.0 + 1.0 / 6.0, 1e-8);
    EXPECT_LT((surfaceBounds(read).min - Vec3(-1.0, 0.0, 0.0)).norm(), 1e-8);
  }
  ASSERT_TRUE(writeMeshes(file, twoSolids()).ok());
  EXPECT_TRUE(test::has(readFile(file).value(), " 0.333333333"));
  EXPECT_FALSE(test::has(readFile(file).value(), " 0.3333333333"));
}

INSTANTIATE_TEST_SUITE_P(, MeshFormat, testing::Values(".obj", ".stl", ".ply", ".STL"),
                         [](const auto& each) { return "as" + std::to_string(each.index) + (each.param + 1); });

TEST(MeshExport, NamesOfPartsAreInTheFilePlainAndUnique) {
  const std::string stl = formatMeshes(twoSolids(), ".stl"), ply = formatMeshes(twoSolids(), ".ply");
  expectAll(stl, {"solid box_of_a_hand\n", "endsolid tetrahedron\n"});
  expectAll(ply, {"comment part 1 tetrahedron\n", "\n3 8 10 9 1\n"});
  EXPECT_EQ(plainNames({"Hips", "Hips", "Hips_2", "\xe8\x85\xb0<\"", "", "a b"}),
            (std::vector<std::string>{"Hips", "Hips_2", "Hips_2_2", "_____", "_", "a_b"}));
}

TEST(MeshExport, BinaryStlHasOneRecordForEachTriangle) {
  const test::TemporaryFolder folder;
  const std::string bytes = formatBinaryStl(test::makeTetrahedron());
  EXPECT_EQ(bytes.size(), 84U + 4U * 50U);
  const TriMesh read = readMesh(folder.write("t.stl", bytes)).value();
  EXPECT_DOUBLE_EQ(signedVolume(read.vertices, read.triangles), 1.0 / 6.0);
}

TEST(MeshExport, LeavesNothingWhereItCannotWrite) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(writeMeshes(folder.path() / "no" / "hulls.stl", twoSolids()).ok());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Engines, AreFoundByTheirNamesAlone) {
  EXPECT_EQ(engineNamed("unity")->maxVertices, 255);
  EXPECT_EQ(engineNamed("unreal")->prefix, "UCX_");
  EXPECT_FALSE(engineNamed("Unity"));
  EXPECT_FALSE(engineNamed(""));
  for (const Engine& engine : kEngines) {
    EXPECT_TRUE(engine.maxVertices == 0 || engine.maxVertices >= 4) << engine.name;
  }
}

}  // namespace
}  // namespace lorica::test
