// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/pressure/pressure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/union_find.h"
#include "simulate/fluid/lattice_sums.h"

namespace sg::fluid {

namespace {

// Calls f(i) for all of so many numbers.
template <class F>
void each(size_t count, const Context& context, F&& f) {
  parallel_for(
      count, values_at_once,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) f(i);
      },
      &context);
}

}  // namespace

template <class T>
PressureSolver<T>::PressureSolver(std::array<size_t, 3> cells, Walls<T> given) : cells_(cells), multigrid_(cells, std::move(given)) {
  find_rooms({});
}

template <class T>
void PressureSolver<T>::set_air(std::vector<uint8_t> air) {
  find_rooms(air);
  multigrid_.set_air(std::move(air));
}

template <class T>
void PressureSolver<T>::find_rooms(const std::vector<uint8_t>& air) {
  const Walls<T>& w = walls();
  const auto& cells = cells_;
  const size_t count = cells[0] * cells[1] * cells[2];
  closed_ = 0, room_.clear();
  if (!w.obstacles() && air.empty()) {  // a single room
    closed_ = std::none_of(w.sides.begin(), w.sides.end(), [](bool open) { return open; });
    if (closed_) room_.assign(count, 0);
    return;
  }
  const auto id = [&](size_t i, size_t j, size_t k) { return i + cells[0] * (j + cells[1] * k); };
  UnionFind<> rooms(count);
  std::vector<uint8_t> opens(count), wet(count);
  for (size_t k = 0; k < cells[2]; ++k)
    for (size_t j = 0; j < cells[1]; ++j)
      for (size_t i = 0; i < cells[0]; ++i) {
        const size_t c = id(i, j, k);
        if (!air.empty() && air[c]) continue;
        const auto face = [&](int a, size_t x, size_t y, size_t z, bool border, size_t neighbour) {
          if (!(w.share(cells, a, x, y, z) > 0)) return;
          wet[c] = 1;
          if (border || (!air.empty() && air[neighbour])) opens[c] = 1;
          else rooms.join(uint32_t(c), uint32_t(neighbour));
        };
        face(0, i, j, k, i == 0, c - 1), face(0, i + 1, j, k, i + 1 == cells[0], c + 1);
        face(1, i, j, k, j == 0, c - cells[0]), face(1, i, j + 1, k, j + 1 == cells[1], c + cells[0]);
        face(2, i, j, k, k == 0, c - cells[0] * cells[1]), face(2, i, j, k + 1, k + 1 == cells[2], c + cells[0] * cells[1]);
      }
  std::vector<uint8_t> has_opening(count);
  for (size_t c = 0; c < count; ++c)
    if (opens[c]) has_opening[rooms.root(uint32_t(c))] = 1;
  std::vector<int32_t> number(count, -1);
  std::vector<int32_t> room(count, -1);
  for (size_t c = 0; c < count; ++c) {
    const size_t root = rooms.root(uint32_t(c));
    if (!wet[c] || has_opening[root]) continue;
    if (number[root] < 0) number[root] = int32_t(closed_++);
    room[c] = number[root];
  }
  if (closed_ > 0) room_ = std::move(room);
}

// Takes the mean of each closed room away.
template <class T>
void PressureSolver<T>::balance(Lattice<T>& v, bool must) const {
  if (closed_ == 0) return;
  std::vector<double> sum(closed_), size(closed_), count(closed_);
  for (size_t c = 0; c < room_.size(); ++c)
    if (const int32_t r = room_[c]; r >= 0)
      sum[size_t(r)] += double(v.values[c]), size[size_t(r)] += std::abs(double(v.values[c])), ++count[size_t(r)];
  for (size_t r = 0; r < closed_; ++r)
    if (must && std::abs(sum[r]) > 1e-4 * size[r] && std::abs(sum[r]) > 1e-6 * count[r])
      fail_data(fmt::format("{:.3g} cells' worth flow into a closed room every step and cannot flow out", sum[r]), "the pressure",
                "open a side of the box, or balance what flows in and out");
  for (size_t c = 0; c < room_.size(); ++c)
    if (const int32_t r = room_[c]; r >= 0) v.values[c] -= T(sum[size_t(r)] / count[size_t(r)]);
}

template <class T>
SolveReport PressureSolver<T>::solve(Lattice<T>& b, Lattice<T>& p, double tolerance, Spare<T> spare, const Context& context, int most) {
  Lattice<T>&r = shaped(spare[0], p.n), &z = shaped(spare[1], p.n), &s = shaped(spare[2], p.n), &smoothed = shaped(spare[3], p.n);
  const size_t count = p.values.size();
  T *const pv = p.values.data(), *const rv = r.values.data(), *const zv = z.values.data(), *const sv = s.values.data();
  balance(b, true);
  SolveReport report;
  const double size = largest(b, context);
  if (std::isnan(size)) fail_data("the flow holds values that are not numbers", "the pressure");
  if (size == 0) {
    std::fill(p.values.begin(), p.values.end(), T(0));
    return report;
  }
  if (!std::isfinite(size)) fail_data("the flow grew beyond all numbers", "the pressure", "take smaller time steps");
  // Conjugate gradients (Hestenes, Stiefel 1952): r the residual, z = M r, s the direction.
  multigrid_.apply(p, z, context);
  each(count, context, [&, bv = b.values.data()](size_t i) { rv[i] = bv[i] - zv[i]; });
  if (!(largest(r, context) < size)) {  // worse than nothing to begin with
    std::fill(p.values.begin(), p.values.end(), T(0));
    r.values = b.values;
  }
  double rz = 0;
  for (report.iterations = 0;; ++report.iterations) {
    report.residual = largest(r, context) / size;
    if (report.residual <= tolerance || report.iterations == most) break;
    multigrid_.precondition(r, z, smoothed, context);
    const double now = dot(r, z, context);
    const T beta = report.iterations == 0 ? T(0) : T(now / rz);
    rz = now;
    if (report.iterations == 0) s.values = z.values;
    else each(count, context, [=](size_t i) { sv[i] = zv[i] + beta * sv[i]; });
    multigrid_.apply(s, z, context);
    const double curvature = dot(s, z, context);
    if (!(curvature > 0)) break;  // nothing is left but rounding
    const T alpha = T(rz / curvature);
    each(count, context, [=](size_t i) { pv[i] += alpha * sv[i], rv[i] -= alpha * zv[i]; });
  }
  balance(p, false);
  return report;
}

template class PressureSolver<float>;
template class PressureSolver<double>;

}  // namespace sg::fluid
