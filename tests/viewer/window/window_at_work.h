#pragma once

#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/virtual_display.h"
#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/pictures/image_files.h"
#include "viewer/window/window.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace lorica {

using test::differingPixels;
using test::VirtualDisplay;

struct Box {
  TriMesh mesh = test::makeBox({-0.3, 0.6, -0.3}, {0.3, 1.4, 0.3});
  std::vector<LivePart> parts = {test::boxPart({-0.5, 0.5, -0.5}, {0.5, 1.5, 0.5})};
  std::vector<Prop> props = std::vector<Prop>(1);
  std::vector<Contact> contacts = std::vector<Contact>(1);
  Scene scene;
  Box() {
    props[0].worldFromProp.translation() = Vec3(0.9, 0.6, 0.0);
    contacts[0].point = Vec3(-0.9, 1.0, 0.0);
    scene.vertices = mesh.vertices;
    scene.triangles = mesh.triangles;
    scene.parts = parts;
    scene.props = props;
    scene.contacts = contacts;
  }
};

/// A window with a box in it, on its own display; pictures are saved in its own folder.
class WindowAtWork : public ::testing::Test {
 protected:
  void open(int width, int height) {
    ASSERT_TRUE(display_->ready());
    Result<Window> opened = Window::create("Lorica test", width, height);
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    window.emplace(std::move(opened).value());
    window->setQuality(RenderQuality::kHigh);
    window->setCamera(test::frontCamera());
    values.name = "a box";
    values.duration = 10.0;
    values.controls = &controls;
    frames(2);
  }
  void SetUp() override {
    LORICA_REQUIRE_KEYS();
    display_.emplace();
    std::filesystem::current_path(folder_.path());
  }
  void TearDown() override {
    window.reset();
    std::filesystem::current_path(before_);
  }

  void frames(int n) {
    for (int i = 0; i < n; ++i) {
      listControls();
      window->show(box.scene, values);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  /// As a run of a recording of `values` has them.
  void listControls() {
    listChoices(window->choices(), controls);
    const bool recorded = values.duration > 0.0;
    for (const ControlId id : {ControlId::kThrow, ControlId::kUndo, ControlId::kOpen}) controls.offer(id);
    for (const ControlId id : {ControlId::kSpeed, ControlId::kRestart, ControlId::kSeek, ControlId::kLoop}) {
      controls[id].absent = !recorded;
    }
    controls[ControlId::kSeek].most = values.duration;
    Control& parts = controls.offer(ControlId::kParts);
    parts.least = 1.0;
    parts.most = 5.0;
    parts.value = 3.0;
    parts.absent = bare;
    for (const ControlId id : {ControlId::kMirror, ControlId::kSmoothing, ControlId::kGravity}) {
      controls[id].absent = bare;
    }
    controls.offer(ControlId::kRecent).choices = recent;
    controls[ControlId::kRecent].absent = recent.empty();
    controls.offer(ControlId::kExpression).choices = expressions;
    controls[ControlId::kExpression].least = -1.0;
    controls[ControlId::kExpression].absent = expressions.empty();
  }
  /// The change of a control since this was asked last; none if there is none.
  std::optional<Change> changeOf(ControlId id) {
    std::optional<Change> found;
    for (const Change& change : window->takeChanges()) {
      if (change.id == id) found = change;
    }
    return found;
  }
  void send(const std::string& what) {
    // The last request is answered after what was sent before has reached the window.
    const std::string command =
        "xdotool search --sync --name 'Lorica test' windowfocus --sync " + what + " getmouselocation > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    frames(3);
  }
  /// The picture that P or shift P saves.
  Image picture(const char* key = "p") {
    send(std::string("key ") + key);
    char name[32];
    std::snprintf(name, sizeof name, "lorica-%03d.png", ++pictures_);
    const Result<Image> read = readPng(name);
    EXPECT_TRUE(read.ok()) << read.error().message;
    return read.ok() ? read.value() : Image{};
  }

  Box box;
  WindowValues values;
  Controls controls;
  bool bare = false;                // without number of parts, mirror, smoothing and gravity
  std::vector<std::string> recent;  // files
  std::vector<std::string> expressions = {"happy"};
  std::optional<Window> window;

 private:
  std::optional<VirtualDisplay> display_;
  test::TemporaryFolder folder_;
  std::filesystem::path before_ = std::filesystem::current_path();
  int pictures_ = 0;
};

}  // namespace lorica
