#include "viewer/vr/headset_window.h"

#include "geometry/clock.h"
#include "geometry/counts.h"
#include "viewer/renderer/picture_area.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

constexpr double kBeside = 1.6;                                        // distance to the avatar at first [m]
constexpr double kNearest = 0.05;                                      // of what is drawn [m]
constexpr double kHeadDepth = 0.16;                                    // the same inside: the own head is not [m]
constexpr double kEyesAbove = 0.07, kEyesAhead = 0.09;                 // of the head joint [m]
constexpr double kReach = 0.12;                                        // of a hand, from a prop's sphere [m]
constexpr double kTurn = std::numbers::pi / 6.0;                       // of the stick [rad]
constexpr double kTurns = 0.7, kTurnsAgain = 0.3, kStickRests = 0.15;  // of the stick
constexpr double kLongestFrame = 0.1;                                  // in which the wearer moves [s]
constexpr double kBetweenTouches = 0.1;                                // that are felt [s]
constexpr double kFirmTouch = 2.0;                                     // is felt with full strength [N s]
constexpr double kFastestThrow = 15.0;                                 // [m/s]
constexpr double kLongestThrow = 2.0;                                  // in which its velocity is measured [s]
constexpr double kPalmNear = 0.6;                                      // to the head: it is looked at [m]
constexpr double kPalmFaces = 0.8;                                     // the cosine of how far it is turned away
constexpr double kClick = 0.3;                                         // strength of a pulse
constexpr double kBetweenLooks = 3.0;                                  // for a headset that was lost [s]
constexpr double kDrawn = 0.8;  // of the time between two pictures of the headset
constexpr double kIdle = 0.05;  // between looks at a headset that is not worn [s]

/// The figure of the avatar that is followed, else the first.
const SceneFigure& followedOf(const Scene& scene, int avatar) {
  const SceneFigure* found = &scene;
  for (const SceneFigure& figure : scene.others) {
    if (figure.number == avatar) found = &figure;
  }
  return *found;
}

std::optional<Vec3> jointAt(const SceneFigure& figure, HumanBone bone) {
  const JointIndex joint = figure.skeleton == nullptr ? kNoJoint : figure.skeleton->jointOf(bone);
  if (joint == kNoJoint || joint >= std::ssize(figure.worldFromJoint)) return std::nullopt;
  return Vec3(figure.worldFromJoint[joint].translation());
}

}  // namespace

Result<std::unique_ptr<HeadsetWindow>> HeadsetWindow::create(const std::function<Result<Window>()>& open,
                                                             std::function<void(const std::string&)> say) {
  LORICA_TRY(std::unique_ptr<Headset> headset, Headset::find());
  LORICA_TRY(Window window, displayAvailable() ? open() : createUnseen(std::move(say)));
  std::unique_ptr<HeadsetWindow> made(new HeadsetWindow(std::move(headset), std::move(window)));
  LORICA_TRY_DO(made->headset_->start(made->glFunctions()));
  return made;
}

HeadsetWindow::~HeadsetWindow() {
  headset_.reset();  // its pictures belong to the window's context
}

void HeadsetWindow::lose(const Error& why) {
  headset_.reset();
  drawFor(nullptr);
  for (Hold& hold : holds_) {
    hold = Hold{.state = hold.state == Hold::State::kAsked ? Hold::State::kReleases : Hold::State::kFree};
  }
  ended_ = fmt::format("{}: the session goes on {}", why.message, seen() ? "in the window" : "without it");
  problem(ended_);
  lookedAt_ = now();
  mayReturn_ = why.code != ErrorCode::kCancelled;
}

