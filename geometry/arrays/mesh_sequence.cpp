#include "geometry/arrays/mesh_sequence.h"

#include "geometry/arrays/array_file.h"
#include "geometry/arrays/same_mesh.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_formats.h"
#include "geometry/parallel_progress.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kMeshEndings = {".obj", ".off", ".ply", ".stl"};
constexpr std::array<std::string_view, 3> kCacheEndings = {".pc2", ".mdd", ".npy"};
constexpr std::array<std::string_view, 5> kSceneEndings = {".abc", ".usd", ".usda", ".usdc", ".usdz"};
constexpr std::size_t kBlock = 16;  // files that are read before they are compared

std::string endingOf(const fs::path& file) {
  return lowerCase(file.extension().string());
}

bool isOne(std::string_view ending, std::span<const std::string_view> of) {
  return std::ranges::find(of, ending) != of.end();
}

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

/// Whether a name fits a pattern, in which * stands for any letters and ? for one.
bool fits(std::string_view name, std::string_view pattern) {
  std::size_t n = 0, p = 0, star = std::string_view::npos, from = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      from = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++n, ++p;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++from;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

bool isPattern(const std::string& input) {
  std::error_code ignored;
  return fs::path(input).filename().string().find_first_of("*?") != std::string::npos && !fs::exists(input, ignored);
}

/// The files of a folder whose names fit a pattern, in order.
Result<std::vector<fs::path>> filesOf(const fs::path& folder, const std::string& pattern) {
  std::error_code error;
  std::vector<fs::path> files;
  fs::directory_iterator entries(folder, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const fs::path& file = entries->path();
    const std::string name = file.filename().string();
    if (name.starts_with('.') || !fits(name, pattern)) continue;
    if (isOne(endingOf(file), kMeshEndings)) files.push_back(file);
    if (files.size() > kMaxSequenceFrames) {
      return unsupported("{}: has more than {} meshes, expected at most that many frames", folder.string(),
                         kMaxSequenceFrames);
    }
  }
  if (error) return unreadable("{}: cannot be read: {}", folder.string(), error.message());
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return comesBefore(a.filename().string(), b.filename().string());
  });
  return files;
}

/// Adds a frame to those before it.
Result<void> add(TriMesh mesh, const fs::path& file, MeshSequence& sequence, int& mended) {
  const std::string& first = sequence.files.front();
  const std::size_t points = sequence.vertexCount, triangles = sequence.triangles.size();
  if (mesh.vertices.size() != points || mesh.triangles.size() != triangles) {
    return badMesh("{}: {} and {}, expected {} and {} as in {}: the frames of a sequence have the same triangles",
                   file.string(), counted(std::ssize(mesh.vertices), "point"),
                   counted(std::ssize(mesh.triangles), "triangle"), points, triangles, first);
  }
  if (mesh.triangles != sequence.triangles) {
    const std::optional<std::vector<VertexIndex>> order =
        sameMesh(sequence.triangles, sequence.frame(sequence.frameCount() - 1), mesh);
    if (!order) {
      return badMesh("{}: its triangles join other points than those of {}: the frames of a sequence have the same",
                     file.string(), first);
    }
    ++mended;
    for (const VertexIndex v : *order) sequence.positions.push_back(mesh.vertices[v]);
  } else {
    sequence.positions.insert(sequence.positions.end(), mesh.vertices.begin(), mesh.vertices.end());
  }
  sequence.files.push_back(file.filename().string());
  return {};
}

/// For each point the first one that is where it is in every frame.
std::vector<VertexIndex> firstAlike(const MeshSequence& sequence) {
  std::vector<std::uint64_t> hashes(sequence.vertexCount, 0);
  for (int f = 0; f < sequence.frameCount(); ++f) {
    const std::span<const Vec3> points = sequence.frame(f);
    for (std::size_t v = 0; v < points.size(); ++v) {
      const Vec3 p = points[v] + Vec3::Zero();  // -0 is 0
      hashes[v] = contentHash({reinterpret_cast<const char*>(p.data()), sizeof(double) * 3}, hashes[v]);
    }
  }
  std::unordered_multimap<std::uint64_t, VertexIndex> seen;
  std::vector<VertexIndex> first(hashes.size());
  for (std::size_t v = 0; v < first.size(); ++v) {
    first[v] = static_cast<VertexIndex>(v);
    const auto [begin, end] = seen.equal_range(hashes[v]);
    const auto alike = std::find_if(begin, end, [&](const auto& other) {
      for (int f = 0; f < sequence.frameCount(); ++f) {
        if (sequence.frame(f)[v] != sequence.frame(f)[other.second]) return false;
      }
      return true;
    });
    if (alike != end) {
      first[v] = alike->second;
    } else {
      seen.emplace(hashes[v], first[v]);
    }
  }
  return first;
}

