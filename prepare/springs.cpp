#include "prepare/springs.h"

#include "apps/options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lorica {

void addSpringOption(CommandLine& app, std::string& mode) {
  app.addOption("--springs", mode,
                "What the character's hair and clothes do, if its file (VRM) has springs: `file` = collide with the "
                "file's colliders, `body` = with the live hulls of the body and with props, `none` = stay at rest "
                "[default: file, or body if the file has no colliders]")
      ->typeName("MODE")
      ->check(oneOf({"none", "file", "body"}));
}

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

void describeSprings(const SpringBones& springs, Report& report, nlohmann::ordered_json& json) {
  json["springs"] = {{"chains", springs.chains.size()},
                     {"joints", springs.springCount()},
                     {"colliders", springs.colliders.size()},
                     {"constraints", springs.constraints.size()}};
  if (!springs.chains.empty()) {
    report.line("springs", fmt::format("{} with {}, {}", counted(std::ssize(springs.chains), "strand"),
                                       counted(springs.springCount(), "joint"),
                                       counted(std::ssize(springs.colliders), "collider")));
  }
  if (!springs.constraints.empty()) {
    report.line("constraints",
                counted(std::ssize(springs.constraints), "joint follows another", "joints follow others"));
  }
}

}  // namespace lorica
