// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include "base/vector_targets.h"
#include "simulate/fluid/advection/carry.h"
#include "simulate/fluid/advection/place_velocity.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulate/fluid/advection/carry_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::fluid::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

template <class D>
struct Place {
  Float<D> x, y, z;
};

// Along one axis: the lower of the neighbours about p, held at the border, as a whole number, and the share of the upper one.
template <class D>
struct Split {
  Float<D> cell, share;

  HWY_INLINE Split(Float<D> p, size_t count) {
    const auto most = hn::TFromD<D>(count - 1), last = hn::TFromD<D>(count < 2 ? 0 : count - 2);
    const auto held = min(max(p, 0), most);
    cell = min(floor(held), last), share = held - cell;
  }
};

// Numbers of a lattice, and those next to them along x.
template <class D, bool paired = HWY_TARGET != HWY_SCALAR && sizeof(hn::TFromD<D>) == 4 && (hn::MaxLanes(D()) > 1)>
class Gather {
 public:
  HWY_INLINE explicit Gather(Int<D> at) : at_(at) {}
  HWY_INLINE void operator()(const hn::TFromD<D>* v, Float<D>& here, Float<D>& next) const {
    here = hn::GatherIndex(D(), v, at_), next = hn::GatherIndex(D(), v + 1, at_);
  }

 private:
  Int<D> at_;
};

#if HWY_TARGET != HWY_SCALAR
// Two floats come from one load; single loads are faster than the instruction that gathers.
template <class D>
class Gather<D, true> {
  static constexpr size_t lanes = hn::MaxLanes(D());

 public:
  HWY_INLINE explicit Gather(Int<D> at) { hn::Store(at, hn::RebindToSigned<D>(), at_); }
  HWY_INLINE void operator()(const float* v, Float<D>& here, Float<D>& next) const {
    const Float<D> even = pairs<lanes / 2>(v, at_), odd = pairs<lanes / 2>(v, at_ + 1);
    here = hn::OddEven(hn::DupEven(odd), even), next = hn::OddEven(odd, hn::DupOdd(even));
  }

 private:
  // Of every second of 2 N lanes.
  template <size_t N>
  HWY_INLINE static hn::Vec<hn::FixedTag<float, 2 * N>> pairs(const float* v, const int32_t* at) {
    const hn::FixedTag<float, 2 * N> d;
    if constexpr (N == 1) return hn::LoadU(d, v + *at);
    else return hn::Combine(d, pairs<N / 2>(v, at + N), pairs<N / 2>(v, at));
  }

  HWY_ALIGN int32_t at_[lanes];
};
#endif

// A lattice seen from places between its numbers.
template <class D>
class Mixed {
  using T = hn::TFromD<D>;

 public:
  HWY_INLINE Mixed(const std::array<size_t, 3>& n, const Split<D>& i, const Split<D>& j, const Split<D>& k)
      : at_(index(n, i.cell, j.cell, k.cell)),
        gather_(at_),
        x_(i.share),
        y_(j.share),
        z_(k.share),
        along_y_(n[1] > 1 ? n[0] : 0),
        along_z_(n[2] > 1 ? n[0] * n[1] : 0) {}
  /// Without shares.
  HWY_INLINE Mixed(const std::array<size_t, 3>& n, Int<D> at)
      : at_(at), gather_(at_), along_y_(n[1] > 1 ? n[0] : 0), along_z_(n[2] > 1 ? n[0] * n[1] : 0) {}

  HWY_INLINE Int<D> at() const { return at_; }

  HWY_INLINE Float<D> sample(const T* v) const {
    const Float<D> low = plane(v);
    return along_z_ == 0 ? low : low + z_ * (plane(v + along_z_) - low);
  }
  // v held between the least and the largest of the numbers that sample(f) mixes.
  HWY_INLINE Float<D> held(Float<D> v, const T* f) const {
    Float<D> lo, hi;
    gather_(f, lo, hi);
    const Float<D> first = lo;
    lo = min(lo, hi), hi = max(first, hi);
    const auto take = [&](const T* p) HWY_ATTR {
      Float<D> a, b;
      gather_(p, a, b);
      lo = min(lo, min(a, b)), hi = max(hi, max(a, b));
    };
    take(f + along_y_);
    if (along_z_ > 0) take(f + along_z_), take(f + along_z_ + along_y_);
    return min(max(v, lo), hi);
  }

