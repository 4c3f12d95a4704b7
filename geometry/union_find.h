#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lorica {

/// Disjoint sets of numbers from 0 on. A set is known by its smallest.
class UnionFind {
 public:
  UnionFind() = default;
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  [[nodiscard]] std::size_t count() const { return parent_.size(); }
  void reserve(std::size_t count) { parent_.reserve(count); }
  void clear() { parent_.clear(); }
  /// Adds the next number, in a set of its own.
  [[nodiscard]] std::int32_t add() { return parent_.emplace_back(static_cast<std::int32_t>(parent_.size())); }

  [[nodiscard]] std::int32_t find(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    (a < b ? parent_[b] : parent_[a]) = a < b ? a : b;
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace lorica
