

#include <utility>

namespace lorica {
namespace {

PathTrust gTrust = PathTrust::kBeneath;

}  // namespace

void trustPaths() {
  gTrust = PathTrust::kAnywhere;
}

PathTrust pathTrust() {
  return gTrust;
}

CharacterFileSettings characterFileSettings(std::vector<std::string> hidden) {
  CharacterFileSettings settings;
  settings.hidden = std::move(hidden);
  settings.paths = gTrust;
  // The file of this program may have been replaced or moved since it was started; this name still leads to it.
  settings.isolated = IsolatedReader{"/proc/self/exe", {std::string(kReadForItself)}, interrupted};
  return settings;
}

}  // namespace lorica
