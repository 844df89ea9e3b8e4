// SPDX-License-Identifier: Apache-2.0
// Walkers through the bricks.
#include <cmath>

#include "render/volume/sources/bricks/brick_source.h"
#include "render/volume/sources/lattice/derivatives.h"

namespace sg::volume {

namespace {

using Data = std::shared_ptr<const BrickData>;

// The cells of one level along a ray.
struct Cells {
  Data data;
  double a[3], b[3];  // sample index v = a + t b
  double cell[3];     // the one that the ray is in
  double next[3];     // t at which it leaves it along each axis

  void begin(const BrickPlaces& p, size_t level, Vec3 start, Vec3 along) {
    for (int i = 0; i < 3; ++i) a[i] = start[i] * p.scale[level][i] + p.shift[level][i], b[i] = along[i] * p.scale[level][i];
  }
  void locate(double t) {
    for (int i = 0; i < 3; ++i) {
      const double v = a[i] + t * b[i];
      cell[i] = std::floor(v);
      if (b[i] < 0 && cell[i] == v) cell[i] -= 1;
      set_next(i);
      pass(i, t);
    }
  }
  void set_next(int i) { next[i] = b[i] > 0 ? (cell[i] + 1 - a[i]) / b[i] : b[i] < 0 ? (cell[i] - a[i]) / b[i] : HUGE_VAL; }
  void pass(int i, double t) {
    while (next[i] <= t) cell[i] += b[i] > 0 ? 1 : -1, set_next(i);
  }
  void advance(double t) {
    for (int i = 0; i < 3; ++i) pass(i, t);
  }
  double leave() const { return std::min({next[0], next[1], next[2]}); }

  // The cell in the brick, and places in it (clamped beyond the outermost samples); false when a corner has no value.
  struct Corners {
    float v[8];
    double first[3];  // sample index of corner 0
    bool flat[3];     // one layer along that axis
  };
  bool corners(Corners& c) const {
    const BrickData& d = *data;
    size_t at = 0, step[3], stride = 1;
    for (size_t i = 0; i < 3; ++i) {
      c.flat[i] = d.n[i] == 1;
      const double local = std::clamp(cell[i] - d.first[i], 0.0, double(std::max(0, d.n[i] - 2)));
      c.first[i] = local + d.first[i];
      at += size_t(local) * stride;
      step[i] = c.flat[i] ? 0 : stride;
      stride *= size_t(d.n[i]);
    }
    d.corners(d.values.raw(), at, step, c.v);
    float sum = 0;
    for (const float v : c.v) sum += v * 0;
    return sum == 0;
  }
  float place(const Corners& c, int i, double t) const {
    return c.flat[i] ? 0.0f : float(std::clamp(a[i] + t * b[i] - c.first[i], 0.0, 1.0));
  }

  // Polar form: each coefficient mixes places at both ends, one axis at a time.
  void bernstein(const Corners& c, double t0, double t1, float out[4]) const {
    const float x[2] = {place(c, 0, t0), place(c, 0, t1)}, y[2] = {place(c, 1, t0), place(c, 1, t1)},
                z[2] = {place(c, 2, t0), place(c, 2, t1)};
    float f[2][2][2];  // [x end][y end][z end]
    for (int i = 0; i < 2; ++i) {
      float e[4];
      for (int k = 0; k < 4; ++k) e[k] = c.v[2 * k] + x[i] * (c.v[2 * k + 1] - c.v[2 * k]);
      for (int j = 0; j < 2; ++j) {
        const float low = e[0] + y[j] * (e[1] - e[0]), high = e[2] + y[j] * (e[3] - e[2]);
        for (int k = 0; k < 2; ++k) f[i][j][k] = low + z[k] * (high - low);
      }
    }
    out[0] = f[0][0][0], out[3] = f[1][1][1];
    out[1] = (f[1][0][0] + f[0][1][0] + f[0][0][1]) / 3;
    out[2] = (f[1][1][0] + f[1][0][1] + f[0][1][1]) / 3;
  }

  // Range of the little cube that holds the cell, and the t at which the ray leaves that cube.
  BrickData::Cube cube(double& leaves) const {
    const BrickData& d = *data;
    int id[3];
    leaves = HUGE_VAL;
    for (size_t i = 0; i < 3; ++i) {
      const double local = std::clamp(cell[i] - d.first[i], 0.0, double(std::max(0, d.n[i] - 2)));
      id[i] = int(local) / BrickData::small;
      // Beyond the outermost samples the cube goes on.
      if (b[i] > 0) {
        if (id[i] + 1 < d.cubes[i]) leaves = std::min(leaves, (d.first[i] + double((id[i] + 1) * BrickData::small) - a[i]) / b[i]);
      } else if (b[i] < 0) {
        if (id[i] > 0) leaves = std::min(leaves, (d.first[i] + double(id[i] * BrickData::small) - a[i]) / b[i]);
      }
    }
    return d.cube[size_t(id[0]) + size_t(d.cubes[0]) * (size_t(id[1]) + size_t(d.cubes[1]) * size_t(id[2]))];
  }
};

class Walker final : public RayField {
 public:
  explicit Walker(const BrickedSource& source) : source_(source), tree_(source.tree()), p_(source.places()), pins_(source.pins()) {}

