// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/multigrid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sg::pde {

namespace {

constexpr int coarsest_sweeps = 8;
constexpr size_t columns_at_once = 256;

// Calls f(begin of the inner numbers, how many, place before the axis) for blocks of a lattice along an axis: lines of places `stride`
// apart that begin side by side.
template <class F>
void along(const std::array<size_t, 3>& n, size_t axis, const Context& context, F&& f) {
  size_t inner = 1, outer = 1;
  for (size_t a = 0; a < 3; ++a) (a < axis ? inner : outer) *= a == axis ? 1 : n[a];
  const size_t blocks = (inner + columns_at_once - 1) / columns_at_once;
  parallel_for(
      outer * blocks, axis == 0 ? rows_at_once : 1,
      [&](size_t begin, size_t end) {
        for (size_t task = begin; task < end; ++task) {
          const size_t from = task % blocks * columns_at_once;
          f(from, std::min(columns_at_once, inner - from), task / blocks, inner);
        }
      },
      &context);
}

}  // namespace

bool Operator::singular() const {
  if (shift != 0) return false;
  return std::none_of(axes.begin(), axes.end(), [](const Axis& a) { return !a.flat() && (a.lo.wall() || a.hi.wall()); });
}

void Operator::apply(const Values& x, Values& out, const Context& context) const {
  double* const to = out.values.data();
  const double* const v = x.values.data();
  each_place<1>(axes, x, 0, context,
                [=, this](size_t i, double around, double diagonal) { to[i] = shift * v[i] + scale * (diagonal * v[i] - around); });
}

void Operator::residual(const Values& b, const Values& x, Values& r, const Context& context) const {
  double* const to = r.values.data();
  const double *const v = x.values.data(), *const f = b.values.data();
  each_place<1>(axes, x, 0, context, [=, this](size_t i, double around, double diagonal) {
    to[i] = f[i] - (shift * v[i] + scale * (diagonal * v[i] - around));
  });
}

void Operator::relax(const Values& b, Values& x, int color, double omega, const Context& context) const {
  double* const to = x.values.data();
  const double* const f = b.values.data();
  each_place<2>(axes, x, size_t(color), context, [=, this](size_t i, double around, double diagonal) {
    const double d = shift + scale * diagonal;
    if (d > 0) to[i] += omega * ((f[i] + scale * around) / d - to[i]);
  });
}

double Operator::best_omega() const {
  double least = HUGE_VAL, couplings = 0;
  if (singular())  // the constant is no error: the next mode counts
    for (const Axis& a : axes) least = a.flat() || a.n < 2 ? least : std::min(least, a.least_eigenvalue());
  else {
    least = 0;
    for (const Axis& a : axes)
      if (!a.flat() && (a.lo.wall() || a.hi.wall())) least += a.least_eigenvalue();
  }
  for (const Axis& a : axes) couplings += a.coupling();
  if (!std::isfinite(least)) return 1;
  const double rho = std::clamp(1 - (shift + scale * least) / (shift + 2 * scale * couplings), 0.0, 1.0);
  return 2 / (1 + std::sqrt(1 - rho * rho));
}

std::vector<Multigrid::Mix> Multigrid::mixes_of(const Axis& fine, const Axis& coarse) {
  std::vector<Mix> mixes(fine.n);
  const auto n = long(coarse.n);
  const bool periodic = coarse.lo.kind == SideKind::periodic;
  for (size_t i = 0; i < fine.n; ++i) {
    const double t = (fine.first() + double(i) * fine.h() - coarse.first()) / coarse.h();
    const auto below = long(std::floor(t + 1e-9));
    const double share = std::max(0.0, t - double(below));
    const auto take = [&](size_t which, long at, double weight) {
      Mix& m = mixes[i];
      if (periodic) at = (at + n) % n;
      else if (at < 0 || at >= n) {  // the side: 0 on a wall, else as near it
        if (at < 0 ? coarse.lo.wall() : coarse.hi.wall()) weight = 0;
        at = at < 0 ? 0 : n - 1;
      }
      m.from[which] = size_t(at), m.weight[which] = weight;
    };
    take(0, below, 1 - share), take(1, below + 1, share);
  }
  return mixes;
}

