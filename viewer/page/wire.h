#pragma once

#include "collision/world/world.h"
#include "geometry/math.h"
#include "geometry/tri_mesh.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/scene.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// What clients get while a session runs: docs/WIRE.md.

namespace lorica {

/// The layers that a client may ask for, as bits.
namespace served {
inline constexpr unsigned kHulls = 1, kContacts = 2, kParticles = 4, kDepth = 8, kFace = 16;
}  // namespace served

/// A layer's bit by its name in the wire; 0 = there is none of this name.
[[nodiscard]] unsigned servedLayer(std::string_view name);

/// A frame as copied from a scene: what the session's thread does, which encodes nothing.
struct ServedFrame {
  struct Part {
    Isometry3 worldFromPart = Isometry3::Identity();
    double extent = 0.0;  ///< greatest coordinate of a vertex [m]
    Vec3f color = Vec3f::Zero();
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
  };
  struct Figure {
    int avatar = 0;
    float opacity = 1.0f;
    std::vector<Affine3> worldFromModel;
    std::vector<float> face;
    std::vector<Part> parts;
  };

  std::uint32_t run = 0;
  double time = 0.0;
  unsigned layers = 0;  ///< that it has
  bool shapes = true;   ///< it has the depth image, and parts have vertices and triangles; else those before hold
  std::vector<Figure> figures;
  std::vector<Prop> props;
  std::vector<Contact> contacts;
  std::vector<Vec3f> particles;  ///< evenly chosen of all
  std::size_t allParticles = 0;
  float particleRadius = 0.0f;
  Vec3f particleColor = Vec3f::Zero();
  Image depth;

  /// Copies what the layers need. Allocates nothing once the largest scene was seen.
  /// @param shapes  with those of hulls and the depth image, which are most of the bytes: not in each frame
  void take(const Scene& scene, unsigned layers, bool shapes = true);

 private:
  std::size_t figureCount_ = 0;
  void addFigure(const SceneFigure& figure);
};

/// Most particles of a frame; what is more is thinned evenly.
inline constexpr std::size_t kMaxServedParticles = 20'000;

/// What a client has got, so that it gets only what is new.
struct ClientMemory {
  std::uint32_t run = 0;
  std::uint32_t propsVersion = 0;
  std::vector<std::array<char, 20>> propPoses;
  struct Part {
    std::uint64_t shape = 0, faces = 0;  ///< versions; 0 = none
  };
  std::vector<std::vector<Part>> parts;         ///< of each figure
  std::size_t particles = kMaxServedParticles;  ///< at most so many: fewer for slow readers
  double depthTime = -1.0;                      ///< of the last depth image [s]
};

/// Turns frames into messages.
class FrameEncoder {
 public:
  /// Encodes what all clients share.
  void encode(const ServedFrame& frame);
  /// The newest frame for one client, appended to an empty message.
  /// @param number  what the client will acknowledge
  /// @param now     of a monotonic clock, for the depth image, which comes at most ten times a second [s]
  void compose(std::uint64_t number, unsigned layers, double now, ClientMemory& client, std::string& message) const;

  /// The message `props` of the present props; its version.
  [[nodiscard]] const std::string& propsText() const { return propsText_; }
  [[nodiscard]] std::uint32_t propsVersion() const { return propsVersion_; }
  /// The bytes of /mesh/N; null if there is none.
  [[nodiscard]] std::shared_ptr<const std::string> mesh(std::size_t number) const;

 private:
  struct EncodedPart {
    std::string head, vertices, faces;
    float extent = 0.0f;
    ClientMemory::Part version;
    std::vector<Triangle> triangles;
  };
  struct EncodedAvatar {
    int avatar = 0;
    std::vector<EncodedPart> parts;
  };
  void describeProps(std::span<const Prop> props);
  void encodeHulls(const ServedFrame& frame);

  std::uint32_t run_ = 0;
  double time_ = 0.0;
  unsigned layers_ = 0;
  std::string avatars_, faces_, contacts_, depth_;
  std::uint16_t avatarSections_ = 0, faceSections_ = 0;
  std::vector<EncodedAvatar> hulls_;
  std::uint64_t shapeVersion_ = 0;
  std::vector<std::array<char, 20>> propPoses_;
  std::vector<Prop> known_;  // the props of propsText_
  std::string propsText_;
  std::uint32_t propsVersion_ = 0;
  std::vector<std::pair<const PropMeshShape*, std::shared_ptr<const std::string>>> meshes_;
  std::vector<Vec3f> particles_;
  std::size_t allParticles_ = 0;
  float particleRadius_ = 0.0f;
  Vec3f particleColor_ = Vec3f::Zero();
};

/// An image as a JPEG file; empty if that fails. @param quality  1 to 100
[[nodiscard]] std::string jpegOf(const Image& image, int quality);

}  // namespace lorica
