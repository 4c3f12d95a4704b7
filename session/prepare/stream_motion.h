#pragma once

#include "session/prepare/read_motion.h"

#include <filesystem>
#include <optional>
#include <string>

namespace lorica {

/// Reads a recording of VMC packets (.pcap): what the sender's bones did.
[[nodiscard]] Result<Motion> readPacketMotion(const std::filesystem::path& file, const MotionOptions& options,
                                              Host& host);

/// Reads the motion of an avatar of a recorded session (.lsession): its joints, or the poses of its character, whose
/// file must be there, or is the options'.
/// @param options  their person is the number of the avatar, from 1; 0 = the first, with a note if there are several
[[nodiscard]] Result<Motion> readSessionMotion(const std::filesystem::path& file, const MotionOptions& options,
                                               Host& host);

/// The rest pose of a sender's model. @param file  VRM 1.0; empty = none
[[nodiscard]] Result<std::optional<SenderRest>> readSenderRest(const std::string& file, const Host& host);

}  // namespace lorica
