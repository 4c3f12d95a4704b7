#pragma once

#include "capture/headset/head_and_hands.h"
#include "geometry/result.h"
#include "viewer/renderer/controls.h"
#include "viewer/renderer/screen.h"

#include <cstdint>
#include <string_view>

namespace lorica {

/// A message of a client, see docs/WIRE.md.
struct ClientMessage {
  enum class Kind : std::uint8_t {
    kAck,
    kShow,
    kChange,  ///< set, throw, press, release; or a file, which came over HTTP
    kDrag,
    kHead,
    kGone  ///< the client left: no message of its own
  };

  Kind kind = Kind::kAck;
  int client = 0;
  std::uint64_t frame = 0;  ///< acknowledged
  unsigned layers = 0;      ///< see `served`
  Change change = {};       ///< its hand is one of the client, below kClientHands
  HandAim aim = {};         ///< of a press and a drag; unit vectors
  HeadAndHands pose = {};   ///< of a headset, in its own stage frame, by the client's clock
};

inline constexpr std::size_t kMaxMessageBytes = 4096;
inline constexpr int kClientHands = 2;

/// @return the message, with numbers that are finite and within their range; or what is wrong with it
[[nodiscard]] Result<ClientMessage> readClientMessage(std::string_view text);

}  // namespace lorica
