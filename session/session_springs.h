#pragma once

#include "collision/live/live_body.h"
#include "collision/world/live_obstacles.h"
#include "collision/world/prop.h"
#include "skinning/character.h"
#include "skinning/springs/spring_simulation.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace lorica {

/// What the springs of a character do in a session. Node constraints apply in each case.
enum class SpringMode : std::uint8_t {
  kNone,  ///< they stay at rest
  kFile,  ///< they collide with the colliders of the file
  kBody,  ///< they collide with the live hulls of the body and with props
};

/// "none", "file", "body"
[[nodiscard]] std::string_view nameOf(SpringMode mode);
/// The inverse of nameOf(); nothing for other names.
[[nodiscard]] std::optional<SpringMode> springModeNamed(std::string_view name);

/// kFile if the springs have colliders, else kBody.
[[nodiscard]] SpringMode usualSpringMode(const SpringBones& springs);

/// The springs of one character in a session.
class SessionSprings {
 public:
  /// @param body  of the character; may be changed later, see setBody()
  /// @return the springs, or the error of checkSprings()
  static Result<SessionSprings> create(const Character& character, SpringBones springs, SpringMode mode,
                                       const LiveBody& body);

  /// Takes another body of the same character.
  void setBody(const Character& character, const LiveBody& body);
  /// Starts at rest in the next frame.
  void reset() { simulation_.reset(); }

  /// Moves the springs to a new frame. Allocates nothing.
  /// @param pose     of the source
  /// @param seconds  since the last frame, as the source says
  /// @param last     worldFromModel of the last frame; empty in the first
  /// @param parts    of the body in the last frame
  /// @return the pose with the rotations of springs and constraints; valid until the next call
  [[nodiscard]] std::span<const JointTransform> advance(const Character& character,
                                                        std::span<const JointTransform> pose, double seconds,
                                                        std::span<const Affine3> last, std::span<const LivePart> parts,
                                                        std::span<const Prop> props);

  [[nodiscard]] SpringMode mode() const { return mode_; }  ///< what hair and clothes collide with
  /// hashOf(SpringBones) of the springs as given.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  [[nodiscard]] const SpringSimulation& simulation() const { return simulation_; }  ///< the joints that swing

 private:
  SessionSprings(SpringSimulation simulation, SpringMode mode, std::uint64_t hash);

  SpringSimulation simulation_;
  SpringMode mode_;
  std::uint64_t hash_;
  std::optional<LiveObstacles> obstacles_;
  Pose pose_;
  std::vector<Affine3> worldFromModel_;  ///< of the source's pose
};

}  // namespace lorica
