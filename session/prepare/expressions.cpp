#include "session/prepare/expressions.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "geometry/errors.h"

namespace lorica {

Result<std::vector<float>> chosenExpressions(const Expressions& expressions, std::span<const std::string> given,
                                             const std::string& input) {
  std::vector<float> weights(expressions.list.size(), 0.0F);
  for (const std::string& one : given) {
    const auto bad = [&](const std::string& what) { return invalidArgument("--expression {}: {}", one, what); };
    const std::size_t equals = one.rfind('=');
    if (equals == std::string::npos) return bad("expected a name and a weight, such as Joy=1");
    float weight = 0.0F;
    const char* end = one.data() + one.size();
    const auto [stopped, problem] = std::from_chars(one.data() + equals + 1, end, weight);
    if (problem != std::errc() || stopped != end || !(weight >= 0.0F && weight <= 1.0F)) {
      return bad("expected a weight from 0 to 1");
    }
    const std::string name = one.substr(0, equals);
    const std::optional<std::size_t> index = findExpression(expressions, name);
    if (!index && expressions.list.empty()) return bad(fmt::format("{} has no expressions", input));
    if (!index)
      return bad(fmt::format("{} has no expression {}, expected one of {}", input, name, namesOf(expressions)));
    weights[*index] = weight;
  }
  return weights;
}

}  // namespace lorica
