#include "export/robots/xml_text.h"

#include "geometry/errors.h"
#include "geometry/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lorica {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view kWhite = " \t\r\n";

/// Where something ends that begins at `from`, its end mark included. The parser has found all of them.
std::size_t behind(std::string_view text, std::string_view mark, std::size_t from) {
  const std::size_t at = text.find(mark, from);
  return at == std::string_view::npos ? text.size() : at + mark.size();
}

struct Attribute {
  std::size_t begin = 0, valueBegin = 0, valueEnd = 0, end = 0;  ///< begin includes the white space before it
  std::string_view name;
};

struct Tag {
  std::size_t nameEnd = 0;
  std::size_t end = 0;  ///< behind its ">"
  bool closed = false;  ///< "/>"
  std::vector<Attribute> attributes;
};

/// The start tag at "<".
Tag startTag(std::string_view text, std::size_t begin) {
  Tag tag;
  tag.nameEnd = std::min(text.find_first_of(" \t\r\n/>", begin + 1), text.size());
  std::size_t at = tag.nameEnd;
  while (at < text.size()) {
    const std::size_t name = std::min(text.find_first_not_of(kWhite, at), text.size());
    if (name == text.size() || text[name] == '>') {
      tag.end = std::min(name + 1, text.size());
      return tag;
    }
    if (text[name] == '/') {
      tag.closed = true;
      tag.end = behind(text, ">", name);
      return tag;
    }
    const std::size_t nameEnd = std::min(text.find_first_of(" \t\r\n=", name), text.size());
    const std::size_t quote = std::min(text.find_first_of("\"'", nameEnd), text.size() - 1);
    const std::size_t close = std::min(text.find(text[quote], quote + 1), text.size() - 1);
    tag.attributes.push_back({at, quote + 1, close, close + 1, text.substr(name, nameEnd - name)});
    at = close + 1;
  }
  tag.end = text.size();
  return tag;
}

/// Behind the element at "<".
std::size_t elementEnd(std::string_view text, std::size_t begin) {
  const Tag first = startTag(text, begin);
  std::size_t at = first.end;
  for (int depth = first.closed ? 0 : 1; depth > 0 && at < text.size();) {
    at = std::min(text.find('<', at), text.size());
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = behind(text, "-->", at);
    } else if (rest.starts_with("<![CDATA[")) {
      at = behind(text, "]]>", at);
    } else if (rest.starts_with("<?")) {
      at = behind(text, "?>", at);
    } else if (rest.starts_with("</")) {
      at = behind(text, ">", at);
      --depth;
    } else {
      const Tag tag = startTag(text, at);
      at = tag.end;
      if (!tag.closed) ++depth;
    }
  }
  return at;
}

/// What a file of a stranger may not be, besides malformed.
struct Inspection : pugi::xml_tree_walker {
  bool dtd = false;
  int deepest = 0, elements = 0;
  bool for_each(pugi::xml_node& node) override {
    dtd |= node.type() == pugi::node_doctype;
    deepest = std::max(deepest, depth() + 1);
    if (node.type() == pugi::node_element) ++elements;
    return !dtd && deepest <= kMaxXmlDepth && elements <= kMaxXmlElements;
  }
};

std::size_t startOf(pugi::xml_node element) {
  return static_cast<std::size_t>(element.offset_debug()) - 1;  // the parser gives the name's place
}

}  // namespace

std::string escapedXml(std::string_view text) {
  std::string escaped;
  using namespace std::string_view_literals;
  for (const char& c : text) {
    escaped += c == '<'    ? "&lt;"sv
               : c == '&'  ? "&amp;"sv
               : c == '"'  ? "&quot;"sv
               : c == '\'' ? "&apos;"sv
                           : std::string_view(&c, 1);
  }
  return escaped;
}

std::string editedElement(std::string_view element, const XmlEdits& edits) {
  const Tag tag = startTag(element, 0);
  std::string text(element.substr(0, tag.nameEnd));
  const auto isNamed = [](const Attribute& attribute, const std::string& name) { return attribute.name == name; };
  for (const auto& edit : edits) {
    const auto isIt = [&](const Attribute& each) { return isNamed(each, edit.first); };
    if (!edit.second || std::ranges::any_of(tag.attributes, isIt)) continue;
    text += fmt::format(" {}=\"{}\"", edit.first, escapedXml(*edit.second));
  }
  std::size_t copied = tag.nameEnd;
  for (const Attribute& attribute : tag.attributes) {
    const auto edit = std::ranges::find_if(edits, [&](const auto& each) { return isNamed(attribute, each.first); });
    if (edit == edits.end()) continue;
    text += element.substr(copied, (edit->second ? attribute.valueBegin : attribute.begin) - copied);
    if (edit->second) text += escapedXml(*edit->second);
    copied = edit->second ? attribute.valueEnd : attribute.end;
  }
  return text + std::string(element.substr(copied));
}

