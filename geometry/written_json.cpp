#include "geometry/written_json.h"

#include "geometry/json.h"
#include "geometry/line_scanner.h"

#include <fmt/format.h>

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