Multigrid::Multigrid(Operator op) {
  levels_.emplace_back();
  levels_[0].op = std::move(op);
  levels_[0].r = Values(levels_[0].op.n());
  for (;;) {
    Level& fine = levels_.back();
    double smallest = HUGE_VAL;
    for (const Axis& a : fine.op.axes)
      if (!a.flat() && a.n > 1) smallest = std::min(smallest, a.h());
    if (!std::isfinite(smallest)) break;
    Level next;
    next.op = fine.op;
    for (size_t a = 0; a < 3; ++a) {
      Axis& axis = next.op.axes[a];
      const Axis& from = fine.op.axes[a];
      if (axis.flat() || axis.n == 1 || axis.h() > 1.6 * smallest) continue;
      axis.n = axis.lo.kind == SideKind::periodic && axis.n > 2 ? (axis.n + 2) / 4 * 2  // even
               : axis.lo.wall() && axis.hi.wall()               ? axis.n / 2
                                                                : (axis.n + 1) / 2;
      if (axis.n == 1 && axis.lo.kind == SideKind::periodic) axis.lo.kind = axis.hi.kind = SideKind::insulated;  // no neighbours
      fine.mixes[a] = mixes_of(from, axis);
      fine.shares[a] = from.h() / axis.h();
      auto n = fine.between.empty() ? fine.op.n() : fine.between.back().n;
      n[a] = axis.n;
      fine.between.emplace_back(n);
    }
    next.x = next.b = next.r = Values(next.op.n());
    levels_.push_back(std::move(next));
  }
}

void Multigrid::restrict_to(Level& fine, Values& coarse, const Context& context) {
  const Values* from = &fine.r;
  size_t stage = 0;
  for (size_t a = 0; a < 3; ++a) {
    const auto& mixes = fine.mixes[a];
    if (mixes.empty()) continue;
    Values& to = stage + 1 == fine.between.size() ? coarse : fine.between[stage];
    const size_t many = from->n[a], few = to.n[a];
    const double scale = fine.shares[a];
    const double* const in = from->values.data();
    double* const out = to.values.data();
    along(from->n, a, context, [&](size_t begin, size_t count, size_t outer, size_t stride) {
      for (size_t j = 0; j < few; ++j) std::fill_n(out + (outer * few + j) * stride + begin, count, 0.0);
      for (size_t i = 0; i < many; ++i)
        for (size_t which = 0; which < 2; ++which) {
          const double w = scale * mixes[i].weight[which];
          if (w == 0) continue;
          const double* const p = in + (outer * many + i) * stride + begin;
          double* const q = out + (outer * few + mixes[i].from[which]) * stride + begin;
          for (size_t c = 0; c < count; ++c) q[c] += w * p[c];
        }
    });
    from = &to, ++stage;
  }
}

void Multigrid::add_prolonged(Level& fine, const Values& coarse, Values& x, const Context& context) {
  const Values* from = &coarse;
  size_t stage = fine.between.size();
  for (size_t a = 3; a-- > 0;) {
    const auto& mixes = fine.mixes[a];
    if (mixes.empty()) continue;
    --stage;
    Values& to = stage == 0 ? x : fine.between[stage - 1];
    const bool add = stage == 0;
    const size_t many = to.n[a], few = from->n[a];
    const double* const in = from->values.data();
    double* const out = to.values.data();
    along(to.n, a, context, [&](size_t begin, size_t count, size_t outer, size_t stride) {
      for (size_t i = 0; i < many; ++i) {
        const Mix& m = mixes[i];
        const double *const p = in + (outer * few + m.from[0]) * stride + begin, *const q = in + (outer * few + m.from[1]) * stride + begin;
        double* const r = out + (outer * many + i) * stride + begin;
        for (size_t c = 0; c < count; ++c) {
          const double v = m.weight[0] * p[c] + m.weight[1] * q[c];
          r[c] = add ? r[c] + v : v;
        }
      }
    });
    from = &to;
  }
}

void Multigrid::cycle(size_t level, const Values& b, Values& x, const Context& context) {
  Level& l = levels_[level];
  const bool last = level + 1 == levels_.size();
  const int sweeps = last ? coarsest_sweeps : 1;
  for (int s = 0; s < sweeps; ++s) l.op.relax(b, x, 0, 1, context), l.op.relax(b, x, 1, 1, context);
  if (!last) {
    Level& next = levels_[level + 1];
    l.op.residual(b, x, l.r, context);
    restrict_to(l, next.b, context);
    std::fill(next.x.values.begin(), next.x.values.end(), 0.0);
    cycle(level + 1, next.b, next.x, context);
    add_prolonged(l, next.x, x, context);
  }
  for (int s = 0; s < sweeps; ++s) l.op.relax(b, x, 0, 1, context), l.op.relax(b, x, 1, 1, context);
}

}  // namespace sg::pde
