// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/lattice_ray.h"

#include <cmath>

#include "render/volume/sources/lattice/derivatives.h"

namespace sg::volume {

namespace {

/// Boxes along one axis: of trilinear cells (box i from sample i to i+1; -1 and n-1 are the halves beyond the outermost samples, where
/// values are clamped), or of labels (box i around sample i).
class Axis {
 public:
  Axis(const Volume& v, int axis) : v_(v), axis_(axis), samples_(long(v.voxels.dims[size_t(axis)])) {}
  long first() const { return v_.nearest ? 0 : -1; }
  long last() const { return samples_ - 1; }
  double sample(long i) const { return v_.affine ? double(i) : v_.coordinates[axis_][size_t(i)]; }
  /// q of the lower side of box i.
  double side(long i) const {
    if (i <= first()) return -HUGE_VAL;
    if (i > last()) return HUGE_VAL;
    return v_.nearest ? 0.5 * (sample(i - 1) + sample(i)) : sample(i);
  }
  long box_at(double q) const {
    if (v_.nearest) return std::clamp(long(std::floor(double(v_.u(axis_, q)) + 0.5)), first(), last());
    if (q < sample(0)) return -1;
    if (q >= sample(samples_ - 1)) return q > sample(samples_ - 1) ? last() : last() - 1;
    return std::min(long(v_.u(axis_, q)), last() - 1);
  }
  /// The cell of samples from which a box takes its values.
  long cell(long box) const { return std::clamp<long>(box, 0, samples_ - 2); }
  DerivativeWeights weights(long i) const {
    return derivative_weights(i > 0 ? sample(i) - sample(i - 1) : 0, i + 1 < samples_ ? sample(i + 1) - sample(i) : 0);
  }
  double fraction(long cell, double q) const {
    const double from = sample(cell);
    return std::clamp(v_.affine ? q - from : (q - from) / (sample(cell + 1) - from), 0.0, 1.0);
  }

 private:
  const Volume& v_;
  int axis_;
  long samples_;
};

/// A walker that another one asks for its field.
class LatticeWalker : public RayField {
 public:
  virtual float at(double t) = 0;
};

template <class T>
class LatticeRay final : public LatticeWalker, public RaySpans {
 public:
  LatticeRay(std::shared_ptr<const Volume> v, const Invisible& invisible, std::unique_ptr<LatticeWalker> second)
      : second_(std::move(second)),
        volume_(std::move(v)),
        v_(*volume_),
        invisible_(invisible),
        axes_{Axis(v_, 0), Axis(v_, 1), Axis(v_, 2)},
        data_(reinterpret_cast<const T*>(v_.voxels.array.raw())),
        row_(v_.voxels.dims[0]),
        layer_(v_.voxels.dims[0] * v_.voxels.dims[1]) {}

  void start(Vec3 origin, Vec3 direction, double from, double to) override {
    if (second_) second_->start(origin, direction, from, to);
    std::fill(slopes_of_, slopes_of_ + 3, -9l);  // on a side between two cells the one of this ray counts, not of the one before
    c_ = course(v_, origin, direction, from, to);
    t_ = c_.enter, end_ = c_.leave, brick_ = size_t(-1);
    for (int a = 0; a < 3; ++a) {
      per_along_[a] = c_.along[a] != 0 ? 1 / c_.along[a] : 0;
      box_[a] = axes_[a].box_at(c_.start[a] + t_ * c_.along[a]);
      next_[a] = crossing(a);
    }
  }

  size_t next(std::span<Stretch> out) override {
    size_t count = 0;
    while (t_ < end_ && count + 4 <= out.size()) {
      size_t at[3], brick;
      for (size_t a = 0; a < 3; ++a) at[a] = size_t(axes_[a].cell(box_[a])) >> MinMaxBricks::shift;
      brick = v_.bricks().id(at[0], at[1], at[2]);
      if (brick != brick_) {
        brick_ = brick;
        const MinMaxBricks::Range r = v_.bricks().ranges[brick];
        empty_ = r.empty() || invisible_(r.lo, r.hi);
      }
      if (empty_) {
        leave_brick(at);
        continue;
      }
      const double leave = std::min({next_[0], next_[1], next_[2], end_});
      if (leave > t_) count += emit(leave, out.subspan(count));
      advance(leave);
    }
    return count;
  }

  double entry() const override { return c_.enter; }

