#include "prepare/host.h"

namespace lorica {

CharacterFileSettings Host::characterFiles(std::vector<std::string> hidden) const {
  CharacterFileSettings settings;
  settings.hidden = std::move(hidden);
  settings.paths = paths;
  settings.isolated = reader;
  if (settings.isolated) settings.isolated->cancelled = [this] { return cancelled(); };
  return settings;
}

}  // namespace lorica
