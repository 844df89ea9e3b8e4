// SPDX-License-Identifier: Apache-2.0
// Velocities by trilinear interpolation of two or four time steps at once, and steps of several particles in turn, so that
// the processor always has one to work at while another waits. The compiler's own vectors: without fused multiply-add every target gives
// the same bits. The scalar reference is advance_one() over an UnsteadyCursor.
#include "filter/flow/unsteady/lattice_advance.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/flow/unsteady/lattice_advance_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cstring>

#pragma GCC diagnostic ignored "-Wpsabi"  // all is inlined

// Not by __AVX2__, which does not follow the target of a function.
#undef SG_LATTICE_AVX2
#if HWY_TARGET <= HWY_AVX2 && HWY_ARCH_X86
#define SG_LATTICE_AVX2 1
#else
#define SG_LATTICE_AVX2 0
#endif

HWY_BEFORE_NAMESPACE();
namespace sg::lattice_advance::HWY_NAMESPACE {

typedef float F4 __attribute__((vector_size(16)));
typedef float F8 __attribute__((vector_size(32)));
typedef int32_t I4 __attribute__((vector_size(16)));
typedef int32_t I8 __attribute__((vector_size(32)));
typedef double D4 __attribute__((vector_size(32)));
typedef int64_t L4 __attribute__((vector_size(32)));

HWY_INLINE F4 load(const float* p) {
  F4 v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
/// The same point of two steps.
HWY_INLINE F8 load_two(const float* a, const float* b) {
#if SG_LATTICE_AVX2
  return reinterpret_cast<F8>(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(a)), _mm_loadu_ps(b), 1));
#else
  return __builtin_shufflevector(load(a), load(b), 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}
/// a > b ? a : b and a < b ? a : b, b where one is NaN.
HWY_INLINE D4 larger(D4 a, D4 b) {
#if SG_LATTICE_AVX2
  return reinterpret_cast<D4>(_mm256_max_pd(reinterpret_cast<__m256d>(a), reinterpret_cast<__m256d>(b)));
#else
  return a > b ? a : b;
#endif
}
HWY_INLINE D4 smaller(D4 a, D4 b) {
#if SG_LATTICE_AVX2
  return reinterpret_cast<D4>(_mm256_min_pd(reinterpret_cast<__m256d>(a), reinterpret_cast<__m256d>(b)));
#else
  return a < b ? a : b;
#endif
}
/// Whether the first three are at most `most`, and not NaN.
HWY_INLINE bool at_most(D4 v, D4 most) {
#if SG_LATTICE_AVX2
  return (_mm256_movemask_pd(_mm256_cmp_pd(reinterpret_cast<__m256d>(v), reinterpret_cast<__m256d>(most), _CMP_LE_OQ)) & 7) == 7;
#else
  return v[0] <= most[0] && v[1] <= most[1] && v[2] <= most[2];
#endif
}
HWY_INLINE D4 absolute(D4 v) { return reinterpret_cast<D4>(reinterpret_cast<L4>(v) & INT64_MAX); }
HWY_INLINE F8 all(float x) { return F8{x, x, x, x, x, x, x, x}; }
HWY_INLINE F8 mix(F8 a, F8 b, F8 f) { return a + f * (b - a); }
HWY_INLINE Vec3 vec(D4 v) { return {v[0], v[1], v[2]}; }

struct Grid {
  D4 origin, inverse, last_cell;
  L4 keep;  // components that have a meaning: three, or two in a flat grid
  const Job* job;
};

/// Two steps interpolated in a cell whose first point lies at a and b.
HWY_INLINE F8 in_cell(const float* a, const float* b, size_t dx, size_t dy, size_t dz, F8 fx, F8 fy, F8 fz) {
  const F8 r0 = mix(load_two(a, b), load_two(a + dx, b + dx), fx);
  const F8 r1 = mix(load_two(a + dy, b + dy), load_two(a + dy + dx, b + dy + dx), fx);
  a += dz, b += dz;
  const F8 r2 = mix(load_two(a, b), load_two(a + dx, b + dx), fx);
  const F8 r3 = mix(load_two(a + dy, b + dy), load_two(a + dy + dx, b + dy + dx), fx);
  return mix(mix(r0, r1, fy), mix(r2, r3, fy), fz);
}
HWY_INLINE F4 first_half(F8 u) { return __builtin_shufflevector(u, u, 0, 1, 2, 3); }
HWY_INLINE F4 second_half(F8 u) { return __builtin_shufflevector(u, u, 4, 5, 6, 7); }

/// False outside. NaN in the data makes NaN of v (with LAST: false), and places that are NaN lie outside, so that the stages of a step need
/// not look.
template <int STEPS, bool LAST = false>
HWY_INLINE bool velocity(const Grid& g, D4 x, double t, D4& v) {
  const Job& job = *g.job;
  const D4 zero{}, q = (x - g.origin) * g.inverse;
  const I4 c = __builtin_convertvector(smaller(larger(q, zero), g.last_cell), I4);  // addresses stay inside whatever q is
  const D4 f = q - __builtin_convertvector(c, D4);
  bool ok = at_most(absolute(f - 0.5), zero + (0.5 + 1e-9));
  const F4 w = __builtin_convertvector(f, F4);
  size_t dx = job.stride[0], dy = job.stride[1], dz = job.stride[2];
  size_t at = size_t(uint32_t(c[0])) * dx + size_t(uint32_t(c[1])) * dy + size_t(uint32_t(c[2])) * dz;
  const double s = (t - job.begin) * job.scale;
  const F8 fx = all(w[0]), fy = all(w[1]), fz = all(w[2]);
  float copy[STEPS][8][4];
  const float* step[STEPS];
  for (int j = 0; j < STEPS; ++j) step[j] = job.step[j];
  if (HWY_UNLIKELY(at == job.last)) {
    for (int j = 0; j < STEPS; ++j) {
      for (size_t k = 0; k < 8; ++k) {
        std::memcpy(copy[j][k], job.step[j] + at + (k & 1 ? dx : 0) + (k & 2 ? dy : 0) + (k & 4 ? dz : 0), 3 * sizeof(float));
        copy[j][k][3] = 0;
      }
      step[j] = copy[j][0];
    }
    at = 0, dx = 4, dy = 8, dz = 16;
  }
  F4 sum;
  if constexpr (STEPS == 2) {
    const F8 u = in_cell(step[0] + at, step[1] + at, dx, dy, dz, fx, fy, fz);
    sum = first_half(u) + float(s) * (second_half(u) - first_half(u));
  } else {
    const F8 u[2] = {in_cell(step[0] + at, step[1] + at, dx, dy, dz, fx, fy, fz),
                     in_cell(step[2] + at, step[3] + at, dx, dy, dz, fx, fy, fz)};
    sum = F4{};
    for (int j = 0; j < 4; ++j) {
      const double* p = job.weight[j];
      const float m = float(((p[3] * s + p[2]) * s + p[1]) * s + p[0]);
      if (m != 0) sum = sum + m * (j % 2 ? second_half(u[j / 2]) : first_half(u[j / 2]));
    }
  }
  v = __builtin_convertvector(sum, D4);
  if (HWY_UNLIKELY(job.flat >= 0)) v = reinterpret_cast<D4>(reinterpret_cast<L4>(v) & g.keep);
  if (LAST) ok = ok && at_most(absolute(v), zero + double(FLT_MAX));
  return ok;
}

/// x^(-1/5) for x > 0 by two of Newton's iterations: to 1e-4, enough for the size of a step.
HWY_INLINE double inverse_fifth_root(double x) {
  const uint64_t bits = std::bit_cast<uint64_t>(x);
  double y = std::bit_cast<double>(uint64_t(0x4CB999999999999A) - bits / 5);
  for (int n = 0; n < 2; ++n) {
    const double y2 = y * y;
    y = y * (1.2 - 0.2 * x * (y2 * y2 * y));
  }
  return y;
}
/// 0.9 error^(-1/5) times h, between a fifth and twice of it.
HWY_INLINE double next_size(double h, double error) {
  if (error <= 0.018) return 2 * h;  // 0.45^5: most steps
  return h * std::max(0.9 * inverse_fifth_root(std::min(error, 1e10)), 0.2);
}

struct Lane {
  Particle* p = nullptr;
  D4 x, k1;
  double t, h, left, least, wished;
  int halving;
  bool at_border;
  // Of the step just tried:
  bool ok;
  D4 x1, k7, error;
};

/// Dormand-Prince, or RK4 with steps of one size.
template <int STEPS, bool ADAPTS>
class Lanes {
 public:
  Lanes(const Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& o, Way* way)
      : particles_(particles), first_(first), until_(until), sign_(sign), o_(o), way_(way) {
    g_.job = &job;
    for (int a = 0; a < 3; ++a) {
      g_.origin[a] = job.origin[a], g_.inverse[a] = job.inverse[a], g_.last_cell[a] = job.cells[a] - 1;
      g_.keep[a] = a == job.flat ? 0 : -1;
    }
    g_.origin[3] = g_.inverse[3] = 0, g_.last_cell[3] = 0, g_.keep[3] = 0;
  }