  /// A brick at a time.
  bool next_span(Span& out) override {
    while (t_ < end_) {
      size_t at[3];
      for (size_t a = 0; a < 3; ++a) at[a] = size_t(axes_[a].cell(box_[a])) >> MinMaxBricks::shift;
      const MinMaxBricks::Range r = v_.bricks().ranges[v_.bricks().id(at[0], at[1], at[2])];
      const double from = t_;
      leave_brick(at);
      if (r.empty() || invisible_(r.lo, r.hi) || !(t_ > from)) continue;
      out = {from, t_, r.lo, r.hi};
      return true;
    }
    return false;
  }
  float value(double t) override { return value_at(clamped_place(t)); }

  /// Derivatives of parabolas at the corners of the cell, trilinear between them; on even axes those are, but for the outermost cells, the
  /// differences of the trilinear field over a cell to each side.
  Vec3f gradient(const Stretch&, double t) override { return gradient_at(c_.start + c_.along * t); }

  /// Differences of the gradient over half a cell to each side.
  bool bend(const Stretch&, double t, SecondDerivatives& h) override {
    // At the border, those of the nearest place whose differences have samples on both sides.
    Vec3 q = c_.start + c_.along * t, rows[3];
    for (int a = 0; a < 3; ++a)
      if (const long last = axes_[a].last(); last >= 4)
        q[a] = std::clamp(q[a], 0.5 * (axes_[a].sample(1) + axes_[a].sample(2)),
                          0.5 * (axes_[a].sample(last - 2) + axes_[a].sample(last - 1)));
    for (int a = 0; a < 3; ++a) {
      const double edge = v_.cell_length(a, q[a]), from = std::max(q[a] - 0.5 * edge, axes_[a].sample(0)),
                   to = std::min(q[a] + 0.5 * edge, axes_[a].sample(axes_[a].last()));
      Vec3 lo = q, hi = q;
      lo[a] = from, hi[a] = to;
      const Vec3f below = gradient_at(lo), above = gradient_at(hi);
      rows[a] = to > from ? Vec3(above - below) / (to - from) : Vec3{0, 0, 0};
    }
    // From q to the world by the transpose of world -> q.
    double m[3][3] = {};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        for (int a = 0; a < 3; ++a) m[r][c] += v_.to_q.m[a][r] * rows[a][c];
    h = {float(m[0][0]),
         float(m[1][1]),
         float(m[2][2]),
         float(0.5 * (m[0][1] + m[1][0])),
         float(0.5 * (m[0][2] + m[2][0])),
         float(0.5 * (m[1][2] + m[2][1]))};
    return true;
  }

  int samples(const Stretch&, double t, float values[8], float shares[8]) override {
    if (v_.nearest) return 0;
    long cell[3];
    double f[3];
    for (int a = 0; a < 3; ++a) {
      const double q = std::clamp(c_.start[a] + t * c_.along[a], axes_[a].sample(0), axes_[a].sample(axes_[a].last()));
      cell[a] = axes_[a].cell(long(v_.u(a, q))), f[a] = axes_[a].fraction(cell[a], q);
    }
    load(cell);
    int n = 0;
    double all = 0;
    for (int c = 0; c < 8; ++c) {
      if (corner_[c] != corner_[c]) continue;
      const double share = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
      values[n] = corner_[c], shares[n++] = float(share), all += share;
    }
    for (int i = 0; i < n; ++i) shares[i] = float(double(shares[i]) / all);
    return all > 0 ? n : 0;
  }

  float second(const Stretch& s, double t) override { return second_ ? second_->at(t) : (void(s), NAN); }
  /// Value at t of the ray that was started, base included.
  float at(double t) override { return value_at(clamped_place(t)) + v_.base; }

 private:
  Vec3 clamped_place(double t) const {
    Vec3 q;
    for (int a = 0; a < 3; ++a) q[a] = std::clamp(c_.start[a] + t * c_.along[a], axes_[a].sample(0), axes_[a].sample(axes_[a].last()));
    return q;
  }
  Vec3f gradient_at(Vec3 q) {
    long cell[3];
    double f[3];
    for (int a = 0; a < 3; ++a) {
      q[a] = std::clamp(q[a], axes_[a].sample(0), axes_[a].sample(axes_[a].last()));
      const long last = slopes_of_[a];  // most places lie in the cell of the one before
      const bool same = last >= 0 && q[a] >= axes_[a].sample(last) && q[a] <= axes_[a].sample(last + 1);
      cell[a] = same ? last : axes_[a].cell(long(v_.u(a, q[a])));
      f[a] = axes_[a].fraction(cell[a], q[a]);
    }
    find_slopes(cell);
    if (beside_holes_) return to_world(slope_beside_holes(q));
    Vec3 slope;
    for (int a = 0; a < 3; ++a) slope[a] = double(trilinear(slopes_[a], f));
    return to_world(slope);
  }
  Vec3f to_world(Vec3 slope) const {
    Vec3 world{0, 0, 0};
    for (int r = 0; r < 3; ++r)
      for (int a = 0; a < 3; ++a) world[r] += v_.to_q.m[a][r] * slope[a];
    return Vec3f(world);
  }

