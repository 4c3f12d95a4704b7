#pragma once

#include "geometry/text.h"
#include "geometry/result.h"
#include "session/session.h"
#include "session/step_watcher.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// Rejects, before any work, a file that cannot be written or that is one of the others, and two uses of standard
/// output.
/// @param others  inputs and other outputs of the command; empty ones are ignored
[[nodiscard]] Result<void> checkEvents(const std::string& to, const CommonOptions& common,
                                       const std::vector<std::filesystem::path>& others);

/// Writes a session's contact events after each step, one JSON object per line (docs/CONTACTS.md). All contacts end
/// when the session changes or finish() is called.
class EventsOutput : public StepWatcher {
 public:
  /// Ends all contacts and completes the file. Further calls do nothing.
  [[nodiscard]] virtual Result<void> finish() = 0;
};

/// @param to    file, which is written beside it and renamed by finish(); "-" = standard output; empty = nowhere
/// @param next  another watcher of the same session; may be null
/// @return the output, null if `to` is empty, or an error
[[nodiscard]] Result<std::shared_ptr<EventsOutput>> makeEventsOutput(const std::string& to,
                                                                     std::shared_ptr<StepWatcher> next);
/// EventsOutput::finish(); does nothing without an output.
[[nodiscard]] Result<void> finishEvents(const std::shared_ptr<EventsOutput>& output);

}  // namespace lorica