 private:
  HWY_INLINE static Int<D> index(const std::array<size_t, 3>& n, Float<D> i, Float<D> j, Float<D> k) {
    const hn::RebindToSigned<D> di;
    if constexpr (sizeof(T) == 8) return convert(di, i + T(n[0]) * (j + T(n[1]) * k));  // exact below 2^53
    else return convert(di, i) + set(di, int32_t(n[0])) * (convert(di, j) + set(di, int32_t(n[1])) * convert(di, k));
  }
  HWY_INLINE Float<D> line(const T* v) const {
    Float<D> a, b;
    gather_(v, a, b);
    return a + x_ * (b - a);
  }
  HWY_INLINE Float<D> plane(const T* v) const {
    const Float<D> a = line(v);
    return a + y_ * (line(v + along_y_) - a);
  }

  Int<D> at_;
  Gather<D> gather_;
  Float<D> x_, y_, z_;
  size_t along_y_, along_z_;
};

// Positions and ways in units of h.
template <class D>
class Tracer {
  using T = hn::TFromD<D>;

 public:
  HWY_INLINE Tracer(const Carrier<T>& step, T direction)
      : u_(step.velocity), flat_(step.grid.flat()), trace_(step.trace), dt_(direction * T(step.dt / step.grid.h)) {}

  // Where the flow takes p, at which it has the velocity k1.
  HWY_INLINE Place<D> moved(const Place<D>& p, const Place<D>& k1) const {
    if (trace_ == BackTrace::euler) return along(p, dt_, k1);
    const Place<D> k2 = velocity(along(p, dt_ / 2, k1));
    if (trace_ == BackTrace::rk2) return along(p, dt_, k2);
    const Place<D> k3 = velocity(along(p, dt_ * T(0.75), k2));  // Ralston 1962
    const auto mean = [&](Float<D> a, Float<D> b, Float<D> c) HWY_ATTR { return T(2) * a + T(3) * b + T(4) * c; };
    return along(p, dt_ / 9, {mean(k1.x, k2.x, k3.x), mean(k1.y, k2.y, k3.y), mean(k1.z, k2.z, k3.z)});
  }

 private:
  HWY_INLINE static Place<D> along(const Place<D>& p, T t, const Place<D>& way) {
    return {p.x + t * way.x, p.y + t * way.y, p.z + t * way.z};
  }
  HWY_INLINE Place<D> velocity(const Place<D>& p) const {
    const auto &nx = u_[0].n, &ny = u_[1].n, &nz = u_[2].n;
    const Split<D> i(p.x, nx[0]), j(p.y, ny[1]), k(p.z, nz[2]);                                // among faces across the axis
    const Split<D> i2(p.x - T(0.5), ny[0]), j2(p.y - T(0.5), nx[1]), k2(p.z - T(0.5), nx[2]);  // among middles
    return {Mixed<D>(nx, i, j2, k2).sample(u_[0].values.data()), Mixed<D>(ny, i2, j, k2).sample(u_[1].values.data()),
            flat_ ? set(D(), 0) : Mixed<D>(nz, i2, j2, k).sample(u_[2].values.data())};
  }

  const Faces<T>& u_;
  bool flat_;
  BackTrace trace_;
  T dt_;
};

