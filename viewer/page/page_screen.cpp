#include "viewer/page/page_screen.h"

#include "geometry/clock.h"
#include "geometry/counts.h"
#include "session/prepare/subject.h"
#include "skinning/clip_files/character_document.h"
#include "viewer/page/page_files.h"
#include "viewer/player/window_opener.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Kind = ClientMessage::Kind;

constexpr double kBetweenShapes = 0.1;               // of hulls [s]
constexpr double kBetweenStates = 0.1;               // [s]
constexpr std::size_t kMaxThrows = 256;              // that wait; a turn takes one
constexpr std::size_t kMaxPlayedPoints = 5'000'000;  // of a mesh in several poses: 60 MB
constexpr int kWindowHands = 2;                      // are those of the window

/// Texts of others may be any bytes.
std::string jsonText(const Json& json) {
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

/// A mesh in several poses, without bones: a pose is a morph target, in the order of the joints after the first, whose
/// scales less 1 are the weights. Without them if they are too much for a page.
Result<CharacterDocument> playedDocument(const Character& played) {
  Character still = played;
  still.shapes = {};
  LORICA_TRY(still.skeleton, Skeleton::create({played.skeleton.joint(0)}));
  still.jointFromModel.resize(1);
  CharacterDocument document = characterDocument(still);
  const std::size_t vertexCount = played.mesh.vertices.size(), poses = played.jointFromModel.size() - 1;
  if (poses * vertexCount > kMaxPlayedPoints) return document;
  std::vector<std::vector<float>> targets(poses, std::vector<float>(3 * vertexCount, 0.0F));
  for (std::size_t v = 0; v < vertexCount; ++v) {
    for (const ShapeOffset& shape : played.shapes.of(v)) {
      const Vec3f offset = shape.offset.cast<float>();
      std::copy(offset.begin(), offset.end(), &targets[shape.joint - 1][3 * v]);
    }
  }
  for (const std::vector<float>& target : targets) {
    const int accessor = document.writer.addNumbers(target, "VEC3", true);
    document.writer.document["meshes"][0]["primitives"][0]["targets"].push_back({{"POSITION", accessor}});
  }
  return document;
}

Result<CharacterDocument> documentOf(const PreparedAvatar& avatar, PathTrust paths) {
  if (!avatar.subject.file) return characterDocument(avatar.character());
  if (avatar.subject.file->format == kSequence) return playedDocument(avatar.subject.file->character);
  return characterDocument(ClipCharacter{avatar.setting.character, &*avatar.subject.file, paths});
}

constexpr std::array<const char*, 6> kKinds = {"toggle", "button", "list", "files", "number", "other"};
constexpr std::array<const char*, 6> kGroups = {"camera", "time", "things", "look", "screen", "nowhere"};

/// What is as usual is left out.
Json jsonOf(const Control& control) {
  Json json = {{"id", control.name},
               {"label", control.label},
               {"kind", kKinds[static_cast<std::size_t>(control.kind)]},
               {"group", kGroups[static_cast<std::size_t>(control.group)]}};
  const auto add = [&](const char* name, const auto& value, bool any) {
    if (any) json[name] = value;
  };
  if (control.kind == ControlKind::kToggle) {
    json["value"] = control.value != 0.0;
  } else if (control.id != ControlId::kSeek) {  // that is the state's `seconds`
    json["value"] = control.value;
  }
  add("keys", control.keys, *control.keys != '\0');
  add("help", control.help, *control.help != '\0');
  if (control.kind == ControlKind::kList || control.kind == ControlKind::kFiles) {
    json["choices"] = Json::array();
    // Folders are nobody's business.
    for (const std::string& name : control.choices) {
      json["choices"].push_back(control.kind == ControlKind::kFiles ? fs::path(name).filename().string() : name);
    }
    add("none", control.none, control.least < 0.0 || control.value < 0.0);
  }
  add("least", control.least, control.least != 0.0);
  add("most", control.most, control.most != 0.0);
  add("no", control.whyNot, !control.whyNot.empty());
  add("own", true, control.isOn(on_screen::kOwn));
  add("repeats", true, control.isOn(on_screen::kRepeats));
  add("absent", true, control.absent);
  return json;
}

}  // namespace

