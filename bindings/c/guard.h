#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "bindings/c/lorica.h"
#include "geometry/convex_hull.h"
#include "geometry/errors.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string>

namespace lorica {

/// Keeps an error for lorica_last_error(). @return its status
lorica_status fail(const Error& error) noexcept;

/// Runs the body of a function of the interface. Nothing is thrown out of it.
/// @param body  returns Result<void>
template <typename Body>
lorica_status guarded(const Body& body) noexcept {
  try {
    const Result<void> done = body();
    return done ? LORICA_OK : fail(done.error());
  } catch (const std::bad_alloc&) {
    (void)fail(unsupported("out of memory"));
  } catch (const std::exception& thrown) {
    (void)fail(unsupported(std::string("unexpected: ") + thrown.what()));
  } catch (...) {
    (void)fail(unsupported("unexpected failure"));
  }
  return LORICA_FAILURE;
}

inline Result<void> given() {
  return {};
}
/// An error if a pointer is null. @param name  of the argument
/// @param others  likewise
template <typename... Others>
Result<void> given(const void* pointer, const char* name, const Others&... others) {
  if (pointer == nullptr) return invalidArgument("{} is null", name);
  return given(others...);
}

/// An error if an index is out of range. @param what  is counted
inline Result<void> inRange(std::size_t index, std::size_t count, const char* what) {
  if (index < count) return {};
  return invalidArgument("{} {}: found {} of them, counted from 0", what, index, count);
}

/// Checks a number of an enum from outside.
inline Result<void> checkChoice(int chosen, int last, const char* name) {
  if (chosen >= 0 && chosen <= last) return {};
  return invalidArgument("{}: found {}, expected 0 to {}", name, chosen, last);
}

/// Checks the size that a program gave for a struct.
template <typename Struct>
Result<void> checkSize(const Struct& given, const char* name) {
  if (given.size == sizeof(Struct)) return {};  // all structs are of their first version
  return invalidArgument(
      "{}.size: found {}, expected {}: set it to sizeof of the struct, and use a library that is not older than the "
      "header",
      name, given.size, sizeof(Struct));
}

/// What a program gave, with zeros where its version of the struct ends. @param given  null = all zeros
template <typename Struct>
Result<Struct> taken(const Struct* given, const char* name) {
  Struct whole = {};
  if (given == nullptr) return whole;
  LORICA_TRY_DO(checkSize(*given, name));
  std::memcpy(&whole, given, given->size);
  return whole;
}

/// Fills as much of a struct as the program knows.
template <typename Struct>
Result<void> handOut(Struct whole, Struct* out) {
  LORICA_TRY_DO(given(out, "out"));
  LORICA_TRY_DO(checkSize(*out, "out"));
  whole.size = out->size;
  std::memcpy(out, &whole, out->size);
  return {};
}

/// Lends a hull to a program.
[[nodiscard]] Result<void> handOut(const ConvexHull& hull, lorica_hull* out);

/// Writes a .lorica file to memory of a program, and how many bytes it has. @param bytes  null: only their number
[[nodiscard]] Result<void> handOut(const DecompositionFile& content, void* bytes, std::size_t room, std::size_t* count);

/// A function of the program as a callback of the library. @param progress  may be null
[[nodiscard]] DecomposeProgress progressFrom(lorica_progress progress, void* user);

}  // namespace lorica