  /// At the corners of a cell.
  void find_slopes(const long cell[3]) {
    if (std::equal(cell, cell + 3, slopes_of_)) return;
    std::copy(cell, cell + 3, slopes_of_);
    const size_t stride[3] = {1, row_, layer_};
    const T* corner = data_ + size_t(cell[0]) + row_ * size_t(cell[1]) + layer_ * size_t(cell[2]);
    float sum = 0;
    for (int a = 0; a < 3; ++a) {
      const DerivativeWeights weights[2] = {axes_[a].weights(cell[a]), axes_[a].weights(cell[a] + 1)};
      const ptrdiff_t back = cell[a] > 0 ? ptrdiff_t(stride[a]) : 0, on = cell[a] + 1 < axes_[a].last() ? ptrdiff_t(stride[a]) : 0;
      for (int c = 0; c < 8; ++c) {
        const bool upper = c >> a & 1;
        const T* own = corner + (c & 1) * stride[0] + (c >> 1 & 1) * stride[1] + (c >> 2) * stride[2];
        const ptrdiff_t to_before = upper ? ptrdiff_t(stride[a]) : back, to_after = upper ? on : ptrdiff_t(stride[a]);
        const float before = float(own[-to_before]), here = float(*own), after = float(own[to_after]);
        const auto& w = weights[upper];
        slopes_[a][c] = w.back * (here - before) + w.on * (after - here);
        if (slopes_[a][c] != slopes_[a][c]) slopes_[a][c] = one_sided(w, before, here, after);
        sum += here;
      }
      if (!back || !on) mend_border(a, !back, !on);
    }
    beside_holes_ = sum != sum;
  }

  /// At the border of an axis, where find_slopes() told differences over the cell. With samples at both borders those are all there is.
  void mend_border(int axis, bool first, bool last) {
    if (first && last) return;
    for (int c = 0; c < 8; ++c) {
      if (c >> axis & 1) continue;
      float &lower = slopes_[axis][c], &upper = slopes_[axis][c | 1 << axis];
      if (first) lower = border_slope(lower, upper);
      else upper = border_slope(upper, lower);
    }
  }
  /// What stands for a slope of find_slopes() where a neighbour is not a number.
  float one_sided(const DerivativeWeights& w, float before, float here, float after) const {
    const float back = here - before, on = after - here, whole = std::sqrt(w.back * w.on);
    const float slope = back == back ? back * (w.back + whole) : on * (w.on + whole);
    return slope == slope ? slope : 0;
  }
  /// In a cell with holes of its own: one-sided where there is no number a cell before or after.
  Vec3 slope_beside_holes(Vec3 q) {
    Vec3 slope;
    float centre = NAN;
    for (int a = 0; a < 3; ++a) {
      const double edge = v_.cell_length(a, q[a]);
      double from = std::max(q[a] - edge, axes_[a].sample(0)), to = std::min(q[a] + edge, axes_[a].sample(axes_[a].last()));
      Vec3 place = q;
      place[a] = from;
      float below = value_at(place);
      place[a] = to;
      float above = value_at(place);
      if (below != below || above != above) {
        if (centre != centre) centre = value_at(q);
        if (below != below) below = centre, from = q[a];
        if (above != above) above = centre, to = q[a];
      }
      slope[a] = to > from ? double(above - below) / (to - from) : 0;
    }
    return slope;
  }

