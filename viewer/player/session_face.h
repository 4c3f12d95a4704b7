#pragma once

#include "capture/skeleton_frame.h"
#include "session/session.h"
#include "skinning/look/avatar.h"
#include "skinning/morphs/face.h"
#include "viewer/renderer/scene.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Lets a face show the expressions of a source of motion. Names of VRM 0.x and 1.0 are the same: "Joy" is "happy".
/// While the source sends a blink of its own, the face does not blink by itself.
class ExpressionFollower {
 public:
  /// Allocates nothing while the names stay the same.
  /// @param sent         those that the character lacks are left out
  /// @param expressions  of the face
  /// @param given        their weights while the source does not name them; missing ones are 0
  void apply(std::span<const NamedWeight> sent, const Expressions& expressions, std::span<const float> given,
             Face& face);

 private:
  struct Known {
    std::string name;
    std::optional<std::size_t> expression;
  };
  void learn(std::span<const NamedWeight> sent, const Expressions& expressions, std::span<const float> given,
             Face& face);

  std::vector<Known> known_;
};

/// The face of a session's avatar: its expressions, those that the session's source sends, the clip that it plays,
/// blinking, and eyes that follow the picture's camera. It is only drawn; hulls and physics do not depend on it, see
/// coverReached() for shapes that they must hold.
class SessionFace {
 public:
  /// @return none if the avatar has no morph targets, no eyes that move and no expressions that change materials
  [[nodiscard]] static std::optional<SessionFace> of(const std::shared_ptr<const Avatar>& avatar);

  /// Sets one expression alone; until then there are those that were chosen on the command line.
  /// @param expression  index into the avatar's expressions; -1 = none
  void choose(int expression);

  /// Computes the face of the session's frame. Does not allocate memory after the first frame.
  /// @param time            of the frame [s]
  /// @param watcher         [m], world: what the eyes follow while it is in front of the head
  /// @param worldFromModel  of the avatar's joints; those of the eyes are turned
  /// @param figure          gets the changed positions, normals and materials, borrowed from this object
  void update(const SessionAvatar& performer, double time, const Vec3& watcher, std::span<Affine3> worldFromModel,
              SceneFigure& figure);

 private:
  explicit SessionFace(std::shared_ptr<const Avatar> avatar);

  std::shared_ptr<const Avatar> avatar_;
  Face face_;
  std::vector<float> given_;  // weights of the expressions unless the source or the user says otherwise
  int chosen_ = -1;
  ExpressionFollower follower_;
  std::vector<Vec3f> bindNormals_;  // of every vertex; zero where the file has none
  std::vector<Vec3> positions_;
  std::vector<Vec3f> normals_;
  std::vector<Material> materials_;  // empty if no expression changes any
  std::vector<float> named_;         // weights of the targets that expressions are named after, if all are
};

}  // namespace lorica
