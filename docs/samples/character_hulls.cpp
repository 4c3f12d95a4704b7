// The hulls of a moving character in your own loop: 30 frames of a recorded walk.
//
//   character_hulls [joints.csv]

#include <lorica/acd/decompose.h>
#include <lorica/capture/files/joint_csv.h>
#include <lorica/collision/hulls/keyframes.h>
#include <lorica/collision/live/live_body.h>
#include <lorica/session/prepare/motion.h>
#include <lorica/skinning/linear_blend.h>
#include <lorica/skinning/mannequin/mannequin.h>

#include <cstdio>

namespace {

int fail(const lorica::Error& error) {
  std::fprintf(stderr, "character_hulls: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  // Prepare, once. The character: the built-in one, or readCharacterFile() and makeBody() for a file.
  const lorica::Character character = lorica::makeMannequin();
  lorica::Motion walk;
  auto joints = lorica::readJointCsv(argc > 1 ? argv[1] : LORICA_RECORDINGS_DIR "/walk.csv");
  if (!joints) return fail(joints.error());
  walk.joints = std::move(*joints);
  const auto motion = lorica::performedBy(character, walk);
  if (!motion) return fail(motion.error());

  // Decompose it for a few keyframes of the motion. Slow: save the result with writeDecomposition().
  const int vertexCount = static_cast<int>(character.mesh.vertices.size());
  const auto keyframes = lorica::sampleKeyframes(character, {&*motion, 1}, 3);
  if (!keyframes) return fail(keyframes.error());
  const auto decomposition = lorica::decompose(character.mesh, {*keyframes, vertexCount}, {.maxParts = 8});
  if (!decomposition) return fail(decomposition.error());

  auto body = lorica::LiveBody::create(*decomposition, character);
  if (!body) return fail(body.error());

  // Per frame: pose the skeleton, move the hulls. Nothing here allocates after the first frame.
  const auto jointCount = static_cast<std::size_t>(character.skeleton.jointCount());
  lorica::Pose pose = lorica::restPose(character.skeleton);
  std::vector<lorica::Affine3> transforms(jointCount);
  lorica::ConvexHull hull;
  double microseconds = 0.0;
  for (int frame = 0; frame < 30; ++frame) {
    lorica::poseAt(*motion, motion->times.front() + frame / 30.0, pose);
    lorica::computeWorldFromJoint(character.skeleton, pose, transforms);
    lorica::computeWorldFromModel(character, transforms, transforms);
    body->update(transforms);
    microseconds += body->timing().motion + body->timing().points + body->timing().hulls;
    if (frame % 10 != 0) continue;
    for (std::size_t i = 0; i < body->parts().size(); ++i) {
      lorica::worldHull(body->parts()[i], hull);
      std::printf("frame %2d, part %zu: %4zu vertices, %.4f m3\n", frame, i, hull.vertices.size(), hull.volume);
    }
  }
  std::printf("%zu parts, mean time per frame %.0f us\n", body->parts().size(), microseconds / 30);
}
