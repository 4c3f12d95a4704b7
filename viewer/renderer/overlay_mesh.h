#pragma once

#include "collision/live/live_body.h"
#include "collision/world/prop.h"
#include "geometry/math.h"
#include "skinning/skeleton.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A vertex of a flat face, or of an edge that the vertex shader widens to a strip of constant width on screen.
struct OverlayVertex {
  Vec3f position;                     ///< world [m]
  Vec3f other;                        ///< other end of an edge; equal to `position` on faces
  std::array<std::int8_t, 4> normal;  ///< of the face, 127 = 1; on edges, x distinguishes the ends and w the sides
  std::array<std::uint8_t, 4> color;  ///< linear RGB and opacity
};

/// The parts of a figure.
struct HullFigure {
  std::span<const LivePart> parts;
  float opacity = 1.0f;                    ///< times that of hulls
  std::span<const PartIndex> colors = {};  ///< see SceneFigure

  [[nodiscard]] PartIndex colorOf(PartIndex part) const { return colors.empty() ? part : colors[part]; }
};

/// Converts hulls and bones to faces and edges; reuses its memory from frame to frame.
class OverlayMesh {
 public:
  /// Hulls sorted from far to near as seen from the eye, back faces first in each hull. Blending in this order is
  /// correct as long as hulls overlap little. Includes outlines, and edges whose faces are not nearly coplanar.
  const std::vector<OverlayVertex>& hulls(std::span<const HullFigure> figures, const Vec3& eye);
  /// The same of one figure.
  const std::vector<OverlayVertex>& hulls(std::span<const LivePart> parts, const Vec3& eye) {
    const HullFigure figure{parts};
    return hulls(std::span(&figure, 1), eye);
  }

  /// Outlines and a tint of the parts that reach into static bodies, to be drawn where something hides them.
  const std::vector<OverlayVertex>& insides(std::span<const HullFigure> figures, std::span<const Prop> props,
                                            const Vec3& eye);

  /// Octahedra from each parent joint to its child. Down to the hips there are none: those joints place the character.
  /// @param further  of another figure, added to what the last call gave
  const std::vector<OverlayVertex>& bones(const Skeleton& skeleton, std::span<const Affine3> worldFromJoint,
                                          const Vec3& eye, float opacity = 1.0f, bool further = false);

 private:
  struct HalfEdge {
    std::uint64_t key;       ///< both vertices, the lower index first
    std::uint32_t triangle;  ///< of the polyhedron
  };
  struct Edge {
    VertexIndex first, second;
    double strength;  ///< 0 to 1
    bool behind;      ///< both faces are back faces
  };
  struct Look {
    Vec3f face, edge;                             ///< linear RGB
    double nearFace, farFace, nearEdge, farEdge;  ///< opacity of front faces and of back faces
  };
  /// @param opacity  times that of the look
  void append(std::vector<OverlayVertex>& out, std::span<const Vec3> vertices, std::span<const Triangle> triangles,
              const Look& look, double opacity, const Vec3& eye);
  void findEdges(std::span<const Triangle> triangles);

  std::vector<OverlayVertex> hullVertices_;
  std::vector<OverlayVertex> insideVertices_;
  std::vector<OverlayVertex> boneVertices_;
  /// A part of a figure.
  struct Placed {
    double nearness;  ///< greater = nearer
    std::size_t figure;
    PartIndex part;
    [[nodiscard]] auto operator<=>(const Placed&) const = default;
  };
  std::vector<Placed> order_;
  std::vector<Vec3> faceNormals_;
  std::vector<double> facing_;  ///< of each face, cosine between its normal and the direction to the eye
  std::vector<HalfEdge> halfEdges_;
  std::vector<Edge> edges_;
};

}  // namespace lorica
