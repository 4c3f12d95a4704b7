#pragma once

#include "apps/options.h"
#include "player/playback.h"

#include "apps/report.h"
#include "prepare/host.h"

#include <string>

namespace lorica {

/// Writes the packets that arrive to a .pcap file until Ctrl-C or the limit of seconds. While recording, the file is
/// called NAME.part.pcap; it is readable at any time.
/// @param listenAt  PORT or HOST:PORT
/// @param limit     [s]; 0 = none
[[nodiscard]] Result<void> recordPackets(const std::string& out, const std::string& listenAt, double limit,
                                         const CommonOptions& common, Host& host);

}  // namespace lorica
