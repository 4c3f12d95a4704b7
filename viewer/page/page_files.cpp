#include "viewer/page/page_files.h"

#include <array>

namespace lorica {

std::span<const std::uint8_t> indexPageFile();
std::span<const std::uint8_t> stylePageFile();
std::span<const std::uint8_t> scriptPageFile();
std::span<const std::uint8_t> licencesPageFile();

namespace {

constexpr std::string_view kNotBuilt =
    "<!doctype html><html lang=\"en\"><title>Lorica</title><h1>Lorica</h1>"
    "<p>This Lorica was built without its page, which needs node and npm: run <code>scripts/setup --page</code> and "
    "build again. Programs can watch at <code>/live</code>, see docs/WIRE.md.</p></html>\n";

std::span<const std::uint8_t> notBuilt() {
  return {reinterpret_cast<const std::uint8_t*>(kNotBuilt.data()), kNotBuilt.size()};
}

}  // namespace

bool pageBuilt() {
  return !scriptPageFile().empty();
}

const PageFile* pageFile(std::string_view path) {
  constexpr std::string_view kHtml = "text/html; charset=utf-8";
  static const std::array<PageFile, 4> files = {{{"/", kHtml, pageBuilt() ? indexPageFile() : notBuilt()},
                                                 {"/page.css", "text/css; charset=utf-8", stylePageFile()},
                                                 {"/page.js", "text/javascript; charset=utf-8", scriptPageFile()},
                                                 {"/licences.txt", "text/plain; charset=utf-8", licencesPageFile()}}};
  for (const PageFile& file : files) {
    if (file.path == path && !file.bytes.empty()) return &file;
  }
  return nullptr;
}

}  // namespace lorica
