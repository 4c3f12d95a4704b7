#include "tests/viewer/renderer/avatars.h"

#include "tests/support/meshes.h"
#include "tests/viewer/renderer/pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace lorica::test {

AvatarMaker::AvatarMaker(int joints) {
  std::vector<Joint> chain(static_cast<std::size_t>(joints));
  for (int j = 0; j < joints; ++j) {
    chain[j].name = "joint " + std::to_string(j);
    chain[j].parent = j - 1;
  }
  avatar.character.skeleton = Skeleton::create(std::move(chain)).value();
  avatar.character.jointFromModel.assign(static_cast<std::size_t>(joints), Affine3::Identity());
  avatar.character.influenceBegin = {0};
}

int AvatarMaker::material(const Material& material) {
  avatar.look.materials.push_back(material);
  return static_cast<int>(avatar.look.materials.size()) - 1;
}

TextureUse AvatarMaker::picture(int width, int height, std::vector<std::array<std::uint8_t, 4>> texels) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  for (const auto& texel : texels) picture.rgba.insert(picture.rgba.end(), texel.begin(), texel.end());
  avatar.pictures.push_back(std::move(picture));
  TextureUse use;
  use.picture = static_cast<int>(avatar.pictures.size()) - 1;
  use.smooth = false;
  use.wrapU = use.wrapV = TextureWrap::kClamp;
  return use;
}

VertexIndex AvatarMaker::vertex(const Vec3& position, const Vec3f& normal) {
  Character& character = avatar.character;
  character.mesh.vertices.push_back(position);
  avatar.look.normals.push_back(normal);
  avatar.look.tangents.emplace_back(0.0f, 0.0f, 0.0f, 0.0f);
  avatar.look.uv[0].emplace_back(0.0f, 0.0f);
  avatar.look.colors.emplace_back(1.0f, 1.0f, 1.0f, 1.0f);
  character.influences.push_back({0, 1.0});
  character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  return static_cast<VertexIndex>(character.mesh.vertices.size()) - 1;
}

void AvatarMaker::group(std::size_t firstTriangle) {
  const std::size_t count = avatar.character.mesh.triangles.size() - firstTriangle;
  avatar.look.groups.push_back(
      {"made", static_cast<int>(avatar.look.materials.size()) - 1, firstTriangle, count, false});
}

void AvatarMaker::add(const Quad& quad) {
  const std::size_t first = avatar.character.mesh.triangles.size();
  const double side = quad.facesAway ? -1.0 : 1.0;
  const Vec3f normal = quad.normal.value_or(Vec3f(0.0f, 0.0f, static_cast<float>(side)));
  std::array<VertexIndex, 4> corners;
  // Counter-clockwise from its front, beginning at the lower left.
  const std::array<std::pair<int, int>, 4> places = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& [x, y] = places[i];
    corners[i] = vertex(quad.center + quad.half * Vec3(side * x, y, 0.0), normal);
    avatar.look.uv[0].back() = {x < 0 ? quad.uLeft : quad.uRight, y < 0 ? quad.vBottom : quad.vTop};
    avatar.look.tangents.back() = quad.tangent;
    avatar.look.colors.back() = quad.color;
  }
  avatar.character.mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  avatar.character.mesh.triangles.push_back({corners[0], corners[2], corners[3]});
  group(first);
  avatar.look.groups.back().flat = normal.isZero();
}

void AvatarMaker::addSphere(const Vec3& center, double radius, int rings, int segments) {
  const std::size_t first = avatar.character.mesh.triangles.size();
  const TriMesh sphere = makeSphere(radius, rings, segments);
  const auto offset = static_cast<VertexIndex>(avatar.character.mesh.vertices.size());
  for (const Vec3& v : sphere.vertices) vertex(center + v, v.cast<float>().normalized());
  for (const Triangle& t : sphere.triangles) {
    avatar.character.mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  group(first);
}

void AvatarMaker::addSkirt(const Vec3& center, double radiusAbove, double radiusBelow, double height, int segments) {
  const std::size_t first = avatar.character.mesh.triangles.size();
  const auto offset = static_cast<VertexIndex>(avatar.character.mesh.vertices.size());
  const Vec3 slope(height, radiusBelow - radiusAbove, 0.0);  // of the normal at the +X side
  for (int i = 0; i < segments; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / segments;
    const Vec3 out(std::cos(angle), 0.0, -std::sin(angle));
    const Vec3f normal = (slope.x() * out + slope.y() * Vec3::UnitY()).normalized().cast<float>();
    vertex(center + radiusAbove * out + 0.5 * height * Vec3::UnitY(), normal);
    vertex(center + radiusBelow * out - 0.5 * height * Vec3::UnitY(), normal);
    const auto at = [&](int k) { return offset + static_cast<VertexIndex>((2 * i + k) % (2 * segments)); };
    avatar.character.mesh.triangles.push_back({at(0), at(1), at(2)});
    avatar.character.mesh.triangles.push_back({at(2), at(1), at(3)});
  }
  group(first);
}

void AvatarMaker::spreadInfluences(int count, std::uint32_t seed) {
  Character& character = avatar.character;
  std::mt19937 random(seed);
  character.influences.clear();
  character.influenceBegin = {0};
  const auto joints = static_cast<std::uint32_t>(character.skeleton.jointCount());
  for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
    std::vector<double> weights;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      weights.push_back(1.0 + random() % 100);
      sum += weights.back();
    }
    for (const double weight : weights) {
      character.influences.push_back({static_cast<JointIndex>(random() % joints), weight / sum});
    }
    character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  }
}

AvatarOnStage::AvatarOnStage(Avatar made)
    : worldFromModel(made.character.jointFromModel.size(), Affine3::Identity()),
      around_{boxPart({-1.0, 0.0, -1.0}, {1.0, 2.0, 1.0})} {
  avatar = std::make_shared<const Avatar>(std::move(made));
}

Scene AvatarOnStage::scene() const {
  Scene scene;
  scene.avatar = avatar;
  scene.worldFromModel = worldFromModel;
  scene.parts = around_;
  return scene;
}

SceneOptions onBlack(const AvatarLight& light) {
  SceneOptions options;
  options.colorSkinByPart = options.hulls = options.ground = false;
  options.background = Vec3f::Zero();
  options.light = light;
  return options;
}

AvatarLight dark() {
  return {Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero()};
}

Vec3 towardsLight() {
  return Vec3(-0.42, 1.0, 0.52).normalized();
}

int byteOf(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return static_cast<int>(std::lround(255.0 * (c < 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055)));
}

double linearOf(int byte) {
  const double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

}  // namespace lorica::test
