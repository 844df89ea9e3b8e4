// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/extent.h"

#include <fmt/core.h>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice.h"

namespace sg {

namespace {

// Integrals of the field along every so many rows of each axis: lowest and highest.
Range column_sums(const Dataset& d, const Field& f, int component) {
  const Lattice lattice(d.mesh());
  const LatticeView& view = lattice.view();
  const auto n = f.association == Association::cell ? view.cell_dims() : view.dims;
  const size_t stride[3] = {1, n[0], n[0] * n[1]};
  Range all;
  dispatch(f.array, [&](auto v) {
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      const size_t rows = n[size_t(b)] * n[size_t(c)];
      size_t skip = std::max<size_t>(1, rows * n[size_t(a)] / 4000000);
      while (skip > 1 && n[size_t(b)] % skip == 0) ++skip;
      const size_t far_i = a == 0 ? view.dims[0] - 1 : 0, far_j = a == 1 ? view.dims[1] - 1 : 0, far_k = a == 2 ? view.dims[2] - 1 : 0;
      const double step = length(view.position(far_i, far_j, far_k) - view.position(0, 0, 0)) / double(std::max<size_t>(n[size_t(a)], 1));
      for (size_t r = 0; r < rows; r += skip) {
        const size_t first = r % n[size_t(b)] * stride[b] + r / n[size_t(b)] * stride[c];
        double sum = 0;
        for (size_t i = 0; i < n[size_t(a)]; ++i) {
          const double x = double(v(first + i * stride[a], std::max(component, 0)));
          if (std::isfinite(x)) sum += x;
        }
        all.add({sum * step, sum * step});
      }
    }
  });
  return all;
}

}  // namespace

void take_collected_range(VolumeItem& item, bool choose_range, bool choose_map) {
  ColorScale& s = item.color;
  const Dataset& d = *item.data;
  const double diagonal = d.bounds().diagonal();
  const RayFunctionInfo& info = info_of(item.mode);
  if (!info.collects()) return;
  if (info.axis == RayFunctionInfo::Axis::value_times_length) {
    s.title = "sum of " + s.title;
    if (choose_range) {
      const Field& f = d.fields().require(item.field, item.association);
      Range r = is_lattice(d.mesh()) ? column_sums(d, f, item.component) : Range{0, s.hi * diagonal / 2};
      r.add({0, 0});
      if (r.lo < r.hi) s.lo = r.lo, s.hi = r.hi;
    }
  } else {
    const std::string level = item.levels.empty() ? "" : short_number(item.levels[0]);
    s.title = item.mode == RayFunction::distance ? fmt::format("distance to {} = {}", s.title, level)
                                                 : fmt::format("length with {} \u2265 {}", s.title, level);
    s.unit.clear();
    if (choose_range) s.lo = 0, s.hi = diagonal > 0 ? diagonal : 1;
  }
  s.kind = ScaleKind::linear;
  s.labels.clear(), s.label_names.clear(), s.limits.clear();
  if (choose_map && s.map.kind != MapKind::sequential) s.map = find_colormap("sight");
}

}  // namespace sg
