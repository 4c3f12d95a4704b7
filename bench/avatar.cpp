// Cost of drawing avatars with their materials, against the same triangles as a plain mesh skinned on the CPU, in the
// same run. CSV on standard output.

#include "bench/large_mannequin.h"
#include "bench/measure.h"
#include "geometry/convex_hull.h"
#include "geometry/files.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "viewer/renderer/avatar_mesh.h"
#include "viewer/renderer/renderer.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>
#include <numbers>

namespace lorica::bench {
namespace {

constexpr int kPictures = 6;
constexpr std::array kQualities = {RenderQuality::kHigh, RenderQuality::kMedium, RenderQuality::kLow};
constexpr std::array kQualityNames = {"high", "medium", "low"};

struct Options {
  int triangles = 60'000;
  int side = 4096;
  int repeats = 15;
  int width = 1280;
  int height = 720;
};

/// What a texture holds, so that compression, mip maps and caches get the usual work.
enum class Holds { kColor, kNormal, kNumbers };

/// A checker with noise from a fixed generator.
Picture checker(int side, Holds holds, std::uint32_t seed) {
  Picture picture;
  picture.width = picture.height = side;
  picture.rgba.resize(4 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  std::uint32_t state = seed * 2654435761u + 1;
  std::size_t at = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x, at += 4) {
      state = state * 1664525u + 1013904223u;
      const auto noise = static_cast<int>(state >> 27);  // 0 to 31
      const int tile = ((x * 64 / side) ^ (y * 64 / side)) & 1;
      std::array<int, 3> rgb = {150 + 60 * tile + noise, 110 + 50 * tile + noise, 90 + 30 * tile + noise};
      if (holds == Holds::kNormal) rgb = {112 + noise, 112 + 31 - noise, 250};
      if (holds == Holds::kNumbers) rgb = {255 - noise, 100 + 80 * tile + noise, 30 * tile};
      for (std::size_t c = 0; c < 3; ++c) picture.rgba[at + c] = static_cast<std::uint8_t>(rgb[c]);
      picture.rgba[at + 3] = 255;
    }
  }
  return picture;
}

[[nodiscard]] TextureUse use(int picture) {
  TextureUse made;
  made.picture = picture;
  return made;
}

/// The character with normals, tangents and texture coordinates, in twelve groups of triangles with the materials in
/// turn.
std::shared_ptr<Avatar> dressed(const Character& character, std::vector<Material> materials,
                                std::span<const Picture> pictures) {
  auto avatar = std::make_shared<Avatar>();
  avatar->character = character;
  avatar->pictures.assign(pictures.begin(), pictures.end());
  Look& look = avatar->look;
  look.normals.assign(character.mesh.vertices.size(), Vec3f::Zero());
  for (const Triangle& t : character.mesh.triangles) {
    const Vec3& a = character.mesh.vertices[t[0]];
    const Vec3 normal = (character.mesh.vertices[t[1]] - a).cross(character.mesh.vertices[t[2]] - a);
    for (const VertexIndex v : t) look.normals[v] += normal.cast<float>();
  }
  for (std::size_t v = 0; v < look.normals.size(); ++v) {
    Vec3f& n = look.normals[v];
    n = n.stableNormalized();
    const Vec3f along = Vec3f::UnitY().cross(n) + 1e-3f * Vec3f::UnitX();
    look.tangents.emplace_back(along.x(), along.y(), along.z(), 1.0f);
    look.tangents.back().head<3>().normalize();
    const Vec3& p = character.mesh.vertices[v];
    look.uv[0].emplace_back(static_cast<float>(std::atan2(p.x(), p.z()) / 3.2), static_cast<float>(1.0 - p.y()));
  }
  constexpr std::size_t kGroups = 12;
  const std::size_t count = character.mesh.triangles.size();
  for (std::size_t g = 0; g < kGroups; ++g) {
    const std::size_t first = count * g / kGroups;
    look.groups.push_back(
        {"body", static_cast<int>(g % materials.size()), first, count * (g + 1) / kGroups - first, false});
  }
  look.materials = std::move(materials);
  return avatar;
}

/// A closed body as tall as a person, with the mannequin's skeleton: 100 rings of 50 quads.
Character smallBody() {
  constexpr int kRings = 100, kSides = 50;
  Character body = makeMannequin();
  body.mesh = {};
  body.influences.clear();
  body.influenceBegin = {0};
  for (int ring = 0; ring <= kRings; ++ring) {
    const double height = static_cast<double>(ring) / kRings;
    const double radius = 0.25 * std::sqrt(std::sin(std::numbers::pi * height)) + 1e-4;
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2.0 * std::numbers::pi * side / kSides;
      body.mesh.vertices.emplace_back(radius * std::sin(angle), 0.1 + 1.6 * height, radius * std::cos(angle));
      const JointIndex joint = std::min(body.skeleton.jointCount() - 2, ring / 8);
      body.influences.insert(body.influences.end(), {{joint, 0.6}, {joint + 1, 0.4}});
      body.influenceBegin.push_back(static_cast<std::uint32_t>(body.influences.size()));
      if (ring == kRings) continue;
      const int a = ring * kSides + side, b = ring * kSides + (side + 1) % kSides;
      body.mesh.triangles.push_back({a, b, b + kSides});
      body.mesh.triangles.push_back({a, b + kSides, a + kSides});
    }
  }
  return body;
}