/// Makes one of points that are equal in every frame, as readMesh() does with those of one frame.
void weld(MeshSequence& sequence) {
  const auto open = [&](std::vector<Triangle> triangles) {
    return openEdgeCount({std::vector<Vec3>(sequence.vertexCount), std::move(triangles)});
  };
  const std::size_t before = open(sequence.triangles);
  if (before == 0) return;
  const std::vector<VertexIndex> first = firstAlike(sequence);
  std::vector<VertexIndex> number(first.size());
  std::vector<VertexIndex> kept;
  for (std::size_t v = 0; v < first.size(); ++v) {
    number[v] = first[v] == static_cast<VertexIndex>(v) ? countOf(kept) : number[first[v]];
    if (first[v] == static_cast<VertexIndex>(v)) kept.push_back(first[v]);
  }
  std::vector<Triangle> welded = sequence.triangles;
  for (Triangle& t : welded) {
    for (VertexIndex& v : t) v = number[v];
  }
  std::erase_if(welded, hasRepeatedCorner);
  if (kept.size() == first.size() || open(welded) >= before) return;
  std::vector<Vec3> positions;
  positions.reserve(kept.size() * sequence.frameCount());
  for (int f = 0; f < sequence.frameCount(); ++f) {
    for (const VertexIndex v : kept) positions.push_back(sequence.frame(f)[v]);
  }
  sequence.positions = std::move(positions);
  sequence.triangles = std::move(welded);
  sequence.vertexCount = countOf(kept);
}

/// The points of all frames as a file has them.
struct PointCache {
  std::vector<double> numbers;  // frames x points x 3
  std::size_t frames = 0, points = 0;
};

Result<PointCache> pointCache(std::size_t frames, std::size_t points, std::string_view floats, std::endian order,
                              const std::string& file) {
  if (frames == 0 || points == 0) return badFormat("{}: found {} frames of {} points", file, frames, points);
  if (frames > kMaxSequencePoints / points) {
    return unsupported("{}: {} frames of {} points, expected at most {} points in all", file, grouped(frames),
                       grouped(points), grouped(kMaxSequencePoints));
  }
  const std::size_t expected = frames * points * 3 * sizeof(float);
  if (floats.size() != expected) {
    return badFormat("{}: found {} bytes of points, expected {} for {} frames of {}", file, floats.size(), expected,
                     frames, points);
  }
  PointCache cache{{}, frames, points};
  cache.numbers.reserve(floats.size() / sizeof(float));
  for (std::size_t at = 0; at < floats.size(); at += sizeof(float)) {
    cache.numbers.push_back(loadBytes<float>(floats.data() + at, order));
  }
  return cache;
}

/// http://mattebb.com/projects/bpython/pointcache/pc2.html: 12 bytes of name, then version, points, start, rate,
/// frames.
Result<PointCache> parsePc2(std::string_view bytes, const std::string& file) {
  if (!bytes.starts_with(std::string_view("POINTCACHE2\0", 12)) || bytes.size() < 32) {
    return badFormat("{}: does not begin as a point cache does: POINTCACHE2", file);
  }
  const auto points = loadLittleEndian<std::int32_t>(bytes.data() + 16),
             frames = loadLittleEndian<std::int32_t>(bytes.data() + 28);
  return pointCache(std::max(frames, 0), std::max(points, 0), bytes.substr(32), std::endian::little, file);
}

