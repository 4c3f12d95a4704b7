#include "bake/bake_report.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Three items: two results and one that is not done; of these one failed.
struct Baked {
  TemporaryFolder folder;
  FileLayer files;
  BakeStore store{files, folder.path() / "out", [](std::chrono::milliseconds) {}};
  std::vector<BakeJob> jobs;

  Baked() {
    std::vector<BakeItem> items;
    for (const char* name : {"a<b>.off", "bad.off", "later.off"}) items.push_back({folder.write(name, name), {}});
    jobs = bakeJobs(items);
    publish(0, {{"parts", 5}, {"score", 0.8}, {"error", 0.25}, {"seconds", 2.0}}, "content");
    publish(1, {{"failure", "bad.off: line 1: found `<`, expected OFF"}, {"seconds", 0.1}}, "");
  }
  void publish(std::size_t job, ordered_json description, const std::string& content) {
    const fs::path made = *store.begin(jobs[job].name, 0);
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
  FileLayer files;
  const fs::path out = folder.path() / "out";
  BakeStore store(files, out, [](std::chrono::milliseconds) {});
  const auto link = [&](const std::vector<BakeItem>& items) {
    const std::vector<BakeJob> jobs = bakeJobs(items);
    for (const BakeJob& job : jobs) {
      if (store.has(job.name)) continue;
      const fs::path made = *store.begin(job.name, 0);
      fs::create_directories(made / (job.stem + "_parts"));
      ordered_json described = {{"item", job.name}, {"files", {{{"file", "../../escape"}, {"hash", ""}}}}};
      for (const std::string& name : {job.stem + ".lorica", job.stem + ".glb", job.stem + "_parts/1.obj"}) {
        EXPECT_TRUE(writeFileAtomically(made / name, job.item.input + job.name).ok());
        described["files"].push_back({{"file", name}, {"hash", ""}});
      }
      EXPECT_TRUE(*store.publish(job.name, made, described));
    }
    linkResults(collect(jobs, store, false), jobs, store);
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
  EXPECT_NE(page.find("<h1>1 baked, 1 failed, 1 not done yet</h1>"), std::string::npos);
  EXPECT_NE(page.find("bad.off: line 1: found `&lt;`, expected OFF"), std::string::npos);
  EXPECT_NE(page.find("a&lt;b&gt;.off"), std::string::npos);
  EXPECT_EQ(page.find("a<b>"), std::string::npos);
  EXPECT_NE(page.find("src=\"data:image/png;base64,AQIDBA==\""), std::string::npos);
  EXPECT_NE(page.find("25.0 %"), std::string::npos);
  EXPECT_NE(page.find("<a href=\"items/"), std::string::npos);
  EXPECT_EQ(page.find("How they spread"), std::string::npos) << "of one result there is nothing to spread";
  EXPECT_EQ(page.find("http"), std::string::npos) << "the page must need nothing else";
  EXPECT_NE(htmlReport({}, [](const ordered_json&) { return std::string(); }).find("0 baked"), std::string::npos);
}

}  // namespace
}  // namespace lorica::test
