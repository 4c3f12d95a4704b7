#include "geometry/new_file.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace lorica {
namespace {

namespace fs = std::filesystem;

TEST(PartFile, NothingFoundIsNothing) {
  const test::TemporaryFolder folder;
  const auto found = test::valueOf(keepFound(folder.path() / "a.part.csv"));
  EXPECT_FALSE(found.has_value());
}

TEST(PartFile, FoundOnesAreKeptUnderFreeNames) {
  const test::TemporaryFolder folder;
  folder.write("a.found-2.csv", "mine");
  for (const auto& [content, name] :
       {std::pair("one", "a.found-1.csv"), std::pair("two", "a.found-3.csv"), std::pair("three", "a.found-4.csv")}) {
    const auto found = test::valueOf(keepFound(folder.write("a.part.csv", content)));
    EXPECT_EQ(found, folder.path() / name);
    EXPECT_EQ(readFile(folder.path() / name).value(), content);
    EXPECT_FALSE(fs::exists(folder.path() / "a.part.csv"));
  }
  EXPECT_EQ(readFile(folder.path() / "a.found-2.csv").value(), "mine");
}

TEST(PartFile, OneThatIsWrittenIsLeftAlone) {
  const test::TemporaryFolder folder;
  const fs::path part = folder.path() / "a.part.csv";
  const int descriptor = test::valueOf(createPart(part));
  const auto found = keepFound(part);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("another program is writing to it"), std::string::npos) << found.error().message;
  EXPECT_FALSE(createPart(part)) << "it exists";
  close(descriptor);
  EXPECT_TRUE(keepFound(part)) << "that program has ended";
}

}  // namespace
}  // namespace lorica
