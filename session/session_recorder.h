#pragma once

#include "session/session_blocks.h"
#include "session/session_file.h"
#include "session/step_watcher.h"
#include "session/treated_source.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// Writes a session to a .lsession file while it runs: each step is handed to the system as soon as it is done, so that
/// whoever ends the program, whichever way, loses no more than the step under way. While it runs the file is
/// called NAME.part.lsession, and can be read as it is.
class SessionRecorder final : public StepWatcher {
 public:
  /// @param file       what finish() will call it: NAME.lsession
  /// @param header     of the session that will be watched
  /// @param sceneText  of its scene file; empty = the demo's
  /// @return the recorder, or why the file cannot be written
  [[nodiscard]] static Result<std::shared_ptr<SessionRecorder>> start(const std::filesystem::path& file,
                                                                      const SessionHeader& header,
                                                                      std::string_view sceneText);
  ~SessionRecorder() override;
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  /// Whoever makes the session's source logs here what is taken from it.
  [[nodiscard]] const std::shared_ptr<SourceLog>& log() const { return log_; }

  void beforeStep(Session& /*session*/) override {}
  [[nodiscard]] Result<void> afterStep(const Session& session, std::span<const WorldAction> done) override;
  /// What follows is not recorded.
  void sessionChanged() override { over_ = true; }

  /// Closes the file and gives it its name. Without a step there is no file. Nothing happens the second time.
  /// @return so many steps were recorded
  [[nodiscard]] Result<int> finish();
  /// Whether the session was changed, so that its end is not recorded.
  [[nodiscard]] bool cutShort() const { return over_; }

 private:
  SessionRecorder(std::filesystem::path file, std::filesystem::path part, int descriptor, bool poses);
  [[nodiscard]] Result<void> write();

  std::filesystem::path file_, part_;
  int descriptor_;
  bool poses_;  ///< or joints
  std::shared_ptr<SourceLog> log_ = std::make_shared<SourceLog>();
  ByteWriter step_;
  std::string block_;  ///< about to be written
  std::uint64_t chain_ = 0;
  int steps_ = 0;
  bool over_ = false;
};

}  // namespace lorica
