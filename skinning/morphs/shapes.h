#pragma once

#include "geometry/tri_mesh.h"
#include "skinning/character.h"
#include "skinning/clip.h"
#include "skinning/morphs/morphs.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// What addShapes() returns if they would be too many.
inline constexpr int kTooManyShapes = -1;

/// Turns the morph targets that clips move into shapes of the character, see Shapes, and their weights into tracks of
/// the clips, if they deform it: if in any clip a vertex moves by more than a fiftieth of the mesh's diagonal. Smaller
/// ones, such as most faces, stay morph targets alone. So do those of so many vertices, bones and keys that they would
/// need much more memory than before, or more than kMaxJoints joints.
/// @param character  before and after it passes checkCharacter(); joints are appended, one for each target and bone
/// @param clips      of the character, as many as morphs.clips
/// @return how many targets became shapes, or kTooManyShapes
int addShapes(Character& character, std::span<Clip> clips, const Morphs& morphs, const Expressions& expressions);

/// Deforms a body as the surface that it was made from: each vertex as the nearest point of the surface that mostly
/// follows the same joint, or any if none does.
/// @param copiesFrom  vertices of the body from this one on repeat those that `from`'s triangles use, in their order
/// @param body        has no shapes; its joints are those of `from`
void carryShapes(const Character& from, std::size_t copiesFrom, Character& body);

/// A character and what it plays.
struct PlayedMesh {
  Character character;  ///< of one joint, and one for each frame but the first
  Clip clip;            ///< the frames, linear between them
};

/// A character whose mesh plays frames of positions.
/// @param name   of the character and the clip
/// @param mesh   at least one vertex; in the first frame, which is the bind pose [m]
/// @param frames frameCount x vertexCount positions, frame-major, the first those of `mesh` [m]
/// @param times  of the frames, increasing, the first not negative [s]
/// @return the character; or an error if counts or times do not fit, a position is not finite, or there are more than
///         kMaxJoints frames
[[nodiscard]] Result<PlayedMesh> playedMesh(const std::string& name, TriMesh mesh, std::span<const Vec3> frames,
                                            std::span<const double> times);

}  // namespace lorica
