// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/lattice/contour_surfels.h"

#include "base/parallel.h"
#include "data/lattice.h"
#include "filter/scalar/contour/contour_parts.h"

namespace sg::contouring {

std::optional<SurfelPlaces> surfel_places(const Dataset& input, const Array& samples, double value, Vec3 origin, bool cells,
                                          Context& context) {
  const Lattice lattice(input.mesh());
  const LatticeView view = lattice.view();
  if (view.mode != LatticeView::Mode::affine) return {};
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 3; ++c)
      if ((view.step[a][c] != 0) != (a == c)) return {};
  const size_t nx = view.dims[0], ny = view.dims[1], nz = view.dims[2], rows = ny * nz, words = (nx + 63) / 64;
  const size_t grain = std::max<size_t>(1, 512 / words);
  if ((grain + 4 * ny) * nx >= size_t(INT32_MAX)) return {};
  Plane<uint64_t> inside(rows * words);
  std::vector<RowState> state(rows);
  const RowsOut out{inside.data(), state.data()};
  if (classify(samples, nx, rows, std::span(&value, 1), std::span(&out, 1), words, context)) return {};

  std::vector<size_t> place(rows + 1);
  parallel_for(
      rows, grain,
      [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r) {
          if (r % ny + 1 >= ny || r / ny + 1 >= nz) continue;
          const RowState s = state[r];
          if (s != RowState::mixed && state[r + 1] == s && state[r + ny] == s && state[r + ny + 1] == s) continue;
          place[r] = count_cut_cells(inside.data() + r * words, words, nx, ny);
        }
      },
      &context);
  const size_t count = exclusive_scan(place);
  SurfelPlaces r;
  float *xyz = nullptr, *normals = nullptr;
  r.xyz = Array::make<float>(count, 3, &xyz);
  r.normals = Array::make<float>(count, 3, &normals);
  if (cells) r.cells.resize(count);
  const SurfelRows work{samples,
                        value,
                        view.origin - origin,
                        {view.step[0].x, view.step[1].y, view.step[2].z},
                        nx,
                        ny,
                        nz,
                        words,
                        inside.data(),
                        place.data(),
                        xyz,
                        normals,
                        cells ? r.cells.data() : nullptr};
  parallel_for(
      rows, grain, [&](size_t begin, size_t end) { make_surfels(work, begin, end); }, &context);
  return r;
}

}  // namespace sg::contouring