/// Two materials with three textures each.
std::vector<Material> physicalMaterials() {
  std::vector<Material> made(2);
  for (int m = 0; m < 2; ++m) {
    made[m].base = use(3 * m);
    made[m].normal = use(3 * m + 1);
    made[m].metallicRoughness = made[m].occlusion = use(3 * m + 2);
  }
  return made;
}

std::vector<Material> toonMaterials() {
  std::vector<Material> made(2);
  for (int m = 0; m < 2; ++m) {
    made[m].shading = Shading::kToon;
    made[m].base = use(3 * m);
    made[m].normal = use(3 * m + 1);
    made[m].toon.shade = use(3 * m + 2);
    made[m].toon.shadeColor = {0.7f, 0.6f, 0.65f};
    made[m].toon.outline = OutlineMode::kWorld;
    made[m].toon.outlineWidth = 0.002f;
    made[m].toon.rimColor = {0.1f, 0.1f, 0.1f};
  }
  return made;
}

/// Six materials with one texture each, as VRM files of 10,000 triangles have.
std::vector<Material> simpleToonMaterials() {
  std::vector<Material> made(kPictures);
  for (int m = 0; m < kPictures; ++m) {
    made[m].shading = Shading::kToon;
    made[m].base = made[m].toon.shade = use(m);
    made[m].toon.shadeColor = {0.8f, 0.7f, 0.7f};
    made[m].toon.outline = OutlineMode::kWorld;
    made[m].toon.outlineWidth = 0.002f;
    made[m].doubleSided = true;
  }
  return made;
}

/// The character in motion, and its scenes with and without materials.
class Dancer {
 public:
  explicit Dancer(const Character& character) : character_(character), pose_(restPose(character.skeleton)) {
    worldFromModel_.resize(pose_.size());
    posed_.resize(character.mesh.vertices.size());
    hull_.resize(1);
    hull_[0].shape = convexHull(character.mesh.vertices);
  }

  /// The scene in a frame, with the skinning that it needs.
  [[nodiscard]] Scene scene(int frame, const std::shared_ptr<const Avatar>& avatar) {
    Pose pose = pose_;
    for (std::size_t j = 1; j < pose.size(); ++j) {
      const double angle = 0.1 * std::sin(0.21 * frame + static_cast<double>(j));
      pose[j].rotation = pose[j].rotation * Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
    }
    computeWorldFromJoint(character_.skeleton, pose, worldFromModel_);
    computeWorldFromModel(character_, worldFromModel_, worldFromModel_);
    Scene scene;
    scene.parts = hull_;
    if (avatar != nullptr) {
      scene.avatar = avatar;
      scene.worldFromModel = worldFromModel_;
      return scene;
    }
    skinLinearBlend(character_, worldFromModel_, posed_);
    scene.vertices = posed_;
    scene.triangles = character_.mesh.triangles;
    return scene;
  }

 private:
  const Character& character_;
  Pose pose_;
  std::vector<Affine3> worldFromModel_;
  std::vector<Vec3> posed_;
  std::vector<LivePart> hull_;
};

struct Cost {
  double wall = 0.0;  ///< [ms]
  double cpu = 0.0;   ///< of all threads [ms]
};

Cost costOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpuStart = std::clock();
  work();
  return {std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count(),
          1e3 * static_cast<double>(std::clock() - cpuStart) / CLOCKS_PER_SEC};
}

/// The costs of several pictures.
struct Costs {
  std::vector<double> wall, cpu;

  void add(const Cost& cost) {
    wall.push_back(cost.wall);
    cpu.push_back(cost.cpu);
  }
  [[nodiscard]] double leastWall() const { return *std::min_element(wall.begin(), wall.end()); }
  [[nodiscard]] double leastCpu() const { return *std::min_element(cpu.begin(), cpu.end()); }
};

[[nodiscard]] std::size_t gpuBytes(const Avatar& avatar) {
  std::size_t textures = 0;
  for (const Picture& picture : avatar.pictures) textures += picture.rgba.size() / 3 * 4;  // smaller copies add a third
  return textures + avatar.character.mesh.vertices.size() * (sizeof(AvatarShape) + sizeof(AvatarVertex)) +
         avatar.character.mesh.triangles.size() * 3 * sizeof(std::uint32_t);
}

