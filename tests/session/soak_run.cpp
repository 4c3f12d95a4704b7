#include "tests/session/soak_run.h"

#include "capture/fault_injector.h"
#include "capture/files/joint_csv.h"
#include "collision/particles/particles.h"
#include "geometry/random_numbers.h"
#include "session/contact_events.h"
#include "session/scenes/demo_scene.h"
#include "session/session.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/memory_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iterator>
#include <memory>
#include <utility>

namespace lorica::test {
namespace {

constexpr std::size_t kMaxViolations = 20;
constexpr double kRate = 30.0;   ///< frames/s
constexpr double kAround = 1.2;  ///< how far from the middle people perform [m]

using Motions = std::vector<std::vector<SkeletonFrame>>;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The joints of a place before a camera where people come and go.
class Visitors final : public SkeletonSource {
 public:
  Visitors(std::shared_ptr<const Motions> motions, std::uint64_t seed, double seconds)
      : motions_(std::move(motions)), random_(seed), end_(static_cast<long>(kRate * seconds)) {}

  Result<std::optional<SkeletonFrame>> next() override {
    if (number_ >= end_) return std::optional<SkeletonFrame>();
    if (number_ >= until_) change();
    SkeletonFrame frame;
    frame.user = kNobody;
    if (there_) {
      const std::vector<SkeletonFrame>& motion = (*motions_)[motion_];
      frame = motion[static_cast<std::size_t>(first_ + number_) % motion.size()];
      for (TrackedJoint& joint : frame.joints) joint.position += place_;
    }
    frame.time = static_cast<double>(number_++) / kRate;
    return std::optional(frame);
  }

 private:
  void change() {
    there_ = !there_;
    until_ = number_ + static_cast<long>(kRate * (there_ ? random_.between(2.0, 8.0) : random_.between(1.0, 5.0)));
    motion_ = static_cast<std::size_t>(random_.bits() % motions_->size());
    first_ = static_cast<long>(random_.bits() % 300);
    const double x = random_.between(-kAround, kAround);
    place_ = Vec3(x, 0.0, random_.between(-kAround, kAround));
  }

  std::shared_ptr<const Motions> motions_;
  RandomNumbers random_;
  long number_ = 0, end_, until_ = 0, first_ = 0;
  std::size_t motion_ = 0;
  bool there_ = false;
  Vec3 place_ = Vec3::Zero();
};

Session sessionOf(const Decomposition& parts, const AvatarSoakSettings& settings) {
  auto motions = std::make_shared<Motions>();
  for (const std::string_view name : kShippedMotions) motions->push_back(shippedFrames(name));
  const Character character = makeMannequin();
  Session session(makeDemoWorld(settings.seed));
  std::optional<SessionAvatar> kind;
  for (int place = 0; place < settings.places; ++place) {
    const std::uint64_t seed = settings.seed + 1000 * static_cast<std::uint64_t>(place);
    std::unique_ptr<PoseSource> source =
        makeTreatedSource(character, std::make_unique<Visitors>(motions, seed, settings.seconds), SourceTreatment())
            .value();
    if (!kind) kind = SessionAvatar::create(character, parts, makeMotionPoseSource({})).value();
    session.addAvatar(kind->another(std::move(source)));
  }
  return session;
}

class AvatarSoak {
 public:
  AvatarSoak(const Decomposition& parts, const AvatarSoakSettings& settings)
      : settings_(settings),
        session_(sessionOf(parts, settings)),
        events_(session_),
        memory_(settings.warmUp),
        there_(session_.avatars().size(), false) {}

  AvatarSoakResult run() {
    const double begin = cpuSeconds();
    while (true) {
      const Result<bool> more = session_.step();
      if (!more) violation(more.error().message);
      if (!more || !*more) break;
      watch();
    }
    result_.cpuSeconds = cpuSeconds() - begin;
    result_.meanThere /= static_cast<double>(std::max(1L, result_.frames));
    judgeMemory();
    return std::move(result_);
  }

 private:
  void violation(const std::string& what) {
    if (result_.violations.size() >= kMaxViolations) return;
    result_.violations.push_back(fmt::format("{:.2f} s: {}", session_.time(), what));
  }

  void watch() {
    ++result_.frames;
    result_.seconds = session_.time();
    for (std::size_t a = 0; a < there_.size(); ++a) watchAvatar(a);
    result_.contacts += std::ssize(session_.world().contacts());
    for (const Contact& contact : session_.world().contacts()) {
      if (!there_[static_cast<std::size_t>(contact.avatar)]) violation("a prop touches an avatar that is away");
    }
    result_.meetings += std::ssize(session_.avatarContacts());
    for (const BodyContact& contact : session_.avatarContacts()) {
      const bool both =
          there_[static_cast<std::size_t>(contact.firstBody)] && there_[static_cast<std::size_t>(contact.secondBody)];
      if (!both) violation("an avatar touches one that is away");
    }
    result_.events += std::ssize(events_.update(session_));
    memory_.watch(session_.time());
  }

  void watchAvatar(std::size_t index) {
    const SessionAvatar& avatar = session_.avatars()[index];
    const bool was = there_[index];
    there_[index] = avatar.present();
    result_.entries += !was && avatar.present() ? 1 : 0;
    result_.exits += was && !avatar.present() ? 1 : 0;
    result_.meanThere += avatar.present() ? 1.0 : 0.0;
    for (const LivePart& part : avatar.partsInWorld()) {
      if (!part.worldFromPart.matrix().allFinite()) violation(fmt::format("avatar {} is not finite", index));
    }
  }

  void judgeMemory() {
    result_.peakMemory = memory_.peak();
    if (!memory_.hasThirds()) return;
    result_.firstMemory = memory_.firstThird();
    result_.lastMemory = memory_.lastThird();
    if (result_.lastMemory - result_.firstMemory <= settings_.memoryGrowth) return;
    violation(fmt::format("memory grew from {:.1f} to {:.1f} MiB, by more than {:g}", result_.firstMemory,
                          result_.lastMemory, settings_.memoryGrowth));
  }

  AvatarSoakSettings settings_;
  Session session_;
  ContactEvents events_;
  MemoryWatch memory_;
  std::vector<bool> there_;
  AvatarSoakResult result_;
};

}  // namespace

AvatarSoakResult soakAvatars(const Decomposition& parts, const AvatarSoakSettings& settings) {
  return AvatarSoak(parts, settings).run();
}

namespace {

constexpr std::array<const char*, 8> kFaults = {"",
                                                "dropout=0.1",
                                                "jitter=0.03",
                                                "swap=0.1",
                                                "late=0.1",
                                                "freeze=0.1",
                                                "dropout=0.4,jitter=0.1",
                                                "dropout,jitter,swap,late,freeze"};

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
    motions_.reserve(kShippedMotions.size());
    for (const std::string_view name : kShippedMotions) {
      motions_.push_back(shippedFrames(name));
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

}  // namespace lorica::test
