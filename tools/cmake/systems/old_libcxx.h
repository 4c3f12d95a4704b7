#pragma once

// What libc++ 13, which emscripten 3.1.6 has, lacks of C++20 and the core uses. Included before everything else. Not
// needed from libc++ 15 on.

#ifdef __cplusplus
#include <algorithm>
#include <cstring>
#include <functional>
#include <iterator>
#include <type_traits>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000

namespace std {

#if _LIBCPP_VERSION < 14000
template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}
#endif

namespace ranges {

struct lorica_less {
  template <typename A, typename B>
  constexpr bool operator()(const A& a, const B& b) const {
    return a < b;
  }
};

template <typename Range, typename Less = lorica_less, typename Projection = std::identity>
void sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::sort(std::begin(range), std::end(range),
            [&](const auto& a, const auto& b) { return less(projection(a), projection(b)); });
}
template <typename Range, typename Less = lorica_less, typename Projection = std::identity>
void stable_sort(Range&& range, Less less = {}, Projection projection = {}) {
  std::stable_sort(std::begin(range), std::end(range),
                   [&](const auto& a, const auto& b) { return less(projection(a), projection(b)); });
}
template <typename Range, typename Value, typename Less = lorica_less, typename Projection = std::identity>
auto lower_bound(Range&& range, const Value& value, Less less = {}, Projection projection = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value,
                          [&](const auto& a, const Value& b) { return less(projection(a), b); });
}
template <typename Range, typename Value, typename Projection = std::identity>
auto find(Range&& range, const Value& value, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](const auto& a) { return std::invoke(projection, a) == value; });
}
template <typename Range>
bool is_sorted(Range&& range) {
  return std::is_sorted(std::begin(range), std::end(range));
}
template <typename Range, typename Others>
auto find_first_of(Range&& range, const Others& others) {
  return std::find_first_of(std::begin(range), std::end(range), std::begin(others), std::end(others));
}
template <typename Range, typename Value>
auto count(Range&& range, const Value& value) {
  return std::count(std::begin(range), std::end(range), value);
}
template <typename Range, typename Test>
bool any_of(Range&& range, Test test) {
  return std::any_of(std::begin(range), std::end(range), test);
}
template <typename Range, typename Test>
bool all_of(Range&& range, Test test) {
  return std::all_of(std::begin(range), std::end(range), test);
}
template <typename Range, typename Test>
bool none_of(Range&& range, Test test) {
  return std::none_of(std::begin(range), std::end(range), test);
}
template <typename Range, typename Test>
auto count_if(Range&& range, Test test) {
  return std::count_if(std::begin(range), std::end(range), test);
}
template <typename Range, typename Less = lorica_less, typename Projection = std::identity>
auto max_element(Range&& range, Less less = {}, Projection projection = {}) {
  return std::max_element(std::begin(range), std::end(range), [&](const auto& a, const auto& b) {
    return less(std::invoke(projection, a), std::invoke(projection, b));
  });
}
template <typename Range, typename Less = lorica_less, typename Projection = std::identity>
auto min_element(Range&& range, Less less = {}, Projection projection = {}) {
  return std::min_element(std::begin(range), std::end(range), [&](const auto& a, const auto& b) {
    return less(std::invoke(projection, a), std::invoke(projection, b));
  });
}
template <typename Range, typename Other>
bool equal(const Range& range, const Other& other) {
  return std::equal(std::begin(range), std::end(range), std::begin(other), std::end(other));
}
template <typename Range, typename Out>
auto copy(Range&& range, Out out) {
  return std::copy(std::begin(range), std::end(range), out);
}

}  // namespace ranges
}  // namespace std

#endif
#endif
