// What `lorica bake` reads of others: lists of inputs, and the descriptions of results in its folder. The first byte
// says which. Names of files cannot leave an empty folder.
#include "bake/bake_list.h"
#include "bake/bake_store.h"
#include "geometry/errors.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace {

using namespace lorica;

/// A shared folder that holds one file.
class OneFile final : public FileLayer {
 public:
  explicit OneFile(std::string content) : content_(std::move(content)) {}
  [[nodiscard]] Result<std::string> read(const std::filesystem::path& /*file*/) override { return content_; }

 private:
  std::string content_;
};

void describe(std::string content) {
  OneFile files(std::move(content));
  BakeStore store(files, "fuzz", [](std::chrono::milliseconds) {});
  const auto description = store.describe("item");
  if (!description) {
    LORICA_CHECK(description.error().message.starts_with("fuzz"), "an error that does not name the file");
    return;
  }
  // What the report reads of it.
  (void)description->value("failure", "");
  (void)description->value("seconds", 0.0);
  (void)description->dump();
}

void list(const std::string& ending, std::string content) {
  static const std::filesystem::path folder = [] {
    std::string name = std::filesystem::temp_directory_path() / "lorica_fuzz_XXXXXX";
    LORICA_CHECK(::mkdtemp(name.data()) != nullptr, "no folder for lists");
    return std::filesystem::path(name);
  }();
  std::replace(content.begin(), content.end(), '/', '_');
  for (std::size_t at = 0; (at = content.find("..", at)) != std::string::npos;) content[at] = '_';
  const std::string file = folder / ("list" + ending);
  std::ofstream(file, std::ios::binary) << content;
  const std::array<std::string, 1> lists = {file};
  const Result<std::vector<BakeItem>> items = readBakeLists(lists, {});
  if (!items) LORICA_CHECK(!items.error().message.empty(), "an error without a sentence");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::array<std::string, 3> endings = {".csv", ".jsonl", ".txt"};
  if (size == 0) return 0;
  std::string content(reinterpret_cast<const char*>(data + 1), size - 1);
  const std::size_t kind = data[0] % 4;
  if (kind < endings.size()) {
    list(endings[kind], std::move(content));
  } else {
    describe(std::move(content));
  }
  return 0;
}
