#include "viewer/window/window_impl.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

constexpr double kPresetElevation = 0.1;  // of the views from the front, the side and the back [rad]
constexpr double kScaleStep = 1.25;       // of text
constexpr double kClickReach = 4.0;       // a press that moves no farther is a click [screen coordinates]
constexpr double kFilled = 0.92;          // of what panels leave free, by the followed avatars
constexpr double kNearerSeconds = 3.0;    // in which the camera comes back most of the way [s]
constexpr double kLongestFrame = 0.5;     // of a session that runs; longer is a jump [s]
constexpr double kTurnPerHeight = 4.0;    // camera rotation for a drag over the window's height [rad]

void appendUtf8(unsigned int code, std::string& text) {
  if (code < 0x80) {
    text += static_cast<char>(code);
    return;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  constexpr std::array<unsigned int, 3> kFirst = {0xc0, 0xe0, 0xf0};
  text += static_cast<char>(kFirst[more - 1] | code >> 6 * more);
  for (int i = more - 1; i >= 0; --i) text += static_cast<char>(0x80 | (code >> 6 * i & 0x3f));
}

/// A key as the list of controls names it. @param letter  its storage @return empty if it has no name there
std::string_view nameOf(int key, char& letter) {
  for (const auto& [code, name] :
       {std::pair(GLFW_KEY_SPACE, "space"), std::pair(GLFW_KEY_TAB, "tab"), std::pair(GLFW_KEY_HOME, "home"),
        std::pair(GLFW_KEY_LEFT, "left"), std::pair(GLFW_KEY_RIGHT, "right"), std::pair(GLFW_KEY_F1, "H")}) {
    if (key == code) return name;
  }
  letter = static_cast<char>(key);
  const bool named = (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) || (key >= GLFW_KEY_0 && key <= GLFW_KEY_9);
  return named ? std::string_view(&letter, 1) : std::string_view();
}

}  // namespace

void Window::Impl::listen() {
  glfwSetWindowUserPointer(window, this);
  static constexpr auto kOf = [](GLFWwindow* w) { return static_cast<Impl*>(glfwGetWindowUserPointer(w)); };
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
    kOf(w)->touch();
    if (action != GLFW_RELEASE) kOf(w)->onKey(key, mods, action == GLFW_REPEAT);
  });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned int code) {
    kOf(w)->touch();
    kOf(w)->onCharacter(code);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    if (kOf(w)->choices.panels || kOf(w)->choices.help) kOf(w)->touch();
    kOf(w)->onCursor(x, y);
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) {
    kOf(w)->touch();
    kOf(w)->onButton(button, action == GLFW_PRESS);
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) {
    kOf(w)->touch();
    kOf(w)->onWheel(y);
  });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { kOf(w)->touch(); });
  glfwSetDropCallback(window, [](GLFWwindow* w, int fileCount, const char** files) {
    kOf(w)->touch();
    kOf(w)->asked.ask({.id = ControlId::kOpen, .files = {files, files + fileCount}});
  });
  glfwGetCursorPos(window, &cursorX, &cursorY);
}

/// Does what the list of controls has under a key.
void Window::Impl::onNamedKey(std::string_view key, bool repeats) {
  for (const Control& control : controls) {
    const bool able = control.isOn(on_screen::kWindow) && control.kind != ControlKind::kOther && !control.absent;
    const double by = control.key() == key ? 1.0 : control.back() == key ? -1.0 : 0.0;
    if (!able || by == 0.0 || (repeats && !control.isOn(on_screen::kRepeats))) continue;
    asked.ask({.id = control.id, .by = by});
  }
}

/// Larger and smaller text.
void Window::Impl::onControlKey(int key) {
  double& scale = choices.scale;
  if (key == GLFW_KEY_EQUAL || key == GLFW_KEY_KP_ADD) scale = std::min(scale * kScaleStep, kLargestScale);
  if (key == GLFW_KEY_MINUS || key == GLFW_KEY_KP_SUBTRACT) scale = std::max(scale / kScaleStep, kSmallestScale);
  if (key == GLFW_KEY_0) scale = 1.0;
}

/// While a path is typed.
void Window::Impl::onKeyOfPath(int key, int mods) {
  if (key == GLFW_KEY_V && (mods & GLFW_MOD_CONTROL) != 0) {
    const char* copied = glfwGetClipboardString(window);
    typed->append(copied == nullptr ? "" : copied);
  }
  if (key == GLFW_KEY_BACKSPACE && !typed->empty()) {
    while (typed->size() > 1 && (typed->back() & 0xc0) == 0x80) typed->pop_back();  // the rest of a character
    typed->pop_back();
  }
  const bool given = (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) && !typed->empty();
  if (given) asked.ask({.id = ControlId::kOpen, .files = {*typed}});
  if (given || key == GLFW_KEY_ESCAPE) typed.reset();
}

