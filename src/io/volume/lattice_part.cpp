// SPDX-License-Identifier: Apache-2.0
#include "io/volume/lattice_part.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "data/lattice_crop.h"

namespace sg {

namespace {

// Row `row` (counted over the wanted ones) as it lies in memory at `from`.
void copy_row(const std::byte* from, size_t tuple, const LatticePart& p, std::byte* to) {
  from += p.lo[0] * tuple;
  if (p.stride[0] == 1) std::memcpy(to, from, p.count[0] * tuple);
  else
    for (size_t i = 0; i < p.count[0]; ++i) std::memcpy(to + i * tuple, from + i * p.stride[0] * tuple, tuple);
}

}  // namespace

LatticePart cut_grid(UniformGrid& grid, const LatticeRegion& region) {
  LatticePart part;
  part.dims = part.count = grid.dims;
  if (region.whole()) return part;
  grid = *crop_lattice(*make_dataset(Mesh(grid)), region.lo, region.hi, region.stride)->as<UniformGrid>();
  part.lo = region.lo;
  part.count = grid.dims;
  part.stride = region.stride;
  return part;
}

UniformGrid with_long_axes(const UniformGrid& grid) {
  UniformGrid g = grid;
  for (int a = 0; a < 3; ++a)
    if (g.spacing[a] == 0) g.spacing[a] = 1;
  return g;
}

void copy_part(const std::byte* block, size_t tuple, const LatticePart& p, std::byte* out) {
  const size_t row_bytes = p.count[0] * tuple;
  parallel_for(p.count[1] * p.count[2], std::max<size_t>(1, (size_t(1) << 18) / std::max<size_t>(row_bytes, 1)),
               [&](size_t begin, size_t end) {
                 for (size_t row = begin; row < end; ++row) {
                   const size_t j = p.lo[1] + row % p.count[1] * p.stride[1], k = p.lo[2] + row / p.count[1] * p.stride[2];
                   copy_row(block + p.dims[0] * (j + p.dims[1] * k) * tuple, tuple, p, out + row * row_bytes);
                 }
               });
}

void stream_part(const std::function<void(std::byte* to, size_t bytes)>& read, size_t tuple, const LatticePart& p, std::byte* out) {
  const size_t row = p.dims[0] * tuple, slice = row * p.dims[1];
  if (p.whole()) return read(out, slice * p.dims[2]);
  const auto one_row = std::make_unique<std::byte[]>(row);
  for (size_t k = 0; k < p.dims[2]; ++k) {
    if (!p.has_slice(k)) {
      read(nullptr, slice);
      continue;
    }
    for (size_t j = 0; j < p.dims[1]; ++j) {
      const bool wanted = j >= p.lo[1] && (j - p.lo[1]) % p.stride[1] == 0 && (j - p.lo[1]) / p.stride[1] < p.count[1];
      read(wanted ? one_row.get() : nullptr, row);
      if (!wanted) continue;
      copy_row(one_row.get(), tuple, p, out);
      out += p.count[0] * tuple;
    }
  }
}

}  // namespace sg
