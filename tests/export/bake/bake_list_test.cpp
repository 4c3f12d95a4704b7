#include "export/bake/bake_list.h"

#include "export/bake/bake_job.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <filesystem>
#include <set>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

struct Library {
  TemporaryFolder folder;
  Library() {
    fs::create_directories(folder.path() / "set" / "more");
    folder.write("set/b.off", "");
    folder.write("set/a.OBJ", "");
    folder.write("set/more/c.glb", "");
    folder.write("set/readme.txt", "");
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder.path() / name; }
};

/// Inputs relative to a folder and settings, a line each.
std::vector<std::string> read(const Library& library, const std::string& list, const BakeSettings& defaults = {}) {
  const Result<std::vector<BakeItem>> items = readBakeLists(std::vector<std::string>{list}, defaults);
  if (!items) return {items.error().message};
  std::vector<std::string> lines;
  for (const BakeItem& item : *items) {
    const bool file = fs::path(item.input).is_absolute();
    lines.push_back((file ? fs::path(item.input).lexically_relative(library.folder.path()).string() : item.input) +
                    " " + textOf(item.settings));
  }
  return lines;
}

TEST(BakeList, IsAFolderAPatternOrAFileOfAnyFormat) {
  const Library library;
  const BakeSettings eight = {{"parts", {"8"}}};
  struct Row {
    const char* name;
    const char* content;  ///< none if it is no file
    BakeSettings defaults;
    Lines expected;
  };
  const std::vector<Row> rows = {
      {"set", nullptr, {}, {"set/a.OBJ ", "set/b.off ", "set/more/c.glb "}},
      {"set/*.o*", nullptr, {}, {"set/b.off "}},
      {"set/*.dae", nullptr, {}, {library.path("set/*.dae") + ": no file fits this pattern"}},
      {"list.txt",
       "# comment\n\nset/b.off\r\nset/more\nset/*.OBJ\nmissing.off\nmannequin\n",
       eight,
       {"set/b.off parts=8", "set/more/c.glb parts=8", "set/a.OBJ parts=8", "missing.off parts=8",
        "mannequin parts=8"}},
      {"list.csv",
       "input,parts,motion,export,max-error\nset/b.off,4,,,\n\"set/more/c.glb\",,walk;set/x.bvh,glb;urdf,5%\n",
       eight,
       {"set/b.off parts=4",
        "set/more/c.glb export=glb;urdf max-error=5% motion=walk;" + library.path("set/x.bvh") + " parts=8"}},
      {"quotes.csv", "input,hide\n\"set/a, b\"\".off\",\"sword, long\"\n", {}, {"set/a, b\".off hide=sword, long"}},
      {"list.jsonl",
       "{\"input\": \"set/b.off\", \"parts\": 4, \"max-error\": 0.05}\n\n{\"input\": \"set/b.off\", \"exact\": true}\n"
       "{\"input\": \"set/more/c.glb\", \"motion\": [\"walk\", \"wave\"], \"export\": \"vrm\"}\n",
       {},
       {"set/b.off max-error=0.05 parts=4", "set/b.off exact=yes", "set/more/c.glb export=vrm motion=walk;wave"}},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    if (row.content != nullptr) library.folder.write(row.name, row.content);
    EXPECT_EQ(read(library, library.path(row.name), row.defaults), row.expected);
  }
}

TEST(BakeList, WhatIsWrongIsSaidWithItsLine) {
  const Library library;
  struct Row {
    const char* name;
    const char* content;
    const char* message;
  };
  const Row rows[] = {
      {"a.csv", "input,parts\nb.off,x\n", "line 2: parts: found `x`, expected a whole number above 0"},
      {"b.csv", "input,parts\nb.off\n", "line 2: found 1 cells, expected 2"},
      {"c.csv", "file,parts\n", "line 1: found the columns file,parts, expected `input` among them"},
      {"d.csv", "input\n\"b.off\n", "line 2: found a quote that is not closed on this line, expected another \""},
      {"e.csv", "input,export\nb.off,usd\n",
       "line 2: export: found `usd`, expected obj, stl, ply, xml, urdf, glb, vrm; did you mean \"urdf\"?"},
      {"f.jsonl", "{\"input\": 1\n", "line 1: found no JSON object, expected {\"input\": \"FILE\", ...}"},
      {"g.jsonl", "{\"parts\": 3}\n", "line 1: found no input, expected the path of a mesh or character"},
      {"h.csv", "input,hide\nb.off,--json\n",
       "line 2: hide: found `--json`, expected a name that does not begin with a dash"},
      {"i.txt", "# nothing\n", "names no input"},
  };
  for (const auto& [name, content, message] : rows) {
    library.folder.write(name, content);
    EXPECT_EQ(read(library, library.path(name)), Lines{library.path(name) + ": " + message});
  }
  const std::string file = library.folder.write("j.csv", "input,colour\nb.off,red\n");
  EXPECT_TRUE(
      read(library, file)
          .front()
          .starts_with(file + ": line 2: found the setting `colour`, expected input or one of parts, max-error"));
}

