#include "geometry/json.h"

#include "geometry/interrupt.h"
#include "geometry/line_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxWrittenLevels = 16;
constexpr std::size_t kShownKey = 40;  // bytes of a key in a message

/// Walks through a text and stops at what JSON allows but parseWrittenJson() does not.
class WrittenJsonWatch : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return next(); }
  bool boolean(bool /*value*/) override { return next(); }
  bool number_integer(std::int64_t /*value*/) override { return next(); }
  bool number_unsigned(std::uint64_t /*value*/) override { return next(); }
  bool number_float(double /*value*/, const std::string& /*text*/) override { return next(); }
  bool string(std::string& /*value*/) override { return next(); }
  bool binary(Json::binary_t& /*value*/) override { return next(); }
  bool start_object(std::size_t /*size*/) override { return open(false); }
  bool start_array(std::size_t /*size*/) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(std::string& name) override {
    open_.back().key = name;
    if (!open_.back().keys.insert(name).second) error_ = path() + ": found twice in one object, expected once";
    return error_.empty();
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  struct Open {
    bool list = false;
    int index = -1;
    std::string key;
    std::set<std::string> keys;
  };
  bool next() {
    if (!open_.empty() && open_.back().list) ++open_.back().index;
    return true;
  }
  bool open(bool list) {
    if (open_.size() >= kMaxWrittenLevels) {
      error_ = fmt::format("{}: lists and objects are nested more than {} levels deep", path(), kMaxWrittenLevels);
      return false;
    }
    next();
    open_.push_back({list, -1, {}, {}});
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }
  [[nodiscard]] std::string path() const {
    std::string path;
    for (const Open& open : open_) {
      if (open.list) {
        if (open.index >= 0) path += fmt::format("[{}]", open.index);
      } else {
        if (!path.empty()) path += '.';
        path += open.key.substr(0, kShownKey);
      }
    }
    return path;
  }

  std::vector<Open> open_;
  std::string error_;
};

}  // namespace

Result<void> checkJson(std::string_view text, const JsonLimits& limits) {
  constexpr int kMaxLevels = 64;
  std::array<std::size_t, kMaxLevels + 1> members{};  // of the object that is open at each level
  const int levels = std::min(limits.levels, kMaxLevels);
  const std::size_t mostHolders = std::max(limits.holders, text.size() / 8);
  std::size_t holders = 0;
  int level = 0;
  bool inString = false;
  if (workStopped()) return cancelled();
  SparseInterrupt interrupt;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (interrupt.stopped()) return cancelled();
    const char c = text[i];
    if (inString) {
      if (c == '\\') ++i;
      if (c == '"') inString = false;
    } else if (c == '"') {
      inString = true;
      ++holders;
    } else if (text.substr(i, 2) == "//") {  // in a comment quotes mean nothing
      i = std::min(text.find('\n', i), text.size());
    } else if (text.substr(i, 2) == "/*") {
      i = std::min(text.find("*/", i + 2), text.size() - 1) + 1;
    } else if (c == '[' || c == '{') {
      if (++level > levels) return badFormat("its JSON nests deeper than {} levels", levels);
      members[level] = 0;
      ++holders;
    } else if ((c == ']' || c == '}') && level > 0) {
      --level;
    } else if (c == ':') {
      if (holders > 0) --holders;  // what came before was the member's name
      if (++members[level] > limits.members) {
        return badFormat("its JSON has an object of more than {} members", limits.members);
      }
    }
  }
  if (holders > mostHolders) return badFormat("its JSON has more than {} lists, objects and texts", mostHolders);
  return {};
}

Result<Json> parseWrittenJson(std::string_view text, std::string_view name) {
  LORICA_TRY_DO(prefixed(name, checkJson(text, kOrderedJson)));
  try {
    WrittenJsonWatch watch;
    Json::sax_parse(text, &watch, nlohmann::detail::input_format_t::json, true, true);
    if (!watch.error().empty()) return badFormat("{}: {}", name, watch.error());
    return Json::parse(text, nullptr, true, true);
  } catch (const Json::exception& problem) {
    return badFormat("{}: {}", name, notJson(problem.what()));
  }
}

}  // namespace lorica
