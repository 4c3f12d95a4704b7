#include "bench/soak_run.h"

#include "bench/memory_watch.h"
#include "capture/fault_injector.h"
#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "geometry/random_numbers.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iterator>
#include <utility>

namespace lorica::bench {
namespace {

constexpr std::size_t kMaxViolations = 20;
constexpr std::array<const char*, 8> kFaults = {"",
                                                "dropout=0.1",
                                                "jitter=0.03",
                                                "swap=0.1",
                                                "late=0.1",
                                                "freeze=0.1",
                                                "dropout=0.4,jitter=0.1",
                                                "dropout,jitter,swap,late,freeze"};

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class Soak {
 public:
  Soak(const Decomposition& parts, const std::vector<SoakScene>& scenes, const SoakSettings& settings)
      : scenes_(scenes),
        settings_(settings),
        random_(settings.seed),
        session_(firstSession(parts)),
        memory_(settings.warmUp) {
    for (const SoakScene& scene : scenes) {
      SoakRow& row = result_.rows.emplace_back();
      row.scene = scene.name;
      // Allocate the memory of the per-frame results first; otherwise its growth would look like a leak.
      row.frameSeconds.reserve(static_cast<std::size_t>(2.0 * 60.0 * settings.seconds) / scenes.size() + 4096);
      std::fill_n(std::back_inserter(row.frameSeconds), row.frameSeconds.capacity(), 0.0);
      row.frameSeconds.clear();
    }
    motions_.reserve(kSyntheticMotionCount);
    for (int m = 0; m < kSyntheticMotionCount; ++m) {
      motions_.push_back(synthesizeMotion(static_cast<SyntheticMotion>(m)));
    }
  }

  SoakResult run() {
    for (std::uint64_t episode = 0; result_.seconds < settings_.seconds; ++episode) play(episode);
    judgeMemory();
    return std::move(result_);
  }

 private:
  static Session firstSession(const Decomposition& parts) {
    Result<Session> session = Session::create(makeMannequin(), parts, makeMotionPoseSource({}), World());
    LORICA_CHECK(session.ok(), "the parts must be the mannequin's");
    return std::move(session).value();
  }

  void violation(std::string what) {
    if (result_.violations.size() < kMaxViolations) {
      result_.violations.push_back(
          fmt::format("{:.2f} s, scene {}: {}", result_.seconds, result_.rows[scene_].scene, what));
    }
  }

  World nextWorld() {
    scene_ = static_cast<std::size_t>(result_.worlds++) % scenes_.size();
    held_ = false;
    return scenes_[scene_].make(random_.bits());
  }

  void play(std::uint64_t episode) {
    const std::vector<SkeletonFrame>& motion = motions_[episode % motions_.size()];
    const char* text = kFaults[(episode / 3) % kFaults.size()];
    SourceTreatment treatment;
    if (*text != '\0') treatment.faults = parseFaults(text).value();
    treatment.faults.seed = settings_.seed + episode;
    session_.restart(makeTreatedSource(session_.character(), makeRecordedSource(motion), treatment).value(),
                     nextWorld());
    double before = motion.front().time;
    bool changed = false;
    while (result_.seconds < settings_.seconds) {
      disturb();
      const double begin = cpuSeconds();
      const Result<bool> more = session_.step();
      const double took = cpuSeconds() - begin;
      if (!more) return violation(more.error().message);
      if (!*more) return;
      result_.seconds += std::max(0.0, session_.time() - before);
      before = session_.time();
      ++result_.frames;
      result_.faultyFrames += treatment.faults.any() ? 1 : 0;
      watch(took);
      if (!changed && session_.time() > 0.5 * (motion.front().time + motion.back().time)) {
        session_.setWorld(nextWorld());
        changed = true;
      }
    }
  }

  /// Sometimes throws a ball at the avatar, or grabs a prop and drags it around for a second.
  void disturb() {
    const Vec3 middle =
        session_.frameCount() == 0 ? Vec3(0.0, 1.0, 0.0) : session_.body().parts().front().worldFromPart.translation();
    if (random_.unit() < 0.04) {
      const Vec3 from = middle + Vec3{random_.between(-3.0, 3.0), random_.between(0.0, 1.5), random_.between(1.0, 3.0)};
      const Vec3 velocity = random_.between(3.0, 20.0) * (middle - from).normalized() + Vec3(0.0, 1.0, 0.0);
      session_.act(WorldAction::throwBall(from, velocity, random_.between(0.04, 0.15)));
      ++result_.balls;
    }
    const std::span<const Prop> props = session_.world().props();
    if (!held_ && !props.empty() && random_.unit() < 0.02) {
      const auto prop = static_cast<std::size_t>(random_.bits() % props.size());
      session_.act(WorldAction::grab(static_cast<int>(prop), props[prop].worldFromProp.translation()));
      ++result_.grabs;
      held_ = true;
    } else if (held_) {
      Vec3 to = middle + Vec3{random_.between(-1.5, 1.5), random_.between(-1.0, 1.0), random_.between(-1.5, 1.5)};
      to.y() = std::max(to.y(), 0.3);
      held_ = random_.unit() >= 0.03;
      session_.act(held_ ? WorldAction::moveGrab(to) : WorldAction::release());
    }
  }

  void watch(double took) {
    SoakRow& row = result_.rows[scene_];
    row.frameSeconds.push_back(took);
    if (took > settings_.factor * settings_.budget) {
      violation(fmt::format("a frame took {:.1f} ms of CPU time, over {:g} x {:.1f} ms", 1e3 * took, settings_.factor,
                            1e3 * settings_.budget));
    }
    for (const LivePart& part : session_.body().parts()) {
      bool finite = part.worldFromPart.matrix().allFinite();
      for (const Vec3& v : part.shape.vertices) finite = finite && v.allFinite();
      if (!finite) violation("a part of the avatar is not finite");
    }
    const std::span<const Prop> props = session_.world().props();
    row.maxProps = std::max(row.maxProps, props.size());
    row.contacts += std::ssize(session_.world().contacts());
    for (std::size_t p = 0; p < props.size(); ++p) {
      const Prop& prop = props[p];
      if (!prop.worldFromProp.matrix().allFinite() || !prop.velocity.allFinite()) {
        violation(fmt::format("prop {} is not finite", p));
        continue;
      }
      if (prop.mass == 0.0) continue;
      const double height = prop.worldFromProp.translation().y();
      row.lowest = std::min(row.lowest, height);
      row.fastest = std::max(row.fastest, prop.velocity.norm());
      // A prop that is half below the floor does not come up again.
      if (height < 0.0) violation(fmt::format("prop {} went through the floor, to {:.3f} m", p, height));
    }
    watchParticles();
    memory_.watch(result_.seconds);
  }

  void watchParticles() {
    const Particles* particles = session_.world().particles();
    if (particles == nullptr) return;
    for (const Vec3f& position : particles->positions()) {
      if (!position.allFinite()) return violation("a particle is not finite");
      if (position.y() < 0.0f)
        return violation(fmt::format("a particle went through the floor, to {:.3f} m", position.y()));
    }
  }

  void judgeMemory() {
    result_.maxMemory = memory_.peak();
    if (!memory_.hasThirds()) return;
    result_.firstMemory = memory_.firstThird();
    result_.lastMemory = memory_.lastThird();
    if (result_.lastMemory - result_.firstMemory > settings_.memoryGrowth) {
      violation(fmt::format("memory grew from {:.1f} to {:.1f} MiB, by more than {:g}", result_.firstMemory,
                            result_.lastMemory, settings_.memoryGrowth));
    }
  }

  const std::vector<SoakScene>& scenes_;
  SoakSettings settings_;
  RandomNumbers random_;
  Session session_;
  std::vector<std::vector<SkeletonFrame>> motions_;
  MemoryWatch memory_;
  SoakResult result_;
  std::size_t scene_ = 0;
  bool held_ = false;
};

}  // namespace

SoakResult soak(const Decomposition& parts, const std::vector<SoakScene>& scenes, const SoakSettings& settings) {
  LORICA_CHECK(!scenes.empty(), "a soak test needs scenes");
  return Soak(parts, scenes, settings).run();
}

}  // namespace lorica::bench
