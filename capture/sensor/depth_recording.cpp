#include "capture/sensor/depth_recording.h"

#include "capture/sensor/oni_file.h"
#include "capture/sensor/oni_records.h"
#include "capture/sensor/raw_depth.h"
#include "geometry/arrays/array_file.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxLensFile = 1 << 20;

class RawRecording final : public DepthRecording {
 public:
  RawRecording(RawDepth raw, DepthRectifier rectifier, std::string name)
      : DepthRecording(std::move(name), raw.about), raw_(std::move(raw)), rectifier_(std::move(rectifier)) {
    image_.resize(static_cast<std::size_t>(raw_.lens.width) * raw_.lens.height);
  }
  [[nodiscard]] const DepthCamera& camera() const override { return rectifier_.camera(); }

 private:
  [[nodiscard]] Result<void> read(int frame, DepthFrame& out) override {
    LORICA_TRY_DO(raw_.read(frame, image_));
    rectifier_.apply(image_, out.depthMm);
    out.time = raw_.times[frame];
    return {};
  }

  RawDepth raw_;
  DepthRectifier rectifier_;
  std::vector<std::uint16_t> image_;
};

/// A camera from JSON: fx, fy, cx, cy (or ppx, ppy), or Open3D's intrinsic_matrix, or ROS's K; distortion, coeffs or D;
/// unit in metres, or depth_scale as numbers a metre.
Result<void> readLensJson(const std::string& content, const std::string& file, DepthLens& lens) {
  LORICA_TRY(const nlohmann::json json, parseJson(content, file));
  if (!json.is_object()) return badFormat("{}: found no object, expected a camera: fx, fy, cx, cy", file);
  const auto number = [&](std::initializer_list<const char*> keys, double& value) {
    for (const char* key : keys) {
      if (const auto found = json.find(key); found != json.end() && found->is_number()) value = found->get<double>();
    }
  };
  const auto list = [&](std::initializer_list<const char*> keys) {
    std::vector<double> values;
    for (const char* key : keys) {
      const auto found = json.find(key);
      if (found == json.end() || !found->is_array()) continue;
      for (const nlohmann::json& each : *found) {
        if (each.is_number()) values.push_back(each.get<double>());
      }
    }
    return values;
  };
  double width = lens.width, height = lens.height, perMetre = 0.0;
  number({"width"}, width);
  number({"height"}, height);
  if (width != lens.width || height != lens.height) {
    return badFormat("{}: found a camera of {:g} x {:g}, expected {} x {} as the images are", file, width, height,
                     lens.width, lens.height);
  }
  if (const std::vector<double> k = list({"intrinsic_matrix"}); k.size() == 9) {  // column by column
    std::tie(lens.focalX, lens.focalY, lens.centreX, lens.centreY) = std::tuple(k[0], k[4], k[6], k[7]);
  }
  if (const std::vector<double> k = list({"K", "k"}); k.size() == 9) {  // row by row
    std::tie(lens.focalX, lens.focalY, lens.centreX, lens.centreY) = std::tuple(k[0], k[4], k[2], k[5]);
  }
  number({"fx"}, lens.focalX);
  number({"fy"}, lens.focalY);
  number({"cx", "ppx"}, lens.centreX);
  number({"cy", "ppy"}, lens.centreY);
  const std::vector<double> bent = list({"distortion", "coeffs", "D", "d"});
  std::copy_n(bent.begin(), std::min(bent.size(), lens.distortion.size()), lens.distortion.begin());
  number({"unit"}, lens.metresPerUnit);
  number({"depth_scale"}, perMetre);
  if (perMetre > 0.0)
    lens.metresPerUnit = perMetre < 1.0 ? perMetre : 1.0 / perMetre;  // RealSense's is the unit itself
  return {};
}

bool endsWith(const fs::path& path, std::string_view ending) {
  return lowerCase(path.extension().string()) == ending;
}

std::string beginOf(const fs::path& file, std::size_t bytes) {
  std::string begin(bytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), static_cast<std::streamsize>(bytes));
  begin.resize(std::max<std::streamsize>(in.gcount(), 0));
  return begin;
}

/// Whether a .npy has three dimensions, of which the last is no point's.
bool hasImages(const fs::path& file) {
  const std::string begin = beginOf(file, 256);
  const std::size_t shape = begin.find("'shape'"), open = begin.find('(', shape), close = begin.find(')', shape);
  if (shape == std::string::npos || open == std::string::npos || close == std::string::npos) return false;
  const std::string inside = begin.substr(open + 1, close - open - 1);
  const std::size_t last = inside.rfind(',');
  return std::ranges::count(inside, ',') == 2 && last != std::string::npos && std::atoi(inside.c_str() + last + 1) > 4;
}

/// Whether a folder holds 16-bit pictures, and no meshes, whose textures they would be.
bool hasPictures(const fs::path& folder) {
  constexpr std::size_t kPngHead = 33;
  std::error_code error;
  if (fs::exists(folder / "depth.txt", error)) return true;
  if (fs::is_directory(folder / "depth", error)) return hasPictures(folder / "depth");
  fs::path picture;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    for (const char* mesh : {".obj", ".ply", ".stl", ".off"}) {
      if (endsWith(at->path(), mesh)) return false;
    }
    if (picture.empty() && endsWith(at->path(), ".png")) picture = at->path();
  }
  return !picture.empty() && depthPngSize(beginOf(picture, kPngHead), "").ok();
}

}  // namespace

