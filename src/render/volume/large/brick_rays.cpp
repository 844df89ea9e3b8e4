// SPDX-License-Identifier: Apache-2.0
// Walkers through the bricks.
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "render/volume/large/brick_store.h"
#include "render/volume/large/bricked_source.h"

namespace sg::volume {

namespace {

using Data = std::shared_ptr<const BrickData>;

struct Prepared {
  const BrickedVolume* volume = nullptr;
  Mat3 to_fine;                    // world -> fine coordinates, after taking the origin off
  Mat3 to_world;                   // gradients: value per sample of level 0 -> per world length
  Vec3 lo, hi;                     // the grid in fine coordinates
  std::vector<Vec3> scale, shift;  // per level: sample index from fine coordinates
};

class BrickedSource final : public RaySource {
 public:
  BrickedSource(BrickedPtr volume, DatasetPtr data, const Projection& projection, size_t memory, double coarser)
      : volume_(std::move(volume)), data_(std::move(data)), projection_(projection), pixels_(coarser) {
    // A part for what walkers hold beside the cache.
    cache_limit_ = memory / 8 * 7;
    const double brick = double(67 * 67 * 67 * std::min<size_t>(4, element_size(volume_->type)));
    pins_ = size_t(std::clamp(double(memory / 8) / brick / std::max(1, thread_count()), 4.0, 64.0));
    cache_ = brick_cache(*data_, cache_limit_);
    const BrickedVolume::Level& fine = volume_->levels[0];
    prepared_.volume = volume_.get();
    for (int a = 0; a < 3; ++a) {
      prepared_.lo[a] = first_place(fine.dims[size_t(a)]), prepared_.hi[a] = last_place(fine.dims[size_t(a)]);
      for (int c = 0; c < 3; ++c) {
        prepared_.to_fine.m[a][c] = volume_->direction.m[c][a] / fine.spacing[a];
        prepared_.to_world.m[c][a] = volume_->direction.m[c][a] / fine.spacing[a];
      }
    }
    for (size_t l = 0; l < volume_->levels.size(); ++l) {
      Vec3 scale, shift;
      level_places(*volume_, l, scale, shift);
      prepared_.scale.push_back(scale), prepared_.shift.push_back(shift);
    }
    for (int c = 0; c < 8; ++c) {
      const Vec3 u{c & 1 ? prepared_.hi.x : prepared_.lo.x, c & 2 ? prepared_.hi.y : prepared_.lo.y,
                   c & 4 ? prepared_.hi.z : prepared_.lo.z};
      bounds.add(fine.origin + volume_->direction * (fine.spacing * u));
    }
    edge = finest_edge();
  }

  std::unique_ptr<RayField> walker() const override;
  const BrickTree& tree() const {
    std::call_once(planned_, [&] {
      tree_ = std::make_unique<BrickTree>(*volume_, projection_, pixels_, 4 * uint64_t(cache_limit_), invisible);
      foresee();
    });
    return *tree_;
  }
  const BrickedVolume& volume() const { return *volume_; }
  const Prepared& prepared() const { return prepared_; }
  size_t pins() const { return pins_; }

  Data brick(size_t level, const std::array<uint32_t, 3>& at) const {
    return cache_->get(brick_key(level, at), [&] {
      BrickNode n;
      n.level = uint8_t(level), n.at = at;
      Vec3 lo, hi;
      tree_->box(n, lo, hi);
      Data b = load_brick(*volume_, level, lo, hi);
      return std::pair(b, b->bytes());
    });
  }

 private:
  // The system may read what rays will need, the nearest first, while the first rays are cast.
  void foresee() const {
    if (!volume_->expect) return;
    std::vector<std::pair<double, size_t>> order;
    for (size_t i = 0; i < tree_->size(); ++i) {
      const BrickNode& n = tree_->node(int(i));
      if (!n.seen || n.children >= 0) continue;
      Vec3 lo, hi;
      tree_->box(n, lo, hi);
      const BrickedVolume::Level& fine = volume_->levels[0];
      order.emplace_back(projection_.to_eye(fine.origin + volume_->direction * (fine.spacing * (0.5 * (lo + hi)))).z, i);
    }
    std::sort(order.begin(), order.end());
    size_t bytes = 0;
    for (size_t i = 0; i < order.size() && bytes < cache_limit_; ++i) {
      const BrickNode& n = tree_->node(int(order[i].second));
      Vec3 lo, hi;
      tree_->box(n, lo, hi);
      std::array<size_t, 3> from{}, count{};
      size_t size = element_size(volume_->type);
      for (size_t a = 0; a < 3; ++a) {
        const double scale = prepared_.scale[n.level][int(a)], shift = prepared_.shift[n.level][int(a)];
        const double last = double(volume_->levels[n.level].dims[a]) - 1;
        from[a] = size_t(std::clamp(std::ceil(lo[int(a)] * scale + shift), 0.0, last));
        count[a] = size_t(std::clamp(std::ceil(hi[int(a)] * scale + shift) - 1, double(from[a]), last)) - from[a] + 1;
        size *= count[a];
      }
      volume_->expect(n.level, from, count);
      bytes += size;
    }
  }

