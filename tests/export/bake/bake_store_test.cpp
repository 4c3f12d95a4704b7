#include "export/bake/bake_store.h"

#include "export/bake/bake_report.h"
#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct Shop {
  TemporaryFolder folder;
  BakeStore store{folder.path()};

  /// A result of one file, not published yet.
  [[nodiscard]] fs::path make(const std::string& content) const {
    fs::path made = valueOf(store.begin());
    EXPECT_TRUE(writeFileAtomically(made / "x.lorica", content).ok());
    return made;
  }
  [[nodiscard]] bool publish(const std::string& content) const {
    return valueOf(store.publish("a", make(content), describing(content)));
  }
  static ordered_json describing(const std::string& content) {
    return {{"parts", 3}, {"files", {{{"file", "x.lorica"}, {"hash", hexDigits(contentHash(content))}}}}};
  }
  [[nodiscard]] std::string resultOf(const std::string& item) const {
    const Result<std::string> content = readFile(folder.path() / "items" / item / "x.lorica");
    return content ? *content : "none";
  }
  [[nodiscard]] std::vector<std::string> items() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder.path() / "items")) names.push_back(entry.path().filename());
    return names;
  }
};

TEST(BakeStore, AResultAppearsWholeAndAloneAndTheFirstStays) {
  const Shop shop;
  const fs::path slow = shop.make("slow"), made = shop.make("first");
  EXPECT_NE(slow, made);
  EXPECT_EQ(shop.store.describe("a").error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(shop.store.has("a"));
  EXPECT_TRUE(valueOf(shop.store.publish("a", made, Shop::describing("first"))));
  EXPECT_TRUE(shop.store.has("a"));
  EXPECT_EQ(shop.store.describe("a")->at("parts"), 3);
  EXPECT_FALSE(valueOf(shop.store.publish("a", slow, Shop::describing("slow"))));
  EXPECT_EQ(shop.resultOf("a"), "first");
  EXPECT_EQ(shop.items(), std::vector<std::string>{"a"});
}

TEST(BakeStore, OfManyProcessesAtOnceOneMakesAResult) {
  const Shop shop;
  std::vector<pid_t> children;
  for (int p = 0; p < 6; ++p) {
    children.push_back(fork());
    if (children.back() == 0) _exit(shop.publish("by " + std::to_string(p)) ? 1 : 0);
  }
  int winners = 0;
  for (const pid_t child : children) {
    int status = -1;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    winners += WEXITSTATUS(status);
  }
  EXPECT_EQ(winners, 1);
  EXPECT_EQ(shop.items(), std::vector<std::string>{"a"});
  EXPECT_EQ(shop.store.damageOf("a", Shop::describing(shop.resultOf("a"))), "");
}

/// A process that is taken for lost comes back and wants to publish what is gone.
TEST(BakeStore, WhatCannotBePublishedIsAnErrorAndLeavesNothing) {
  const Shop shop;
  const fs::path made = shop.make("content");
  fs::remove_all(made);
  EXPECT_EQ(shop.store.publish("a", made, {}).error().code, ErrorCode::kUnwritable);
  // Somebody's file in place of the folder.
  shop.folder.write("items/a", "");
  const fs::path other = shop.make("content");
  EXPECT_EQ(errorOf(shop.store.publish("a", other, {})).message,
            shop.store.folderOf("a").string() + ": cannot be written: Not a directory");
  EXPECT_FALSE(fs::exists(other));
  shop.folder.write("file", "");
  EXPECT_EQ(BakeStore(shop.folder.path() / "file").begin().error().code, ErrorCode::kUnwritable);
}

TEST(BakeStore, DamageIsFoundAndTheResultCanBeMadeAgain) {
  const Shop shop;
  EXPECT_TRUE(shop.publish("content"));
  const std::string file = shop.store.folderOf("a") / "x.lorica";
  EXPECT_EQ(shop.store.damageOf("a", Shop::describing("content")), "");
  shop.folder.write("items/a/x.lorica", "kontent");
  EXPECT_EQ(shop.store.damageOf("a", Shop::describing("content")),
            fmt::format("{}: found content with the hash {}, expected {}", file, hexDigits(contentHash("kontent")),
                        hexDigits(contentHash("content"))));
  fs::remove(file);
  EXPECT_EQ(shop.store.damageOf("a", Shop::describing("content")), file + ": is missing");
  fs::remove(shop.store.folderOf("a") / "item.json");
  EXPECT_EQ(shop.store.describe("a").error().code, ErrorCode::kBadFormat);
  EXPECT_TRUE(has(shop.store.damageOf("a", {{"files", {{{"file", "../../x"}, {"hash", ""}}}}}), "../../x"));
  ASSERT_TRUE(shop.store.discard("a").ok());
  EXPECT_TRUE(shop.store.discard("a").ok()) << "another process was faster";
  EXPECT_TRUE(shop.items().empty());
  EXPECT_TRUE(shop.publish("content"));
}

TEST(BakeStore, WhatAKilledProcessLeftGoesWhenItIsOld) {
  const Shop shop;
  EXPECT_TRUE(shop.publish("content"));
  const fs::path lost = shop.make("half"), living = shop.make("half");
  for (const fs::path& old : {lost, shop.store.folderOf("a")}) {
    fs::last_write_time(old, fs::last_write_time(living) - std::chrono::hours(25));
  }
  shop.store.removeAbandoned(26.0 * 3600.0);
  EXPECT_TRUE(fs::exists(lost));
  shop.store.removeAbandoned(24.0 * 3600.0);
  EXPECT_FALSE(fs::exists(lost));
  EXPECT_TRUE(fs::exists(living));
  EXPECT_TRUE(shop.store.has("a"));
}

TEST(BakeStore, FilesAreListedWithTheirHashes) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "b_meshes");
  folder.write("b.urdf", "robot");
  folder.write("b_meshes/0.stl", "solid");
  folder.write("item.json", "{}");
  const std::vector<BakedFile> files = valueOf(bakedFiles(folder.path()));
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[1].name, "b_meshes/0.stl");
  EXPECT_EQ(files[1].hash, hexDigits(contentHash("solid")));
  std::vector<BakedFile> other = files;
  other[0].hash = hexDigits(contentHash("robots"));
  EXPECT_NE(resultHash(other), resultHash(files));
  EXPECT_FALSE(bakedFiles(folder.path() / "none").ok());
}