TEST(BakeList, EveryPrefixOfAListIsReadOrRefused) {
  const Library library;
  const std::string csv = "input,parts,hide\n\"set/b.off\",4,\"a\"\"b\"\nset/a.OBJ,,\n";
  const std::string jsonl = "{\"input\": \"set/b.off\", \"hide\": [\"a\", [\"b\"]], \"parts\": 4}\n";
  for (std::size_t length = 0; length <= std::max(csv.size(), jsonl.size()); ++length) {
    library.folder.write("p.csv", csv.substr(0, length));
    library.folder.write("p.jsonl", jsonl.substr(0, length));
    EXPECT_FALSE(read(library, library.path("p.csv")).empty());
    EXPECT_FALSE(read(library, library.path("p.jsonl")).empty());
  }
}

TEST(BakeList, AFoldersPipesLinksAndResultsAreNoInputs) {
  const Library library;
  fs::create_symlink("loop.off", library.path("set/loop.off"));
  ASSERT_EQ(::mkfifo(library.path("set/pipe.off").c_str(), 0600), 0);
  for (const char* folder : {"set/baked/items/a-0123", "set/items/a-0123/a_meshes", "set/items/.bake-7-0"})
    fs::create_directories(library.path(folder));
  for (const char* file :
       {"set/baked/items/a-0123/item.json", "set/baked/items/a-0123/a.glb", "set/items/a-0123/item.json",
        "set/items/a-0123/a.glb", "set/items/a-0123/a_meshes/0.stl", "set/items/.bake-7-0/b.glb"})
    library.folder.write(file, "");
  fs::create_symlink("items/a-0123/a.glb", library.path("set/a.glb"));
  EXPECT_EQ(read(library, library.path("set")), (Lines{"set/a.OBJ ", "set/b.off ", "set/more/c.glb "}));
}

TEST(BakeList, DeepJsonIsNoLine) {
  const Library library;
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  const std::string list = library.folder.write("deep.jsonl", "{\"input\": " + deep + "}\n" + deep + "\n");
  EXPECT_EQ(read(library, list), Lines{list + ": line 1: found no JSON object, expected {\"input\": \"FILE\", ...}"});
}

constexpr const char* kTetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::uint64_t keyOf(const BakeItem& item) {
  return bakeJobs(std::vector{item}).front().key;
}

TEST(BakeJob, TheKeyIsThatOfContentsAndSettings) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("a.off", kTetrahedron);
  const BakeItem item{mesh, {{"parts", {"4"}}}};
  const std::uint64_t key = keyOf(item);
  EXPECT_EQ(keyOf(item), key);
  EXPECT_NE(keyOf({mesh, {{"parts", {"5"}}}}), key);
  EXPECT_NE(keyOf({mesh, {}}), key);

  fs::create_directories(folder.path() / "moved");
  EXPECT_EQ(keyOf({folder.write("moved/a.off", kTetrahedron), item.settings}), key) << "moving files changes nothing";
  EXPECT_NE(keyOf({folder.write("b.off", kTetrahedron), item.settings}), key) << "results have the name in them";
  folder.write("a.off", std::string(kTetrahedron) + "\n");
  EXPECT_NE(keyOf(item), key) << "the content changed";
}

TEST(BakeJob, TheKeyHasTheContentsOfMotionsAndBuffers) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("a.off", kTetrahedron);
  const std::string motion = folder.write("m.csv", "1");
  const BakeItem moved{mesh, {{"motion", {motion}}}};
  const std::uint64_t key = keyOf(moved);
  folder.write("m.csv", "2");
  EXPECT_NE(keyOf(moved), key);

  const std::string gltf = folder.write("a.gltf", R"({"buffers": [{"uri": "a.bin"}, {"uri": "../../outside"}, 3]})");
  folder.write("a.bin", "1");
  const std::uint64_t before = keyOf({gltf, {}});
  folder.write("a.bin", "2");
  EXPECT_NE(keyOf({gltf, {}}), before);
}