  void start(Vec3 origin, Vec3 direction, double from, double to) override {
    const auto& fine = source_.volume().levels[0];
    start_ = p_.to_fine * (origin - fine.origin), along_ = p_.to_fine * direction;
    t_ = from, end_ = to, leaf_ = -1;
    for (int i = 0; i < 3; ++i) {
      if (along_[i] == 0) {
        if (start_[i] < p_.lo[i] || start_[i] > p_.hi[i]) end_ = t_;
        continue;
      }
      const double t0 = (p_.lo[i] - start_[i]) / along_[i], t1 = (p_.hi[i] - start_[i]) / along_[i];
      t_ = std::max(t_, std::min(t0, t1)), end_ = std::min(end_, std::max(t0, t1));
    }
    entry_ = t_;
    // A hair: much less than a cell, much more than rounding.
    hair_ = 1e-7 / std::max({std::abs(along_.x), std::abs(along_.y), std::abs(along_.z), 1e-300});
  }

  double entry() const override { return entry_; }

  size_t next(std::span<Stretch> out) override {
    size_t n = 0;
    while (n < out.size() && t_ < end_) {
      if (leaf_ < 0 && !enter()) continue;
      if (skip_cube()) continue;
      const double stop = std::min({leaf_end_, cells_[0].leave(), blends_ ? cells_[1].leave() : HUGE_VAL});
      if (stop > t_ && emit(t_, stop, out[n])) ++n;
      go_to(stop);
    }
    return n;
  }

  Vec3f gradient(const Stretch& stretch, double t) override {
    const BrickNode& n = tree_.node(int(stretch.cell));
    const Vec3 u = start_ + along_ * t;
    Vec3 lo, hi;
    tree_.box(n, lo, hi);
    const double w = n.blend ? coarser_share(n, lo, hi, u) : 0;
    Vec3 g{0, 0, 0};
    if (w < 1) g += slope(n.level, *pinned(n.level, n.at), u) * (1 - w);
    if (w > 0) g += slope(n.level + 1u, *pinned(n.level + 1u, tree_.parent(n)), u) * w;
    return Vec3f(p_.to_world * g);
  }

 private:
  // Finds the leaf at t_, up to where the ray leaves it. False when there is nothing to see in it.
  bool enter() {
    const double inside = std::min(t_ + hair_, 0.5 * (t_ + end_));
    leaf_ = tree_.find(start_ + along_ * inside);
    const BrickNode& n = tree_.node(leaf_);
    tree_.box(n, lo_, hi_);
    leaf_end_ = end_;
    for (int i = 0; i < 3; ++i)
      if (along_[i] != 0) {
        const double t = ((along_[i] > 0 ? hi_[i] : lo_[i]) - start_[i]) / along_[i];
        leaf_end_ = std::min(leaf_end_, std::max(t, t_ + hair_));
      }
    if (!n.seen) {
      t_ = leaf_end_, leaf_ = -1;
      return false;
    }
    blends_ = n.blend != 0;
    cells_[0].data = pinned(n.level, n.at);
    cells_[0].begin(p_, n.level, start_, along_);
    cells_[0].locate(t_);
    if (blends_) {
      cells_[1].data = pinned(n.level + 1u, tree_.parent(n));
      cells_[1].begin(p_, n.level + 1u, start_, along_);
      cells_[1].locate(t_);
    }
    cube_end_ = -HUGE_VAL;
    return true;
  }

  // Passes over a little cube in which nothing can be seen.
  bool skip_cube() {
    if (t_ < cube_end_) return false;
    double leaves;
    BrickData::Cube c = cells_[0].cube(leaves);
    if (blends_) {
      double other;
      const BrickData::Cube d = cells_[1].cube(other);
      c.lo = std::min(c.lo, d.lo), c.hi = std::max(c.hi, d.hi), leaves = std::min(leaves, other);
    }
    leaves = std::max(leaves, t_ + hair_);
    if (c.lo <= c.hi && !source_.invisible(c.lo, c.hi)) {
      cube_end_ = leaves;
      return false;
    }
    t_ = std::min(leaves, leaf_end_);
    if (t_ >= leaf_end_) {
      leaf_ = -1;
    } else {
      cells_[0].locate(t_);
      if (blends_) cells_[1].locate(t_);
    }
    return true;
  }

