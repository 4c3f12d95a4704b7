#include "viewer/window.h"

#include "viewer/orbit_camera.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace lorica {
namespace {

constexpr const char* kHelp =
    "left drag\torbit\n"
    "right drag\tpan\n"
    "wheel\tzoom\n"
    "space\tpause\n"
    "N\tsingle step\n"
    "1\tskin\n"
    "2\thulls\n"
    "3\tbones\n"
    "4\tprops\n"
    "5\tcontacts\n"
    "6\tground\n"
    "C\tcolours of the skin\n"
    "P\tsave a picture\n"
    "R\tcamera back to start\n"
    "H\thide this help\n"
    "Esc\tclose";
constexpr double kNoticeSeconds = 3.0;

std::string& lastGlfwError() {
  static std::string text;
  return text;
}

void* glfwProc(const char* name) {
  return reinterpret_cast<void*>(glfwGetProcAddress(name));
}

Error noDisplay(const std::string& why) {
  return {ErrorCode::kNoDisplay,
          fmt::format("no window can be opened ({}): run without --window, or on a desktop with DISPLAY set; "
                      "snapshots and videos need no display",
                      why)};
}

}  // namespace

struct Window::Impl {
  GLFWwindow* window = nullptr;
  std::optional<Renderer> renderer;
  OrbitCamera camera;
  SceneOptions options;
  bool paused = false;
  bool stepAsked = false;
  bool help = false;
  bool pictureAsked = false;
  std::string notice;
  std::chrono::steady_clock::time_point noticeUntil;
  double cursorX = 0.0;
  double cursorY = 0.0;

  ~Impl() {
    renderer.reset();  // its objects belong to the window's context
    if (window != nullptr) glfwDestroyWindow(window);
    glfwTerminate();
  }

  void onKey(int key);
  void onCursor(double x, double y);
  void savePicture();
};

void Window::Impl::onKey(int key) {
  const auto toggle = [](bool& flag) { flag = !flag; };
  switch (key) {
    case GLFW_KEY_SPACE:
      return toggle(paused);
    case GLFW_KEY_N:
      paused = true;
      stepAsked = true;
      return;
    case GLFW_KEY_1:
      return toggle(options.skin);
    case GLFW_KEY_2:
      return toggle(options.hulls);
    case GLFW_KEY_3:
      return toggle(options.bones);
    case GLFW_KEY_4:
      return toggle(options.props);
    case GLFW_KEY_5:
      return toggle(options.contacts);
    case GLFW_KEY_6:
      return toggle(options.ground);
    case GLFW_KEY_C:
      return toggle(options.colorSkinByPart);
    case GLFW_KEY_P:
      pictureAsked = true;
      return;
    case GLFW_KEY_R:
      return camera.reset();
    case GLFW_KEY_H:
      return toggle(help);
    case GLFW_KEY_ESCAPE:
      glfwSetWindowShouldClose(window, GLFW_TRUE);
      return;
    default:
      return;
  }
}

void Window::Impl::onCursor(double x, double y) {
  // Cursor and window size are both in screen coordinates, whatever the pixels behind them.
  int width = 1, height = 1;
  glfwGetWindowSize(window, &width, &height);
  const double dx = (x - cursorX) / std::max(height, 1);
  const double dy = (y - cursorY) / std::max(height, 1);
  cursorX = x;
  cursorY = y;
  if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
    camera.turn(-4.0 * dx, 4.0 * dy);
  } else if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS) {
    camera.pan(-dx, dy);
  }
}

/// To the first free name lorica-001.png, lorica-002.png ... in the working directory.
void Window::Impl::savePicture() {
  std::string name;
  for (int i = 1; i <= 999; ++i) {
    name = fmt::format("lorica-{:03}.png", i);
    std::error_code error;
    if (!std::filesystem::exists(name, error)) break;
  }
  const Result<void> written = writePng(name, renderer->readBack());
  notice = written.ok() ? "saved " + name : written.error().message;
  noticeUntil = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                       std::chrono::duration<double>(kNoticeSeconds));
}

Window::Window(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Window::~Window() = default;
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;

Result<Window> Window::create(const std::string& title, int width, int height) {
  if (width < 1 || height < 1 || width > 16384 || height > 16384) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("window of {} x {} pixels: expected 1 to 16384 each", width, height)};
  }
  if (!displayAvailable()) return noDisplay("neither DISPLAY nor WAYLAND_DISPLAY is set");
  lastGlfwError().clear();
  glfwSetErrorCallback([](int, const char* text) { lastGlfwError() = text; });
  if (!glfwInit()) return noDisplay(lastGlfwError().empty() ? "GLFW does not start" : lastGlfwError());

  auto impl = std::make_unique<Impl>();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);  // the renderer draws into framebuffers of its own
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  impl->window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (impl->window == nullptr) return noDisplay(lastGlfwError());
  glfwMakeContextCurrent(impl->window);
  glfwSwapInterval(1);
  Result<Renderer> renderer = Renderer::create(glfwProc);
  if (!renderer.ok()) return renderer.error();
  impl->renderer.emplace(std::move(renderer).value());

  glfwSetWindowUserPointer(impl->window, impl.get());
  static constexpr auto kOf = [](GLFWwindow* w) { return static_cast<Impl*>(glfwGetWindowUserPointer(w)); };
  glfwSetKeyCallback(impl->window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_PRESS || (action == GLFW_REPEAT && key == GLFW_KEY_N)) kOf(w)->onKey(key);
  });
  glfwSetCursorPosCallback(impl->window, [](GLFWwindow* w, double x, double y) { kOf(w)->onCursor(x, y); });
  glfwSetScrollCallback(impl->window, [](GLFWwindow* w, double, double y) { kOf(w)->camera.zoom(std::pow(0.9, y)); });
  glfwGetCursorPos(impl->window, &impl->cursorX, &impl->cursorY);
  return Window(std::move(impl));
}

bool Window::open() const {
  return !glfwWindowShouldClose(impl_->window);
}

bool Window::wantsStep() {
  const bool step = !impl_->paused || impl_->stepAsked;
  impl_->stepAsked = false;
  return step;
}

void Window::setOptions(const SceneOptions& options) {
  impl_->options = options;
}
void Window::setCamera(const Camera& camera) {
  impl_->camera = OrbitCamera(camera);
}

void Window::show(const Scene& scene, const std::string& caption) {
  Impl& i = *impl_;
  int width = 0, height = 0;
  glfwMakeContextCurrent(i.window);
  glfwGetFramebufferSize(i.window, &width, &height);
  if (width > 0 && height > 0) {  // minimised windows have no pixels
    const bool notice = !i.pictureAsked && std::chrono::steady_clock::now() < i.noticeUntil;
    i.options.caption = notice ? i.notice : caption;
    if (i.paused && !notice) i.options.caption += caption.empty() ? "paused" : "  -  paused";
    i.options.panel = i.help ? kHelp : "";
    i.renderer->draw(scene, i.options, i.camera.camera(), width, height);
    if (i.pictureAsked) i.savePicture();
    i.pictureAsked = false;
    i.renderer->present(width, height);
    glfwSwapBuffers(i.window);
  }
  glfwPollEvents();
}

bool displayAvailable() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return set("DISPLAY") || set("WAYLAND_DISPLAY");
}

}  // namespace lorica
