#include "geometry/text.h"
#include "tests/export/robots/outside_readers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Twice the bytes are at most a little more than twice the work, whatever the bytes are. Work is counted in branches of
// our code that are run: clang calls a function of ours at each (-fsanitize-coverage, tools/cmake/LoricaTargets.cmake),
// also in what headers of others bring (nlohmann's JSON), but not in libraries that are linked, as pugixml and libpng.

namespace {

std::uint64_t gWork = 0;

}  // namespace

extern "C" __attribute__((no_sanitize("coverage"))) void __sanitizer_cov_trace_pc_guard(std::uint32_t* /*guard*/) {
  ++gWork;
}
extern "C" void __sanitizer_cov_trace_pc_guard_init(std::uint32_t* /*begin*/, std::uint32_t* /*end*/) {}

namespace lorica::test {
namespace {

constexpr std::size_t kBytes = 10'000;  // of what is put into a file, then twice and four times that
constexpr double kMostGrowth = 3.0;  // of the work that twice the bytes add: sorting takes 2.2 to 2.6, squares take 4
constexpr double kUncounted = 4.0;   // branches a byte that need not be explained

/// What is repeated: as it is, or with a number in place of each #.
constexpr std::array<std::string_view, 45> kRepeated = {"\n",
                                                        " ",
                                                        ",",
                                                        ";",
                                                        "\t",
                                                        "0",
                                                        "9",
                                                        "-",
                                                        "1 ",
                                                        "1,",
                                                        "1;",
                                                        "0,5,",
                                                        "1e",
                                                        "e9",
                                                        "1e9 ",
                                                        "nan,",
                                                        "a",
                                                        "a ",
                                                        "a,",
                                                        "world",
                                                        "head_x,",
                                                        "name#,",
                                                        "name# ",
                                                        "k #\n",
                                                        "o k#\n",
                                                        "f 1 2 3\n",
                                                        "v 0 0 0\n",
                                                        "\"",
                                                        "\\",
                                                        "\\\n",
                                                        "//\n",
                                                        "/*",
                                                        "[",
                                                        "[1],",
                                                        "{\"a\":",
                                                        "\"k#\":1,",
                                                        "\"a\":1,",
                                                        "{\"name\":\"k#\"},",
                                                        "<a>",
                                                        "<a/>",
                                                        "<a b='#'/>",
                                                        "&amp;",
                                                        "JOINT k# {\n",
                                                        "}",
                                                        "property float x#\n"};

/// As many bytes of repeated text, or a few less.
std::string repeated(std::string_view text, std::size_t bytes) {
  const std::size_t number = text.find('#');
  std::string all;
  for (int i = 0;; ++i) {
    const std::string one = number == std::string_view::npos
                                ? std::string(text)
                                : fmt::format("{}{}{}", text.substr(0, number), i, text.substr(number + 1));
    if (all.size() + one.size() > bytes) return all;
    all += one;
  }
}

/// A file into which something is put at a place.
struct SlowFile {
  std::string what;
  std::string_view text;  ///< repeated
  std::size_t at = 0;     ///< in the seed
};

/// In a seed: within its first line, after it, in its middle and at its end what is made to be slow; its own lines, and
/// words of them with what follows, where they are.
std::vector<SlowFile> slowFiles(std::string_view seed) {
  std::vector<SlowFile> files;
  const std::size_t first = std::min(seed.find('\n'), seed.size() - 1) + 1;
  for (const std::string_view text : kRepeated) {
    for (const std::size_t at : {first / 2, first, seed.size() / 2, seed.size()}) {
      files.push_back({fmt::format("{} at byte {}", printable(text), at), text, at});
    }
  }
  std::vector<std::string_view> own;
  for (std::size_t begin = 0; begin < seed.size();) {
    const std::size_t end = std::min(seed.find('\n', begin), seed.size() - 1) + 1;
    own.push_back(seed.substr(begin, end - begin));
    begin = end;
  }
  constexpr std::string_view kBetween = " ,;\t\n{}[]<>";
  for (std::size_t begin = 0; begin < seed.size();) {
    const std::size_t end = std::min(seed.find_first_of(kBetween, begin), seed.size() - 1) + 1;
    own.push_back(seed.substr(begin, end - begin));
    begin = end;
  }
  constexpr std::size_t kOwn = 20;  // of many, some everywhere
  for (std::size_t i = 0; i < own.size(); i += 1 + own.size() / kOwn) {
    const std::size_t at = static_cast<std::size_t>(own[i].data() - seed.data());
    files.push_back({fmt::format("its own {} bytes at byte {}", own[i].size(), at), own[i], at});
  }
  return files;
}

constexpr int kReaders = 18;

class ReaderWork : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { ASSERT_EQ(readers_.size(), std::size_t{kReaders}); }

  /// Of a file with something in it. @param bytes  of that
  [[nodiscard]] double workOf(std::string_view seed, const SlowFile& slow, std::size_t bytes) const {
    std::string file(seed.substr(0, slow.at));
    file += repeated(slow.text, bytes);
    file += seed.substr(slow.at);
    const std::uint64_t before = gWork;
    (void)reader().read(file).ok();
    return static_cast<double>(gWork - before);
  }
  [[nodiscard]] const OutsideReader& reader() const { return readers_[static_cast<std::size_t>(GetParam())]; }

 private:
  TemporaryFolder folder_;
  std::vector<OutsideReader> readers_ = outsideReaders(folder_);
};

TEST_P(ReaderWork, GrowsAsTheBytesDo) {
  const std::vector<std::string>& seeds = reader().seeds;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    for (const SlowFile& slow : slowFiles(seeds[i])) {
      // What is read besides, or is not since the file is refused, is in all of them.
      const double once = workOf(seeds[i], slow, kBytes), twice = workOf(seeds[i], slow, 2 * kBytes);
      const double more = workOf(seeds[i], slow, 4 * kBytes) - twice;
      EXPECT_LE(more, kMostGrowth * std::max(twice - once, 0.0) + kUncounted * kBytes)
          << reader().name << ", seed " << i << ", " << slow.what << ": " << once << " branches, " << twice;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, ReaderWork, testing::Range(0, kReaders));

}  // namespace
}  // namespace lorica::test
