#include "serve/page_screen.h"

#include "geometry/clock.h"
#include "geometry/counts.h"
#include "player/window_opener.h"
#include "serve/sent_file.h"
#include "serve/vrm_licence.h"
#include "skinning/clip_files/character_document.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Kind = Wish::Kind;

constexpr double kBetweenShapes = 0.1;    // of hulls [s]
constexpr double kBetweenStates = 0.1;    // [s]
constexpr std::size_t kMaxWaiting = 512;  // wishes; half of them throws, of which a turn takes one
constexpr int kWindowHands = 2;           // are those of the window

/// Texts of others may be any bytes.
std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json matrixOf(const Affine3& transform) {
  Json numbers = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) numbers.push_back(transform(row, column));
  }
  return numbers;
}

/// A joint that moves a node of the file, or the file's scene.
Json jointsOf(const CharacterDocument& document) {
  Json joints = Json::array();
  bool scene = false;
  for (std::size_t j = 0; j < document.nodeOfJoint.size(); ++j) {
    Json joint = {{"node", document.nodeOfJoint[j]}};
    const bool movesScene = !scene && document.hangOn[j] < 0;
    if (document.nodeOfJoint[j] >= 0 || movesScene) joint["bind"] = matrixOf(document.nodeFromModel[j].inverse());
    scene = scene || movesScene;
    joints.push_back(std::move(joint));
  }
  return joints;
}

Result<CharacterDocument> documentOf(const PreparedAvatar& avatar, PathTrust paths) {
  if (!avatar.subject.file) return characterDocument(avatar.character());
  return characterDocument(ClipCharacter{avatar.setting.character, &*avatar.subject.file, paths});
}

/// File names without their folders, which are nobody's business.
std::vector<std::string> namesOf(std::span<const std::string> files) {
  std::vector<std::string> names;
  for (const std::string& file : files) names.push_back(fs::path(file).filename().string());
  return names;
}

template <typename Choices>
Json namesOfChoices(const Choices& choices) {
  Json names = Json::array();
  for (const auto& choice : choices) names.push_back(choice.name);
  return names;
}

}  // namespace

Result<void> PageScreen::begin(const Run& run, Host& host) {
  const auto cast = std::make_shared<ServedCast>();
  cast->run = ++run_;
  Json hello = {{"type", "hello"},    {"wire", 1},          {"run", run_},
                {"name", run.name()}, {"live", run.live()}, {"watched", run.watched()}};
  hello["avatars"] = Json::array();
  for (std::size_t a = 0; a < run.cast.avatars.size(); ++a) {
    const PreparedAvatar& prepared = run.cast.avatars[a];
    const Character& character = prepared.character();
    LORICA_TRY(CharacterDocument document, documentOf(prepared, host.paths));
    const std::string licence = vrmLicence(document.writer.document);
    LORICA_TRY(std::string file, document.writer.glb(character.name));
    cast->characters.push_back(std::make_shared<const std::string>(std::move(file)));
    if (!licence.empty()) host.warn(fmt::format("{}: {}", character.name, licence));
    Json avatar = {{"name", character.name},
                   {"character", fmt::format("/character/{}.glb", a)},
                   {"plain", character.avatar == nullptr || character.avatar->plain},
                   {"humanoid", character.skeleton.jointOf(HumanBone::kHips) != kNoJoint},
                   {"licence", licence},
                   {"head", character.skeleton.jointOf(HumanBone::kHead)},
                   {"joints", jointsOf(document)}};
    avatar["expressions"] = Json::array();
    if (character.avatar != nullptr) {
      for (const Expression& one : character.avatar->face.expressions.list) avatar["expressions"].push_back(one.name);
    }
    hello["avatars"].push_back(std::move(avatar));
  }
  const Camera from = camera();
  hello["camera"] = Json{{"eye", listOf(from.eye)}, {"target", listOf(from.target)}, {"fov", from.verticalFov}};
  cast->hello = textOf(hello);
  server_.setCast(cast);
  hands_ = {};
  present_ = &run;
  return {};
}

