#include "viewer/renderer/stroke_font_module.h"

#include <opencv2/imgproc.hpp>

namespace lorica {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

int widthOf(const std::string& text, const StrokeStyle& style) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, style.scale, style.thickness, &baseline).width;
}

void draw(std::span<const StrokeLine> lines, const StrokeStyle& style, int width, int height,
          std::span<std::uint8_t> coverage) {
  cv::Mat large(height * style.oversampling, width * style.oversampling, CV_8U, cv::Scalar(0));
  for (const StrokeLine& line : lines) {
    cv::putText(large, line.text, cv::Point(line.x, line.baseline), kFont, style.scale, cv::Scalar(255),
                style.thickness, style.antiAliased ? cv::LINE_AA : cv::LINE_8);
  }
  cv::Mat small(height, width, CV_8U, coverage.data());
  cv::resize(large, small, small.size(), 0, 0, cv::INTER_AREA);
}

}  // namespace
}  // namespace lorica

extern "C" __attribute__((visibility("default")))
const lorica::StrokeFontModule loricaStrokeFont = {lorica::widthOf, lorica::draw};
