#pragma once

#include "viewer/orbit_camera.h"
#include "viewer/quality_choice.h"
#include "viewer/time_graph.h"
#include "viewer/window.h"
#include "viewer/window_panels.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>

namespace lorica {

/// Seconds of a clock that never goes back, since the program's first call.
[[nodiscard]] double secondsNow();

/// What the window's framebuffer holds, panels included, before it is presented.
[[nodiscard]] Image readWindow(const GlFunctions& gl, int width, int height);

/// The video that a window writes: what it shows, 30 times a second of real time.
struct WindowVideo {
  VideoWriter writer;
  std::string name;
  int width = 0, height = 0;  ///< of the window when it began [pixels]
  double begin = 0.0;         ///< [s]
  int frames = 0;
};

/// What a Window keeps: window.cpp makes it and draws, window_input.cpp takes keys and mouse, window_files.cpp writes
/// pictures and videos.
struct Window::Impl {
  ~Impl();

  void listen();
  void onKey(int key, int mods);
  void onCharacter(unsigned int code);
  void onCursor(double x, double y);
  void decideDrag(bool holdsProp);
  void onButton(int button, bool down);
  void onWheel(double y);
  /// The mouse for the panels, which then see each press at least once.
  [[nodiscard]] PanelInput takePanelInput(int width, int height);
  [[nodiscard]] Ray rayThrough(double x, double y) const;
  void seekBy(double seconds);

  void drawScene(const Scene& scene, int width, int height);
  void countPicture(double seconds);
  void chooseQuality(double seconds);
  void savePicture(const Image& image);
  void toggleVideo(int width, int height);
  void addToVideo(int width, int height);
  void endVideo();
  void setNotice(std::string sentence);

  GLFWwindow* window = nullptr;
  GlFunctions gl;
  std::optional<Renderer> renderer;
  std::optional<WindowPanels> panels;
  OrbitCamera camera;
  ControlState state;
  WindowRequests requests;
  WindowValues lastValues;  ///< numbers only, its views are cut off
  TimeGraph times;

  QualityChoice choice{3};
  double lastShow = 0.0;  ///< [s]
  /// For people to read, so they change twice a second: of a picture [s], and pictures a second.
  double pictureSeconds = 0.0, pictureRate = 0.0;
  double countBegin = 0.0, countSeconds = 0.0;  ///< of what is counted for the next ones [s]
  int count = 0;

  std::string noticeText;
  double noticeUntil = 0.0;  ///< [s]
  std::optional<WindowVideo> video;

  /// Who the left button belongs to while it is down.
  enum class Drag : std::uint8_t {
    kNone,
    kPanel,
    kUndecided,  ///< until the next show() says whether a prop is held
    kCamera,
    kProp,
    kPan
  };
  Drag drag = Drag::kNone;
  std::optional<std::array<double, 2>> undecidedEnd;  ///< where the button came up before that was decided
  double cursorX = 0.0, cursorY = 0.0;                ///< in the window's coordinates
  double heldX = 0.0, heldY = 0.0;                    ///< where the camera has followed the mouse to
  std::array<bool, 2> down{}, pressedSince{};
  float wheel = 0.0f;
};

}  // namespace lorica