/// Takes the wishes that came since: what is only about this screen is done at once, the rest waits for its turn.
void PageScreen::hear() {
  heard_.clear();
  server_.takeWishes(heard_);
  for (const Wish& wish : heard_) {
    if (wish.kind == Kind::kHead) {
      HeadsetPose& heard = headsets_.emplace_back();
      heard.wearer = wish.client;
      heard.pose = wish.pose;
      continue;
    }
    const std::size_t most = wish.kind == Kind::kThrow ? kMaxWaiting / 2 : kMaxWaiting;
    const bool rare = wish.kind == Kind::kGone || wish.kind == Kind::kOpen;
    if (waiting_.size() < most || rare) waiting_.push_back(wish);
  }
}

/// The hand of the world that a client's hand moves, or a free one that nothing was asked of yet in this turn.
/// @return null if there is none
PageScreen::ClientHand* PageScreen::handFor(const Wish& press, const WindowRequests& requests) {
  ClientHand* found = nullptr;
  for (int i = window_ != nullptr ? kWindowHands : 0; i < countOf(hands_); ++i) {
    if (hands_[i].isOf(press)) return &hands_[i];
    if (found == nullptr && hands_[i].client == 0 && !requests.hands[i].released) found = &hands_[i];
  }
  return found;
}

void PageScreen::obey(const Wish& wish, WindowRequests& requests) {
  WindowChoices choices = this->choices();
  const auto file = [&](const std::vector<std::string>& files) {
    if (wish.index >= 0 && wish.index < countOf(files)) requests.files = {files[wish.index]};
  };
  const auto isIn = [&](int count) { return wish.index >= 0 && wish.index < count; };
  const Kind kind = wish.kind;
  if (kind == Kind::kPause) choices.paused = wish.on;
  if (kind == Kind::kStep) {
    choices.paused = true;
    ++choices.steps;
  }
  if (kind == Kind::kRestart) requests.seekTo = 0.0;
  if (kind == Kind::kSeek) requests.seekTo = wish.to;
  if (kind == Kind::kSpeed && std::ranges::find(kSpeeds, wish.to, &SpeedChoice::factor) != std::end(kSpeeds)) {
    choices.speed = wish.to;
  }
  if (kind == Kind::kLoop) choices.loop = wish.on;
  if (kind == Kind::kRecord) requests.record = wish.on;
  if (kind == Kind::kMirror) choices.treatment.mirror = wish.on;
  if (kind == Kind::kSmoothing && isIn(countOf(kSmoothings))) choices.treatment.smoothing = wish.index;
  if (kind == Kind::kGravity && isIn(countOf(kGravities))) choices.treatment.gravity = wish.index;
  if (kind == Kind::kScene && isIn(scenes_)) requests.scene = wish.index;
  if (kind == Kind::kCharacter) file(characters_);
  if (kind == Kind::kMotion) file(motions_);
  if (kind == Kind::kRecent) file(recents_);
  if (kind == Kind::kExpression) requests.expression = wish.index;
  if (kind == Kind::kClip && isIn(clips_)) requests.clip = wish.index;
  if (kind == Kind::kPerson && wish.index < people_) requests.person = wish.index;
  if (kind == Kind::kParts && wish.index >= 1 && wish.index <= maxParts_) requests.parts = wish.index;
  if (kind == Kind::kThrow) {
    requests.throwBall = true;
    requests.thrower = camera();
    requests.thrower->eye = wish.origin;
    requests.thrower->target = wish.target;
  }
  if (kind == Kind::kPress) {
    if (ClientHand* hand = handFor(wish, requests)) {
      *hand = {wish.client, wish.hand, wish.aim()};
      requests.hands[hand - hands_.data()].pressed = hand->aim.ray;
    }
  }
  for (int i = 0; i < countOf(hands_); ++i) {
    if (kind == Kind::kDrag && hands_[i].isOf(wish)) hands_[i].aim = wish.aim();
    const bool leaves = kind == Kind::kGone && hands_[i].client == wish.client;
    if (!leaves && !(kind == Kind::kRelease && hands_[i].isOf(wish))) continue;
    hands_[i].client = 0;
    requests.hands[i].released = true;
    requests.hands[i].throwsWith = wish.velocity;
  }
  if (kind == Kind::kOpen) requests.received = wish.file;
  if (kind == Kind::kUndo) requests.undo = true;
  if (kind == Kind::kCancel) requests.cancel = true;
  setChoices(choices);
}

