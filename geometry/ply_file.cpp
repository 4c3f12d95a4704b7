#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/line_scanner.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lorica {

namespace {

// Files of scanners have a dozen; each line of the header is compared with those before.
constexpr std::size_t kMaxElements = 100;
constexpr std::size_t kMaxProperties = 1000;

enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct Property {
  std::string name;
  Scalar type = Scalar::kFloat32;
  std::optional<Scalar> countType;  ///< only for a list
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
  std::optional<Encoding> encoding;
  std::vector<Element> elements;
};

struct ScalarKind {
  std::string_view name, newName;
  std::size_t size;
  double (*load)(const char* at, std::endian order);
};

template <typename T>
constexpr ScalarKind kindOf(std::string_view name, std::string_view newName) {
  return {name, newName, sizeof(T),
          [](const char* at, std::endian order) { return static_cast<double>(loadBytes<T>(at, order)); }};
}

/// In the order of Scalar.
constexpr std::array<ScalarKind, 8> kScalars = {
    kindOf<std::int8_t>("char", "int8"),    kindOf<std::uint8_t>("uchar", "uint8"),
    kindOf<std::int16_t>("short", "int16"), kindOf<std::uint16_t>("ushort", "uint16"),
    kindOf<std::int32_t>("int", "int32"),   kindOf<std::uint32_t>("uint", "uint32"),
    kindOf<float>("float", "float32"),      kindOf<double>("double", "float64")};

std::optional<Scalar> scalarNamed(std::string_view name) {
  for (std::size_t i = 0; i < kScalars.size(); ++i) {
    if (name == kScalars[i].name || name == kScalars[i].newName) return static_cast<Scalar>(i);
  }
  return std::nullopt;
}

bool isInteger(Scalar type) {
  return type < Scalar::kFloat32;
}

std::size_t sizeOf(Scalar type) {
  return kScalars[ordinalOf(type)].size;
}

Result<Property> readProperty(LineScanner& scanner) {
  Property property;
  std::string_view word = scanner.word();
  if (word == "list") {
    word = scanner.word();
    property.countType = scalarNamed(word);
    if (!property.countType || !isInteger(*property.countType)) {
      return scanner.fail(fmt::format("found {} as the type of a list's count, expected an integer type such as uchar",
                                      quotedWord(word)));
    }
    word = scanner.word();
  }
  const std::optional<Scalar> type = scalarNamed(word);
  if (!type) return scanner.fail(fmt::format("found {}, expected a type such as float or int", quotedWord(word)));
  property.type = *type;
  property.name = std::string(scanner.word());
  if (property.name.empty()) return scanner.fail("the line ends before the property's name");
  return property;
}

/// Reads up to and including the line end_header.
Result<PlyHeader> readPlyHeader(LineScanner& scanner) {
  if (!scanner.nextLine()) return scanner.failAtEnd("expected the word ply");
  if (const std::string_view word = scanner.word(); word != "ply") {
    return scanner.fail(fmt::format("found {}, expected the word ply", quotedWord(word)));
  }
  PlyHeader header;
  while (true) {
    if (!scanner.nextLine()) return scanner.failAtEnd("expected end_header");
    const std::string_view keyword = scanner.word();
    if (keyword == "end_header") break;
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      const std::string_view name = scanner.word();
      if (name == "ascii") header.encoding = Encoding::kAscii;
      if (name == "binary_little_endian") header.encoding = Encoding::kLittleEndian;
      if (name == "binary_big_endian") header.encoding = Encoding::kBigEndian;
      if (!header.encoding) {
        return scanner.fail(
            fmt::format("format {}, expected ascii, binary_little_endian or binary_big_endian", quotedWord(name)));
      }
    } else if (keyword == "element") {
      Element element;
      element.name = std::string(scanner.word());
      if (!scanner.integer(element.count))
        return scanner.error(fmt::format("the count of {}", quotedWord(element.name)));
      if (element.count < 0 || element.count > std::numeric_limits<VertexIndex>::max()) {
        return scanner.fail(fmt::format("element {} has a count of {}, expected 0 to {}", element.name, element.count,
                                        std::numeric_limits<VertexIndex>::max()));
      }
      for (const Element& other : header.elements) {
        if (other.name == element.name) return scanner.fail(fmt::format("a second element {}", element.name));
      }
      if (header.elements.size() == kMaxElements)
        return scanner.fail(fmt::format("more than {} elements", kMaxElements));
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) return scanner.fail("a property before the first element");
      LORICA_TRY(Property property, readProperty(scanner));
      std::vector<Property>& properties = header.elements.back().properties;
      if (properties.size() == kMaxProperties) {
        return scanner.fail(fmt::format("more than {} properties of one element", kMaxProperties));
      }
      properties.push_back(std::move(property));
    } else {
      return scanner.fail(
          fmt::format("found {} in the header, expected element, property or end_header", quotedWord(keyword)));
    }
  }
  if (!header.encoding) return scanner.fail("the header has no format line");
  return header;
}

