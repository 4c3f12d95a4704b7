#include "bake/bake_store.h"

#include "geometry/files.h"
#include "tests/bake/faulty_files.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct Shop {
  TemporaryFolder folder;
  FaultyFiles files;
  int waits = 0;
  BakeStore store{files, folder.path(), [this](std::chrono::milliseconds) { ++waits; }};

  /// A result of one file, not published yet.
  fs::path make(const std::string& item, int earlier, const std::string& content) {
    Result<fs::path> made = store.begin(item, earlier);
    EXPECT_TRUE(made.ok());
    EXPECT_TRUE(writeFileAtomically(*made / "x.lorica", content).ok());
    return *made;
  }
  [[nodiscard]] std::string resultOf(const std::string& item) const {
    const Result<std::string> content = readFile(folder.path() / "items" / item / "x.lorica");
    return content ? *content : "none";
  }
};

TEST(BakeStore, AResultAppearsWhole) {
  Shop shop;
  const fs::path made = shop.make("a", 0, "first");
  EXPECT_FALSE(shop.store.has("a"));
  EXPECT_EQ(shop.resultOf("a"), "none");
  shop.files.beforeRename = [&] { EXPECT_FALSE(fs::exists(shop.store.folderOf("a"))); };
  const Result<bool> published = shop.store.publish("a", made, {{"parts", 3}});
  ASSERT_TRUE(published.ok());
  EXPECT_TRUE(*published);
  EXPECT_TRUE(shop.store.has("a"));
  EXPECT_EQ(shop.store.describe("a")->at("parts"), 3);
  EXPECT_EQ(shop.resultOf("a"), "first");
  EXPECT_FALSE(fs::exists(made));
}

TEST(BakeStore, TheFirstOfTwoResultsStays) {
  Shop shop;
  const fs::path slow = shop.make("a", 0, "slow");
  const fs::path quick = shop.folder.path() / "work" / "a.1";
  fs::create_directories(quick);
  ASSERT_TRUE(writeFileAtomically(quick / "x.lorica", "quick").ok());
  EXPECT_TRUE(*shop.store.publish("a", quick, {{"by", 2}}));
  EXPECT_FALSE(*shop.store.publish("a", slow, {{"by", 1}}));
  EXPECT_EQ(shop.resultOf("a"), "quick");
  EXPECT_FALSE(fs::exists(slow));
}

TEST(BakeStore, TakingOverRemovesWhatTheLostProcessLeft) {
  Shop shop;
  const fs::path lost = shop.make("a", 0, "half");
  const fs::path made = shop.make("a", 1, "whole");
  EXPECT_FALSE(fs::exists(lost));
  // The lost process comes back and wants to publish what is gone.
  EXPECT_TRUE(*shop.store.publish("a", made, {{"by", 2}}));
  const Result<bool> late = shop.store.publish("a", lost, {{"by", 1}});
  EXPECT_FALSE(late && *late);
  EXPECT_EQ(shop.resultOf("a"), "whole");
}

TEST(BakeStore, AFaultIsOvercomeOrLeavesNothing) {
  struct Row {
    const char* what;
    int FaultyFiles::*fault;
    int value;
    const char* error;
  };
  for (const auto& [what, fault, value, error] :
       {Row{"a rename that fails once is tried again", &FaultyFiles::failRenames, 1, ""},
        {"a rename whose answer is lost was done", &FaultyFiles::loseRenameAnswers, 1, ""},
        {"a rename that always fails", &FaultyFiles::failRenames, 100, "cannot be written: Input/output error"},
        {"without space", &FaultyFiles::createError, ENOSPC, "No space left on device"}}) {
    SCOPED_TRACE(what);
    Shop shop;
    const fs::path made = shop.make("a", 0, "content");
    shop.files.*fault = value;
    const Result<bool> published = shop.store.publish("a", made, {{"parts", 3}});
    if (*error == '\0') {
      EXPECT_TRUE(published && *published);
      EXPECT_EQ(shop.resultOf("a"), "content");
      if (fault == &FaultyFiles::failRenames) {
        EXPECT_EQ(shop.waits, 1);
      }
      continue;
    }
    ASSERT_FALSE(published.ok());
    EXPECT_TRUE(has(published.error().message, error));
    EXPECT_FALSE(shop.store.has("a"));
    EXPECT_FALSE(fs::exists(shop.store.folderOf("a")));
    EXPECT_FALSE(fs::exists(made));
  }
}

TEST(BakeStore, AStaleListingMakesAnItemTwiceButKeepsOne) {
  Shop shop;
  const fs::path first = shop.make("a", 0, "first");
  EXPECT_TRUE(*shop.store.publish("a", first, {{"by", 1}}));
  shop.files.notSeen = {shop.store.folderOf("a") / "item.json"};
  EXPECT_FALSE(shop.store.has("a"));
  const fs::path second = shop.make("a", 1, "second");
  shop.files.beforeRename = [&] { shop.files.notSeen.clear(); };
  EXPECT_FALSE(*shop.store.publish("a", second, {{"by", 2}}));
  EXPECT_EQ(shop.resultOf("a"), "first");
}

TEST(BakeStore, FilesAreListedWithTheirHashes) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "b_meshes");
  folder.write("b.urdf", "robot");
  folder.write("b_meshes/0.stl", "solid");
  folder.write("item.json", "{}");
  const Result<std::vector<BakedFile>> files = bakedFiles(folder.path());
  ASSERT_TRUE(files.ok());
  ASSERT_EQ(files->size(), 2u);
  EXPECT_EQ((*files)[1].name, "b_meshes/0.stl");
  EXPECT_EQ((*files)[1].hash, hexDigits(contentHash("solid")));
  std::vector<BakedFile> other = *files;
  other[0].hash = hexDigits(contentHash("robots"));
  EXPECT_NE(resultHash(other), resultHash(*files));
  EXPECT_FALSE(bakedFiles(folder.path() / "none").ok());
}

TEST(BakeStore, ADescriptionHasTheTypesThatAreRead) {
  Shop shop;
  fs::create_directories(shop.store.folderOf("a"));
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  for (const std::string& text : std::vector<std::string>{
           "[]", "{\"failure\": 1}", "{\"error\": \"1\"}", "{\"seconds\": null}", "{\"files\": {}}", "{\"files\": [1]}",
           "{\"files\": [{\"hash\": 1}]}", "{\"item\": []}", "{", "{\"item\": " + deep + "}"}) {
    shop.folder.write("items/a/item.json", text);
    EXPECT_EQ(shop.store.describe("a").error().code, ErrorCode::kBadFormat) << text.substr(0, 100);
  }
  shop.folder.write("items/a/item.json",
                    "{\"item\": \"a\", \"files\": [{\"file\": \"x\", \"hash\": \"0\"}], \"parts\": 3}");
  EXPECT_TRUE(shop.store.describe("a").ok());
}

}  // namespace
}  // namespace lorica::test