/// All that waits, but for a second ball and a second file.
WindowRequests PageScreen::takeRequests() {
  WindowRequests requests = window_ != nullptr ? window_->takeRequests() : WindowRequests();
  hear();
  std::size_t kept = 0;
  for (const Wish& wish : waiting_) {
    const bool second =
        wish.kind == Kind::kOpen ? !requests.received.empty() : wish.kind == Kind::kThrow && requests.throwBall;
    if (second) {
      waiting_[kept++] = wish;
    } else {
      obey(wish, requests);
    }
  }
  waiting_.resize(kept);
  return requests;
}

bool PageScreen::takeCancel() {
  hear();
  bool cancel = window_ != nullptr && window_->takeCancel();
  for (const Wish& wish : waiting_) cancel = cancel || wish.kind == Kind::kCancel;
  std::erase_if(waiting_, [](const Wish& wish) {
    return wish.kind != Kind::kRelease && wish.kind != Kind::kGone && wish.kind != Kind::kOpen;
  });
  return cancel;
}

bool PageScreen::wantsStep() {
  if (window_ != nullptr) return window_->wantsStep();
  if (!choices_.paused) {
    choices_.steps = 0;
    return true;
  }
  if (choices_.steps == 0) return false;
  --choices_.steps;
  return true;
}

void PageScreen::setChoices(const WindowChoices& choices) {
  if (window_ != nullptr) {
    window_->setChoices(choices);
  } else {
    choices_ = choices;
  }
}

HandAim PageScreen::aim(int hand) const {
  return window_ != nullptr && hand < kWindowHands ? window_->aim(hand) : hands_[hand].aim;
}

void PageScreen::setCamera(const Camera& camera) {
  camera_ = camera;
  if (window_ != nullptr) window_->setCamera(camera);
}

void PageScreen::rest(double seconds) {
  if (window_ != nullptr) return window_->rest(seconds);
  if (waiting_.empty()) server_.waitForWish(seconds);
}

void PageScreen::chooseFiles() {
  if (window_ != nullptr) window_->chooseFiles();
}

void PageScreen::addTimes(std::span<const TimedStage> stages) {
  times_.assign(stages.begin(), stages.end());
  if (window_ != nullptr) window_->addTimes(stages);
}

void PageScreen::say(const std::string& sentence, bool problem) {
  const std::string text = withoutFolder(sentence, server_.sentFiles());
  server_.say(textOf({{"type", "notice"}, {"text", text}, {"problem", problem}}));
}

void PageScreen::notice(std::string sentence, double seconds) {
  if (!sentence.empty()) say(sentence, false);
  if (window_ != nullptr) window_->notice(std::move(sentence), seconds);
}

void PageScreen::problem(std::string sentence) {
  say(sentence, true);
  if (window_ != nullptr) window_->problem(std::move(sentence));
}

void PageScreen::setTitle(const std::string& title) {
  if (window_ != nullptr) window_->setTitle(title);
}

std::string PageScreen::stateOf(const WindowValues& values) const {
  const WindowChoices& chosen = choices();
  Json hits = Json::array(), times = Json::array(), speeds = Json::array();
  for (const TargetScore& target : values.hits) hits.push_back({{"name", target.name}, {"hits", target.hits}});
  // Tenths are enough to read, and do not make another state of every frame.
  for (const TimedStage& stage : times_) times.push_back({stage.name, std::round(10.0 * stage.milliseconds) / 10.0});
  for (const SpeedChoice& speed : kSpeeds) speeds.push_back(speed.factor);
  return textOf({{"type", "state"},
                 {"title", values.name},
                 {"status", values.status},
                 {"seconds", std::round(10.0 * values.seconds) / 10.0},
                 {"duration", values.duration},
                 {"paused", chosen.paused},
                 {"ended", values.ended},
                 {"loop", chosen.loop},
                 {"speed", chosen.speed},
                 {"speeds", std::move(speeds)},
                 {"mirror", chosen.treatment.mirror},
                 {"smoothing", chosen.treatment.smoothing},
                 {"smoothings", namesOfChoices(kSmoothings)},
                 {"gravity", chosen.treatment.gravity},
                 {"gravities", namesOfChoices(kGravities)},
                 {"treatable", values.treatable},
                 {"parts", values.parts},
                 {"maxParts", values.maxParts},
                 {"scenes", values.scenes},
                 {"scene", values.scene},
                 {"characters", namesOf(values.characters)},
                 {"character", values.character},
                 {"motions", namesOf(values.motions)},
                 {"motion", values.motion},
                 {"recents", namesOf(recents_)},
                 {"expressions", values.expressions},
                 {"expression", values.expression},
                 {"clips", values.clips},
                 {"clip", values.clip},
                 {"people", values.people},
                 {"person", values.person},
                 {"everyone", values.everyone},
                 {"warnings", values.warnings},
                 {"hits", std::move(hits)},
                 {"times", std::move(times)},
                 {"loading", values.loading},
                 {"loaded", std::round(100.0 * values.loaded) / 100.0},
                 {"recording", fs::path(values.recording).filename().string()},
                 {"outside", values.outsideTraining},
                 {"holds", values.holds != 0},
                 {"no",
                  {{"throw", values.noThrow},
                   {"undo", values.noUndo},
                   {"loop", values.noLoop},
                   {"record", values.noRecord},
                   {"open", values.opens ? server_.noSentFiles() : kWrittenOnce},
                   {"mirror", values.noMirror},
                   {"smoothing", values.noSmoothing},
                   {"gravity", values.noGravity}}},
                 {"clients", server_.clients()}});
}