std::string vrmLicence(const Json& document) {
  for (const std::string_view extension : {"VRMC_vrm", "VRM"}) {
    const Json::json_pointer path(fmt::format("/extensions/{}/meta", extension));
    if (!document.contains(path) || !document.at(path).is_object()) continue;
    const Json& meta = document.at(path);
    if (extension == "VRM" && meta.value("licenseName", Json()) == "Redistribution_Prohibited") {
      return "its licence does not let it be given to others, and whoever opens the page gets it";
    }
    if (extension == "VRMC_vrm" && meta.value("allowRedistribution", Json()) != true) {
      return "its licence does not say that it may be given to others, and whoever opens the page gets it";
    }
  }
  return "";
}

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
                   {"joints", jointsOf(document)},
                   {"played", prepared.subject.file && prepared.subject.file->format == kSequence}};
    avatar["expressions"] = Json::array();
    if (character.avatar != nullptr) {
      for (const Expression& one : character.avatar->face.expressions.list) avatar["expressions"].push_back(one.name);
    }
    hello["avatars"].push_back(std::move(avatar));
  }
  const Camera from = camera();
  hello["camera"] = Json{{"eye", listOf(from.eye)}, {"target", listOf(from.target)}, {"fov", from.verticalFov}};
  cast->hello = jsonText(hello);
  server_.setCast(cast);
  hands_ = {};
  present_ = &run;
  return {};
}

/// The hand of the world that a client's hand moves, or a free one. @return null if there is none
PageScreen::ClientHand* PageScreen::handFor(const ClientMessage& press) {
  ClientHand* found = nullptr;
  for (int i = window_ != nullptr ? kWindowHands : 0; i < countOf(hands_); ++i) {
    if (hands_[i].isOf(press)) return &hands_[i];
    if (found == nullptr && hands_[i].client == 0) found = &hands_[i];
  }
  return found;
}

void PageScreen::perform(const ClientMessage& message) {
  Change change = message.change;
  for (int i = 0; i < countOf(hands_); ++i) {
    ClientHand& hand = hands_[i];
    if (message.kind == Kind::kDrag && hand.isOf(message)) hand.aim = message.aim;
    const bool leaves = message.kind == Kind::kGone && hand.client == message.client;
    const bool releases = message.kind == Kind::kChange && change.id == ControlId::kRelease && hand.isOf(message);
    if (!leaves && !releases) continue;
    hand.client = 0;
    addTo(asked().changes,
          {.id = ControlId::kRelease, .client = message.client, .hand = i, .velocity = change.velocity});
  }
  if (message.kind != Kind::kChange || change.id == ControlId::kRelease) return;
  change.client = message.client;
  if (change.id == ControlId::kPress) {
    ClientHand* hand = handFor(message);
    if (hand == nullptr) return;
    *hand = {message.client, change.hand, message.aim};
    change.hand = static_cast<int>(hand - hands_.data());
    return addTo(asked().changes, std::move(change));
  }
  if (change.id == ControlId::kThrow) {
    if (throws_.size() < kMaxThrows) throws_.push_back(std::move(change));
    return;
  }
  if (change.id == ControlId::kOpen) {
    change.client = -1;  // a file comes over HTTP; without one a dialogue would open elsewhere
    if (!change.files.empty()) addTo(asked().changes, std::move(change));
    return;
  }
  asked().ask(std::move(change));
}

/// Does what came since.
void PageScreen::receive() {
  messages_.clear();
  server_.takeMessages(messages_);
  for (const ClientMessage& message : messages_) {
    if (message.kind == Kind::kHead) headsets_.push_back({message.client, message.pose});
    perform(message);
  }
}

std::vector<Change> PageScreen::takeChanges() {
  receive();
  if (!throws_.empty()) {
    addTo(asked().changes, std::move(throws_.front()));
    throws_.pop_front();
  }
  return window_ != nullptr ? window_->takeChanges() : Screen::takeChanges();
}

bool PageScreen::takeCancel() {
  receive();
  throws_.clear();
  return Screen::takeCancel();
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
  if (throws_.empty()) server_.waitForMessage(seconds);
}

