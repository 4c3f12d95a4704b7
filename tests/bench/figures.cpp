// Figures 3, 8 and 9 of Thul et al. 2018 on the built-in character and motions, as pictures, with the numbers as CSV on
// standard output. Also measures the benefit of choosing keyframes.

#include "acd/transfer.h"
#include "capture/files/joint_csv.h"
#include "collision/hulls/keyframes.h"
#include "geometry/result.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/measure.h"
#include "tests/bench/walker.h"
#include "viewer/pictures/image_files.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

/// One line or set of bars in a chart.
struct Series {
  std::string name;  ///< for the legend
  std::vector<double> x;
  std::vector<double> y;
  bool dots = false;  ///< draw a dot at each point
};

/// A chart with axes, ticks and a legend, drawn as a PNG.
struct Chart {
  std::string title;
  std::string xName;
  std::string yName;
  std::vector<Series> series;
  bool logX = false;                    ///< logarithmic, with ticks at the values of x that occur
  bool bars = false;                    ///< bars of equal width, side by side, instead of lines
  std::vector<std::string> ticks = {};  ///< labels instead of numbers, one for each x of the first series
};

constexpr int kWidth = 1000;
constexpr int kHeight = 480;
constexpr int kLeft = 90, kRight = 25, kTop = 70, kBottom = 65;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kTextSize = 0.48;
const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kGrid(225, 225, 225);

/// Palette for colour-blind readers too (Okabe and Ito), in the order blue, green, red.
cv::Scalar colorOf(std::size_t series) {
  static const std::array<cv::Scalar, 5> colors = {cv::Scalar(178, 114, 0), cv::Scalar(0, 94, 213),
                                                   cv::Scalar(115, 158, 0), cv::Scalar(167, 121, 204),
                                                   cv::Scalar(66, 159, 240)};
  return colors[series % colors.size()];
}

cv::Size sizeOf(const std::string& text) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, kTextSize, 1, &baseline);
}

void write(cv::Mat& picture, const std::string& text, cv::Point at) {
  cv::putText(picture, text, at, kFont, kTextSize, kInk, 1, cv::LINE_AA);
}

/// A step of 1, 2 or 5 times a power of ten that divides a range into about `wanted` intervals.
double niceStep(double range, int wanted) {
  const double rough = range / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= rough) return step * power;
  }
  return 10.0 * power;
}

class Axes {
 public:
  Axes(cv::Mat picture, const Chart& chart) : picture_(std::move(picture)), chart_(chart) {
    for (const Series& s : chart.series) {
      for (const double x : s.x) {
        minX_ = std::min(minX_, x);
        maxX_ = std::max(maxX_, x);
      }
      for (const double y : s.y) maxY_ = std::max(maxY_, y);
    }
    if (chart.bars) {
      const double half = 0.5 * spacing();
      minX_ -= half;
      maxX_ += half;
    }
    if (!(maxX_ > minX_)) maxX_ = minX_ + 1.0;
    step_ = niceStep(maxY_ > 0.0 ? maxY_ : 1.0, 6);
    maxY_ = step_ * std::ceil(maxY_ / step_ + 1e-9);
  }

  void draw() {
    drawFrame();
    for (std::size_t i = 0; i < chart_.series.size(); ++i) chart_.bars ? drawBars(i) : drawLine(i);
    drawLegend();
  }