TEST(BakeStore, ADescriptionHasTheTypesThatAreRead) {
  const Shop shop;
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

/// Three items: two results and one that is not done; of these one failed.
struct Baked {
  TemporaryFolder folder;
  BakeStore store{folder.path() / "out"};
  std::vector<BakeJob> jobs;

  Baked() {
    std::vector<BakeItem> items;
    for (const char* name : {"a<b>.off", "bad.off", "later.off"}) items.push_back({folder.write(name, name), {}});
    jobs = bakeJobs(items);
    publish(0, {{"parts", 5}, {"score", 0.8}, {"error", 0.25}, {"seconds", 2.0}}, "content");
    publish(1, {{"failure", "bad.off: line 1: found `<`, expected OFF"}, {"seconds", 0.1}}, "");
  }
  void publish(std::size_t job, ordered_json description, const std::string& content) {
    const fs::path made = *store.begin();
    if (!content.empty()) {
      EXPECT_TRUE(writeFileAtomically(made / "a.lorica", content).ok());
    }
    const std::vector<BakedFile> baked = *bakedFiles(made);
    description["item"] = jobs[job].name;
    description["input"] = jobs[job].item.input;
    description["files"] = ordered_json::array();
    for (const BakedFile& file : baked) description["files"].push_back({{"file", file.name}, {"hash", file.hash}});
    description["result"] = resultHash(baked);
    EXPECT_TRUE(*store.publish(jobs[job].name, made, description));
  }
};

TEST(BakeReport, CollectsByTheList) {
  Baked baked;
  const BakeCollection collection = collect(baked.jobs, baked.store, true);
  EXPECT_EQ(collection.results.size(), 2u);
  EXPECT_EQ(collection.failed().size(), 1u);
  EXPECT_EQ(collection.worstFirst().size(), 1u);
  EXPECT_EQ(collection.missing, std::vector<std::string>{baked.jobs[2].item.input});
  EXPECT_TRUE(collection.damaged.empty());
  const std::string lines = jsonLines(collection);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2);
  EXPECT_EQ(ordered_json::parse(lines.substr(0, lines.find('\n')))["parts"], 5);
}

