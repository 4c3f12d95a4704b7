#pragma once

#include "session/session.h"
#include "viewer/renderer/screen.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// "hero performs walk"; live "hero follows camera"; "2 avatars perform walk and wave".
/// @param source  name of the motion or of what is followed
[[nodiscard]] std::string titleOf(const Session& session, const std::string& source, bool live);

/// The line of status of a screen: parts and touched props.
[[nodiscard]] std::string statusOf(const Session& session, bool ended);

/// Adds the last frame of a session to the screen's graph.
/// @param tracking  time for tracking the joints [s]; none = not measured
void addStageTimes(const Session& session, std::optional<double> tracking, Screen& screen);

/// The note about PoseSource::refusedLegs().
inline constexpr const char* kRefusedLegs =
    "Legs that cannot be (they run upwards or change their length) were not used; without legs the character stands.";

/// The caption of a picture: name, time, contacts.
[[nodiscard]] std::string captionOf(const std::string& name, const Session& session, double seconds);

/// Keeps each warning visible for at least a second, so that it is readable, and those that come and go for longer, so
/// that they do not flicker.
class WarningBoard {
 public:
  static constexpr double kHoldSeconds = 1.0;
  static constexpr double kLongestHold = 8.0;  ///< of a warning that came back often [s]
  static constexpr double kForgotten = 20.0;   ///< without it, until a warning is held shortly again [s]

  /// Raises a warning. A new text of the same kind replaces the previous one, but not before that was shown for
  /// kHoldSeconds.
  /// @param kind  identifies the warning
  void raise(std::string_view kind, std::string_view sentence, double now);
  /// Removes warnings that have not been raised for kHoldSeconds; each time that one came back doubles that. @param now
  /// monotonic clock [s]
  void update(double now);
  void clear() { notes_.clear(), sentences_.clear(), past_.clear(), known.clear(); }

  /// The current warnings, in the order in which they were first raised.
  [[nodiscard]] std::span<const std::string> sentences() const { return sentences_; }

  std::vector<std::vector<bool>> known;  ///< of each avatar, see lostLimbs()

 private:
  struct Note {
    std::string kind;
    double worded = 0.0;  // when its text last changed [s]
    double raised = 0.0;  // when it was last raised [s]
    double hold = kHoldSeconds;
  };
  std::vector<Note> notes_;
  std::vector<std::string> sentences_;  // of the notes
  std::vector<Note> past_;              // that were removed
};

/// Raises warnings about a frame: lost limbs and problems with the source, after which nothing is known of the limbs.
/// @param trouble  problem with the source; empty = none
/// @param now      monotonic time [s]
void raiseWarnings(const Session& session, std::string_view trouble, double now, WarningBoard& board);

/// Names of the limbs that are not trusted any more: "left hand, left lower arm lost". If there are more than three,
/// the first three and the number of the others; empty if there are none. What a source never had is not lost.
/// @param trust  one value per joint, see PoseSource::trust(); empty = all are trusted
/// @param known  the joints that were trusted before; those of this frame are added
[[nodiscard]] std::string lostLimbs(const Skeleton& skeleton, std::span<const double> trust, std::vector<bool>& known);

}  // namespace lorica
