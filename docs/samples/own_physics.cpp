// A character's hulls in your own physics engine: here a minimal one, 200 balls that fall on a waving person. No Lorica
// world and no Bullet are linked. Contacts come from the planes of the hulls' faces.

#include <lorica/acd/decompose.h>
#include <lorica/capture/files/joint_csv.h>
#include <lorica/collision/hulls/keyframes.h>
#include <lorica/collision/live/live_body.h>
#include <lorica/session/prepare/motion.h>
#include <lorica/skinning/linear_blend.h>
#include <lorica/skinning/mannequin/mannequin.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

namespace {

struct Ball {
  lorica::Vec3 position;  // [m]
  lorica::Vec3 velocity;  // [m/s]
};
constexpr double kRadius = 0.04;  // [m]
constexpr double kStep = 1.0 / 30.0;

struct Contact {
  lorica::Vec3 normal;  // out of the part, in the world
  double depth = 0.0;   // [m]
};

/// A ball against one part: the face with the least overlap. A ball outside any face's plane does not touch. (Balls
/// that only touch an edge are reported slightly early, because the planes are enlarged and not rounded.)
std::optional<Contact> touch(const lorica::LivePart& part, const lorica::Vec3& position) {
  const lorica::Vec3 local = part.worldFromPart.inverse() * position;
  Contact contact;
  contact.depth = std::numeric_limits<double>::infinity();
  for (const lorica::Triangle& t : part.shape.triangles) {
    const lorica::Vec3& a = part.shape.vertices[t[0]];
    const lorica::Vec3 normal = (part.shape.vertices[t[1]] - a).cross(part.shape.vertices[t[2]] - a).normalized();
    const double depth = kRadius - normal.dot(local - a);
    if (depth <= 0.0) return std::nullopt;
    if (depth < contact.depth) contact = {part.worldFromPart.linear() * normal, depth};
  }
  if (part.shape.triangles.empty()) return std::nullopt;
  return contact;
}

template <typename T>
T orExit(lorica::Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "own_physics: %s\n", result.error().message.c_str());
  std::exit(1);
}

}  // namespace

int main() {
  const lorica::Character character = lorica::makeMannequin();
  lorica::Motion wave;
  wave.joints = orExit(lorica::readJointCsv(LORICA_RECORDINGS_DIR "/wave.csv"));
  const lorica::SkeletalMotion motion = orExit(lorica::performedBy(character, wave));
  const int vertexCount = static_cast<int>(character.mesh.vertices.size());
  const auto keyframes = orExit(lorica::sampleKeyframes(character, {&motion, 1}, 3));
  const auto decomposition = orExit(lorica::decompose(character.mesh, {keyframes, vertexCount}, {.maxParts = 12}));
  lorica::LiveBody body = orExit(lorica::LiveBody::create(decomposition, character));

  std::vector<Ball> balls;
  for (int i = 0; i < 200; ++i) {
    balls.push_back({{0.1 * (i % 10) - 0.45, 2.0 + 0.1 * (i / 50), 0.1 * (i / 10 % 5) - 0.2}, lorica::Vec3::Zero()});
  }
  lorica::Pose pose = lorica::restPose(character.skeleton);
  std::vector<lorica::Affine3> transforms(pose.size());
  int contacts = 0;
  int stuck = 0;  // balls more than 5 mm inside a part after a frame: squeezed against the floor or another part
  for (int frame = 0; frame < 90; ++frame) {
    lorica::poseAt(motion, motion.times.front() + frame * kStep, pose);
    lorica::computeWorldFromJoint(character.skeleton, pose, transforms);
    lorica::computeWorldFromModel(character, transforms, transforms);
    body.update(transforms);

    for (Ball& ball : balls) {
      ball.velocity.y() -= 9.81 * kStep;
      ball.position += kStep * ball.velocity;
      // Out of one part may be into its neighbour: a few rounds.
      for (int round = 0; round < 8; ++round) {
        bool touched = false;
        for (const lorica::LivePart& part : body.parts()) {
          const std::optional<Contact> contact = touch(part, ball.position);
          if (!contact) continue;
          touched = true;
          ++contacts;
          ball.position += contact->depth * contact->normal;
          // The part's own motion at that point pushes the ball.
          const lorica::Vec3 pushed = lorica::velocityAt(part, ball.position, kStep);
          const double approach = (ball.velocity - pushed).dot(contact->normal);
          if (approach < 0.0) ball.velocity -= 1.3 * approach * contact->normal;
        }
        if (!touched) break;
      }
      if (ball.position.y() < kRadius) {
        ball.position.y() = kRadius;
        ball.velocity *= 0.5;
        ball.velocity.y() = std::abs(ball.velocity.y());
      }
      for (const lorica::LivePart& part : body.parts()) {
        if (const auto left = touch(part, ball.position); left && left->depth > 0.005) ++stuck;
      }
    }
  }
  std::printf("%d contacts of %zu balls with %zu parts\n", contacts, balls.size(), body.parts().size());
  std::printf("%.2f %% of the positions overlap a part by more than 5 mm\n", 100.0 * stuck / (90.0 * balls.size()));
}
