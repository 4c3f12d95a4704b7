#include "skinning/import/collada_check.h"

#include "geometry/errors.h"
#include "skinning/import/file_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <vector>

namespace lorica {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// A start tag: "accessor" and "source="#a" count="4"".
struct Tag {
  std::string_view name;
  std::string_view attributes;
};

[[nodiscard]] Tag tagOf(std::string_view inside) {
  const std::size_t end = std::min(inside.find_first_of(" \t\r\n/"), inside.size());
  std::string_view name = inside.substr(0, end);
  if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) name.remove_prefix(colon + 1);
  return {name, inside.substr(end)};
}

/// An attribute's text; none if the tag lacks it.
[[nodiscard]] std::optional<std::string_view> attribute(const Tag& tag, std::string_view name) {
  for (std::size_t at = tag.attributes.find(name); at != std::string_view::npos;
       at = tag.attributes.find(name, at + 1)) {
    if (at == 0 || kBlanks.find(tag.attributes[at - 1]) == std::string_view::npos) continue;
    std::string_view rest = tag.attributes.substr(at + name.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    if (!rest.starts_with('=')) continue;
    rest.remove_prefix(1);
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    if (rest.empty() || (rest.front() != '"' && rest.front() != '\'')) continue;
    const std::size_t end = rest.find(rest.front(), 1);
    if (end == std::string_view::npos) return std::nullopt;
    return rest.substr(1, end - 1);
  }
  return std::nullopt;
}

[[nodiscard]] std::optional<std::uint64_t> wholeNumber(std::optional<std::string_view> text) {
  if (!text) return std::nullopt;
  std::uint32_t value = 0;  // so that the products below fit into 64 bits
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error != std::errc{} || end != text->data() + text->size()) return std::nullopt;
  return value;
}

class ColladaCheck {
 public:
  ColladaCheck(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  [[nodiscard]] Result<void> run() {
    for (std::size_t open = text_.find('<'); open != std::string_view::npos; open = text_.find('<', open + 1)) {
      if (text_.substr(open).starts_with("<!--")) {
        const std::size_t end = text_.find("-->", open);
        if (end == std::string_view::npos) return {};  // left to assimp to reject
        open = end;
        continue;
      }
      const std::size_t close = text_.find('>', open);
      if (close == std::string_view::npos) return {};
      const Tag tag = tagOf(text_.substr(open + 1, close - open - 1));
      const std::size_t end = std::min(text_.find('<', close), text_.size());
      LORICA_TRY_DO(checkTag(tag, close + 1, end, open));
    }
    return checkAccessors();
  }

 private:
  struct Accessor {
    std::string_view source;
    std::uint64_t end = 0;  ///< one past the last number that it reads
    std::size_t at = 0;
  };

  [[nodiscard]] Error bad(std::size_t at, const std::string& what) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + at, '\n');
    return badFormat("{}: line {}: {}", name_, line, what);
  }

  [[nodiscard]] Result<void> checkTag(const Tag& tag, std::size_t begin, std::size_t end, std::size_t at) {
    constexpr std::array<std::string_view, 5> kWholeNumbers = {"p", "h", "v", "vcount", "int_array"};
    if (std::find(kWholeNumbers.begin(), kWholeNumbers.end(), tag.name) != kWholeNumbers.end()) {
      const std::size_t odd = text_.substr(0, end).find_first_not_of("0123456789+- \t\r\n", begin);
      if (odd != std::string_view::npos) {
        return bad(odd, fmt::format("<{}> contains byte {}, expected whole numbers", tag.name,
                                    static_cast<int>(static_cast<unsigned char>(text_[odd]))));
      }
    }
    if (tag.name == "float_array" || tag.name == "Name_array" || tag.name == "IDREF_array") {
      const std::optional<std::uint64_t> count = wholeNumber(attribute(tag, "count"));
      if (!count) return bad(at, fmt::format("<{}> has no count, expected a whole number", tag.name));
      // Each needs at least one character, with a blank between.
      if (*count > (end - begin + 1) / 2) {
        return bad(at,
                   fmt::format("<{}> declares {} values in {} bytes", tag.name, grouped(*count), grouped(end - begin)));
      }
      if (const auto id = attribute(tag, "id")) counts_[*id] = *count;
    }
    if (tag.name == "accessor") {
      const std::optional<std::string_view> source = attribute(tag, "source");
      const std::optional<std::uint64_t> count = wholeNumber(attribute(tag, "count"));
      const std::optional<std::uint64_t> stride = wholeNumber(attribute(tag, "stride").value_or("1"));
      const std::optional<std::uint64_t> offset = wholeNumber(attribute(tag, "offset").value_or("0"));
      if (!source || !source->starts_with('#') || !count || !stride || !offset) {
        return bad(at, "<accessor> needs a source in this file and whole numbers for count, stride and offset");
      }
      accessors_.push_back({source->substr(1), *offset + *count * *stride, at});
    }
    return {};
  }

  [[nodiscard]] Result<void> checkAccessors() const {
    for (const Accessor& accessor : accessors_) {
      const auto array = counts_.find(accessor.source);
      if (array == counts_.end()) {
        return bad(accessor.at, fmt::format("<accessor> reads from '{}', which does not exist", accessor.source));
      }
      if (accessor.end > array->second) {
        return bad(accessor.at, fmt::format("<accessor> reads {} values of '{}', which has {}", grouped(accessor.end),
                                            accessor.source, grouped(array->second)));
      }
    }
    return {};
  }

  std::string_view text_;
  const std::string& name_;
  std::map<std::string_view, std::uint64_t> counts_;  // number of values of each array, by its id
  std::vector<Accessor> accessors_;
};

}  // namespace

Result<void> checkCollada(std::string_view text, const std::string& name) {
  return ColladaCheck(text, name).run();
}

}  // namespace lorica