TEST(BakeReport, FindsFilesThatChanged) {
  Baked baked;
  const std::string hash = collect(baked.jobs, baked.store, true).hash();
  const fs::path file = baked.store.folderOf(baked.jobs[0].name) / "a.lorica";
  ASSERT_TRUE(writeFileAtomically(file, "kontent").ok());
  BakeCollection changed = collect(baked.jobs, baked.store, true);
  ASSERT_EQ(changed.damaged.size(), 1u);
  EXPECT_EQ(changed.damaged.front(), fmt::format("{}: found content with the hash {}, expected {}", file.string(),
                                                 hexDigits(contentHash("kontent")), hexDigits(contentHash("content"))));
  EXPECT_TRUE(collect(baked.jobs, baked.store, false).damaged.empty());
  fs::remove(file);
  EXPECT_EQ(collect(baked.jobs, baked.store, true).damaged.front(), file.string() + ": is missing");
  EXPECT_EQ(changed.hash(), hash) << "the hash is that of what was made";
}

TEST(BakeReport, LinksResultsByTheirNames) {
  TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const BakeStore store(out);
  const auto link = [&](const std::vector<BakeItem>& items) {
    const std::vector<BakeJob> jobs = bakeJobs(items);
    for (const BakeJob& job : jobs) {
      if (store.has(job.name)) continue;
      const fs::path made = *store.begin();
      fs::create_directories(made / (job.stem + "_parts"));
      ordered_json described = {{"item", job.name}, {"files", {{{"file", "../../escape"}, {"hash", ""}}}}};
      for (const std::string& name : {job.stem + ".lorica", job.stem + ".glb", job.stem + "_parts/1.obj"}) {
        EXPECT_TRUE(writeFileAtomically(made / name, job.item.input + job.name).ok());
        described["files"].push_back({{"file", name}, {"hash", ""}});
      }
      EXPECT_TRUE(*store.publish(job.name, made, described));
    }
    linkResults(collect(jobs, store, false), jobs, out);
    return jobs;
  };
  const auto at = [](const fs::path& file) {
    const Result<std::string> text = readFile(file);
    return text ? *text : "none";
  };
  fs::create_directories(out);
  ASSERT_TRUE(writeFileAtomically(out / "b.glb", "the user's").ok());
  std::vector<BakeItem> items = {{folder.write("x/a.off", "1"), {}}, {folder.write("b.off", "2"), {}}};
  std::vector<BakeJob> jobs = link(items);
  EXPECT_EQ(at(out / "a.lorica"), items[0].input + jobs[0].name);
  EXPECT_EQ(at(out / "a_parts/1.obj"), items[0].input + jobs[0].name);
  EXPECT_EQ(at(out / "b.lorica"), items[1].input + jobs[1].name);
  EXPECT_EQ(at(out / "b.glb"), "the user's");
  EXPECT_FALSE(fs::exists(out / ".." / "escape"));
  folder.write("x/a.off", "changed");
  jobs = link(items);
  EXPECT_EQ(at(out / "a.glb"), items[0].input + jobs[0].name) << "the latest";
  fs::rename(out, folder.path() / "moved");
  EXPECT_EQ(at(folder.path() / "moved" / "a.glb"), items[0].input + jobs[0].name);
  fs::rename(folder.path() / "moved", out);
  items.push_back({folder.write("y/a.off", "3"), {}});
  jobs = link(items);
  EXPECT_EQ(at(out / (jobs[2].name + ".glb")), items[2].input + jobs[2].name);
  EXPECT_EQ(at(out / (jobs[0].name + ".glb")), items[0].input + jobs[0].name);
}

TEST(BakeReport, IsOnePageWithSentencesAndPictures) {
  Baked baked;
  BakeCollection collection = collect(baked.jobs, baked.store, true);
  const std::string page =
      htmlReport(collection, [](const ordered_json&) { return std::string("\x01\x02\x03\x04", 4); });
  expectAll(page, {"<h1>1 baked, 1 failed, 1 not done yet</h1>", "bad.off: line 1: found `&lt;`, expected OFF",
                   "a&lt;b&gt;.off"});
  EXPECT_FALSE(has(page, "a<b>"));
  expectAll(page, {"src=\"data:image/png;base64,AQIDBA==\"", "25.0 %", "<a href=\"items/"});
  EXPECT_FALSE(has(page, "How they spread")) << "of one result there is nothing to spread";
  EXPECT_FALSE(has(page, "http")) << "the page must need nothing else";
  EXPECT_TRUE(has(htmlReport({}, [](const ordered_json&) { return std::string(); }), "0 baked"));
}

}  // namespace
}  // namespace lorica::test
