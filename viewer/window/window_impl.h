#pragma once

#include "geometry/clock.h"
#include "viewer/pictures/video_writer.h"
#include "viewer/renderer/gl_functions.h"
#include "viewer/window/file_dialog.h"
#include "viewer/window/orbit_camera.h"
#include "viewer/window/panel_parts.h"
#include "viewer/window/quality_choice.h"
#include "viewer/window/time_graph.h"
#include "viewer/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// The contents of the window's framebuffer, including panels, before it is presented.
[[nodiscard]] Image readWindow(const GlFunctions& gl, int width, int height);

/// The video that a window writes: its contents, 30 times per second of real time.
struct WindowVideo {
  VideoWriter writer;
  std::string name;
  int width = 0, height = 0;  ///< of the window at the start [pixels]
  double begin = 0.0;         ///< start time [s]
  int frames = 0;
};

/// The state of a Window: window.cpp creates it and draws, window_input.cpp handles keys and mouse, window_files.cpp
/// writes pictures and videos.
struct Window::Impl {
  ~Impl();

  void listen();
  void onKey(int key, int mods, bool repeats);
  void onNamedKey(std::string_view key, bool repeats);
  void onControlKey(int key);
  void onCharacter(unsigned int code);
  void onCursor(double x, double y);
  void decideDrag(bool holdsProp);
  void onButton(int button, bool down);
  void noteClick(double x, double y);
  void onWheel(double y);
  /// Whether the mouse is over a panel or operates one.
  [[nodiscard]] bool overPanels() const;
  /// Mouse input for the panels; each press is reported at least once.
  [[nodiscard]] PanelInput takePanelInput(int width, int height);
  [[nodiscard]] Ray rayThrough(double x, double y) const;
  void onKeyOfPath(int key, int mods);
  void follow(const std::optional<Vec3>& focus);
  void frameFollowed(const WindowValues& values, double aspect);
  void lookFrom(double azimuth, double elevation);
  void takeOver();
  /// The camera as the picture is drawn.
  [[nodiscard]] Camera view() const;

  /// Another picture is due; a few more show panels that find their size.
  void touch() { picturesDue = kPanelPictures; }
  void listControls(const Scene& scene, const WindowValues& values);
  [[nodiscard]] std::uint64_t printOf(const WindowValues& values, int width, int height) const;
  void draw(const Scene& scene, const WindowValues& values, int width, int height);
  void drawUnseen(const Scene& scene);
  void drawScene(Scene scene, const WindowValues& values, int width, int height);
  void countPicture(double seconds);
  void chooseQuality(double seconds);
  void savePicture(const Image& image);
  void toggleVideo(int width, int height);
  void addToVideo(int width, int height);
  void endVideo();
  void setNotice(std::string sentence, double seconds = 3.0);

  GLFWwindow* window = nullptr;               ///< null = nobody sees it
  std::optional<OffscreenContext> offscreen;  ///< of what nobody sees
  std::function<void(const std::string&)> say;
  GlFunctions gl;
  std::optional<Renderer> renderer;
  std::optional<WindowPanels> panels;
  OrbitCamera camera;
  std::optional<Vec3> followed;  ///< the focus that the camera has moved with; none = it has not followed yet
  bool leftFocus = false;        ///< the user chose not to follow since then
  bool ownView = false;          ///< the user panned or zoomed since then
  bool clearView = false;        ///< see lookFrom()
  double fitted = 0.0;           ///< distance from the target at which the followed avatars are in view [m]
  double fittedAt = 0.0;         ///< WindowValues::seconds of that
  std::optional<Eigen::Vector2d> targetAt;  ///< see Camera; none = in the middle
  Eyes eyes;                                ///< null = none
  Asked asked;
  Choices& choices = asked.choices;
  Controls controls;      ///< as shown last
  bool runs = false;      ///< whether there is a session; not while the first one loads
  std::string automatic;  ///< what it calls the automatic quality
  double facing = 0.0;    ///< WindowValues::facing as shown last
  static constexpr int kPanelPictures = 4;
  int picturesDue = kPanelPictures;  ///< pictures to be drawn
  std::uint64_t print = 0;           ///< of what was shown last
  long long pictures = 0;
  FileDialog dialog;
  std::optional<std::string> typed;  ///< where there is no dialogue: the path so far; none = it is not asked for
  TimeGraph times;

  QualityChoice choice{3};
  double lastShow = 0.0;  ///< [s]
  /// Displayed statistics, updated twice per second for readability: time per picture [s], and pictures per second.
  double pictureSeconds = 0.0, pictureRate = 0.0;
  double countBegin = 0.0, countSeconds = 0.0;  ///< measurements for the next update [s]
  int count = 0;

  std::string noticeText;
  double noticeUntil = 0.0;  ///< [s]
  bool noticeIsProblem = false;
  double endAsked = -1e9;  ///< when Escape was pressed last in a live session [s]
  std::optional<WindowVideo> video;

  /// What a drag with a pressed button controls.
  enum class Drag : std::uint8_t {
    kNone,
    kPanel,
    kUndecided,  ///< until the next show() tells whether a prop is held
    kCamera,
    kProp,
    kPan
  };
  Drag drag = Drag::kNone;
  std::optional<std::array<double, 2>> undecidedEnd;  ///< where the button was released before that was decided
  double cursorX = 0.0, cursorY = 0.0;                ///< in window coordinates
  double heldX = 0.0, heldY = 0.0;                    ///< mouse position up to which the camera has followed
  double pressedX = 0.0, pressedY = 0.0;              ///< where the button was pressed
  std::array<bool, 2> down{}, pressedSince{};
  float wheel = 0.0f;
};

}  // namespace lorica
