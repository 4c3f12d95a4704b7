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
                         testing::Values(Known{"jumping_jacks", 2.0, 0x6c1033b890defb5cu, 0x85f53d86a1ae2ae0u},
                                         Known{"punch_and_kick", 5.5, 0xc6de7a85616de63bu, 0xf51a70d8cc03b712u},
                                         Known{"punch_and_kick_noisy", 5.5, 0x2323bc515b64c6ccu, 0x356374254dd2e8du},
                                         Known{"squat_and_reach", 2.0, 0x3a7949fab29bdb90u, 0xbd236d2220e5f306u},
                                         Known{"turn_around", 2.0, 0x2418007483c6f077u, 0xcbf454cbc78d6083u},
                                         Known{"walk", 3.0, 0x804066cab2c51915u, 0x364f8a7c3b7d3b29u},
                                         Known{"walk_noisy", 3.0, 0xf16d838af4e83001u, 0xe0f98885801eae3eu},
                                         Known{"wave", 2.0, 0xf3eb08a0594db2c3u, 0x9200d599303e0967u}),
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
