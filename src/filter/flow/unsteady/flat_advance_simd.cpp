// SPDX-License-Identifier: Apache-2.0
// Sixteen particles are under way; each stage of their steps takes all of them, in as many vectors as the processor needs. A corner of a
// cell is one load of 64 bits, both components, so that the bilinear interpolation of eight particles is one of sixteen floats. Places,
// times and step sizes are doubles. No fused multiply-add, and no lane looks at another. The scalar reference is advance_one() over an
// UnsteadyCursor.
#include "filter/flow/unsteady/flat_advance.h"

#include "base/vector_targets.h"
// One lane has no vectors of two floats, and takes another way than all others: SSSE3 and SSE4 stand before it.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS HWY_AVX3_DL

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/flow/unsteady/flat_advance_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace sg::flat_advance::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;
using lattice_advance::Job;

#if HWY_TARGET == HWY_SCALAR  // has no vectors of two floats
void run(const Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& o, Way* way) {
  lattice_advance::run(job, particles, first, until, sign, o, way);
}
#else

constexpr size_t W = 16;
using D = hn::CappedTag<double, 8>;
using L = hn::RebindToSigned<D>;
using U = hn::RebindToUnsigned<D>;
using F = hn::Repartition<float, D>;
using VD = Float<D>;
using VF = hn::Vec<F>;
using Mask = Mask<D>;
constexpr D d;

struct Flat {
  int a = 0, b = 1;           // the axes
  const float* step[4] = {};  // the first of the two components
  double bytes[2] = {};       // from a point to the next
  ptrdiff_t dx = 0, dy = 0;   // floats
  double origin[2] = {}, inverse[2] = {}, last[2] = {};
  const Job* job = nullptr;
};

using simd::HWY_NAMESPACE::set;
HWY_INLINE VD set(double v) { return set(d, v); }

/// Both components at a point of each lane.
HWY_INLINE VF corners(const float* base, hn::Vec<L> bytes) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  return bit_cast(F(), hn::GatherOffset(L(), reinterpret_cast<const int64_t*>(base), bytes));
#else
  HWY_ALIGN int64_t at[8];
  HWY_ALIGN float v[16];
  hn::Store(bytes, L(), at);
  for (size_t l = 0; l < hn::Lanes(d); ++l) std::memcpy(v + 2 * l, reinterpret_cast<const char*>(base) + at[l], 8);
  return hn::Load(F(), v);
#endif
}
/// Each lane's number as a float for both components.
HWY_INLINE VF twice(VD v) {
  const hn::Rebind<float, D> half;
  const hn::Rebind<uint32_t, D> bits;
  return hn::DupEven(bit_cast(F(), hn::PromoteTo(U(), bit_cast(bits, hn::DemoteTo(half, v)))));
}
HWY_INLINE VD component(hn::Vec<U> bits) {
  const hn::Rebind<float, D> half;
  const hn::Rebind<uint32_t, D> low;
  return hn::PromoteTo(d, bit_cast(half, hn::TruncateTo(low, bits)));
}
HWY_INLINE VF mix(VF a, VF b, VF f) { return a + f * (b - a); }

