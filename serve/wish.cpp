#include "serve/wish.h"

#include "geometry/json.h"
#include "serve/wire.h"
#include "session/world_action.h"

#include <array>
#include <cmath>

namespace lorica {
namespace {

using Json = nlohmann::json;
using Kind = Wish::Kind;

/// A member of a message and how it is read.
enum class Member { kNone, kFrame, kLayers, kOn, kTo, kIndex, kCount, kTarget, kRay, kRelease, kPose };

struct Message {
  const char* type;
  Kind kind;
  Member member;
};
constexpr std::array<Message, 27> kMessages = {{{"ack", Kind::kAck, Member::kFrame},
                                                {"show", Kind::kShow, Member::kLayers},
                                                {"pause", Kind::kPause, Member::kOn},
                                                {"step", Kind::kStep, Member::kNone},
                                                {"restart", Kind::kRestart, Member::kNone},
                                                {"seek", Kind::kSeek, Member::kTo},
                                                {"speed", Kind::kSpeed, Member::kTo},
                                                {"loop", Kind::kLoop, Member::kOn},
                                                {"record", Kind::kRecord, Member::kOn},
                                                {"mirror", Kind::kMirror, Member::kOn},
                                                {"smoothing", Kind::kSmoothing, Member::kIndex},
                                                {"gravity", Kind::kGravity, Member::kIndex},
                                                {"scene", Kind::kScene, Member::kIndex},
                                                {"character", Kind::kCharacter, Member::kIndex},
                                                {"motion", Kind::kMotion, Member::kIndex},
                                                {"recent", Kind::kRecent, Member::kIndex},
                                                {"expression", Kind::kExpression, Member::kIndex},
                                                {"clip", Kind::kClip, Member::kIndex},
                                                {"person", Kind::kPerson, Member::kIndex},
                                                {"parts", Kind::kParts, Member::kCount},
                                                {"throw", Kind::kThrow, Member::kTarget},
                                                {"press", Kind::kPress, Member::kRay},
                                                {"drag", Kind::kDrag, Member::kRay},
                                                {"release", Kind::kRelease, Member::kRelease},
                                                {"undo", Kind::kUndo, Member::kNone},
                                                {"cancel", Kind::kCancel, Member::kNone},
                                                {"head", Kind::kHead, Member::kPose}}};
constexpr double kSmallest = 1e-6;      // length of a direction
constexpr double kLongestClock = 1e11;  // [s]
constexpr double kLongest = 1e6;        // of a recording [s]
constexpr int kMostThings = 100'000;    // that are counted
constexpr const char* kHands = "0 or 1";

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
bool readHand(const Json& json, Wish& wish) {
  const Json* hand = member(json, "hand");
  if (hand == nullptr) return true;
  if (!hand->is_number_unsigned() || hand->get<std::uint64_t>() >= kClientHands) return false;
  wish.hand = hand->get<int>();
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
    return expected(type, "position", "three numbers from -1,000 to 1,000");
  }
  if (!readNumbers(member(json, "orientation"), 1.001, turned.coeffs()) || turned.norm() < 0.5) {
    return expected(type, "orientation", "a quaternion");
  }
  pose = Eigen::Translation3d(position) * turned.normalized();
  return {};
}

Result<void> readMember(const Json& json, const Message& message, Wish& wish) {
  const char* type = message.type;
  switch (message.member) {
    case Member::kNone:
      return {};
    case Member::kFrame: {
      const Json* frame = member(json, "frame");
      if (frame == nullptr || !frame->is_number_unsigned()) return expected(type, "frame", "a number of a frame");
      wish.frame = frame->get<std::uint64_t>();
      return {};
    }
    case Member::kLayers: {
      const Json* layers = member(json, "layers");
      if (layers == nullptr || !layers->is_array()) return expected(type, "layers", "a list");
      for (const Json& layer : *layers) {
        const unsigned bit = layer.is_string() ? servedLayer(layer.get_ref<const std::string&>()) : 0;
        if (bit == 0) return expected(type, "layers", "one of hulls, contacts, particles, depth, face");
        wish.layers |= bit;
      }
      return {};
    }
    case Member::kOn: {
      const Json* on = member(json, "on");
      if (on == nullptr || !on->is_boolean()) return expected(type, "on", "true or false");
      wish.on = on->get<bool>();
      return {};
    }
    case Member::kTo: {
      const Json* to = member(json, "to");
      if (to == nullptr || !to->is_number()) return expected(type, "to", "a number");
      wish.to = to->get<double>();
      if (!(wish.to >= 0.0 && wish.to <= kLongest)) return expected(type, "to", "from 0 to 1,000,000");
      return {};
    }
    case Member::kIndex:
    case Member::kCount: {
      const char* name = message.member == Member::kIndex ? "index" : "count";
      const Json* number = member(json, name);
      if (number == nullptr || !number->is_number_integer()) return expected(type, name, "a whole number");
      const double value = number->get<double>();
      if (value < -1.0 || value > kMostThings) return expected(type, name, "from -1 to 100,000");
      wish.index = static_cast<int>(value);
      return {};
    }
    case Member::kPose: {
      const Json* time = member(json, "time");
      if (time == nullptr || !time->is_number()) return expected(type, "time", "a number");
      wish.pose.time = time->get<double>();
      if (!(std::abs(wish.pose.time) <= kLongestClock)) return expected(type, "time", "seconds of a clock");
      LORICA_TRY_DO(readPose(json, type, wish.pose.head));
      const Json* hands = member(json, "hands");
      if (hands == nullptr) return {};
      if (!hands->is_array() || hands->size() != wish.pose.hands.size())
        return expected(type, "hands", "a list of two");
      for (std::size_t i = 0; i < hands->size(); ++i) {
        if (!(*hands)[i].is_null()) LORICA_TRY_DO(readPose((*hands)[i], type, wish.pose.hands[i].emplace()));
      }
      return {};
    }
    case Member::kRelease: {
      if (!readHand(json, wish)) return expected(type, "hand", kHands);
      const Json* velocity = member(json, "velocity");
      if (velocity != nullptr &&
          (!readNumbers(velocity, kFastestBall, wish.velocity) || wish.velocity.norm() > kFastestBall)) {
        return expected(type, "velocity", "three numbers of at most 100 m/s");
      }
      return {};
    }
    case Member::kTarget:
    case Member::kRay: {
      constexpr const char* kPosition = "three numbers from -1,000 to 1,000";
      if (!readNumbers(member(json, "origin"), kFarthestPosition, wish.origin))
        return expected(type, "origin", kPosition);
      if (message.member == Member::kTarget) {
        if (!readNumbers(member(json, "target"), kFarthestPosition, wish.target)) {
          return expected(type, "target", kPosition);
        }
        return {};
      }
      if (!readHand(json, wish)) return expected(type, "hand", kHands);
      if (!readDirection(member(json, "direction"), wish.direction)) return expected(type, "direction", "a direction");
      if (!readDirection(member(json, "forward"), wish.forward)) return expected(type, "forward", "a direction");
      return {};
    }
  }
  return {};
}

}  // namespace

Result<Wish> readWish(std::string_view text) {
  if (text.size() > kMaxWishBytes) return badFormat("message of {} bytes: at most {}", text.size(), kMaxWishBytes);
  LORICA_TRY(const Json json, parseJson<Json>(text, "message", JsonLimits{4, 16}));
  const Json* type = json.is_object() ? member(json, "type") : nullptr;
  if (type == nullptr || !type->is_string()) return badFormat("message: no object with a type");
  for (const Message& message : kMessages) {
    if (message.type != type->get_ref<const std::string&>()) continue;
    Wish wish;
    wish.kind = message.kind;
    LORICA_TRY_DO(readMember(json, message, wish));
    return wish;
  }
  return badFormat("message: no type that Lorica knows");
}

}  // namespace lorica
