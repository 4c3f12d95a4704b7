// The C interface by random sequences of calls: handles in any order, freed and not, null pointers, wrong sizes, absurd
// numbers. The bytes of an input are taken from its front. Decomposing is cancelled after a few parts.
#include "lorica.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace {

/// A failure must have a sentence, and success none of the library's own faults.
void check(lorica_status status) {
  if (status != LORICA_OK && std::strlen(lorica_last_error()) == 0) std::abort();
  if (status == LORICA_FAILURE && std::strstr(lorica_last_error(), "memory") == nullptr) {
    std::fprintf(stderr, "%s\n", lorica_last_error());
    std::abort();
  }
}

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}
  [[nodiscard]] bool any() const { return left_ > 0; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *at_++;
  }
  /// Mostly small, sometimes absurd.
  std::int32_t count() {
    constexpr std::array<std::int32_t, 6> kOdd = {
        -1, std::numeric_limits<std::int32_t>::min(), 1'000'000'000, std::numeric_limits<std::int32_t>::max(), 1 << 20,
        -7};
    const std::uint8_t b = byte();
    return b < 200 ? b % 8 : kOdd[b % kOdd.size()];
  }
  double number() {
    constexpr std::array<double, 10> kOdd = {0.0,   -1.0,  1e-300, 1e300, std::numeric_limits<double>::infinity(),
                                             1e107, 1e-12, 1e9,    -0.0,  std::numeric_limits<double>::quiet_NaN()};
    const std::uint8_t b = byte();
    return b < 220 ? (b - 100) / 40.0 : kOdd[b % kOdd.size()];
  }
  /// The right size of a struct, or now and then another one.
  std::size_t size(std::size_t right) {
    const std::uint8_t b = byte();
    return b < 240 ? right : b == 255 ? std::numeric_limits<std::size_t>::max() : b - 240;
  }
  bool rarely() { return byte() >= 248; }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

template <typename Handle>
using Pool = std::array<Handle*, 3>;

template <typename Handle>
Handle* pick(const Pool<Handle>& pool, Bytes& bytes) {
  return pool[bytes.byte() % pool.size()];
}

/// Puts a new handle in a place, and frees what was there.
template <typename Handle, typename Make, typename Free>
void renew(Pool<Handle>& pool, Bytes& bytes, const Make& make, const Free& free) {
  Handle*& place = pool[bytes.byte() % pool.size()];
  Handle* made = nullptr;
  const lorica_status status = make(bytes.rarely() ? nullptr : &made);
  check(status);
  if ((status == LORICA_OK) != (made != nullptr)) std::abort();
  free(place);
  place = made;
}

int fewCalls(void* calls, std::int32_t /*done*/, std::int32_t /*wanted*/) {
  return ++*static_cast<int*>(calls) < 6;
}

/// Shared by all inputs: they never change.
struct Fixed {
  lorica_character* mannequin = nullptr;
  lorica_body* body = nullptr;
  lorica_motion* motion = nullptr;
  std::string file;
};

const Fixed& fixed() {
  static const Fixed made = [] {
    Fixed all;
    check(lorica_character_read("mannequin", &all.mannequin));
    lorica_body_options options = {};
    options.size = sizeof options;
    options.parts = 3;
    check(lorica_body_make(all.mannequin, &options, &all.body));
    check(lorica_motion_read(all.mannequin, "wave", nullptr, &all.motion));
    all.file = "/tmp/lorica_fuzz_" + std::to_string(::getpid()) + ".lorica";
    check(lorica_body_save(all.body, all.file.c_str()));
    return all;
  }();
  return made;
}

