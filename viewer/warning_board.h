#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Keeps each warning visible for at least a second, so that it is readable and does not flicker.
class WarningBoard {
 public:
  static constexpr double kHoldSeconds = 1.0;

  /// Raises a warning. A new text of the same kind replaces the previous one, but not before that was shown for
  /// kHoldSeconds.
  /// @param kind  identifies the warning
  void raise(std::string_view kind, std::string_view sentence, double now);
  /// Removes warnings that have not been raised for kHoldSeconds. @param now  monotonic clock [s]
  void update(double now);
  void clear() { notes_.clear(), sentences_.clear(); }

  /// The current warnings, in the order in which they were first raised.
  [[nodiscard]] std::span<const std::string> sentences() const { return sentences_; }

 private:
  struct Note {
    std::string kind;
    double worded = 0.0;  // when its text last changed [s]
    double raised = 0.0;  // when it was last raised [s]
  };
  std::vector<Note> notes_;
  std::vector<std::string> sentences_;  // of the notes
};

}  // namespace lorica
