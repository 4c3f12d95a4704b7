#pragma once

#include "acd/decomposition.h"
#include "geometry/math.h"
#include "skinning/skeleton.h"

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

enum class TouchKind : std::uint8_t {
  kProp,    ///< a part and a prop
  kSelf,    ///< two parts of one avatar
  kAvatars  ///< parts of two avatars
};

/// What touches what. An avatar and the other thing can touch in several pairs of parts at a time.
struct TouchPair {
  TouchKind kind = TouchKind::kProp;
  int avatar = 0;
  PartIndex part = 0;   ///< of the avatar
  int otherAvatar = 0;  ///< kAvatars: above `avatar`; otherwise the same
  int other = 0;        ///< prop, or part of the other avatar

  [[nodiscard]] auto operator<=>(const TouchPair&) const = default;
};

/// A pair that touches in one frame.
struct Touch {
  TouchPair pair;
  JointIndex bone = kNoJoint;       ///< of the part's character, with the most influence on the point
  JointIndex otherBone = kNoJoint;  ///< the same for the other part; kNoJoint for a prop
  Vec3 point = Vec3::Zero();        ///< world [m]
  Vec3 normal = Vec3::UnitX();      ///< unit, from the part to the other
  double depth = 0.0;               ///< if the other moves this far along the normal, they just touch [m]
  double strength = 0.0;            ///< impulse of this frame, see ContactEvents [N s]
};

enum class ContactPhase : std::uint8_t { kBegin, kStay, kEnd };

/// What happens to a pair in one frame.
struct ContactEvent {
  ContactPhase phase = ContactPhase::kBegin;
  Touch touch;           ///< of this frame; if the pair does not touch in it, the last one with depth and strength 0
  double time = 0.0;     ///< of this frame [s]
  double began = 0.0;    ///< time of the begin: with the pair, it names the contact [s]
  double touched = 0.0;  ///< when the pair touched last, at most `time` [s]
};

/// Turns the touches of each frame into events without flicker: of each contact one begin, then one stay in each frame,
/// then one end.
///
/// A contact with a prop begins with the first touch; one of two parts when they overlap by kBeginDepth. Either ends in
/// the first frame that is kReleaseSeconds or more after the last touch, however shallow. So contact noise of up to
/// kBeginDepth, or gaps shorter than kReleaseSeconds, never end and begin a contact. The bones of a contact are those
/// of its begin.
class TouchTracker {
 public:
  static constexpr double kBeginDepth = 0.003;     ///< [m]
  static constexpr double kReleaseSeconds = 0.09;  ///< [s]; not a multiple of usual frame times

  /// Allocates nothing once the most touches of a frame have been seen.
  /// @param touches  of one frame; in ascending order of their pairs, each pair once
  /// @param time     of the frame [s]; if it is before the previous one's, all contacts that are not touched end
  /// @return the events of the frame, in ascending order of the pairs; valid until the next call
  std::span<const ContactEvent> update(std::span<const Touch> touches, double time);

  /// Ends all contacts, at the time of the last frame: the stream is over, or what was touched is no longer there.
  std::span<const ContactEvent> endAll();

 private:
  std::vector<ContactEvent> open_;    // contacts after the last frame; ascending pairs
  std::vector<ContactEvent> events_;  // of the last frame
  double time_ = 0.0;
};

}  // namespace lorica