/// Reads the numbers of a text body: one element per line.
class TextElements {
 public:
  explicit TextElements(LineScanner& scanner) : scanner_(scanner) {}

  std::optional<Error> checkSize(const Element&) { return std::nullopt; }
  [[nodiscard]] std::size_t atMost(std::int64_t count) const {
    return std::min<std::size_t>(count, scanner_.bytesLeft() / 6 + 1);
  }
  std::optional<Error> beginItem(const Element& element, std::int64_t index) {
    if (scanner_.nextLine()) return std::nullopt;
    return scanner_.failAtEnd(
        fmt::format("the header declares {} of element {}, found {}", element.count, element.name, index));
  }
  std::optional<Error> endItem(const Element& element, std::int64_t index) {
    if (scanner_.atLineEnd()) return std::nullopt;
    return scanner_.fail(fmt::format("found {} after {} {}, expected the end of the line", quotedWord(scanner_.word()),
                                     element.name, index));
  }
  std::optional<Error> endBody() {
    if (!scanner_.nextLine()) return std::nullopt;
    return scanner_.fail(
        fmt::format("found {} after the last element, expected the end of the file", quotedWord(scanner_.word())));
  }
  bool read(Scalar type, double& value) {
    if (!isInteger(type)) return scanner_.real(value);
    std::int64_t integer = 0;
    if (!scanner_.integer(integer)) return false;
    value = integer;
    return true;
  }
  bool skip(Scalar, std::int64_t count) {
    double missing = 0.0;
    for (std::int64_t i = 0; i < count; ++i) {
      // Accept any word: nan is harmless in a normal that is not used.
      if (scanner_.atLineEnd()) return scanner_.real(missing);
      (void)scanner_.word();
    }
    return true;
  }
  [[nodiscard]] Error error(std::string_view what) const { return scanner_.error(what); }
  [[nodiscard]] Error fail(std::string_view message) const { return scanner_.fail(message); }

 private:
  LineScanner& scanner_;
};

/// Reads the numbers of a binary body in sequence.
class BinaryElements {
 public:
  BinaryElements(std::string_view bytes, std::size_t fileSize, std::endian order, std::string fileName)
      : bytes_(bytes), fileSize_(fileSize), order_(order), fileName_(std::move(fileName)) {}

