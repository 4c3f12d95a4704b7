// What the tests of the C interface and of the Python module compare with, made by the library itself.
//
//   truth glb OUT.glb                             the mannequin as a user's file: an open surface, two clips
//   truth hulls BODY.lorica MOTION FRAMES OUT     the hulls of a session's first frames, in world space: for each part
//                                                 its counts of vertices and triangles (int32), x y z (float64) and
//                                                 indices (int32)

#include "acd/decomposition_file.h"
#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "session/demo_scene.h"
#include "session/prepare/motion.h"
#include "session/session.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/apps/mannequin_glb.h"

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

std::string hullsOfSession(const std::filesystem::path& body, const std::filesystem::path& file, int frames) {
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
  Session session = Session::create(character, content.decomposition, std::move(source), makeDemoWorld(kDemoSeed),
                                    content.cover, content.training)
                        .value();
  std::string bytes;
  for (int frame = 0; frame < frames && session.step().value(); ++frame) bytes += hullsOf(session);
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "glb" && argc == 3) {
    std::ofstream(argv[2], std::ios::binary) << lorica::test::mannequinGlb(true);
  } else if (what == "hulls" && argc == 6) {
    std::ofstream(argv[5], std::ios::binary) << hullsOfSession(argv[2], argv[3], std::atoi(argv[4]));
  } else {
    return 2;
  }
  return 0;
}
