// What `lorica bake` reads of others: lists of inputs, and the descriptions of results in its folder. The first byte
// says which. Names of files cannot leave an empty folder.
#include "export/bake/bake_list.h"
#include "export/bake/bake_store.h"
#include "geometry/errors.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace {

using namespace lorica;

/// A folder of this process.
const std::filesystem::path& folder() {
  static const std::filesystem::path made = [] {
    std::string name = std::filesystem::temp_directory_path() / "lorica_fuzz_XXXXXX";
    LORICA_CHECK(::mkdtemp(name.data()) != nullptr, "no folder for files");
    return std::filesystem::path(name);
  }();
  return made;
}

void describe(const std::string& content) {
  const BakeStore store(folder());
  std::filesystem::create_directories(store.folderOf("item"));
  std::ofstream(store.folderOf("item") / kBakeDescription, std::ios::binary) << content;
  const auto description = store.describe("item");
  if (!description) {
    LORICA_CHECK(description.error().message.starts_with(folder().string()), "an error that does not name the file");
    return;
  }
  (void)store.damageOf("item", *description);
  // What the report reads of it.
  (void)description->value("failure", "");
  (void)description->value("seconds", 0.0);
  (void)description->dump();
}

void list(const std::string& ending, std::string content) {
  std::replace(content.begin(), content.end(), '/', '_');
  for (std::size_t at = 0; (at = content.find("..", at)) != std::string::npos;) content[at] = '_';
  const std::string file = folder() / ("list" + ending);
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
    describe(content);
  }
  return 0;
}
