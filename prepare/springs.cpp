#include "prepare/springs.h"

namespace lorica {

std::optional<SpringChoice> chooseSprings(const Subject& subject, const std::string& mode) {
  if (!subject.file || subject.file->springs.empty()) return std::nullopt;
  const SpringBones& springs = subject.file->springs;
  SpringChoice choice{springs, springModeNamed(mode).value_or(usualSpringMode(springs))};
  if (choice.mode == SpringMode::kNone && springs.constraints.empty()) return std::nullopt;
  return choice;
}

}  // namespace lorica
