#pragma once

#include "apps/report.h"
#include "prepare/live_cast.h"

#include <cstddef>
#include <functional>
#include <string>

namespace lorica {

/// The options of `lorica record FILE.lsession`.
struct SessionRecording {
  std::string out;
  std::string into = {};  ///< what `finished` makes of it, which reports name; empty = it stays
  CastRequest request;    ///< no motion = a live camera
  LiveRequest live;
  int frames = 0;        ///< maximum; 0 = no limit
  double seconds = 0.0;  ///< maximum [s]; 0 = no limit
};

/// Writes the packets that arrive to a .pcap file until Ctrl-C or the limit of seconds. While recording, the file is
/// called NAME.part.pcap; it is readable at any time.
/// @param options   of which --vmc and the limit of seconds count
/// @param finished  called when the file is complete
[[nodiscard]] Result<void> recordPackets(const SessionRecording& options, const CommonOptions& common, Host& host,
                                         const std::function<Result<void>()>& finished = {});

}  // namespace lorica
