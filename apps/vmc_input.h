#pragma once

#include "apps/report.h"
#include "capture/streams/vmc_stream.h"
#include "session/session.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Rejects a bad address before any work. @param listenAt  empty = none
[[nodiscard]] Result<void> checkVmcInput(const std::string& listenAt);

/// A VMC stream that a session follows, and what is told of it.
class VmcInput {
 public:
  /// @param listenAt  PORT or HOST:PORT
  /// @return the opened stream, or why there is none
  [[nodiscard]] static Result<VmcInput> open(const std::string& listenAt);

  /// For makeStreamPoseSource(), once. The stream must outlive this object's later use, as the session's source does.
  [[nodiscard]] std::unique_ptr<BoneStream> takeStream() { return std::move(stream_); }

  /// "VMC on 127.0.0.1:39539"
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Whether the session should step now: there is a new frame, or none came for a thirtieth of a second.
  [[nodiscard]] bool ready(const Session& session) const;
  /// Adds a frame whose hulls have been posed; tells on standard error when the sender comes and goes.
  void add(const Session& session);
  /// For the caption: "no program is sending", or empty.
  [[nodiscard]] std::string state() const;

  void addTo(nlohmann::ordered_json& json) const;
  void addTo(Report& report) const;

 private:
  VmcInput(std::unique_ptr<VmcStream> stream, std::string name);

  const VmcStream* view_;
  std::unique_ptr<BoneStream> stream_;
  std::string name_;
  std::vector<double> latency_;  // from the packet to the posed hulls [us]
  bool heard_ = false;           // a frame came within half a second
};

}  // namespace lorica
