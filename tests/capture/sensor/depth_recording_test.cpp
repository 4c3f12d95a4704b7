#include "capture/sensor/depth_recording.h"

#include "capture/sensor/oni_file.h"
#include "capture/sensor/oni_records.h"
#include "capture/sensor/raw_depth.h"
#include "geometry/arrays/array_file.h"
#include "geometry/little_endian.h"
#include "geometry/new_file.h"
#include "geometry/random_numbers.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <dlfcn.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using test::has;
using test::valueOf;

/// A slanted wall, another one in each frame.
std::vector<std::uint16_t> wallOf(int width, int height, int frame) {
  std::vector<std::uint16_t> image;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      image.push_back(static_cast<std::uint16_t>(1500 + 2 * column + row + 10 * frame));
    }
  }
  image[7] = 0;
  return image;
}

void writePng(const fs::path& file, int width, int height, const std::vector<std::uint16_t>& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_LINEAR_Y;
  ASSERT_NE(png_image_write_to_file(&image, file.c_str(), 0, pixels.data(), 0, nullptr), 0) << image.message;
}

std::vector<std::uint16_t> undone(const DepthLens& lens, const std::vector<std::uint16_t>& raw) {
  std::vector<std::uint16_t> made;
  valueOf(DepthRectifier::create(lens)).apply(raw, made);
  return made;
}

/// Checks frames and times, and that seeking gives the same.
void expectFrames(DepthRecording& recording, const DepthLens& lens, const std::vector<double>& times,
                  const std::function<std::vector<std::uint16_t>(int)>& raw) {
  EXPECT_EQ(recording.about().frameCount, static_cast<int>(times.size()));
  DepthFrame frame;
  for (std::size_t i = 0; i < times.size(); ++i) {
    ASSERT_EQ(valueOf(recording.next(frame)), DepthRead::kFrame);
    EXPECT_NEAR(frame.time - times[i], 0.0, 1e-6) << i;
    EXPECT_EQ(frame.depthMm, undone(lens, raw(static_cast<int>(i)))) << i;
  }
  EXPECT_EQ(valueOf(recording.next(frame)), DepthRead::kEnd);
  recording.seek(static_cast<int>(times.size()) - 1);
  ASSERT_EQ(valueOf(recording.next(frame)), DepthRead::kFrame);
  EXPECT_EQ(frame.depthMm, undone(lens, raw(static_cast<int>(times.size()) - 1)));
}

// ---- pictures ----

TEST(DepthPictures, NumberedOnesAreThirtyASecondOfTheUsualCamera) {
  const test::TemporaryFolder folder;
  for (int i = 0; i < 12; ++i) {
    writePng(folder.path() / fmt::format("MDepth-{}.png", i), 512, 424, wallOf(512, 424, i));
  }
  ASSERT_TRUE(isDepthRecording(folder.path()));
  const auto recording = valueOf(openDepthRecording(folder.path() / ""));
  EXPECT_TRUE(has(recording->about().lens, "Kinect v2"));
  EXPECT_EQ(recording->name(), folder.path().filename());
  std::vector<double> times;
  for (int i = 0; i < 12; ++i) times.push_back(i / 30.0);
  expectFrames(*recording, valueOf(parseDepthLens("512x424")), times, [](int i) { return wallOf(512, 424, i); });
}

TEST(DepthPictures, TumsListHasTimesAndItsUnit) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder.path() / "depth");
  const auto scaled = [](int i) {
    std::vector<std::uint16_t> image = wallOf(640, 480, i);
    for (std::uint16_t& depth : image) depth *= 5;
    return image;
  };
  for (int i = 0; i < 3; ++i) writePng(folder.path() / fmt::format("depth/{}.png", 9 - i), 640, 480, scaled(i));
  folder.write("depth.txt", "# depth maps\r\n100.5 depth/9.png\r\n100.6 depth/8.png\n100.75\tdepth/7.png\n");
  const DepthLens lens{640, 480, 525.0, 525.0, 319.5, 239.5, {}, 0.0002};
  expectFrames(*valueOf(openDepthRecording(folder.path())), lens, {100.5, 100.6, 100.75}, scaled);

  folder.write("depth.txt", "100.5 depth/9.png\n1 ../secret.png\n");
  EXPECT_TRUE(has(openDepthRecording(folder.path()).error().message, "depth.txt:2"));
  folder.write("depth.txt", "100.5 depth/9.png\n100.5 depth/8.png\n");
  EXPECT_TRUE(has(openDepthRecording(folder.path()).error().message, "expected a time after"));
}