 private:
  /// Distance between neighbouring bars.
  [[nodiscard]] double spacing() const {
    const std::vector<double>& x = chart_.series.front().x;
    return x.size() > 1 ? x[1] - x[0] : 1.0;
  }
  [[nodiscard]] double pixelX(double x) const {
    const double share = chart_.logX ? std::log(x / minX_) / std::log(maxX_ / minX_) : (x - minX_) / (maxX_ - minX_);
    return kLeft + share * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double pixelY(double y) const { return kHeight - kBottom - y / maxY_ * (kHeight - kTop - kBottom); }
  [[nodiscard]] cv::Point pixel(double x, double y) const {
    return {static_cast<int>(std::lround(pixelX(x))), static_cast<int>(std::lround(pixelY(y)))};
  }

  void drawFrame() {
    for (int i = 0; i * step_ <= maxY_ * (1.0 + 1e-9); ++i) {
      const double y = i * step_;
      cv::line(picture_, pixel(minX_, y), pixel(maxX_, y), i == 0 ? kInk : kGrid, 1);
      const std::string text = fmt::format("{:g}", y);
      write(picture_, text, pixel(minX_, y) + cv::Point(-sizeOf(text).width - 8, 5));
    }
    const auto tick = [&](double x, const std::string& text) {
      cv::line(picture_, pixel(x, 0.0), pixel(x, 0.0) + cv::Point(0, 5), kInk, 1);
      write(picture_, text, pixel(x, 0.0) + cv::Point(-sizeOf(text).width / 2, 22));
    };
    const std::vector<double>& x = chart_.series.front().x;
    if (chart_.ticks.size() == x.size()) {
      for (std::size_t i = 0; i < x.size(); ++i) tick(x[i], chart_.ticks[i]);
    } else if (chart_.logX) {
      for (const double value : x) tick(value, fmt::format("{:g}", value));
    } else {
      const double step = niceStep(maxX_ - minX_, 10);
      const auto last = static_cast<int>(std::floor(maxX_ / step + 1e-9));
      for (int i = static_cast<int>(std::ceil(minX_ / step - 1e-9)); i <= last; ++i) {
        tick(i * step, fmt::format("{:g}", i * step));
      }
    }
    write(picture_, chart_.title, {kLeft, 28});
    write(picture_, chart_.xName, {(kWidth + kLeft - kRight - sizeOf(chart_.xName).width) / 2, kHeight - 16});
    // The name of the y axis, rotated.
    const cv::Size size = sizeOf(chart_.yName);
    cv::Mat label(size.height + 10, size.width + 4, CV_8UC3, cv::Scalar::all(255));
    write(label, chart_.yName, {2, size.height + 2});
    cv::rotate(label, label, cv::ROTATE_90_COUNTERCLOCKWISE);
    const int top = std::max(0, (kHeight - kBottom + kTop - label.rows) / 2);
    label.copyTo(picture_(cv::Rect(8, top, label.cols, std::min(label.rows, kHeight - top))));
  }

  void drawLine(std::size_t index) {
    const Series& s = chart_.series[index];
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (i > 0)
        cv::line(picture_, pixel(s.x[i - 1], s.y[i - 1]), pixel(s.x[i], s.y[i]), colorOf(index), 2, cv::LINE_AA);
      if (s.dots) cv::circle(picture_, pixel(s.x[i], s.y[i]), 4, colorOf(index), cv::FILLED, cv::LINE_AA);
    }
  }

  void drawBars(std::size_t index) {
    const Series& s = chart_.series[index];
    const double width = 0.8 * spacing() / static_cast<double>(chart_.series.size());
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const double left = s.x[i] - 0.4 * spacing() + width * static_cast<double>(index);
      if (s.y[i] <= 0.0) continue;
      cv::rectangle(picture_, pixel(left, s.y[i]), pixel(left + width, 0.0) + cv::Point(-1, -1), colorOf(index),
                    cv::FILLED);
    }
  }

  /// In a row below the title, where it covers nothing.
  void drawLegend() {
    int left = kLeft;
    for (std::size_t i = 0; i < chart_.series.size(); ++i) {
      const int half = chart_.bars ? 5 : 1;
      cv::rectangle(picture_, {left, 48 - half}, {left + 24, 48 + half}, colorOf(i), cv::FILLED);
      write(picture_, chart_.series[i].name, {left + 32, 53});
      left += 60 + sizeOf(chart_.series[i].name).width;
    }
  }

  cv::Mat picture_;
  const Chart& chart_;
  double minX_ = std::numeric_limits<double>::infinity();
  double maxX_ = -std::numeric_limits<double>::infinity();
  double maxY_ = 0.0;
  double step_ = 1.0;
};

/// Writes one or more charts, one below the other, as one picture of 1000 pixels width.
Result<void> writeCharts(const std::filesystem::path& file, const std::vector<Chart>& charts) {
  cv::Mat picture(kHeight * static_cast<int>(charts.size()), kWidth, CV_8UC3, cv::Scalar::all(255));
  for (std::size_t i = 0; i < charts.size(); ++i) {
    Axes(picture(cv::Rect(0, kHeight * static_cast<int>(i), kWidth, kHeight)), charts[i]).draw();
  }
  Image image{picture.cols, picture.rows, std::vector<std::uint8_t>(picture.total() * 4)};
  cv::Mat rgba(picture.rows, picture.cols, CV_8UC4, image.rgba.data());
  cv::cvtColor(picture, rgba, cv::COLOR_BGR2RGBA);
  return writePng(file, image);
}