/// A headset that was lost may come back: it is looked for in another thread, since runtimes take their time to answer.
void HeadsetWindow::seek() {
  if (!mayReturn_) return;
  if (!finding_.valid()) {
    if (now() - lookedAt_ < kBetweenLooks) return;
    lookedAt_ = now();
    finding_ = std::async(std::launch::async, Headset::find);
  }
  if (finding_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  Result<std::unique_ptr<Headset>> found = finding_.get();
  if (!found || !(*found)->start(glFunctions())) return;
  headset_ = std::move(*found);
  ended_.clear();
  panel_ = {};  // it is drawn again
  inside_.reset();
  stands_ = false;
  notice("the headset is there again");
}

bool HeadsetWindow::open() const {
  return Window::open() && (seen() || headset_ || mayReturn_);
}

void HeadsetWindow::show(const Scene& scene, const WindowValues& values) {
  if (!headset_) seek();
  if (!headset_) return Window::show(scene, values);
  const bool ran = headset_->running();
  Result<void> alive = headset_->poll();
  double begun = now();
  const auto timed = [&](TimedStage& stage) { stage.milliseconds = 1e3 * (now() - std::exchange(begun, now())); };
  if (alive && headset_->running()) alive = headset_->beginFrame();
  timed(times_[0]);
  if (!alive) {
    lose(alive.error());
    return Window::show(scene, values);
  }
  if (!headset_->running()) {
    if (ran) drawFor(nullptr);
    return Window::show(scene, values);
  }
  if (!ran) {
    drawFor([this](Renderer& renderer, const Scene& drawn,
                   const SceneOptions& options) { return drawEyes(renderer, drawn, options); },
            kDrawn * headset_->frame().period);
  }
  const double seconds =
      std::clamp(headset_->frame().time - std::exchange(time_, headset_->frame().time), 0.0, kLongestFrame);
  if (headset_->frame().located) {
    move(seconds);
    findPlace(scene, values);
    notePose();
    usePanel(values);
    holdProps(scene, values);
    feel(scene, values);
  }
  Window::show(scene, values);
  timed(times_[1]);
  if (!headset_) return;
  if (const Result<void> ended = headset_->endFrame(); !ended) return lose(ended.error());
  timed(times_[2]);
}

bool HeadsetWindow::drawEyes(Renderer& renderer, const Scene& scene, const SceneOptions& options) {
  const HeadsetFrame& frame = headset_->frame();
  if (!frame.drawn || !frame.located) return false;
  Scene around = scene;
  around.inset = nullptr;
  for (const int index : {1, 0}) {  // the window shows the left one
    const HeadsetEye& eye = frame.eyes[index];
    eyes_[index] =
        cameraOf(place_.worldFromStage() * eye.stageFromEye, eye.angles, inside_ == true ? kHeadDepth : kNearest);
    if (index == 1) {
      renderer.draw(around, options, eyes_[index], headset_->width(), headset_->height());
    } else {
      renderer.drawAgain(around, options, eyes_[index]);
    }
    // A failure is reported when the frame ends.
    if (!headset_->take(index, renderer)) return false;
  }
  return true;
}

/// The left stick walks where the head looks, the right one turns. Buttons change between beside and inside, and bring
/// the wearer to the avatar again.
void HeadsetWindow::move(double seconds) {
  const HeadsetFrame& frame = headset_->frame();
  HeadsetPlace& moved = inside_ == true && wearer_.alone ? floor_ : place_;
  if (frame.hands[0].stick.norm() > kStickRests && (inside_ == false || wearer_.alone)) {
    moved.walk(frame.stageFromHead, frame.hands[0].stick, seconds);
  }
  const double x = frame.hands[1].stick.x();
  const double wants = std::abs(x) > kTurns ? std::copysign(1.0, x) : std::abs(x) < kTurnsAgain ? 0.0 : turned_;
  if (wants != 0.0 && wants != turned_) moved.turn(frame.stageFromHead, -wants * kTurn);
  turned_ = wants;
  for (const HeadsetHand& hand : frame.hands) {
    if (hand.opens) panel_.isOpen() ? panel_.close() : panel_.open(frame.stageFromHead);
    if (!hand.changes) continue;
    asked().ask({.id = ControlId::kInside});
  }
}

/// Beside the avatar once, looking at it; inside, the eyes are where its eyes are, and turn freely.
void HeadsetWindow::findPlace(const Scene& scene, const WindowValues& values) {
  const SceneFigure& figure = followedOf(scene, values.avatar);
  const std::optional<Vec3> head = jointAt(figure, HumanBone::kHead);
  if (!values.focus || figure.skeleton == nullptr) return;  // nobody is there
  const Isometry3& stageFromHead = headset_->frame().stageFromHead;
  const Vec3 ahead = directionAt(values.facing, 0.0);
  const bool inside = choices().inside && head;
  if (inside_ != inside) {
    if (inside) {
      place_.stand(stageFromHead, *values.focus, ahead);
    } else {
      place_.stand(stageFromHead, *values.focus + kBeside * ahead, -ahead);
    }
    inside_ = inside;
    place_.forgetAvatar();
  }
  if (!inside) return;
  if (!wearer_.alone && !wearer_.registration) {
    return place_.inside(stageFromHead, *head + kEyesAbove * Vec3::UnitY() + kEyesAhead * ahead);
  }
  // The avatar is that of the last pose: its head is off by what its proportions are others.
  const Isometry3 floorFromStage = followedFromStage();
  const Isometry3& last = poses_.front().pose.head;
  const Vec3 known = wearer_.registration ? Vec3(floorFromStage * (last * wearer_.registration->headInHeadset))
                                          : Vec3(last * kNominalHeadInHeadset);
  place_.along(floorFromStage, known, *head);
}

/// In the frame of what follows the wearer.
Isometry3 HeadsetWindow::followedFromStage() const {
  if (wearer_.registration)
    return Eigen::Translation3d(-wearer_.origin) * wearer_.registration->stageFromFloor().inverse();
  return wearer_.alone ? floor_.worldFromStage() : Isometry3::Identity();
}

/// Where the wearer is, for what follows them: in the stage, or where the sticks brought them.
void HeadsetWindow::notePose() {
  const HeadsetFrame& frame = headset_->frame();
  if (wearer_.alone && !stands_) {
    floor_.stand(frame.stageFromHead, Vec3::Zero(), Vec3::UnitZ());
    stands_ = true;
  }
  const Isometry3 floorFromStage = wearer_.alone ? floor_.worldFromStage() : Isometry3::Identity();
  HeadAndHands& pose = poses_.front().pose;
  pose.time = frame.time;
  pose.head = floorFromStage * frame.stageFromHead;
  for (const std::size_t index : {0, 1}) {
    const HeadsetHand& hand = frame.hands[index];
    pose.hands[index] = hand.seen ? std::optional<Isometry3>(floorFromStage * hand.stageFromGrip) : std::nullopt;
  }
  poseIsNew_ = true;
}

std::span<const HeadsetPose> HeadsetWindow::headsets() {
  return std::exchange(poseIsNew_, false) ? std::span<const HeadsetPose>(poses_) : std::span<const HeadsetPose>();
}

void HeadsetWindow::setWearer(const WearerState& state) {
  if (state.alone != wearer_.alone) choices().inside = state.alone;
  if (!state.advice.empty() && state.advice != wearer_.advice) notice(state.advice, kNoticeSeconds);
  wearer_ = state;
  place_.forgetAvatar();
}

Ray HeadsetWindow::aimOf(int hand) const {
  const HeadsetHand& seen = headset_->frame().hands[hand];
  const Hold& hold = holds_[hand];
  const bool reaches = hold.holds() && hold.reaches;
  const Isometry3 worldFromHand = place_.worldFromStage() * (reaches ? seen.stageFromGrip : seen.stageFromAim);
  return {worldFromHand.translation(), worldFromHand.linear() * (reaches ? hold.direction : Vec3(-Vec3::UnitZ()))};
}

/// A button opens it, or a bare left palm that is looked at; what points at a row chooses it by grabbing.
void HeadsetWindow::usePanel(const WindowValues& values) {
  const HeadsetFrame& frame = headset_->frame();
  const HeadsetHand& left = frame.hands[0];
  const Vec3 toHead = frame.stageFromHead.translation() - left.stageFromAim.translation();
  const bool looksAtPalm = left.seen && left.bare && toHead.norm() < kPalmNear &&
                           -left.stageFromAim.linear().col(1).dot(toHead.normalized()) > kPalmFaces;
  if (looksAtPalm) panel_.openAt(left.stageFromAim.translation(), frame.stageFromHead);
  if (panelAtHand_ && !looksAtPalm) panel_.close();
  panelAtHand_ = looksAtPalm;
  points_ = {};
  if (!panel_.isOpen()) return;
  std::optional<std::size_t> pointed;
  for (const int index : {0, 1}) {
    const HeadsetHand& hand = frame.hands[index];
    if (!hand.seen || holds_[index].holds() || (panelAtHand_ && index == 0)) continue;
    const Isometry3& aim = hand.stageFromAim;
    const std::optional<std::size_t> row = panel_.rowAt({aim.translation(), -aim.linear().col(2)});
    if (!row) continue;
    points_[index] = true;
    pointed = row;
    if (!hand.grabs || holds_[index].grabbed) continue;
    headset_->pulse(index, kClick);
    if (*row == panel_.closeRow()) panel_.close();
    if (*row == panel_.toAvatarRow()) {
      inside_.reset();
      stands_ = false;
    }
    if (const std::optional<ControlId> control = panel_.controlOf(*row)) asked().ask({.id = *control});
  }
  if (values.controls != nullptr && panel_.draw(*values.controls, pointed)) {
    if (const Result<void> drawn = headset_->drawPanel(panel_.image()); !drawn) return panel_.close();
  }
  if (panel_.isOpen()) headset_->placePanel(panel_.stageFromPanel(), panel_.width(), panel_.height());
}

/// Each hand holds a prop: one in its reach, else the first along its ray.
void HeadsetWindow::holdProps(const Scene& scene, const WindowValues& values) {
  const HeadsetFrame& frame = headset_->frame();
  const bool mayHold = values.controls != nullptr && (*values.controls)[ControlId::kThrow].whyNot.empty();
  for (int index = 0; index < 2; ++index) {
    const HeadsetHand& hand = frame.hands[index];
    Hold& hold = holds_[index];
    const bool before = std::exchange(hold.grabbed, hand.grabs);
    if (hold.state == Hold::State::kAsked && (values.holds >> index & 1u) == 0) hold.state = Hold::State::kFree;
    if (hold.holds() && !hand.grabs) {
      const double seconds = frame.time - was_[next_].time;
      const Vec3 now = place_.worldFromStage() * hand.stageFromGrip.translation();
      hold.velocity = seconds < kLongestThrow ? Vec3((now - was_[next_].hands[index]) / std::max(seconds, 1e-3))
                                              : Vec3(Vec3::Zero());
      if (hold.velocity.norm() > kFastestThrow) hold.velocity *= kFastestThrow / hold.velocity.norm();
      hold.state = hold.state == Hold::State::kAsked ? Hold::State::kReleases : Hold::State::kFree;
    }
    if (hold.state != Hold::State::kFree || before || !hand.grabs || !hand.seen || points_[index] || !mayHold) continue;
    hold.state = Hold::State::kPresses;
    hold.reaches = false;
    const Isometry3 worldFromGrip = place_.worldFromStage() * hand.stageFromGrip;
    const Vec3 grip = worldFromGrip.translation();
    double nearest = kReach;
    for (const Prop& prop : scene.props) {
      const Vec3 center = prop.worldFromProp.translation();
      const double radius = boundingRadius(prop), distance = (center - grip).norm();
      if (prop.mass == 0.0 || distance - radius >= nearest || distance < 1e-6) continue;
      nearest = distance - radius;
      const Vec3 direction = (center - grip) / distance;
      hold.reaches = true;
      hold.direction = worldFromGrip.linear().transpose() * direction;
      // From outside, for a ray that begins within a prop does not meet it.
      hold.ray = Ray{center - (radius + kReach) * direction, direction};
    }
    if (!hold.reaches) hold.ray = aimOf(index);
  }
  was_[next_].time = frame.time;
  for (int index = 0; index < 2; ++index) {
    was_[next_].hands[index] = place_.worldFromStage() * frame.hands[index].stageFromGrip.translation();
  }
  next_ = (next_ + 1) % was_.size();
}

/// A hand feels that it holds a prop; inside, the hands feel what those of the avatar touch.
void HeadsetWindow::feel(const Scene& scene, const WindowValues& values) {
  if (time_ - touched_ < kBetweenTouches || scene.skeleton == nullptr || inside_ != true) return;
  const SceneFigure& worn = followedOf(scene, values.avatar);
  for (const Contact& contact : scene.contacts) {
    if (contact.avatar != worn.number || contact.impulse <= 0.0 || contact.bone == kNoJoint) continue;
    for (const int hand : {0, 1}) {
      const HumanBone bone = hand == 0 ? HumanBone::kLeftHand : HumanBone::kRightHand;
      if (worn.skeleton == nullptr || contact.bone != worn.skeleton->jointOf(bone)) continue;
      headset_->pulse(hand, contact.impulse / kFirmTouch);
      touched_ = time_;
    }
  }
}

std::vector<Change> HeadsetWindow::takeChanges() {
  std::vector<Change> changes = Window::takeChanges();
  for (int hand = 0; hand < countOf(holds_); ++hand) {
    Hold& hold = holds_[static_cast<std::size_t>(hand)];
    if (hold.state == Hold::State::kReleases) {
      changes.push_back({.id = ControlId::kRelease, .hand = hand, .velocity = hold.velocity});
      hold.state = Hold::State::kFree;
    } else if (hold.state == Hold::State::kPresses) {
      changes.push_back({.id = ControlId::kPress, .hand = hand, .ray = hold.ray});
      hold.state = Hold::State::kAsked;
    }
  }
  return changes;
}

/// What a controller holds stays as far along the ray as it was taken.
HandAim HeadsetWindow::aim(int hand) const {
  if (!headset_ || hand >= countOf(holds_) || !holds_[hand].holds()) return Window::aim(hand);
  const Ray ray = aimOf(hand);
  return {ray, ray.direction};
}

Camera HeadsetWindow::camera() const {
  return headset_ && inside_ ? eyes_[0] : Window::camera();
}

void HeadsetWindow::rest(double seconds) {
  if (!headset_) return Window::rest(seconds);
  if (!headset_->running()) Window::rest(std::min(seconds, kIdle));  // else the headset sets the pace
}

}  // namespace lorica
