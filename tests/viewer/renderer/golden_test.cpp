#include "tests/support/meshes.h"
#include "tests/viewer/renderer/picture_error.h"
#include "tests/viewer/renderer/pictures.h"

#include "geometry/convex_hull.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>

namespace lorica {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

/// The joint with the largest weight of a vertex.
JointIndex leader(const Character& character, VertexIndex v) {
  const auto i = static_cast<std::size_t>(v);
  Influence best;
  for (std::uint32_t k = character.influenceBegin[i]; k < character.influenceBegin[i + 1]; ++k) {
    if (character.influences[k].weight > best.weight) best = character.influences[k];
  }
  return best.joint;
}

/// The mannequin in its bind pose, with one part for each bone except the fingers, and props around it.
struct Golden : ::testing::Test {
  static const Character& mannequin() {
    static const Character character = makeMannequin();
    return character;
  }

  std::vector<PartIndex> partOfTriangle;
  std::vector<LivePart> parts;
  std::vector<Affine3> worldFromJoint;
  std::vector<Prop> props;
  std::vector<Contact> contacts;
  std::vector<Vec3f> particles;
  Image inset;
  Scene scene;
  SceneOptions nothing;
  Camera camera;

  Golden() {
    const Character& character = mannequin();
    std::vector<std::vector<Vec3>> pointsOfJoint(static_cast<std::size_t>(character.skeleton.jointCount()));
    std::vector<PartIndex> partOfVertex;
    partOfVertex.reserve(character.mesh.vertices.size());
    for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
      JointIndex joint = leader(character, static_cast<VertexIndex>(v));
      while (isFinger(character.skeleton.joint(joint).name)) joint = character.skeleton.joint(joint).parent;
      partOfVertex.push_back(static_cast<PartIndex>(joint));
      pointsOfJoint[joint].push_back(character.mesh.vertices[v]);
    }
    partOfTriangle.reserve(character.mesh.triangles.size());
    for (const Triangle& t : character.mesh.triangles) {
      partOfTriangle.push_back(partOfVertex[t[0]]);
    }
    parts.resize(pointsOfJoint.size());
    for (std::size_t j = 0; j < parts.size(); ++j) parts[j].shape = convexHull(pointsOfJoint[j]);
    worldFromJoint.reserve(character.jointFromModel.size());
    for (const Affine3& jointFromModel : character.jointFromModel) worldFromJoint.push_back(jointFromModel.inverse());

    for (int i = 0; i < 5; ++i) {
      Prop prop;
      prop.shape = static_cast<PropShape>(i);
      prop.halfExtents = Vec3(0.13, 0.2, i == 0 ? 0.1 : 0.13);
      prop.worldFromProp.translation() = Vec3(-0.9 + 0.45 * i, 0.22 + 0.06 * i, 0.6);
      prop.worldFromProp.rotate(Eigen::AngleAxisd(0.4 + 0.2 * i, Vec3(1.0, 0.5 * i, 0.7).normalized()));
      prop.color = Vec3f(0.15f + 0.15f * static_cast<float>(i), 0.35f, 0.75f - 0.15f * static_cast<float>(i));
      if (prop.shape == PropShape::kMesh) {
        auto mesh = std::make_shared<PropMeshShape>();
        mesh->shown = test::makeTorus(0.16, 0.06, 24, 12);
        mesh->hulls = {convexHull(mesh->shown.vertices)};
        prop.mesh = mesh;
      }
      props.push_back(prop);
    }
    for (int i = 0; i < 16; ++i) {
      Contact contact;
      contact.point = Vec3(-0.75 + 0.1 * i, 1.2 + 0.3 * std::sin(1.1 * i), i % 3 == 0 ? -0.3 : 0.35);
      contacts.push_back(contact);
    }
    // A cone of balls in layers.
    for (int layer = 0; layer < 16; ++layer) {
      for (int i = -16; i <= 16; ++i) {
        for (int k = -16; k <= 16; ++k) {
          const double half = 0.5 * (layer % 2);
          if (std::hypot(i + half, k + half) > 15.5 - layer) continue;
          particles.push_back(
              (Vec3(0.55 + 0.025 * (i + half), 0.0125 + 0.018 * layer, 0.1 + 0.025 * (k + half))).cast<float>());
        }
      }
    }
    inset = {80, 60, {}};
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 80; ++x) {
        const bool ring = std::abs(std::hypot(x - 40, y - 25) - 15) < 4;
        for (const int c : {ring ? 250 : 20, 3 * x, 4 * y, 255}) inset.rgba.push_back(static_cast<std::uint8_t>(c));
      }
    }

    scene.vertices = character.mesh.vertices;
    scene.triangles = character.mesh.triangles;
    scene.partOfTriangle = partOfTriangle;
    scene.parts = parts;
    scene.props = props;
    scene.contacts = contacts;
    scene.particles = particles;
    scene.particleRadius = 0.0125f;
    scene.skeleton = &character.skeleton;
    scene.worldFromJoint = worldFromJoint;
    nothing.skin = nothing.colorSkinByPart = nothing.hulls = nothing.props = false;
    nothing.contacts = nothing.particles = nothing.ground = false;
    camera.eye = {1.5, 1.5, 3.3};
    camera.target = {0.0, 0.85, 0.0};
  }

  static bool isFinger(const std::string& name) {
    for (const char* finger : {"Thumb", "Index", "Middle", "Ring", "Little"}) {
      if (name.find(finger) != std::string::npos) return true;
    }
    return false;
  }

  [[nodiscard]] SceneOptions showing(std::string_view what) const {
    SceneOptions show = nothing;
    const auto has = [what](std::string_view word) { return what.find(word) != std::string_view::npos; };
    show.skin = has("skin");
    show.colorSkinByPart = has("colours");
    show.hulls = has("hulls");
    show.bones = has("bones");
    show.props = has("props");
    show.contacts = has("contacts");
    show.particles = has("particles");
    show.ground = has("ground");
    if (has("caption")) show.caption = "walk   1.5 s   16 convex parts";
    if (has("panel")) show.panel = "pose\t0.12 ms\nhulls\t0.40 ms\nphysics\t0.31 ms";
    return show;
  }

  [[nodiscard]] Image drawn(test::Studio& studio, std::string_view what) const {
    Scene shown = scene;
    if (what.find("inset") != std::string_view::npos) shown.inset = &inset;
    return studio.draw(shown, showing(what), camera, kWidth, kHeight);
  }
};