/// Velocities; a mask of those inside. NaN in the data makes NaN of v, and places that are NaN lie outside.
template <int STEPS>
HWY_INLINE Mask velocity(const Flat& g, VD x, VD y, VD t, VD& u, VD& v) {
  const VD zero = set(d, 0);
  const VD qx = (x - g.origin[0]) * g.inverse[0], qy = (y - g.origin[1]) * g.inverse[1];
  // Addresses stay inside whatever q is.
  const auto cell = [&](VD q, double last) { return floor(min(only(q > zero, q), last)); };
  const VD cx = cell(qx, g.last[0]), cy = cell(qy, g.last[1]), fx = qx - cx, fy = qy - cy;
  const auto near = [](VD f) { return abs(f - 0.5) <= 0.5 + 1e-9; };
  const Mask ok = near(fx) & near(fy);
  // A whole number below 2^52 is in the low bits of its sum with 2^52.
  constexpr double two52 = 4503599627370496.0;
  const VD place = cx * g.bytes[0] + cy * g.bytes[1] + two52;
  const auto at = bit_cast(L(), place) & ((int64_t(1) << 52) - 1);
  const VF wx = twice(fx), wy = twice(fy);
  const VD s = (t - g.job->begin) * g.job->scale;
  const auto in_step = [&](int j) {
    const float* p = g.step[j];
    const VF low = mix(corners(p, at), corners(p + g.dx, at), wx);
    return mix(low, mix(corners(p + g.dy, at), corners(p + g.dy + g.dx, at), wx), wy);
  };
  VF sum;
  if constexpr (STEPS == 2) {
    sum = mix(in_step(0), in_step(1), twice(s));
  } else {
    sum = set(F(), 0);
    for (int j = 0; j < 4; ++j) {
      const double* p = g.job->weight[j];
      VD m = p[3] * s + p[2];
      m = (m * s + p[1]) * s + p[0];
      const VF w = twice(m);
      sum = sum + only(w != 0, w * in_step(j));
    }
  }
  const auto bits = bit_cast(U(), sum);
  u = component(bits), v = component(shift_right<32>(bits));
  return ok;
}
HWY_INLINE Mask known(VD u, VD v) { return (abs(u) <= double(FLT_MAX)) & (abs(v) <= double(FLT_MAX)); }

HWY_INLINE VD length_of(VD x, VD y) { return sqrt(x * x + y * y); }

/// h times 0.9 error^(-1/5), between 0.2 and 5; the root by two of Newton's iterations: to 1e-4, enough for the size of a step.
HWY_INLINE VD next_size(VD h, VD error) {
  const VD x = min(max(error, 1e-10), 1e10), two52 = set(4503599627370496.0);
  // A fifth of the upper 52 bits.
  const auto upper = shift_right<12>(bit_cast(U(), x)) | bit_cast(U(), two52);
  const VD fifth = (bit_cast(d, upper) - two52) * 0.2 + two52;
  const auto whole = bit_cast(U(), fifth) & ((uint64_t(1) << 52) - 1);
  VD y = bit_cast(d, 0x4CB999999999999A - shift_left<12>(whole));
  for (int n = 0; n < 2; ++n) {
    const VD y2 = y * y, y5 = y2 * y2 * y;  // y^5, one of it is the factor outside
    y = y * (set(1.2) - 0.2 * x * y5);
  }
  return h * min(max(0.9 * y, 0.2), 5);
}

struct Lanes16 {
  HWY_ALIGN double x[2][W], k[7][2][W], to[2][W];  // to: where the step tried leads
  HWY_ALIGN double t[W], h[W], left[W], least[W], wished[W], next[W], steps[W], halvings[W], border[W];
  HWY_ALIGN double begins[W];  // 1: a step is to be sized, 0: it is tried again
  HWY_ALIGN int64_t ok[W];
};

template <int STEPS>
class Runner {
 public:
  Runner(const Flat& flat, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& o, Way* way)
      : g_(flat), particles_(particles), first_(first), until_(until), sign_(sign), o_(o), way_(way) {}

  void run() {
    std::memset(&s_, 0, sizeof s_);
    start();
    size_t n = 0;
    for (; n < W && fill(n); ++n) {
    }
    while (n > 0) {
      size(n);
      try_steps(n);
      uint32_t ends = finish(n);
      for (size_t l = n; ends != 0 && l-- > 0;) {  // downwards, so that the last lane is one that continues
        if (!(ends >> l & 1)) continue;
        write(l);
        if (!fill(l)) move(l, --n);
      }
    }
  }

 private:
  bool waits(const Particle& p) const { return p.ended || (until_ - p.t) * sign_ < 0; }

