#include "viewer/window/window.h"
#include "viewer/renderer/text.h"

#include "geometry/errors.h"
#include "geometry/hard_stop.h"
#include "viewer/window/window_impl.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

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

constexpr std::array<RenderQuality, 3> kRenderQualities = {RenderQuality::kLow, RenderQuality::kMedium,
                                                           RenderQuality::kHigh};
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
  return noDisplay(
      "no window can be opened ({}): run without --window, or on a desktop with DISPLAY set; "
      "snapshots and videos need no display",
      why);
}

constexpr int kDisplayLost = 2;
constexpr std::string_view kLossSentence = "lorica: the connection to the display was lost\n";

/// Must not return.
int onLoss(void* /*display*/) {
  runHardStop();
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kLossSentence.data(), kLossSentence.size());
  _exit(kDisplayLost);
}

/// From now on, losing the connection to the display ends the program: the tasks of AtHardStop run, a sentence goes to
/// standard error, the exit status is 2. X11 would end it too, without them. Call it after glfwInit().
void endWithDisplay() {
  // GLFW has loaded libX11, which viewer/ is not linked with: there may be Wayland instead. GLFW 3.4 opens it for
  // itself, so its functions are not found among those of the program.
  void* x11 = dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);
  if (x11 == nullptr) return;
  using Handler = int (*)(void*);
  using SetHandler = Handler (*)(Handler);
  const auto set = reinterpret_cast<SetHandler>(dlsym(x11, "XSetIOErrorHandler"));
  if (set != nullptr) set(onLoss);
}

struct Color {
  float red, green, blue;  // sRGB
};

constexpr Color kSky{0.85f, 0.87f, 0.89f}, kPanel{0.98f, 0.98f, 0.99f}, kBar{0.83f, 0.85f, 0.89f};  // of kLightPanels
constexpr Color kInk{0.11f, 0.14f, 0.19f};

void fill(const GlFunctions& gl, const Color& color, int left, int bottom, int width, int height) {
  gl.Scissor(left, bottom, width, height);
  gl.ClearColor(color.red, color.green, color.blue, 1.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT);
}

/// Draws what a window shows before anything else can be drawn: the background with a word and an empty progress bar,
/// without shaders. Into the bound framebuffer.
void drawFirstPicture(const GlFunctions& gl, int width, int height) {
  gl.Enable(GL_SCISSOR_TEST);
  fill(gl, kSky, 0, 0, width, height);
  // Where the panels show what is loading.
  const int margin = std::max(1, height / 72), panelWidth = width / 4 + 2 * margin;
  const int left = (width - panelWidth) / 2, bottom = height - 5 * margin;
  fill(gl, kPanel, left, bottom - 3 * margin, panelWidth, 7 * margin);
  fill(gl, kBar, left + margin, bottom - 2 * margin, panelWidth - 2 * margin, margin);
  const TextMask word = drawText("Starting ...", std::clamp(2 * margin, 12, 64));
  for (int y = 0; y < word.height; ++y) {
    const std::uint8_t* row = word.coverage.data() + static_cast<std::ptrdiff_t>(y) * word.width;
    for (int x = 0, end = 0; x < word.width; x = end + 1) {  // what is mostly covered, from x to before end
      for (end = x; end < word.width && row[end] > 127; ++end) {
      }
      if (end > x) fill(gl, kInk, left + margin + x, bottom + 3 * margin - y, end - x, 1);
    }
  }
  gl.Disable(GL_SCISSOR_TEST);
}

}  // namespace

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
  impl->lastShow = now();
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

Asked& Window::asked() {
  return impl_->asked;
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
  const auto* found =
      quality ? std::find(kRenderQualities.begin(), kRenderQualities.end(), *quality) : kRenderQualities.end();
  impl_->choices.quality = found == kRenderQualities.end() ? -1 : found - kRenderQualities.begin();
}

void Window::Impl::setNotice(std::string sentence, double seconds) {
  if (say) say(sentence);
  noticeText = std::move(sentence);
  noticeUntil = now() + seconds;
  noticeIsProblem = false;
}

void Window::Impl::drawScene(Scene scene, const WindowValues& values, int width, int height) {
  if (clearView) scene.unhidden = values.followed;
  choices.show.caption.clear();  // the panels show it
  choices.show.panel.clear();
  renderer->draw(scene, choices.show, view(), width, height);
}

void Window::Impl::countPicture(double seconds) {
  const double time = now();
  if (count == 0 || time - countBegin > 2.0 * kCounted) {  // also after a rest
    countBegin = time - seconds;
    count = 0;
    countSeconds = 0.0;
  }
  ++count;
  countSeconds += seconds;
  if (time - countBegin < kCounted) return;
  pictureSeconds = countSeconds / count;
  pictureRate = count / (time - countBegin);
  count = 0;
  countSeconds = 0.0;
}

