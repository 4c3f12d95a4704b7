#include "geometry/files.h"

#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

namespace lorica {
namespace {

using test::TemporaryFolder;

std::size_t entriesIn(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(ReadFile, GivesEveryByte) {
  const TemporaryFolder folder;
  std::string content;
  for (int i = 0; i < 100000; ++i) content += static_cast<char>(i * 7);
  const auto read = test::valueOf(readFile(folder.write("bytes", content)));
  EXPECT_EQ(read, content);
  EXPECT_EQ(*readFile(folder.write("empty", "")), "");
}

TEST(ReadFile, MissingFileIsNotFound) {
  const auto read = readFile("/nowhere/at/all.off");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(read.error().message, "/nowhere/at/all.off: cannot be read: No such file or directory");
}

TEST(ReadFile, FolderIsUnreadable) {
  const TemporaryFolder folder;
  const auto read = readFile(folder.path());
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, ErrorCode::kUnreadable);
  EXPECT_EQ(read.error().message, folder.path().string() + ": cannot be read: Is a directory");
}

TEST(WriteFileAtomically, WritesAndReplacesWithoutLeftovers) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "out.bin";
  const std::string large(3'000'000, 'x');
  for (const std::string& content : {std::string("first"), std::string("a\0b", 3), large, std::string()}) {
    ASSERT_TRUE(writeFileAtomically(file, content).ok());
    EXPECT_EQ(*readFile(file), content);
    EXPECT_EQ(entriesIn(folder.path()), 1u);
  }
}

TEST(WriteFileAtomically, KeepsPermissionsOfWhatItReplaces) {
  const TemporaryFolder folder;
  const auto file = folder.write("script", "old");
  const auto mode = std::filesystem::perms::owner_all | std::filesystem::perms::group_read;
  std::filesystem::permissions(file, mode);
  ASSERT_TRUE(writeFileAtomically(file, "new").ok());
  EXPECT_EQ(std::filesystem::status(file).permissions(), mode);
}

TEST(WriteFileAtomically, FailuresSaySoAndLeaveNothing) {
  const TemporaryFolder folder;
  const auto missing = writeFileAtomically(folder.path() / "no" / "out.bin", "x");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kUnwritable);
  EXPECT_EQ(missing.error().message,
            (folder.path() / "no" / "out.bin").string() + ": cannot be written: No such file or directory");

  std::filesystem::create_directory(folder.path() / "sub");
  const auto onFolder = writeFileAtomically(folder.path() / "sub", "x");
  ASSERT_FALSE(onFolder.ok());
  EXPECT_EQ(onFolder.error().message, (folder.path() / "sub").string() + ": cannot be written: Is a directory");
  EXPECT_EQ(entriesIn(folder.path()), 1u);
}

TEST(WriteFileAtomically, DevicesAreNotReplacedByFiles) {
  const auto written = writeFileAtomically("/dev/null", "x");
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().message, "/dev/null: cannot be written: not a regular file");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(WriteFileAtomically, SymbolicLinksStayLinks) {
  const TemporaryFolder folder;
  const auto real = folder.write("real", "old");
  std::filesystem::create_symlink(real, folder.path() / "link");
  ASSERT_TRUE(writeFileAtomically(folder.path() / "link", "new").ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link"));
  EXPECT_EQ(*readFile(real), "new");
}

TEST(WriteFileAtomically, ReadersSeeOldOrNewButNeverAMixture) {
  const TemporaryFolder folder;
  const std::string a(200'000, 'a');
  const std::string b(300'000, 'b');
  const auto file = folder.write("shared", a);
  std::thread writer([&] {
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(writeFileAtomically(file, i % 2 == 0 ? b : a).ok());
  });
  for (int i = 0; i < 50; ++i) {
    const auto content = readFile(file);
    EXPECT_TRUE(content.ok() && (*content == a || *content == b));
  }
  writer.join();
}

TEST(ContentHash, IsXxh3) {
  // Reference values of the XXH3 specification.
  EXPECT_EQ(hexDigits(contentHash("")), "2d06800538d394c2");
  EXPECT_NE(contentHash("", 1), contentHash(""));
  EXPECT_NE(contentHash("a"), contentHash("b"));
  EXPECT_EQ(hexDigits(0), "0000000000000000");
  EXPECT_EQ(hexDigits(0xABCu), "0000000000000abc");
}

TEST(WriteFileAtomically, FollowsALinkOnlyForTheUser) {
  const TemporaryFolder folder;
  const auto target = folder.write("target", "precious");
  const auto link = folder.path() / "link";
  std::filesystem::create_symlink(target, link);
  ASSERT_TRUE(writeFileAtomically(link, "ours", NamedBy::kLorica).ok());
  EXPECT_EQ(*readFile(target), "precious");
  EXPECT_EQ(*readFile(link), "ours");
  EXPECT_FALSE(std::filesystem::is_symlink(link));

  std::filesystem::remove(link);
  std::filesystem::create_symlink(target, link);
  ASSERT_TRUE(writeFileAtomically(link, "theirs").ok());
  EXPECT_EQ(*readFile(target), "theirs");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST(MakeOwnFolder, IsForThisUserAlone) {
  const TemporaryFolder folder;
  const auto own = folder.path() / "a" / "own";
  ASSERT_TRUE(makeOwnFolder(own).ok());
  EXPECT_EQ(std::filesystem::status(own).permissions(), std::filesystem::perms::owner_all);
  EXPECT_TRUE(makeOwnFolder(own).ok()) << "it is there";
  std::filesystem::permissions(own, std::filesystem::perms::all);
  EXPECT_EQ(makeOwnFolder(own).error().message, own.string() + ": everybody may write into it");
  EXPECT_EQ(makeOwnFolder(folder.write("file", "")).error().code, ErrorCode::kUnwritable);
  if (::geteuid() != 0) return;  // only root can make what belongs to another
  std::filesystem::permissions(own, std::filesystem::perms::owner_all);
  ASSERT_EQ(::chown(own.c_str(), 1, 1), 0);
  EXPECT_EQ(makeOwnFolder(own).error().message, own.string() + ": belongs to another user");
}

}  // namespace
}  // namespace lorica