  void go_to(double t) {
    t_ = std::max(t_, t);
    if (t_ >= leaf_end_) {
      leaf_ = -1;
      return;
    }
    cells_[0].advance(t_);
    if (blends_) cells_[1].advance(t_);
  }

  bool emit(double from, double to, Stretch& s) const {
    s.from = from, s.to = to, s.cell = uint64_t(leaf_);
    Cells::Corners c;
    if (!cells_[0].corners(c)) return false;
    cells_[0].bernstein(c, from, to, s.b);
    if (!blends_) return true;
    Stretch coarse = s;
    Cells::Corners d;
    if (!cells_[1].corners(d)) return false;
    cells_[1].bernstein(d, from, to, coarse.b);
    float v[4];
    for (int i = 0; i < 4; ++i) {
      const double t = from + (to - from) * i / 3;
      const auto w = float(coarser_share(tree_.node(leaf_), lo_, hi_, start_ + along_ * t));
      v[i] = (1 - w) * s.value(t) + w * coarse.value(t);
    }
    bernstein_from_thirds(v, s.b);
    return true;
  }

  static double sample(const BrickData& d, Vec3 v) {
    Cells c{};
    c.data = Data(Data(), &d);  // not its owner
    for (int i = 0; i < 3; ++i) c.a[i] = v[i], c.cell[i] = std::floor(v[i]);
    Cells::Corners corners;
    if (!c.corners(corners)) return NAN;
    float b[4];
    c.bernstein(corners, 0, 0, b);
    return double(b[0]);
  }

  // The same where all samples around the cell are held, at once. False elsewhere.
  static bool inner_slope(const BrickData& d, Vec3 v, Vec3& g) {
    size_t at = 0, step[3], stride = 1;
    float place[3], out[3];
    for (size_t i = 0; i < 3; ++i) {
      const double local = v[int(i)] - d.first[i];
      if (!(local >= 1) || !(local < double(d.n[i] - 2))) return false;
      const auto cell = size_t(local);
      place[i] = float(local - double(cell));
      at += cell * stride, step[i] = stride, stride *= size_t(d.n[i]);
    }
    d.differences(d.values.raw(), at, step, place, out);
    g = {double(out[0]), double(out[1]), double(out[2])};
    return std::isfinite(g.x + g.y + g.z);
  }

  // Central differences of a level, per sample of level 0; 0 where a value is missing.
  Vec3 slope(size_t level, const BrickData& d, Vec3 u) const {
    Vec3 g;
    const Vec3 v = u * p_.scale[level] + p_.shift[level];
    if (inner_slope(d, v, g)) return g * p_.scale[level];
    for (int i = 0; i < 3; ++i) {
      const double most = d.most[size_t(i)], here = std::clamp(v[i], 0.0, most);
      Vec3 place = v;
      const auto at = [&](double along) {
        place[i] = std::clamp(along, 0.0, most);
        return sample(d, place);
      };
      const bool first = here < 1;
      double rise = 0;
      if (!first && here <= most - 1) {
        rise = 0.5 * (at(here + 1) - at(here - 1));
      } else if (most > 0) {
        // Inwards from the border.
        const double border = first ? 0 : most, step = first ? 1 : -1;
        const double v0 = at(border), v1 = at(border + step), over = v1 - v0;
        const double inner = most < 2 ? over : 0.5 * (at(border + 2 * step) - v0);
        const double outer = border_slope(over, inner);
        rise = step * (outer + std::abs(here - border) * (inner - outer));
      }
      g[i] = std::isfinite(rise) ? rise * p_.scale[level][i] : 0;
    }
    return g;
  }

  // A brick that this thread has at hand.
  const Data& pinned(size_t level, const std::array<uint32_t, 3>& at) {
    const uint64_t key = brick_key(level, at);
    Pin& pin = pins_[(key * 0x9E3779B97F4A7C15u >> 32) % pins_.size()];
    if (!pin.data || pin.key != key) pin.data = source_.brick(level, at), pin.key = key;
    return pin.data;
  }

  struct Pin {
    uint64_t key = 0;
    Data data;
  };
  const BrickedSource& source_;
  const BrickTree& tree_;
  const BrickPlaces& p_;
  std::vector<Pin> pins_;
  Vec3 start_, along_, lo_, hi_;
  double t_ = 0, end_ = 0, entry_ = 0, leaf_end_ = 0, cube_end_ = 0, hair_ = 0;
  int leaf_ = -1;
  bool blends_ = false;
  Cells cells_[2];
};

}  // namespace

std::unique_ptr<RayField> BrickedSource::walker() const {
  tree();
  if (!in_lattices_) caches_->lattices.set_limit(0), caches_->bricks.set_limit(cache_limit_);
  return std::make_unique<Walker>(*this);
}

}  // namespace sg::volume
