#include "prepare/decomposition_cache.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// A box, whose topology does not depend on its size.
TriMesh box(double width) {
  return test::makeBox(Vec3::Zero(), Vec3(width, 1.0, 1.0));
}

class Cache : public testing::Test {
 protected:
  CachedDecomposition get(const TriMesh& mesh) {
    Result<CachedDecomposition> made =
        meshDecomposition("box", mesh, DecomposeSettings(),
                          {folder.path() / "c", [this](const std::string& sentence) { warnings.push_back(sentence); }});
    EXPECT_TRUE(made) << made.error().message;
    return std::move(made).value();
  }
  [[nodiscard]] std::vector<fs::path> entries() const {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path() / "c")) files.push_back(entry.path());
    return files;
  }
  test::TemporaryFolder folder;
  std::vector<std::string> warnings;
};

TEST_F(Cache, AnEntryIsUsedAgain) {
  EXPECT_FALSE(get(box(1.0)).fromCache);
  EXPECT_TRUE(get(box(1.0)).fromCache);
  EXPECT_FALSE(get(box(2.0)).fromCache);
  EXPECT_EQ(entries().size(), 2u);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
}

TEST_F(Cache, AValidEntryOfAnotherKeyIsNotUsed) {
  (void)get(box(1.0));
  const fs::path one = entries().front();
  const std::string first = readFile(one).value();
  (void)get(box(2.0));
  for (const fs::path& file : entries()) {
    if (file == one) continue;
    ASSERT_TRUE(writeFileAtomically(file, first));
  }
  EXPECT_FALSE(get(box(2.0)).fromCache) << "it has the same triangles, but other hulls";
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("does not begin with 'lorica cache entry"), std::string::npos) << warnings[0];
  EXPECT_TRUE(get(box(2.0)).fromCache) << "it was replaced";
}

TEST_F(Cache, EveryCutOffEntryIsReplaced) {
  (void)get(box(1.0));
  const fs::path file = entries().front();
  const std::string whole = readFile(file).value();
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{5}, std::size_t{36}, std::size_t{60}, whole.size() - 1}) {
    ASSERT_TRUE(writeFileAtomically(file, whole.substr(0, length)));
    EXPECT_FALSE(get(box(1.0)).fromCache) << length;
    EXPECT_EQ(readFile(file).value(), whole) << length;
  }
  EXPECT_EQ(warnings.size(), 5u);
}

TEST_F(Cache, ALinkIsReplacedAndAForeignFolderNotUsed) {
  (void)get(box(1.0));
  const fs::path file = entries().front();
  const fs::path target = folder.write("target", "precious");
  fs::remove(file);
  fs::create_symlink(target, file);
  EXPECT_FALSE(get(box(1.0)).fromCache);
  EXPECT_EQ(readFile(target).value(), "precious");
  EXPECT_FALSE(fs::is_symlink(file));
  EXPECT_TRUE(get(box(1.0)).fromCache);

  warnings.clear();
  fs::permissions(folder.path() / "c", fs::perms::all);
  EXPECT_FALSE(get(box(2.0)).fromCache);
  EXPECT_FALSE(get(box(2.0)).fromCache);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("everybody may write into it; what was computed is not cached"), std::string::npos);
}

}  // namespace
}  // namespace lorica