TEST(DepthPictures, TheCameraIsWhatTheFileBesideOrTheOptionSays) {
  const test::TemporaryFolder folder;
  const fs::path pictures = folder.path() / "take";
  fs::create_directory(pictures);
  writePng(pictures / "1.25.png", 80, 60, wallOf(80, 60, 0));
  writePng(pictures / "1.5.png", 80, 60, wallOf(80, 60, 1));
  EXPECT_TRUE(has(openDepthRecording(pictures).error().message, "--lens"));
  const auto wall = [](int i) { return wallOf(80, 60, i); };
  DepthLens lens{80, 60, 70.0, 71.0, 39.0, 31.5, {0.1, -0.01, 0.001, 0.002, 0.003, 0, 0, 0}, 0.002};
  folder.write("take.json", R"({"fx": 70, "fy": 71, "ppx": 39, "ppy": 31.5, "coeffs": [0.1, -0.01, 0.001, 0.002, 0.003],
                               "depth_scale": 0.002})");
  expectFrames(*valueOf(openDepthRecording(pictures)), lens, {1.25, 1.5}, wall);
  lens.distortion = {};
  std::ofstream(pictures / "camera.json")
      << R"({"width": 80, "height": 60, "intrinsic_matrix": [70, 0, 0, 0, 71, 0, 39, 31.5, 1], "depth_scale": 500})";
  expectFrames(*valueOf(openDepthRecording(pictures)), lens, {1.25, 1.5}, wall);
  lens.metresPerUnit = 0.001;
  expectFrames(*valueOf(openDepthRecording(pictures, "fx=70,fy=71,cx=39,cy=31.5")), lens, {1.25, 1.5}, wall);
  std::ofstream(pictures / "camera.json") << R"({"width": 81, "height": 60})";
  EXPECT_TRUE(has(openDepthRecording(pictures).error().message, "81 x 60"));
}

TEST(DepthPictures, FoldersOfMeshesAndOfColourAreNone) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(isDepthRecording(folder.path()));
  folder.write("1.png", "\x89PNG\r\n\x1a\n and more");
  EXPECT_FALSE(isDepthRecording(folder.path()));
  fs::remove(folder.path() / "1.png");
  writePng(folder.path() / "skin.png", 20, 20, wallOf(20, 20, 0));
  EXPECT_TRUE(isDepthRecording(folder.path()));
  folder.write("frame_1.obj", "v 0 0 0\n");
  EXPECT_FALSE(isDepthRecording(folder.path()));
}

TEST(DepthPictures, DamagedOnesAreSentences) {
  const test::TemporaryFolder folder;
  const fs::path whole = folder.path() / "0.png";
  writePng(whole, 40, 30, wallOf(40, 30, 0));
  const std::string bytes = valueOf(readFile(whole));
  RandomNumbers random(7);
  std::vector<std::uint16_t> image(1200);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decodeDepthPng(std::string(bytes, 0, size), "cut", 40, 30, image)) << size;
  }
  for (int trial = 0; trial < 3000; ++trial) {
    std::string mutated = bytes;
    mutated[static_cast<std::size_t>(random.unit() * 0.999 * static_cast<double>(bytes.size()))] ^=
        static_cast<char>(1 + trial % 255);
    (void)decodeDepthPng(mutated, "mutated", 40, 30, image);
  }
  writePng(folder.path() / "1.png", 30, 40, wallOf(30, 40, 0));
  const auto recording = valueOf(openDepthRecording(folder.path(), "fov=60x45"));
  DepthFrame frame;
  EXPECT_TRUE(recording->next(frame));
  EXPECT_TRUE(has(recording->next(frame).error().message, "30 x 40"));
}

// ---- arrays ----

