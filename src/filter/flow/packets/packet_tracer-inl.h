// SPDX-License-Identifier: Apache-2.0
// The loop over steps that packets of every mesh kind share; included once per target, after hwy/highway.h. A Mesh works in numbers of type
// Real, and has
//   void start(size_t lane, const Item&)             puts a particle at its seed
//   bool velocity(size_t lane, Real v[3])            velocity there
//   void look(const Real (&move)[3][N], size_t active, Real (&v)[3][N], Int* ok)   velocities at the places moved by `move`
//   void go(size_t lane)                                 to the place that was looked at last
//   void copy(size_t to, size_t from)                    of all that it knows of a lane
//   Record place: x(size_t lane, Real x[3]), cell(size_t lane) size of the cell
#if defined(SG_PACKET_TRACER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_TRACER_INL_H_
#undef SG_PACKET_TRACER_INL_H_
#else
#define SG_PACKET_TRACER_INL_H_
#endif

#include "base/simd/vector-inl.h"
#include "filter/flow/packets/packets.h"
#include "filter/flow/trace_line.h"

HWY_BEFORE_NAMESPACE();
namespace sg::packets::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

constexpr size_t N = lanes;

/// Steps that watch their error see the rounding of f32 in it.
inline bool in_f64(const TraceOptions& o) { return o.scheme == Scheme::dormand_prince; }

// out = scale * (c0 k0 + c1 k1 + ...), each lane with its own scale.
template <class T, size_t K>
HWY_INLINE void combine(const T* scale, const T (*const (&k)[K])[3][N], const T (&c)[K], T (&out)[3][N]) {
  const hn::CappedTag<T, N> d;
  for (int a = 0; a < 3; ++a)
    for (size_t l = 0; l < N; l += hn::Lanes(d)) {
      auto sum = c[0] * hn::Load(d, &(*k[0])[a][l]);
      for (size_t n = 1; n < K; ++n) sum = sum + c[n] * hn::Load(d, &(*k[n])[a][l]);
      hn::Store(hn::Load(d, scale + l) * sum, d, &out[a][l]);
    }
}

template <class Mesh>
class Tracer {
 public:
  using T = typename Mesh::Real;
  using DR = hn::CappedTag<T, N>;
  using DI = hn::RebindToSigned<DR>;
  using Int = hn::TFromD<DI>;
  using Lanes3 = T[3][N];
  Tracer(Mesh& mesh, const TraceOptions& options, float sign, Lines& out) : mesh_(mesh), o_(options), sign_(sign), out_(out) {
    adaptive_ = o_.scheme == Scheme::dormand_prince;
    sized_ = o_.unit == StepUnit::cells;
    along_ = detail::by_length(o_);
    bounded_ = std::isfinite(o_.max_time) || std::isfinite(o_.max_length);
  }

  template <class Item>
  void run(std::span<const Item> items) {
    size_t next = 0;
    const auto refill = [&](size_t lane) {
      while (next < items.size()) {
        const auto item = uint32_t(next++);
        mesh_.start(lane, items[item]);
        if (begin(lane, item)) return true;
      }
      return false;
    };
    for (auto& r : records_) r.resize(256);
    while (active_ < N && refill(active_)) ++active_;
    while (active_ > 0) {
      for (size_t l = 0; l < active_;) {
        StopReason why{};
        const bool goes = end_[l] < 0 && prepare(l, why);
        if (goes) {
          ++l;
          continue;
        }
        finish(l, end_[l] >= 0 ? StopReason(end_[l]) : why);
        if (refill(l)) continue;
        // The last lane moves here; this lane's list of records goes there.
        --active_;
        if (l < active_) copy(l, active_);
      }
      if (active_ == 0) break;
      if (adaptive_) step_adaptive();
      else step_fixed();
    }
  }

