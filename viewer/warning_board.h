#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Warnings as people can read them: each stays for at least a second, so that what comes and goes does not flicker.
class WarningBoard {
 public:
  static constexpr double kHoldSeconds = 1.0;

  /// Something is wrong now. A warning of the same kind with other words takes the place of the one before, but not
  /// within the time that it is held.
  /// @param kind  tells warnings apart
  void raise(std::string_view kind, std::string_view sentence, double now);
  /// Forgets what has not been raised for so long. @param now  a clock that never goes back [s]
  void update(double now);
  void clear() { notes_.clear(), sentences_.clear(); }

  /// In the order in which they came.
  [[nodiscard]] std::span<const std::string> sentences() const { return sentences_; }

 private:
  struct Note {
    std::string kind;
    double worded = 0.0;  // when its words were last changed [s]
    double raised = 0.0;  // when it was last raised [s]
  };
  std::vector<Note> notes_;
  std::vector<std::string> sentences_;  // of the notes
};

}  // namespace lorica