Result<XmlText> XmlText::read(const std::filesystem::path& file, std::string shown, NamedBy by) {
  XmlText xml;
  xml.shown_ = std::move(shown);
  LORICA_TRY(xml.bytes_, readFile(file, by, kMaxXmlBytes));
  if (xml.bytes_.starts_with(kByteOrderMark)) {
    xml.mark_ = kByteOrderMark;
    xml.bytes_.erase(0, kByteOrderMark.size());
  }
  for (std::size_t at = 0; at != std::string::npos; at = xml.bytes_.find('\n', at + 1)) xml.lines_.push_back(at);
  if (const std::size_t zero = xml.bytes_.find('\0'); zero != std::string::npos) {
    return badFormat("{}:{}: found a zero byte, expected XML in UTF-8", xml.shown_, xml.lineAt(zero));
  }
  xml.document_ = std::make_unique<pugi::xml_document>();
  const pugi::xml_parse_result parsed = xml.document_->load_buffer(
      xml.bytes_.data(), xml.bytes_.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!parsed) {
    return badFormat("{}:{}: found no XML: {}", xml.shown_, xml.lineAt(static_cast<std::size_t>(parsed.offset)),
                     parsed.description());
  }
  Inspection inspection;
  xml.document_->traverse(inspection);
  if (inspection.dtd) return badFormat("{}: found a DTD (<!DOCTYPE>), expected a file without one", xml.shown_);
  xml.deepest_ = inspection.deepest;
  if (xml.deepest_ > kMaxXmlDepth) {
    return badFormat("{}: found more than {} levels of elements, expected at most that", xml.shown_, kMaxXmlDepth);
  }
  xml.elements_ = inspection.elements;
  if (xml.elements_ > kMaxXmlElements) {
    return badFormat("{}: found more than {} elements, expected at most that", xml.shown_, kMaxXmlElements);
  }
  if (!xml.root()) return badFormat("{}: found no element, expected XML", xml.shown_);
  return xml;
}

std::size_t XmlText::lineAt(std::size_t offset) const {
  return std::max<std::size_t>(1, std::ranges::upper_bound(lines_, offset) - lines_.begin());
}

std::string XmlText::where(pugi::xml_node node) const {
  return fmt::format("{}:{}", shown_, lineAt(startOf(node)));
}

std::string_view XmlText::textOf(pugi::xml_node element) const {
  const std::size_t begin = startOf(element);
  return std::string_view(bytes_).substr(begin, elementEnd(bytes_, begin) - begin);
}

std::string_view XmlText::indentOf(pugi::xml_node element) const {
  const std::size_t begin = startOf(element);
  std::size_t line = begin;
  while (line > 0 && (bytes_[line - 1] == ' ' || bytes_[line - 1] == '\t')) --line;
  return std::string_view(bytes_).substr(line, begin - line);
}

void XmlText::replace(pugi::xml_node element, const std::vector<std::string>& texts) {
  const std::size_t begin = startOf(element);
  const std::string between = "\n" + std::string(indentOf(element));
  splices_.push_back({begin, begin + textOf(element).size(), fmt::format("{}", fmt::join(texts, between))});
}

void XmlText::append(pugi::xml_node element, std::string text) {
  const std::size_t at = startOf(element) + textOf(element).rfind("</");
  splices_.push_back({at, at, std::move(text)});
}

std::string XmlText::changedText() const {
  std::vector<const Splice*> sorted;
  for (const Splice& each : splices_) sorted.push_back(&each);
  std::ranges::stable_sort(sorted, {}, [](const Splice* each) { return each->begin; });
  std::string text = mark_;
  std::size_t copied = 0;
  for (const Splice* each : sorted) {
    LORICA_CHECK(each->begin >= copied, "replaced elements contain each other");
    text += bytes_.substr(copied, each->begin - copied) + each->text;
    copied = each->end;
  }
  return text + bytes_.substr(copied);
}

Result<std::vector<double>> numbersOf(const std::string& where, std::string_view attribute, std::string_view text,
                                      std::size_t least, std::size_t most) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  bool good = true;
  while (good) {
    while (at != end && kWhite.find(*at) != std::string_view::npos) ++at;
    if (at == end) break;
    if (*at == '+') ++at;
    double number = 0.0;
    const auto [stop, error] = std::from_chars(at, end, number);
    good = error == std::errc() && std::isfinite(number) && numbers.size() < most &&
           (stop == end || kWhite.find(*stop) != std::string_view::npos);
    numbers.push_back(number);
    at = stop;
  }
  if (good && numbers.size() >= least) return numbers;
  return badFormat("{}: {}: found '{}', expected {}{}", where, attribute, printable(text, 60),
                   least == most ? "" : fmt::format("{} to ", least), counted(static_cast<long long>(most), "number"));
}

}  // namespace lorica