void Window::Impl::chooseQuality(double seconds) {
  // The quality does not change during a video. What the user is being told is more important.
  if (choices.quality < 0 && !video && choice.add(seconds, now()) && now() >= noticeUntil && choices.panels) {
    setNotice(fmt::format("drawing a frame takes {:.0f} ms: quality set to {}", 1e3 * seconds,
                          choiceNames<kQualities>()[choice.level()]));
  }
}

/// Differs where a picture does; what the scene holds is counted by WindowValues::changes.
std::uint64_t Window::Impl::printOf(const WindowValues& values, int width, int height) const {
  Fingerprint all;
  values.eachText([&](std::string_view text) { all.add(text); });
  const Camera seen = view();
  const SceneOptions& show = choices.show;
  for (const double number : {seen.eye.x(), seen.eye.y(), seen.eye.z(), seen.target.x(), seen.target.y(),
                              seen.target.z(), seen.targetAt.x(), seen.targetAt.y(), values.seconds, values.duration,
                              choices.scale, std::round(200.0 * values.loaded), values.smoothingDelay}) {
    all.add(number);
  }
  for (const Control& control : controls) {
    all.add(control.value);
    all.add(std::string_view(control.label));
    all.add(std::int64_t(2 * control.absent + control.whyNot.empty()));
  }
  for (const std::int64_t number :
       std::initializer_list<std::int64_t>{width, height, std::int64_t(values.changes), choice.level(), values.ended,
                                           values.outsideTraining, values.holds != 0, values.empty(), show.transparent,
                                           clearView, now() < noticeUntil, noticeIsProblem, typed.has_value()}) {
    all.add(number);
  }
  for (const TargetScore& target : values.hits) all.add(std::int64_t(target.hits));
  if (now() < noticeUntil) all.add(noticeText);
  if (typed) all.add(*typed);
  if (show.background) all.add(double(show.background->sum()));
  return all.value();
}

void Window::show(const Scene& scene, const WindowValues& values) {
  Impl& i = *impl_;
  if (i.window == nullptr) return i.drawUnseen(scene);
  int width = 0, height = 0;
  glfwMakeContextCurrent(i.window);
  glfwGetFramebufferSize(i.window, &width, &height);
  std::vector<std::string> files;
  i.dialog.take(files);
  if (!files.empty()) i.asked.ask({.id = ControlId::kOpen, .files = std::move(files)});
  i.decideDrag((values.holds & 1u) != 0);
  i.follow(values.focus);
  if (width > 0 && height > 0) i.frameFollowed(values, 1.0 * width / height);
  i.facing = values.facing;
  i.listControls(scene, values);

  const std::uint64_t print = i.printOf(values, width, height);
  const bool moves = i.video || (!values.loading.empty() && now() - i.lastShow > kAlive);
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

/// Those of the run, with what this window knows.
void Window::Impl::listControls(const Scene& scene, const WindowValues& values) {
  runs = values.controls != nullptr;
  if (runs) {
    controls = *values.controls;
  } else {
    listChoices(choices, controls);
  }
  if (scene.particles.empty()) controls[ControlId::kGrains].whyNot = "there is no sand or water";
  if (video) controls[ControlId::kVideo].label = "stop the video";
  automatic = "auto (" + choiceNames<kQualities>()[choices.quality < 0 ? choice.level() : choices.quality] + ")";
  controls[ControlId::kQuality].none = automatic.c_str();
}

void Window::Impl::drawUnseen(const Scene& scene) {
  const double begin = now();
  renderer->setQuality(kRenderQualities[choices.quality < 0 ? choice.level() : choices.quality]);
  if (!eyes || !eyes(*renderer, scene, choices.show)) return;
  gl.Finish();
  chooseQuality(now() - begin);
  ++pictures;
}

void Window::Impl::draw(const Scene& scene, const WindowValues& values, int width, int height) {
  const double begin = now();
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
  const double drawing = now();
  renderer->setQuality(kRenderQualities[level]);
  const bool mirrors = eyes && eyes(*renderer, scene, choices.show);
  if (!mirrors || video) drawScene(scene, values, width, height);
  if (video) addToVideo(width, height);
  renderer->present(width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);

  WindowValues shown = values;
  shown.pictureMilliseconds = 1e3 * pictureSeconds;
  shown.picturesASecond = pictureRate;
  shown.videoSeconds = video ? begin - video->begin : -1.0;
  if (scene.inset != nullptr && scene.inset->width > 0) {
    shown.insetWidth = 0.25 * width;
    shown.insetHeight = shown.insetWidth * scene.inset->height / scene.inset->width;
  }
  if (begin < noticeUntil) shown.notice = noticeText;
  shown.problem = noticeIsProblem;
  if (typed) shown.typed = *typed;
  choices.scrubbing = false;  // only visible panels can set it
  panels->draw(takePanelInput(width, height), shown, times, controls, asked);
  if (choices.pictureWithPanels) savePicture(readWindow(gl, width, height));
  choices.pictureWithPanels = false;
  // The driver may defer its work, which would then be measured as waiting for the display.
  gl.Finish();
  const double seconds = now() - drawing;
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