// The places [i, i + lanes) of a row.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void carry_some(const Carrier<T>& step, const Tracer<D>& tracer, int axis, Pass pass, std::span<const Carried<T>> fields,
                           T* marks, size_t i, size_t row, const T* const u[3]) {
  const D d;
  const hn::RebindToSigned<D> di;
  const auto& n = fields.front().f->n;
  const auto shift = MacGrid::shift(axis);
  const size_t first = i + row * n[0];
  const T sx = T(shift[0]), sy = T(shift[1]), sz = T(shift[2]);
  const Place<D> here{hn::Iota(d, T(i)) + sx, set(d, T(row % n[1]) + sy), set(d, T(row / n[1]) + sz)};
  const Place<D> p = tracer.moved(here, {hn::LoadU(d, u[0] + i), hn::LoadU(d, u[1] + i), hn::LoadU(d, u[2] + i)});
  const Mixed<D> there(n, Split<D>(p.x - sx, n[0]), Split<D>(p.y - sy, n[1]), Split<D>(p.z - sz, n[2]));
  if (pass == Pass::back_marked) hn::StoreU(bit_cast(d, there.at()), d, marks + first);
  for (const Carried<T>& c : fields) {
    const T *const f = c.f->values.data(), *const s = c.scratch->values.data();
    const auto store = [&](Float<D> v, Lattice<T>* to) HWY_ATTR { hn::StoreU(v, d, to->values.data() + first); };
    switch (pass) {
      case Pass::back: store(there.sample(f), c.out); break;
      case Pass::back_marked: store(there.sample(f), c.scratch); break;
      case Pass::correct: {
        // Forth and back again, f would have become this; half of the difference is the error of a step.
        const Float<D> again = there.sample(s);
        const Float<D> v = hn::LoadU(d, s + first) + (hn::LoadU(d, f + first) - again) * T(0.5);
        store(step.limit ? Mixed<D>(n, bit_cast(di, hn::LoadU(d, marks + first))).held(v, f) : v, c.out);
        break;
      }
      case Pass::compensate: {
        const Float<D> again = there.sample(c.out->values.data()), now = hn::LoadU(d, f + first);
        store(now + (now - again) * T(0.5), c.scratch);
        break;
      }
      case Pass::back_limited: {
        const Float<D> v = there.sample(s);
        store(step.limit ? there.held(v, f) : v, c.out);
        break;
      }
    }
  }
}

template <class T>
void carry_all(const Carrier<T>& step, int axis, Pass pass, std::span<const Carried<T>> fields, Lattice<T>& marks, size_t begin,
               size_t end) {
  using Wide = hn::CappedTag<T, 16>;
  using Narrow = hn::CappedTag<T, 1>;
  const T direction = pass == Pass::correct || pass == Pass::compensate ? T(1) : T(-1);
  const Tracer<Wide> tracer(step, direction);
  const Tracer<Narrow> narrow(step, direction);
  const size_t n = fields.front().f->n[0], lanes = hn::Lanes(Wide());
  std::vector<T> velocities(3 * n);
  T* const u[3] = {velocities.data(), velocities.data() + n, velocities.data() + 2 * n};
  for (size_t row = begin; row < end; ++row) {
    place_velocities(step.grid, step.velocity, axis, row, u);
    size_t i = 0;
    for (; i + lanes <= n; i += lanes) carry_some<Wide>(step, tracer, axis, pass, fields, marks.values.data(), i, row, u);
    for (; i < n; ++i) carry_some<Narrow>(step, narrow, axis, pass, fields, marks.values.data(), i, row, u);
  }
}

void carry_floats(const Carrier<float>& step, int axis, Pass pass, std::span<const Carried<float>> fields, Lattice<float>& marks,
                  size_t begin, size_t end) {
  carry_all(step, axis, pass, fields, marks, begin, end);
}
void carry_doubles(const Carrier<double>& step, int axis, Pass pass, std::span<const Carried<double>> fields, Lattice<double>& marks,
                   size_t begin, size_t end) {
  carry_all(step, axis, pass, fields, marks, begin, end);
}

}  // namespace sg::fluid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::fluid {
HWY_EXPORT(carry_floats);
HWY_EXPORT(carry_doubles);

template <>
void carry_rows(const Carrier<float>& step, int axis, Pass pass, std::span<const Carried<float>> fields, Lattice<float>& marks,
                size_t begin, size_t end) {
  HWY_DYNAMIC_DISPATCH(carry_floats)(step, axis, pass, fields, marks, begin, end);
}
template <>
void carry_rows(const Carrier<double>& step, int axis, Pass pass, std::span<const Carried<double>> fields, Lattice<double>& marks,
                size_t begin, size_t end) {
  HWY_DYNAMIC_DISPATCH(carry_doubles)(step, axis, pass, fields, marks, begin, end);
}
}  // namespace sg::fluid
#endif
