// SPDX-License-Identifier: Apache-2.0
// FieldSampler: the point and cell fields of a dataset at places in its cells, filled in from any thread in any order.
#pragma once
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Places to be evaluated together: for each the output tuple, the cell (-1: none), and ids and weights [begin[i], begin[i+1]).
struct SampleBlock {
  std::vector<size_t> to;
  std::vector<int64_t> cells;
  std::vector<uint32_t> begin{0};
  std::vector<int64_t> ids;
  std::vector<double> weights;

  size_t size() const { return to.size(); }
  void clear() { to.clear(), cells.clear(), begin.assign(1, 0), ids.clear(), weights.clear(); }
  void add(size_t out, int64_t cell, std::span<const int64_t> point_ids, std::span<const double> w) {
    to.push_back(out), cells.push_back(cell);
    ids.insert(ids.end(), point_ids.begin(), point_ids.end());
    weights.insert(weights.end(), w.begin(), w.end());
    begin.push_back(uint32_t(ids.size()));
  }
  void add_missing(size_t out) { to.push_back(out), cells.push_back(-1), begin.push_back(uint32_t(ids.size())); }
};

/// Point fields are combined as combine() of data/field_ops.h does (integers become f32, 64-bit ones f64), cell fields are copied from
/// the cell. Where there is no cell: NaN, integers 0. A cell field that has the name of a point field gets "_cell" behind it.
class FieldSampler {
 public:
  /// Room for `count` tuples. A PointCloud counts as cells of one point, with point fields only.
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
