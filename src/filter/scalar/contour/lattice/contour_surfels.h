// SPDX-License-Identifier: Apache-2.0
// Places and normals in the cells that a surface cuts, for surfels; on axis-parallel uniform grids.
#pragma once
#include <optional>

#include "base/context.h"
#include "data/dataset.h"

namespace sg::contouring {

struct SurfelPlaces {
  Array xyz, normals;          ///< f32, xyz relative to `origin`
  std::vector<int64_t> cells;  ///< empty when not requested
};

/// One place per cell with samples on both sides of the value, in the order of the cells: two Newton steps on the trilinear function from
/// the middle of the cell, held within it, and the unit normal there, towards the smaller values, from central differences (at the border
/// of the grid from the cell's own slopes). `samples`: packed, one component, one of u8 i8 u16 i16 f32 f64. Nothing when a sample is NaN,
/// or the lattice is not uniform, axis-parallel and of three axes.
std::optional<SurfelPlaces> surfel_places(const Dataset& input, const Array& samples, double value, Vec3 origin, bool cells,
                                          Context& context);

/// For the kernel: rows of cells, of which row r has its first place at first[r].
struct SurfelRows {
  const Array& samples;
  double value;
  Vec3 first, step;
  size_t nx, ny, nz, words;
  const uint64_t* inside;
  const size_t* place;  ///< per row of points
  float *xyz, *normals;
  int64_t* cells;
};
/// (end - begin + 4 ny) * nx must be less than 2^31.
void make_surfels(const SurfelRows& rows, size_t begin, size_t end);
size_t count_cut_cells(const uint64_t* row, size_t words, size_t nx, size_t ny);

}  // namespace sg::contouring