  /// Rejects a count that the rest of the file cannot hold, before anything is allocated.
  std::optional<Error> checkSize(const Element& element) {
    std::size_t min = 0;
    for (const Property& p : element.properties) min += sizeOf(p.countType.value_or(p.type));
    const std::size_t needed = min * element.count;
    if (needed <= bytes_.size()) return std::nullopt;
    return fail(fmt::format("{} of element {} need at least {} bytes, {} bytes are left", element.count, element.name,
                            needed, bytes_.size()));
  }
  [[nodiscard]] std::size_t atMost(std::int64_t count) const { return count; }
  std::optional<Error> beginItem(const Element&, std::int64_t) { return std::nullopt; }
  std::optional<Error> endItem(const Element&, std::int64_t) { return std::nullopt; }
  std::optional<Error> endBody() {
    if (bytes_.empty()) return std::nullopt;
    return fail(counted(std::ssize(bytes_), "byte is", "bytes are") +
                " left after the last element, expected the end of the file");
  }
  bool read(Scalar type, double& value) {
    if (sizeOf(type) > bytes_.size()) return false;
    value = kScalars[ordinalOf(type)].load(bytes_.data(), order_);
    if (!std::isfinite(value)) return false;
    bytes_.remove_prefix(sizeOf(type));
    return true;
  }
  bool skip(Scalar type, std::int64_t count) {
    if (static_cast<std::uint64_t>(count) > bytes_.size() / sizeOf(type)) return false;
    bytes_.remove_prefix(sizeOf(type) * count);
    return true;
  }
  [[nodiscard]] Error error(std::string_view what) const {
    return fail(fmt::format("{}: expected a finite number, {} left", what,
                            counted(std::ssize(bytes_), "byte is", "bytes are")));
  }
  [[nodiscard]] Error fail(std::string_view message) const {
    return badFormat("{}: byte {}: {}", fileName_, fileSize_ - bytes_.size(), message);
  }

 private:
  std::string_view bytes_;
  std::size_t fileSize_;
  std::endian order_;
  std::string fileName_;
};

/// Reads the length of a list, which must not be negative.
template <typename Body>
std::optional<Error> readLength(Body& body, const Property& property, const Element& element, std::int64_t index,
                                std::int64_t& length) {
  double value = 0.0;
  if (!body.read(*property.countType, value)) {
    return body.error(fmt::format("the length of {} of {} {}", property.name, element.name, index));
  }
  if (value < 0.0) {
    return body.fail(
        fmt::format("{} of {} {} has length {}, expected 0 or more", property.name, element.name, index, value));
  }
  length = value;
  return std::nullopt;
}

/// Skips a property that the mesh does not need.
template <typename Body>
std::optional<Error> skipProperty(Body& body, const Property& property, const Element& element, std::int64_t index) {
  std::int64_t count = 1;
  if (property.countType) {
    if (auto error = readLength(body, property, element, index, count)) return error;
  }
  if (body.skip(property.type, count)) return std::nullopt;
  return body.error(fmt::format("{} of {} {}", property.name, element.name, index));
}

template <typename Body>
std::optional<Error> readVertices(Body& body, const Element& element, TriMesh& mesh) {
  mesh.vertices.reserve(body.atMost(element.count));
  for (std::int64_t i = 0; i < element.count; ++i) {
    if (auto error = body.beginItem(element, i)) return error;
    Vec3 p;
    for (const Property& property : element.properties) {
      const bool isCoordinate = property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z';
      if (!isCoordinate) {
        if (auto error = skipProperty(body, property, element, i)) return error;
      } else if (!body.read(property.type, p[property.name[0] - 'x'])) {
        return body.error(fmt::format("{} of vertex {}", property.name, i));
      }
    }
    if (auto error = body.endItem(element, i)) return error;
    mesh.vertices.push_back(p);
  }
  return std::nullopt;
}

bool isCornerList(const Property& property) {
  return property.name == "vertex_indices" || property.name == "vertex_index";
}