TEST(DepthArrays, OfAllTypesGiveMillimetres) {
  const test::TemporaryFolder folder;
  const auto made = [&](const std::string& type, auto value) {
    NamedArray array{"depth", type, {2, 48, 64}, {}};
    for (int i = 0; i < 2; ++i) {
      for (const std::uint16_t depth : wallOf(64, 48, i)) appendLittleEndian(value(depth), array.bytes);
    }
    return array;
  };
  const std::string k = [] {
    std::string bytes;
    for (const double each : {60.0, 0.0, 31.5, 0.0, 61.0, 23.5, 0.0, 0.0, 1.0}) appendLittleEndian(each, bytes);
    return bytes;
  }();
  std::string times;
  appendLittleEndian(2.0, times);
  appendLittleEndian(2.5, times);
  const DepthLens lens{64, 48, 60.0, 61.0, 31.5, 23.5, {}, 0.001};
  for (const NamedArray& depth :
       {made("<u2", [](std::uint16_t d) { return d; }), made("<i4", [](std::uint16_t d) { return std::int32_t{d}; }),
        made("<f4", [](std::uint16_t d) { return 0.001F * d; }),
        made("<f8", [](std::uint16_t d) { return static_cast<double>(d); })}) {
    const fs::path file = folder.path() / "take.npz";
    {
      const auto out = valueOf(NewFile::create(file));
      ASSERT_TRUE(writeArrays(
          std::vector{depth, NamedArray{"K", "<f8", {3, 3}, k}, NamedArray{"times", "<f8", {2}, times}}, *out));
      ASSERT_TRUE(out->finish());
    }
    ASSERT_TRUE(isDepthRecording(file)) << depth.type;
    expectFrames(*valueOf(openDepthRecording(file)), lens, {2.0, 2.5}, [](int i) { return wallOf(64, 48, i); });
    fs::remove(file);
  }
}

// ---- Matroska ----

std::string ebml(std::uint32_t id, std::string_view content) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) {
    if (id >> shift != 0) bytes += static_cast<char>(id >> shift & 0xff);
  }
  bytes += '\x08';  // a size of five bytes
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(content.size() >> shift & 0xff);
  return bytes.append(content);
}
std::string ebml(std::uint32_t id, std::uint64_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
  return ebml(id, std::string_view(bytes));
}

// The lens of a real Azure Kinect, that others published.
constexpr std::array<double, 14> kKinect = {0.5122697949409485,
                                            0.49451231956481934,
                                            0.4921168386936188,
                                            0.4921667277812958,
                                            3.1305770874023438,
                                            2.324939012527466,
                                            0.1304156482219696,
                                            3.458651542663574,
                                            3.350114583969116,
                                            0.6629416346549988,
                                            0.0,
                                            0.0,
                                            -0.0000511557373,
                                            0.00008132171933};

std::string calibration() {
  return fmt::format(R"({{"CalibrationInformation": {{"Cameras": [
    {{"Purpose": "CALIBRATION_CameraPurposePhotoVideo", "Intrinsics": {{"ModelParameters": [1, 2]}}}},
    {{"Purpose": "CALIBRATION_CameraPurposeDepth", "Intrinsics": {{"ModelParameters": [{}]}}}}]}}}})",
                     fmt::join(kKinect, ", "));
}

struct MkvSettings {
  int width = 320, height = 288, frames = 3;
  bool png = false, calibrated = true, openEnds = false;
};

