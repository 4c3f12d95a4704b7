#pragma once

#include "collision/hulls/host.h"
#include "geometry/result.h"
#include "session/session.h"

#include <vector>

namespace lorica {

/// The parts of each avatar of a session, as they are now.
using PartsOfAvatars = std::vector<std::vector<LivePart>>;
[[nodiscard]] PartsOfAvatars partsOf(const Session& session);

/// Whether a step of this world begins with letting sand or water settle, which takes seconds.
[[nodiscard]] bool mustSettle(const World& world);
/// Share of the work of opening what an avatar and a scene need that comes before settling, see Stage.
inline constexpr double kBeforeSettling = 0.6;

/// Lets sand and water settle around parts that stand. A task of the host; stops if that is cancelled: the world is to
/// be given up then.
void settleAround(const PartsOfAvatars& parts, World& world, Host& host);

/// The same in the first step of a session. If it is stopped, the step that ends it is no longer watched, so that it is
/// not recorded.
[[nodiscard]] Result<bool> stepAndSettle(Session& session, Host& host);

}  // namespace lorica
