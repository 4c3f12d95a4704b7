#include "geometry/files.h"
#include "tests/apps/run_command.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBox =
    "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

/// A library: a box, a character with a clip, and items that cannot be baked.
struct Library {
  TemporaryFolder folder;
  CommandSurroundings surroundings{folder.path(), folder.path() / "cache"};

  Library() {
    folder.write("box.off", kBox);
    folder.write("small.glb", smallCharacter().glb());
    folder.write("bad.off", "OFF\n1 x\n");
    folder.write("list.csv",
                 "input,parts,export\n"
                 "box.off,1,obj;urdf\n"
                 "small.glb,2,glb\n"
                 "bad.off,,\n"
                 "missing.glb,,\n");
  }
  [[nodiscard]] CommandResult run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "bake");
    return runLorica(arguments, surroundings);
  }
  [[nodiscard]] std::vector<nlohmann::json> lines() const {
    const Result<std::string> text = readFile(folder.path() / "out" / "bake.jsonl");
    std::vector<nlohmann::json> lines;
    for (std::size_t at = 0; text && at < text->size(); at = text->find('\n', at) + 1) {
      lines.push_back(nlohmann::json::parse(text->substr(at, text->find('\n', at) - at)));
    }
    return lines;
  }
};

TEST(Bake, MakesResultsOfWhatCanBeBakedAndSentencesOfTheRest) {
  const Library library;
  const CommandResult first = library.run({"list.csv", "--out", "out", "--json", "-"});
  ASSERT_EQ(first.exitCode, 0) << first.err;
  EXPECT_EQ(first.json()["made"], 2);
  EXPECT_EQ(first.json()["failed"], 2);

  const std::vector<nlohmann::json> lines = library.lines();
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0]["settings"], "export=obj;urdf parts=1");
  EXPECT_NEAR(lines[0]["score"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(lines[0]["inputs"][0]["hash"], hexDigits(contentHash(kBox)));
  EXPECT_GT(lines[0]["peakMemory"].get<double>(), 1e6);
  EXPECT_FALSE(lines[0].contains("heldOutError"));
  EXPECT_GE(lines[1]["heldOutError"].get<double>(), 0.0);
  EXPECT_EQ(lines[2]["failure"].get<std::string>().find("bad.off: line 2: "), 0u) << lines[2]["failure"];
  EXPECT_EQ(lines[3]["failure"].get<std::string>().find("missing.glb: "), 0u) << lines[3]["failure"];
  std::vector<std::string> files;
  for (const auto& file : lines[0]["files"]) files.push_back(file["file"]);
  EXPECT_EQ(files[0], "box.lorica");
  EXPECT_EQ(files[1], "box.obj");
  EXPECT_EQ(files[2], "box.urdf");
  const fs::path result = library.folder.path() / "out" / "items" / lines[0]["item"].get<std::string>();
  const Result<std::string> lorica = readFile(result / "box.lorica");
  ASSERT_TRUE(lorica.ok());
  EXPECT_EQ(lines[0]["files"][0]["hash"], hexDigits(contentHash(*lorica)));
  EXPECT_EQ(filesIn(library.folder.path() / "out" / "items").size(), 4u);

  const CommandResult second = library.run({"list.csv", "--out", "out", "--json", "-"});
  EXPECT_EQ(second.json()["there"], 4);
  EXPECT_EQ(second.json()["made"], 0);
}

/// A stranger's mesh is refused with its name in the sentence; what it is called decides nothing.
TEST(Bake, NamesOfMeshesDoNotDecideWhatKindAFailureIs) {
  const Library library;
  std::string list = "box.off\n";
  for (const char* name : {"cannot be written", "lorica: x: No space left on device", "lorica: cancelled",
                           "needs more than the 64 MB of memory that it may take", "std::bad_alloc"}) {
    GlbWriter writer = smallCharacter();
    writer.document["meshes"][0]["name"] = name;
    writer.document["accessors"][1]["count"] = 0;
    const std::string file = "forged" + std::to_string(list.size()) + ".glb";
    library.folder.write(file, writer.glb());
    list += file + "\n";
  }
  library.folder.write("forged.txt", list);
  const CommandResult first = library.run({"forged.txt", "--out", "out", "--json", "-"});
  ASSERT_EQ(first.exitCode, 0) << first.err;
  EXPECT_EQ(first.json()["made"], 1);
  EXPECT_EQ(first.json()["failed"], 5);
  for (const nlohmann::json& line : library.lines()) {
    const std::string failure = line.value("failure", "");
    EXPECT_EQ(failure.find("has no elements") == std::string::npos, line["input"] == "box.off") << failure;
  }
  EXPECT_EQ(library.run({"forged.txt", "--out", "out", "--json", "-"}).json()["there"], 6);
}

TEST(Bake, ShardsGiveTheSameAsOneProcess) {
  const Library library;
  EXPECT_EQ(library.run({"list.csv", "--out", "out", "--threads", "1"}).exitCode, 0);
  for (const char* shard : {"3/3", "1/3"}) {
    EXPECT_EQ(library.run({"list.csv", "--out", "shards", "--shard", shard}).exitCode, 0);
  }
  const CommandResult early = library.run({"list.csv", "--out", "shards", "--collect", "--json", "early.json"});
  EXPECT_EQ(library.run({"list.csv", "--out", "shards", "--shard", "2/3"}).exitCode, 0);
  const CommandResult whole = library.run({"list.csv", "--out", "out", "--collect", "--json", "-"});
  const CommandResult merged = library.run({"list.csv", "--out", "shards", "--collect", "--json", "-"});
  EXPECT_EQ(whole.exitCode, 0) << whole.err;
  EXPECT_EQ(merged.exitCode, 0) << merged.err;
  EXPECT_EQ(merged.json()["hash"], whole.json()["hash"]);
  EXPECT_TRUE(early.exitCode == 0 || early.err.find(" not done yet: ") != std::string::npos) << early.err;
}

TEST(Bake, CollectWithOtherSettingsLeavesTheReport) {
  const Library library;
  EXPECT_EQ(library.run({"list.csv", "--out", "out"}).exitCode, 0);
  EXPECT_EQ(library.run({"list.csv", "--out", "out", "--collect"}).exitCode, 0);
  const std::string report = *readFile(library.folder.path() / "out" / "report.html");
  const CommandResult other = library.run({"list.csv", "--out", "out", "--collect", "--preset", "quality"});
  EXPECT_EQ(other.exitCode, 2);
  EXPECT_NE(other.err.find("out: nothing is baked there as asked"), std::string::npos) << other.err;
  EXPECT_EQ(*readFile(library.folder.path() / "out" / "report.html"), report);
}

TEST(Bake, AListThatDoesNotExistIsASlip) {
  const Library library;
  const CommandResult none = library.run({"nothere", "--out", "none"});
  EXPECT_EQ(none.exitCode, 2);
  EXPECT_NE(none.err.find("nothere: there is no such file or folder"), std::string::npos) << none.err;
  EXPECT_FALSE(fs::exists(library.folder.path() / "none"));
}

TEST(Bake, CollectChecksEveryFileAndWritesAReport) {
  const Library library;
  EXPECT_EQ(library.run({"list.csv", "--out", "out"}).exitCode, 0);
  const CommandResult collected = library.run({"list.csv", "--out", "out", "--collect", "--json", "-"});
  EXPECT_EQ(collected.exitCode, 0) << collected.err;
  EXPECT_EQ(collected.json()["failures"].size(), 2u);
  const Result<std::string> page = readFile(library.folder.path() / "out" / "report.html");
  ASSERT_TRUE(page.ok());
  EXPECT_NE(page->find("<h1>2 baked, 2 failed, 0 not done yet</h1>"), std::string::npos);
  if (collected.err.find("has no pictures") == std::string::npos) {
    EXPECT_NE(page->find("data:image/png;base64,iVBORw0KGgo"), std::string::npos);
  }
  const std::string item = library.lines()[0]["item"];
  library.folder.write("out/items/" + item + "/box.obj", "o changed\n");
  const CommandResult damaged = library.run({"list.csv", "--out", "out", "--collect"});
  EXPECT_EQ(damaged.exitCode, 2);
  EXPECT_NE(damaged.err.find("box.obj: found content with the hash "), std::string::npos) << damaged.err;
  EXPECT_EQ(library.run({"list.csv", "--out", "out", "--json", "-"}).json()["made"], 1);
  EXPECT_EQ(library.run({"list.csv", "--out", "out", "--collect", "--json", "-"}).json()["hash"],
            collected.json()["hash"]);
}

TEST(Bake, InterruptFinishesTheItemAndASecondRunGoesOn) {
  const Library library;
  std::string list = "input,parts\n";
  for (int parts = 2; parts < 8; ++parts) list += "mannequin," + std::to_string(parts) + "\n";
  library.folder.write("many.csv", list);
  CommandSurroundings interrupted = library.surroundings;
  interrupted.interruptWhen = [&](const RunningCommand&) {  // the first item is in progress
    std::error_code ignored;
    for (fs::directory_iterator entry(library.folder.path() / "out" / "items", ignored), end; entry != end;
         entry.increment(ignored)) {
      if (fs::exists(entry->path() / "log.txt", ignored)) return true;
    }
    return false;
  };
  const CommandResult first = runLorica({"bake", "many.csv", "--out", "out", "--threads", "1"}, interrupted);
  EXPECT_EQ(first.exitCode, 130);
  EXPECT_NE(first.err.find("finishing the items in progress"), std::string::npos) << first.err;
  const std::vector<std::string> done = filesIn(library.folder.path() / "out" / "items");
  ASSERT_EQ(done.size(), 1u);
  EXPECT_TRUE(fs::exists(library.folder.path() / "out" / "items" / done[0] / "mannequin.lorica"));
}

TEST(Bake, RefusesWhatIsWrongBeforeAnyWork) {
  const Library library;
  const auto expectRefused = [&](const std::vector<std::string>& arguments, const std::string& sentence) {
    const CommandResult result = library.run(arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_NE(result.err.find(sentence), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(library.folder.path() / "out"));
  };
  expectRefused({"list.csv", "--out", "out", "--shard", "4/3"}, "found `4/3`, expected I/N with I from 1 to N");
  expectRefused({"list.csv", "--out", "out", "--memory", "8"}, "found `8`, expected a size such as 500M or 8G");
  expectRefused({"list.csv", "--out", "out", "--parts", "many"}, "--parts: found `many`, expected a whole number");
  expectRefused({"list.csv", "--out", "out", "--max-error", "5"},
                "--max-error: found `5`, expected a fraction between");
  expectRefused({"list.csv", "--out", "out", "--export", "glb,usd"}, "--export: found `usd`, expected obj, stl, ply");
  expectRefused({"list.csv", "--out", "box.off"}, "box.off is a file, expected a folder");
  expectRefused({"box.off", "--out", "out", "--json", "none/x.json"}, "no such folder");
}

TEST(Bake, MemoryThatIsTooSmallIsSaidAndLeavesTheItemForLater) {
  const Library library;
  const CommandResult small = library.run({"box.off", "--out", "out", "--memory", "1M"});
  EXPECT_EQ(small.exitCode, 2);
  EXPECT_NE(small.err.find("box.off: 12 triangles may take"), std::string::npos) << small.err;
  EXPECT_EQ(library.run({"box.off", "--out", "out"}).exitCode, 0);
}

}  // namespace
}  // namespace lorica::test
