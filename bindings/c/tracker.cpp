#include "capture/tracking/tracker.h"
#include "bindings/c/guard.h"
#include "capture/sensor/depth_frame.h"

#include <cmath>
#include <utility>
#include <vector>

using namespace lorica;

struct lorica_tracker {
  Tracker tracker;
  DepthFrame frame;
  std::vector<TrackedPerson> people;
};

lorica_status lorica_tracker_make(const lorica_tracker_options* options, lorica_tracker** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(out, "out"));
    LORICA_TRY(const lorica_tracker_options wanted, taken(options, "options"));
    DepthCamera camera;
    if (wanted.width != 0) camera.width = wanted.width;
    if (wanted.height != 0) camera.height = wanted.height;
    if (wanted.horizontal_fov != 0.0) camera.horizontalFov = wanted.horizontal_fov;
    if (wanted.vertical_fov != 0.0) camera.verticalFov = wanted.vertical_fov;
    TrackerSettings settings;
    if (wanted.max_people != 0) settings.maxPeople = wanted.max_people;
    LORICA_TRY(Tracker made, Tracker::create(camera, settings));
    DepthFrame frame;
    frame.time = -kInfinity;
    frame.depthMm.resize(static_cast<std::size_t>(camera.width) * camera.height);
    *out = new lorica_tracker{std::move(made), std::move(frame), {}};
    return {};
  });
}

void lorica_tracker_free(lorica_tracker* tracker) {
  delete tracker;
}

lorica_status lorica_tracker_track(lorica_tracker* tracker, double seconds, const uint16_t* depth_mm,
                                   size_t pixel_count, size_t* people) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(tracker, "tracker", depth_mm, "depth_mm", people, "people"));
    DepthFrame& frame = tracker->frame;
    if (pixel_count != frame.depthMm.size()) {
      return invalidArgument("pixel_count: found {}, expected {}", pixel_count, frame.depthMm.size());
    }
    if (!std::isfinite(seconds) || !(seconds > frame.time)) {
      return invalidArgument("seconds: found {}, expected more than {}, that of the last image", seconds, frame.time);
    }
    frame.time = seconds;
    frame.depthMm.assign(depth_mm, depth_mm + pixel_count);
    const std::span<const TrackedPerson> found = tracker->tracker.track(frame);
    tracker->people.assign(found.begin(), found.end());
    *people = found.size();
    return {};
  });
}

lorica_status lorica_tracker_person(const lorica_tracker* tracker, size_t index, lorica_person* out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(tracker, "tracker"));
    LORICA_TRY_DO(inRange(index, tracker->people.size(), "person"));
    static_assert(LORICA_JOINT_COUNT == kBodyJointCount);
    const TrackedPerson& found = tracker->people[index];
    lorica_person person = {};
    person.user = found.skeleton.user;
    person.height = found.height;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      Eigen::Map<Vec3>(person.positions[j]) = found.skeleton.joints[j].position;
      person.confidences[j] = found.skeleton.joints[j].confidence;
    }
    return handOut(person, out);
  });
}