struct Named {
  const char* name;
  std::shared_ptr<const Avatar> avatar;
};

void measure(Renderer& renderer, const Character& character, std::span<const Named> avatars, const Options& options) {
  Dancer dancer(character);
  SceneOptions show;
  show.colorSkinByPart = show.hulls = false;
  const Camera camera;
  std::uint64_t hash = 0;
  const auto draw = [&](int frame, const std::shared_ptr<const Avatar>& avatar) {
    renderer.draw(dancer.scene(frame, avatar), show, camera, options.width, options.height);
    const Image image = renderer.readBack();
    hash = contentHash({reinterpret_cast<const char*>(image.rgba.data()), image.rgba.size()}, hash);
  };
  for (const Named& tested : avatars) {
    renderer.setQuality(RenderQuality::kHigh);
    const double first = costOf([&] { draw(0, tested.avatar); }).wall;
    const double later = costOf([&] { draw(0, tested.avatar); }).wall;
    fmt::print("# {}: {} triangles, {:.0f} MiB on the GPU; the first picture takes {:.0f} ms longer than the next\n",
               tested.name, character.mesh.triangles.size(), static_cast<double>(gpuBytes(*tested.avatar)) / 1048576.0,
               first - later);
  }
  for (std::size_t q = 0; q < kQualities.size(); ++q) {
    renderer.setQuality(kQualities[q]);
    Costs plain;
    std::vector<Costs> costs(avatars.size());
    std::vector<std::uint64_t> hashes(avatars.size());
    for (int r = -2; r < options.repeats; ++r) {  // two to warm up
      const Cost base = costOf([&] { draw(r, nullptr); });
      if (r >= 0) plain.add(base);
      for (std::size_t a = 0; a < avatars.size(); ++a) {
        hash = hashes[a];
        const Cost cost = costOf([&] { draw(r, avatars[a].avatar); });
        hashes[a] = hash;
        if (r >= 0) costs[a].add(cost);
      }
    }
    for (std::size_t a = 0; a < avatars.size(); ++a) {
      fmt::print("{},{},{},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{:.2f},{:016x}\n", avatars[a].name,
                 character.mesh.triangles.size(), kQualityNames[q], costs[a].leastWall(), medianOf(costs[a].wall),
                 costs[a].leastCpu(), plain.leastWall(), medianOf(plain.wall), plain.leastCpu(),
                 costs[a].leastCpu() / plain.leastCpu(), hashes[a]);
      std::fflush(stdout);
    }
  }
}

int run(const Options& options) {
  const Result<OffscreenContext> context = OffscreenContext::create();
  if (!context) return fail(context.error());
  Result<Renderer> renderer = Renderer::create(context->getProc());
  if (!renderer) return fail(renderer.error());
  fmt::print("# {}, {} x {} pixels, six textures of {} x {}\n", context->description(), options.width, options.height,
             options.side, options.side);
  std::vector<Picture> pictures;
  for (int i = 0; i < kPictures; ++i) {
    const Holds holds = i % 3 == 0 ? Holds::kColor : i % 3 == 1 ? Holds::kNormal : Holds::kNumbers;
    pictures.push_back(checker(options.side, holds, static_cast<std::uint32_t>(i)));
  }
  fmt::print(
      "avatar,triangles,quality,ms_min,ms_median,cpu_ms_min,plain_ms_min,plain_ms_median,plain_cpu_ms_min,cpu_ratio,"
      "hash\n");
  const Character large = largeMannequin(static_cast<std::size_t>(options.triangles));
  const std::array largeOnes = {Named{"physical", dressed(large, physicalMaterials(), pictures)},
                                Named{"toon", dressed(large, toonMaterials(), pictures)}};
  measure(*renderer, large, largeOnes, options);
  const Character small = smallBody();
  const std::array smallOnes = {Named{"small toon", dressed(small, simpleToonMaterials(), pictures)}};
  measure(*renderer, small, smallOnes, options);
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Measures the time to draw avatars with their materials, against plain meshes of the same triangles.");
  app.add_option("--triangles", options.triangles, "Triangles of the large avatars [default: 60,000]")
      ->check(CLI::Range(20'000, 4'000'000));
  app.add_option("--side", options.side, "Sides of the textures in pixels [default: 4096]")->check(CLI::Range(1, 8192));
  app.add_option("--repeats", options.repeats, "Pictures of each kind [default: 15]")->check(CLI::Range(1, 1000));
  app.add_option("--width", options.width, "Of the picture in pixels [default: 1280]")->check(CLI::Range(1, 8192));
  app.add_option("--height", options.height, "Of the picture in pixels [default: 720]")->check(CLI::Range(1, 8192));
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