 private:
  bool begin(size_t l, uint32_t item) {
    item_[l] = item, count_[l] = 0;
    T v[3];
    if (!mesh_.velocity(l, v)) {
      out_.lines.push_back({item, nullptr, 0, StopReason::outside});
      return false;
    }
    for (int a = 0; a < 3; ++a) v_[a][l] = start_v_[a][l] = v[a];
    mesh_.x(l, &x_[l][0]);
    for (size_t a = 0; a < 3; ++a) start_x_[l][a] = x_[l][a];
    t_[l] = arc_[l] = drift_[l] = 0, steps_[l] = 0, suggested_[l] = 0, retry_[l] = false, away_[l] = false, end_[l] = -1;
    first_cell_[l] = o_.closed ? mesh_.cell(l) : 1;
    record(l);
    return true;
  }
  void finish(size_t l, StopReason why) { out_.lines.push_back({item_[l], out_.keep({records_[l].data(), count_[l]}), count_[l], why}); }
  void copy(size_t to, size_t from) {
    mesh_.copy(to, from);
    std::swap(records_[to], records_[from]);
    item_[to] = item_[from], count_[to] = count_[from];
    for (int a = 0; a < 3; ++a) v_[a][to] = v_[a][from], start_v_[a][to] = start_v_[a][from];
    for (size_t a = 0; a < 3; ++a) x_[to][a] = x_[from][a], start_x_[to][a] = start_x_[from][a];
    t_[to] = t_[from], arc_[to] = arc_[from], drift_[to] = drift_[from], steps_[to] = steps_[from], suggested_[to] = suggested_[from];
    retry_[to] = retry_[from], away_[to] = away_[from], end_[to] = end_[from], first_cell_[to] = first_cell_[from];
    h_[to] = h_[from], timed_[to] = timed_[from], smallest_[to] = smallest_[from], halvings_[to] = halvings_[from],
    border_[to] = border_[from];
  }
  void record(size_t l) {
    if (count_[l] == records_[l].size()) records_[l].resize(2 * count_[l]);
    records_[l][count_[l]++] = {{float(x_[l][0]), float(x_[l][1]), float(x_[l][2])},
                                {float(v_[0][l]), float(v_[1][l]), float(v_[2][l])},
                                float(t_[l]),
                                float(arc_[l])};
  }
  T time_of(double size, T speed, T cell) const { return T(detail::time_of(o_, size, double(speed), double(cell))); }

  // The size of the next step as in trace_line(); false when the line has ended.
  HWY_INLINE bool prepare(size_t l, StopReason& why) {
    if (retry_[l]) return true;
    if (steps_[l] >= o_.max_steps) return why = StopReason::steps, false;
    const T speed = std::sqrt(v_[0][l] * v_[0][l] + v_[1][l] * v_[1][l] + v_[2][l] * v_[2][l]), cell = sized_ ? mesh_.cell(l) : T(1);
    if (!(double(speed) > o_.min_speed)) return why = StopReason::speed, false;
    T h = suggested_[l] > 0 ? suggested_[l] : time_of(o_.step, speed, cell);
    if (adaptive_) {
      smallest_[l] = time_of(o_.min_step, speed, cell);
      h = std::min(std::max(h, smallest_[l]), time_of(o_.max_step, speed, cell));
    } else {
      smallest_[l] = time_of(o_.min_step, speed, cell);
    }
    if (bounded_) {
      const double time_left = o_.max_time - std::abs(t_[l]), left = std::min(time_left, (o_.max_length - arc_[l]) / double(speed));
      if (!(left > 1e-6 * double(h))) return why = time_left <= 1e-6 * double(h) ? StopReason::time : StopReason::length, false;
      h = std::min(h, T(left));
    }
    h_[l] = h, halvings_[l] = 0, border_[l] = false, timed_[l] = along_ ? 0 : -1;
    return true;
  }

  void signed_steps() {
    for (size_t l = 0; l < N; ++l) s_[l] = l < active_ ? T(sign_) * h_[l] : T(0);
  }
  void look(Lanes3& move, Lanes3& v, bool first) {
    Int* to = first ? ok_ : look_ok_;
    mesh_.look(move, active_, v, to);
    if (first) return;
    for (size_t l = 0; l < N; ++l) ok_[l] &= look_ok_[l];
  }

