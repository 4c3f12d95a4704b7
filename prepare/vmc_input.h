#pragma once

#include "capture/retarget/sender_rest.h"
#include "capture/streams/vmc_stream.h"
#include "prepare/host.h"
#include "session/session.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// How a program is listened to.
struct VmcInputOptions {
  std::string listenAt;  ///< PORT or HOST:PORT; empty = not at all
  int delayMs = 0;       ///< of the frames
  std::string sender;    ///< see readSenderRest()
};

/// Rejects a bad address or sender before any work.
[[nodiscard]] Result<void> checkVmcInput(const VmcInputOptions& options, const Host& host);

/// A VMC stream that a session follows, and what is told of it.
class VmcInput {
 public:
  /// @param options  with an address
  /// @return the opened stream, or why there is none
  [[nodiscard]] static Result<VmcInput> open(const VmcInputOptions& options, const Host& host);

  /// The poses of a character that follows the stream; once. The source must outlive this object's later use.
  /// @param leads  whether the session waits for its frames
  [[nodiscard]] Result<std::unique_ptr<PoseSource>> makeSource(const Character& character, bool mirror,
                                                               bool leads = true);

  /// "VMC on 127.0.0.1:39539"
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Whether the session should step now: there is a new frame, or none came for a thirtieth of a second.
  [[nodiscard]] bool ready(const Session& session) const;
  /// Adds a frame whose hulls have been posed; tells the host when the sender comes and goes.
  void add(const Session& session, Host& host);
  /// For the caption: "no program is sending", or empty.
  [[nodiscard]] std::string state() const;

  [[nodiscard]] VmcStream::Counts counts() const { return view_->counts(); }
  [[nodiscard]] int delayMs() const { return delayMs_; }
  /// From the packet to the posed hulls [us], of each frame.
  [[nodiscard]] const std::vector<double>& latency() const { return latency_; }

 private:
  VmcInput(std::unique_ptr<VmcStream> stream, std::string name, std::optional<SenderRest> sender, int delayMs);

  const VmcStream* view_;
  std::unique_ptr<BoneStream> stream_;
  std::string name_;
  std::optional<SenderRest> sender_;
  int delayMs_;
  std::vector<double> latency_;  // from the packet to the posed hulls [us]
  bool heard_ = false;           // a frame came within half a second
};

}  // namespace lorica
