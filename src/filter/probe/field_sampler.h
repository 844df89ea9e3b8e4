// SPDX-License-Identifier: Apache-2.0
// FieldSampler: the point and cell fields of a dataset at places in its cells, filled in from any thread in any order.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Up to `capacity` places to be evaluated together: for each the output tuple, the cell (-1: none), and ids and weights [begin[i],
/// begin[i+1]).
struct SampleBlock {
  static constexpr size_t capacity = 256;
  size_t count = 0;
  std::array<size_t, capacity> to;
  std::array<int64_t, capacity> cells;
  std::array<uint32_t, capacity + 1> begin{};
  std::vector<int64_t> ids;  ///< as long as ever needed; only the first begin[count] count
  std::vector<double> weights;

  bool full() const { return count == capacity; }
  void add(size_t out, int64_t cell, std::span<const int64_t> point_ids, std::span<const double> w) {
    const size_t first = begin[count], n = point_ids.size();
    if (first + n > ids.size()) ids.resize(2 * (first + n)), weights.resize(2 * (first + n));
    std::copy_n(point_ids.data(), n, &ids[first]);
    std::copy_n(w.data(), n, &weights[first]);
    to[count] = out, cells[count] = cell;
    begin[++count] = uint32_t(first + n);
  }
  void add_missing(size_t out) {
    to[count] = out, cells[count] = -1;
    begin[count + 1] = begin[count];
    ++count;
  }
};

/// Point fields are combined as combine() of data/field_ops.h does (integers become f32, 64-bit ones f64), cell fields are copied from
/// the cell. Where there is no cell: NaN, integers 0. A cell field that has the name of a point field gets "_cell" behind it.
class FieldSampler {
 public:
  /// Allocates `count` tuples. A PointCloud counts as cells of one point, with point fields only.
  FieldSampler(const Dataset& from, size_t count);
  /// Blocks may be written at the same time when they write different tuples.
  void write(const SampleBlock& block);
  /// The fields, in the order of `from`, and the u8 point field "valid": 1 where there was a cell. Fields of the whole are added as they
  /// are.
  FieldSet take();

 private:
  struct Target {
    Field field;  // without its array
    Array from, to;
    std::byte* out;
  };
  template <class T>
  static void combine_block(const Target& t, const View<T>& v, const SampleBlock& block);
  static void copy_block(const Target& t, const SampleBlock& block);
  std::vector<Target> targets_;
  std::vector<Field> whole_;
  Array valid_;
  uint8_t* valid_out_ = nullptr;
};

}  // namespace sg