std::string madeMkv(const MkvSettings& settings, const test::TemporaryFolder& folder) {
  const auto track = [&](std::uint64_t number, std::string_view name, std::string_view fourCc) {
    const std::string header = std::string(16, '\0').append(fourCc) + std::string(20, '\0');
    return ebml(0xae,
                ebml(0xd7, number) + ebml(0x536e, name) + ebml(0x86, "V_MS/VFW/FOURCC") + ebml(0x63a2, header) +
                    ebml(0xe0, ebml(0xb0, std::uint64_t(settings.width)) + ebml(0xba, std::uint64_t(settings.height))));
  };
  std::string segment = ebml(0x1549a966, ebml(0x2ad7b1, std::uint64_t{1000000})) +
                        ebml(0x1654ae6b, track(1, "COLOR", "MJPG") + track(2, "DEPTH", settings.png ? "MPNG" : "b16g"));
  if (settings.calibrated) {
    segment +=
        ebml(0x1941a469, ebml(0x61a7, ebml(0x466e, "other.txt") + ebml(0x465c, "x")) +
                             ebml(0x61a7, ebml(0x466e, "calibration.json") + ebml(0x465c, calibration() + '\0')));
  }
  for (int i = 0; i < settings.frames; ++i) {
    std::string image;
    for (const std::uint16_t depth : wallOf(settings.width, settings.height, i)) {
      image += static_cast<char>(depth >> 8);
      image += static_cast<char>(depth & 0xff);
    }
    if (settings.png) {
      writePng(folder.path() / "one.png", settings.width, settings.height, wallOf(settings.width, settings.height, i));
      image = readFile(folder.path() / "one.png").value();
    }
    const std::string block = std::string("\x82\x00", 2) + static_cast<char>(33 * (i % 2)) + '\x80' + image;
    const std::string children = ebml(0xe7, std::uint64_t(5000 + 66 * (i / 2))) +
                                 ebml(0xa3, std::string("\x81\x00\x00\x80", 4) + "colour") +
                                 (i % 2 == 0 ? ebml(0xa3, block) : ebml(0xa0, ebml(0xa1, block)));
    segment += settings.openEnds ? std::string("\x1f\x43\xb6\x75\xff", 5) + children : ebml(0x1f43b675, children);
  }
  const std::string head = ebml(0x1a45dfa3, ebml(0x4282, "matroska"));
  return head + (settings.openEnds ? std::string("\x18\x53\x80\x67\x01\xff\xff\xff\xff\xff\xff\xff", 12) + segment
                                   : ebml(0x18538067, segment));
}

TEST(DepthMatroska, AnAzureKinectsIsReadWithItsCalibration) {
  const test::TemporaryFolder folder;
  for (const bool png : {false, true}) {
    for (const bool openEnds : {false, true}) {
      const fs::path file = folder.write("take.mkv", madeMkv({.png = png, .openEnds = openEnds}, folder));
      ASSERT_TRUE(isDepthRecording(file));
      const auto recording = valueOf(openDepthRecording(file));
      EXPECT_EQ(recording->about().lens, "its calibration");
      // The binned mode has half the pixels of the sensor.
      const DepthLens lens{
          320,
          288,
          kKinect[2] * 512,
          kKinect[3] * 512,
          kKinect[0] * 512 - 96.5,
          kKinect[1] * 512 - 90.5,
          {kKinect[4], kKinect[5], kKinect[13], kKinect[12], kKinect[6], kKinect[7], kKinect[8], kKinect[9]},
          0.001};
      expectFrames(*recording, lens, {5.0, 5.033, 5.066}, [](int i) { return wallOf(320, 288, i); });
    }
  }
  const fs::path wide = folder.write("wide.mkv", madeMkv({.width = 640, .height = 576, .frames = 1}, folder));
  const DepthCamera camera = valueOf(openDepthRecording(wide))->camera();
  EXPECT_GT(camera.horizontalFov, 1.25) << "75 degrees are 1.31";
  const fs::path bare = folder.write("bare.mkv", madeMkv({.calibrated = false}, folder));
  EXPECT_TRUE(has(valueOf(openDepthRecording(bare))->about().lens, "Azure Kinect"));
  EXPECT_EQ(valueOf(openDepthRecording(bare, "fov=60x55"))->about().lens, "--lens");
}

TEST(DepthMatroska, FilmsAreSentences) {
  const test::TemporaryFolder folder;
  std::string film = madeMkv({}, folder);
  film.replace(film.find("DEPTH"), 5, "VIDEO");
  film.replace(film.find("b16g"), 4, "H264");
  const fs::path file = folder.write("film.mkv", film);
  EXPECT_TRUE(has(openDepthRecording(file).error().message, "COLOR, VIDEO"));
}

// ---- ROS ----