Result<std::unique_ptr<DepthRecording>> recordingOf(RawDepth raw, const fs::path& path) {
  const std::string name = path.string();
  if (raw.times.empty()) return badFormat("{}: found no depth image, expected at least one", name);
  for (std::size_t i = 0; i < raw.times.size(); ++i) {
    if (!std::isfinite(raw.times[i]) || (i > 0 && raw.times[i] <= raw.times[i - 1])) {
      return badFormat("{}: image {} is at {:.6f} s, expected a time after {:.6f} s", name, i, raw.times[i],
                       i > 0 ? raw.times[i - 1] : 0.0);
    }
  }
  LORICA_TRY(DepthRectifier rectifier, prefixed(name, DepthRectifier::create(raw.lens)));
  std::vector<std::uint16_t> first(static_cast<std::size_t>(raw.lens.width) * raw.lens.height);
  LORICA_TRY_DO(raw.read(0, first));
  LORICA_TRY_DO(prefixed(name, checkDepthUnit(raw.lens, first)));
  raw.about.frameCount = static_cast<int>(raw.times.size());
  raw.about.duration = raw.times.back() - raw.times.front();
  const fs::path last = path.has_filename() ? path.filename() : path.parent_path().filename();
  return std::unique_ptr<DepthRecording>(
      std::make_unique<RawRecording>(std::move(raw), std::move(rectifier), last.string()));
}

Result<GivenLens> GivenLens::find(std::string text, const std::vector<fs::path>& json) {
  GivenLens given;
  given.text_ = std::move(text);
  for (const fs::path& file : json) {
    std::error_code ignored;
    if (!given.file_.empty() || !fs::is_regular_file(file, ignored)) continue;
    given.file_ = file.string();
    LORICA_TRY(given.content_, readFile(file, NamedBy::kFile, kMaxLensFile));
  }
  return given;
}

Result<DepthLens> GivenLens::lensOf(int width, int height, const std::optional<DepthLens>& own, double unit,
                                    std::string& from) const {
  if (!text_.empty()) {
    from = "--lens";
    const std::string whole = text_.find("unit=") == std::string::npos ? fmt::format("{},unit={}", text_, unit) : text_;
    return prefixed("--lens", parseDepthLens(whole, width, height));
  }
  DepthLens lens;
  const std::optional<UsualLens> usual = usualLens(width, height);
  if (own) {
    lens = *own;
  } else if (usual) {
    lens = usual->lens;
    lens.metresPerUnit = unit;
    from = fmt::format("the usual camera of {} x {}: {}", width, height, usual->camera);
  } else {
    lens.metresPerUnit = unit;
  }
  lens.width = width;
  lens.height = height;
  if (!file_.empty()) {
    LORICA_TRY_DO(readLensJson(content_, file_, lens));
    from = file_;
  } else if (!own && !usual) {
    return invalidArgument(
        "found images of {} x {}, which no usual camera has, expected --lens fov=75x65, --lens fx=525,cx=320,cy=240 or "
        "a .json file beside them",
        width, height);
  }
  return lens;
}

bool isDepthRecording(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (endsWith(path, ".oni") || endsWith(path, ".bag")) return true;
  if (fs::is_directory(status)) return hasPictures(path);
  if (!fs::is_regular_file(status)) return false;
  if (endsWith(path, ".npy")) return hasImages(path);
  if (endsWith(path, ".npz")) {
    const std::vector<std::string> names = arrayNames(path);
    return std::ranges::find(names, "depth") != names.end();
  }
  const std::string begin = beginOf(path, 8);
  return begin.starts_with("NI10") || begin.starts_with("#ROSBAG") || begin.starts_with("\x1a\x45\xdf\xa3");
}

Result<std::unique_ptr<DepthRecording>> openDepthRecording(const fs::path& path, const std::string& lens) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    LORICA_TRY(RawDepth raw, readDepthPictures(path, lens));
    return recordingOf(std::move(raw), path);
  }
  if (endsWith(path, ".npy") || endsWith(path, ".npz")) {
    LORICA_TRY(RawDepth raw, readDepthArrays(path, lens));
    return recordingOf(std::move(raw), path);
  }
  LORICA_TRY(std::shared_ptr<const OniBytes> bytes, openBytes(path));
  std::array<std::uint8_t, 8> begin{};
  const bool long_ = bytes->read(0, begin);
  const std::string_view magic(reinterpret_cast<const char*>(begin.data()), begin.size());
  if (long_ && (magic.starts_with("#ROSBAG") || magic.starts_with("\x1a\x45\xdf\xa3"))) {
    LORICA_TRY(const GivenLens given, GivenLens::find(lens, {fs::path(path).replace_extension(".json")}));
    const bool bag = magic.starts_with("#");
    LORICA_TRY(RawDepth raw, bag ? readDepthBag(std::move(bytes), path.string(), given)
                                 : readDepthMatroska(std::move(bytes), path.string(), given));
    return recordingOf(std::move(raw), path);
  }
  if (!lens.empty())
    return invalidArgument("{}: --lens is for recordings of a camera's own images; .oni says its camera",
                           path.string());
  LORICA_TRY(std::unique_ptr<OniFile> opened, openOni(path));
  return std::unique_ptr<DepthRecording>(std::move(opened));
}

}  // namespace lorica
