// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/border_layers.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "data/lattice.h"
#include "filter/field/derivatives/fitted_derivatives.h"
#include "filter/field/derivatives/lattice_frame.h"
#include "filter/field/sampling/center_lattice.h"

namespace sg {

namespace {

constexpr size_t places = 4;

// The second derivative at x of the cubic through f at the places s.
double cubic_bend(const double (&s)[places], const double (&f)[places], double x) {
  double sum = 0;
  for (size_t j = 0; j < places; ++j) {
    double others = 0, product = 1;
    for (size_t k = 0; k < places; ++k)
      if (k != j) others += s[k], product *= s[j] - s[k];
    sum += f[j] * 2 * (3 * x - others) / product;
  }
  return sum;
}

bool at_right_angles(const Mat3& m, int axes) {
  for (int a = 0; a < axes; ++a)
    for (int b = 0; b <= a; ++b)
      if (!(std::abs(dot(normalize(m.column(a)), normalize(m.column(b))) - (a == b)) < 1e-9)) return false;
  return true;
}

// One end of a line along `axis`.
template <class Values, class T>
void renew_end(const LatticeFrame& frame, std::array<size_t, 3> at, size_t axis, bool high, Values&& value, T* tensors) {
  const Vec3 along = normalize(frame.to_world.column(int(axis)));
  double s[places], f[places];
  size_t id[places];
  Vec3 first;
  for (size_t k = 0; k < places; ++k) {
    at[axis] = high ? frame.dims[axis] - 1 - k : k;
    id[k] = frame.id(at[0], at[1], at[2]), f[k] = value(id[k]);
    const Vec3 x = frame.position(at[0], at[1], at[2]);
    if (k == 0) first = x;
    s[k] = dot(x - first, along);
    if (!std::isfinite(f[k]) || (k > 0 && !(std::abs(s[k]) > std::abs(s[k - 1])))) return;
  }
  for (size_t k = 0; k < 2; ++k) {
    T* h = tensors + 9 * id[k];
    double before = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) before += along[i] * along[j] * double(h[3 * i + j]);
    const double change = cubic_bend(s, f, s[k]) - before;
    if (!std::isfinite(change)) continue;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) h[3 * i + j] = T(double(h[3 * i + j]) + change * along[i] * along[j]);
  }
}

template <class Values, class T>
void renew_borders(const LatticeFrame& frame, Values&& value, T* tensors, Context& context) {
  if (!at_right_angles(frame.to_world, frame.axes)) return;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (frame.dims[axis] < places) continue;
    const size_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2, lines = frame.dims[u] * frame.dims[v];
    parallel_for(
        lines, 256,
        [&](size_t begin, size_t end) {
          for (size_t line = begin; line < end; ++line)
            for (const bool high : {false, true}) {
              std::array<size_t, 3> at{};
              at[u] = line % frame.dims[u], at[v] = line / frame.dims[u];
              renew_end(frame, at, axis, high, value, tensors);
            }
        },
        &context);
  }
}

}  // namespace

Array with_border_derivatives(const Dataset& grid, bool of_cells, const Array& values, const Array& tensors, Context& context) {
  if (tensors.type() != ElementType::f64 && tensors.type() != ElementType::f32) return tensors;
  std::byte* bytes = nullptr;
  const Array packed = tensors.made_packed();
  Array out = Array::make_raw(tensors.type(), tensors.count(), 9, &bytes);
  std::memcpy(bytes, packed.raw(), packed.bytes());
  const Array numbers = values.converted(ElementType::f64);
  const auto f = numbers.view<double>();
  const auto run = [&](const LatticeView& view, size_t first) {
    if (view.mode == LatticeView::Mode::listed) return;
    const LatticeFrame frame(view);
    const auto value = [&](size_t i) { return double(f[first + i]); };
    if (tensors.type() == ElementType::f64) renew_borders(frame, value, reinterpret_cast<double*>(bytes) + 9 * first, context);
    else renew_borders(frame, value, reinterpret_cast<float*>(bytes) + 9 * first, context);
  };
  const auto* amr = grid.as<AmrGrid>();
  if (!amr) {
    const Lattice lattice(of_cells ? center_lattice(grid.mesh()) : grid.mesh());
    run(lattice.view(), 0);
    return out;
  }
  for (const auto& level : amr->levels)
    for (const auto& patch : level.patches) {
      const auto cells = patch.cells();
      const size_t more = of_cells ? 0 : 1;
      LatticeView v;
      v.dims = {cells[0] + more, cells[1] + more, amr->dimension == 3 ? cells[2] + more : 1};
      for (int a = 0; a < 3; ++a) v.step[a][a] = level.spacing[a];
      run(v, of_cells ? patch.cell_offset : patch.point_offset);
    }
  return out;
}

Array with_fitted_borders(const DatasetPtr& grid, const Field& field, const Array& tensors, Context& context) {
  constexpr size_t layers = 2;
  std::array<size_t, 3> dims = lattice_dims(grid->mesh());
  if (field.association == Association::cell)
    for (size_t& n : dims) n = std::max<size_t>(n, 2) - 1;
  std::vector<uint32_t> places;
  for (size_t k = 0; k < dims[2]; ++k)
    for (size_t j = 0; j < dims[1]; ++j)
      for (size_t i = 0; i < dims[0]; ++i) {
        const size_t at[3] = {i, j, k};
        bool outer = false;
        for (size_t a = 0; a < 3; ++a) outer = outer || (dims[a] > 1 && (at[a] < layers || at[a] + layers >= dims[a]));
        if (outer) places.push_back(uint32_t(i + dims[0] * (j + dims[1] * k)));
      }
  const Array values = field.array.converted(ElementType::f64).made_packed();
  std::vector<double> g(3 * places.size()), h(6 * places.size());
  fitted_derivatives_at(grid, field.association, places, values, g.data(), h.data(), context);
  std::byte* bytes = nullptr;
  const Array packed = tensors.made_packed();
  Array out = Array::make_raw(tensors.type(), tensors.count(), 9, &bytes);
  std::memcpy(bytes, packed.raw(), packed.bytes());
  constexpr size_t place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
  const auto put = [&](auto* to) {
    for (size_t n = 0; n < places.size(); ++n)
      for (size_t k = 0; k < 9; ++k)
        if (const double v = h[6 * n + place[k]]; std::isfinite(v)) to[9 * size_t(places[n]) + k] = std::remove_pointer_t<decltype(to)>(v);
  };
  if (tensors.type() == ElementType::f64) put(reinterpret_cast<double*>(bytes));
  else put(reinterpret_cast<float*>(bytes));
  return out;
}

}  // namespace sg