std::string bagField(std::string_view name, std::string_view value) {
  std::string bytes;
  appendLittleEndian(static_cast<std::uint32_t>(name.size() + 1 + value.size()), bytes);
  return bytes.append(name).append("=").append(value);
}
template <typename T>
std::string packed(T value) {
  std::string bytes;
  appendLittleEndian(value, bytes);
  return bytes;
}
std::string sized(std::string_view bytes) {
  return packed(static_cast<std::uint32_t>(bytes.size())).append(bytes);
}
std::string bagRecord(char op, const std::string& fields, const std::string& data) {
  return sized(bagField("op", std::string(1, op)) + fields) + sized(data);
}

enum class Packing { kNone, kLz4, kBz2 };

/// Literals, and runs of equal bytes as copies.
std::string lz4Of(const std::string& bytes) {
  const auto more = [](std::size_t length) {
    std::string out;
    for (length -= 15; length >= 255; length -= 255) out += '\xff';
    return out + static_cast<char>(length);
  };
  std::string block;
  std::size_t begin = 0;
  for (std::size_t at = 1; at < bytes.size();) {
    std::size_t run = at;
    while (run < bytes.size() && bytes[run] == bytes[at - 1]) ++run;
    if (run - at >= 4 && run + 12 < bytes.size()) {
      const std::size_t literals = at - begin, count = run - at - 4;
      block += static_cast<char>(std::min<std::size_t>(literals, 15) << 4 | std::min<std::size_t>(count, 15));
      if (literals >= 15) block += more(literals);
      block.append(bytes, begin, literals).append("\x01\x00", 2);
      if (count >= 15) block += more(count);
      begin = run;
    }
    at = run + 1;
  }
  const std::size_t literals = bytes.size() - begin;
  block += static_cast<char>(std::min<std::size_t>(literals, 15) << 4);
  if (literals >= 15) block += more(literals);
  block.append(bytes, begin, literals);
  // A stored block follows, of nothing that belongs to it.
  return packed(0x184d2204U) + "\x60\x70\x73" + sized(block) + packed(0U);
}

std::string bz2Of(const std::string& bytes) {
  using Pack = int (*)(char*, unsigned*, char*, unsigned, int, int, int);
  static const auto pack = reinterpret_cast<Pack>(dlsym(dlopen("libbz2.so.1.0", RTLD_NOW), "BZ2_bzBuffToBuffCompress"));
  std::string out(bytes.size() + 1000, '\0');
  auto size = static_cast<unsigned>(out.size());
  EXPECT_EQ(pack(out.data(), &size, const_cast<char*>(bytes.data()), static_cast<unsigned>(bytes.size()), 9, 0, 0), 0);
  return out.substr(0, size);
}

const DepthLens kBagLens{64, 48, 60.0, 61.0, 30.0, 25.0, {0.1, -0.02, 0.001, 0.002, 0.0, 0, 0, 0}, 0.0005};

std::string header(int frame) {
  return packed(frame) + packed(100U + static_cast<unsigned>(frame)) + packed(500'000'000U) + sized("camera");
}

std::string imageMessage(int frame, bool bigEndian) {
  std::string pixels;
  for (std::size_t i = 0; const std::uint16_t depth : wallOf(64, 48, frame)) {
    pixels += bigEndian ? static_cast<char>(depth >> 8) : static_cast<char>(depth & 0xff);
    pixels += bigEndian ? static_cast<char>(depth & 0xff) : static_cast<char>(depth >> 8);
    if (++i % 64 == 0) pixels += "pad!";
  }
  return header(frame) + packed(48U) + packed(64U) + sized("16UC1") + static_cast<char>(bigEndian) + packed(132U) +
         sized(pixels);
}

std::string infoMessage() {
  std::string bytes = header(0) + packed(48U) + packed(64U) + sized("plumb_bob") + packed(5U);
  for (int i = 0; i < 5; ++i) bytes += packed(kBagLens.distortion[static_cast<std::size_t>(i)]);
  for (const double k : {60.0, 0.0, 30.0, 0.0, 61.0, 25.0, 0.0, 0.0, 1.0}) bytes += packed(k);
  for (int i = 0; i < 9; ++i) bytes += packed(0.0);
  for (const double p : {50.0, 0.0, 31.5, 0.0, 0.0, 51.0, 23.5, 0.0, 0.0, 0.0, 1.0, 0.0}) bytes += packed(p);
  return bytes + std::string(17, '\0');
}

