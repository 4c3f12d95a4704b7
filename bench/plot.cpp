#include "bench/plot.h"

#include "viewer/pictures/image_files.h"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lorica::bench {

namespace {

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

}  // namespace

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

}  // namespace lorica::bench