  /// All of those that start now.
  void start() {
    const Job& job = *g_.job;
    const int z = job.flat;
    size_t who[8], n = 0;
    HWY_ALIGN double x[8] = {}, y[8] = {}, t[8] = {}, u[8], v[8];
    HWY_ALIGN int64_t ok[8];
    const auto look = [&] {
      VD vu, vv;
      const Mask in = velocity<STEPS>(g_, hn::Load(d, x), hn::Load(d, y), hn::Load(d, t), vu, vv);
      hn::Store(hn::VecFromMask(L(), rebind(L(), in & known(vu, vv))), L(), ok);
      hn::Store(vu, d, u), hn::Store(vv, d, v);
      for (size_t l = 0; l < n; ++l) {
        Particle& p = particles_[who[l]];
        p.started = ok[l] != 0 && p.x[z] == job.origin[z], p.ended = !p.started;
        if (!p.started) continue;
        p.v[g_.a] = u[l], p.v[g_.b] = v[l], p.v[z] = 0;
        record(who[l]);
      }
      n = 0;
    };
    for (size_t i = 0; i < particles_.size(); ++i) {
      Particle& p = particles_[i];
      if (waits(p) || p.started) continue;
      if (std::abs(p.x[z] - job.origin[z]) <= job.cell) p.x[z] = job.origin[z];
      who[n] = i, x[n] = p.x[g_.a], y[n] = p.x[g_.b], t[n] = p.t;
      if (++n == hn::Lanes(d)) look();
    }
    if (n > 0) look();
  }
  void record(size_t i) {
    const Particle& p = particles_[i];
    way_push(i, p.x, p.v, p.t);
  }
  void way_push(size_t i, Vec3 x, Vec3 v, double t) {
    if (way_) way_->particle.push_back(first_ + i), way_->x.push_back(x), way_->v.push_back(v), way_->t.push_back(t);
  }

  /// The next particle that has a way to go.
  bool fill(size_t l) {
    for (; next_ < particles_.size(); ++next_) {
      Particle& p = particles_[next_];
      if (waits(p)) continue;
      const double left = std::abs(until_ - p.t);
      if (!(left > 1e-12 * std::max(std::abs(until_), left))) {
        p.t = until_;
        continue;
      }
      if (p.steps >= o_.max_steps) {
        p.ended = true, p.why = StopReason::steps;
        continue;
      }
      who_[l] = next_++;
      s_.x[0][l] = p.x[g_.a], s_.x[1][l] = p.x[g_.b], s_.k[0][0][l] = p.v[g_.a], s_.k[0][1][l] = p.v[g_.b];
      s_.t[l] = p.t, s_.left[l] = left, s_.next[l] = p.next, s_.steps[l] = p.steps, s_.begins[l] = 1;
      return true;
    }
    return false;
  }
  /// A particle that is through with the interval, back to its place.
  void write(size_t l) {
    Particle& p = particles_[who_[l]];
    p.x[g_.a] = s_.x[0][l], p.x[g_.b] = s_.x[1][l], p.v[g_.a] = s_.k[0][0][l], p.v[g_.b] = s_.k[0][1][l];
    p.t = s_.t[l], p.next = s_.next[l], p.steps = int32_t(s_.steps[l]);
    if (lost_ >> l & 1) p.ended = true, p.why = StopReason::outside;
    else if (p.t != until_) p.ended = true, p.why = StopReason::steps;
  }
  void move(size_t to, size_t from) {
    if (to == from) return;
    for (size_t c = 0; c < 2; ++c) s_.x[c][to] = s_.x[c][from], s_.k[0][c][to] = s_.k[0][c][from];
    s_.t[to] = s_.t[from], s_.h[to] = s_.h[from], s_.left[to] = s_.left[from], s_.least[to] = s_.least[from];
    s_.wished[to] = s_.wished[from], s_.next[to] = s_.next[from], s_.steps[to] = s_.steps[from], s_.begins[to] = s_.begins[from];
    s_.halvings[to] = s_.halvings[from], s_.border[to] = s_.border[from], who_[to] = who_[from];
  }

  /// Sizes of the steps that begin, as in advance_one().
  HWY_INLINE void size(size_t n) {
    for (size_t l = 0; l < n; l += hn::Lanes(d)) {
      const Mask begins = hn::Load(d, s_.begins + l) != 0;
      VD unit = set(1);
      if (o_.unit != StepUnit::time)
        unit = (o_.unit == StepUnit::cells ? g_.job->cell : 1.0) / length_of(hn::Load(d, s_.k[0][0] + l), hn::Load(d, s_.k[0][1] + l));
      const VD least = o_.min_step * unit, next = hn::Load(d, s_.next + l), left = hn::Load(d, s_.left + l);
      const VD wished = min(max(select(next > 0, next, o_.step * unit), least), o_.max_step * unit);
      // Two even steps rather than a long and a short one.
      const VD half = left * 0.5;
      const VD h = select(wished < left, min(wished, half), left);
      const auto store = [&](VD v, double* to) { hn::Store(select(begins, v, hn::Load(d, to + l)), d, to + l); };
      store(least, s_.least), store(wished, s_.wished), store(h, s_.h);
      store(set(d, 0), s_.halvings), store(set(d, 0), s_.border);
    }
  }