/// What to draw with an overlay, and without it.
struct Overlay {
  const char* name;
  const char* with;
  const char* without;
};

class GoldenOverlay : public Golden, public ::testing::WithParamInterface<Overlay> {};

TEST_P(GoldenOverlay, IsAsItWas) {
  const auto& [name, with, without] = GetParam();
  LORICA_REQUIRE_STUDIO(studio, "");
  test::expectGolden(name, drawn(*studio, with));
  // Without the overlay the comparison must fail, otherwise it would not detect a missing overlay.
  EXPECT_GT(test::pictureError(drawn(*studio, without), test::readGolden(name)).wrong, 4.0 * test::kMaxWrong)
      << name << ": the comparison does not detect the missing overlay";
}

INSTANTIATE_TEST_SUITE_P(
    Each, GoldenOverlay,
    ::testing::Values(Overlay{"skin", "skin", ""}, Overlay{"parts", "skin colours", "skin"},
                      Overlay{"hulls", "skin hulls", "skin"}, Overlay{"bones", "skin bones", "skin"},
                      Overlay{"props", "ground props", "ground"}, Overlay{"contacts", "skin contacts", "skin"},
                      Overlay{"ground", "skin props ground", "skin props"},
                      Overlay{"particles", "skin ground particles", "skin ground"}, Overlay{"inset", "inset", ""},
                      Overlay{"caption", "caption", ""}, Overlay{"panel", "panel", ""}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(PictureError, SmallDifferencesAreNone) {
  Image a{40, 30, std::vector<std::uint8_t>(40 * 30 * 4, 200)};
  for (int y = 0; y < 30; ++y) {
    for (int x = 10; x < 20; ++x) a.rgba[4 * (40 * y + x)] = 20;
  }
  EXPECT_EQ(test::pictureError(a, a).wrong, 0.0);
  Image moved = a;
  std::rotate(moved.rgba.begin(), moved.rgba.begin() + 4, moved.rgba.end());  // by one pixel
  EXPECT_EQ(test::pictureError(a, moved).wrong, 0.0);
  Image darker = a;
  for (std::uint8_t& c : darker.rgba) c = static_cast<std::uint8_t>(std::max(0, c - 35));
  EXPECT_EQ(test::pictureError(a, darker).wrong, 0.0);
}

TEST(PictureError, IsTheShareOfPixelsThatHaveNothingLikeThemNearby) {
  const Image white{40, 30, std::vector<std::uint8_t>(40 * 30 * 4, 255)};
  Image square = white;
  for (int y = 5; y < 15; ++y) {
    for (int x = 8; x < 20; ++x) square.rgba[4 * (40 * y + x) + 1] = 0;
  }
  EXPECT_DOUBLE_EQ(test::pictureError(white, square).wrong, 10.0 * 12.0 / (40.0 * 30.0));
  EXPECT_DOUBLE_EQ(test::pictureError(square, white).wrong, 10.0 * 12.0 / (40.0 * 30.0));
  const Image other{30, 40, std::vector<std::uint8_t>(40 * 30 * 4, 255)};
  EXPECT_EQ(test::pictureError(white, other).wrong, 1.0);
  // A missing line of one pixel width is detected in both directions.
  Image line = white;
  for (int y = 0; y < 30; ++y) line.rgba[4 * (40 * y + 7)] = 0;
  EXPECT_DOUBLE_EQ(test::pictureError(white, line).wrong, 1.0 / 40.0);
  EXPECT_DOUBLE_EQ(test::pictureError(line, white).wrong, 1.0 / 40.0);
}

}  // namespace
}  // namespace lorica