class Program {
 public:
  explicit Program(Bytes bytes) : bytes_(bytes) {
    lives_ = {};
    for (int calls = 0; calls < 60 && bytes_.any(); ++calls) call();
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() {
    for (lorica_parts* parts : parts_) lorica_parts_free(parts);
    for (lorica_live* live : lives_) lorica_live_free(live);
    for (lorica_tracker* tracker : trackers_) lorica_tracker_free(tracker);
  }

 private:
  void call() {
    switch (bytes_.byte() % 16) {
      case 0:
        return decompose();
      case 1:
        return askParts();
      case 2:
        return renew(
            lives_, bytes_,
            [&](lorica_live** out) { return lorica_live_make(bytes_.rarely() ? nullptr : fixed().body, out); },
            lorica_live_free);
      case 3:
        return check(lorica_live_play(pick(lives_, bytes_), fixed().motion, bytes_.count()));
      case 4:
        return check(lorica_live_play_at(pick(lives_, bytes_), fixed().motion, bytes_.number()));
      case 5:
      case 6:
        return pose();
      case 7:
        return hull();
      case 8:
        return support();
      case 9:
        return contacts();
      case 10:
      case 11:
        return touches();
      case 12:
        return renew(
            trackers_, bytes_, [&](lorica_tracker** out) { return makeTracker(out); }, lorica_tracker_free);
      case 13:
        return track();
      case 14:
        return makeBody();
      default:
        return askCharacter();
    }
  }

  void decompose() {
    constexpr std::array<double, 24> kBox = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    constexpr std::array<std::int32_t, 36> kSides = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                                     1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    std::array<double, 24> xyz = kBox;
    std::array<std::int32_t, 36> corners = kSides;
    for (int change = bytes_.byte() % 4; change > 0; --change) xyz[bytes_.byte() % xyz.size()] = bytes_.number();
    if (bytes_.rarely()) corners[bytes_.byte() % corners.size()] = bytes_.count();
    lorica_mesh mesh = {};
    mesh.size = bytes_.size(sizeof mesh);
    mesh.vertices = bytes_.rarely() ? nullptr : xyz.data();
    mesh.vertex_count = bytes_.byte() % 9;
    mesh.triangles = bytes_.rarely() ? nullptr : corners.data();
    mesh.triangle_count = bytes_.byte() % 13;
    if (bytes_.byte() < 160) {
      mesh.vertex_count = 8;
      mesh.triangle_count = 12;
    }
    int calls = 0;
    lorica_decompose_options options = {};
    options.size = bytes_.size(sizeof options);
    options.parts = bytes_.count();
    options.preset = bytes_.count();
    options.max_error = bytes_.number();
    options.max_distance = bytes_.number();
    options.hull_vertices = bytes_.count();
    options.closed_body = bytes_.rarely() ? bytes_.count() : LORICA_CLOSED_NEVER;
    options.threads = bytes_.byte() < 128 ? 1 : bytes_.count();
    options.progress = fewCalls;
    options.user = &calls;
    renew(
        parts_, bytes_, [&](lorica_parts** out) { return lorica_decompose(&mesh, &options, out); }, lorica_parts_free);
  }

  void askParts() {
    const lorica_parts* parts = pick(parts_, bytes_);
    lorica_hull hull = {};
    hull.size = bytes_.size(sizeof hull);
    check(lorica_parts_hull(parts, bytes_.count(), bytes_.rarely() ? nullptr : &hull));
    (void)lorica_parts_count(parts);
    (void)lorica_parts_error(parts);
    (void)std::strlen(lorica_parts_repaired(parts));
    (void)std::strlen(lorica_parts_warning(parts));
  }

  void pose() {
    std::vector<double> matrices;
    for (std::size_t j = 0; j < lorica_character_joint_count(fixed().mannequin); ++j) {
      matrices.insert(matrices.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1});
    }
    for (int change = bytes_.byte() % 16; change > 0; --change) {
      matrices[(bytes_.byte() | bytes_.byte() << 8) % matrices.size()] = bytes_.number();
    }
    lorica_live* live = pick(lives_, bytes_);
    check(lorica_live_pose(live, bytes_.rarely() ? nullptr : matrices.data(),
                           bytes_.rarely() ? bytes_.byte() : matrices.size() / 16));
    check(lorica_live_transforms(live, matrices.data(), matrices.size() / 16));
  }

  void hull() {
    lorica_hull hull = {};
    hull.size = bytes_.size(sizeof hull);
    const lorica_status status = lorica_live_hull(pick(lives_, bytes_), bytes_.count(), &hull);
    check(status);
    if (status != LORICA_OK) return;
    double sum = 0.0;
    for (std::size_t t = 0; t < 3 * hull.triangle_count; ++t) {
      if (hull.triangles[t] < 0 || static_cast<std::size_t>(hull.triangles[t]) >= hull.vertex_count) std::abort();
    }
    for (std::size_t v = 0; v < 3 * hull.vertex_count; ++v) sum += hull.vertices[v];
    if (!std::isfinite(sum)) std::abort();
  }

