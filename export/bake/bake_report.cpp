#include "export/bake/bake_report.h"

#include "geometry/files.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace lorica {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kPictures = 20;
constexpr std::size_t kBins = 20;

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:72em;padding:0 1em;color:#222}"
    "h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}table{border-collapse:collapse}"
    "td,th{padding:.15em .8em .15em 0;text-align:left;vertical-align:top;border-bottom:1px solid #ddd}"
    "td.n,th.n{text-align:right}.row{display:flex;flex-wrap:wrap;gap:1.2em}figure{margin:0;width:16em}"
    "figure img{width:100%}figcaption{font-size:.85em;overflow-wrap:anywhere}svg text{font-size:11px;fill:#444}"
    "td.n{white-space:nowrap}svg rect{fill:#4a7ab5}.bad{color:#a00}";

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return safe;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kSigns = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three = (three << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kSigns[(three >> (18 - 6 * k)) & 63] : '=';
  }
  return text;
}

struct Axis {
  std::string title;
  double factor = 1.0;  ///< from the figure to what is written
  std::string unit;
};

/// Bars from the smallest to the largest figure, with their counts on hover.
std::string histogram(const std::vector<double>& figures, const Axis& axis) {
  if (figures.empty()) return "";
  const auto [min, max] = std::ranges::minmax(figures);
  std::vector<std::size_t> counts(kBins, 0);
  for (const double figure : figures) {
    const double place = max > min ? (figure - min) / (max - min) : 0.0;
    ++counts[std::min<std::size_t>(kBins - 1, place * kBins)];
  }
  const double most = *std::ranges::max_element(counts);
  std::string svg =
      fmt::format("<figure><figcaption>{}</figcaption><svg viewBox=\"0 0 260 120\">", escaped(axis.title));
  for (std::size_t b = 0; b < kBins; ++b) {
    const double height = 100.0 * counts[b] / most;
    const double from = min + (max - min) * b / kBins;
    svg += fmt::format(
        "<rect x=\"{}\" y=\"{:.1f}\" width=\"12\" height=\"{:.1f}\"><title>{} from {:.4g} {}</title></rect>", 13 * b,
        100.0 - height, height, counts[b], axis.factor * from, axis.unit);
  }
  svg +=
      fmt::format("<text x=\"0\" y=\"115\">{:.3g}</text><text x=\"260\" y=\"115\" text-anchor=\"end\">{:.3g} {}</text>",
                  axis.factor * min, axis.factor * max, axis.unit);
  return svg + "</svg></figure>";
}

std::string histograms(const std::vector<const ordered_json*>& results) {
  if (results.size() < 2) return "";  // one does not spread
  std::vector<double> errors, seconds, parts;
  for (const ordered_json* result : results) {
    errors.push_back(std::max(0.0, errorOf(*result)));
    seconds.push_back(result->value("seconds", 0.0));
    parts.push_back(result->value("parts", 0.0));
  }
  return "<h2>How they spread</h2><div class=\"row\">" +
         histogram(errors, {"Extra volume of the hulls, in held-out poses for characters", 100.0, "%"}) +
         histogram(seconds, {"Time", 1.0, "s"}) + histogram(parts, {"Parts", 1.0, "parts"}) + "</div>";
}

std::string failures(const BakeCollection& collection) {
  std::string html;
  const auto list = [&html](const std::string& title, const std::vector<std::string>& sentences) {
    if (sentences.empty()) return;
    html += fmt::format("<h2>{}</h2><ul class=\"bad\">", title);
    for (const std::string& sentence : sentences) html += fmt::format("<li>{}</li>", escaped(sentence));
    html += "</ul>";
  };
  std::vector<std::string> sentences;
  for (const ordered_json* result : collection.failed()) sentences.push_back(result->value("failure", ""));
  list("Failed", sentences);
  list("Damaged", collection.damaged);
  list("Not done yet", collection.missing);
  return html;
}

std::string contactSheet(const std::vector<const ordered_json*>& worst, const BakePicture& picture) {
  std::string html = "<h2>The largest errors</h2><div class=\"row\">";
  for (std::size_t i = 0; i < std::min(kPictures, worst.size()); ++i) {
    const ordered_json& result = *worst[i];
    const std::string png = picture(result);
    html += "<figure>";
    if (!png.empty()) html += fmt::format("<img alt=\"\" src=\"data:image/png;base64,{}\">", base64(png));
    html += fmt::format("<figcaption>{}<br>{}, {:.1f} %<br>{}</figcaption></figure>",
                        escaped(result.value("input", "")), counted(result.value("parts", 0), "part"),
                        100.0 * errorOf(result), escaped(result.value("settings", "")));
  }
  return html + "</div>";
}