  double crossing(int a) const {
    if (c_.along[a] == 0) return HUGE_VAL;
    return std::max((axes_[a].side(box_[a] + (c_.along[a] > 0)) - c_.start[a]) * per_along_[a], t_);
  }
  void advance(double leave) {
    t_ = leave;
    if (!(t_ < end_)) return;
    for (int a = 0; a < 3; ++a)
      if (next_[a] <= t_) box_[a] += c_.along[a] > 0 ? 1 : -1, next_[a] = crossing(a);
  }
  /// To the first box behind the brick, which shares its other indices with boxes of the brick.
  void leave_brick(const size_t brick[3]) {
    double out = end_;
    long side[3];
    for (int a = 0; a < 3; ++a) {
      const bool up = c_.along[a] > 0;
      side[a] = long((brick[a] + up) << MinMaxBricks::shift) - !up;  // the first box beyond
      if (c_.along[a] == 0 || side[a] < 0 || side[a] > axes_[a].last() || (up && brick[a] + 1 >= v_.bricks().dims[size_t(a)])) continue;
      out = std::min(out, std::max((axes_[a].side(side[a] + !up) - c_.start[a]) * per_along_[a], t_));
    }
    t_ = out;
    if (!(t_ < end_)) return;
    for (int a = 0; a < 3; ++a) {
      if (c_.along[a] == 0) continue;
      const bool up = c_.along[a] > 0;
      long box = axes_[a].box_at(c_.start[a] + t_ * c_.along[a]);
      const bool inner = up ? brick[a] + 1 < v_.bricks().dims[size_t(a)] : brick[a] > 0;
      if (inner) {
        const double at = (axes_[a].side(side[a] + !up) - c_.start[a]) * per_along_[a];
        if (at <= t_) box = up ? std::max(box, side[a]) : std::min(box, side[a]);
        else box = up ? std::min(box, side[a] - 1) : std::max(box, side[a] + 1);
      }
      box_[a] = up ? std::max(box, box_[a]) : std::min(box, box_[a]);
      next_[a] = crossing(a);
    }
  }

  T sample(size_t i, size_t j, size_t k) const { return data_[i + row_ * j + layer_ * k]; }

  void load(const long cell[3]) {
    if (cell[0] == loaded_[0] && cell[1] == loaded_[1] && cell[2] == loaded_[2]) return;
    for (int a = 0; a < 3; ++a) loaded_[a] = cell[a];
    const T* p = data_ + size_t(cell[0]) + row_ * size_t(cell[1]) + layer_ * size_t(cell[2]);
    corner_[0] = float(p[0]), corner_[1] = float(p[1]), corner_[2] = float(p[row_]), corner_[3] = float(p[row_ + 1]);
    p += layer_;
    corner_[4] = float(p[0]), corner_[5] = float(p[1]), corner_[6] = float(p[row_]), corner_[7] = float(p[row_ + 1]);
    float sum = 0;
    for (float c : corner_) sum += c;
    holes_ = false;
    if (sum != sum)
      for (float c : corner_) holes_ = holes_ || c != c;
  }

  static float trilinear(const float c[8], const double f[3]) {
    const float x = float(f[0]), y = float(f[1]), z = float(f[2]);
    const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
    return mix(mix(mix(c[0], c[1], x), mix(c[2], c[3], x), y), mix(mix(c[4], c[5], x), mix(c[6], c[7], x), y), z);
  }
  /// Mean of the corners that have a value, weighted as usual.
  float around_holes(const double f[3]) const {
    double sum = 0, weights = 0;
    for (int c = 0; c < 8; ++c) {
      if (corner_[c] != corner_[c]) continue;
      const double w = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
      sum += w * double(corner_[c]), weights += w;
    }
    return weights > 0 ? float(sum / weights) : NAN;
  }
  void place(const long cell[3], double t, double f[3]) const {
    for (int a = 0; a < 3; ++a) f[a] = axes_[a].fraction(cell[a], c_.start[a] + t * c_.along[a]);
  }

  size_t emit(double leave, std::span<Stretch> out) {
    if (v_.nearest) {
      const float value = float(sample(size_t(box_[0]), size_t(box_[1]), size_t(box_[2])));
      if (value != value || hidden()) return 0;
      out[0] = {t_, leave, {value, value, value, value}};
      return 1;
    }
    long cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = axes_[a].cell(box_[a]);
    load(cell);
    if (hidden() || (holes_ && !v_.dual)) return 0;
    if (holes_) return emit_around_holes(cell, leave, out);
    float value[4];
    for (int i = 0; i < 4; ++i) {
      double f[3];
      place(cell, t_ + (leave - t_) * (i / 3.0), f);
      value[i] = trilinear(corner_, f);
    }
    out[0] = {t_, leave, {}};
    bernstein_from_thirds(value, out[0].b);
    return 1;
  }

