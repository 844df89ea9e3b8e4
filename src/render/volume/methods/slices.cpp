// SPDX-License-Identifier: Apache-2.0
// Object-order slicing: the volume as a stack of textured slices, rasterised one after the other. Each slice stands for the slab
// around it; a pixel's alpha comes from the length of its own ray inside the slab, so that oblique and perspective views, cut
// borders and surfaces inside are right for any distance of the slices.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "render/volume/methods/options.h"
#include "render/volume/methods/slab_polygon.h"
#include "render/volume/methods/stage.h"
#include "render/volume/sources/lattice/runs.h"

namespace sg::volume {

namespace {

constexpr int tile_width = 64, tile_height = 16;
constexpr size_t most_slabs = 200000;

/// What one slice stands for, between two planes. View stack: depths. Axis stack: places in q along the axis.
struct Slab {
  double from, to, plane;
  Polygon outline;
  double top, bottom;  // rows that the outline covers
};

struct Stack {
  const Stage& stage;
  const SliceOptions& options;
  int axis = -1;            // of the axis stack; -1 = across the view
  std::vector<Slab> slabs;  // in the order in which they are drawn
  size_t rising = 0;        // axis stack: slabs [0, rising) are drawn for rays that rise along the axis, the rest for others
};

void box_corners(const Stage& s, Vec3 lo, Vec3 hi, Vec3 corners[8]) {
  for (int c = 0; c < 8; ++c) corners[c] = s.world({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z});
}

void add(Stack& stack, double from, double to, double plane, Polygon outline) {
  if (outline.size() < 3) return;
  Slab slab{from, to, plane, std::move(outline), HUGE_VAL, -HUGE_VAL};
  for (const Vec2& p : slab.outline) slab.top = std::min(slab.top, p.y), slab.bottom = std::max(slab.bottom, p.y);
  stack.slabs.push_back(std::move(slab));
}

/// Planes across the view, the first half a step behind the nearest corner.
void view_stack(Stack& stack) {
  const Stage& s = stack.stage;
  Vec3 corners[8];
  box_corners(s, s.volume.lo, s.volume.hi, corners);
  double nearest = HUGE_VAL, farthest = -HUGE_VAL;
  for (const Vec3& c : corners) {
    const double z = s.projection.to_eye(c).z;
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  nearest = std::max(nearest, s.projection.near_plane), farthest = std::min(farthest, s.projection.far_plane);
  const double step = s.volume.step;
  const size_t count = farthest > nearest ? size_t(std::ceil((farthest - nearest) / step)) : 0;
  if (count > most_slabs)
    fail_usage(fmt::format("a step of {} makes {} slices", step, count), "volume",
               fmt::format("use a longer step: at most {} slices", most_slabs));
  for (size_t i = 0; i < count; ++i) {
    const double from = nearest + double(i) * step, to = std::min(from + step, farthest);
    add(stack, from, to, 0.5 * (from + to), slab_polygon(corners, from, to, s.projection));
  }
  stack.rising = stack.slabs.size();
}

/// The axis that is looked along most, counted in cells.
int main_axis(const Stage& s) {
  const Vec3 centre = s.world((s.volume.lo + s.volume.hi) * 0.5);
  const Vec3 along = s.volume.to_q * s.sight(centre);
  int best = 0;
  double most = -1;
  for (int a = 0; a < 3; ++a)
    if (const double cells = std::abs(along[a]) / s.volume.cell_length(a, 0.5 * (s.volume.lo[a] + s.volume.hi[a])); cells > most)
      most = cells, best = a;
  return best;
}

/// The samples' own layers, each from the middle of the gap before it to the middle of the gap behind it.
void axis_stack(Stack& stack) {
  const Stage& s = stack.stage;
  const Volume& v = s.volume;
  const int a = stack.axis = main_axis(s);
  const size_t n = v.voxels.dims[size_t(a)];
  const auto place = [&](size_t k) { return v.affine ? double(k) : v.coordinates[a][k]; };
  const auto layer = [&](size_t k) {
    const double q = place(k), from = k > 0 ? 0.5 * (place(k - 1) + q) : v.lo[a], to = k + 1 < n ? 0.5 * (q + place(k + 1)) : v.hi[a];
    if (!(to > from)) return;
    Vec3 lo = v.lo, hi = v.hi, corners[8];
    lo[a] = from, hi[a] = to;
    box_corners(s, lo, hi, corners);
    add(stack, from, to, q, slab_polygon(corners, s.projection.near_plane, s.projection.far_plane, s.projection));
  };
  // Away from the eye on both of its sides: a ray meets the layers of one side only.
  for (size_t k = 0; k < n; ++k) layer(k);
  stack.rising = stack.slabs.size();
  for (size_t k = n; k-- > 0;) layer(k);
}

struct Pixel {
  PixelRay ray;
  Gathered sum;
  float back[4] = {0, 0, 0, 0};  // back to front
  double total = 0, length = 0;  // value * length, length
  float best = NAN;
  double resume = -HUGE_VAL;  // front to back: nothing is seen before this length
};

class Tile {
 public:
  Tile(const Stack& stack, int x0, int y0) : k_(stack), s_(stack.stage), x0_(x0), y0_(y0) {
    x1_ = std::min(x0 + tile_width, s_.projection.width), y1_ = std::min(y0 + tile_height, s_.projection.height);
    pixels_.resize(size_t(tile_width) * tile_height);
    double nearest = HUGE_VAL, farthest = -HUGE_VAL;
    for (int y = y0_; y < y1_; ++y)
      for (int x = x0_; x < x1_; ++x) {
        PixelRay& r = at(x, y).ray = s_.ray(x, y);
        if (!(r.leave > r.enter)) continue;
        for (const double t : {r.enter, r.leave}) {
          const double place = k_.axis < 0 ? r.first_depth + t * r.per_length : r.start[k_.axis] + t * r.along[k_.axis];
          nearest = std::min(nearest, place), farthest = std::max(farthest, place);
        }
      }
    first_ = nearest, last_ = farthest;
    composite_ = s_.item.mode == RayFunction::composite;
    skip_ = composite_ && k_.options.front_to_back;
    lit_ = s_.lit(s_.projection.forward);
  }

  void draw() {
    const size_t n = k_.slabs.size();
    for (size_t i = 0; i < n; ++i) {
      const size_t index = k_.options.front_to_back ? i : n - 1 - i;
      const Slab& slab = k_.slabs[index];
      if (slab.to < first_ || slab.from > last_ || slab.bottom < y0_ || slab.top > y1_) continue;
      rising_ = index < k_.rising;
      const int from = int(std::max(slab.top - 1, double(y0_))), to = int(std::min(slab.bottom + 2, double(y1_)));
      for (int y = from; y < to; ++y) {
        int first, last;
        row_span(slab.outline, y, s_.projection.width, first, last);
        row(slab, y, std::max(first, x0_), std::min(last, x1_));
      }
    }
  }

  void write(const Ink& ink, std::vector<float>& rgba) {
    for (int y = y0_; y < y1_; ++y)
      for (int x = x0_; x < x1_; ++x) {
        const Pixel& p = at(x, y);
        float* out = &rgba[4 * (size_t(y) * size_t(s_.projection.width) + size_t(x))];
        if (composite_ && k_.options.front_to_back) {
          out[0] = p.sum.r, out[1] = p.sum.g, out[2] = p.sum.b, out[3] = 1 - p.sum.transmittance;
        } else if (composite_) {
          std::copy(p.back, p.back + 4, out);
        } else {
          ink.draw(collected(p), out);
        }
      }
  }

 private:
  Pixel& at(int x, int y) { return pixels_[size_t(y - y0_) * tile_width + size_t(x - x0_)]; }

  double collected(const Pixel& p) const {
    const double base = double(s_.volume.base);
    if (s_.item.mode == RayFunction::sum) return p.length > 0 ? p.total + base * p.length : NAN;
    if (s_.item.mode == RayFunction::average) return p.length > 0 ? p.total / p.length + base : NAN;
    return double(p.best) + base;
  }

  /// The part [from, to] of a ray in the slab and the place of its sample.
  bool piece(const Slab& slab, const PixelRay& r, double& from, double& to, double& sample) const {
    if (k_.axis < 0) {
      from = std::max((slab.from - r.first_depth) / r.per_length, r.enter);
      to = std::min((slab.to - r.first_depth) / r.per_length, r.leave);
      sample = 0.5 * (from + to);
      return to > from;
    }
    const double start = r.start[k_.axis], along = r.along[k_.axis];
    if ((along >= 0) != rising_) return false;
    if (along == 0) {  // within one layer; the upper border belongs to the next
      from = r.enter, to = r.leave, sample = 0.5 * (from + to);
      return to > from && start >= slab.from && (start < slab.to || (start == slab.to && slab.to == s_.volume.hi[k_.axis]));
    }
    const double a = (slab.from - start) / along, b = (slab.to - start) / along;
    from = std::max(std::min(a, b), r.enter), to = std::min(std::max(a, b), r.leave);
    sample = std::clamp((slab.plane - start) / along, from, std::max(from, to));
    return to > from;
  }

  void row(const Slab& slab, int y, int first, int last) {
    int n = 0;
    for (int x = first; x < last; ++x) {
      Pixel& p = at(x, y);
      double from, to, sample;
      if ((composite_ && p.sum.transmittance < opaque_below) || !piece(slab, p.ray, from, to, sample)) continue;
      if (skip_ && sample < p.resume) continue;
      for (int a = 0; a < 3; ++a) {
        place_[a][n] = p.ray.start[a] + sample * p.ray.along[a];
        // The axis stack interpolates within its slice, and only there.
        if (a == k_.axis) place_[a][n] = slab.plane;
        u_[a][n] = s_.volume.u(a, place_[a][n]);
      }
      if (skip_ && clear(p, n)) continue;
      live_[n] = &p, length_[n] = float(to - from);
      if (++n == run_length) run(n), n = 0;
    }
    if (n > 0) run(n);
  }

  /// Is the sample's brick empty? Then so is the ray up to where it leaves the cube of empty bricks around, but for a margin wider than
  /// rounding errors.
  bool clear(Pixel& p, int n) const {
    const Volume& v = s_.volume;
    size_t brick[3];
    for (size_t a = 0; a < 3; ++a) brick[a] = std::min(size_t(u_[a][n]) >> FineBricks::shift, v.fine().dims[a] - 1);
    const int d = v.distance[v.fine().id(brick[0], brick[1], brick[2])];
    if (d == 0) return false;
    double out = HUGE_VAL;
    for (int a = 0; a < 3; ++a) {
      const double along = p.ray.along[a];
      if (along == 0) continue;
      const ptrdiff_t border = ptrdiff_t(brick[a]) + (along > 0 ? d : 1 - d);
      if (border < 0 || border > ptrdiff_t(v.fine().dims[size_t(a)])) continue;
      // The axis stack looks at its plane, up to half a slice from where the ray is.
      const double slack = v.margin[a] + (a == k_.axis ? v.cell_length(a, place_[a][n]) : 0), q = v.fine_border[a][size_t(border)];
      out = std::min(out, (q + (along > 0 ? -slack : slack) - p.ray.start[a]) / along);
    }
    p.resume = out;
    return true;
  }

  void run(int count) {
    const Volume& v = s_.volume;
    Run run;
    for (int n = 0; n < run_length; ++n) {
      const int m = n < count ? n : 0;
      run.ux[n] = u_[0][m], run.uy[n] = u_[1][m], run.uz[n] = u_[2][m];
    }
    finish_values(v, run);
    if (!composite_) return collect(run, count);
    int seen[run_length], n_seen = 0;
    for (int n = 0; n < count; ++n) {
      run.entry[n] = s_.transfer().index(run.value[n]);
      if (s_.transfer().medium(run.entry[n]).density > 0) seen[n_seen++] = n;
    }
    if (n_seen == 0) return;
    Gradients g;
    if (v.shaded)
      gradients(
          v, run, seen, n_seen, [&](int axis, int n) { return place_[axis][n]; }, g);
    for (int m = 0; m < n_seen; ++m) {
      const int n = seen[m];
      const Transfer::Medium& medium = s_.transfer().medium(run.entry[n]);
      Shade shade;
      if (v.shaded) {
        if (!s_.projection.parallel) s_.light(s_.to_world * live_[n]->ray.along, lit_);
        shade = shade_sample(s_, {g.x[m], g.y[m], g.z[m]}, g.per_cell[m], lit_);
      }
      const float alpha = alpha_of(medium.density * length_[n]);
      blend(*live_[n], alpha * (medium.r * shade.diffuse + shade.flash), alpha * (medium.g * shade.diffuse + shade.flash),
            alpha * (medium.b * shade.diffuse + shade.flash), alpha);
    }
  }

  void blend(Pixel& p, float r, float g, float b, float alpha) const {
    if (k_.options.front_to_back) return p.sum.behind(r, g, b, alpha);
    const float pass = 1 - alpha;
    p.back[0] = r + pass * p.back[0], p.back[1] = g + pass * p.back[1], p.back[2] = b + pass * p.back[2];
    p.back[3] = alpha + pass * p.back[3];
  }

  void collect(const Run& run, int count) const {
    const RayFunction mode = s_.item.mode;
    for (int n = 0; n < count; ++n) {
      const float value = run.value[n];
      Pixel& p = *live_[n];
      if (value != value) continue;
      p.total += double(value) * double(length_[n]), p.length += double(length_[n]);
      if (!(p.best == p.best) || (mode == RayFunction::maximum ? value > p.best : value < p.best)) p.best = value;
    }
  }

  const Stack& k_;
  const Stage& s_;
  int x0_, y0_, x1_, y1_;
  double first_ = 0, last_ = 0;
  bool composite_ = true, skip_ = true, rising_ = true;
  std::vector<Pixel> pixels_;
  LitRay lit_;
  Pixel* live_[run_length];
  float length_[run_length];
  double place_[3][run_length];
  float u_[3][run_length];
};

}  // namespace

Layer slices(const LayerInput& input, const SliceOptions& options) {
  const Stage stage =
      make_stage(input, {"slices",
                         {RayFunction::composite, RayFunction::maximum, RayFunction::minimum, RayFunction::average, RayFunction::sum},
                         true,
                         true,
                         true});
  Layer layer;
  layer.rgba.assign(4 * stage.pixels(), 0.0f);
  if (stage.empty) return layer;
  Stack stack{stage, options, -1, {}, 0};
  if (options.stack == SliceOptions::Stack::view) view_stack(stack);
  else axis_stack(stack);
  const Ink ink(input.item);
  const int width = stage.projection.width, height = stage.projection.height;
  const size_t across = size_t(width + tile_width - 1) / tile_width, down = size_t(height + tile_height - 1) / tile_height;
  parallel_for(
      across * down, 1,
      [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) {
          Tile tile(stack, int(t % across) * tile_width, int(t / across) * tile_height);
          tile.draw();
          tile.write(ink, layer.rgba);
        }
      },
      &input.context);
  return layer;
}

Layer slices(const LayerInput& input) { return slices(input, SliceOptions{}); }

}  // namespace sg::volume