  // Steps in length (see detail::AlongFlow): directions instead of velocities, and how long a unit takes. Lanes in time keep theirs.
  HWY_INLINE void direct(const Lanes3& v, Lanes3& u, const T* still, T* slow) {
    const DR d;
    const DI di;
    const auto one = set(d, T(1));
    for (size_t l = 0; l < N; l += hn::Lanes(d)) {
      const auto x = hn::Load(d, &v[0][l]), y = hn::Load(d, &v[1][l]), z = hn::Load(d, &v[2][l]);
      const auto square = x * x + y * y + z * z;
      const auto timed = rebind(d, hn::Load(di, timed_ + l) != 0), moves = square > 0;
      const auto speed = sqrt(square), inverse = one / select(moves, speed, one);
      const auto by = select(timed, one, inverse);
      hn::Store(x * by, d, &u[0][l]), hn::Store(y * by, d, &u[1][l]), hn::Store(z * by, d, &u[2][l]);
      hn::Store(select(timed | moves, by, hn::Load(d, still + l)), d, slow + l);
    }
  }
  void step_fixed() {
    signed_steps();
    if (!along_) {
      if (o_.scheme == Scheme::rk4) {
        combine<T, 1>(s_, {&v_}, {T(0.5)}, move_), look(move_, k_[0], true);
        combine<T, 1>(s_, {&k_[0]}, {T(0.5)}, move_), look(move_, k_[1], false);
        combine<T, 1>(s_, {&k_[1]}, {T(1)}, move_), look(move_, k_[2], false);
        combine<T, 4>(s_, {&v_, &k_[0], &k_[1], &k_[2]}, {T(1) / 6, T(2) / 6, T(2) / 6, T(1) / 6}, move_);
      } else {  // midpoint
        combine<T, 1>(s_, {&v_}, {T(0.5)}, move_), look(move_, k_[0], true);
        combine<T, 1>(s_, {&k_[0]}, {T(1)}, move_);
      }
      std::copy(s_, s_ + N, dt_);
    } else {
      step_along();
    }
    look(move_, k_[3], false);
    for (size_t l = 0; l < active_; ++l) {
      if (!ok_[l]) halve(l);
      else if (along_ && bounded_ && !timed_[l] && !(std::abs(t_[l]) + std::abs(double(dt_[l])) <= o_.max_time))
        timed_[l] = -1, retry_[l] = true, h_[l] = std::min(h_[l], T(o_.max_time - std::abs(t_[l])));  // the last one ends in time
      else advance(l, k_[3], 0);
    }
  }
  void step_along() {
    HWY_ALIGN T none[N] = {}, slow[4][N];
    direct(v_, k_[4], none, slow[0]);
    for (size_t l = 0; l < active_; ++l) s_[l] = timed_[l] ? s_[l] : s_[l] / slow[0][l];
    const auto stage = [&](Lanes3& k, size_t n, bool first) {
      look(move_, k, first);
      direct(k, k, slow[0], slow[n]);
    };
    if (o_.scheme == Scheme::rk4) {
      combine<T, 1>(s_, {&k_[4]}, {T(0.5)}, move_), stage(k_[0], 1, true);
      combine<T, 1>(s_, {&k_[0]}, {T(0.5)}, move_), stage(k_[1], 2, false);
      combine<T, 1>(s_, {&k_[1]}, {T(1)}, move_), stage(k_[2], 3, false);
      combine<T, 4>(s_, {&k_[4], &k_[0], &k_[1], &k_[2]}, {T(1) / 6, T(2) / 6, T(2) / 6, T(1) / 6}, move_);
      for (size_t l = 0; l < N; ++l) dt_[l] = s_[l] / 6 * (slow[0][l] + 2 * slow[1][l] + 2 * slow[2][l] + slow[3][l]);
    } else {
      combine<T, 1>(s_, {&k_[4]}, {T(0.5)}, move_), stage(k_[0], 1, true);
      combine<T, 1>(s_, {&k_[0]}, {T(1)}, move_);
      for (size_t l = 0; l < N; ++l) dt_[l] = s_[l] * slow[1][l];
    }
  }

  // Dormand and Prince as in integrator.h.
  void step_adaptive() {
    signed_steps();
    std::copy(s_, s_ + N, dt_);
    combine<T, 1>(s_, {&v_}, {T(1) / 5}, move_), look(move_, k_[0], true);
    combine<T, 2>(s_, {&v_, &k_[0]}, {T(3) / 40, T(9) / 40}, move_), look(move_, k_[1], false);
    combine<T, 3>(s_, {&v_, &k_[0], &k_[1]}, {T(44) / 45, T(-56) / 15, T(32) / 9}, move_), look(move_, k_[2], false);
    combine<T, 4>(s_, {&v_, &k_[0], &k_[1], &k_[2]}, {T(19372) / 6561, T(-25360) / 2187, T(64448) / 6561, T(-212) / 729}, move_),
        look(move_, k_[3], false);
    combine<T, 5>(s_, {&v_, &k_[0], &k_[1], &k_[2], &k_[3]}, {T(9017) / 3168, T(-355) / 33, T(46732) / 5247, T(49) / 176, T(-5103) / 18656},
                  move_),
        look(move_, k_[4], false);
    combine<T, 5>(s_, {&v_, &k_[1], &k_[2], &k_[3], &k_[4]}, {T(35) / 384, T(500) / 1113, T(125) / 192, T(-2187) / 6784, T(11) / 84},
                  move_),
        look(move_, k_[5], false);
    combine<T, 6>(s_, {&v_, &k_[1], &k_[2], &k_[3], &k_[4], &k_[5]},
                  {T(71) / 57600, T(-71) / 16695, T(71) / 1920, T(-17253) / 339200, T(22) / 525, T(-1) / 40}, error_);
    for (size_t l = 0; l < active_; ++l) {
      if (!ok_[l]) {
        halve(l);
        continue;
      }
      const T e = std::sqrt(error_[0][l] * error_[0][l] + error_[1][l] * error_[1][l] + error_[2][l] * error_[2][l]);
      const double error = double(e) / (o_.tolerance * double(mesh_.cell(l)));
      if (error > 1 && h_[l] > smallest_[l] * T(1.001)) {
        h_[l] = std::max(T(detail::next_step(double(h_[l]), error)), smallest_[l]);
        retry_[l] = true;
        continue;
      }
      suggested_[l] = T(detail::next_step(double(h_[l]), error));
      advance(l, k_[5], e);
    }
  }