  /// k[OUT] at x + h (c0 k[n0] + c1 k[n1] + ...): see dormand_prince_step().
  template <int OUT, int K>
  HWY_INLINE void stage(size_t n, const int (&from)[K], const double (&c)[K], double share) {
    for (size_t l = 0; l < n; l += hn::Lanes(d)) {
      const VD h = sign_ * hn::Load(d, s_.h + l);
      VD x[2], u, v;
      for (int a = 0; a < 2; ++a) {
        VD sum = c[0] * hn::Load(d, s_.k[from[0]][a] + l);
        for (int i = 1; i < K; ++i) sum = sum + c[i] * hn::Load(d, s_.k[from[i]][a] + l);
        x[a] = hn::Load(d, s_.x[a] + l) + h * sum;
      }
      Mask ok = velocity<STEPS>(g_, x[0], x[1], hn::Load(d, s_.t + l) + share * h, u, v);
      if (OUT == 6) {
        hn::Store(x[0], d, s_.to[0] + l), hn::Store(x[1], d, s_.to[1] + l);
        ok = ok & known(u, v);
      }
      const auto all = hn::VecFromMask(L(), rebind(L(), ok));
      hn::Store(OUT == 1 ? all : all & hn::Load(L(), s_.ok + l), L(), s_.ok + l);
      hn::Store(u, d, s_.k[OUT][0] + l), hn::Store(v, d, s_.k[OUT][1] + l);
    }
  }
  HWY_INLINE void try_steps(size_t n) {
    stage<1>(n, {0}, {1.0 / 5}, 1.0 / 5);
    stage<2>(n, {0, 1}, {3.0 / 40, 9.0 / 40}, 3.0 / 10);
    stage<3>(n, {0, 1, 2}, {44.0 / 45, -56.0 / 15, 32.0 / 9}, 4.0 / 5);
    stage<4>(n, {0, 1, 2, 3}, {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729}, 8.0 / 9);
    stage<5>(n, {0, 1, 2, 3, 4}, {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656}, 1.0);
    stage<6>(n, {0, 2, 3, 4, 5}, {35.0 / 384, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}, 1.0);
  }
  HWY_INLINE VD error_of(size_t l, VD h) {
    constexpr double c[6] = {71.0 / 57600, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    VD e[2];
    for (int a = 0; a < 2; ++a) {
      e[a] = c[0] * hn::Load(d, s_.k[0][a] + l);
      for (int i = 1; i < 6; ++i) e[a] = e[a] + c[i] * hn::Load(d, s_.k[i + 1][a] + l);
      e[a] = h * e[a];
    }
    return length_of(e[0], e[1]) / (o_.tolerance * g_.job->cell);
  }

  /// What advance_one() does with a step; the lanes whose particles are through with the interval.
  HWY_INLINE uint32_t finish(size_t n) {
    const VD zero = set(d, 0), one = set(1);
    uint32_t ends = 0, goes = 0;
    lost_ = 0;
    for (size_t l = 0; l < n; l += hn::Lanes(d)) {
      const Mask ok = rebind(d, hn::MaskFromVec(hn::Load(L(), s_.ok + l)));
      const VD h = hn::Load(d, s_.h + l), left = hn::Load(d, s_.left + l), least = hn::Load(d, s_.least + l);
      const VD wished = hn::Load(d, s_.wished + l), t = hn::Load(d, s_.t + l), shortest = min(least, left);
      const VD error = error_of(l, h), next = next_size(h, error);
      const Mask large = (error > one) & (h > 1.001 * shortest);
      const Mask accept = ok & !large, fail = !ok;
      const VD border = select(fail, one, hn::Load(d, s_.border + l));
      const VD halvings = hn::Load(d, s_.halvings + l) + only(fail, one);
      hn::Store(border, d, s_.border + l), hn::Store(halvings, d, s_.halvings + l);
      hn::Store(select(fail, h * 0.5, select(large, max(next, shortest), h)), d, s_.h + l);
      for (int a = 0; a < 2; ++a) {
        hn::Store(select(accept, hn::Load(d, s_.to[a] + l), hn::Load(d, s_.x[a] + l)), d, s_.x[a] + l);
        hn::Store(select(accept, hn::Load(d, s_.k[6][a] + l), hn::Load(d, s_.k[0][a] + l)), d, s_.k[0][a] + l);
      }
      VD now = select(h >= left, until_, t + sign_ * h);
      now = select(accept, now, t);
      const VD rest = abs(until_ - now), steps = hn::Load(d, s_.steps + l) + only(accept, one);
      // A step cut short by the end of the interval says little about the next.
      const Mask cut = (h < wished) & (error <= one);
      const VD kept = select(cut, max(wished, next), next);
      hn::Store(select(accept, kept, hn::Load(d, s_.next + l)), d, s_.next + l);
      const Mask lost = (fail & (halvings > 10)) | (accept & ((border > zero) & (h < least)));
      const Mask there = accept & (rest <= 1e-12 * max(std::abs(until_), rest));
      const Mask tired = accept & (steps >= double(o_.max_steps));
      hn::Store(select(there & !lost, until_, now), d, s_.t + l);
      hn::Store(rest, d, s_.left + l), hn::Store(steps, d, s_.steps + l);
      hn::Store(only(accept, one), d, s_.begins + l);
      lost_ |= bits_of(lost) << l, ends |= bits_of(lost | there | tired) << l, goes |= bits_of(accept) << l;
    }
    if (way_)
      for (size_t l = 0; l < n; ++l)
        if (goes >> l & 1) record_lane(l);
    return ends & ((1u << n) - 1);
  }
  static HWY_INLINE uint32_t bits_of(Mask m) {
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, m, bits);
    return bits[0];
  }
  void record_lane(size_t l) {
    Vec3 x = particles_[who_[l]].x, v(0, 0, 0);
    x[g_.a] = s_.x[0][l], x[g_.b] = s_.x[1][l], v[g_.a] = s_.k[0][0][l], v[g_.b] = s_.k[0][1][l];
    way_push(who_[l], x, v, s_.t[l]);
  }