  void run() {
    Lane lane[width];
    int n = 0;
    for (; n < width && fill(lane[n]); ++n) {
    }
    while (n > 0) {
      try_steps(lane, n);
      for (int l = 0; l < n; ++l)
        if (!after_step(lane[l]) && !fill(lane[l])) lane[l--] = lane[--n];
    }
  }

 private:
  static constexpr int width = 4;

  /// What a size of 1 in the options' unit takes.
  double unit_time(double speed) const {
    switch (o_.unit) {
      case StepUnit::cells: return g_.job->cell / speed;
      case StepUnit::length: return 1 / speed;
      default: return 1;
    }
  }
  double speed_of(D4 v) const { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

  bool start(Particle& p) {
    const Job& job = *g_.job;
    if (job.flat >= 0) {
      const double off = p.x[job.flat] - job.origin[job.flat];
      if (std::abs(off) <= job.cell) p.x[job.flat] = job.origin[job.flat];
    }
    D4 v;
    p.started = inside_plane(p.x) && velocity<STEPS, true>(g_, D4{p.x.x, p.x.y, p.x.z, 0}, p.t, v);
    p.ended = !p.started;
    if (p.started) p.v = vec(v), record(p);
    return p.started;
  }
  bool inside_plane(Vec3 x) const { return g_.job->flat < 0 || x[g_.job->flat] == g_.job->origin[g_.job->flat]; }

  void record(const Particle& p) {
    if (!way_) return;
    way_->particle.push_back(first_ + size_t(&p - particles_.data()));
    way_->x.push_back(p.x), way_->v.push_back(p.v), way_->t.push_back(p.t);
  }

  /// The next particle that has a way to go.
  bool fill(Lane& l) {
    for (; next_ < particles_.size(); ++next_) {
      Particle& p = particles_[next_];
      __builtin_prefetch(&p + 8);
      if (p.ended || (until_ - p.t) * sign_ < 0 || (!p.started && !start(p))) continue;
      l.p = &p;
      l.x = D4{p.x.x, p.x.y, p.x.z, 0}, l.k1 = D4{p.v.x, p.v.y, p.v.z, 0}, l.t = p.t;
      if (!begin_step(l)) continue;
      ++next_;
      return true;
    }
    return false;
  }

  /// Size of the next step; false at the end of the interval.
  bool begin_step(Lane& l) {
    Particle& p = *l.p;
    l.left = std::abs(until_ - l.t);
    if (!(l.left > 1e-12 * std::max(std::abs(until_), l.left))) {
      p.t = until_;
      return false;
    }
    if (p.steps >= o_.max_steps) {
      p.ended = true, p.why = StopReason::steps;
      return false;
    }
    const double unit = unit_time(speed_of(l.k1));
    l.least = o_.min_step * unit;
    double h = ADAPTS && p.next > 0 ? p.next : o_.step * unit;
    if (ADAPTS) h = std::min(std::max(h, l.least), o_.max_step * unit);
    l.wished = h;
    if (!(h < l.left)) h = l.left;
    else if (ADAPTS && h > l.left / 2) h = l.left / 2;
    l.h = h, l.halving = 0, l.at_border = false;
    return true;
  }

  // A stage of all lanes, then the next: see dormand_prince_step().
  void try_steps(Lane* lane, int n) {
    D4 k2[width], k3[width], k4[width], k5[width], k6[width];
    const auto stage = [&](auto&& place, double share, D4* k) __attribute__((always_inline)) {
      for (int i = 0; i < n; ++i) {
        Lane& l = lane[i];
        const double h = sign_ * l.h;
        l.ok &= velocity<STEPS>(g_, l.x + h * place(l, i), l.t + share * h, k[i]);
      }
    };
    for (int i = 0; i < n; ++i) lane[i].ok = true;
    if constexpr (!ADAPTS) {
      stage([&](const Lane& l, int) { return 0.5 * l.k1; }, 0.5, k2);
      stage([&](const Lane&, int i) { return 0.5 * k2[i]; }, 0.5, k3);
      stage([&](const Lane&, int i) { return k3[i]; }, 1.0, k4);
      for (int i = 0; i < n; ++i) {
        Lane& l = lane[i];
        const double h = sign_ * l.h;
        l.x1 = l.x + (h / 6) * (l.k1 + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        l.ok &= velocity<STEPS, true>(g_, l.x1, l.t + h, l.k7);
      }
      return;
    }
    stage([&](const Lane& l, int) { return (1.0 / 5) * l.k1; }, 1.0 / 5, k2);
    stage([&](const Lane& l, int i) { return (3.0 / 40) * l.k1 + (9.0 / 40) * k2[i]; }, 3.0 / 10, k3);
    stage([&](const Lane& l, int i) { return (44.0 / 45) * l.k1 - (56.0 / 15) * k2[i] + (32.0 / 9) * k3[i]; }, 4.0 / 5, k4);
    stage([&](const Lane& l,
              int i) { return (19372.0 / 6561) * l.k1 - (25360.0 / 2187) * k2[i] + (64448.0 / 6561) * k3[i] - (212.0 / 729) * k4[i]; },
          8.0 / 9, k5);
    stage(
        [&](const Lane& l, int i) {
          return (9017.0 / 3168) * l.k1 - (355.0 / 33) * k2[i] + (46732.0 / 5247) * k3[i] + (49.0 / 176) * k4[i] - (5103.0 / 18656) * k5[i];
        },
        1.0, k6);
    for (int i = 0; i < n; ++i) {
      Lane& l = lane[i];
      const double h = sign_ * l.h;
      l.x1 =
          l.x + h * ((35.0 / 384) * l.k1 + (500.0 / 1113) * k3[i] + (125.0 / 192) * k4[i] - (2187.0 / 6784) * k5[i] + (11.0 / 84) * k6[i]);
      l.ok &= velocity<STEPS, true>(g_, l.x1, l.t + h, l.k7);
      l.error = h * ((71.0 / 57600) * l.k1 - (71.0 / 16695) * k3[i] + (71.0 / 1920) * k4[i] - (17253.0 / 339200) * k5[i] +
                     (22.0 / 525) * k6[i] - (1.0 / 40) * l.k7);
    }
  }

  /// What advance_one() does with a step; false when the particle is through with the interval.
  bool after_step(Lane& l) {
    Particle& p = *l.p;
    if (!l.ok) {
      l.at_border = true, l.h /= 2;
      if (++l.halving <= 10) return true;
      p.ended = true, p.why = StopReason::outside;
      return false;
    }
    const double error = !ADAPTS ? 0 : speed_of(l.error) / (o_.tolerance * g_.job->cell), least = std::min(l.least, l.left);
    if (ADAPTS && error > 1 && l.h > 1.001 * least) {
      l.h = std::max(next_size(l.h, error), least);
      return true;
    }
    l.x = l.x1, l.k1 = l.k7;
    l.t = l.h >= l.left ? until_ : l.t + sign_ * l.h;
    p.x = vec(l.x), p.v = vec(l.k1), p.t = l.t;
    ++p.steps;
    if (ADAPTS) {
      const double next = next_size(l.h, error);
      p.next = l.h < l.wished && error <= 1 ? std::max(l.wished, next) : next;
    }
    record(p);
    if (l.at_border && l.h < l.least) {
      p.ended = true, p.why = StopReason::outside;
      return false;
    }
    return begin_step(l);
  }

  Grid g_;
  std::span<Particle> particles_;
  size_t first_, next_ = 0;
  double until_, sign_;
  const TraceOptions& o_;
  Way* way_;
};

void run(const Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& o, Way* way) {
  const auto go = [&](auto lanes) { lanes.run(); };
  if (o.scheme == Scheme::rk4) {
    if (job.steps == 2) go(Lanes<2, false>(job, particles, first, until, sign, o, way));
    else go(Lanes<4, false>(job, particles, first, until, sign, o, way));
  } else {
    if (job.steps == 2) go(Lanes<2, true>(job, particles, first, until, sign, o, way));
    else go(Lanes<4, true>(job, particles, first, until, sign, o, way));
  }
}

}  // namespace sg::lattice_advance::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::lattice_advance {
HWY_EXPORT(run);

void run(const Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& options, Way* way) {
  HWY_DYNAMIC_DISPATCH(run)(job, particles, first, until, sign, options, way);
}
}  // namespace sg::lattice_advance
#endif
