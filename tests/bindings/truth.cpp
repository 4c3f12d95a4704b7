// What the tests of the C interface and of the Python module compare with, made by the library itself.
//
//   truth glb OUT.glb                             the mannequin as a user's file: an open surface, two clips
//   truth faces OUT.glb                           the same, closed, with a clip that moves a morph target out of it
//   truth bucket OUT.glb                          the same, closed, with a bucket in its hand, a sheet
//   truth hulls BODY.lorica MOTION FRAMES OUT     the hulls of a session's first frames, in world space: for each part
//                                                 its counts of vertices and triangles (int32), x y z (float64) and
//                                                 indices (int32)
//   truth touches BODY.lorica MOTION FRAMES OUT   what a capsule touches in each of these frames: a count (int32), then
//   each
//                                                 part (int32), position, direction, depth (float64)
//   truth depth FILE.oni FRAMES OUT               images and the tracker's joints: width, height (int32), two fields of
//                                                 view (float64); for each frame its time (float64), depths (uint16),
//                                                 count of people (int32), and of each 15 joints' x y z confidence

#include "acd/decomposition_file.h"
#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/sensor/oni_file.h"
#include "capture/tracking/tracker.h"
#include "collision/world/shape_contact.h"
#include "session/prepare/motion.h"
#include "session/scenes/demo_scene.h"
#include "session/session.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace {

using namespace lorica;

template <typename T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

std::string hullsOf(const Session& session) {
  std::string bytes;
  for (const LivePart& part : session.body().parts()) {
    const ConvexHull hull = worldHull(part);
    const std::int32_t counts[] = {static_cast<std::int32_t>(hull.vertices.size()),
                                   static_cast<std::int32_t>(hull.triangles.size())};
    append(bytes, counts, 2);
    append(bytes, hull.vertices.data(), hull.vertices.size());
    append(bytes, hull.triangles.data(), hull.triangles.size());
  }
  return bytes;
}

/// The capsule that tests use: it goes through the mannequin's hips.
std::string touchesOf(const Session& session, ShapeContactQuery& query) {
  const std::array<Vec3, 2> ends = {Vec3(-1.5, 0.9, 0.1), Vec3(0.2, 1.1, -0.1)};
  const std::span<const ShapeContact> found = query.find(session.body().parts(), {ends, 0.06});
  std::string bytes;
  const auto count = static_cast<std::int32_t>(found.size());
  append(bytes, &count, 1);
  for (const ShapeContact& touch : found) {
    append(bytes, &touch.part, 1);
    append(bytes, touch.position.data(), 3);
    append(bytes, touch.direction.data(), 3);
    append(bytes, &touch.depth, 1);
  }
  return bytes;
}

Session sessionOf(const std::filesystem::path& body, const std::filesystem::path& file) {
  const DecompositionFile content = readDecomposition(body).value();
  const Character character = makeMannequin();
  Motion motion;
  motion.name = file.stem().string();
  if (file.extension() == ".bvh") {
    motion.bones = readBvh(file).value().motion;
  } else {
    motion.joints = readJointCsv(file).value();
  }
  std::unique_ptr<PoseSource> source = poseSourceOf(character, motion, SourceTreatment{}).value();
  return Session::create(character, content.decomposition, std::move(source), makeDemoWorld(kDemoSeed), content.cover,
                         content.training)
      .value();
}

/// @param bytesOf  of a frame
template <typename Bytes>
std::string inEachFrame(Session& session, int frames, const Bytes& bytesOf) {
  std::string bytes;
  for (int frame = 0; frame < frames && session.step().value(); ++frame) bytes += bytesOf(session);
  return bytes;
}

std::string trackedDepth(const std::filesystem::path& recording, int frames) {
  OniFile file = OniFile::open(recording).value();
  const DepthCamera& camera = file.info().camera;
  Tracker tracker = Tracker::create(camera).value();
  std::string bytes;
  const std::int32_t size[] = {camera.width, camera.height};
  const double fov[] = {camera.horizontalFov, camera.verticalFov};
  append(bytes, size, 2);
  append(bytes, fov, 2);
  DepthFrame image;
  for (int frame = 0; frame < std::min(frames, file.info().frameCount); ++frame) {
    if (const Result<void> read = file.read(frame, image); !read) break;
    append(bytes, &image.time, 1);
    append(bytes, image.depthMm.data(), image.depthMm.size());
    const std::span<const TrackedPerson> people = tracker.track(image);
    const auto count = static_cast<std::int32_t>(people.size());
    append(bytes, &count, 1);
    for (const TrackedPerson& person : people) {
      for (const TrackedJoint& joint : person.skeleton.joints) {
        append(bytes, joint.position.data(), 3);
        append(bytes, &joint.confidence, 1);
      }
    }
  }
  return bytes;
}

/// A box without its top, of one side only, that hangs from the right hand.
std::string bucketGlb() {
  lorica::test::GlbWriter writer = lorica::test::mannequinWriter(false);
  const JointIndex hand = makeMannequin().skeleton.jointOf(HumanBone::kRightHand);
  TriMesh box = lorica::test::makeBox(Vec3(-0.5, -0.4, -0.15), Vec3(-0.2, -0.1, 0.15));
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](VertexIndex v) { return box.vertices[std::size_t(v)].y() > -0.2; });
  });
  const int positions = writer.positions(box.vertices);
  const int indices = writer.triangles(box.triangles);
  const int mesh = writer.add(
      "meshes",
      {{"name", "Bucket"}, {"primitives", {{{"indices", indices}, {"attributes", {{"POSITION", positions}}}}}}});
  const int node = writer.add("nodes", {{"name", "Pail"}, {"mesh", mesh}});
  writer.document["nodes"][static_cast<std::size_t>(hand)]["children"].push_back(node);
  return writer.glb();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "glb" && argc == 3) {
    std::ofstream(argv[2], std::ios::binary) << lorica::test::mannequinGlb(true);
  } else if (what == "faces" && argc == 3) {
    std::ofstream(argv[2], std::ios::binary) << lorica::test::facesGlb(true);
  } else if (what == "bucket" && argc == 3) {
    std::ofstream(argv[2], std::ios::binary) << bucketGlb();
  } else if (what == "hulls" && argc == 6) {
    Session session = sessionOf(argv[2], argv[3]);
    std::ofstream(argv[5], std::ios::binary) << inEachFrame(session, std::atoi(argv[4]), hullsOf);
  } else if (what == "touches" && argc == 6) {
    Session session = sessionOf(argv[2], argv[3]);
    ShapeContactQuery query(session.body());
    const auto touches = [&](const Session& posed) { return touchesOf(posed, query); };
    std::ofstream(argv[5], std::ios::binary) << inEachFrame(session, std::atoi(argv[4]), touches);
  } else if (what == "depth" && argc == 5) {
    std::ofstream(argv[4], std::ios::binary) << trackedDepth(argv[2], std::atoi(argv[3]));
  } else {
    return 2;
  }
  return 0;
}