std::string resultTable(const std::vector<const ordered_json*>& results) {
  std::string html =
      "<h2>All results</h2><table><tr><th>input</th><th>settings</th><th class=\"n\">parts</th><th "
      "class=\"n\">score</th>"
      "<th class=\"n\">error</th><th class=\"n\">s</th><th class=\"n\">MB</th><th>files</th></tr>";
  for (const ordered_json* result : results) {
    html += fmt::format(
        "<tr><td>{0}</td><td>{1}</td><td class=\"n\">{2}</td><td class=\"n\">{3:.4f}</td><td class=\"n\">{4:.1f} "
        "%</td><td "
        "class=\"n\">{5:.1f}</td><td class=\"n\">{6:.0f}</td><td><a href=\"items/{7}\">items/{7}</a></td></tr>",
        escaped(result->value("input", "")), escaped(result->value("settings", "")), result->value("parts", 0),
        result->value("score", 0.0), 100.0 * errorOf(*result), result->value("seconds", 0.0),
        result->value("peakMemory", 0.0) / 1e6, escaped(result->value("item", "")));
  }
  return html + "</table>";
}

/// Makes a symbolic link, or replaces one. Some file systems have none: items/ holds everything.
void link(const std::filesystem::path& target, const std::filesystem::path& link) {
  std::error_code ignored;
  const std::filesystem::file_status there = std::filesystem::symlink_status(link, ignored);
  if (std::filesystem::exists(there) && !std::filesystem::is_symlink(there)) return;
  const std::filesystem::path made = link.string() + ".new";
  std::filesystem::remove(made, ignored);
  std::filesystem::create_symlink(target, made, ignored);
  std::filesystem::rename(made, link, ignored);
}

}  // namespace

double errorOf(const ordered_json& result) {
  return result.contains("heldOutError") ? result.value("heldOutError", 0.0) : result.value("error", 0.0);
}

std::vector<const ordered_json*> BakeCollection::failed() const {
  std::vector<const ordered_json*> those;
  for (const ordered_json& result : results) {
    if (result.contains("failure")) those.push_back(&result);
  }
  return those;
}

std::vector<const ordered_json*> BakeCollection::worstFirst() const {
  std::vector<const ordered_json*> those;
  for (const ordered_json& result : results) {
    if (!result.contains("failure")) those.push_back(&result);
  }
  std::ranges::stable_sort(those, [](const auto* a, const auto* b) { return errorOf(*a) > errorOf(*b); });
  return those;
}

std::string BakeCollection::hash() const {
  std::vector<std::string> lines;
  for (const ordered_json& result : results) {
    lines.push_back(
        fmt::format("{} {} {}\n", result.value("item", ""), result.value("result", ""), result.contains("failure")));
  }
  std::ranges::sort(lines);
  return hexDigits(contentHash(fmt::format("{}", fmt::join(lines, ""))));
}

BakeCollection collect(std::span<const BakeJob> jobs, const BakeStore& store, bool checkFiles) {
  BakeCollection collection;
  for (const BakeJob& job : jobs) {
    Result<ordered_json> result = store.describe(job.name);
    if (!result) {
      if (result.error().code == ErrorCode::kNotFound) collection.missing.push_back(job.item.input);
      if (result.error().code != ErrorCode::kNotFound) collection.damaged.push_back(result.error().message);
      continue;
    }
    if (checkFiles) {
      std::string damage = store.damageOf(job.name, *result);
      if (!damage.empty()) collection.damaged.push_back(std::move(damage));
    }
    collection.results.push_back(std::move(*result));
  }
  return collection;
}

void linkResults(const BakeCollection& collection, std::span<const BakeJob> jobs, const std::filesystem::path& folder) {
  std::map<std::string, const BakeJob*> byName;
  std::map<std::string, int> stems;
  for (const BakeJob& job : jobs) {
    byName[job.name] = &job;
    ++stems[job.stem];
  }
  for (const ordered_json& result : collection.results) {
    const auto found = byName.find(result.value("item", ""));
    if (found == byName.end()) continue;
    const auto& [item, job] = *found;
    std::set<std::string> names;
    for (const ordered_json& file : result.value("files", ordered_json::array())) {
      // The first folder of "hero/part.obj"; the name itself if it is in none.
      const std::string name = file.value("file", "");
      names.insert(name.substr(0, name.find('/')));
    }
    for (const std::string& name : names) {
      if (!name.starts_with(job->stem)) continue;
      link(std::filesystem::path("items") / item / name,
           folder / (stems[job->stem] > 1 ? item + name.substr(job->stem.size()) : name));
    }
  }
}

std::string jsonLines(const BakeCollection& collection) {
  std::string text;
  for (const ordered_json& result : collection.results) {
    text += result.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  }
  return text;
}

std::string htmlReport(const BakeCollection& collection, const BakePicture& picture) {
  const std::vector<const ordered_json*> done = collection.worstFirst();
  const std::string title = fmt::format("{} baked, {} failed, {} not done yet", done.size(), collection.failed().size(),
                                        collection.missing.size());
  return fmt::format(
             "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Lorica: {0}</title><style>{1}</style>"
             "<h1>{0}</h1><p>Hash of all results: <code>{2}</code></p>",
             title, kStyle, collection.hash()) +
         failures(collection) + histograms(done) + contactSheet(done, picture) + resultTable(done) + "</html>\n";
}

}  // namespace lorica
