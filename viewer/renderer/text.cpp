#include "viewer/renderer/text.h"

#include "viewer/renderer/stroke_font.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

namespace lorica {
namespace {

constexpr int kOversampling = 4;
constexpr double kCapPerLine = 0.52;       // height of capitals per line height
constexpr double kStrokePerCap = 0.115;    // thickness of a stroke per height of capitals
constexpr double kTabPerLine = 5.5;        // distance of tab stops per line height
constexpr double kBaselinePerLine = 0.74;  // from the top of a line

constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kLikeness = {{{"\u2013", "-"},
                                                                                      {"\u2014", "-"},
                                                                                      {"\u2212", "-"},
                                                                                      {"\u00b7", "-"},
                                                                                      {"\u00d7", "x"},
                                                                                      {"\u00b5", "u"},
                                                                                      {"\u03bc", "u"},
                                                                                      {"\u00b1", "+-"},
                                                                                      {"\u2018", "'"},
                                                                                      {"\u2019", "'"},
                                                                                      {"\u2026", "..."},
                                                                                      {"\u00b0", " deg"}}};

/// @param line  line height in the oversampled picture [pixels]
StrokeStyle styleOf(int line) {
  const double cap = kCapPerLine * line;
  return {kOversampling, cap / kStrokeCapHeight, std::max(1, static_cast<int>(std::lround(kStrokePerCap * cap))), true};
}

}  // namespace

std::string drawableText(std::string_view utf8) {
  std::string ascii;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto byte = static_cast<unsigned char>(utf8[i]);
    if (byte < 0x80) {
      ascii += byte == '\n' || byte == '\t' || (byte >= 0x20 && byte < 0x7f) ? static_cast<char>(byte) : ' ';
      ++i;
      continue;
    }
    const auto* like = std::find_if(kLikeness.begin(), kLikeness.end(),
                                    [&](const auto& pair) { return utf8.substr(i).starts_with(pair.first); });
    if (like != kLikeness.end()) {
      ascii += like->second;
      i += like->first.size();
    } else {
      ascii += '?';
      do ++i;
      while (i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80);
    }
  }
  return ascii;
}

TextMask drawText(std::string_view text, int lineHeight) {
  const std::string ascii = drawableText(text);
  std::vector<std::string> lines(1);
  for (const char c : ascii) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }

  const int line = std::max(lineHeight, 6) * kOversampling;
  const StrokeStyle style = styleOf(line);
  int width = 0;
  std::vector<StrokeLine> pieces;
  for (std::size_t row = 0; row < lines.size(); ++row) {
    const int baseline = static_cast<int>(row) * line + static_cast<int>(kBaselinePerLine * line);
    std::stringstream cells(lines[row]);
    std::string cell;
    for (int column = 0; std::getline(cells, cell, '\t'); ++column) {
      const int x = column * static_cast<int>(kTabPerLine * line);
      width = std::max(width, x + strokeWidth(cell, style));
      pieces.push_back({cell, style.thickness + x, baseline});
    }
  }
  TextMask mask;
  mask.width = (width + 2 * style.thickness + kOversampling - 1) / kOversampling;
  mask.height = static_cast<int>(lines.size()) * line / kOversampling;
  mask.coverage.resize(static_cast<std::size_t>(mask.width) * mask.height);
  drawStrokes(pieces, style, mask.width, mask.height, mask.coverage);
  return mask;
}

std::string fittedText(std::string_view text, int lineHeight, int width) {
  const StrokeStyle style = styleOf(std::max(lineHeight, 6));
  const auto fits = [&](const std::string& line) { return strokeWidth(line, style) + 2 * style.thickness <= width; };
  std::istringstream words(drawableText(text));
  std::string all, line, word, blanks;
  const auto endLine = [&] {
    if (!all.empty()) all += '\n';
    all += line;
    line.clear();
  };
  while (words >> word) {
    if (!line.empty() && !fits(fmt::format("{}{}{}", line, blanks, word))) endLine();
    if (!line.empty()) line += blanks;
    if (!fits(word)) {
      while (!word.empty() && !fits(fmt::format("{}..", word))) word.pop_back();
      word += "..";
    }
    line += word;
    blanks.clear();
    while (words.peek() == ' ') blanks += static_cast<char>(words.get());
  }
  endLine();
  return all;
}

Image drawTextPanel(std::string_view text, int lineHeight) {
  constexpr double kPlateAlpha = 0.72;
  const TextMask mask = drawText(text, lineHeight);
  const int margin = std::max(2, lineHeight / 3);
  const double radius = 0.9 * margin;
  Image panel;
  panel.width = mask.width + 2 * margin;
  panel.height = mask.height + margin;
  panel.rgba.assign(static_cast<std::size_t>(panel.width) * panel.height * 4, 0);
  const std::array<double, 3> ink = {38, 44, 54};
  for (int y = 0; y < panel.height; ++y) {
    for (int x = 0; x < panel.width; ++x) {
      // The distance to the plate, shrunk by its corner radius, gives an anti-aliased rim.
      const double dx = std::max({radius - (x + 0.5), x + 0.5 - (panel.width - radius), 0.0});
      const double dy = std::max({radius - (y + 0.5), y + 0.5 - (panel.height - radius), 0.0});
      const double plate = kPlateAlpha * std::clamp(radius - std::hypot(dx, dy) + 0.5, 0.0, 1.0);
      const int tx = x - margin;
      const int ty = y - margin / 2;
      const bool inside = tx >= 0 && ty >= 0 && tx < mask.width && ty < mask.height;
      const double cover =
          inside ? mask.coverage[static_cast<std::size_t>(ty) * mask.width + static_cast<std::size_t>(tx)] / 255.0
                 : 0.0;
      std::uint8_t* pixel = panel.rgba.data() + (static_cast<std::size_t>(y) * panel.width + x) * 4;
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = static_cast<std::uint8_t>(std::lround(ink[c] * cover + 255.0 * plate * (1.0 - cover)));
      }
      pixel[3] = static_cast<std::uint8_t>(std::lround(255.0 * (cover + plate * (1.0 - cover))));
    }
  }
  return panel;
}

}  // namespace lorica
