#include "skinning/import/gltf_types.h"

#include "geometry/errors.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string_view>

namespace lorica {
namespace {

using Json = nlohmann::json;

enum class Kind {
  kSize,       ///< a whole number from 0 on
  kReference,  ///< a whole number; whether that element exists is checked where it is used, but -1 means none in
               ///< tinygltf
  kNumber,
  kText,
  kBool,
};

struct Rule {
  std::string_view path;  ///< keys; * stands for each element or member
  Kind kind;
  bool required = false;  ///< in each object that the path leads to
};

// Properties that are not listed are of no use here or are checked elsewhere. Each list comes with the path of its
// elements, which makes it a list.
constexpr Rule kRules[] = {
    {"scene", Kind::kReference},
    {"bufferViews/*/buffer", Kind::kReference},
    {"bufferViews/*/byteOffset", Kind::kSize},
    {"bufferViews/*/byteLength", Kind::kSize},
    {"bufferViews/*/byteStride", Kind::kSize},
    {"accessors/*/bufferView", Kind::kReference},
    {"accessors/*/byteOffset", Kind::kSize},
    {"accessors/*/componentType", Kind::kReference},
    {"accessors/*/count", Kind::kSize},
    {"accessors/*/type", Kind::kText},
    {"accessors/*/normalized", Kind::kBool},
    {"accessors/*/sparse/count", Kind::kSize},
    {"accessors/*/sparse/indices/bufferView", Kind::kReference},
    {"accessors/*/sparse/indices/byteOffset", Kind::kSize},
    {"accessors/*/sparse/indices/componentType", Kind::kReference},
    {"accessors/*/sparse/values/bufferView", Kind::kReference},
    {"accessors/*/sparse/values/byteOffset", Kind::kSize},
    {"meshes/*/primitives/*/attributes/*", Kind::kReference},
    {"meshes/*/primitives/*/targets/*/*", Kind::kReference},
    {"meshes/*/primitives/*/indices", Kind::kReference},
    {"meshes/*/primitives/*/material", Kind::kReference},
    {"meshes/*/primitives/*/mode", Kind::kReference},
    {"meshes/*/weights/*", Kind::kNumber},
    {"nodes/*/children/*", Kind::kReference},
    {"nodes/*/mesh", Kind::kReference},
    {"nodes/*/skin", Kind::kReference},
    {"nodes/*/matrix/*", Kind::kNumber},
    {"nodes/*/translation/*", Kind::kNumber},
    {"nodes/*/rotation/*", Kind::kNumber},
    {"nodes/*/scale/*", Kind::kNumber},
    {"nodes/*/weights/*", Kind::kNumber},
    {"skins/*/inverseBindMatrices", Kind::kReference},
    {"skins/*/joints/*", Kind::kReference},
    {"animations/*/channels/*/sampler", Kind::kReference, true},
    {"animations/*/channels/*/target/node", Kind::kReference},
    {"animations/*/channels/*/target/path", Kind::kText, true},
    {"animations/*/samplers/*/input", Kind::kReference, true},
    {"animations/*/samplers/*/output", Kind::kReference, true},
    {"animations/*/samplers/*/interpolation", Kind::kText},
    {"scenes/*/nodes/*", Kind::kReference},
};

[[nodiscard]] bool is(const Json& value, Kind kind) {
  switch (kind) {
    case Kind::kSize:
      return value.is_number_unsigned();
    case Kind::kReference:
      return value.is_number_integer() && value != -1;
    case Kind::kNumber:
      return value.is_number();
    case Kind::kText:
      return value.is_string();
    case Kind::kBool:
      return value.is_boolean();
  }
  return false;
}

[[nodiscard]] std::string_view describe(Kind kind) {
  switch (kind) {
    case Kind::kSize:
    case Kind::kReference:
      return "a whole number from 0 on";
    case Kind::kNumber:
      return "a number";
    case Kind::kText:
      return "a text";
    case Kind::kBool:
      return "true or false";
  }
  return {};
}

/// "a text", "0.5": what stands where something else was expected.
[[nodiscard]] std::string found(const Json& value) {
  if (value.is_number()) return value.dump();
  return value.is_string() ? "a text" : value.is_structured() ? std::string("a list or object") : value.dump();
}

/// Follows one rule through the document. @return the first fault, or an empty text
[[nodiscard]] std::string faultOf(const Json& value, std::string_view path, const Rule& rule,
                                  const std::string& place) {
  const auto fault = [&](std::string_view expected) {
    return fmt::format("{}: {}, expected {}", place, found(value), expected);
  };
  if (path.empty()) return is(value, rule.kind) ? std::string() : fault(describe(rule.kind));
  const std::size_t slash = std::min(path.find('/'), path.size());
  const std::string_view key = path.substr(0, slash);
  const std::string_view rest = path.substr(std::min(slash + 1, path.size()));
  if (key == "*") {
    if (!value.is_structured()) return fault("a list or object");
    std::size_t i = 0;
    for (auto it = value.begin(); it != value.end(); ++it, ++i) {
      // The place costs more than the check: it is written when something is wrong.
      if (rest.empty() && is(*it, rule.kind)) continue;
      std::string wrong = faultOf(*it, rest, rule, place + "/" + (value.is_object() ? it.key() : std::to_string(i)));
      if (!wrong.empty()) return wrong;
    }
    return {};
  }
  if (!value.is_object()) return fault("an object");
  const auto member = value.find(key);
  if (member == value.end()) {
    return rest.empty() && rule.required ? fmt::format("{}: has no {}, expected {}", place, key, describe(rule.kind))
                                         : std::string();
  }
  return faultOf(*member, rest, rule, fmt::format("{}/{}", place, key));
}

}  // namespace

Result<void> checkGltfTypes(const Json& document, const std::string& name) {
  for (const Rule& rule : kRules) {
    std::string fault = faultOf(document, rule.path, rule, {});
    if (!fault.empty()) return badFormat("{}: {}", name, fault);
  }
  return {};
}

}  // namespace lorica