std::string madeBag(Packing packing, bool bigEndian = false, const std::string& kind = "image_raw") {
  struct Topic {
    std::string name, type;
  };
  const std::vector<Topic> topics = {{"/camera/color/image_raw", "sensor_msgs/Image"},
                                     {"/camera/color/camera_info", "sensor_msgs/CameraInfo"},
                                     {"/camera/depth/" + kind, "sensor_msgs/Image"},
                                     {"/camera/depth/camera_info", "sensor_msgs/CameraInfo"},
                                     {"/device_0/sensor_0/option/Depth Units/value", "std_msgs/Float32"}};
  const auto connection = [&](std::uint32_t number) {
    return bagRecord('\7', bagField("conn", packed(number)) + bagField("topic", topics[number].name),
                     bagField("topic", topics[number].name) + bagField("type", topics[number].type));
  };
  std::string bag =
      "#ROSBAG V2.0\n" + bagRecord('\3', bagField("index_pos", packed(std::uint64_t{4711})), std::string(100, ' '));
  for (int chunk = 0; chunk < 2; ++chunk) {
    std::string content;
    std::map<std::uint32_t, std::string> index;
    const auto message = [&](std::uint32_t topic, int second, const std::string& data) {
      const std::string time = packed(200U + static_cast<unsigned>(second)) + packed(250'000'000U);
      index[topic] += time + packed(static_cast<std::uint32_t>(content.size()));
      content += bagRecord('\2', bagField("conn", packed(topic)) + bagField("time", time), data);
    };
    if (chunk == 0) {
      content += connection(2);
      message(4, 0, packed(0.0005F));
      message(1, 0, "not read");
      message(3, 0, infoMessage());
    }
    message(0, chunk, std::string(300, 'c'));
    for (int i = 0; i < 2; ++i) message(2, 2 * chunk + i, imageMessage(2 * chunk + i, bigEndian));
    const std::string stored = packing == Packing::kLz4   ? lz4Of(content)
                               : packing == Packing::kBz2 ? bz2Of(content)
                                                          : content;
    const char* name = packing == Packing::kLz4 ? "lz4" : packing == Packing::kBz2 ? "bz2" : "none";
    bag += bagRecord(
        '\5', bagField("compression", name) + bagField("size", packed(static_cast<std::uint32_t>(content.size()))),
        stored);
    for (const auto& [topic, entries] : index) {
      bag += bagRecord('\4',
                       bagField("ver", packed(1U)) + bagField("conn", packed(topic)) +
                           bagField("count", packed(static_cast<std::uint32_t>(entries.size() / 12))),
                       entries);
    }
  }
  for (std::uint32_t number = 0; number < topics.size(); ++number) bag += connection(number);
  return bag + bagRecord('\6', bagField("ver", packed(1U)), "");
}

TEST(DepthBag, ChunksOfEachPackingGiveTheSame) {
  const test::TemporaryFolder folder;
  for (const Packing packing : {Packing::kNone, Packing::kLz4, Packing::kBz2}) {
    for (const bool bigEndian : {false, true}) {
      const fs::path file = folder.write("take.bag", madeBag(packing, bigEndian));
      const auto recording = valueOf(openDepthRecording(file));
      EXPECT_EQ(recording->about().lens, "the topic /camera/depth/camera_info");
      expectFrames(*recording, kBagLens, {200.25, 201.25, 202.25, 203.25}, [](int i) { return wallOf(64, 48, i); });
    }
  }
}

TEST(DepthBag, ARectifiedImageHasNoDistortion) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.write("take.bag", madeBag(Packing::kNone, false, "image_rect_raw"));
  const DepthLens lens{64, 48, 50.0, 51.0, 31.5, 23.5, {}, 0.0005};
  expectFrames(*valueOf(openDepthRecording(file)), lens, {200.25, 201.25, 202.25, 203.25},
               [](int i) { return wallOf(64, 48, i); });
}

