#include "geometry/files.h"

#include "geometry/arrays/array_file.h"
#include "geometry/byte_reader.h"
#include "geometry/little_endian.h"
#include "geometry/module.h"
#include "geometry/named_file.h"
#include "geometry/new_file.h"
#include "geometry/random_numbers.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace lorica::test {
namespace {

using test::TemporaryFolder;
namespace fs = std::filesystem;

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
  const Error missing = test::errorOf(writeFileAtomically(folder.path() / "no" / "out.bin", "x"));
  EXPECT_EQ(missing.code, ErrorCode::kUnwritable);
  EXPECT_EQ(missing.message,
            (folder.path() / "no" / "out.bin").string() + ": cannot be written: No such file or directory");

  std::filesystem::create_directory(folder.path() / "sub");
  EXPECT_EQ(test::errorOf(writeFileAtomically(folder.path() / "sub", "x")).message,
            (folder.path() / "sub").string() + ": cannot be written: Is a directory");
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
  std::filesystem::permissions(own, std::filesystem::perms::owner_all);
  std::filesystem::permissions(own.parent_path(), std::filesystem::perms::all);
  EXPECT_EQ(checkOwnFolder(own).error().message, own.parent_path().string() + ": everybody may write into it");
  std::filesystem::permissions(own.parent_path(), std::filesystem::perms::all | fs::perms::sticky_bit);
  EXPECT_TRUE(checkOwnFolder(own).ok()) << "as in /tmp, where nobody can rename it";
  EXPECT_EQ(makeOwnFolder(folder.write("file", "")).error().code, ErrorCode::kUnwritable);
  if (::geteuid() != 0) return;  // only root can make what belongs to another
  std::filesystem::permissions(own, std::filesystem::perms::owner_all);
  ASSERT_EQ(::chown(own.c_str(), 1, 1), 0);
  EXPECT_EQ(makeOwnFolder(own).error().message, own.string() + ": belongs to another user");
}

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
  EXPECT_TRUE(test::has(found.error().message, "another program is writing to it"));
  EXPECT_FALSE(createPart(part)) << "it exists";
  close(descriptor);
  EXPECT_TRUE(keepFound(part)) << "that program has ended";
}

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
    test::expectAll(file.error().message, {"is outside the file's folder", "--trust-paths"});
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
    EXPECT_TRUE(
        test::has(test::errorOf(find(std::string("near.txt\0.off", 13), trust)).message, "zero byte after 'near.txt'"));
  }
}