TEST(BakeJob, AMissingFileHasAKeyOfItsOwnUntilItAppears) {
  const TemporaryFolder folder;
  const std::string missing = folder.path() / "a.off";
  const std::uint64_t key = keyOf({missing, {}});
  EXPECT_NE(keyOf({folder.path() / "other" / "a.off", {}}), key);
  EXPECT_EQ(keyOf({folder.path() / "other" / ".." / "a.off", {}}), key) << "the same place";
  EXPECT_EQ(keyOf({"nowhere.off", {}}), keyOf({fs::absolute("nowhere.off"), {}}));
  folder.write("a.off", kTetrahedron);
  EXPECT_NE(keyOf({missing, {}}), key);
}

TEST(BakeJob, TheSameItemTwiceIsOneJob) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("a mesh.off", kTetrahedron);
  const std::vector<BakeJob> jobs = bakeJobs(std::vector<BakeItem>{{mesh, {}}, {mesh, {{"parts", {"2"}}}}, {mesh, {}}});
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_TRUE(jobs[0].name.starts_with("a_mesh-")) << jobs[0].name;
  EXPECT_EQ(jobs[0].triangles, 4u);
}

TEST(BakeJob, ShardsDivideTheListWithoutRest) {
  std::vector<BakeItem> items;
  for (int i = 0; i < 300; ++i) items.push_back({"missing" + std::to_string(i) + ".off", {}});
  const std::vector<BakeJob> jobs = bakeJobs(items);
  std::set<std::uint64_t> keys;
  for (int i = 1; i <= 7; ++i) {
    const std::vector<BakeJob> shard = jobsOf({i, 7}, jobs);
    EXPECT_GT(shard.size(), 20u);
    for (const BakeJob& job : shard) EXPECT_TRUE(keys.insert(job.key).second);
  }
  EXPECT_EQ(keys.size(), jobs.size());
  // Items that are added to the list leave the others in their shards.
  items.insert(items.begin(), {"new.off", {}});
  std::set<std::uint64_t> before, after;
  for (const BakeJob& job : jobsOf({3, 7}, jobs)) before.insert(job.key);
  for (const BakeJob& job : jobsOf({3, 7}, bakeJobs(items))) after.insert(job.key);
  EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end()));
}

TEST(BakeJob, MoreTrianglesMayTakeMoreMemory) {
  EXPECT_GT(memoryBound(0), 100'000'000u);
  EXPECT_GT(memoryBound(2'000'000), memoryBound(1'000'000));
}

TEST(TriangleCount, IsExactButForPlysTwoAFace) {
  std::string binaryStl(84 + 3 * 50, '\0');
  const std::uint32_t count = 3;
  std::memcpy(binaryStl.data() + 80, &count, sizeof(count));
  std::string stl = "solid x\n";
  for (int i = 0; i < 4; ++i) stl += "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\n";
  const std::string gltf =
      R"({"accessors": [{"count": 30}, {"count": 9}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0},
          "indices": 1}, {"attributes": {"POSITION": 0}}, 7]}]})";
  const std::uint32_t length = static_cast<std::uint32_t>(gltf.size());
  std::string glb = "glTF" + std::string(16, '\0') + gltf + "BIN";
  std::memcpy(glb.data() + 12, &length, sizeof(length));
  struct Row {
    const char* ending;
    std::string content;
    std::size_t triangles;
  };
  for (const auto& [ending, content, triangles] : std::vector<Row>{
           {".off", "OFF\n# by hand\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 2 1\n4 0 1 3 4\n3 0 3 2\n", 4},
           {".obj", "v 0 0 0\nf 1 2 3\nf 1//1 2//2 3//3 4//4\nvn 0 0 1\nf 1/1 2/2 3/3 4/4 5/5", 6},
           {".stl", binaryStl, 3},
           {".stl", stl + "endsolid x\n", 4},
           {".ply", "ply\nformat ascii 1.0\nelement vertex 8\nelement face 6\nend_header\n", 12},
           {".gltf", gltf, 13},
           {".glb", glb, 13}}) {
    EXPECT_EQ(trianglesIn(content, ending), triangles) << ending << ": " << content;
  }
}

TEST(TriangleCount, AnyPrefixHasSomeNumber) {
  const std::string json = R"({"accessors": [{"count": 30}], "meshes": [{"primitives": [{"indices": 0}]}]})";
  for (const char* ending : {".off", ".obj", ".stl", ".ply", ".glb", ".gltf", ".fbx", ""}) {
    for (std::size_t length = 0; length < json.size(); ++length) {
      EXPECT_LE(trianglesIn("glTF" + json.substr(0, length), ending), 1000u);
    }
  }
}

}  // namespace
}  // namespace lorica::test