  // Of the level that the nearest place of the box is drawn from.
  double finest_edge() const {
    double nearest = HUGE_VAL;
    for (int c = 0; c < 8; ++c)
      nearest = std::min(
          nearest,
          projection_.to_eye(Vec3{c & 1 ? bounds.hi.x : bounds.lo.x, c & 2 ? bounds.hi.y : bounds.lo.y, c & 4 ? bounds.hi.z : bounds.lo.z})
              .z);
    const double pixel =
        pixels_ * (projection_.parallel ? 1 / projection_.scale : std::max(nearest, projection_.near_plane) / projection_.scale);
    double best = 0;
    for (const auto& l : volume_->levels) {
      const double e = std::min({l.spacing.x, l.spacing.y, l.spacing.z});
      if (best == 0 || std::max({l.spacing.x, l.spacing.y, l.spacing.z}) <= pixel) best = e;
    }
    return best;
  }

  BrickedPtr volume_;
  DatasetPtr data_;
  Projection projection_;
  double pixels_;
  size_t cache_limit_ = 0, pins_ = 4;
  std::shared_ptr<BrickCache> cache_;
  Prepared prepared_;
  mutable std::once_flag planned_;
  mutable std::unique_ptr<BrickTree> tree_;
};

// The cells of one level along a ray.
struct Cells {
  Data data;
  double a[3], b[3];  // sample index v = a + t b
  double cell[3];     // the one that the ray is in
  double next[3];     // t at which it leaves it along each axis

  void begin(const Prepared& p, size_t level, Vec3 start, Vec3 along) {
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
  explicit Walker(const BrickedSource& source) : source_(source), tree_(source.tree()), p_(source.prepared()), pins_(source.pins()) {}

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
    const double w = n.blend ? weight(n, lo, hi, u) : 0;
    Vec3 g{0, 0, 0};
    if (w < 1) g += slope(n.level, *pinned(n.level, n.at), u) * (1 - w);
    if (w > 0) g += slope(n.level + 1u, *pinned(n.level + 1u, parent(n)), u) * w;
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
      cells_[1].data = pinned(n.level + 1u, parent(n));
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
      const auto w = float(weight(tree_.node(leaf_), lo_, hi_, start_ + along_ * t));
      v[i] = (1 - w) * s.value(t) + w * coarse.value(t);
    }
    bernstein_from_thirds(v, s.b);
    return true;
  }

  // Share of the coarser level at a place in a leaf: trilinear between its corners.
  static double weight(const BrickNode& n, Vec3 lo, Vec3 hi, Vec3 u) {
    double f[3];
    for (int a = 0; a < 3; ++a) f[a] = std::clamp((u[a] - lo[a]) / std::max(hi[a] - lo[a], 1e-300), 0.0, 1.0);
    double w = 0;
    for (int c = 0; c < 8; ++c)
      if (n.blend >> c & 1) w += (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
    return w;
  }

  std::array<uint32_t, 3> parent(const BrickNode& n) const {
    const auto &c = source_.volume().levels[n.level + 1u].coarseness, &f = source_.volume().levels[n.level].coarseness;
    std::array<uint32_t, 3> at{};
    for (size_t a = 0; a < 3; ++a) at[a] = uint32_t(n.at[a] / (c[a] / f[a]));
    return at;
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
      Vec3 before = v, after = v;
      before[i] = std::clamp(v[i] - 1, 0.0, d.most[size_t(i)]), after[i] = std::clamp(v[i] + 1, 0.0, d.most[size_t(i)]);
      const double length = after[i] - before[i];
      const double rise = length > 0 ? (sample(d, after) - sample(d, before)) / length : 0;
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
  const Prepared& p_;
  std::vector<Pin> pins_;
  Vec3 start_, along_, lo_, hi_;
  double t_ = 0, end_ = 0, entry_ = 0, leaf_end_ = 0, cube_end_ = 0, hair_ = 0;
  int leaf_ = -1;
  bool blends_ = false;
  Cells cells_[2];
};

std::unique_ptr<RayField> BrickedSource::walker() const {
  tree();
  return std::make_unique<Walker>(*this);
}

}  // namespace

std::unique_ptr<RaySource> bricked_source(const VolumeItem& item, const Projection& projection, size_t memory, Context&, double coarser) {
  if (!item.data) return nullptr;
  BrickedPtr volume = bricked_of(*item.data);
  if (!volume || (!item.field.empty() && item.field != volume->field) || item.association != Association::point) return nullptr;
  if (!(coarser >= 1) || !std::isfinite(coarser)) fail_usage(fmt::format("voxels of {} pixels", coarser), "volume", "give 1 or more");
  if (memory == 0) memory = size_t(1) << 30;
  return std::make_unique<BrickedSource>(std::move(volume), item.data, projection, memory, coarser);
}

BrickedUse bricked_use(const RaySource& source) {
  const auto* s = dynamic_cast<const BrickedSource*>(&source);
  if (!s) fail_internal("not the source of a bricked volume");
  const BrickTree& tree = s->tree();
  BrickedUse use;
  use.bricks.resize(s->volume().levels.size());
  for (size_t i = 0; i < tree.size(); ++i)
    if (const BrickNode& n = tree.node(int(i)); n.children < 0 && n.seen) ++use.bricks[n.level];
  use.voxel_pixels = tree.pixels(), use.bytes = tree.bytes();
  return use;
}

}  // namespace sg::volume
