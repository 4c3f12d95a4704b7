#include "geometry/named_file.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <filesystem>
#include <string>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// A folder with a file in it, in one below, and outside; and links between them.
class NamedFile : public testing::Test {
 protected:
  NamedFile() {
    fs::create_directories(folder.path() / "own/below");
    (void)folder.write("own/near.txt", "near");
    (void)folder.write("own/below/deep.txt", "deep");
    (void)folder.write("secret.txt", "secret");
    (void)folder.write("owner.txt", "beside a folder whose name begins alike");
    fs::create_symlink(folder.path() / "secret.txt", folder.path() / "own/link_out.txt");
    fs::create_symlink("below/deep.txt", folder.path() / "own/link_in.txt");
    fs::create_symlink(folder.path(), folder.path() / "own/folder_out");
    fs::create_symlink("loop", folder.path() / "own/loop");
  }
  [[nodiscard]] Result<fs::path> find(const std::string& name, PathTrust trust = PathTrust::kBeneath) const {
    return NamedFiles{folder.path() / "own", trust}.find(name);
  }

  const test::TemporaryFolder folder;
};

TEST_F(NamedFile, FilesInTheFolderAndBelowAreFound) {
  for (const auto& [name, content] :
       {std::pair("near.txt", "near"), std::pair("./near.txt", "near"), std::pair("below/deep.txt", "deep"),
        std::pair("below\\deep.txt", "deep"), std::pair("link_in.txt", "deep")}) {
    const fs::path file = test::valueOf(find(name));
    EXPECT_EQ(readFile(file, NamedBy::kFile).value(), content);
  }
  EXPECT_TRUE(find("not there.txt").ok()) << "whether it exists is for the reader to say";
}

TEST_F(NamedFile, WhatLeadsOutIsRefusedWithTheOptionThatAllowsIt) {
  const std::string absolute = (folder.path() / "own/near.txt").string();
  for (const std::string& name :
       {std::string("../secret.txt"), std::string("below/../../secret.txt"), std::string("below/../near.txt"),
        std::string("..\\secret.txt"), absolute, std::string("~/near.txt"), std::string("C:/near.txt"),
        std::string("file:near.txt"), std::string(), std::string("link_out.txt"), std::string("folder_out/secret.txt"),
        std::string("../owner.txt")}) {
    const Result<fs::path> file = find(name);
    ASSERT_FALSE(file.ok()) << name;
    EXPECT_NE(file.error().message.find("is outside the file's folder"), std::string::npos) << file.error().message;
    EXPECT_NE(file.error().message.find("--trust-paths"), std::string::npos);
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
  }
  EXPECT_FALSE(find("loop").ok());
}

TEST_F(NamedFile, TrustedNamesMayLeadAnywhere) {
  for (const std::string& name : {std::string("../secret.txt"), std::string("link_out.txt"),
                                  (folder.path() / "secret.txt").string(), std::string("..\\secret.txt")}) {
    const fs::path file = test::valueOf(find(name, PathTrust::kAnywhere));
    EXPECT_EQ(readFile(file, NamedBy::kFile).value(), "secret");
  }
}

TEST_F(NamedFile, AZeroByteIsRefusedEvenIfTrusted) {
  for (const PathTrust trust : {PathTrust::kBeneath, PathTrust::kAnywhere}) {
    const Result<fs::path> file = find(std::string("near.txt\0.off", 13), trust);
    ASSERT_FALSE(file.ok());
    EXPECT_NE(file.error().message.find("zero byte after 'near.txt'"), std::string::npos) << file.error().message;
  }
}

TEST_F(NamedFile, LongNamesAreShownByTheirEnds) {
  const Result<fs::path> file = find("../" + std::string(100'000, 'x') + "/end.txt");
  ASSERT_FALSE(file.ok());
  EXPECT_LT(file.error().message.size(), 300u);
  EXPECT_NE(file.error().message.find("/end.txt'"), std::string::npos);
}

TEST(ReadFileNamedByAFile, OnlyRegularFilesAreRead) {
  const test::TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe.obj";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto sentence = [](const fs::path& file) {
    const Result<std::string> read = readFile(file, NamedBy::kFile);
    return read ? "read" : read.error().message;
  };
  EXPECT_EQ(sentence(pipe), pipe.string() + ": cannot be read: found a named pipe, expected a file");
  EXPECT_EQ(sentence("/dev/zero"), "/dev/zero: cannot be read: found a device, expected a file");
  EXPECT_EQ(sentence(folder.path()), folder.path().string() + ": cannot be read: Is a directory");
}

TEST(ReadFile, WhatIsTooLargeIsNotRead) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.write("sparse.off", "OFF\n");
  fs::resize_file(file, std::uintmax_t{40'000'000'000});
  const Result<std::string> read = readFile(file);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().message, file.string() + ": 40000000000 bytes, expected at most 268435456 bytes");
  EXPECT_EQ(readFile(folder.write("four", "1234"), NamedBy::kUser, 4).value(), "1234");
  EXPECT_FALSE(readFile(folder.write("five", "12345"), NamedBy::kUser, 4).ok());
}

}  // namespace
}  // namespace lorica
