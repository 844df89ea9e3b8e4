// SPDX-License-Identifier: Apache-2.0
// The maximum of the trilinear field along a ray. Within a cell the field along a ray is a cubic, so its maximum is found
// exactly; cells and bricks whose largest corner is not above the best so far are passed over.
#include "render/volume/lattice/runs.h"

namespace sg::volume {

namespace {

/// Walks the boxes of a grid that a ray crosses between t and end; side(axis, i) is the q of the lower side of box i.
template <class Side>
struct Walk {
  Vec3 start, along, per_along;
  long box[3];
  double t, end, next[3];
  const Side& side;

  Walk(const Course& c, double from, double to, const long first[3], const Side& s)
      : start(c.start), along(c.along), t(from), end(to), side(s) {
    for (int a = 0; a < 3; ++a) box[a] = first[a], per_along[a] = along[a] != 0 ? 1 / along[a] : 0, next[a] = crossing(a);
  }
  double crossing(int a) const {
    if (along[a] == 0) return HUGE_VAL;
    const double at = (side(a, box[a] + (along[a] > 0)) - start[a]) * per_along[a];
    return std::max(at, t);
  }
  double leave() const { return std::min({next[0], next[1], next[2], end}); }
  /// Goes on to the next box; false at the end.
  bool advance() {
    t = leave();
    if (!(t < end)) return false;
    for (int a = 0; a < 3; ++a)
      if (next[a] <= t) box[a] += along[a] > 0 ? 1 : -1, next[a] = crossing(a);
    return true;
  }
};

template <class T>
class Search {
 public:
  Search(const Volume& v, const Course& c, bool skip)
      : v_(v), c_(c), skip_(skip), data_(reinterpret_cast<const T*>(v.voxels.array.raw())) {}

  Maximum run() {
    const auto side = [this](int a, long i) {
      if (i <= 0) return -HUGE_VAL;
      return size_t(i) >= v_.bricks().dims[size_t(a)] ? HUGE_VAL : v_.border[a][size_t(i)];
    };
    long first[3];
    for (int a = 0; a < 3; ++a)
      first[a] = std::clamp<long>(cell_at(a, c_.enter), 0, long(v_.voxels.dims[size_t(a)]) - 2) >> MinMaxBricks::shift;
    if (skip_) raise_floor(c_.enter, c_.leave);
    // The brick with the largest value first: most others then lie below what is found there.
    std::vector<Crossed>& crossed = crossed_;
    crossed.clear();
    for (Walk walk(c_, c_.enter, c_.leave, first, side);;) {
      bool inside = true;
      for (int a = 0; a < 3; ++a) inside = inside && walk.box[a] >= 0 && walk.box[a] < long(v_.bricks().dims[size_t(a)]);
      if (!inside) break;
      const MinMaxBricks::Range r = v_.bricks().ranges[v_.bricks().id(size_t(walk.box[0]), size_t(walk.box[1]), size_t(walk.box[2]))];
      if (!r.empty() && !(skip_ && r.hi < floor_)) crossed.push_back({r.hi, {walk.box[0], walk.box[1], walk.box[2]}, walk.t, walk.leave()});
      if (!walk.advance()) break;
    }
    while (!crossed.empty()) {
      const auto top = std::max_element(crossed.begin(), crossed.end(), [](const Crossed& a, const Crossed& b) { return a.hi < b.hi; });
      if (skip_ && (top->hi < floor_ || (best_.found && top->hi <= best_.value))) break;
      const Crossed now = *top;
      *top = crossed.back();
      crossed.pop_back();
      brick(now.box, now.t, now.leave);
    }
    return best_;
  }

 private:
  struct Crossed {
    float hi;
    long box[3];
    double t, leave;
  };

  double sample_q(int a, long i) const { return v_.affine ? double(i) : v_.coordinates[a][size_t(i)]; }

  /// Cell of the place at t; -1 and samples-1 are the halves beyond the outermost samples, where values are clamped.
  long cell_at(int a, double t) const {
    const double q = c_.start[a] + t * c_.along[a];
    const long last = long(v_.voxels.dims[size_t(a)]) - 1;
    if (q < sample_q(a, 0)) return -1;
    if (q >= sample_q(a, last)) return q > sample_q(a, last) ? last : last - 1;
    return long(v_.u(a, q));
  }

  void brick(const long box[3], double from, double to) {
    const auto side = [this](int a, long i) {
      if (i < 0) return -HUGE_VAL;
      return i > long(v_.voxels.dims[size_t(a)]) - 1 ? HUGE_VAL : sample_q(a, i);
    };
    long first[3], lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      const long cells = long(v_.voxels.dims[size_t(a)]) - 1;
      lo[a] = box[a] << MinMaxBricks::shift, hi[a] = std::min(lo[a] + MinMaxBricks::edge, cells) - 1;
      if (lo[a] == 0) lo[a] = -1;
      if (hi[a] == cells - 1) hi[a] = cells;
      first[a] = std::clamp(cell_at(a, from), lo[a], hi[a]);
    }
    if (skip_) raise_floor(from, to);
    Walk walk(c_, from, to, first, side);
    do {
      for (int a = 0; a < 3; ++a)
        if (walk.box[a] < lo[a] || walk.box[a] > hi[a]) return;
      cell(walk.box, walk.t, walk.leave());
    } while (walk.advance());
  }