/// A histogram of several sets of values with common bins, as bars: x is the centre of a bin, y the share of values.
Chart histogram(const std::vector<Series>& values, int bins) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Series& s : values) {
    const auto [min, max] = std::minmax_element(s.y.begin(), s.y.end());
    low = std::min(low, *min);
    high = std::max(high, *max);
  }
  const double width = high > low ? (high - low) / bins : 1.0;
  Chart chart;
  chart.bars = true;
  for (const Series& s : values) {
    Series bars{s.name, {}, std::vector<double>(static_cast<std::size_t>(bins)), false};
    for (int b = 0; b < bins; ++b) bars.x.push_back(low + (b + 0.5) * width);
    for (const double v : s.y) {
      const auto bin = std::min(static_cast<std::size_t>((v - low) / width), static_cast<std::size_t>(bins - 1));
      bars.y[bin] += 1.0 / static_cast<double>(s.y.size());
    }
    chart.series.push_back(std::move(bars));
  }
  return chart;
}

struct Options {
  std::string folder;
  std::string preset = "fast";
  int parts = 16;
  int keyframes = 12;
  int frames = 200;
  int threads = 2;
  bool quick = false;
  std::vector<int> figures = {3, 8, 9, 0};
};

using Motions = std::vector<SkeletalMotion>;

/// The character, its motions and the settings for all figures.
struct Studio {
  Options options;
  Character character = makeMannequin();
  Motions motions = syntheticMotions(character);

  [[nodiscard]] std::size_t vertexCount() const { return character.mesh.vertices.size(); }

  [[nodiscard]] std::vector<Vec3> uniformFrames(const Motions& from, int count) const {
    Result<std::vector<Vec3>> frames = sampleKeyframes(character, from, count);
    LORICA_CHECK(frames.ok(), "the motions must have enough frames for each figure");
    return std::move(*frames);
  }

  /// Decomposes into the requested number of parts; cannot fail because the character's mesh is valid.
  [[nodiscard]] Timed cut(std::span<const Vec3> keyframes, DecomposeSettings settings) const {
    settings.maxParts = options.parts;
    settings.threads = options.threads;
    Result<Timed> made = timeDecompose(character.mesh, {keyframes, static_cast<int>(vertexCount())}, settings, 1);
    LORICA_CHECK(made.ok(), "the built-in character can be decomposed");
    return std::move(*made);
  }

  [[nodiscard]] DecomposeSettings preset() const { return preset(options.preset); }
  [[nodiscard]] static DecomposeSettings preset(const std::string& name) {
    DecomposeSettings settings;
    settings.preset = presetOf(name);
    return settings;
  }

  /// Relative volume error in each pose.
  [[nodiscard]] std::vector<double> errors(const Decomposition& parts, std::span<const Vec3> poses) const {
    const PoseView view{poses, static_cast<int>(vertexCount())};
    std::vector<double> found;
    found.reserve(static_cast<std::size_t>(view.keyframeCount()));
    for (int k = 0; k < view.keyframeCount(); ++k) {
      found.push_back(errorInPose(parts, character.mesh, view.keyframe(k)).relative());
    }
    return found;
  }

  /// Mean error over every tenth frame of a motion.
  [[nodiscard]] double errorOver(const Decomposition& parts, const SkeletalMotion& motion) const {
    const Motions alone = {motion};
    return meanOf(errors(parts, uniformFrames(alone, std::max(2, motion.frameCount() / 10))));
  }
};

std::vector<double> counted(std::size_t count) {
  std::vector<double> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<double>(i + 1);
  return numbers;
}

