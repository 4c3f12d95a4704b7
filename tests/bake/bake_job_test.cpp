#include "bake/bake_job.h"

#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

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

}  // namespace
}  // namespace lorica::test
