#include "prepare/cover.h"

#include "geometry/counts.h"
#include "geometry/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lorica {
namespace {

// In heights of the character. A smaller tolerance would select most points one by one, in half a minute or more.
constexpr double kLargestTolerance = 0.1;
constexpr double kSmallestTolerance = 1e-4;

}  // namespace

Result<void> checkCover(const CoverRequest& request, const Character& character) {
  if (request.tolerance && *request.tolerance == 0.0 && request.hullVertices > 0) {
    return invalidArgument("--cover exact and --hull-vertices {} exclude each other, expected only one of them",
                           request.hullVertices);
  }
  const double max = kLargestTolerance * character.height;
  const double min = kSmallestTolerance * character.height;
  if (request.tolerance && *request.tolerance > 0.0 && *request.tolerance < min) {
    return invalidArgument("--cover: found {:g} m, expected exact, or at least {:.2g} m (0.01 % of the height of {})",
                           *request.tolerance, min, character.name);
  }
  if (request.tolerance && *request.tolerance > max) {
    return invalidArgument("--cover: found {:g} m, expected at most {:.3g} m (10 % of the height of {})",
                           *request.tolerance, max, character.name);
  }
  return {};
}

std::string asTyped(const CoverRequest& request) {
  std::string text;
  if (request.tolerance) text = fmt::format("--cover {:g}", *request.tolerance);
  if (request.hullVertices > 0) {
    text += fmt::format("{}--hull-vertices {}", text.empty() ? "" : " ", request.hullVertices);
  }
  return text;
}

Result<HullCover> chooseCoverWithProgress(const Character& character, const Decomposition& decomposition,
                                          const CoverPoses& poses, const CoverRequest& request, Host& host) {
  Task task(host, "Choosing a hull cover for " + character.name, "parts");
  task.update(0, countOf(decomposition.parts));
  Result<HullCover> cover = chooseCover(character, decomposition, poses, request, host.threads, task.progress());
  if (host.cancelled()) return cancelled();
  if (!cover && cover.error().code == ErrorCode::kInvalidArgument) {
    return invalidArgument(asTyped(request) + ": " + cover.error().message);
  }
  return cover;
}

}  // namespace lorica
