#pragma once

#include "collision/hulls/host.h"
#include "geometry/result.h"
#include "session/session.h"

#include <memory>
#include <string>

namespace lorica {

/// Writes a session's contact events after each step, one JSON object per line (docs/CONTACTS.md). All contacts end
/// when the session changes or finish() is called.
class EventsOutput : public StepWatcher {
 public:
  /// Ends all contacts and completes the file. Further calls do nothing.
  [[nodiscard]] virtual Result<void> finish() = 0;
};

/// @param to    file, which is written next to it and renamed by finish(); "-" = standard output; empty = nowhere
/// @param next  another watcher of the same session; may be null
/// @return the output, null if `to` is empty, or an error
[[nodiscard]] Result<std::shared_ptr<EventsOutput>> makeEventsOutput(const std::string& to,
                                                                     std::shared_ptr<StepWatcher> next, Host& host);

}  // namespace lorica
