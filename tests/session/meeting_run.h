#pragma once

#include "acd/decomposition.h"
#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "capture/virtual_sensor/depth_noise.h"
#include "geometry/result.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lorica::test {

/// Two people who do something together: their joints over time at 30 Hz, world frame, the camera at +Z.
struct Meeting {
  std::string name;
  std::array<std::vector<SkeletonFrame>, 2> people;  ///< the first starts at -X and faces +X, the second faces -X
};

/// Shaking hands, boxing, hugging, and changing places: 4 s each.
[[nodiscard]] std::vector<Meeting> meetings();

struct MeetingSettings {
  DepthCamera camera;
  DepthNoiseSettings noise;
  double framesPerSecond = 30.0;
  int every = 1;  ///< frames whose contacts are compared with the meshes
};

/// Two people before the virtual camera, followed by a tracker, as two avatars of a session.
struct MeetingResult {
  int frames = 0;
  std::optional<int> bothSince;  ///< the first frame in which both are followed
  int lost = 0;                  ///< frames since then in which one is not
  int exchanged = 0;             ///< frames since then in which an avatar is nearer to the other person
  double errorMm = 0.0;          ///< mean over all joints that are known

  // The avatars' skins in the frames that are compared. Apart: the distance of the nearest vertex. Deep: a vertex of
  // one is that far inside the other.
  int compared = 0, touching = 0, contacts = 0;
  int missed = 0, missed2cm = 0;  ///< no contact, though the skins overlap, and by more than 2 cm
  int wrong = 0, wrong2cm = 0;    ///< a contact, though the skins are apart, and by more than 2 cm
  double deepestMissedMm = 0.0, farthestWrongMm = 0.0;
  int points = 0, pointsOff2cm = 0;  ///< contact points; those that are more than 2 cm from one of the skins

  // The people's own skins: what the camera's errors cost.
  int peopleTouch = 0;        ///< frames in which they overlap by more than 2 cm
  int peopleTouchMissed = 0;  ///< of these, without a contact of the avatars
};

/// @param parts  of the mannequin
[[nodiscard]] Result<MeetingResult> runMeeting(const Meeting& meeting, const Decomposition& parts,
                                               const MeetingSettings& settings);

}  // namespace lorica::test
