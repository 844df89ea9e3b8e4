// SPDX-License-Identifier: Apache-2.0
#include "data/lattice.h"

#include <algorithm>
#include <cmath>

namespace sg {

bool is_lattice(const Mesh& mesh) {
  return std::holds_alternative<UniformGrid>(mesh) || std::holds_alternative<RectilinearGrid>(mesh) ||
         std::holds_alternative<CurvilinearGrid>(mesh);
}

double shortest_spacing(const UniformGrid& grid) {
  double shortest = 0;
  for (int a = 0; a < 3; ++a)
    if (const double s = std::abs(grid.spacing[a]); grid.dims[size_t(a)] > 1 && (shortest == 0 || s < shortest)) shortest = s;
  return shortest;
}

std::array<size_t, 3> lattice_dims(const Mesh& mesh) {
  if (auto* m = std::get_if<UniformGrid>(&mesh)) return m->dims;
  if (auto* m = std::get_if<RectilinearGrid>(&mesh)) return m->dims();
  if (auto* m = std::get_if<CurvilinearGrid>(&mesh)) return m->dims;
  return {point_count(mesh), 1, 1};
}

std::array<size_t, 3> LatticeView::cell_dims() const {
  return {std::max<size_t>(dims[0], 2) - 1, std::max<size_t>(dims[1], 2) - 1, std::max<size_t>(dims[2], 2) - 1};
}

size_t LatticeView::cells() const {
  if (points() == 0) return 0;
  const auto c = cell_dims();
  return c[0] * c[1] * c[2];
}

Lattice::Lattice(const Mesh& mesh) {
  if (!is_lattice(mesh)) fail_internal("expected a lattice");
  view_.dims = lattice_dims(mesh);
  if (auto* u = std::get_if<UniformGrid>(&mesh)) {
    view_.mode = LatticeView::Mode::affine;
    view_.origin = u->origin;
    for (int a = 0; a < 3; ++a) view_.step[a] = u->direction.column(a) * u->spacing[a];
  } else if (auto* r = std::get_if<RectilinearGrid>(&mesh)) {
    view_.mode = LatticeView::Mode::separable;
    const Array* source[3] = {&r->x, &r->y, &r->z};
    for (int a = 0; a < 3; ++a) {
      axes_[a].resize(source[a]->count());
      for (size_t i = 0; i < axes_[a].size(); ++i) axes_[a][i] = source[a]->get(i);
      view_.axis[a] = axes_[a].data();
    }
  } else {
    const auto& g = std::get<CurvilinearGrid>(mesh);
    view_.mode = LatticeView::Mode::listed;
    view_.origin = g.points.origin;
    listed_ = g.points.xyz.made_packed();
    if (listed_.type() == ElementType::f32) view_.xyz32 = listed_.view<float>().data;
    else view_.xyz64 = listed_.view<double>().data;
  }
}

}  // namespace sg