/// Fig. 3: the error as a function of the number of deepest concave edges that are tried for each cut. Uses the paper's
/// algorithm, because the other kinds of planes that the presets add would hide the effect.
Result<void> figure3(const Studio& studio) {
  fmt::print("figure,keyframes,candidate_edges,error,seconds\n");
  std::vector<double> candidates = {1, 2, 4, 8, 16, 32, 64};
  if (studio.options.quick) candidates = {1, 4, 16};
  Chart error{"", "candidate edges (C)", "relative volume error", {}, true, false};
  error.title = fmt::format("Fig. 3: error by candidate edges, the paper's algorithm, {} parts", studio.options.parts);
  Chart seconds{"Time by candidate edges", "candidate edges (C)", "seconds", {}, true, false};
  const std::vector<Vec3> bind = studio.character.mesh.vertices;
  const std::vector<Vec3> moving = studio.uniformFrames(studio.motions, studio.options.keyframes);
  for (const auto& [name, frames] : {std::pair{std::string("bind pose"), &bind},
                                     std::pair{fmt::format("{} keyframes", studio.options.keyframes), &moving}}) {
    Series errors{name, candidates, {}, true};
    Series times{name, candidates, {}, true};
    for (const double c : candidates) {
      fmt::print(stderr, "figure 3: {}, {} candidate edges\n", name, c);
      DecomposeSettings settings;
      settings.preset = DecomposePreset::kPaper;
      settings.candidateEdges = static_cast<int>(c);
      const Timed made = studio.cut(*frames, settings);
      errors.y.push_back(meanOf(studio.errors(made.decomposition, *frames)));
      times.y.push_back(made.seconds);
      fmt::print("3,{},{},{:.5f},{:.3f}\n", frames->size() / studio.vertexCount(), c, errors.y.back(), times.y.back());
    }
    error.series.push_back(std::move(errors));
    seconds.series.push_back(std::move(times));
  }
  return writeCharts(fs::path(studio.options.folder) / "fig3_candidates.png", {error, seconds});
}

/// Fig. 8: the error in each keyframe of parts trained on this keyframe only, and of parts trained on all keyframes.
Result<void> figure8(const Studio& studio) {
  fmt::print("figure,keyframe,alone,together\n");
  const std::vector<Vec3> frames = studio.uniformFrames(studio.motions, studio.options.keyframes);
  fmt::print(stderr, "figure 8: all {} keyframes together\n", studio.options.keyframes);
  const std::vector<double> together = studio.errors(studio.cut(frames, studio.preset()).decomposition, frames);
  std::vector<double> alone;
  alone.reserve(together.size());
  for (std::size_t k = 0; k < together.size(); ++k) {
    fmt::print(stderr, "figure 8: keyframe {} by itself\n", k + 1);
    const std::span<const Vec3> one = std::span(frames).subspan(k * studio.vertexCount(), studio.vertexCount());
    alone.push_back(studio.errors(studio.cut(one, studio.preset()).decomposition, one).front());
    fmt::print("8,{},{:.5f},{:.5f}\n", k + 1, alone.back(), together[k]);
  }
  fmt::print("# figure 8: mean error alone {:.4f}, together {:.4f}, ratio {:.3f}\n", meanOf(alone), meanOf(together),
             meanOf(together) / meanOf(alone));
  Chart chart{"", "keyframe", "relative volume error", {}, false, true};
  chart.title = fmt::format("Fig. 8: parts trained on one frame or on all ({} parts, {})", studio.options.parts,
                            studio.options.preset);
  for (std::size_t k = 1; k <= alone.size(); ++k) chart.ticks.push_back(std::to_string(k));
  chart.series = {{"each frame by itself", counted(alone.size()), alone, false},
                  {"all frames together", counted(alone.size()), together, false}};
  return writeCharts(fs::path(studio.options.folder) / "fig8_alone_together.png", {chart});
}

/// Fig. 9: the error over many frames of parts trained on the first frame, and of parts trained on several keyframes.
Result<void> figure9(const Studio& studio) {
  fmt::print("figure,frame,first,all\n");
  const int count = studio.options.quick ? 40 : studio.options.frames;
  const std::vector<Vec3> keyframes = studio.uniformFrames(studio.motions, studio.options.keyframes);
  const std::vector<Vec3> frames = studio.uniformFrames(studio.motions, count);
  fmt::print(stderr, "figure 9: {} frames\n", count);
  const std::span<const Vec3> firstFrame = std::span(keyframes).first(studio.vertexCount());
  const std::vector<double> first = studio.errors(studio.cut(firstFrame, studio.preset()).decomposition, frames);
  const std::vector<double> all = studio.errors(studio.cut(keyframes, studio.preset()).decomposition, frames);
  for (std::size_t k = 0; k < first.size(); ++k) fmt::print("9,{},{:.5f},{:.5f}\n", k + 1, first[k], all[k]);
  const auto worst = [](const std::vector<double>& e) { return *std::max_element(e.begin(), e.end()); };
  fmt::print("# figure 9: mean error from the first frame {:.4f}, from {} keyframes {:.4f}; largest {:.4f}, {:.4f}\n",
             meanOf(first), studio.options.keyframes, meanOf(all), worst(first), worst(all));
  const std::vector<Series> both = {
      {"trained on the first frame", counted(first.size()), first, false},
      {fmt::format("trained on {} keyframes", studio.options.keyframes), counted(all.size()), all, false}};
  Chart curve{"", "frame", "relative volume error", both};
  curve.title = fmt::format("Fig. 9: error over {} frames of six motions ({} parts, {})", count, studio.options.parts,
                            studio.options.preset);
  Chart bars = histogram(both, 24);
  bars.title = "Distribution of the error";
  bars.xName = "relative volume error";
  bars.yName = "share of frames";
  return writeCharts(fs::path(studio.options.folder) / "fig9_first_all.png", {curve, bars});
}

