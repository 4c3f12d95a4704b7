#pragma once

#include "capture/headset/head_and_hands.h"
#include "geometry/math.h"
#include "geometry/result.h"
#include "viewer/renderer/screen.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace lorica {

/// A message of a client, see docs/WIRE.md.
struct Wish {
  enum class Kind : std::uint8_t {
    kAck,
    kShow,
    kPause,
    kStep,
    kRestart,
    kSeek,
    kSpeed,
    kLoop,
    kRecord,
    kMirror,
    kSmoothing,
    kGravity,
    kScene,
    kCharacter,
    kMotion,
    kRecent,
    kExpression,
    kClip,
    kPerson,
    kParts,
    kThrow,
    kPress,
    kDrag,
    kRelease,
    kUndo,
    kCancel,
    kHead,
    kOpen,  ///< a file, which came over HTTP
    kGone   ///< the client left: no message of its own
  };

  Kind kind = Kind::kAck;
  int client = 0;
  bool on = false;
  int index = 0;            ///< or the number of parts
  int hand = 0;             ///< of the client, below kClientHands
  double to = 0.0;          ///< seconds or a factor
  std::uint64_t frame = 0;  ///< acknowledged
  unsigned layers = 0;      ///< see `served`
  Vec3 origin = Vec3::Zero(), direction = Vec3::UnitZ(), forward = Vec3::UnitZ();  ///< world; unit vectors
  Vec3 target = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();  ///< of what is let go [m/s]; 0 = its own
  std::string file;              ///< its path, under a name that the server chose
  HeadAndHands pose = {};        ///< of a headset, in its own stage frame, by the client's clock

  [[nodiscard]] HandAim aim() const { return {{origin, direction}, forward}; }
};

inline constexpr std::size_t kMaxWishBytes = 4096;
inline constexpr int kClientHands = 2;

/// @return the wish, with numbers that are finite and within their range; or what is wrong with it
[[nodiscard]] Result<Wish> readWish(std::string_view text);

}  // namespace lorica