void PageScreen::chooseFiles() {
  if (window_ != nullptr) window_->chooseFiles();
}

void PageScreen::addTimes(std::span<const TimedStage> stages) {
  times_.assign(stages.begin(), stages.end());
  if (window_ != nullptr) window_->addTimes(stages);
}

void PageScreen::send(const std::string& notice, bool problem) {
  const std::string text = withoutFolder(notice, server_.facts().sentFiles);
  server_.say(jsonText({{"type", "notice"}, {"text", text}, {"problem", problem}}));
}

void PageScreen::notice(std::string sentence, double seconds) {
  if (!sentence.empty()) send(sentence, false);
  if (window_ != nullptr) window_->notice(std::move(sentence), seconds);
}

void PageScreen::problem(std::string sentence) {
  send(sentence, true);
  if (window_ != nullptr) window_->problem(std::move(sentence));
}

void PageScreen::setTitle(const std::string& title) {
  if (window_ != nullptr) window_->setTitle(title);
}

std::string PageScreen::controlsOf(const Controls& controls) const {
  Json list = Json::array();
  for (const Control& control : controls) {
    if (!control.isOn(on_screen::kPage)) continue;
    list.push_back(jsonOf(control));
    if (control.id == ControlId::kOpen && control.whyNot.empty() && !server_.facts().noSentFiles.empty()) {
      list.back()["no"] = server_.facts().noSentFiles;
    }
  }
  return jsonText(Json{{"type", "controls"}, {"controls", std::move(list)}});
}

std::string PageScreen::stateOf(const WindowValues& values) const {
  Json hits = Json::array(), times = Json::array();
  for (const TargetScore& target : values.hits) hits.push_back({{"name", target.name}, {"hits", target.hits}});
  // Tenths are enough to read, and do not make another state of every frame.
  for (const TimedStage& stage : times_) times.push_back({stage.name, std::round(10.0 * stage.milliseconds) / 10.0});
  return jsonText({{"type", "state"},
                   {"title", values.name},
                   {"status", values.status},
                   {"seconds", std::round(10.0 * values.seconds) / 10.0},
                   {"duration", values.duration},
                   {"ended", values.ended},
                   {"warnings", values.warnings},
                   {"hits", std::move(hits)},
                   {"times", std::move(times)},
                   {"loading", values.loading},
                   {"loaded", std::round(100.0 * values.loaded) / 100.0},
                   {"recording", fs::path(values.recording).filename().string()},
                   {"outside", values.outsideTraining},
                   {"holds", values.holds != 0},
                   {"clients", server_.clients()}});
}

std::span<const HeadsetPose> PageScreen::headsets() {
  for (const HeadsetPose& pose : window_ ? window_->headsets() : std::span<const HeadsetPose>())
    headsets_.push_back(pose);
  givenHeadsets_.clear();
  std::swap(headsets_, givenHeadsets_);
  return givenHeadsets_;
}

void PageScreen::setWearer(const WearerState& state) {
  if (window_ != nullptr) window_->setWearer(state);
  if (!state.registration && !state.alone && state.advice.empty()) return;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  Json json = {{"type", "registration"},
               {"known", state.registration.has_value()},
               {"alone", state.alone},
               {"advice", state.advice}};
  if (state.registration) {
    const Registration& known = *state.registration;
    json["yaw"] = -known.yaw;
    json["translation"] = listOf(known.stageFromFloor().inverse().translation() - state.origin);
    json["degrees"] = std::round(100.0 * kDegrees * known.yawDeviation) / 100.0;
    json["millimetres"] = std::round(1e3 * known.levelDeviation);
  }
  server_.say(jsonText(json));
}

void PageScreen::show(const Scene& scene, const WindowValues& values) {
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
    if (values.controls != nullptr) server_.set(ServedText::kControls, controlsOf(*values.controls));
    server_.set(ServedText::kState, stateOf(values));
    stateTime_ = now();
  }
  shownClients_ = clients;
  if (window_ != nullptr) window_->show(scene, values);
}

}  // namespace lorica
