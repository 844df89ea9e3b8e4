// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/advect.h"

#include "base/parallel.h"

namespace sg::fluid {

namespace {

constexpr size_t place_rows = 8;

template <class T>
struct Place {
  T x, y, z;
  friend Place operator+(Place a, Place b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Place operator*(T s, Place a) { return {s * a.x, s * a.y, s * a.z}; }
};

// Positions and ways in units of h.
template <class T>
class Tracer {
 public:
  explicit Tracer(const Carrier<T>& step) : u_(step.velocity), flat_(step.grid.flat()), dt_(T(step.dt / step.grid.h)), trace_(step.trace) {}

  Place<T> velocity(Place<T> p) const {
    const auto along = [&](size_t a, T sx, T sy, T sz) {
      return Spot<T>(u_[a].n, p.x - sx, p.y - sy, p.z - sz).sample(u_[a].values.data());
    };
    constexpr T half = T(0.5);
    return {along(0, 0, half, half), along(1, half, 0, half), flat_ ? T(0) : along(2, half, half, 0)};
  }
  // Where the flow takes p in the time direction * dt.
  Place<T> moved(Place<T> p, T direction) const {
    const T dt = direction * dt_;
    const Place<T> k1 = velocity(p);
    if (trace_ == BackTrace::euler) return p + dt * k1;
    const Place<T> k2 = velocity(p + (dt / 2) * k1);
    if (trace_ == BackTrace::rk2) return p + dt * k2;
    const Place<T> k3 = velocity(p + (dt * T(0.75)) * k2);  // Ralston 1962
    return p + (dt / 9) * (T(2) * k1 + T(3) * k2 + T(4) * k3);
  }
  Place<T> change(Place<T> p) const { return dt_ * velocity(p); }

 private:
  const Faces<T>& u_;
  bool flat_;
  T dt_;
  BackTrace trace_;
};

// Calls f(i, at, place) for every place of a lattice: its indices and number, and where it lies.
template <class T, class F>
void each_place(const Lattice<T>& l, int axis, const Context& context, F&& f) {
  const auto shift = MacGrid::shift(axis);
  parallel_for(
      l.rows(), place_rows,
      [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) {
          const size_t j = row % l.n[1], k = row / l.n[1];
          for (size_t i = 0; i < l.n[0]; ++i)
            f(std::array<size_t, 3>{i, j, k}, i + row * l.n[0],
              Place<T>{T(double(i) + shift[0]), T(double(j) + shift[1]), T(double(k) + shift[2])});
        }
      },
      &context);
}

template <class T>
Spot<T> spot_at(const Lattice<T>& l, int axis, Place<T> p) {
  const auto shift = MacGrid::shift(axis);
  return {l.n, p.x - T(shift[0]), p.y - T(shift[1]), p.z - T(shift[2])};
}

// to = f where the flow was dt ago (direction -1), or will be.
template <class T>
void step_back(const Tracer<T>& tracer, int axis, const Lattice<T>& f, Lattice<T>& to, T direction, const Context& context) {
  each_place(f, axis, context, [&](const auto&, size_t at, Place<T> p) {
    to.values[at] = spot_at(f, axis, tracer.moved(p, direction)).sample(f.values.data());
  });
}

template <class T>
T limited(T value, const std::array<T, 2>& bounds) {
  return std::min(std::max(value, bounds[0]), bounds[1]);
}

template <class T>
void central(const Tracer<T>& tracer, int axis, const Lattice<T>& f, Lattice<T>& out, const Context& context) {
  const size_t stride[3] = {1, f.n[0], f.n[0] * f.n[1]};
  each_place(f, axis, context, [&](const std::array<size_t, 3>& i, size_t at, Place<T> p) {
    const Place<T> way = tracer.change(p);
    const T ways[3] = {way.x, way.y, way.z};
    T change = 0;
    for (size_t a = 0; a < 3; ++a) {
      const T before = f.values[i[a] > 0 ? at - stride[a] : at], after = f.values[i[a] + 1 < f.n[a] ? at + stride[a] : at];
      change += ways[a] * (after - before) / 2;
    }
    out.values[at] = f.values[at] - change;
  });
}

}  // namespace

template <class T>
void advect(const Carrier<T>& step, int axis, const Lattice<T>& f, Lattice<T>& out, Lattice<T>& scratch, const Context& context) {
  const Tracer<T> tracer(step);
  switch (step.scheme) {
    case Advection::explicit_euler: return central(tracer, axis, f, out, context);
    case Advection::semi_lagrangian: return step_back(tracer, axis, f, out, T(-1), context);
    case Advection::maccormack:
      step_back(tracer, axis, f, scratch, T(-1), context);
      return each_place(f, axis, context, [&](const auto&, size_t at, Place<T> p) {
        // Forth and back again, f would have become this; half of the difference is the error of a step.
        const T again = spot_at(scratch, axis, tracer.moved(p, T(1))).sample(scratch.values.data());
        const T value = scratch.values[at] + (f.values[at] - again) / 2;
        out.values[at] = step.limit ? limited(value, spot_at(f, axis, tracer.moved(p, T(-1))).bounds(f.values.data())) : value;
      });
    case Advection::bfecc:
      step_back(tracer, axis, f, out, T(-1), context);
      each_place(f, axis, context, [&](const auto&, size_t at, Place<T> p) {
        const T again = spot_at(out, axis, tracer.moved(p, T(1))).sample(out.values.data());
        scratch.values[at] = f.values[at] + (f.values[at] - again) / 2;
      });
      return each_place(f, axis, context, [&](const auto&, size_t at, Place<T> p) {
        const Spot<T> from = spot_at(f, axis, tracer.moved(p, T(-1)));
        const T value = from.sample(scratch.values.data());
        out.values[at] = step.limit ? limited(value, from.bounds(f.values.data())) : value;
      });
  }
}

template void advect(const Carrier<float>&, int, const Lattice<float>&, Lattice<float>&, Lattice<float>&, const Context&);
template void advect(const Carrier<double>&, int, const Lattice<double>&, Lattice<double>&, Lattice<double>&, const Context&);

}  // namespace sg::fluid