std::span<const HeadsetPose> PageScreen::headsets() {
  for (const HeadsetPose& heard : window_ ? window_->headsets() : std::span<const HeadsetPose>())
    headsets_.push_back(heard);
  toldHeadsets_.clear();
  std::swap(headsets_, toldHeadsets_);
  return toldHeadsets_;
}

void PageScreen::tell(const HeadsetNews& news) {
  if (window_ != nullptr) window_->tell(news);
  if (!news.registration && !news.alone && news.advice.empty()) return;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  Json json = {{"type", "registration"},
               {"known", news.registration.has_value()},
               {"alone", news.alone},
               {"advice", news.advice}};
  if (news.registration) {
    const Registration& known = *news.registration;
    json["yaw"] = -known.yaw;
    json["translation"] = listOf(known.stageFromFloor().inverse().translation() - news.origin);
    json["degrees"] = std::round(100.0 * kDegrees * known.yawDeviation) / 100.0;
    json["millimetres"] = std::round(1e3 * known.levelDeviation);
  }
  server_.say(textOf(json));
}

void PageScreen::show(const Scene& scene, const WindowValues& values) {
  // Compared, since copying names in each frame would allocate.
  if (!std::ranges::equal(characters_, values.characters)) {
    characters_.assign(values.characters.begin(), values.characters.end());
  }
  if (!std::ranges::equal(motions_, values.motions)) motions_.assign(values.motions.begin(), values.motions.end());
  scenes_ = countOf(values.scenes);
  clips_ = countOf(values.clips);
  people_ = countOf(values.people);
  maxParts_ = values.maxParts;
  for (int i = 0; i < countOf(hands_); ++i) {
    if ((values.holds >> i & 1u) == 0) hands_[i].client = 0;  // its ray met none, or the world is another
  }

  const int clients = server_.clients();
  const unsigned layers = server_.layers();
  if (clients > 0 && scene.skeleton != nullptr &&
      (values.changes != shownChanges_ || clients != shownClients_ || layers != shownLayers_ || run_ != shownRun_)) {
    // Between shapes the parts move as they are: that is a sixth of the bytes, and hardly to be seen.
    const bool shapes = layers != shownLayers_ || run_ != shownRun_ || clients != shownClients_ ||
                        now() - shapesTime_ >= kBetweenShapes;
    if (shapes) shapesTime_ = now();
    server_.next().take(scene, layers, shapes);
    server_.publish();
    shownChanges_ = values.changes;
    shownRun_ = run_;
    shownLayers_ = layers;
  }
  if (clients > 0 && (clients != shownClients_ || now() - stateTime_ >= kBetweenStates)) {
    recents_.clear();  // the owner's are nobody's business
    std::copy_if(values.recent.begin(), values.recent.end(), std::back_inserter(recents_), [&](const fs::path& file) {
      return !server_.sentFiles().empty() && file.parent_path() == server_.sentFiles();
    });
    server_.setState(stateOf(values));
    stateTime_ = now();
  }
  shownClients_ = clients;
  if (window_ != nullptr) window_->show(scene, values);
}

}  // namespace lorica
