// SPDX-License-Identifier: Apache-2.0
// What the contour kernels hand to each other. Inside filter/scalar only.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "data/dataset.h"
#include "data/field_ops.h"
#include "filter/field/derivatives/lattice_frame.h"
#include "filter/scalar/contour/lattice/contour_bits.h"
#include "filter/scalar/contour/lattice/contour_rows.h"

namespace sg {
struct CellActiveIndex;
}

namespace sg::contouring {

/// Uninitialised numbers: results are written once, in parallel.
template <class T>
struct Block {
  Array bytes;
  T* data = nullptr;
  size_t count = 0;
  void allocate(size_t n) {
    std::byte* p = nullptr;
    bytes = Array::make_raw(ElementType::u8, n * sizeof(T), 1, &p);
    data = reinterpret_cast<T*>(p), count = n;
  }
  std::span<const T> span() const { return {data, count}; }
};

/// A point inside a lattice cell whose lowest corner is point `base`.
struct InnerPoint {
  size_t base;
  float at[3];  ///< u, v, w in (0,1)
};

/// One isovalue's surface: the points on edges, then those inside cells.
struct Piece {
  Array xyz;      ///< f32, relative to Job::origin
  Array normals;  ///< f32, or empty
  Block<EdgePoint> points;
  Block<InnerPoint> inner;
  std::array<ptrdiff_t, 3> stride{};             ///< of the inner points' corners
  Block<std::array<uint32_t, 8>> inner_corners;  ///< not on lattices: the corners themselves
  Array lines, triangles;                        ///< i32 connectivity, 2 and 3 per cell
  Block<uint32_t> line_cells, triangle_cells;    ///< source cell of each; empty when not requested

  size_t first_point = 0;  ///< what the connectivity's numbers already count from
  size_t point_count() const { return points.count + inner.count; }
};

/// The question, for all values.
struct Job {
  const Dataset& input;
  Array samples;  ///< u8, i8, u16, i16, f32 or f64; one component, packed
  bool normals = true;
  bool cells = true;  ///< record source cells
  bool trilinear = true;
  bool edges = true;  ///< record edge points: there are fields to carry besides the contoured one (lattices only)
  Vec3 origin;        ///< of the result's points
  Context& context;
};

/// A sample as double, for the few places that need one at a time.
class Sample {
 public:
  explicit Sample(const Array& a) : data_(a.raw()), type_(a.type()) {}
  double operator()(size_t i) const {
    switch (type_) {
      case ElementType::u8: return double(reinterpret_cast<const uint8_t*>(data_)[i]);
      case ElementType::i8: return double(reinterpret_cast<const int8_t*>(data_)[i]);
      case ElementType::u16: return double(reinterpret_cast<const uint16_t*>(data_)[i]);
      case ElementType::i16: return double(reinterpret_cast<const int16_t*>(data_)[i]);
      case ElementType::f32: return double(reinterpret_cast<const float*>(data_)[i]);
      default: return reinterpret_cast<const double*>(data_)[i];
    }
  }

 private:
  const std::byte* data_;
  ElementType type_;
};

/// Where the value lies between two samples of different sides; an infinite sample counts as far away.
inline double crossing(double value, double a, double b) {
  const double t = (value - a) / (b - a);
  return t >= 0 && t <= 1 ? t : 0.5;
}

struct LatticeIndex;

/// Kernels on lattices of two or three axes; make one for all values.
class LatticeContour {
 public:
  /// `index`: what is known from earlier contours, or null.
  explicit LatticeContour(const Job& job, std::shared_ptr<const LatticeIndex> index = nullptr);
  std::vector<Piece> run(std::span<const double> values);

 private:
  struct Cuts;
  struct Room;
  struct Slow;
  void skip_points(const std::vector<uint64_t>& bad);
  void find_cuts(Cuts& cuts) const;
  bool simple() const { return frame_.axes == 3 && skip_.empty(); }
  bool may_cut(const Cuts& cuts, size_t j, size_t k) const;
  void count_row(Cuts& cuts, size_t j, size_t k) const;
  void count_simple_row(Cuts& cuts, size_t j, size_t k, uint64_t* odd) const;
  void count_cell(const Cuts& cuts, RowStart& row, uint32_t pattern, size_t p) const;
  Piece generate(const Cuts& cuts, Room& room) const;
  struct Writing;
  void simple_triangles_of_row(const Cuts& cuts, size_t j, size_t k, uint32_t first_point, int32_t* out, uint32_t* cells,
                               InnerPoint* inner) const;
  void triangles_of_row(const Cuts& cuts, size_t j, size_t k, uint32_t first_point, int32_t* out, uint32_t* cells, InnerPoint* inner) const;
  void lines_of_row(const Cuts& cuts, size_t j, uint32_t first_point, int32_t* out, uint32_t* cells) const;

  const Job& job_;
  std::shared_ptr<const LatticeIndex> index_;
  Lattice lattice_;
  LatticeFrame frame_;
  Sample sample_;
  size_t words_ = 0;  ///< 64-bit words per row of bits
  bool missing_known_ = false, flip_ = false;
  const CellTables* tables_ = nullptr;
  std::vector<uint64_t> skip_;  ///< bit per cell that must not be looked at, in rows like the points; empty when all are good
};

/// Fills positions, normals and edge points of all cut edges. `cut[a]` has a bit per edge along axis a; null: all edges whose ends differ.
struct VertexJob {
  const LatticeFrame& frame;
  const Array& samples;
  double value;
  Vec3 origin;
  size_t words;
  const uint64_t* inside;
  const Plane<uint64_t>* cut;  ///< 3, or null
  const Plane<RowStart>& rows;
  float* xyz;
  float* normals;     ///< null: none
  EdgePoint* points;  ///< null: none
  Context& context;
  std::span<const InnerPoint> inner;  ///< their positions and normals follow those of the edges
  size_t inner_first;
};
void make_vertices(const VertexJob& job);

/// Point array `a` at the inner points, trilinear, in its own type (integers round to nearest).
void interpolate_inner(const Array& a, const Piece& piece, std::byte* out);

/// Unstructured and surface meshes. `index`: what is known from earlier contours, or null.
Piece contour_cells(const Job& job, double value, const CellActiveIndex* index = nullptr);

/// Where rows of bits go, and what each holds.
struct RowsOut {
  uint64_t* bits;
  RowState* state;
};
/// Sets bit i of row r of out[v] for samples >= values[v]. Returns true when a sample was NaN.
bool classify(const Array& samples, size_t nx, size_t rows, std::span<const double> values, std::span<const RowsOut> out, size_t words,
              Context& context);
/// The same for one value, where the ranges are known.
void classify_known(const Array& samples, size_t nx, size_t rows, const StretchRanges& ranges, double value, RowsOut out, size_t words,
                    Context& context);
/// One pass over the samples. `missing`: whether one is NaN.
StretchRanges find_ranges(const Array& samples, size_t nx, size_t rows, bool& missing, Context& context);
/// Sets the bit of samples that are NaN.
void find_missing(const Array& samples, size_t nx, size_t rows, uint64_t* bits, size_t words, Context& context);

}  // namespace sg::contouring
