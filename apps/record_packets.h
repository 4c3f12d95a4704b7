#pragma once

#include "apps/options.h"
#include "player/playback.h"

#include <string>

namespace lorica {

/// Writes the packets that arrive to a .pcap file until Ctrl-C or the limit of seconds. While recording, the file is
/// called NAME.part.pcap; it is readable at any time.
/// @param listenAt  PORT or HOST:PORT
[[nodiscard]] Result<void> recordPackets(const std::string& out, const std::string& listenAt,
                                         const PlaybackOptions& limit, const CommonOptions& common);

}  // namespace lorica