/// LightWave's: big-endian, frames, points, the time of each frame, points.
Result<PointCache> parseMdd(std::string_view bytes, const std::string& file) {
  const auto count = [&](std::size_t at) -> std::size_t {
    return bytes.size() < at + 4 ? 0 : std::max(loadBytes<std::int32_t>(bytes.data() + at, std::endian::big), 0);
  };
  const std::size_t frames = count(0), points = count(4), head = 8 + 4 * frames;
  if (bytes.size() < head) return badFormat("{}: ends before the times of {} frames", file, frames);
  return pointCache(frames, points, bytes.substr(head), std::endian::big, file);
}

std::string shapeOf(const NamedArray& array) {
  return fmt::format("{} ({})", printable(array.name, 40), fmt::join(array.shape, ", "));
}

bool isWhole(const NamedArray& array) {
  return array.type.size() > 1 && (array.type[1] == 'i' || array.type[1] == 'u');
}

/// Points in an array: (frames, points, 3), or (points, 3) of one frame.
Result<PointCache> pointsOf(const NamedArray& array, const std::string& file) {
  const std::size_t rank = array.shape.size();
  if (rank < 2 || rank > 3 || array.shape.back() != 3 || isWhole(array)) {
    return badFormat("{}: found the array {}, expected points (frames, points, 3)", file, shapeOf(array));
  }
  const std::size_t frames = rank == 3 ? array.shape[0] : 1, points = array.shape[rank - 2];
  if (frames == 0 || points == 0 || frames > kMaxSequencePoints / points) {
    return unsupported("{}: found {} frames of {} points, expected 1 to {} in all", file, frames, points,
                       grouped(kMaxSequencePoints));
  }
  LORICA_TRY(std::vector<double> numbers, prefixed(file, numbersOf(array)));
  return PointCache{std::move(numbers), frames, points};
}

void take(PointCache&& cache, MeshSequence& sequence) {
  sequence.vertexCount = static_cast<int>(cache.points);
  sequence.positions.clear();
  sequence.positions.reserve(cache.numbers.size() / 3);
  for (std::size_t i = 0; i < cache.numbers.size(); i += 3) {
    sequence.positions.emplace_back(cache.numbers[i], cache.numbers[i + 1], cache.numbers[i + 2]);
  }
}

/// The array that is meant: the only one that is possible, or the one with a usual name.
Result<const NamedArray*> chosen(std::span<const NamedArray> arrays, std::initializer_list<std::string_view> names,
                                 const std::string& file, const char* expected,
                                 const std::function<bool(const NamedArray&)>& possible) {
  std::vector<const NamedArray*> found;
  for (const NamedArray& array : arrays) {
    if (possible(array)) found.push_back(&array);
  }
  if (found.size() == 1) return found.front();
  for (const std::string_view name : names) {
    for (const NamedArray* array : found) {
      if (lowerCase(array->name) == name) return array;
    }
  }
  std::vector<std::string> shapes;
  for (const NamedArray& array : arrays) shapes.push_back(shapeOf(array));
  return badFormat("{}: found {}, expected {}", file, fmt::join(shapes, ", "), expected);
}

Result<MeshSequence> readArchive(const fs::path& path) {
  const std::string file = path.string();
  LORICA_TRY(const std::vector<NamedArray> arrays, readArrays(path));
  const auto rowsOfThree = [](const NamedArray& array) { return array.shape.size() > 1 && array.shape.back() == 3; };
  LORICA_TRY(const NamedArray* points,
             chosen(arrays, {"vertices", "verts", "positions", "points", "v"}, file,
                    "one array of points (frames, points, 3), such as `vertices`", [&](const NamedArray& array) {
                      return rowsOfThree(array) && !isWhole(array) && array.shape.size() == 3;
                    }));
  LORICA_TRY(const NamedArray* faces,
             chosen(arrays, {"faces", "triangles", "indices", "f"}, file,
                    "one array of whole numbers (triangles, 3), such as `faces`", [&](const NamedArray& array) {
                      return rowsOfThree(array) && isWhole(array) && array.shape.size() == 2;
                    }));
  MeshSequence sequence;
  LORICA_TRY(PointCache cache, pointsOf(*points, file));
  take(std::move(cache), sequence);
  LORICA_TRY(const std::vector<double> corners, prefixed(file, numbersOf(*faces)));
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    Triangle& t = sequence.triangles.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const double corner = corners[i + c];
      if (!(corner >= 0.0 && corner < sequence.vertexCount)) {
        return badMesh("{}: triangle {}: found point {:.0f}, expected 0 to {}", file, i / 3, corner,
                       sequence.vertexCount - 1);
      }
      t[c] = static_cast<VertexIndex>(corner);
    }
  }
  for (const NamedArray& array : arrays) {
    const Result<std::vector<double>> rate = numbersOf(array);
    if (lowerCase(array.name) != "fps" || !rate || rate->size() != 1) continue;
    if (!(rate->front() > 0.0 && rate->front() <= 1000.0)) {
      return badFormat("{}: found fps {:g}, expected a number up to 1000", file, rate->front());
    }
    sequence.framesPerSecond = rate->front();
  }
  return sequence;
}