  /// Some samples on the way say what the maximum is at least, short of rounding errors: cells below that are not looked at.
  void raise_floor(double from, double to) {
    Run run;
    for (int n = 0; n < run_length; ++n) {
      const double t = from + (to - from) * ((n + 0.5) / run_length);
      run.ux[n] = v_.u(0, c_.start.x + t * c_.along.x), run.uy[n] = v_.u(1, c_.start.y + t * c_.along.y),
      run.uz[n] = v_.u(2, c_.start.z + t * c_.along.z);
    }
    finish_values(v_, run);
    for (int n = 0; n < run_length; ++n) {
      const float least = run.value[n] - 1e-5f * std::abs(run.value[n]);
      if (least > floor_ && least < HUGE_VALF) floor_ = least;
    }
  }

  void offer(double value, double t) {
    if (!best_.found || value > double(best_.value)) best_ = {float(value), t, true};
  }

  void cell(const long box[3], double from, double to) {
    size_t at[3];
    for (size_t a = 0; a < 3; ++a) at[a] = size_t(std::clamp(box[a], 0l, long(v_.voxels.dims[a]) - 2));
    const size_t nx = v_.voxels.dims[0], ny = v_.voxels.dims[1];
    if (!v_.hidden().empty() && v_.hidden()[at[0] + (nx - 1) * (at[1] + (ny - 1) * at[2])]) return;
    const T* p = data_ + at[0] + nx * (at[1] + ny * at[2]);
    const size_t offset[4] = {0, nx, nx * ny, nx * ny + nx};
    T top = p[0];
    bool nan = false;
    for (const size_t o : offset) {
      const T a = p[o], b = p[o + 1];
      if constexpr (std::is_floating_point_v<T>) nan = nan || a != a || b != b;
      top = std::max({top, a, b});
    }
    if (nan) {
      if (v_.dual) beside_nan(from, to);
      return;
    }
    if (skip_ && (float(top) < floor_ || (best_.found && float(top) <= best_.value))) return;
    // The ray's fraction of each edge at both ends; constant in the clamped halves.
    double f0[3], df[3], corner[8];
    for (int i = 0; i < 8; ++i) corner[i] = double(p[offset[i / 2] + size_t(i % 2)]);
    for (int a = 0; a < 3; ++a) {
      f0[a] = box[a] < 0 ? 0 : 1, df[a] = 0;
      if (box[a] < 0 || box[a] > long(v_.voxels.dims[size_t(a)]) - 2) continue;
      const double q0 = sample_q(a, box[a]), edge = sample_q(a, box[a] + 1) - q0;
      f0[a] = edge > 0 ? std::clamp((c_.start[a] + from * c_.along[a] - q0) / edge, 0.0, 1.0) : 0;
      df[a] = edge > 0 ? std::clamp((c_.start[a] + to * c_.along[a] - q0) / edge, 0.0, 1.0) - f0[a] : 0;
    }
    const auto value = [&](double s) {
      const double x = f0[0] + s * df[0], y = f0[1] + s * df[1], z = f0[2] + s * df[2];
      double along_x[4], along_y[2];
      for (int i = 0; i < 4; ++i) along_x[i] = corner[2 * i] * (1 - x) + corner[2 * i + 1] * x;
      for (int i = 0; i < 2; ++i) along_y[i] = along_x[2 * i] * (1 - y) + along_x[2 * i + 1] * y;
      return along_y[0] * (1 - z) + along_y[1] * z;
    };
    // The cubic a s^3 + b s^2 + c s + f(0) through four places, and the zeros of its derivative.
    const double v0 = value(0), v1 = value(1.0 / 3), v2 = value(2.0 / 3), v3 = value(1);
    offer(v0, from), offer(v3, to);
    const double a = 4.5 * (v3 - v0 + 3 * (v1 - v2)), b = 4.5 * (2 * v0 - 5 * v1 + 4 * v2 - v3),
                 c = 0.5 * (-11 * v0 + 18 * v1 - 9 * v2 + 2 * v3);
    const double discriminant = b * b - 3 * a * c;
    if (!(discriminant > 0)) return;
    const double root = -(b + std::copysign(std::sqrt(discriminant), b));
    for (const double s : {root != 0 ? c / root : -1.0, a != 0 ? root / (3 * a) : -1.0})
      if (s > 0 && s < 1) offer(value(s), from + s * (to - from));
  }

  /// Cells of data beside one without a value: by samples.
  void beside_nan(double from, double to) {
    Run run;
    for (int n = 0; n < run_length; ++n) {
      const double t = from + (to - from) * n / (run_length - 1);
      run.ux[n] = v_.u(0, c_.start.x + t * c_.along.x), run.uy[n] = v_.u(1, c_.start.y + t * c_.along.y),
      run.uz[n] = v_.u(2, c_.start.z + t * c_.along.z);
    }
    finish_values(v_, run);
    for (int n = 0; n < run_length; ++n)
      if (run.value[n] == run.value[n]) offer(double(run.value[n]), from + (to - from) * n / (run_length - 1));
  }

  const Volume& v_;
  const Course& c_;
  const bool skip_;
  const T* data_;
  Maximum best_{0, 0, false};
  float floor_ = -HUGE_VALF;
  std::vector<Crossed> crossed_;
};

}  // namespace

Maximum maximum_along(const Volume& v, const Course& c, const Knobs& knobs) {
  if (!(c.leave > c.enter)) return {0, 0, false};
  switch (v.voxels.array.type()) {
    case ElementType::u8: return Search<uint8_t>(v, c, knobs.skip_empty).run();
    case ElementType::i8: return Search<int8_t>(v, c, knobs.skip_empty).run();
    case ElementType::u16: return Search<uint16_t>(v, c, knobs.skip_empty).run();
    case ElementType::i16: return Search<int16_t>(v, c, knobs.skip_empty).run();
    default: return Search<float>(v, c, knobs.skip_empty).run();
  }
}

}  // namespace sg::volume