/// Not in the paper: each motion in turn is held out, the others provide keyframes at even intervals or chosen ones.
Result<void> unseenMotion(const Studio& studio) {
  fmt::print("figure,preset,unseen,uniform,chosen,first\n");
  Motions all = studio.motions;
  if (studio.options.quick) all.resize(2);
  const std::array<const char*, 3> presets = {"paper", "fast", "quality"};
  std::array<std::array<std::vector<double>, 3>, 3> errors;
  for (std::size_t unseen = 0; unseen < all.size(); ++unseen) {
    const std::string name(kShippedMotions[unseen]);
    fmt::print(stderr, "unseen motion: {}\n", name);
    Motions training = all;
    training.erase(training.begin() + static_cast<std::ptrdiff_t>(unseen));
    const std::vector<Vec3> evenly = studio.uniformFrames(training, studio.options.keyframes);
    const Result<ChosenKeyframes> picked = chooseKeyframes(studio.character, training, studio.options.keyframes, 0.0);
    if (!picked) return picked.error();
    const std::array<std::span<const Vec3>, 3> keyframes = {evenly, picked->positions,
                                                            std::span(evenly).first(studio.vertexCount())};
    for (std::size_t p = 0; p < presets.size(); ++p) {
      for (std::size_t k = 0; k < keyframes.size(); ++k) {
        const Timed cut = studio.cut(keyframes[k], studio.preset(presets[p]));
        errors[p][k].push_back(studio.errorOver(cut.decomposition, all[unseen]));
      }
      fmt::print("unseen,{},{},{:.5f},{:.5f},{:.5f}\n", presets[p], name, errors[p][0].back(), errors[p][1].back(),
                 errors[p][2].back());
    }
  }
  for (std::size_t p = 0; p < presets.size(); ++p) {
    fmt::print("# unseen motion, {}, mean error: {} uniform keyframes {:.3f}, chosen {:.3f}, first frame {:.3f}\n",
               presets[p], studio.options.keyframes, meanOf(errors[p][0]), meanOf(errors[p][1]), meanOf(errors[p][2]));
  }
  return {};
}

int run(const Options& options) {
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) return fail({ErrorCode::kUnwritable, fmt::format("{}: {}", options.folder, error.message())});
  const Studio studio{options};
  for (const int figure : options.figures) {
    const Result<void> drawn = figure == 3   ? figure3(studio)
                               : figure == 8 ? figure8(studio)
                               : figure == 9 ? figure9(studio)
                                             : unseenMotion(studio);
    if (!drawn) return fail(drawn.error());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app(
      "Draws Fig. 3, 8 and 9 of Thul et al. 2018 on the built-in character into a folder; numbers as CSV on "
      "standard output, progress on standard error.");
  app.add_option("FOLDER", options.folder, "Output folder of the pictures")->required();
  app.add_option("--figures", options.figures, "3, 8, 9; 0 = uniform or chosen keyframes [default: all]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({0, 3, 8, 9}));
  app.add_option("--preset", options.preset, "For Fig. 8 and 9 [default: fast]")
      ->check(CLI::IsMember({"paper", "fast", "quality"}));
  app.add_option("--parts", options.parts, "[default: 16]")->check(CLI::Range(1, 1000));
  app.add_option("--keyframes", options.keyframes, "[default: 12]")->check(CLI::Range(1, 200));
  app.add_option("--frames", options.frames, "Number of frames in Fig. 9 [default: 200]")->check(CLI::Range(2, 2000));
  app.add_option("--threads", options.threads, "[default: 2]")->check(CLI::Range(1, 1024));
  app.add_flag("--quick", options.quick, "Fewer points, for a quick test");
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