TEST(DepthBag, OthersAreSentences) {
  const test::TemporaryFolder folder;
  std::string bag = madeBag(Packing::kNone);
  bag.replace(bag.find(packed(std::uint64_t{4711})), 8, 8, '\0');
  EXPECT_TRUE(has(openDepthRecording(folder.write("killed.bag", bag)).error().message, "rosbag reindex"));
  bag = madeBag(Packing::kNone);
  for (std::size_t at = 0; (at = bag.find("16UC1", at)) != std::string::npos; ++at) bag.replace(at, 5, "bgra8");
  EXPECT_TRUE(has(openDepthRecording(folder.write("colour.bag", bag)).error().message, "/camera/depth/image_raw"));
}

// ---- all ----

Result<void> readWhole(Result<RawDepth> read) {
  if (!read) return read.error();
  LORICA_TRY(const std::unique_ptr<DepthRecording> recording, recordingOf(std::move(*read), "made"));
  DepthFrame frame;
  for (int i = 0; i < std::min(recording->about().frameCount, 5); ++i) LORICA_TRY_DO(recording->next(frame));
  return {};
}

TEST(DepthRecordings, DamagedOnesAreFramesOrSentencesAndReserveLittle) {
  const test::TemporaryFolder folder;
  const GivenLens none = valueOf(GivenLens::find("fov=60x45", {}));
  RandomNumbers random(681);
  const auto read = [&](const std::string& bytes, bool bag) {
    std::shared_ptr<const OniBytes> memory = bytesInMemory(bytes);
    return readWhole(bag ? readDepthBag(std::move(memory), "made", none)
                         : readDepthMatroska(std::move(memory), "made", none));
  };
  const std::vector<std::pair<std::string, bool>> whole = {
      {madeMkv({.width = 20, .height = 16}, folder), false},
      {madeMkv({.width = 20, .height = 16, .png = true, .openEnds = true}, folder), false},
      {madeBag(Packing::kNone), true},
      {madeBag(Packing::kLz4), true},
      {madeBag(Packing::kBz2), true}};
  int refused = 0;
  const test::AllocationWatch watch;
  for (const auto& [bytes, bag] : whole) {
    EXPECT_TRUE(read(bytes, bag));
    for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 300) {
      const Result<void> cut = read(bytes.substr(0, size), bag);
      EXPECT_TRUE(cut || !cut.error().message.empty());
    }
    for (int trial = 0; trial < 1000; ++trial) {
      std::string mutated = bytes;
      for (int change = 0; change <= trial % 3; ++change) {
        // Half of them where the heads are.
        const double reach = trial % 2 == 0 ? std::min(1500.0, 0.999 * static_cast<double>(bytes.size()))
                                            : 0.999 * static_cast<double>(bytes.size());
        mutated[static_cast<std::size_t>(random.unit() * reach)] = static_cast<char>(random.bits() >> 56U);
      }
      refused += read(mutated, bag) ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(watch.largest(), std::size_t{300} << 20);
}

TEST(DepthRecordings, EachBecomesOniWithoutLoss) {
  const test::TemporaryFolder folder;
  const fs::path oni = folder.path() / "out.oni";
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"take.mkv", madeMkv({}, folder)}, {"take.bag", madeBag(Packing::kLz4)}}) {
    const auto recording = valueOf(openDepthRecording(folder.write(name, bytes)));
    int written = 0;
    ASSERT_TRUE(writeOni(*recording, oni, [&](int done) { return (written = done) > 0; }));
    EXPECT_EQ(written, recording->about().frameCount);
    const auto read = valueOf(openOni(oni));
    EXPECT_EQ(read->camera(), recording->camera());
    EXPECT_EQ(read->info().frameCount, written);
    recording->seek(0);
    DepthFrame a, b;
    double begin = 0.0;
    for (int i = 0; i < written; ++i) {
      ASSERT_TRUE(recording->next(a));
      ASSERT_TRUE(read->next(b));
      if (i == 0) begin = a.time;
      EXPECT_NEAR(a.time - begin, b.time, 1e-6);
      EXPECT_EQ(a.depthMm, b.depthMm);
    }
    EXPECT_EQ(writeOni(*recording, oni, [](int) { return false; }).error().code, ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace lorica