  Lanes16 s_;
  size_t who_[W] = {};
  const Flat& g_;
  std::span<Particle> particles_;
  size_t first_, next_ = 0;
  uint32_t lost_ = 0;
  double until_, sign_;
  const TraceOptions& o_;
  Way* way_;
};

void run(const Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& o, Way* way) {
  Flat g;
  g.a = job.flat == 0 ? 1 : 0, g.b = job.flat == 2 ? 1 : 2;
  const auto a = size_t(g.a), b = size_t(g.b);
  for (int j = 0; j < 4; ++j) g.step[j] = job.step[j] + g.a;
  g.dx = ptrdiff_t(job.stride[a]), g.dy = ptrdiff_t(job.stride[b]);
  g.bytes[0] = double(4 * job.stride[a]), g.bytes[1] = double(4 * job.stride[b]);
  for (int k = 0; k < 2; ++k) {
    const size_t axis = k == 0 ? a : b;
    g.origin[k] = job.origin[axis], g.inverse[k] = job.inverse[axis], g.last[k] = job.cells[axis] - 1;
  }
  g.job = &job;
  if (job.steps == 2) Runner<2>(g, particles, first, until, sign, o, way).run();
  else Runner<4>(g, particles, first, until, sign, o, way).run();
}
#endif

}  // namespace sg::flat_advance::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::flat_advance {
HWY_EXPORT(run);

bool takes(const lattice_advance::Job& job) { return job.flat == 2 || (job.flat == 0 && job.components == 3); }

void run(const lattice_advance::Job& job, std::span<Particle> particles, size_t first, double until, int sign, const TraceOptions& options,
         Way* way) {
  HWY_DYNAMIC_DISPATCH(run)(job, particles, first, until, sign, options, way);
}
}  // namespace sg::flat_advance
#endif
