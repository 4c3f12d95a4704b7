// Cost of importing user files: a character of 60,000 triangles, its body, a BVH file of 10,000 frames. CSV on standard
// output, each row with a reference from the same run that does the minimum of the same work.

#include "bench/large_mannequin.h"
#include "bench/measure.h"
#include "capture/files/bvh_file.h"
#include "capture/retarget/skeletal_retarget.h"
#include "capture/synthetic/synthetic_motion.h"
#include "geometry/files.h"
#include "skinning/body/closed_body.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/import/glb_writer.h"

#include <fmt/format.h>
#include <tiny_gltf.h>
#include <CLI/CLI.hpp>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>

namespace lorica::bench {
namespace {

using Json = nlohmann::json;

struct Options {
  int triangles = 60'000;
  int frames = 10'000;
  int repeats = 7;
  int threads = 0;
};

struct Times {
  double minMs = 0.0;
  double medianMs = 0.0;
  double cpuMs = 0.0;  ///< minimum, over all threads
};

Times timed(int repeats, const std::function<void()>& work) {
  std::vector<double> wall;
  std::vector<double> cpu;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpuStart = std::clock();
    work();
    cpu.push_back(1e3 * static_cast<double>(std::clock() - cpuStart) / CLOCKS_PER_SEC);
    wall.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  return {*std::min_element(wall.begin(), wall.end()), medianOf(wall), *std::min_element(cpu.begin(), cpu.end())};
}

template <typename T>
std::uint64_t hashOf(const std::vector<T>& values, std::uint64_t seed) {
  return contentHash({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)}, seed);
}

std::uint64_t hashOf(const Character& character) {
  std::uint64_t hash = hashOf(character.mesh.vertices, 0);
  hash = hashOf(character.mesh.triangles, hash);
  hash = hashOf(character.influenceBegin, hash);
  for (const Influence& i : character.influences) {  // field by field, because padding bytes are undefined
    hash = contentHash({reinterpret_cast<const char*>(&i.weight), sizeof(i.weight)},
                       hash + static_cast<std::uint64_t>(i.joint));
  }
  return hash;
}

std::uint64_t hashOf(const SkeletalMotion& motion) {
  std::uint64_t hash = hashOf(motion.times, 0);
  for (const JointTransform& t : motion.poses) {
    const std::array<double, 7> numbers = {t.translation.x(),      t.translation.y(),      t.translation.z(),
                                           t.rotation.coeffs()[0], t.rotation.coeffs()[1], t.rotation.coeffs()[2],
                                           t.rotation.coeffs()[3]};
    hash = contentHash({reinterpret_cast<const char*>(numbers.data()), sizeof(numbers)}, hash);
  }
  return hash;
}

/// @param torn  omit six of each thousand triangles, so that a closed surface has to be made
std::string glbOf(const Character& character, bool torn) {
  test::GlbWriter writer;
  const Skeleton& skeleton = character.skeleton;
  Json joints = Json::array();
  Json roots = Json::array();
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const Joint& joint = skeleton.joint(j);
    const Vec3& t = joint.rest.translation;
    const Quat& r = joint.rest.rotation;
    Json node = {
        {"name", joint.name}, {"translation", {t.x(), t.y(), t.z()}}, {"rotation", {r.x(), r.y(), r.z(), r.w()}}};
    for (JointIndex c = j + 1; c < skeleton.jointCount(); ++c) {
      if (skeleton.joint(c).parent == j) node["children"].push_back(c);
    }
    writer.add("nodes", node);
    joints.push_back(j);
    if (joint.parent == kNoJoint) roots.push_back(j);
  }
  std::vector<Triangle> triangles;
  triangles.reserve(character.mesh.triangles.size());
  for (std::size_t t = 0; t < character.mesh.triangles.size(); ++t) {
    if (!torn || t % 1000 >= 6) triangles.push_back(character.mesh.triangles[t]);
  }
  std::vector<std::uint16_t> joint4(4 * character.mesh.vertices.size(), 0);
  std::vector<float> weight4(joint4.size(), 0.0F);
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    std::vector<Influence> own(character.influences.begin() + character.influenceBegin[v],
                               character.influences.begin() + character.influenceBegin[v + 1]);
    std::stable_sort(own.begin(), own.end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    for (std::size_t k = 0; k < std::min<std::size_t>(4, own.size()); ++k) {
      joint4[4 * v + k] = static_cast<std::uint16_t>(own[k].joint);
      weight4[4 * v + k] = static_cast<float>(own[k].weight);
    }
  }
  const int positions = writer.positions(character.mesh.vertices);
  const int indices = writer.triangles(triangles);
  const int jointsOf = writer.accessor(joint4, "VEC4");
  const int weightsOf = writer.accessor(weight4, "VEC4");
  const int matrices = writer.matrices(character.jointFromModel);
  const Json attributes = {{"POSITION", positions}, {"JOINTS_0", jointsOf}, {"WEIGHTS_0", weightsOf}};
  writer.add("meshes", {{"primitives", {{{"attributes", attributes}, {"indices", indices}}}}});
  writer.add("skins", {{"joints", joints}, {"inverseBindMatrices", matrices}});
  roots.push_back(writer.add("nodes", {{"name", "skin"}, {"mesh", 0}, {"skin", 0}}));
  writer.add("scenes", {{"nodes", roots}});
  writer.document["scene"] = 0;
  return writer.glb();
}

