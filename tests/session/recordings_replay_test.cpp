#include "capture/files/joint_csv.h"
#include "session/session_replay.h"
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
                         testing::Values(Known{"jumping_jacks", 2.0, 0x5216bfa6919db6dbu, 0xa62c68b14f1681f7u},
                                         Known{"punch_and_kick", 5.5, 0xe1e14a649bc0a39du, 0x40c7f661a7f7b70u},
                                         Known{"punch_and_kick_noisy", 5.5, 0xfa449e5ced13f967u, 0x7d3cf398f52fe317u},
                                         Known{"squat_and_reach", 2.0, 0x5d505f54f3b55923u, 0xbc03606b4084b6edu},
                                         Known{"turn_around", 2.0, 0x350e1fd5603f5304u, 0x81984935ab5181b8u},
                                         Known{"walk", 3.0, 0xfffe27870d102e6eu, 0xc10940a545be754bu},
                                         Known{"walk_noisy", 3.0, 0x2e78c84cbc76f707u, 0x80f7f408464f4e6u},
                                         Known{"wave", 2.0, 0xe6fcb7ed36070377u, 0x6502e7d172b5834u}),
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
                                         KnownParticles{ParticleSettings::Kind::kWater, 0x29d94ce1cef39c16u}),
                         [](const auto& param) {
                           return param.param.kind == ParticleSettings::Kind::kSand ? "sand" : "water";
                         });

}  // namespace
}  // namespace lorica