  void support() {
    const std::array<double, 3> direction = {bytes_.number(), bytes_.number(), bytes_.number()};
    std::array<double, 3> point{};
    check(lorica_live_support(pick(lives_, bytes_), bytes_.count(), direction.data(), point.data()));
  }

  void contacts() {
    lorica_live* live = pick(lives_, bytes_);
    std::size_t count = 0;
    check(lorica_live_find_contacts(live, &count));
    lorica_contact contact = {};
    contact.size = bytes_.size(sizeof contact);
    check(lorica_live_contact(live, bytes_.count(), &contact));
  }

  void touches() {
    std::vector<double> points;
    for (int p = bytes_.byte() % 9; p > 0; --p) points.insert(points.end(), {bytes_.number(), bytes_.number(), 0.3});
    lorica_shape shape = {};
    shape.size = bytes_.size(sizeof shape);
    shape.points = points.data();
    shape.point_count = points.size() / 3;
    shape.radius = bytes_.number();
    lorica_live* live = pick(lives_, bytes_);
    std::size_t count = 0;
    check(lorica_live_find_touches(live, &shape, &count));
    lorica_touch touch = {};
    touch.size = bytes_.size(sizeof touch);
    check(lorica_live_touch(live, bytes_.count(), &touch));
  }

  lorica_status makeTracker(lorica_tracker** out) {
    lorica_tracker_options options = {};
    options.size = bytes_.size(sizeof options);
    options.width = bytes_.rarely() ? bytes_.count() : 32;
    options.height = bytes_.rarely() ? bytes_.count() : 24;
    options.horizontal_fov = bytes_.rarely() ? bytes_.number() : 0.0;
    options.vertical_fov = bytes_.rarely() ? bytes_.number() : 0.0;
    options.max_people = bytes_.count();
    return lorica_tracker_make(&options, out);
  }

  void track() {
    std::vector<std::uint16_t> depth(bytes_.rarely() ? bytes_.byte() : 32 * 24);
    for (std::size_t p = 0; p < depth.size(); ++p) depth[p] = bytes_.byte() * 32;
    lorica_tracker* tracker = pick(trackers_, bytes_);
    std::size_t people = 0;
    check(lorica_tracker_track(tracker, bytes_.rarely() ? bytes_.number() : ++seconds_, depth.data(), depth.size(),
                               &people));
    lorica_person person = {};
    person.size = bytes_.size(sizeof person);
    check(lorica_tracker_person(tracker, bytes_.count(), &person));
  }

  void makeBody() {
    int calls = 0;
    lorica_body_options options = {};
    options.size = bytes_.size(sizeof options);
    options.parts = bytes_.byte() < 200 ? -1 : bytes_.count();
    options.hull_vertices = bytes_.count();
    options.cover = bytes_.number();
    options.threads = bytes_.count();
    options.progress = [](void*, std::int32_t, std::int32_t) { return 0; };  // it takes seconds
    options.user = &calls;
    lorica_body* body = nullptr;
    if (options.parts == 0) options.parts = 1;  // that of the user's cache
    check(lorica_body_make(fixed().mannequin, &options, &body));
    lorica_body_free(body);
    check(lorica_body_load(fixed().mannequin, fixed().file.c_str(), &body));
    lorica_body_free(body);
  }

  void askCharacter() {
    const lorica_character* character = bytes_.rarely() ? nullptr : fixed().mannequin;
    (void)lorica_character_joint_name(character, bytes_.count());
    (void)lorica_character_joint_parent(character, bytes_.count());
    (void)lorica_character_clip_name(character, bytes_.count());
    (void)lorica_motion_time(bytes_.rarely() ? nullptr : fixed().motion, bytes_.count());
    lorica_motion_options options = {};
    options.size = bytes_.size(sizeof options);
    options.clip = bytes_.rarely() ? "Run" : nullptr;
    lorica_motion* motion = nullptr;
    if (options.clip != nullptr) check(lorica_motion_read(fixed().mannequin, "wave", &options, &motion));
    lorica_motion_free(motion);
  }

  Bytes bytes_;
  Pool<lorica_parts> parts_{};
  Pool<lorica_live> lives_{};
  Pool<lorica_tracker> trackers_{};
  double seconds_ = 0.0;
};

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*count*/, char*** /*words*/) {
  (void)fixed();  // takes longer than an input may
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Program program(Bytes(data, size));
  return 0;
}