/// The shipped walk on the mannequin, repeated.
Result<SkeletalMotion> longMotion(int frames) {
  const Result<SkeletalMotion> walk = skeletalMotionOf(synthesizeMotion(SyntheticMotion::kWalk));
  if (!walk) return walk.error();
  Result<SkeletalMotion> motion = retargetMotion(*walk, makeMannequin().skeleton);
  if (!motion) return motion.error();
  const int length = motion->frameCount();
  SkeletalMotion out{"long", motion->skeleton, {}, {}};
  out.times.reserve(frames);
  out.poses.reserve(static_cast<std::size_t>(frames) * motion->poses.size() / static_cast<std::size_t>(length));
  for (int f = 0; f < frames; ++f) {
    const std::span<const JointTransform> pose = motion->pose(f % length);
    out.times.push_back(f / 30.0);
    out.poses.insert(out.poses.end(), pose.begin(), pose.end());
  }
  return out;
}

void print(const char* task, std::size_t size, const Times& times, const char* reference, const Times& min,
           double targetMs, std::uint64_t hash) {
  fmt::print("{},{},{:.2f},{:.2f},{:.2f},{},{:.2f},{:.2f},{:.0f},{:016x}\n", task, size, times.minMs, times.medianMs,
             times.cpuMs, reference, min.cpuMs, times.cpuMs / min.cpuMs, targetMs, hash);
  std::fflush(stdout);
}

int measureCharacter(const Character& character, bool torn, const Options& options) {
  const std::string glb = glbOf(character, torn);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(glb));
  const Times bare = timed(options.repeats, [&] {
    tinygltf::Model model;
    tinygltf::TinyGLTF reader;
    std::string error;
    std::string warning;
    LORICA_CHECK(
        reader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
                                    static_cast<unsigned int>(glb.size())),
        "tinygltf must read the output of this program");
  });
  Result<CharacterFile> file = parseCharacterFile(bytes, "bench.glb");
  if (!file) return fail(file.error());
  const Times load = timed(options.repeats, [&] { file = parseCharacterFile(bytes, "bench.glb"); });
  const std::size_t triangleCount = file->character.mesh.triangles.size();
  print(torn ? "load torn" : "load", triangleCount, load, "tinygltf alone", bare, 300.0, hashOf(file->character));

  const BodySettings settings{.resolution = 0.0, .threads = options.threads};
  Result<ClosedBody> body = makeBody(file->character, settings);
  if (!body) return fail(body.error());
  const Times made = timed(options.repeats, [&] { body = makeBody(file->character, settings); });
  if (body->made != torn) return fail({ErrorCode::kInvalidArgument, "the body was not made in the expected way"});
  print(torn ? "body made" : "body kept", triangleCount, made, "load", load, 3000.0, hashOf(body->character));
  return 0;
}

int measureBvh(const Options& options) {
  const Result<SkeletalMotion> motion = longMotion(options.frames);
  if (!motion) return fail(motion.error());
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("lorica_bench_{}.bvh", ::getpid());
  const Result<void> written = writeBvh(path, *motion);
  const Result<std::string> text = written ? readFile(path) : Result<std::string>(written.error());
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  if (!text) return fail(text.error());

  const std::size_t begin = text->find("Frame Time:");
  const Times numbers = timed(options.repeats, [&] {
    const char* at = text->c_str() + text->find('\n', begin);
    std::vector<double> values;
    for (char* end = nullptr;; at = end) {
      const double value = std::strtod(at, &end);
      if (end == at) break;
      values.push_back(value);
    }
    LORICA_CHECK(values.size() >= static_cast<std::size_t>(options.frames), "every frame must have numbers");
  });
  Result<BvhFile> file = parseBvh(*text, "bench.bvh");
  if (!file) return fail(file.error());
  const Times read = timed(options.repeats, [&] { file = parseBvh(*text, "bench.bvh"); });
  if (file->motion.frameCount() != options.frames) {
    return fail({ErrorCode::kInvalidArgument, fmt::format("read {} frames, not all", file->motion.frameCount())});
  }
  print("bvh", file->motion.poses.size(), read, "strtod of its numbers", numbers, 200.0, hashOf(file->motion));
  return 0;
}

int run(const Options& options) {
  fmt::print("task,size,ms_min,ms_median,cpu_ms_min,reference,reference_cpu_ms,ratio,target_ms,hash\n");
  const Character character = largeMannequin(static_cast<std::size_t>(options.triangles));
  for (const bool torn : {false, true}) {
    if (const int failed = measureCharacter(character, torn, options); failed != 0) return failed;
  }
  return measureBvh(options);
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Measures the time to read a large character, to make its body, and to read a long BVH file.");
  app.add_option("--triangles", options.triangles, "Triangles of the character [default: 60,000]")
      ->check(CLI::Range(20'000, 4'000'000));
  app.add_option("--frames", options.frames, "Frames of the BVH file [default: 10,000]")
      ->check(CLI::Range(2, 1'000'000));
  app.add_option("--repeats", options.repeats, "Repeats of each measurement [default: 7]")->check(CLI::Range(1, 1000));
  app.add_option("--threads", options.threads, "Threads for the body [default: all]")->check(CLI::Range(0, 256));
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