TEST_F(NamedFile, LongNamesAreShownByTheirEnds) {
  const Error file = test::errorOf(find("../" + std::string(100'000, 'x') + "/end.txt"));
  EXPECT_LT(file.message.size(), 300u);
  EXPECT_TRUE(test::has(file.message, "/end.txt'"));
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
  EXPECT_EQ(test::errorOf(readFile(file)).message,
            file.string() + ": 40000000000 bytes, expected at most 268435456 bytes");
  EXPECT_EQ(readFile(folder.write("four", "1234"), NamedBy::kUser, 4).value(), "1234");
  EXPECT_FALSE(readFile(folder.write("five", "12345"), NamedBy::kUser, 4).ok());
}

template <typename T>
std::string bytesOf(std::initializer_list<T> numbers) {
  std::string bytes;
  for (const T number : numbers) appendLittleEndian(number, bytes);
  return bytes;
}

TEST(ByteReader, ReadsNumbersInOrderAndSaysWhatIsLeft) {
  const std::string bytes = bytesOf<std::uint32_t>({7, 0xFFFFFFFFu}) + bytesOf<double>({-0.5}) + "abc";
  ByteReader reader(bytes);
  EXPECT_EQ(reader.take<std::uint32_t>(), 7u);
  EXPECT_EQ(reader.take<std::int32_t>(), -1);
  EXPECT_EQ(reader.take<double>(), -0.5);
  EXPECT_EQ(reader.left(), 3u);
  EXPECT_EQ(reader.takeText(2), "ab");
  EXPECT_EQ(reader.rest(), "c");
  EXPECT_TRUE(reader.ok());
}

TEST(ByteReader, EveryTruncationFailsAtItsByteAndReadsNothingBeyond) {
  const std::string whole = bytesOf<std::uint32_t>({1, 2, 3});
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::vector<char> exact(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    ByteReader reader({exact.data(), exact.size()}, 0, "x");
    for (int i = 0; i < 3; ++i) (void)reader.take<std::uint32_t>("a number");
    EXPECT_FALSE(reader.ok());
    const std::size_t at = length / 4 * 4;
    EXPECT_EQ(reader.error().message, "x: byte " + std::to_string(at) + ": expected a number (4 bytes), " +
                                          std::to_string(length - at) +
                                          (length - at == 1 ? " byte is left" : " bytes are left"));
    EXPECT_EQ(reader.take<std::uint32_t>("another"), 0u) << "after a failure every number is 0";
  }
}

TEST(ByteReader, RangesAndCountsAreChecked) {
  const auto whyNot = [](const std::string& bytes, auto read) {
    ByteReader reader(bytes, 0, "x");
    read(reader);
    return reader.ok() ? std::string() : reader.error().message;
  };
  const auto index = [](ByteReader& r) { (void)r.takeIndex("an index", 0, 5); };
  EXPECT_EQ(whyNot(bytesOf<std::int32_t>({4}), index), "");
  EXPECT_NE(whyNot(bytesOf<std::int32_t>({5}), index), "");
  EXPECT_NE(whyNot(bytesOf<std::int32_t>({-1}), index), "");
  const auto finite = [](ByteReader& r) { (void)r.takeFinite("a length"); };
  EXPECT_EQ(whyNot(bytesOf<double>({1e300}), finite), "");
  EXPECT_NE(whyNot(bytesOf<double>({std::numeric_limits<double>::infinity()}), finite), "");
  // A count whose entries cannot be in the remaining bytes.
  const auto count = [](ByteReader& r) { EXPECT_LE(r.takeCount("the number of points", 8), 1u); };
  EXPECT_EQ(whyNot(bytesOf<std::uint32_t>({1}) + "12345678", count), "");
  EXPECT_NE(whyNot(bytesOf<std::uint32_t>({2}) + "12345678", count), "");
  EXPECT_NE(whyNot(bytesOf<std::uint32_t>({0xFFFFFFFFu}) + "12345678", count), "");
}

TEST(Module, OneThatIsNotThereIsASentence) {
  const Error module = test::errorOf(loadModule("of_that_name_there_is_none", "symbol", "doing this"));
  EXPECT_EQ(module.code, ErrorCode::kUnsupported);
  EXPECT_EQ(module.message.find("doing this needs liblorica_of_that_name_there_is_none.so"), 0u);
  test::expectAll(module.message, {"; install the Debian package lorica", "No such file"});
}

TEST(Module, NamesThePackageOfWhatIsMissing) {
  const auto missing = [](std::string library) { return packageOf(library + ": cannot open shared object file: No"); };
  EXPECT_EQ(missing("libopencv_videoio.so.406"), "libopencv-videoio406");
  EXPECT_EQ(missing("libopenvdb.so.10.0"), "libopenvdb10.0");
  EXPECT_EQ(missing("libIex-3_1.so.30"), "libIex-3-1-30");
  EXPECT_EQ(missing("liblorica_video.so"), "lorica");
  EXPECT_EQ(missing("/somewhere/else"), "");
  EXPECT_EQ(packageOf("liblorica_video.so: file too short"), "");
}

/// A .npy with a header as given.
std::string npy(const std::string& header, const std::string& elements, char version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += {version, '\0'};
  if (version == 1) {
    appendLittleEndian(static_cast<std::uint16_t>(header.size()), bytes);
  } else {
    appendLittleEndian(static_cast<std::uint32_t>(header.size()), bytes);
  }
  return bytes + header + elements;
}
std::string headerOf(const std::string& type, const std::string& shape, const char* fortran = "False") {
  return "{'descr': " + type + ", 'fortran_order': " + fortran + ", 'shape': " + shape + ", }\n";
}

std::string errorOf(std::string_view bytes, const char* file = "x.npy") {
  const std::vector<char> exact(bytes.begin(), bytes.end());
  const Result<std::vector<NamedArray>> read = parseArrays({exact.data(), exact.size()}, file);
  return read ? "" : read.error().message;
}

std::string archiveOf(const std::vector<NamedArray>& arrays) {
  const TemporaryFolder folder;
  const auto file = NewFile::create(folder.path() / "a.npz").value();
  EXPECT_TRUE(writeArrays(arrays, *file).ok());
  EXPECT_TRUE(file->finish().ok());
  return readFile(folder.path() / "a.npz").value();
}

const std::vector<NamedArray>& someArrays() {
  static const std::vector<NamedArray> arrays = {{"depth", "<f4", {3}, bytesOf<float>({0.5F, -1.0F, 2.0F})},
                                                 {"points", "<f8", {1, 2, 1}, bytesOf<double>({0.1, -3e9})},
                                                 {"none", "<i4", {0, 3}, ""},
                                                 {"stands", "|b1", {2}, std::string("\0\1", 2)},
                                                 {"bones", "<U2", {1}, bytesOf<std::uint32_t>({U'a', 0xe9})}};
  return arrays;
}

TEST(ArrayFile, WhatIsWrittenIsReadAndTheSameEachTime) {
  const std::string bytes = archiveOf(someArrays());
  EXPECT_EQ(bytes, archiveOf(someArrays()));
  const std::vector<NamedArray> read = parseArrays(bytes, "a.npz").value();
  ASSERT_EQ(read.size(), someArrays().size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].name, someArrays()[i].name);
    EXPECT_EQ(read[i].type, someArrays()[i].type);
    EXPECT_EQ(read[i].shape, someArrays()[i].shape);
    EXPECT_EQ(read[i].bytes, someArrays()[i].bytes);
  }
}

/// Of numpy 1.24: savez_compressed(points=arange(18, dtype='<f4').reshape(2, 3, 3), frames=int64(2)).
TEST(ArrayFile, WhatNumpyPackedIsRead) {
  const std::vector<NamedArray> arrays = readArrays(sourceFile("tests/fuzz/corpus/arrays/points.npz")).value();
  ASSERT_EQ(arrays.size(), 2U);
  EXPECT_EQ(arrays[0].name, "points");
  EXPECT_EQ(arrays[0].shape, (std::vector<std::size_t>{2, 3, 3}));
  std::vector<double> counted(18);
  for (int i = 0; i < 18; ++i) counted[i] = i;
  EXPECT_EQ(numbersOf(arrays[0]).value(), counted);
  EXPECT_EQ(arrays[1].name, "frames");
  EXPECT_TRUE(arrays[1].shape.empty());
  EXPECT_EQ(numbersOf(arrays[1]).value(), std::vector<double>{2.0});
}

TEST(ArrayFile, NumbersOfEachTypeAreRead) {
  const auto numbers = [](const std::string& bytes) {
    return numbersOf(parseArrays(bytes, "folder/x.npy").value().at(0)).value();
  };
  const std::vector<double> two = {-1.0, 7.0};
  EXPECT_EQ(numbers(npy(headerOf("'<f4'", "(2,)"), bytesOf<float>({-1.0F, 7.0F}))), two);
  EXPECT_EQ(numbers(npy(headerOf("'<f8'", "(2, 1)"), bytesOf<double>({-1.0, 7.0}), 2)), two);
  EXPECT_EQ(numbers(npy(headerOf("'<i4'", "(1,2)"), bytesOf<std::int32_t>({-1, 7}), 3)), two);
  EXPECT_EQ(numbers(npy(headerOf("'<i8'", "(2,)"), bytesOf<std::int64_t>({-1, 7}))), two);
  const NamedArray text = parseArrays(npy(headerOf("'<U1'", "(1,)"), bytesOf<std::uint32_t>({U'a'})), "x.npy")->at(0);
  EXPECT_EQ(text.name, "x");
  EXPECT_EQ(numbersOf(text).error().message, "x: found elements of type '<U1', expected '<f4', '<f8' or whole numbers");
}

TEST(ArrayFile, WhatIsNotReadIsASentence) {
  const std::string four = bytesOf<float>({1.0F});
  EXPECT_EQ(errorOf("no array"), "x.npy: found no array of numpy, expected .npy or .npz");
  EXPECT_EQ(errorOf(npy(headerOf("'>f4'", "(1,)"), four)),
            "x.npy: found elements of type '>f4', expected little-endian numbers such as '<f4'");
  EXPECT_EQ(errorOf(npy(headerOf("'|O'", "(1,)"), four)),
            "x.npy: found elements of type '|O', expected little-endian numbers such as '<f4'");
  EXPECT_EQ(errorOf(npy(headerOf("[('a', '<f4')]", "(1,)"), four)),
            "x.npy: found elements of type [('a', expected little-endian numbers such as '<f4'");
  EXPECT_EQ(errorOf(npy(headerOf("'<f4'", "(1, 1)", "True"), four)),
            "x.npy: found the order of Fortran, expected that of C: numpy.ascontiguousarray()");
  EXPECT_EQ(errorOf(npy(headerOf("'<f4'", "1"), four)),
            "x.npy: found a header without a shape, expected one such as (100, 3)");
  EXPECT_EQ(errorOf(npy(headerOf("'<f4'", "(-1,)"), four)),
            "x.npy: found a header without a shape, expected one such as (100, 3)");
  EXPECT_EQ(errorOf(npy(headerOf("'<f4'", "(2, 3)"), four)),
            "x.npy: found 4 bytes of elements, expected 24 for the shape (2, 3)");
  EXPECT_EQ(errorOf(npy(headerOf("'<f4'", "(4294967296, 4294967297)"), four)),
            "x.npy: found the shape (4294967296, 4294967297), expected at most 1073741824 bytes");
  EXPECT_EQ(errorOf(npy(headerOf("'<f4'", "(1,)"), four, 4)), "x.npy: found version 4 of .npy, expected 1 to 3");
  EXPECT_NE(errorOf("PK\3\4 and nothing else").find("x.npy: its archive is broken: "), std::string::npos);
  std::string renamed = archiveOf(someArrays());
  for (std::size_t at = 0; (at = renamed.find("depth.npy", at)) != std::string::npos;)
    renamed.replace(at, 9, "depth.txt");
  EXPECT_EQ(errorOf(renamed, "a.npz"), "a.npz: depth.txt: found a file in the archive, expected arrays (.npy)");
}

TEST(ArrayFile, EveryTruncatedPrefixFailsCleanly) {
  for (const std::string& whole :
       {npy(headerOf("'<f4'", "(2,)"), bytesOf<float>({1.0F, 2.0F})), archiveOf(someArrays()),
        readFile(sourceFile("tests/fuzz/corpus/arrays/points.npz")).value()}) {
    for (std::size_t length = 0; length < whole.size(); ++length) {
      EXPECT_NE(errorOf(std::string_view(whole).substr(0, length)), "") << length << " of " << whole.size();
    }
    EXPECT_EQ(errorOf(whole), "");
  }
}

TEST(ArrayFile, DamagedBytesAreReadOrRefused) {
  RandomNumbers random(65);
  for (const std::string& whole :
       {archiveOf(someArrays()), readFile(sourceFile("tests/fuzz/corpus/arrays/points.npz")).value()}) {
    for (int i = 0; i < 3000; ++i) {
      std::string damaged = whole;
      for (int n = 0; n < 1 + i % 3; ++n) damaged[random.bits() % damaged.size()] = static_cast<char>(random.bits());
      (void)errorOf(damaged);
    }
  }
}

TEST(ArrayFile, AnArchiveThatUnpacksToTooMuchIsRefused) {
  const std::string bytes = readFile(sourceFile("tests/fuzz/corpus/arrays/points.npz")).value();
  EXPECT_EQ(parseArrays(bytes, "a.npz", 300).error().message,
            "a.npz: unpacks to more than 300 bytes, expected at most that");
}

}  // namespace
}  // namespace lorica::test