/// The points of a cache and the triangles of the mesh beside it.
Result<MeshSequence> readCache(const fs::path& path) {
  const std::string file = path.string();
  fs::path beside = path;
  const auto isThere = [&](std::string_view ending) {
    std::error_code ignored;
    return fs::is_regular_file(beside.replace_extension(ending), ignored);
  };
  if (std::ranges::none_of(kMeshEndings, isThere)) {
    return notFound("{}: has points alone, expected their mesh beside it: {}", file,
                    beside.replace_extension(".obj").string());
  }
  LORICA_TRY(TriMesh mesh, readStoredMesh(beside));
  PointCache cache;
  if (endingOf(path) == ".npy") {
    LORICA_TRY(const std::vector<NamedArray> arrays, readArrays(path));
    LORICA_TRY(cache, pointsOf(arrays.front(), file));
  } else {
    LORICA_TRY(const std::string bytes, readFile(path, NamedBy::kUser, kMaxArrayBytes));
    LORICA_TRY(cache, (endingOf(path) == ".pc2" ? parsePc2 : parseMdd)(bytes, file));
  }
  if (cache.points != mesh.vertices.size()) {
    return badMesh("{}: {} points in a frame, expected {} as in {}", file, cache.points, mesh.vertices.size(),
                   beside.filename().string());
  }
  MeshSequence sequence;
  take(std::move(cache), sequence);
  sequence.triangles = std::move(mesh.triangles);
  return sequence;
}

}  // namespace

Result<std::vector<fs::path>> meshesOf(const std::string& input) {
  const fs::path path(input);
  const bool pattern = isPattern(input);
  const fs::path folder = !pattern ? path : path.has_parent_path() ? path.parent_path() : fs::path(".");
  LORICA_TRY(std::vector<fs::path> files, filesOf(folder, pattern ? path.filename().string() : "*"));
  if (files.empty()) {
    return notFound("{}: no mesh {}, expected a frame in each file (.obj, .off, .ply, .stl)", input,
                    pattern ? "has such a name" : "is in this folder");
  }
  for (const fs::path& file : files) {
    if (endingOf(file) == endingOf(files.front())) continue;
    return invalidArgument("{}: has {} and {}, expected the frames of one mesh: name them by a pattern such as '{}'",
                           input, files.front().filename().string(), file.filename().string(),
                           (folder / ("*" + endingOf(file))).string());
  }
  return files;
}

bool comesBefore(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto number = [](const std::string& text, std::size_t& at) {
    const std::size_t begin = std::min(text.find_first_not_of('0', at), text.size());
    for (at = begin; at < text.size() && isDigit(text[at]);) ++at;
    return std::string_view(text).substr(begin, at - begin);
  };
  while (i < a.size() && j < b.size()) {
    if (isDigit(a[i]) && isDigit(b[j])) {
      const std::string_view first = number(a, i), second = number(b, j);
      if (first.size() != second.size()) return first.size() < second.size();
      if (first != second) return first < second;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i, ++j;
    }
  }
  return std::pair(a.size() - i, std::string_view(a)) < std::pair(b.size() - j, std::string_view(b));
}

bool namesSequence(const std::string& input) {
  std::error_code ignored;
  const std::string ending = endingOf(input);
  return isPattern(input) || fs::is_directory(input, ignored) || ending == ".npz" || isOne(ending, kCacheEndings) ||
         isOne(ending, kSceneEndings);
}