  void halve(size_t l) {
    border_[l] = true, retry_[l] = true, h_[l] /= 2;
    if (++halvings_[l] > 10) end_[l] = int8_t(StopReason::outside);
  }
  HWY_INLINE void advance(size_t l, const Lanes3& v, T error) {
    const T m[3] = {move_[0][l], move_[1][l], move_[2][l]};
    const double before_arc = arc_[l];
    const T before_x[3] = {x_[l][0], x_[l][1], x_[l][2]}, before_v[3] = {v_[0][l], v_[1][l], v_[2][l]};
    mesh_.go(l);
    mesh_.x(l, &x_[l][0]);
    for (int a = 0; a < 3; ++a) v_[a][l] = v[a][l];
    t_[l] += double(dt_[l]), arc_[l] = before_arc + double(std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]));
    drift_[l] += error, ++steps_[l], retry_[l] = false;
    if (o_.closed && closes(l, before_x, before_v, before_arc)) return;
    record(l);
    if (border_[l] && h_[l] < smallest_[l]) end_[l] = int8_t(StopReason::outside);
  }
  // Back at the seed, by the rule of trace_line().
  bool closes(size_t l, const T* before_x, const T* before_v, double before_arc) {
    const auto vec = [](const T* p) { return Vec3(double(p[0]), double(p[1]), double(p[2])); };
    const T* start = &start_x_[l][0];
    T before = 0, after = 0, gone = 0, moved = 0;
    for (size_t a = 0; a < 3; ++a) {
      const T now = x_[l][a] - start[a], was = before_x[a] - start[a], step = x_[l][a] - before_x[a];
      before += was * start_v_[a][l], after += now * start_v_[a][l], gone += now * now, moved += step * step;
    }
    away_[l] = away_[l] || gone > first_cell_[l] * first_cell_[l];
    if (!away_[l] || !(T(sign_) * before < 0) || !(T(sign_) * after >= 0) || gone >= 4 * moved) return false;
    const T now_v[3] = {v_[0][l], v_[1][l], v_[2][l]}, seed_v[3] = {start_v_[0][l], start_v_[1][l], start_v_[2][l]};
    double f = 0;
    const double h = double(sign_) * double(h_[l]), now = length(vec(now_v));
    const double h1 = !timed_[l] && now > 0 ? h * length(vec(before_v)) / now : h;
    const Vec3 back =
        detail::crossing(vec(before_x), vec(&x_[l][0]), h * vec(before_v), h1 * vec(now_v), vec(start), double(sign_) * vec(seed_v), f);
    const double cell = double(first_cell_[l]), miss = adaptive_ ? std::clamp(double(drift_[l]), 1e-4 * cell, 1e-2 * cell) : 1e-3 * cell;
    if (!(length(back - vec(start)) < miss)) return false;
    t_[l] -= double(dt_[l]) * (1 - f), arc_[l] = before_arc + f * (arc_[l] - before_arc);
    for (size_t a = 0; a < 3; ++a) x_[l][a] = start[a], v_[a][l] = start_v_[a][l];
    record(l);
    end_[l] = int8_t(StopReason::closed);
    return true;
  }

  Mesh& mesh_;
  const TraceOptions& o_;
  const float sign_;
  Lines& out_;
  bool adaptive_ = false, bounded_ = false, sized_ = true, along_ = false;
  size_t active_ = 0;
  HWY_ALIGN Lanes3 v_ = {}, start_v_ = {}, move_ = {}, error_ = {}, k_[6] = {};
  HWY_ALIGN T s_[N] = {}, dt_[N] = {};  // the step, in length or time, and the time that it takes
  HWY_ALIGN Int ok_[N] = {}, look_ok_[N] = {}, timed_[N] = {};
  T x_[N][3] = {}, start_x_[N][3] = {};
  T h_[N] = {}, suggested_[N] = {}, smallest_[N] = {}, drift_[N] = {}, first_cell_[N] = {};
  double t_[N] = {}, arc_[N] = {};
  int64_t steps_[N] = {};
  int halvings_[N] = {};
  bool retry_[N] = {}, away_[N] = {}, border_[N] = {};
  int8_t end_[N] = {};
  // Of the lines in progress.
  std::vector<Record> records_[N];
  size_t count_[N] = {};
  uint32_t item_[N] = {};
};

}  // namespace sg::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
