#include "viewer/page/client_message.h"

#include "geometry/json.h"
#include "session/world_action.h"
#include "viewer/page/wire.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace lorica {
namespace {

using Json = nlohmann::json;
using Kind = ClientMessage::Kind;

constexpr double kSmallest = 1e-6;      // length of a direction
constexpr double kLongestClock = 1e11;  // [s]
constexpr double kLongest = 1e6;        // of a vector
constexpr double kLargestValue = 1e6;   // of a control; seconds of a recording, among others
constexpr const char* kHands = "0 or 1";
constexpr const char* kPosition = "three numbers from -1,000 to 1,000";

Error expected(const char* type, const char* member, const char* what) {
  return badFormat("message {}: its {} is not {}", type, member, what);
}

const Json* member(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found == json.end() ? nullptr : &*found;
}

template <typename Vector>
bool readNumbers(const Json* from, double largest, Vector& v) {
  if (from == nullptr || !from->is_array() || from->size() != static_cast<std::size_t>(v.size())) return false;
  for (int c = 0; c < v.size(); ++c) {
    if (!(*from)[c].is_number()) return false;
    v[c] = (*from)[c].get<double>();
    if (!(std::abs(v[c]) <= largest)) return false;
  }
  return true;
}

/// Left out: the first one.
bool readHand(const Json& json, Change& change) {
  const Json* hand = member(json, "hand");
  if (hand == nullptr) return true;
  if (!hand->is_number_unsigned() || hand->get<std::uint64_t>() >= kClientHands) return false;
  change.hand = hand->get<int>();
  return true;
}

bool readDirection(const Json* from, Vec3& v) {
  if (!readNumbers(from, kLongest, v) || v.norm() < kSmallest) return false;
  v.normalize();
  return true;
}

Result<void> readPose(const Json& json, const char* type, Isometry3& pose) {
  Vec3 position;
  Quat turned;
  if (!readNumbers(member(json, "position"), kFarthestPosition, position)) {
    return expected(type, "position", kPosition);
  }
  if (!readNumbers(member(json, "orientation"), 1.001, turned.coeffs()) || turned.norm() < 0.5) {
    return expected(type, "orientation", "a quaternion");
  }
  pose = Eigen::Translation3d(position) * turned.normalized();
  return {};
}

Result<void> readSet(const Json& json, Change& change) {
  const Json& name = json["set"];
  const Control* control = name.is_string() ? controlNamed(name.get_ref<const std::string&>()) : nullptr;
  if (control == nullptr || !control->isOn(on_screen::kPage) || control->isOn(on_screen::kOwn)) {
    return badFormat("message set: no control of this name");
  }
  change.id = control->id;
  const Json *to = member(json, "to"), *by = member(json, "by");
  for (const auto& [value, what] : {std::pair(to, "to"), std::pair(by, "by")}) {
    if (value == nullptr || value->is_boolean()) continue;
    if (!value->is_number() || !(std::abs(value->get<double>()) <= kLargestValue)) {
      return expected("set", what, "true, false, or a number from -1,000,000 to 1,000,000");
    }
  }
  if (to != nullptr) change.to = to->is_boolean() ? double(to->get<bool>()) : to->get<double>();
  if (by != nullptr) change.by = by->is_boolean() ? double(by->get<bool>()) : by->get<double>();
  return {};
}

Result<void> readAck(const Json& json, const char* type, ClientMessage& message) {
  const Json* frame = member(json, "frame");
  if (frame == nullptr || !frame->is_number_unsigned()) return expected(type, "frame", "a number of a frame");
  message.frame = frame->get<std::uint64_t>();
  return {};
}

Result<void> readShow(const Json& json, const char* type, ClientMessage& message) {
  const Json* layers = member(json, "layers");
  if (layers == nullptr || !layers->is_array()) return expected(type, "layers", "a list");
  for (const Json& layer : *layers) {
    const unsigned bit = layer.is_string() ? servedLayer(layer.get_ref<const std::string&>()) : 0;
    if (bit == 0) return expected(type, "layers", "one of hulls, contacts, particles, depth, face");
    message.layers |= bit;
  }
  return {};
}

Result<void> readHead(const Json& json, const char* type, ClientMessage& message) {
  const Json* time = member(json, "time");
  if (time == nullptr || !time->is_number()) return expected(type, "time", "a number");
  message.pose.time = time->get<double>();
  if (!(std::abs(message.pose.time) <= kLongestClock)) return expected(type, "time", "seconds of a clock");
  LORICA_TRY_DO(readPose(json, type, message.pose.head));
  const Json* hands = member(json, "hands");
  if (hands == nullptr) return {};
  if (!hands->is_array() || hands->size() != message.pose.hands.size()) return expected(type, "hands", "a list of two");
  for (std::size_t i = 0; i < hands->size(); ++i) {
    if (!(*hands)[i].is_null()) LORICA_TRY_DO(readPose((*hands)[i], type, message.pose.hands[i].emplace()));
  }
  return {};
}

Result<void> readThrow(const Json& json, const char* type, ClientMessage& message) {
  for (const auto& [name, point] :
       {std::pair("origin", &message.change.ray.origin), {"target", &message.change.at.emplace()}}) {
    if (!readNumbers(member(json, name), kFarthestPosition, *point)) return expected(type, name, kPosition);
  }
  return {};
}

Result<void> readRay(const Json& json, const char* type, ClientMessage& message) {
  HandAim& aim = message.aim;
  if (!readNumbers(member(json, "origin"), kFarthestPosition, aim.ray.origin))
    return expected(type, "origin", kPosition);
  if (!readHand(json, message.change)) return expected(type, "hand", kHands);
  if (!readDirection(member(json, "direction"), aim.ray.direction)) return expected(type, "direction", "a direction");
  if (!readDirection(member(json, "forward"), aim.forward)) return expected(type, "forward", "a direction");
  message.change.ray = aim.ray;
  return {};
}

Result<void> readRelease(const Json& json, const char* type, ClientMessage& message) {
  if (!readHand(json, message.change)) return expected(type, "hand", kHands);
  const Json* velocity = member(json, "velocity");
  if (velocity != nullptr && (!readNumbers(velocity, kFastestBall, message.change.velocity) ||
                              message.change.velocity.norm() > kFastestBall)) {
    return expected(type, "velocity", "three numbers of at most 100 m/s");
  }
  return {};
}

/// A type of message: what it is, the control that it changes, and how its members are read.
struct Reader {
  const char* type;
  Kind kind;
  ControlId id;
  Result<void> (*read)(const Json&, const char* type, ClientMessage&);
};
constexpr ControlId kNone = ControlId::kCancel;  // as in Change
constexpr std::array<Reader, 7> kReaders = {{{"ack", Kind::kAck, kNone, readAck},
                                             {"show", Kind::kShow, kNone, readShow},
                                             {"throw", Kind::kChange, ControlId::kThrow, readThrow},
                                             {"press", Kind::kChange, ControlId::kPress, readRay},
                                             {"drag", Kind::kDrag, kNone, readRay},
                                             {"release", Kind::kChange, ControlId::kRelease, readRelease},
                                             {"head", Kind::kHead, kNone, readHead}}};

}  // namespace

Result<ClientMessage> readClientMessage(std::string_view text) {
  if (text.size() > kMaxMessageBytes)
    return badFormat("message of {} bytes: at most {}", text.size(), kMaxMessageBytes);
  LORICA_TRY(const Json json, parseJson<Json>(text, "message", JsonLimits{4, 16}));
  ClientMessage message;
  if (json.is_object() && json.contains("set")) {
    message.kind = Kind::kChange;
    LORICA_TRY_DO(readSet(json, message.change));
    return message;
  }
  const Json* type = json.is_object() ? member(json, "type") : nullptr;
  if (type == nullptr || !type->is_string()) return badFormat("message: no object with a type or a set");
  for (const Reader& reader : kReaders) {
    if (reader.type != type->get_ref<const std::string&>()) continue;
    message.kind = reader.kind;
    message.change.id = reader.id;
    LORICA_TRY_DO(reader.read(json, reader.type, message));
    return message;
  }
  return badFormat("message: no type that Lorica knows");
}

}  // namespace lorica
