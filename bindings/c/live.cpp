#include "bindings/c/guard.h"
#include "bindings/c/handles.h"
#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

/// Whether a motion is of the same skeleton as the body.
Result<void> checkMotion(const lorica_live* live, const lorica_motion* motion) {
  LORICA_TRY_DO(given(live, "live", motion, "motion"));
  const Skeleton& own = live->live.body().character().skeleton;
  const Skeleton& other = motion->motion.skeleton;
  bool same = own.jointCount() == other.jointCount();
  for (JointIndex j = 0; same && j < own.jointCount(); ++j) same = own.joint(j).name == other.joint(j).name;
  if (same) return {};
  return invalidArgument("the motion is one of another character, with {} joints; expected the {} joints of {}",
                         other.jointCount(), own.jointCount(), live->live.body().character().name);
}

Result<void> checkJoints(const lorica_live* live, const double* numbers, std::size_t count) {
  LORICA_TRY_DO(given(live, "live", numbers, "world_from_joint"));
  const std::size_t expected = live->live.worldFromJoint().size();
  if (count == expected) return {};
  return invalidArgument("joint_count: found {}, expected {}", count, expected);
}

}  // namespace
}  // namespace lorica

using namespace lorica;

lorica_status lorica_live_make(const lorica_body* body, lorica_live** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(body, "body", out, "out"));
    const Skeleton& skeleton = body->body->character().skeleton;
    *out = new lorica_live{LiveCharacter(body->body), restPose(skeleton),
                           std::vector<Affine3>(skeleton.joints().size()), nullptr};
    return {};
  });
}

void lorica_live_free(lorica_live* live) {
  delete live;
}

lorica_status lorica_live_play(lorica_live* live, const lorica_motion* motion, size_t frame) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(checkMotion(live, motion));
    LORICA_TRY_DO(inRange(frame, motion->motion.times.size(), "frame"));
    live->live.pose(motion->motion.pose(frame));
    return {};
  });
}

lorica_status lorica_live_play_at(lorica_live* live, const lorica_motion* motion, double seconds) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(checkMotion(live, motion));
    if (!std::isfinite(seconds)) return invalidArgument("seconds: found {}, expected a finite number", seconds);
    poseAt(motion->motion, seconds, live->pose);
    live->live.pose(live->pose);
    return {};
  });
}

lorica_status lorica_live_pose(lorica_live* live, const double* world_from_joint, size_t joint_count) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(checkJoints(live, world_from_joint, joint_count));
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      const std::optional<Affine3> matrix = affineFrom(world_from_joint + 16 * joint);
      if (!matrix) return invalidArgument("the matrix of joint {} {}", joint, kBadMatrix);
      live->given[joint] = *matrix;
    }
    live->live.place(live->given);
    return {};
  });
}

lorica_status lorica_live_transforms(const lorica_live* live, double* world_from_joint, size_t joint_count) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(checkJoints(live, world_from_joint, joint_count));
    for (const Affine3& transform : live->live.worldFromJoint()) {
      world_from_joint = std::copy_n(transform.data(), 16, world_from_joint);
    }
    return {};
  });
}

lorica_status lorica_live_hull(const lorica_live* live, size_t part, lorica_hull* out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live"));
    LORICA_TRY_DO(inRange(part, live->live.hulls().size(), "part"));
    return handOut(live->live.hulls()[part], out);
  });
}

lorica_status lorica_live_part_motion(lorica_live* live, size_t part, double seconds, lorica_part_motion* out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live"));
    LORICA_TRY_DO(inRange(part, live->live.hulls().size(), "part"));
    LORICA_TRY_DO(checkSeconds(seconds));
    if (!live->live.posed()) return invalidArgument("the body has no pose yet");
    const LivePart& own = live->live.parts()[part];
    const PartVelocity velocity = velocityOf(own, seconds);
    const std::span<const Vec3> points = live->live.swept(part);
    lorica_part_motion motion = {};
    std::copy_n(own.worldFromPart.data(), 16, motion.world_from_part);
    std::copy_n(own.previousWorldFromPart.data(), 16, motion.previous_world_from_part);
    Eigen::Map<Vec3>(motion.linear_velocity) = velocity.linear;
    Eigen::Map<Vec3>(motion.angular_velocity) = velocity.angular;
    motion.points = points.empty() ? nullptr : points.front().data();
    motion.point_count = points.size();
    motion.present_count = own.shape.vertices.size();
    return handOut(motion, out);
  });
}

lorica_status lorica_live_support(const lorica_live* live, size_t part, const double* direction, double* point) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live", direction, "direction", point, "point"));
    LORICA_TRY_DO(inRange(part, live->live.hulls().size(), "part"));
    if (!live->live.posed()) return invalidArgument("the body has no pose yet");
    const Eigen::Map<const Vec3> along(direction);
    if (!along.allFinite() || along.isZero(0.0)) {
      return invalidArgument("direction: found {} {} {}, expected finite numbers that are not all 0", along.x(),
                             along.y(), along.z());
    }
    const Vec3 farthest = live->live.support(part, along);
    std::copy_n(farthest.data(), 3, point);
    return {};
  });
}

lorica_status lorica_live_cast_rays(lorica_live* live, const double* rays, size_t count, double reach, double radius,
                                    const double* half, int32_t* parts, double* distances, double* positions,
                                    double* normals) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live"));
    if (count > 0) LORICA_TRY_DO(given(rays, "rays", parts, "parts"));
    const Vec3 axis = half != nullptr ? Vec3(half) : Vec3(Vec3::Zero());
    LORICA_TRY_DO(checkCast(reach, radius, axis));
    const RayQuery& query = live->live.rays();
    for (std::size_t i = 0; i < count; ++i) {
      const HullHit hit = query.nearest({Vec3(rays + 6 * i), Vec3(rays + 6 * i + 3), reach, radius, axis});
      parts[i] = hit.part;
      if (distances != nullptr) distances[i] = hit ? hit.distance : kInfinity;
      if (!hit) continue;
      if (positions != nullptr) std::copy_n(hit.position.data(), 3, positions + 3 * i);
      if (normals != nullptr) std::copy_n(hit.normal.data(), 3, normals + 3 * i);
    }
    return {};
  });
}

lorica_status lorica_live_cast_on_skin(lorica_live* live, const double* rays, size_t count, double reach,
                                       int32_t* triangles, double* weights, double* distances, double* positions) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live"));
    if (count > 0) LORICA_TRY_DO(given(rays, "rays", triangles, "triangles"));
    LORICA_TRY_DO(checkCast(reach, 0.0, Vec3::Zero()));
    for (std::size_t i = 0; i < count; ++i) {
      const SkinHit hit = live->live.castOnSkin({Vec3(rays + 6 * i), Vec3(rays + 6 * i + 3), reach});
      triangles[i] = hit.triangle;
      if (distances != nullptr) distances[i] = hit.distance;
      if (!hit) continue;
      if (weights != nullptr) std::copy_n(hit.weights.data(), 3, weights + 3 * i);
      if (positions != nullptr) std::copy_n(hit.position.data(), 3, positions + 3 * i);
    }
    return {};
  });
}
