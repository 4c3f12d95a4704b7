#include "prepare/springs.h"


#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lorica {

std::optional<SpringChoice> chooseSprings(const Subject& subject, const std::string& mode) {
  if (!subject.file || subject.file->springs.empty()) return std::nullopt;
  const SpringBones& springs = subject.file->springs;
  SpringChoice choice{springs, springModeNamed(mode).value_or(usualSpringMode(springs))};
  if (choice.mode == SpringMode::kNone && springs.constraints.empty()) return std::nullopt;
  return choice;
}

Result<void> addSprings(const std::optional<SpringChoice>& choice, Session& session, int avatar) {
  return choice ? session.setSprings(choice->springs, choice->mode, avatar) : Result<void>();
}

}  // namespace lorica