void Window::Impl::onKey(int key, int mods, bool repeats) {
  if (typed || (mods & GLFW_MOD_CONTROL) != 0) {
    if (repeats) return;
    return typed ? onKeyOfPath(key, mods) : onControlKey(key);
  }
  if (key == GLFW_KEY_P && (mods & GLFW_MOD_SHIFT) != 0) {
    choices.pictureWithPanels = true;
    return;
  }
  char letter = 0;
  if (const std::string_view name = nameOf(key, letter); !name.empty()) onNamedKey(name, repeats);
  if (repeats) return;
  if (key == GLFW_KEY_R) {
    ownView = clearView = false;
    fitted = 0.0;
    camera.reset();
  }
  if (key == GLFW_KEY_F2) lookFrom(0.0, kPresetElevation);
  if (key == GLFW_KEY_F3) lookFrom(0.5 * std::numbers::pi, kPresetElevation);
  if (key == GLFW_KEY_F4) lookFrom(std::numbers::pi, kPresetElevation);
  if (key == GLFW_KEY_F5) lookFrom(0.0, 0.5 * std::numbers::pi);
  if (key != GLFW_KEY_ESCAPE || panels->closeList() || dialog.isOpen()) return;
  if (choices.help) return asked.ask({.id = ControlId::kHelp});
  const bool live = runs && controls[ControlId::kSeek].absent;
  if (live && now() > std::exchange(endAsked, now()) + kNoticeSeconds) {
    return setNotice("Escape once more ends the session", kNoticeSeconds);
  }
  glfwSetWindowShouldClose(window, GLFW_TRUE);
}

/// The camera looks at the focus and moves with it, as long as the user wants it.
void Window::Impl::follow(const std::optional<Vec3>& focus) {
  if (!choices.follow) {
    leftFocus = true;
    return;
  }
  if (!focus) return;
  camera.carry(*focus - followed.value_or(camera.camera().target));
  if (leftFocus) {
    camera.aimAt(*focus);
    ownView = false;
  }
  followed = focus;
  leftFocus = false;
}

/// The target comes to the middle of what the panels leave free, and the camera goes back as far as the followed
/// avatars need to be seen there. It comes near again slowly as the session goes on, and at once after a jump in time:
/// a picture depends on what is shown, not on when it was drawn.
void Window::Impl::frameFollowed(const WindowValues& values, double aspect) {
  if (!values.followed) return;
  PictureArea area = panels->freeArea();
  targetAt = area.middle;
  const double seconds = values.seconds - std::exchange(fittedAt, values.seconds);
  if (!choices.follow || ownView) return;
  area.half *= kFilled;
  const double needed = distanceToSee(cornersOf(*values.followed), camera.camera(), area, aspect);
  const bool jumped = seconds < 0.0 || seconds > kLongestFrame;
  const double kept = jumped ? 0.0 : std::exp(-seconds / kNearerSeconds);
  fitted = std::max(needed, needed + kept * (fitted - needed));
}

/// Looks at the avatar from a side of it; nothing hides it until the user turns the camera.
void Window::Impl::lookFrom(double azimuth, double elevation) {
  camera.lookFrom(facing + azimuth, elevation);
  clearView = true;
}

/// The user pans or zooms: from what is seen, and from now on without being interfered with.
void Window::Impl::takeOver() {
  const Camera now = camera.camera();
  camera.zoom(std::max(fitted / (now.eye - now.target).norm(), 1.0));
  fitted = 0.0;
  ownView = true;
}

Camera Window::Impl::view() const {
  Camera view = camera.camera();
  const Vec3 back = view.eye - view.target;
  if (fitted > back.norm()) view.eye = view.target + fitted * back.normalized();
  if (targetAt) view.targetAt = *targetAt;
  return view;
}

/// Punctuation keys are handled as typed characters, because keyboard layouts differ.
void Window::Impl::onCharacter(unsigned int code) {
  if (typed) {
    appendUtf8(code, *typed);
    return;
  }
  const char key = code == '=' ? '+' : static_cast<char>(code);
  if (code < 0x80 && std::string_view("[]+-").find(key) != std::string_view::npos) onNamedKey({&key, 1}, false);
}

bool Window::Impl::overPanels() const {
  int width = 1, height = 1, pixelWidth = 1, pixelHeight = 1;
  glfwGetWindowSize(window, &width, &height);
  glfwGetFramebufferSize(window, &pixelWidth, &pixelHeight);
  return panels->busy() ||
         panels->covers(cursorX * pixelWidth / std::max(width, 1), cursorY * pixelHeight / std::max(height, 1));
}

