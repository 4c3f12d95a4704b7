#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "geometry/counts.h"
#include "tests/capture/files/joint_files.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <functional>
#include <random>
#include <string>
#include <vector>

/// MediaPipe's landmarks as programs write them.
namespace lorica {
namespace {

using J = BodyJoint;
using nlohmann::json;
using test::kLandmarks;
using test::landmarkOf;

std::vector<SkeletonFrame> wave() {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  frames.resize(40);
  return frames;
}

json pointOf(const Vec3& p) {
  return {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}, {"visibility", 0.97}, {"presence", 0.99}};
}

json landmarksOf(const SkeletonFrame& frame) {
  json list = json::array();
  for (int i = 0; i < countOf(kLandmarks); ++i) list.push_back(pointOf(landmarkOf(frame, i)));
  return list;
}

/// The same in fractions of a picture, which must not be preferred.
json imageOf(const SkeletonFrame& frame) {
  json list = json::array();
  for (int i = 0; i < countOf(kLandmarks); ++i) {
    const Vec3 p = landmarkOf(frame, i);
    list.push_back(pointOf(Vec3(0.5 + 0.2 * p.x(), 0.5 + 0.35 * p.y(), 0.2 * p.z())));
  }
  return list;
}

json arraysOf(const SkeletonFrame& frame) {
  json list = json::array();
  for (int i = 0; i < countOf(kLandmarks); ++i) {
    const Vec3 p = landmarkOf(frame, i);
    list.push_back({p.x(), p.y(), p.z(), 0.97});
  }
  return list;
}

/// So many points that are no body: a hand's 21, a face's 478.
json otherPoints(int count) {
  json list = json::array();
  for (int i = 0; i < count; ++i) list.push_back(pointOf(Vec3(0.1 + 0.001 * i, 0.3, 0.0)));
  return list;
}

/// All frames as a list of what a program writes of each.
json listOf(const std::vector<SkeletonFrame>& frames, const std::function<json(const SkeletonFrame&, int)>& write) {
  json list = json::array();
  for (int f = 0; f < countOf(frames); ++f) list.push_back(write(frames[f], f));
  return list;
}

struct Program {
  std::function<json(const std::vector<SkeletonFrame>&)> write;
  double rate = 30.0;  ///< of the truth's frames, as the file has them [1/s]
};

void expectPerformance(const JointStream& stream, const std::vector<SkeletonFrame>& truth, double rate) {
  ASSERT_EQ(stream.frames.size(), truth.size());
  for (std::size_t f = 0; f < truth.size(); ++f) {
    const SkeletonFrame& read = stream.frames[f];
    EXPECT_NEAR(read.time, static_cast<double>(f) / rate, 1e-3);
    const Vec3 moved = read[J::kRightHip].position - truth[f][J::kRightHip].position;
    for (int j = 0; j < kBodyJointCount; ++j) {
      const auto joint = static_cast<J>(j);
      EXPECT_EQ(read[joint].confidence, 1.0);
      if (joint == J::kNeck || joint == J::kTorso) continue;  // between shoulders and hips, which is not their place
      EXPECT_LT((read[joint].position - truth[f][joint].position - moved).norm(), 1e-5) << f << " " << j;
    }
  }
}

TEST(MediaPipeJson, GivesThePerformanceHoweverItIsWritten) {
  const std::vector<SkeletonFrame> truth = wave();
  const std::vector<Program> programs = {
      // Frames with numbers, landmarks as objects.
      {[](const auto& frames) {
        return json{
            {"fps", 30.0}, {"width", 1280}, {"frames", listOf(frames, [](const SkeletonFrame& frame, int f) -> json {
                                               return {{"frame_index", f}, {"landmarks", landmarksOf(frame)}};
                                             })}};
      }},
      // A list of frames, people in lists, of the picture and of the world.
      {[](const auto& frames) {
         return listOf(frames, [](const SkeletonFrame& frame, int f) -> json {
           return {{"timestamp_ms", 1000.0 + 40.0 * f},
                   {"inference_time_ms", 7.5},
                   {"pose_landmarks", json::array({imageOf(frame)})},
                   {"pose_world_landmarks", json::array({landmarksOf(frame)})}};
         });
       },
       25.0},
      // As JavaScript calls them, with hands and a face, below another member.
      {[](const auto& frames) {
         const json list = listOf(frames, [](const SkeletonFrame& frame, int f) -> json {
           return {{"time", f / 20.0},
                   {"faceLandmarks", otherPoints(478)},
                   {"leftHandLandmarks", otherPoints(21)},
                   {"poseLandmarks", imageOf(frame)},
                   {"poseWorldLandmarks", arraysOf(frame)}};
         });
         return json{{"session", {{"name", "a take"}, {"results", list}}}, {"timestamps", {1, 2, 3}}};
       },
       20.0},
      // Nothing but numbers.
      {[](const auto& frames) {
        return listOf(frames, [](const SkeletonFrame& frame, int) { return arraysOf(frame); });
      }},
      // An object of frames, in the order of the text: "frame_10" before "frame_9".
      {[](const auto& frames) {
         json all;
         for (int f = 0; f < countOf(frames); ++f)
           all[fmt::format("frame_{}", f)] = {{"keypoints", arraysOf(frames[f])}};
         return json{{"video", {{"file", "a.mp4"}, {"frame_rate", 50}}}, {"frames", all}};
       },
       50.0},
      // Joints by their names, as members or in points of any order; times of day.
      {[](const auto& frames) {
         return listOf(frames, [](const SkeletonFrame& frame, int f) -> json {
           json joints;
           for (int i = 0; i < countOf(kLandmarks); ++i) {
             joints[fmt::format("PoseLandmark.{}", kLandmarks[i])] = pointOf(landmarkOf(frame, i));
           }
           return {{"timestamp", fmt::format("2024-05-01T12:30:{:06.3f}Z", f / 10.0)}, {"landmarks", joints}};
         });
       },
       10.0},
      {[](const auto& frames) {
         return json{{"poses", listOf(frames, [](const SkeletonFrame& frame, int f) -> json {
                        json list = json::array();
                        for (int i = countOf(kLandmarks); i-- > 0;) {
                          if (kLandmarks[i].find("mouth") != std::string_view::npos) continue;
                          list.push_back(pointOf(landmarkOf(frame, i)));
                          list.back()["name"] = kLandmarks[i];
                        }
                        const json person = {{"id", 3}, {"keypoints3D", list}};
                        return {{"t", f / 60.0}, {"id", 100 + f}, {"people", json::array({person})}};
                      })}};
       },
       60.0},
      // By their numbers.
      {[](const auto& frames) {
         return json{{"metadata", {{"fps", 24}}},
                     {"data", listOf(frames, [](const SkeletonFrame& frame, int f) -> json {
                        json joints;
                        for (int i = 0; i < countOf(kLandmarks); ++i) {
                          joints[std::to_string(i)] = pointOf(landmarkOf(frame, i));
                        }
                        return {{"frame", 7 + f}, {"landmark", joints}};
                      })}};
       },
       24.0}};
  for (const Program& program : programs) {
    const json file = program.write(truth);
    SCOPED_TRACE(file.dump().substr(0, 90));
    for (const int indent : {-1, 2}) {
      const JointStream stream = test::valueOf(parseJointStream(file.dump(indent), "wave.json"));
      EXPECT_EQ(stream.format, JointFormat::kMediaPipeJson);
      EXPECT_TRUE(stream.firstGuess.at(0).starts_with("metres, since the body measures")) << stream.firstGuess.at(0);
      EXPECT_TRUE(stream.firstGuess.at(1).starts_with("Y is down")) << stream.firstGuess.at(1);
      EXPECT_EQ(stream.people, std::vector<int>{1});
      expectPerformance(stream, truth, program.rate);
    }
  }
}

TEST(MediaPipeJson, FramesWithoutABodyAreGapsInTime) {
  const std::vector<SkeletonFrame> truth = wave();
  const json file = {{"fps", 30}, {"frames", listOf(truth, [](const SkeletonFrame& frame, int f) -> json {
                                     if (f % 4 == 1) return {{"frame_index", f}, {"landmarks", nullptr}};
                                     if (f % 4 == 2) return {{"frame_index", f}, {"landmarks", json::array()}};
                                     return {{"frame_index", f}, {"landmarks", landmarksOf(frame)}};
                                   })}};
  const JointStream stream = test::valueOf(parseJointStream(file.dump(), "wave.json"));
  ASSERT_EQ(stream.frames.size(), 20u);
  EXPECT_NEAR(stream.frames[2].time, 4.0 / 30.0, 1e-9);
  EXPECT_NEAR(stream.frames[3].time, 7.0 / 30.0, 1e-9);
}

TEST(MediaPipeJson, SeveralPeopleInAFrameAreTold) {
  const std::vector<SkeletonFrame> truth = wave();
  const json file = listOf(truth, [&](const SkeletonFrame& frame, int f) -> json {
    return {{"timestamp_ms", 33.3 * f}, {"world_landmarks", {landmarksOf(truth[0]), landmarksOf(frame)}}};
  });
  const JointStream stream = test::valueOf(parseJointStream(file.dump(), "two.json", {.person = 2}));
  EXPECT_EQ(stream.people, (std::vector<int>{1, 2}));
  const auto arm = [](const SkeletonFrame& frame) {
    return Vec3(frame[J::kLeftElbow].position - frame[J::kLeftShoulder].position);
  };
  EXPECT_LT((arm(stream.frames[20]) - arm(truth[20])).norm(), 1e-5);
}

TEST(MediaPipeJson, WhatIsNoBodyIsRefusedWithASentence) {
  const std::vector<SkeletonFrame> truth = wave();
  const auto without = [&](const char* axis) {
    return listOf(truth,
                  [&](const SkeletonFrame& frame, int) -> json {
                    json list = landmarksOf(frame);
                    for (json& point : list) point.erase(axis);
                    return {{"landmarks", list}};
                  })
        .dump();
  };
  constexpr std::string_view kNone =
      "x: found JSON without joints, expected frames, each with MediaPipe's 33 landmarks of x, y and z, or with points "
      "that are named as joints";
  for (const std::string& text :
       {std::string(R"({"frames": []})"), std::string(R"([{"landmarks": [{"x": 1, "y": 2, "z": 3}]}])"), without("z"),
        json{{"frames", json::array({{{"hand_landmarks", otherPoints(21)}}})}}.dump()}) {
    const Result<JointStream> stream = parseJointStream(text, "x");
    EXPECT_EQ(stream ? "accepted" : stream.error().message, kNone) << text.substr(0, 60);
  }
  EXPECT_NE(parseJointStream(R"({"frames": [)", "x").error().message.find("its JSON is broken"), std::string::npos);
  EXPECT_EQ(parseJointStream("a,b\n", "x", {.format = JointFormat::kMediaPipeJson}).error().message,
            "x: found 'a,b\\x0a', expected the JSON of MediaPipe's landmarks");
  json far = listOf(truth, [](const SkeletonFrame& frame, int) { return arraysOf(frame); });
  far[3][11][0] = 1e6;
  const std::string tooFar = parseJointStream(far.dump(), "x").error().message;
  EXPECT_TRUE(tooFar.starts_with("x, frame 3: found '[1000000.0,")) << tooFar;
}

TEST(MediaPipeJson, DamagedFilesGiveASentenceOrSoundJoints) {
  const test::TemporaryFolder folder;
  std::vector<SkeletonFrame> truth = wave();
  truth.resize(3);
  const std::string text = json{
      {"fps", 30}, {"frames", listOf(truth, [](const SkeletonFrame& frame, int f) -> json {
                      return {{"frame_index", f},
                              {"person_id", f % 2},
                              {"landmarks", landmarksOf(frame)},
                              {"world_landmarks", {arraysOf(frame)}}};
                    })}}.dump();
  std::mt19937 random(41);
  constexpr std::string_view kSigns = "0123456789.,:- \n+xyzNav{}[]\"";
  for (int round = 0; round < 300; ++round) {
    std::string damaged = text;
    for (unsigned hits = 1 + random() % 3; hits > 0; --hits) {
      const std::size_t at = random() % damaged.size();
      if (random() % 2 == 0) {
        damaged[at] = kSigns[random() % kSigns.size()];
      } else {
        damaged.erase(at, 1 + random() % 6);
      }
    }
    const Result<JointStream> stream = parseJointStream(damaged, "x", {.format = JointFormat::kMediaPipeJson});
    if (!stream) {
      EXPECT_TRUE(stream.error().message.starts_with("x")) << stream.error().message;
      continue;
    }
    const Result<void> written = writeJointCsv(folder.path() / "out.csv", stream->frames);
    EXPECT_TRUE(written) << written.error().message;
  }
}

}  // namespace
}  // namespace lorica
