#include "bake/bake_list.h"

#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

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

using Lines = std::vector<std::string>;

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
       "line 2: export: found `usd`, expected obj, stl, ply, xml, urdf, glb, vrm"},
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
  for (const char* folder : {"set/baked/items/a-0123", "set/baked/claims", "set/done/items/a-0123", "set/items/a-0123"})
    fs::create_directories(library.path(folder));
  library.folder.write("set/baked/items/a-0123/a.glb", "");
  library.folder.write("set/done/items/a-0123/a.glb", "");
  library.folder.write("set/done/bake.jsonl", "");
  library.folder.write("set/items/a-0123/a.dat", "");
  fs::create_symlink("items/a-0123/a.dat", library.path("set/a.glb"));
  EXPECT_EQ(read(library, library.path("set")), (Lines{"set/a.OBJ ", "set/b.off ", "set/more/c.glb "}));
}

TEST(BakeList, DeepJsonIsNoLine) {
  const Library library;
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  const std::string list = library.folder.write("deep.jsonl", "{\"input\": " + deep + "}\n" + deep + "\n");
  EXPECT_EQ(read(library, list), Lines{list + ": line 1: found no JSON object, expected {\"input\": \"FILE\", ...}"});
}

}  // namespace
}  // namespace lorica::test