void Window::Impl::onButton(int button, bool pressed) {
  if (button != GLFW_MOUSE_BUTTON_LEFT && button != GLFW_MOUSE_BUTTON_RIGHT) return;
  const bool left = button == GLFW_MOUSE_BUTTON_LEFT;
  const std::size_t index = left ? 0 : 1;
  down[index] = pressed;
  pressedSince[index] = pressedSince[index] || pressed;
  if (!pressed) {
    const bool ends = left ? drag != Drag::kPan : drag == Drag::kPan;
    if (!ends) return;
    if (drag == Drag::kUndecided) {
      asked.ask({.id = ControlId::kRelease});
      undecidedEnd = {cursorX, cursorY};
      return;
    }
    if (drag == Drag::kProp) asked.ask({.id = ControlId::kRelease});
    if (drag == Drag::kCamera) noteClick(cursorX, cursorY);
    drag = Drag::kNone;
    return;
  }
  if (drag != Drag::kNone) return;
  heldX = pressedX = cursorX;
  heldY = pressedY = cursorY;
  if (overPanels()) {
    drag = Drag::kPanel;
  } else if (left) {
    drag = Drag::kUndecided;
    asked.ask({.id = ControlId::kPress, .ray = rayThrough(cursorX, cursorY)});
  } else {
    drag = Drag::kPan;
  }
}

void Window::Impl::noteClick(double x, double y) {
  if (std::hypot(x - pressedX, y - pressedY) > kClickReach) return;
  asked.ask({.id = ControlId::kClick, .ray = rayThrough(x, y)});
}

/// Called when the owner has handled the press: the mouse moves the held prop, or otherwise the camera, starting from
/// where the button was pressed.
void Window::Impl::decideDrag(bool holdsProp) {
  if (drag != Drag::kUndecided) return;
  drag = holdsProp ? Drag::kProp : Drag::kCamera;
  const std::array<double, 2> now = {cursorX, cursorY};
  const std::array<double, 2> end = undecidedEnd.value_or(now);
  onCursor(end[0], end[1]);
  if (undecidedEnd) {  // already released
    if (drag == Drag::kCamera) noteClick(end[0], end[1]);
    drag = Drag::kNone;
  }
  undecidedEnd.reset();
  onCursor(now[0], now[1]);
}

void Window::Impl::onCursor(double x, double y) {
  cursorX = x;
  cursorY = y;
  if (drag != Drag::kCamera && drag != Drag::kPan) return;
  // Cursor and window size are both in screen coordinates, which may differ from pixels.
  int width = 1, height = 1;
  glfwGetWindowSize(window, &width, &height);
  const double dx = (x - heldX) / std::max(height, 1);
  const double dy = (y - heldY) / std::max(height, 1);
  heldX = x;
  heldY = y;
  if (drag == Drag::kCamera) {
    camera.turn(-kTurnPerHeight * dx, kTurnPerHeight * dy);
    clearView = clearView && dx == 0.0 && dy == 0.0;
  } else {
    takeOver();
    camera.pan(-dx, dy);
  }
}

void Window::Impl::onWheel(double y) {
  if (overPanels()) {
    wheel += y;
  } else {
    takeOver();
    camera.zoom(std::pow(0.9, y));
  }
}

PanelInput Window::Impl::takePanelInput(int width, int height) {
  PanelInput input;
  int windowWidth = 1, windowHeight = 1;
  glfwGetWindowSize(window, &windowWidth, &windowHeight);
  float scaleX = 1.0f, scaleY = 1.0f;
  glfwGetWindowContentScale(window, &scaleX, &scaleY);
  input.width = width;
  input.height = height;
  input.scale = std::max(scaleX, scaleY) * choices.scale;
  input.x = cursorX * width / std::max(windowWidth, 1);
  input.y = cursorY * height / std::max(windowHeight, 1);
  // A button that was pressed over the scene is not down for the panels.
  const bool theirs = drag == Drag::kPanel || drag == Drag::kNone;
  for (std::size_t b = 0; b < down.size(); ++b) input.down[b] = theirs && (down[b] || pressedSince[b]);
  pressedSince = {};
  input.wheel = std::exchange(wheel, 0.0f);
  input.seconds = now() - std::exchange(lastShow, now());
  return input;
}

/// The inverse of the renderer's camera projection.
Ray Window::Impl::rayThrough(double x, double y) const {
  int width = 1, height = 1;
  glfwGetWindowSize(window, &width, &height);
  const Camera now = view();
  const auto [forward, right, up] = axesOf(now);
  const double half = std::tan(0.5 * now.verticalFov);
  const double across = (2.0 * x / std::max(width, 1) - 1.0 - now.targetAt.x()) * half * width / std::max(height, 1);
  const double upward = (1.0 - 2.0 * y / std::max(height, 1) - now.targetAt.y()) * half;
  return {now.eye, (forward + across * right + upward * up).normalized()};
}

}  // namespace lorica
