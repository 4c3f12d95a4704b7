#pragma once

#include "geometry/hard_stop.h"
#include "session/recording/session_file.h"
#include "session/session.h"
#include "session/treated_source.h"

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Writes a session to a .lsession file while it runs. Each step is handed to the operating system as soon as it is
/// done, so at most the current step is lost if the program ends unexpectedly. While recording, the file is called
/// NAME.part.lsession; it is readable at any time. If a killed program left such a file behind, it is kept as
/// NAME.found-1.lsession.
class SessionRecorder final : public StepWatcher {
 public:
  /// @param file       final name after finish(): NAME.lsession
  /// @param header     of the session that will be watched
  /// @param sceneText  of its scene file; empty = the demo scene
  /// @return the recorder, or why the file cannot be written
  [[nodiscard]] static Result<std::shared_ptr<SessionRecorder>> start(const std::filesystem::path& file,
                                                                      const SessionHeader& header,
                                                                      std::string_view sceneText,
                                                                      std::uint64_t maxBytes = kMaxSessionBytes);
  ~SessionRecorder() override;
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  /// The recording that a killed program left behind, under its new name; nothing if there was none.
  [[nodiscard]] const std::optional<std::filesystem::path>& found() const { return found_; }
  /// The log that the source of an avatar must write to.
  [[nodiscard]] const std::shared_ptr<SourceLog>& log(std::size_t avatar = 0) const { return tracks_[avatar].log; }

  void beforeStep(Session& /*session*/) override {}
  [[nodiscard]] Result<void> afterStep(const Session& session, std::span<const WorldAction> done) override;
  /// Stops recording: later steps are not recorded.
  void sessionChanged() override { over_ = true; }

  /// Closes the file and renames it. Without any steps, the file is removed. Further calls do nothing. Other threads
  /// may call it while a step is done.
  /// @return number of recorded steps
  [[nodiscard]] Result<int> finish();
  /// Whether the session was changed, so that its end is not recorded.
  [[nodiscard]] bool cutShort() const { return over_; }
  /// Whether the file is as large as those that are read, so that the rest is not recorded.
  [[nodiscard]] bool full() const { return full_; }

 private:
  SessionRecorder(std::filesystem::path file, std::filesystem::path part, int descriptor, const SessionHeader& header,
                  std::uint64_t maxBytes);
  /// What is recorded of an avatar.
  struct Track {
    bool poses = false;        ///< poses are recorded; otherwise joints
    bool expressions = false;  ///< expressions are recorded with them
    std::shared_ptr<SourceLog> log = std::make_shared<SourceLog>();
  };
  [[nodiscard]] Result<void> write();
  void putMotion(const Track& track);
  void clearLogs();

  std::filesystem::path file_, part_;
  std::optional<std::filesystem::path> found_;
  std::mutex mutex_;  ///< of the file
  int descriptor_;
  std::vector<Track> tracks_;
  ByteWriter step_;
  std::string block_;  ///< bytes to be written
  std::uint64_t chain_ = 0;
  int steps_ = 0;
  std::uint64_t bytes_ = 0, maxBytes_ = 0;
  bool over_ = false, full_ = false;
  AtHardStop finishing_{[this] { (void)finish(); }};
};

}  // namespace lorica
