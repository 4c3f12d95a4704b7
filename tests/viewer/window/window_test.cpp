#include "tests/viewer/window/window_at_work.h"

#include <opencv2/videoio.hpp>

#include <fstream>
#include <functional>
#include <utility>

namespace lorica {
namespace {

TEST(Window, WithoutDisplayItSaysWhatToDo) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  EXPECT_FALSE(displayAvailable());
  const Result<Window> window = Window::create("test", 320, 240);
  ASSERT_FALSE(window.ok());
  EXPECT_EQ(window.error().code, ErrorCode::kNoDisplay);
  EXPECT_NE(window.error().message.find("without --window"), std::string::npos) << window.error().message;
}

TEST(Window, ADisplayThatIsNotThereIsAnErrorToo) {
  unsetenv("WAYLAND_DISPLAY");
  setenv("DISPLAY", ":54321", 1);
  EXPECT_TRUE(displayAvailable());
  const Result<Window> window = Window::create("test", 320, 240);
  unsetenv("DISPLAY");
  ASSERT_FALSE(window.ok());
  EXPECT_EQ(window.error().code, ErrorCode::kNoDisplay);
}

TEST(Window, ImpossibleSizesAreRefused) {
  EXPECT_EQ(Window::create("test", 0, 240).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(Window::create("test", 320, -1).error().code, ErrorCode::kInvalidArgument);
}

TEST(Window, OpensShowsFramesAndClosesBesideAnOffscreenContext) {
  if (!test::installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed (Debian package xvfb)";
  const VirtualDisplay display;
  ASSERT_TRUE(display.ready());
  const Box box;
  for (int turn = 0; turn < 2; ++turn) {  // a second window after the first one is destroyed
    Result<Window> window = Window::create("Lorica test", 320, 240);
    ASSERT_TRUE(window.ok()) << window.error().message;
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(window->open());
      EXPECT_TRUE(window->wantsStep());
      window->show(box.scene, WindowValues());
    }
  }
  LORICA_REQUIRE_STUDIO(studio, "");
  const Image image = studio->draw(box.scene, {}, test::frontCamera(), 64, 48);
  EXPECT_NE(test::pixelAt(image, 32, 24), test::pixelAt(image, 0, 0));
}

TEST_F(WindowAtWork, EachKeyShowsAndHidesItsThing) {
  open(320, 240);
  const Image all = picture();
  EXPECT_EQ(all.width, 320);
  // The position at which the object that the key toggles is visible.
  const std::pair<const char*, Vec3> things[] = {{"1", Vec3(0.0, 1.0, 0.3)},
                                                 {"2", Vec3(0.42, 1.0, 0.5)},
                                                 {"4", Vec3(0.9, 0.6, 0.1)},
                                                 {"5", Vec3(-0.9, 1.0, 0.0)},
                                                 {"6", Vec3(-0.7, 0.0, 0.5)}};
  for (const auto& [key, position] : things) {
    send(std::string("key ") + key);
    const Image without = picture();
    const auto [x, y] = test::seenAt(position, 320, 240);
    EXPECT_NE(test::pixelAt(all, static_cast<int>(x), static_cast<int>(y)),
              test::pixelAt(without, static_cast<int>(x), static_cast<int>(y)))
        << key;
    send(std::string("key ") + key);
  }
  EXPECT_EQ(picture().rgba, all.rgba) << "everything is shown again";
}

TEST_F(WindowAtWork, AnAvatarIsShownUntilItsPartsAreAskedFor) {
  test::AvatarMaker maker;
  Material material;
  material.shading = Shading::kUnlit;
  material.baseColor = {1.0f, 0.0f, 0.0f, 1.0f};
  maker.material(material);
  maker.addSphere({0, 1, 0}, 0.4, 24, 32);
  const test::AvatarOnStage stage(maker.avatar);
  box.scene.avatar = stage.avatar;
  box.scene.worldFromModel = stage.worldFromModel;
  open(320, 240);
  SceneOptions asDrawn;
  asDrawn.colorSkinByPart = asDrawn.hulls = false;
  window->choices().show = asDrawn;
  frames(2);
  const Image avatar = picture();
  const auto middle = [](const Image& image) { return test::pixelAt(image, 160, 120); };
  EXPECT_EQ(middle(avatar), (std::array{255, 0, 0}));
  send("key c");
  EXPECT_TRUE(window->choices().show.colorSkinByPart);
  const auto part = middle(picture());
  EXPECT_NE(part, middle(avatar)) << "the body by part";
  send("key c");
  EXPECT_EQ(picture().rgba, avatar.rgba);
  send("key 2");
  const auto through = middle(picture());
  EXPECT_NE(through, middle(avatar)) << "a hull over the avatar";
  EXPECT_GT(through[0], through[1] + 40) << "which shows through it";
  send("key 2 1");
  EXPECT_NE(middle(picture()), middle(avatar)) << "the character is hidden";
  send("key 1");
  EXPECT_EQ(picture().rgba, avatar.rgba);
}

TEST_F(WindowAtWork, DragsTurnTheCameraAndRTakesItBack) {
  open(320, 240);
  const Image before = picture();
  const Vec3 eye = window->camera().eye;
  send("mousemove --window %1 160 150 mousedown 1 mousemove --window %1 220 140");
  EXPECT_GT((window->camera().eye - eye).norm(), 0.5);
  send("mouseup 1");
  const Vec3 turned = window->camera().eye;
  send("mousemove --window %1 100 100");
  EXPECT_EQ(window->camera().eye, turned) << "the button is up";
  EXPECT_GT(differingPixels(before, picture(), 8), 500);
  send("mousemove --window %1 160 120 mousedown 3 mousemove --window %1 130 120 mouseup 3");
  EXPECT_GT((window->camera().target - test::frontCamera().target).norm(), 0.1);
  send("mousemove --window %1 160 150 click 4");
  EXPECT_LT((window->camera().eye - window->camera().target).norm(), 3.9) << "the wheel zooms in";
  send("key r");
  EXPECT_EQ(picture().rgba, before.rgba) << "the camera is reset";
}

TEST_F(WindowAtWork, AClickOnATitleFoldsAndUnfolds) {
  open(1000, 700);
  const Image open = picture("shift+p");
  send("mousemove --window %1 60 20 click 1");
  send("mousemove --window %1 500 400");
  const int folded = differingPixels(open, picture("shift+p"), 8);
  EXPECT_GT(folded, 20'000);
  send("mousemove --window %1 60 20 click 1");
  send("mousemove --window %1 500 400");
  EXPECT_LT(differingPixels(open, picture("shift+p"), 8), folded / 3) << "but for the graph of times";
}

TEST_F(WindowAtWork, WhatFailedIsMarkedUntilTheNextMessage) {
  open(1000, 700);
  const auto red = [&] {
    const Image image = picture("shift+p");
    int count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      const bool plate = image.rgba[i] == 255 && image.rgba[i + 1] == 0xe1 && image.rgba[i + 2] == 0xde;
      count += plate ? 1 : 0;
    }
    return count;
  };
  window->notice("walk.bvh: a note", 60.0);
  const int before = red();
  window->problem("walk.bvh, line 3: found nothing");
  EXPECT_GT(red(), before + 2000);
  window->notice("walk.bvh: a note", 60.0);
  EXPECT_EQ(red(), before);
}

TEST_F(WindowAtWork, FilesAreListedByNameWithTheirFoldersAsATooltip) {
  open(1000, 700);
  const std::vector<std::string> files{"/here/a.csv", "/a/very/long/folder/so/that/it/is/wide/b.csv"};
  recent = files;
  bare = true;
  expressions.clear();
  frames(2);
  send("mousemove --window %1 113 64 click 1");
  const Image list = picture("shift+p");
  send("mousemove --window %1 60 120");
  const Image tooltip = picture("shift+p");
  EXPECT_GT(differingPixels(list, tooltip, 8), 3'000);
  send("click 1 key b");
  EXPECT_EQ(changeOf(ControlId::kRecent)->to, 1.0);
}

TEST_F(WindowAtWork, EscapeClosesTheHelpBeforeTheWindow) {
  open(320, 240);
  send("key h");
  send("key Escape");
  EXPECT_TRUE(window->open());
  send("key Escape");
  EXPECT_FALSE(window->open());
}

TEST_F(WindowAtWork, EscapeAsksBeforeItEndsALiveSession) {
  open(320, 240);
  values.duration = 0.0;
  frames(1);
  send("key Escape");
  EXPECT_TRUE(window->open());
  for (int i = 0; i < 50 && window->open(); ++i) send("key Escape Escape");  // quick enough on a busy machine, too
  EXPECT_FALSE(window->open());
}

TEST_F(WindowAtWork, StepsInTimeAddUpWhileTheRecordingRunsThere) {
  open(320, 240);
  send("key Left");
  send("key Left Left");
  EXPECT_EQ(changeOf(ControlId::kSeek)->by, -3.0) << "from where it runs to";
  EXPECT_FALSE(changeOf(ControlId::kSeek).has_value());
}

TEST_F(WindowAtWork, SpacePausesAndNStepsAndEscapeCloses) {
  open(320, 240);
  EXPECT_TRUE(window->wantsStep());
  send("key space");
  EXPECT_FALSE(window->wantsStep()) << "paused";
  send("key n");
  EXPECT_TRUE(window->wantsStep()) << "one step";
  EXPECT_FALSE(window->wantsStep());
  send("key n n n");
  EXPECT_TRUE(window->wantsStep() && window->wantsStep() && window->wantsStep()) << "no press is lost";
  EXPECT_FALSE(window->wantsStep());
  send("key space");
  EXPECT_TRUE(window->wantsStep());
  EXPECT_TRUE(window->open());
  send("key Escape");
  EXPECT_FALSE(window->open());
}

TEST_F(WindowAtWork, KeysAskForWhatTheOwnerDoes) {
  open(320, 240);
  values.seconds = 4.0;
  frames(1);
  const std::pair<const char*, ControlId> keys[] = {
      {"b", ControlId::kThrow}, {"e", ControlId::kExpression}, {"u", ControlId::kUndo}, {"Home", ControlId::kRestart}};
  for (const auto& [key, id] : keys) {
    send(std::string("key ") + key);
    EXPECT_TRUE(changeOf(id).has_value()) << key;
    EXPECT_FALSE(changeOf(id).has_value()) << "once";
  }
  send("key bracketleft");
  EXPECT_EQ(changeOf(ControlId::kParts)->by, -1.0);
  send("key bracketright bracketright bracketright");
  EXPECT_EQ(changeOf(ControlId::kParts)->by, 3.0);
  send("key Right Right");
  EXPECT_EQ(changeOf(ControlId::kSeek)->by, 2.0);
  EXPECT_EQ(window->choices().speedFactor(), 1.0);
  send("key minus minus minus minus minus minus minus minus minus minus minus minus");
  EXPECT_EQ(window->choices().speedFactor(), 0.25);
  send("key plus");
  EXPECT_EQ(window->choices().speedFactor(), 0.5);
  values.duration = 0.0;  // live
  frames(1);
  send("key Left Home");
  EXPECT_FALSE(changeOf(ControlId::kSeek) || changeOf(ControlId::kRestart));
}

TEST_F(WindowAtWork, PanelsTakeTheMouseThatIsOverThem) {
  open(640, 480);
  const Vec3 eye = window->camera().eye;
  // The timeline: farther to the right is later, and the camera does not turn.
  send("mousemove --window %1 240 421 mousedown 1");
  const std::optional<double> left = changeOf(ControlId::kSeek).value_or(Change()).to;
  ASSERT_TRUE(left.has_value());
  EXPECT_FALSE(window->wantsStep()) << "playback is suspended while the slider is dragged";
  send("mousemove --window %1 290 421");
  const std::optional<double> right = changeOf(ControlId::kSeek).value_or(Change()).to;
  ASSERT_TRUE(right.has_value());
  EXPECT_GT(*left, 0.1);
  EXPECT_GT(*right, *left + 1.0);
  EXPECT_LT(*right, 10.0);
  send("mouseup 1");
  EXPECT_TRUE(window->wantsStep());
  EXPECT_EQ(window->camera().eye, eye);
  EXPECT_FALSE(changeOf(ControlId::kPress).has_value());
  send("mousemove --window %1 40 421 click 1");
  EXPECT_TRUE(window->choices().paused) << "the button";
  send("click 1");
  EXPECT_FALSE(window->choices().paused);
  send("mousemove --window %1 300 435 click 4");
  EXPECT_EQ(window->camera().eye, eye) << "the wheel over a panel";
  send("key Tab");
  send("mousemove --window %1 300 435 mousedown 1 mousemove --window %1 340 435 mouseup 1");
  EXPECT_NE(window->camera().eye, eye) << "the panels are hidden";
}

TEST_F(WindowAtWork, HelpAndPanelsAreShownButNotInPictures) {
  open(640, 480);
  const Image picture1 = picture();
  const Image panels = picture("shift+p");
  EXPECT_EQ(panels.width, 640);
  EXPECT_GT(differingPixels(picture1, panels, 24), 5000);
  EXPECT_EQ(test::pixelAt(panels, 320, 240), test::pixelAt(picture1, 320, 240)) << "the middle is free";
  send("key h");
  const Image help = picture("shift+p");
  EXPECT_GT(differingPixels(panels, help, 24), 20000);
  EXPECT_EQ(picture().rgba, picture1.rgba);
  send("key h Tab");
  EXPECT_EQ(test::pixelAt(picture("shift+p"), 30, 465), test::pixelAt(picture1, 30, 465)) << "no panel";
}

TEST_F(WindowAtWork, APictureWaitsForSomethingToSee) {
  open(320, 240);
  values.loading = "sand settles";
  send("key p");
  EXPECT_TRUE(std::filesystem::exists("lorica-001.png")) << "the session goes on";
  const Scene whole = std::exchange(box.scene, Scene());
  send("key p");
  EXPECT_FALSE(std::filesystem::exists("lorica-002.png"));
  box.scene = whole;
  frames(1);
  EXPECT_TRUE(std::filesystem::exists("lorica-002.png"));
}

TEST_F(WindowAtWork, WarningsAreWords) {
  open(640, 480);
  const Image calm = picture("shift+p");
  const std::vector<std::string> warnings = {"left hand lost"};
  values.warnings = warnings;
  // Notices of saved pictures appear below the warning, so only the rows of the warning are compared.
  const Image warned = picture("shift+p");
  int amber = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 200; x < 440; ++x) {
      const auto [r, g, b] = test::pixelAt(warned, x, y);
      amber += r == 0xff && g == 0xf3 && b == 0xd6 ? 1 : 0;
    }
  }
  EXPECT_GT(amber, 1000);
  EXPECT_GT(differingPixels(calm, warned, 24), 500);
  send("key Tab");
  window->notice("");
  const Image hidden = picture("shift+p");
  EXPECT_EQ(differingPixels(hidden, picture(), 8), 0) << "for a stream there is the picture alone";
}

TEST_F(WindowAtWork, APressOnThePictureOffersTheRayAndAHeldThingKeepsTheCamera) {
  open(640, 480);
  const auto [x, y] = test::seenAt(Vec3(0.6, 1.2, 0.2), 640, 480);
  const std::string position = std::to_string(std::lround(x)) + " " + std::to_string(std::lround(y));
  const Vec3 eye = window->camera().eye;
  values.holds = 1;
  send("mousemove --window %1 " + position + " mousedown 1");
  const std::optional<Change> pressed = changeOf(ControlId::kPress);
  ASSERT_TRUE(pressed.has_value());
  const Vec3 to = (Vec3(0.6, 1.2, 0.2) - eye).normalized();
  EXPECT_LT((pressed->ray.direction - to).norm(), 0.003) << "a pixel is 0.0013";
  EXPECT_LT((pressed->ray.origin - eye).norm(), 1e-9);
  send("mousemove --window %1 200 200");
  EXPECT_EQ(window->camera().eye, eye);
  EXPECT_GT((window->aim(0).ray.direction - to).norm(), 0.1);
  EXPECT_FALSE(changeOf(ControlId::kRelease).has_value());
  send("mouseup 1");
  EXPECT_TRUE(changeOf(ControlId::kRelease).has_value());
  values.holds = 0;
  send("mousedown 1 mousemove --window %1 260 200 mouseup 1");
  EXPECT_NE(window->camera().eye, eye) << "no prop is held: the camera turns";
}

TEST_F(WindowAtWork, TinyHiddenAndResizedWindowsGoOn) {
  open(300, 200);
  EXPECT_EQ(picture("shift+p").height, 200);
  send("key h");
  send("windowsize --sync %1 90 60");
  send("windowsize --sync %1 700 500");
  EXPECT_EQ(picture().width, 700);
  EXPECT_EQ(picture("shift+p").height, 500);
  send("windowunmap --sync %1");
  frames(3);
  ASSERT_EQ(std::system("xdotool search --name 'Lorica test' windowmap --sync %1 > /dev/null 2>&1"), 0);
  frames(3);
  EXPECT_EQ(picture().width, 700);
  EXPECT_TRUE(window->open());
}

TEST_F(WindowAtWork, PanelsFoldWhereTheWindowBecomesSmallAndOpenAgain) {
  open(1000, 600);
  const auto turnsAt = [&](const char* position) {
    const Vec3 eye = window->camera().eye;
    send(std::string("mousemove --window %1 ") + position + " mousedown 1 mousemove_relative 15 0 mouseup 1");
    return window->camera().eye != eye;
  };
  EXPECT_FALSE(turnsAt("60 80")) << "the panel";
  send("windowsize --sync %1 640 480");
  EXPECT_TRUE(turnsAt("60 80"));
  send("windowsize --sync %1 1000 600");
  EXPECT_FALSE(turnsAt("60 80"));
  send("mousemove --window %1 20 20 click 1");  // collapsed by the user
  EXPECT_TRUE(turnsAt("60 80"));
  send("windowsize --sync %1 640 480");
  send("windowsize --sync %1 1000 600");
  EXPECT_TRUE(turnsAt("60 80")) << "as it was left";
}

TEST_F(WindowAtWork, APictureIsDrawnOnlyWhenSomethingChanges) {
  open(320, 240);
  const auto drawnBy = [&](const std::function<void()>& change) {
    send("");  // whatever happened before has reached the window
    frames(20);
    const long long before = window->pictures();
    change();
    frames(20);
    return window->pictures() - before;
  };
  EXPECT_EQ(drawnBy([] {}), 0) << "nothing moves";
  std::vector<std::string> warnings;
  for (const std::function<void()>& change : std::vector<std::function<void()>>{
           [&] { ++values.changes; }, [&] { values.seconds += 0.1; }, [&] { values.status = "another"; },
           [&] {
             warnings.emplace_back("left hand lost");
             values.warnings = warnings;
           },
           [&] { window->notice("saved", 1e6); }, [&] { send("key 2"); }, [&] { send("windowsize --sync %1 330 250"); },
           [&] { send("mousemove --window %1 160 120 mousedown 1 mousemove --window %1 170 120 mouseup 1"); }}) {
    const long long drawn = drawnBy(change);
    EXPECT_GT(drawn, 0);
    EXPECT_LT(drawn, 20) << "and then no more";
  }
  EXPECT_EQ(drawnBy([] {}), 0);
  values.loading = "a body";
  EXPECT_GT(drawnBy([] {}), 0) << "the bar moves";
}

TEST_F(WindowAtWork, APathCanBeTypedWhereThereIsNoDialogue) {
  const std::string path = getenv("PATH");
  open(640, 480);
  setenv("PATH", "/nowhere", 1);
  window->chooseFiles();
  setenv("PATH", path.c_str(), 1);
  send("key slash a B BackSpace b period g l b");
  EXPECT_TRUE(window->choices().show.skin);
  EXPECT_TRUE(window->takeChanges().empty()) << "keys are letters";
  send("key Return b");
  EXPECT_FALSE(window->takeCancel());
  const std::optional<Change> typed = changeOf(ControlId::kOpen);
  ASSERT_TRUE(typed.has_value()) << "files can be opened later";
  EXPECT_EQ(typed->files, std::vector<std::string>{"/ab.glb"});
  send("key b");
  EXPECT_TRUE(changeOf(ControlId::kThrow).has_value()) << "keys again";
}

TEST_F(WindowAtWork, TheDialogueOfTheDesktopGivesFiles) {
  const std::filesystem::path tool = std::filesystem::current_path() / "zenity";
  std::ofstream(tool) << "#!/bin/sh\nprintf '/a b.glb\\n/c.bvh\\n'\n";
  std::filesystem::permissions(tool, std::filesystem::perms::owner_all);
  const std::string path = getenv("PATH");
  open(320, 240);
  setenv("PATH", (tool.parent_path().string() + ":" + path).c_str(), 1);
  window->chooseFiles();
  setenv("PATH", path.c_str(), 1);
  std::vector<std::string> files;
  const auto giveUp = std::chrono::steady_clock::now() + std::chrono::seconds(60);  // it never takes so long
  while (files.empty() && std::chrono::steady_clock::now() < giveUp) {
    frames(1);
    files = changeOf(ControlId::kOpen).value_or(Change()).files;
  }
  EXPECT_EQ(files, (std::vector<std::string>{"/a b.glb", "/c.bvh"}));
}

TEST_F(WindowAtWork, HelpStaysInThePictureAndBelowWarnings) {
  open(480, 360);
  const std::vector<std::string> warnings = {"left hand lost"};
  values.warnings = warnings;
  const Image warned = picture("shift+p");
  send("key h");
  const Image helped = picture("shift+p");
  // The help does not cover the warning: the column at x = 240 is unchanged in the rows of the warning and above.
  for (int y = 0; y < 60; ++y) EXPECT_EQ(test::pixelAt(warned, 240, y), test::pixelAt(helped, 240, y)) << y;
  EXPECT_NE(test::pixelAt(warned, 240, 180), test::pixelAt(helped, 240, 180));
  EXPECT_EQ(test::pixelAt(warned, 240, 355), test::pixelAt(helped, 240, 355)) << "a margin below";
}

TEST_F(WindowAtWork, VStartsAndEndsAVideoThatPlays) {
  open(321, 240);  // odd width, which no encoder accepts
  send("key v");
  for (int i = 0; i < 12; ++i) {
    frames(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  send("key v");
  ASSERT_TRUE(std::filesystem::exists("lorica-001.mp4"));
  cv::VideoCapture video("lorica-001.mp4", cv::CAP_FFMPEG);
  ASSERT_TRUE(video.isOpened());
  EXPECT_EQ(video.get(cv::CAP_PROP_FRAME_WIDTH), 320);
  EXPECT_EQ(video.get(cv::CAP_PROP_FPS), 30);
  int count = 0;
  cv::Mat frame;
  while (video.read(frame)) {
    ++count;
    EXPECT_NE(frame.at<cv::Vec3b>(120, 160), frame.at<cv::Vec3b>(2, 2)) << "the box and the sky";
  }
  EXPECT_GE(count, 8) << "at least the 0.3 s of waiting";
  // A change of size also ends a video.
  send("key v");
  send("windowsize --sync %1 400 300");
  EXPECT_TRUE(std::filesystem::exists("lorica-002.mp4"));
}

}  // namespace
}  // namespace lorica