template <typename Body>
std::optional<Error> readFaces(Body& body, const Element& element, std::int64_t vertexCount, TriMesh& mesh) {
  mesh.triangles.reserve(body.atMost(element.count));
  std::vector<VertexIndex> corners;
  for (std::int64_t i = 0; i < element.count; ++i) {
    if (auto error = body.beginItem(element, i)) return error;
    for (const Property& property : element.properties) {
      if (!isCornerList(property)) {
        if (auto error = skipProperty(body, property, element, i)) return error;
        continue;
      }
      std::int64_t length = 0;
      if (auto error = readLength(body, property, element, i, length)) return error;
      if (length < 3) return body.fail(fmt::format("face {} has {}, expected 3 or more", i, counted(length, "corner")));
      corners.clear();
      for (std::int64_t k = 0; k < length; ++k) {
        double index = 0.0;
        if (!body.read(property.type, index)) {
          return body.error(fmt::format("corner {} of {} of face {}", k, length, i));
        }
        if (index < 0.0 || index >= vertexCount) {
          return body.fail(fmt::format("face {}: vertex index {} is out of range, expected 0 to {} ({} vertices)", i,
                                       index, vertexCount - 1, vertexCount));
        }
        corners.push_back(index);
      }
      appendPolygon(corners, mesh.triangles);
    }
    if (auto error = body.endItem(element, i)) return error;
  }
  return std::nullopt;
}

template <typename Body>
Result<TriMesh> readBody(Body body, const PlyHeader& header, std::int64_t vertexCount) {
  TriMesh mesh;
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;  // occupies no bytes, whatever its count
    if (auto error = body.checkSize(element)) return *error;
    if (element.name == "vertex") {
      if (auto error = readVertices(body, element, mesh)) return *error;
    } else if (element.name == "face") {
      if (auto error = readFaces(body, element, vertexCount, mesh)) return *error;
    } else {
      for (std::int64_t i = 0; i < element.count; ++i) {
        if (auto error = body.beginItem(element, i)) return *error;
        for (const Property& property : element.properties) {
          if (auto error = skipProperty(body, property, element, i)) return *error;
        }
        if (auto error = body.endItem(element, i)) return *error;
      }
    }
  }
  if (auto error = body.endBody()) return *error;
  return mesh;
}

/// Checks that the header declares vertices with x, y, z and faces with a list of corners.
/// @return what is missing, or nothing
std::optional<std::string> missingInHeader(const PlyHeader& header) {
  const auto find = [&](std::string_view name) {
    return std::find_if(header.elements.begin(), header.elements.end(),
                        [&](const Element& e) { return e.name == name; });
  };
  const auto vertex = find("vertex");
  const auto face = find("face");
  if (vertex == header.elements.end()) return "the header has no element vertex";
  if (face == header.elements.end())
    return "the header has no element face: triangle strips and point clouds are not supported";
  for (const std::string_view axis : {"x", "y", "z"}) {
    const auto count = std::count_if(vertex->properties.begin(), vertex->properties.end(),
                                     [&](const Property& p) { return p.name == axis && !p.countType; });
    const auto all = std::count_if(vertex->properties.begin(), vertex->properties.end(),
                                   [&](const Property& p) { return p.name == axis; });
    if (count != 1 || all != 1)
      return fmt::format("element vertex has {} properties {}, expected one number", all, axis);
  }
  const auto lists = std::count_if(face->properties.begin(), face->properties.end(), isCornerList);
  const auto good = std::count_if(face->properties.begin(), face->properties.end(), [](const Property& p) {
    return isCornerList(p) && p.countType && isInteger(p.type);
  });
  if (lists != 1 || good != 1) {
    return fmt::format("element face has {} properties vertex_indices or vertex_index, expected one list of integers",
                       lists);
  }
  return std::nullopt;
}

}  // namespace

Result<TriMesh> parsePly(std::string_view content, const std::string& fileName) {
  LineScanner scanner(content, fileName, 0);
  LORICA_TRY(const PlyHeader header, readPlyHeader(scanner));
  if (const auto missing = missingInHeader(header)) return scanner.fail(*missing);
  std::int64_t vertexCount = 0;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") vertexCount = element.count;
  }
  if (*header.encoding == Encoding::kAscii) return readBody(TextElements(scanner), header, vertexCount);
  const std::endian order = *header.encoding == Encoding::kBigEndian ? std::endian::big : std::endian::little;
  return readBody(BinaryElements(scanner.afterLine(), content.size(), order, fileName), header, vertexCount);
}

}  // namespace lorica
