#include "capture/files/joint_csv.h"
#include "session/recording/session_replay.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <memory>
#include <ostream>
#include <string>

namespace lorica {
namespace {

/// Expected hashes of a recording's session: the same for every build, compiler and number of threads. After an
/// intended change of poses, hulls or physics, copy the numbers that the test prints.
struct Known {
  const char* recording;
  double from;  ///< [s]
  std::uint64_t hulls, props;
};
void PrintTo(const Known& known, std::ostream* out) {
  *out << known.recording;
}

class ShippedSession : public testing::TestWithParam<Known> {};

constexpr std::size_t kFrames = 60;

TEST_P(ShippedSession, ComesOutTheSameOnOneThreadAndTwoAndAsItAlwaysDid) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s.lsession";
  const Known& known = GetParam();
  ASSERT_EQ(test::recordJoints(file, test::shippedFrames(known.recording, kFrames, known.from)),
            static_cast<int>(kFrames));
  const auto recorded = std::make_shared<const SessionFile>(readSession(file).value());
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Session session = test::demoSession(SessionReplay::source(*recorded, makeMannequin()).value());
    const auto replay = std::make_shared<SessionReplay>(recorded);
    session.watch(replay);
    while (!replay->over()) ASSERT_TRUE(session.step().value());
    EXPECT_FALSE(replay->difference().has_value())
        << threads << " threads, step " << replay->difference()->step << ": " << replay->difference()->what;
  }
  const SessionHashes& last = recorded->steps.back().hashes;
  EXPECT_TRUE(last.hulls == known.hulls && last.props == known.props)
      << std::hex << "{\"" << known.recording << "\", " << known.from << ", 0x" << last.hulls << "u, 0x" << last.props
      << "u},";
}

INSTANTIATE_TEST_SUITE_P(Recordings, ShippedSession,
                         testing::Values(Known{"jumping_jacks", 2.0, 0xbf55bc15b1be5934u, 0xaf7d2d08cd6b600du},
                                         Known{"punch_and_kick", 5.5, 0x3a20b09d6c3d74f8u, 0x8f430ae09ab59812u},
                                         Known{"punch_and_kick_noisy", 5.5, 0xc7131f4cbb85e6fcu, 0xa30d03574db45edeu},
                                         Known{"squat_and_reach", 2.0, 0x4b0b4ed68e8ef5cdu, 0xdd95adaf0e2600c2u},
                                         Known{"turn_around", 2.0, 0xa57acd6ef79782e9u, 0xcae90c1007aabd79u},
                                         Known{"walk", 3.0, 0xc0ee812cacfd35b7u, 0xd00eff208885486fu},
                                         Known{"walk_noisy", 3.0, 0xb6aa9a5e9f5a64bu, 0x7e77402015a9b1a4u},
                                         Known{"wave", 2.0, 0xd4bc5ca664fd7cbdu, 0x696c29069c625da6u}),
                         [](const auto& param) { return std::string(param.param.recording); });

struct KnownParticles {
  ParticleSettings::Kind kind;
  std::uint64_t particles;
};

class KnownParticlesTest : public testing::TestWithParam<KnownParticles> {};

TEST_P(KnownParticlesTest, AroundAWalkerComeOutAsTheyAlwaysDid) {
  ParticleSettings settings;
  settings.kind = GetParam().kind;
  settings.walls = Aabb{Vec3(-0.3, 0.0, -0.5), Vec3(0.3, 2.0, 0.5)};
  settings.fills.push_back({Vec3(0.0, 0.15, 0.0), Vec3(0.6, 0.3, 1.0), 8000});
  Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("walk", 20, 3.0)), {}).value());
  World world;
  world.setParticles(settings);
  session.setWorld(std::move(world));
  while (session.step().value()) {
  }
  EXPECT_EQ(session.hashes().particles, GetParam().particles) << std::hex << session.hashes().particles;
}

INSTANTIATE_TEST_SUITE_P(Kinds, KnownParticlesTest,
                         testing::Values(KnownParticles{ParticleSettings::Kind::kSand, 0x2f356800a61ce4ddu},
                                         KnownParticles{ParticleSettings::Kind::kWater, 0x553d865e9c1c57a7u}),
                         [](const auto& param) {
                           return param.param.kind == ParticleSettings::Kind::kSand ? "sand" : "water";
                         });

}  // namespace
}  // namespace lorica