  /// Up to four parts, by the middle planes of the cell: each lies in the half cells of one sample.
  size_t emit_around_holes(const long cell[3], double leave, std::span<Stretch> out) {
    double cut[5] = {t_, leave, leave, leave, leave};
    int n = 1;
    for (int a = 0; a < 3; ++a) {
      if (c_.along[a] == 0) continue;
      const double middle = 0.5 * (axes_[a].sample(cell[a]) + axes_[a].sample(cell[a] + 1)), t = (middle - c_.start[a]) * per_along_[a];
      if (t > t_ && t < leave) cut[n++] = t;
    }
    std::sort(cut, cut + n);
    cut[n] = leave;
    size_t count = 0;
    for (int p = 0; p < n; ++p) {
      double f[3];
      place(cell, 0.5 * (cut[p] + cut[p + 1]), f);
      const int owner = (f[0] >= 0.5) + 2 * (f[1] >= 0.5) + 4 * (f[2] >= 0.5);
      if (corner_[owner] != corner_[owner] || !(cut[p + 1] > cut[p])) continue;
      float value[4];
      for (int i = 0; i < 4; ++i) {
        place(cell, cut[p] + (cut[p + 1] - cut[p]) * (i / 3.0), f);
        value[i] = around_holes(f);
      }
      out[count] = {cut[p], cut[p + 1], {}};
      bernstein_from_thirds(value, out[count++].b);
    }
    return count;
  }

  bool hidden() const {
    if (v_.hidden().empty()) return false;
    size_t at[3];
    for (int a = 0; a < 3; ++a) at[a] = size_t(axes_[a].cell(box_[a]));
    return v_.hidden()[at[0] + (v_.voxels.dims[0] - 1) * (at[1] + (v_.voxels.dims[1] - 1) * at[2])];
  }

  float value_at(Vec3 q) {
    long cell[3];
    double f[3];
    for (int a = 0; a < 3; ++a) cell[a] = axes_[a].cell(long(v_.u(a, q[a]))), f[a] = axes_[a].fraction(cell[a], q[a]);
    load(cell);
    if (!holes_) return trilinear(corner_, f);
    return v_.dual ? around_holes(f) : NAN;
  }

  std::unique_ptr<LatticeWalker> second_;
  std::shared_ptr<const Volume> volume_;
  const Volume& v_;
  Invisible invisible_;
  Axis axes_[3];
  const T* data_;
  size_t row_, layer_;

  Course c_;
  Vec3 per_along_;
  double t_ = 0, end_ = -1, next_[3] = {};
  long box_[3] = {};
  size_t brick_ = size_t(-1);
  bool empty_ = false;
  long loaded_[3] = {-9, -9, -9};
  float corner_[8] = {};
  bool holes_ = false;
  long slopes_of_[3] = {-9, -9, -9};
  float slopes_[3][8] = {};
  bool beside_holes_ = false;
};

/// As a RayField or RaySpans.
template <class Walker>
std::unique_ptr<Walker> walker_of(const std::shared_ptr<const Volume>& v, const Invisible& invisible,
                                  std::unique_ptr<LatticeWalker> second) {
  switch (v->voxels.array.type()) {
    case ElementType::u8: return std::make_unique<LatticeRay<uint8_t>>(v, invisible, std::move(second));
    case ElementType::i8: return std::make_unique<LatticeRay<int8_t>>(v, invisible, std::move(second));
    case ElementType::u16: return std::make_unique<LatticeRay<uint16_t>>(v, invisible, std::move(second));
    case ElementType::i16: return std::make_unique<LatticeRay<int16_t>>(v, invisible, std::move(second));
    case ElementType::f32: return std::make_unique<LatticeRay<float>>(v, invisible, std::move(second));
    default: fail_internal("the samples of a volume were not narrowed");
  }
}

class LatticeSource final : public RaySource {
 public:
  LatticeSource(std::shared_ptr<const Volume> v, std::shared_ptr<const Volume> second) : volume_(std::move(v)), second_(std::move(second)) {
    base = volume_->base, bounds = volume_->bounds, edge = volume_->edge;
  }
  std::unique_ptr<RayField> walker() const override {
    return walker_of<RayField>(volume_, invisible, second_ ? walker_of<LatticeWalker>(second_, {}, nullptr) : nullptr);
  }
  /// Not where some of the cells or halves of cells draw nothing, nor of labels.
  std::unique_ptr<RaySpans> spans() const override {
    if (volume_->nearest || !volume_->hidden().empty() || (volume_->dual && volume_->samples->holes)) return nullptr;
    return walker_of<RaySpans>(volume_, invisible, nullptr);
  }

 private:
  std::shared_ptr<const Volume> volume_, second_;
};

}  // namespace

std::unique_ptr<RaySource> lattice_source(std::shared_ptr<const Volume> volume, std::shared_ptr<const Volume> second) {
  return std::make_unique<LatticeSource>(std::move(volume), std::move(second));
}

}  // namespace sg::volume
