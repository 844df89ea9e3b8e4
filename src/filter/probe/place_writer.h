// SPDX-License-Identifier: Apache-2.0
// PlaceWriter: places in cells, found by scan conversion, become values in blocks of a few hundred.
#pragma once
#include <vector>

#include "filter/probe/field_sampler.h"
#include "index/cell_probe.h"

namespace sg {

/// One per thread. Whatever was added is written at the latest by the destructor.
class PlaceWriter {
 public:
  PlaceWriter(CellProbe probe, const SimplexArrays& simplices, FieldSampler& out)
      : probe_(std::move(probe)), simplices_(simplices), out_(out) {}
  ~PlaceWriter() { flush(); }
  PlaceWriter(const PlaceWriter&) = delete;

  void add_missing(size_t to) {
    block_.add_missing(to);
    if (block_.full()) flush();
  }
  /// Output tuple, cell, reference coordinates, position.
  void add(size_t to, uint32_t cell, Vec3 rst, Vec3 x) {
    const SimplexArrays& s = simplices_;
    if (s.type(cell) == CellType::tetra) {
      const size_t b = s.cells.begin(cell);
      const IndexView& n = s.cells.connectivity;
      const int64_t ids[4] = {n[b], n[b + 1], n[b + 2], n[b + 3]};
      const double w[4] = {1 - rst.x - rst.y - rst.z, rst.x, rst.y, rst.z};
      block_.add(to, cell, ids, w);
    } else {
      add_any(to, cell, rst, x);
    }
    if (block_.full()) flush();
  }
  void flush() {
    if (block_.count > 0) out_.write(block_);
    block_.count = 0;
  }

 private:
  void add_any(size_t to, uint32_t cell, Vec3 rst, Vec3 x) {
    CellPlace place;
    place.rst = rst;
    // A place in a polygon or polyhedron is more than its reference coordinates.
    if (simplices_.type(cell) == CellType::empty) {
      const CellReader& reader = probe_.open(cell).reader();
      if (!CellShape::find(reader.type(), reader.ids().size(), reader.orders())) probe_.holds(cell, x, place);
    }
    probe_.weights(cell, place, ids_, weights_);
    block_.add(to, cell, ids_, weights_);
  }
  CellProbe probe_;
  const SimplexArrays& simplices_;
  FieldSampler& out_;
  SampleBlock block_;
  std::vector<int64_t> ids_;
  std::vector<double> weights_;
};

}  // namespace sg