Result<MeshSequence> readMeshSequence(const std::string& input, const SequenceProgress& progress) {
  const fs::path path(input);
  const std::string ending = endingOf(path);
  const fs::path folder = path.parent_path().filename();
  const fs::path last = isPattern(input) ? folder / path.filename() : path.has_filename() ? path.filename() : folder;
  std::error_code ignored;
  if (isPattern(input) || fs::is_directory(path, ignored)) {
    LORICA_TRY(const std::vector<fs::path> files, meshesOf(input));
    return readMeshSequence(last.string(), files, progress);
  }
  if (isOne(ending, kSceneEndings)) {
    return unsupported(
        "{}: {} is not read: open it in Blender, select the mesh and export Wavefront (.obj) with Animation, which "
        "writes a file a frame: bpy.ops.wm.obj_export(filepath='frames/f.obj', export_animation=True)",
        input, ending == ".abc" ? "Alembic" : "USD");
  }
  LORICA_TRY(MeshSequence sequence, ending == ".npz" ? readArchive(path) : readCache(path));
  sequence.name = last.string();
  return prefixed(input, checkedSequence(std::move(sequence)));
}

Result<MeshSequence> readMeshSequence(const std::string& name, std::span<const fs::path> frames,
                                      const SequenceProgress& progress) {
  if (frames.size() > kMaxSequenceFrames) {
    return unsupported("{}: {} frames, expected at most {}", name, grouped(frames.size()), kMaxSequenceFrames);
  }
  MeshSequence sequence;
  sequence.name = name;
  int mended = 0;
  for (std::size_t from = 0; from < frames.size(); from += kBlock) {
    std::vector<std::optional<Result<TriMesh>>> block(std::min(kBlock, frames.size() - from));
    inParallel(block.size(), 0, {}, [&](std::size_t i) { block[i].emplace(readStoredMesh(frames[from + i])); });
    for (std::size_t i = 0; i < block.size(); ++i) {
      const fs::path& file = frames[from + i];
      if (!*block[i]) return block[i]->error();
      TriMesh& mesh = **block[i];
      if (sequence.files.empty()) {
        sequence.files.push_back(file.filename().string());
        sequence.vertexCount = countOf(mesh.vertices);
        sequence.triangles = std::move(mesh.triangles);
        sequence.positions = std::move(mesh.vertices);
        if (frames.size() > kMaxSequencePoints / sequence.positions.size()) {
          return unsupported("{}: {} frames of {} points, expected at most {} points in all", name,
                             grouped(frames.size()), grouped(sequence.vertexCount), grouped(kMaxSequencePoints));
        }
        sequence.positions.reserve(frames.size() * sequence.positions.size());
      } else {
        LORICA_TRY_DO(add(std::move(mesh), file, sequence, mended));
      }
    }
    if (progress && !progress(static_cast<int>(from + block.size()), static_cast<int>(frames.size()))) {
      return cancelled();
    }
  }
  if (mended > 0) {
    sequence.notes.push_back(fmt::format("{} had the points or triangles of {} in another order",
                                         counted(mended, "frame"), sequence.files.front()));
  }
  return prefixed(name, checkedSequence(std::move(sequence)));
}

Result<MeshSequence> checkedSequence(MeshSequence sequence) {
  if (sequence.vertexCount < 1 || sequence.positions.empty()) return badMesh("no points, expected at least one frame");
  if (sequence.triangles.empty()) return badMesh("no triangles, expected a surface");
  if (std::cmp_greater(sequence.frameCount(), kMaxSequenceFrames) || sequence.positions.size() > kMaxSequencePoints) {
    return unsupported("{} frames of {} points, expected at most {} frames and {} points in all",
                       grouped(sequence.frameCount()), grouped(sequence.vertexCount), grouped(kMaxSequenceFrames),
                       grouped(kMaxSequencePoints));
  }
  for (std::size_t i = 0; i < sequence.positions.size(); ++i) {
    const Vec3& p = sequence.positions[i];
    if (p.allFinite()) continue;
    return badMesh("frame {}, point {}: found ({}, {}, {}), expected finite numbers", i / sequence.vertexCount,
                   i % sequence.vertexCount, p.x(), p.y(), p.z());
  }
  weld(sequence);
  return sequence;
}

}  // namespace lorica
