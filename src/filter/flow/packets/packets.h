// SPDX-License-Identifier: Apache-2.0
// Lines of many seeds at once, in packets of 16 particles that step together: RK4 and Dormand-Prince 4(5) in f32 grids and tetrahedra.
// A particle that ends makes room for the next seed. Each line is worked out by itself, in the order of operations that is written down in
// packet_tracer-inl.h: it is the same for any packet, number of threads and vector length. Internal to filter/flow.
//
// Places are kept as a cell and a place in it (grids) or as a pair of numbers (tetrahedra). Fixed steps are worked out in f32: lines agree
// with trace_line() to 1e-6 of the mesh's size, as far as the flow does not separate neighbours. Adaptive steps are worked out in f64:
// the rounding of f32 is a good part of the errors that they watch, and other steps make other lines at the kinks between cells.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/huge_allocator.h"
#include "filter/flow/trace.h"

namespace sg::packets {

constexpr size_t lanes = 16;

/// A point of a line: place less the input's origin, velocity, time and length since the seed.
struct Record {
  float x[3], v[3], time, arc;
};
struct Line {
  uint32_t item = 0;              ///< which seed
  const Record* first = nullptr;  ///< the seed's; in Lines::blocks
  size_t count = 0;               ///< 0: no velocity at the seed
  StopReason stop = StopReason::outside;
};
struct Lines {
  using Block = std::vector<Record, HugeAllocator<Record>>;
  std::vector<Line> lines;    ///< in the order in which they ended
  std::vector<Block> blocks;  ///< their records; never moved
  /// A copy of a whole line that stays where it is.
  const Record* keep(std::span<const Record> records) {
    constexpr size_t block = (size_t(1) << 20) / sizeof(Record);
    if (blocks.empty() || blocks.back().capacity() - blocks.back().size() < records.size())
      blocks.emplace_back().reserve(std::max(block, records.size()));
    Block& b = blocks.back();
    const size_t at = b.size();
    b.insert(b.end(), records.begin(), records.end());
    return b.data() + at;
  }
};

/// An f32 grid of 3D vectors, cells along all axes, fewer than 2^31 numbers.
struct GridInput {
  const float* v = nullptr;
  int32_t cells[3];
  int32_t stride[3];  ///< floats from one point to the next along each axis
  double to_grid[3][3], to_world[3][3];
  double length;  ///< of a cell
};
struct GridItem {
  int32_t cell[3];
  double f[3];  ///< in [0, 1]
};
void trace_grid(const GridInput& input, const TraceOptions& options, float sign, std::span<const GridItem> items, Lines& out);

/// Tetrahedra with f32 points and f32 3D vectors.
struct TetInput {
  const float* points = nullptr;
  const float* v = nullptr;
  const void* ids = nullptr;
  bool wide_ids = false;            ///< i64, else i32
  const int32_t* across = nullptr;  ///< four a cell, opposite to its corners
  /// A cell that holds a place (less the origin of the points) that the walk lost at a border, or -1.
  std::function<int64_t(Vec3)> locate;
};
struct TetItem {
  double x[3];
  int32_t cell;
};
/// `input.locate` is called by one thread for each call of this.
void trace_tets(const TetInput& input, const TraceOptions& options, float sign, std::span<const TetItem> items, Lines& out);

}  // namespace sg::packets
