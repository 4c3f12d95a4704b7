#include "geometry/json.h"

#include <algorithm>
#include <array>

namespace lorica {

Result<void> checkJson(std::string_view text, const JsonLimits& limits) {
  constexpr int kMaxLevels = 64;
  std::array<std::size_t, kMaxLevels + 1> members{};  // of the object that is open at each level
  const int levels = std::min(limits.levels, kMaxLevels);
  const std::size_t mostHolders = std::max(limits.holders, text.size() / 8);
  std::size_t holders = 0;
  int level = 0;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
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

}  // namespace lorica
