#include "serve/vrm_licence.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

std::string member(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

std::string vrmLicence(const Json& document) {
  const auto extensions = document.find("extensions");
  if (extensions == document.end() || !extensions->is_object()) return "";
  for (const char* extension : {"VRMC_vrm", "VRM"}) {
    const auto vrm = extensions->find(extension);
    if (vrm == extensions->end() || !vrm->is_object()) continue;
    const auto meta = vrm->find("meta");
    if (meta == vrm->end() || !meta->is_object()) continue;
    if (std::string_view(extension) == "VRM") {
      if (member(*meta, "licenseName") == "Redistribution_Prohibited") {
        return "its licence does not let it be given to others, and whoever opens the page gets it";
      }
    } else {
      const auto allowed = meta->find("allowRedistribution");
      const bool given = allowed != meta->end() && allowed->is_boolean() && allowed->get<bool>();
      if (!given) return "its licence does not say that it may be given to others, and whoever opens the page gets it";
    }
  }
  return "";
}

}  // namespace lorica
