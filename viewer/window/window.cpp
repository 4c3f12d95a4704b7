#include "viewer/window/window.h"

#include "geometry/errors.h"
#include "viewer/window/display_loss.h"
#include "viewer/window/first_picture.h"
#include "viewer/window/window_impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <string_view>
#include <thread>
#include <utility>

namespace lorica {
namespace {

/// Tells whether values are the same as before, without keeping them: 64 bits of FNV-1a.
class Fingerprint {
 public:
  void add(std::int64_t number) {
    for (int shift = 0; shift < 64; shift += 8) addByte(static_cast<std::uint64_t>(number) >> shift);
  }
  void add(double number) { add(std::bit_cast<std::int64_t>(number)); }
  void add(std::string_view text) {
    for (const char c : text) addByte(c);
    add(static_cast<std::int64_t>(text.size()));
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  void addByte(std::uint64_t byte) { hash_ = (hash_ ^ (byte & 0xff)) * 0x100000001b3; }
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

constexpr std::array<const char*, 3> kQualityNames = {"low", "medium", "high"};
constexpr std::array<RenderQuality, 3> kQualities = {RenderQuality::kLow, RenderQuality::kMedium, RenderQuality::kHigh};
constexpr double kCounted = 0.5;      // interval of the displayed statistics [s]
constexpr double kAlive = 0.1;        // between pictures while something loads [s]
constexpr double kShortRest = 0.002;  // limits the frame rate without vertical synchronisation [s]

std::string& lastGlfwError() {
  static std::string text;
  return text;
}

void* glfwProc(const char* name) {
  return reinterpret_cast<void*>(glfwGetProcAddress(name));
}

Error noWindow(const std::string& why) {
  return {ErrorCode::kNoDisplay,
          fmt::format("no window can be opened ({}): run without --window, or on a desktop with DISPLAY set; "
                      "snapshots and videos need no display",
                      why)};
}

}  // namespace

double secondsNow() {
  using Clock = std::chrono::steady_clock;
  static const Clock::time_point start = Clock::now();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Window::Impl::~Impl() {
  if (video) endVideo();
  panels.reset();  // their objects belong to the window's context
  renderer.reset();
  offscreen.reset();
  if (window != nullptr) glfwDestroyWindow(window);
  glfwTerminate();
}

Window::Window(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Window::~Window() = default;
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;

Result<Window> Window::create(const std::string& title, int width, int height, bool transparent) {
  if (width < 1 || height < 1 || width > 16384 || height > 16384) {
    return invalidArgument("window of {} x {} pixels: expected 1 to 16384 each", width, height);
  }
  if (!displayAvailable()) return noWindow("neither DISPLAY nor WAYLAND_DISPLAY is set");
  lastGlfwError().clear();
  glfwSetErrorCallback([](int, const char* text) { lastGlfwError() = text; });
  if (!glfwInit()) return noWindow(lastGlfwError().empty() ? "GLFW cannot be initialized" : lastGlfwError());
  endWithDisplay();

  auto impl = std::make_unique<Impl>();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);  // the renderer draws into its own framebuffers
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  glfwWindowHint(GLFW_TRANSPARENT_FRAMEBUFFER, transparent ? GLFW_TRUE : GLFW_FALSE);
  impl->window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (impl->window == nullptr) return noWindow(lastGlfwError());
  glfwMakeContextCurrent(impl->window);
  glfwSwapInterval(1);
  LORICA_TRY(impl->gl, loadGlFunctions(glfwProc));
  // To compile the shaders takes longer than to open the window. Keys that are pressed meanwhile wait for listen().
  glfwGetFramebufferSize(impl->window, &width, &height);
  drawFirstPicture(impl->gl, width, height);
  glfwSwapBuffers(impl->window);
  LORICA_TRY(impl->renderer, Renderer::create(glfwProc));
  LORICA_TRY(impl->panels, WindowPanels::create());
  impl->lastShow = secondsNow();
  impl->listen();
  if (transparent && glfwGetWindowAttrib(impl->window, GLFW_TRANSPARENT_FRAMEBUFFER) == GLFW_FALSE) {
    impl->setNotice("this desktop has no transparent windows: saved pictures are transparent", kNoticeSeconds);
  }
  return Window(std::move(impl));
}

Result<Window> Window::createUnseen(std::function<void(const std::string&)> say) {
  auto impl = std::make_unique<Impl>();
  impl->say = std::move(say);
  LORICA_TRY(impl->offscreen, OffscreenContext::create(true));
  LORICA_TRY(impl->renderer, Renderer::create(impl->offscreen->getProc()));
  LORICA_TRY(impl->gl, loadGlFunctions(impl->offscreen->getProc()));
  return Window(std::move(impl));
}

bool Window::open() const {
  return impl_->window == nullptr || !glfwWindowShouldClose(impl_->window);
}

bool Window::wantsStep() {
  WindowChoices& choices = impl_->choices;
  if (choices.scrubbing) return false;
  if (!choices.paused) {
    choices.steps = 0;
    return true;
  }
  if (choices.steps == 0) return false;
  --choices.steps;
  return true;
}

const WindowChoices& Window::choices() const {
  return impl_->choices;
}
void Window::setChoices(const WindowChoices& choices) {
  impl_->choices = choices;
}
void Window::setCamera(const Camera& camera) {
  impl_->camera = OrbitCamera(camera);
  impl_->followed.reset();
  impl_->targetAt.reset();
  impl_->fitted = 0.0;
  impl_->ownView = false;
}
void Window::addTimes(std::span<const TimedStage> stages) {
  impl_->times.add(stages);
}
void Window::notice(std::string sentence, double seconds) {
  impl_->setNotice(std::move(sentence), seconds);
}
void Window::problem(std::string sentence) {
  impl_->setNotice(std::move(sentence), kNoticeSeconds);
  impl_->noticeIsProblem = true;
}
void Window::setTitle(const std::string& title) {
  if (impl_->window != nullptr) glfwSetWindowTitle(impl_->window, title.c_str());
}
Camera Window::camera() const {
  return impl_->view();
}
HandAim Window::aim(int /*hand*/) const {
  const Camera now = camera();
  if (impl_->window == nullptr) return {};
  return {impl_->rayThrough(impl_->cursorX, impl_->cursorY), (now.target - now.eye).normalized()};
}
WindowRequests Window::takeRequests() {
  return std::exchange(impl_->requests, {});
}

bool Window::takeCancel() {
  WindowRequests requests = takeRequests();
  impl_->requests.files = std::move(requests.files);
  return requests.cancel;
}

bool Window::seen() const {
  return impl_->window != nullptr;
}

Renderer::GetProc Window::glFunctions() const {
  return impl_->offscreen ? impl_->offscreen->getProc() : glfwProc;
}

void Window::drawFor(Eyes eyes, double longest) {
  impl_->choice.setLongest(longest > 0.0 ? longest : QualityChoice::kLongest);
  impl_->eyes = std::move(eyes);
  if (impl_->window == nullptr) return;
  glfwMakeContextCurrent(impl_->window);
  glfwSwapInterval(impl_->eyes ? 0 : 1);
}

void Window::setQuality(std::optional<RenderQuality> quality) {
  const auto* found = quality ? std::find(kQualities.begin(), kQualities.end(), *quality) : kQualities.end();
  impl_->choices.quality = found == kQualities.end() ? -1 : found - kQualities.begin();
}

void Window::Impl::setNotice(std::string sentence, double seconds) {
  if (say) say(sentence);
  noticeText = std::move(sentence);
  noticeUntil = secondsNow() + seconds;
  noticeIsProblem = false;
}

void Window::Impl::drawScene(Scene scene, const WindowValues& values, int width, int height) {
  if (clearView) scene.unhidden = values.followed;
  choices.show.caption.clear();  // the panels show it
  choices.show.panel.clear();
  renderer->draw(scene, choices.show, view(), width, height);
}

void Window::Impl::countPicture(double seconds) {
  const double now = secondsNow();
  if (count == 0 || now - countBegin > 2.0 * kCounted) {  // also after a rest
    countBegin = now - seconds;
    count = 0;
    countSeconds = 0.0;
  }
  ++count;
  countSeconds += seconds;
  if (now - countBegin < kCounted) return;
  pictureSeconds = countSeconds / count;
  pictureRate = count / (now - countBegin);
  count = 0;
  countSeconds = 0.0;
}

void Window::Impl::chooseQuality(double seconds) {
  // The quality does not change during a video. What the user is being told is more important.
  if (choices.quality < 0 && !video && choice.add(seconds, secondsNow()) && secondsNow() >= noticeUntil &&
      choices.panels) {
    setNotice(fmt::format("drawing a frame takes {:.0f} ms: quality set to {}", 1e3 * seconds,
                          kQualityNames[choice.level()]));
  }
}

/// Differs where a picture does; what the scene holds is counted by WindowValues::changes.
std::uint64_t Window::Impl::printOf(const WindowValues& values, int width, int height) const {
  Fingerprint now;
  values.eachText([&](std::string_view text) { now.add(text); });
  const Camera seen = view();
  const SceneOptions& show = choices.show;
  for (const double number : {seen.eye.x(), seen.eye.y(), seen.eye.z(), seen.target.x(), seen.target.y(),
                              seen.target.z(), seen.targetAt.x(), seen.targetAt.y(), values.seconds, values.duration,
                              choices.speed, choices.scale, std::round(200.0 * values.loaded), values.smoothingDelay}) {
    now.add(number);
  }
  for (const std::int64_t number : std::initializer_list<std::int64_t>{
           width, height, values.parts, values.maxParts, values.scene, values.expression, values.avatar,
           values.character, values.motion, values.clip, values.person, std::int64_t(values.changes), choices.quality,
           choice.level(), choices.treatment.smoothing, choices.treatment.gravity}) {
    now.add(number);
  }
  for (const bool flag : {values.ended,
                          values.preparingParts,
                          values.outsideTraining,
                          values.holds != 0,
                          values.everyone,
                          values.treatable,
                          values.opens,
                          values.noMirror.empty(),
                          values.noSmoothing.empty(),
                          values.noGravity.empty(),
                          values.noThrow.empty(),
                          values.noUndo.empty(),
                          values.noLoop.empty(),
                          show.skin,
                          show.colorSkinByPart,
                          show.hulls,
                          show.bones,
                          show.props,
                          show.contacts,
                          show.particles,
                          show.ground,
                          show.transparent,
                          show.background.has_value(),
                          choices.treatment.mirror,
                          choices.paused,
                          choices.help,
                          choices.panels,
                          choices.loop,
                          choices.follow,
                          clearView,
                          secondsNow() < noticeUntil,
                          noticeIsProblem,
                          typed.has_value()}) {
    now.add(std::int64_t(flag));
  }
  for (const TargetScore& target : values.hits) now.add(std::int64_t(target.hits));
  if (secondsNow() < noticeUntil) now.add(noticeText);
  if (typed) now.add(*typed);
  if (show.background) now.add(double(show.background->sum()));
  return now.value();
}

void Window::show(const Scene& scene, const WindowValues& values) {
  Impl& i = *impl_;
  if (i.window == nullptr) return i.drawUnseen(scene);
  int width = 0, height = 0;
  glfwMakeContextCurrent(i.window);
  glfwGetFramebufferSize(i.window, &width, &height);
  i.dialog.take(i.requests.files);
  i.decideDrag((values.holds & 1u) != 0);
  i.follow(values.focus);
  if (width > 0 && height > 0) i.frameFollowed(values, 1.0 * width / height);
  i.last = values;

  const std::uint64_t print = i.printOf(values, width, height);
  const bool moves = i.video || (!values.loading.empty() && secondsNow() - i.lastShow > kAlive);
  const bool asked = i.choices.picture || i.choices.pictureWithPanels || i.choices.video || i.eyes;
  if (std::exchange(i.print, print) != print || moves || asked) i.touch();
  const bool seen = width > 0 && height > 0 &&  // minimised windows have no pixels
                    (i.video || glfwGetWindowAttrib(i.window, GLFW_ICONIFIED) == GLFW_FALSE);
  if (seen && i.picturesDue > 0) {
    --i.picturesDue;
    i.draw(scene, values, width, height);
  } else if (i.eyes) {
    (void)i.eyes(*i.renderer, scene, i.choices.show);
  }
  glfwPollEvents();
}

void Window::Impl::drawUnseen(const Scene& scene) {
  const double begin = secondsNow();
  renderer->setQuality(kQualities[choices.quality < 0 ? choice.level() : choices.quality]);
  if (!eyes || !eyes(*renderer, scene, choices.show)) return;
  gl.Finish();
  chooseQuality(secondsNow() - begin);
  ++pictures;
}

void Window::Impl::draw(const Scene& scene, const WindowValues& values, int width, int height) {
  const double begin = secondsNow();
  const int level = choices.quality < 0 ? choice.level() : choices.quality;
  // While the first session loads, a picture waits for something to see.
  const bool nothingYet = !values.loading.empty() && scene.vertices.empty() && scene.parts.empty();
  if (choices.picture && !nothingYet) {  // saved at the best quality
    renderer->setQuality(RenderQuality::kHigh);
    drawScene(scene, values, width, height);
    savePicture(renderer->readBack());
    choices.picture = false;
  }
  if (choices.video) toggleVideo(width, height);
  choices.video = false;
  const double drawing = secondsNow();
  renderer->setQuality(kQualities[level]);
  const bool mirrors = eyes && eyes(*renderer, scene, choices.show);
  if (!mirrors || video) drawScene(scene, values, width, height);
  if (video) addToVideo(width, height);
  renderer->present(width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);

  WindowValues shown = values;
  shown.pictureMilliseconds = 1e3 * pictureSeconds;
  shown.picturesASecond = pictureRate;
  shown.qualities = kQualityNames;
  shown.quality = level;
  shown.videoSeconds = video ? begin - video->begin : -1.0;
  shown.grains = !scene.particles.empty();
  if (scene.inset != nullptr && scene.inset->width > 0) {
    shown.insetWidth = 0.25 * width;
    shown.insetHeight = shown.insetWidth * scene.inset->height / scene.inset->width;
  }
  if (begin < noticeUntil) shown.notice = noticeText;
  shown.problem = noticeIsProblem;
  if (typed) shown.typed = *typed;
  choices.scrubbing = false;  // only visible panels can set it
  panels->draw(takePanelInput(width, height), shown, times, choices, requests);
  if (choices.pictureWithPanels) savePicture(readWindow(gl, width, height));
  choices.pictureWithPanels = false;
  // The driver may defer its work, which would then be measured as waiting for the display.
  gl.Finish();
  const double seconds = secondsNow() - drawing;
  countPicture(seconds);
  chooseQuality(seconds);
  glfwSwapBuffers(window);
  ++pictures;
}

void Window::rest(double seconds) {
  if (impl_->window == nullptr) return std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  glfwWaitEventsTimeout(impl_->picturesDue > 0 ? kShortRest : std::max(seconds, kShortRest));
}

void Window::chooseFiles() {
  if (!impl_->dialog.open()) impl_->typed.emplace();
}

long long Window::pictures() const {
  return impl_->pictures;
}

bool displayAvailable() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return set("DISPLAY") || set("WAYLAND_DISPLAY");
}

}  // namespace lorica
