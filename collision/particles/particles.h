#pragma once

#include "collision/live/live_part.h"
#include "collision/particles/particle_bodies.h"
#include "geometry/math.h"
#include "geometry/result.h"
#include "geometry/work_budgets.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lorica {

class ParticleSimulation;

/// The grains or water particles of a scene, and their sources.
struct ParticleSettings {
  /// Grains that heap up, or drops that flow.
  enum class Kind : std::uint8_t { kSand, kWater };
  Kind kind = Kind::kSand;                   ///< which of the numbers below count
  double radius = 0.01;                      ///< of a grain, or half the spacing of water [m]
  double friction = 0.4;                     ///< of sand
  double viscosity = 0.1;                    ///< of water
  Vec3 gravity{0.0, -9.81, 0.0};             ///< [m/s^2]
  bool floor = true;                         ///< at y = 0
  std::optional<Aabb> walls;                 ///< they stay within its x and z range
  Vec3f color = Vec3f(0.60f, 0.45f, 0.26f);  ///< linear RGB
  /// A box that is full of them at the start.
  struct Fill {
    Vec3 middle = Vec3::Zero();  ///< world [m]
    Vec3 size = Vec3::Ones();    ///< along the axes of the world [m]
    int max = kMaxParticles;     ///< at most as many, from below
  };
  std::vector<Fill> fills;  ///< boxes that are full in the beginning
  /// A level disc that they fall from.
  struct Pour {
    Vec3 middle = Vec3::Zero();     ///< world [m]
    double radius = 0.2;            ///< of the disc [m]
    double rate = 5000.0;           ///< particles per second
    int count = 10'000;             ///< total number to pour
    Vec3 velocity{0.0, -1.0, 0.0};  ///< of a particle when it appears, world [m/s]
  };
  std::vector<Pour> pours;  ///< what falls during the session
  /// Time for which they settle around the body's first pose, before the first step [s].
  double settleSeconds = 0.0;
};

/// Sand or water with its sources, moved frame by frame. The same settings and parts give the same bits.
class Particles {
 public:
  /// @param bodies  that no particle starts in
  /// @return sand or water, or which setting is out of range (kInvalidArgument)
  [[nodiscard]] static Result<Particles> create(const ParticleSettings& settings,
                                                std::span<const ParticleBody> bodies = {});
  ~Particles();
  Particles(Particles&&) noexcept;
  Particles& operator=(Particles&&) noexcept;

  /// Advances by a frame. The first call also settles the particles, unless settle() has done so.
  /// @param seconds  above 0
  /// @param bodies   that meet them; while they settle the bodies stay at the frame's begin
  void step(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies = {});
  /// Settles the particles around parts that stand, before the first step. Costs as much as that many frames.
  /// @return false if the watch stopped it; a step that it begins then ends with it
  bool settle(std::span<const LivePart> parts, std::span<const ParticleBody> bodies = {});
  /// Whether they have settled or need not.
  [[nodiscard]] bool settled() const { return settled_ || settings_.settleSeconds <= 0.0; }
  /// Called after each frame of settling, in the thread that settles. @return false = settle no further
  using SettlingWatch = std::function<bool(int frame, int frames)>;
  /// Before settle().
  void watchSettling(SettlingWatch watch) { settlingWatch_ = std::move(watch); }

  [[nodiscard]] const ParticleSettings& settings() const { return settings_; }  ///< what they were made with
  /// World [m]; a particle keeps its index.
  [[nodiscard]] std::span<const Vec3f> positions() const;
  /// In the same order, world [m/s].
  [[nodiscard]] std::span<const Vec3f> velocities() const;

 private:
  Particles(const ParticleSettings& settings, std::unique_ptr<ParticleSimulation> simulation);
  void fill(const ParticleSettings::Fill& fill, std::span<const ParticleBody> bodies);
  void pour(std::size_t source, double seconds);
  void move(std::span<const LivePart> parts, double seconds, std::span<ParticleBody> bodies);

  ParticleSettings settings_;
  std::unique_ptr<ParticleSimulation> simulation_;
  struct Source {
    std::vector<Vec3f> disc;  // positions side by side
    double due = 0.0;         // particles
    int poured = 0;
  };
  std::vector<Source> sources_;
  std::vector<Vec3f> added_;
  bool settled_ = false;
  SettlingWatch settlingWatch_;
};

}  // namespace lorica
