// SPDX-License-Identifier: Apache-2.0
// Splatting: each voxel of an affine lattice is thrown onto the picture as the footprint of its kernel.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/volume/classic/options.h"
#include "render/volume/classic/splat_list.h"
#include "render/volume/lattice/runs.h"

namespace sg::volume {

namespace {

using Four = float __attribute__((vector_size(16)));

struct Job {
  const Stage& stage;
  const Footprints& footprints;
  const SplatList& list;
  const KernelTable& table;
  bool after;    // classify the sheets' pixels
  double sheet;  // depth of a sheet
  double nearest, farthest;
  std::vector<Shade> shades;  // of the listed voxels, when they are classified and shaded before
};

/// One band of rows, from near to far.
class Band {
 public:
  Band(const Job& job, size_t number) : j_(job), s_(job.stage), number_(number) {
    width_ = s_.projection.width, y0_ = int(number) * SplatList::band, y1_ = std::min(y0_ + SplatList::band, s_.projection.height);
    const size_t n = size_t(width_) * size_t(y1_ - y0_);
    sums_.resize(n), sheet_.assign(n, Four{0, 0, 0, 0});
    composite_ = s_.item.mode == RayFunction::composite;
    if (!composite_) best_.assign(n, NAN), totals_.assign(n, {0, 0});
    if (s_.projection.parallel) lit_ = s_.lit(s_.projection.forward);
    touched_.assign(size_t(y1_ - y0_), {width_, -1});
    full_ = float(1 / length(s_.volume.to_q * s_.projection.forward));
  }

  void sheets() {
    const uint32_t *from = j_.list.begin(number_), *const last = j_.list.end(number_);
    std::vector<Footprint> window;  // of the voxels [from, to)
    std::vector<Four> values;
    size_t first_kept = 0;
    const uint32_t* to = from;
    const double reach = j_.footprints.reach();
    const size_t count = size_t(std::ceil((j_.farthest - j_.nearest) / j_.sheet));
    for (size_t i = 0; i < count; ++i) {
      const double z0 = j_.nearest + double(i) * j_.sheet, z1 = std::min(z0 + j_.sheet, j_.farthest);
      while (to < last && j_.footprints.depth(j_.list.q(*to)) - reach < z1) {
        Footprint f;
        j_.footprints.at(j_.list.q(*to), f);
        window.push_back(f), values.push_back(value(*to)), ++to;
      }
      while (first_kept < window.size() && double(window[first_kept].depth) + reach <= z0) ++first_kept, ++from;
      if (first_kept > 4096 && first_kept > window.size() / 2) {
        window.erase(window.begin(), window.begin() + ptrdiff_t(first_kept)),
            values.erase(values.begin(), values.begin() + ptrdiff_t(first_kept));
        first_kept = 0;
      }
      for (size_t v = first_kept; v < window.size(); ++v) part(window[v], values[v], z0, z1);
      composite_sheet(z0, z1);
      if (opaque_ == sums_.size()) return;
    }
  }

  void whole() {
    for (const uint32_t* p = j_.list.begin(number_); p < j_.list.end(number_) && opaque_ < sums_.size(); ++p) {
      Footprint f;
      j_.footprints.at(j_.list.q(*p), f);
      if (double(f.depth) < s_.projection.near_plane || double(f.depth) > s_.projection.far_plane) continue;
      const Four v = value(*p);
      const float density = v[3];
      const Four color = {v[0] / density, v[1] / density, v[2] / density, 0};
      rows(f, [&](int y) {
        const float* opaque = &s_.opaque.depth[size_t(y) * size_t(width_)];
        Gathered* sums = &sums_[row(y)];
        footprint_row(j_.table, f, y, width_, [&](int x, float, float share) {
          Gathered& g = sums[x];
          if (g.transmittance < opaque_below || opaque[x] < f.depth) return;
          const float alpha = alpha_of(density * share);
          g.behind(alpha * color[0], alpha * color[1], alpha * color[2], alpha);
          opaque_ += g.transmittance < opaque_below;
        });
      });
    }
  }

  void write(const Ink& ink, std::vector<float>& rgba) const {
    for (size_t i = 0; i < sums_.size(); ++i) {
      float* out = &rgba[4 * (size_t(y0_) * size_t(width_) + i)];
      const Gathered& g = sums_[i];
      if (composite_) out[0] = g.r, out[1] = g.g, out[2] = g.b, out[3] = 1 - g.transmittance;
      else ink.draw(collected(i), out);
    }
  }

 private:
  /// What a mode other than composite shows. Kernels reach beyond the box; rays that miss it show nothing.
  double collected(size_t i) const {
    const PixelRay ray = s_.ray(int(i % size_t(width_)), y0_ + int(i / size_t(width_)));
    if (!(ray.leave > ray.enter)) return NAN;
    const auto [total, length] = totals_[i];
    const double base = double(s_.volume.base);
    if (s_.item.mode == RayFunction::sum) return total + base * length;
    if (s_.item.mode == RayFunction::average) return length > 0 ? total / length + base : NAN;
    return double(best_[i]) + base;
  }

  size_t row(int y) const { return size_t(y - y0_) * size_t(width_); }

  template <class F>
  void rows(const Footprint& f, F&& each) const {
    const int from = std::max(y0_, int(std::floor(f.y - f.half_y))), to = std::min(y1_ - 1, int(std::floor(f.y + f.half_y)));
    for (int y = from; y <= to; ++y) each(y);
  }

  /// What a voxel adds up: density times colour and density; or its value and 1. Times its share of the box.
  Four value(uint32_t place) const {
    const Splat v = j_.list.splat(place);
    if (j_.after) return Four{v.value * v.share, 0, 0, v.share};
    const Transfer::Medium& m = s_.transfer().medium(s_.transfer().index(v.value));
    const Shade shade = j_.shades.empty() ? Shade{} : j_.shades[place];
    const float density = std::min(m.density, 1e20f) * v.share;
    return Four{m.r * shade.diffuse + shade.flash, m.g * shade.diffuse + shade.flash, m.b * shade.diffuse + shade.flash, 1} * density;
  }

  /// The part of a kernel between two depths, added to the sheet.
  void part(const Footprint& f, Four value, double z0, double z1) {
    const float a = float((z0 - double(f.depth)) / double(f.deviation)), b = float((z1 - double(f.depth)) / double(f.deviation));
    const float tilt = std::abs(f.slope_x) * f.half_x + std::abs(f.slope_y) * f.half_y;
    // What lies above the same depths everywhere under the footprint needs no second table.
    const bool level = tilt < 0.02f;
    const float here = j_.table.before(b) - j_.table.before(a);
    if (level && !(here > 0)) return;
    rows(f, [&](int y) {
      Four* out = &sheet_[row(y)];
      int from = width_, to = -1;
      const float shift = f.slope_y * (float(y) + 0.5f - f.y);
      const auto touch = [&](int x) { from = std::min(from, x), to = x; };
      if (level) footprint_row(j_.table, f, y, width_, [&](int x, float, float share) { out[x] += value * (share * here), touch(x); });
      else
        footprint_row(j_.table, f, y, width_, [&](int x, float dx, float share) {
          const float middle = shift + f.slope_x * dx;
          out[x] += value * (share * (j_.table.before(b - middle) - j_.table.before(a - middle))), touch(x);
        });
      auto& [first, last] = touched_[size_t(y - y0_)];
      first = std::min(first, from), last = std::max(last, to);
    });
  }

  /// Share of a sheet that lies in front of a pixel's surface and between near and far.
  float seen(size_t pixel, double z0, double z1) const {
    const double far = std::min(s_.projection.far_plane, double(s_.opaque.depth[size_t(y0_) * size_t(width_) + pixel]));
    const double from = std::max(z0, s_.projection.near_plane), to = std::min(z1, far);
    return to > from ? float((to - from) / (z1 - z0)) : 0;
  }

  void composite_sheet(double z0, double z1) {
    for (int y = y0_; y < y1_; ++y) {
      auto& [first, last] = touched_[size_t(y - y0_)];
      for (int x = first; x <= last; ++x) {
        const size_t at = row(y) + size_t(x);
        const Four s = sheet_[at];
        if (!(s[3] > 0)) continue;
        sheet_[at] = Four{0, 0, 0, 0};
        const float share = seen(at, z0, z1);
        if (share == 0 || sums_[at].transmittance < opaque_below) continue;
        if (!composite_) {
          collect(at, s, share);
        } else if (!j_.after) {
          const float alpha = alpha_of(s[3] * share), color = alpha / s[3];
          blend(at, s[0] * color, s[1] * color, s[2] * color, alpha);
        } else {
          classify(at, x, y, s[0] / s[3], s[3] * share, 0.5 * (z0 + z1));
        }
      }
      if (waiting_ > 0) flush();
      first = width_, last = -1;
    }
  }

  void blend(size_t at, float r, float g, float b, float alpha) {
    sums_[at].behind(r, g, b, alpha);
    opaque_ += sums_[at].transmittance < opaque_below;
  }

  void collect(size_t at, Four s, float share) {
    totals_[at].first += double(s[0]) * double(share), totals_[at].second += double(s[3]) * double(share);
    if (!(s[3] > 0.5f * full_ * float(j_.sheet))) return;  // the kernels' fringe
    const float value = s[0] / s[3];
    float& best = best_[at];
    if (!(best == best) || (s_.item.mode == RayFunction::maximum ? value > best : value < best)) best = value;
  }

  void classify(size_t at, int x, int y, float value, float length, double depth) {
    const int entry = s_.transfer().index(value);
    const Transfer::Medium& m = s_.transfer().medium(entry);
    if (!(m.density > 0)) return;
    if (!s_.item.shaded) {
      const float alpha = alpha_of(m.density * length);
      return blend(at, alpha * m.r, alpha * m.g, alpha * m.b, alpha);
    }
    const Vec3 q = j_.footprints.q_at(x + 0.5, y + 0.5, depth);
    const int n = waiting_++;
    run_.ux[n] = s_.volume.u(0, q.x), run_.uy[n] = s_.volume.u(1, q.y), run_.uz[n] = s_.volume.u(2, q.z);
    run_.value[n] = value, run_.entry[n] = entry;
    at_[n] = at, x_[n] = x, y_[n] = y, length_[n] = length;
    if (waiting_ == run_length) flush();
  }

  /// Lights up to a run of classified pixels by the gradient of the field at their places.
  void flush() {
    int which[run_length];
    for (int n = 0; n < run_length; ++n) which[n] = n;
    Gradients g;
    gradients(
        s_.volume, run_, which, waiting_, [](int, int) { return 0.0; }, g);
    for (int n = 0; n < waiting_; ++n) {
      if (!s_.projection.parallel) lit_ = s_.lit(s_.projection.ray(x_[n] + 0.5, y_[n] + 0.5).direction);
      const Shade shade = shade_sample(s_, {g.x[n], g.y[n], g.z[n]}, g.per_cell[n], lit_);
      const Transfer::Medium& m = s_.transfer().medium(run_.entry[n]);
      const float alpha = alpha_of(m.density * length_[n]), white = alpha * shade.flash, color = alpha * shade.diffuse;
      blend(at_[n], color * m.r + white, color * m.g + white, color * m.b + white, alpha);
    }
    waiting_ = 0;
  }

  const Job& j_;
  const Stage& s_;
  const size_t number_;
  int width_, y0_, y1_;
  bool composite_ = true;
  std::vector<Gathered> sums_;
  std::vector<Four> sheet_;
  std::vector<std::pair<int, int>> touched_;       // per row: the pixels that the sheet touches
  std::vector<float> best_;                        // modes other than composite
  std::vector<std::pair<double, double>> totals_;  // value times length, length
  float full_ = 1;                                 // world length of a ray through one voxel
  size_t opaque_ = 0;                              // pixels
  LitRay lit_;
  Run run_;
  int waiting_ = 0, x_[run_length], y_[run_length];
  size_t at_[run_length];
  float length_[run_length];
};

/// Light on every listed voxel.
void shade_voxels(Job& job) {
  const Stage& s = job.stage;
  job.shades.resize(job.list.size());
  parallel_for(
      job.list.size(), 4096,
      [&](size_t begin, size_t end) {
        LitRay lit = s.lit(s.projection.forward);
        for (size_t i = begin; i < end; ++i) {
          const Vec3 q = job.list.q(uint32_t(i));
          if (!s.projection.parallel) lit = s.lit(s.sight(s.world(q)));
          const PointGradient g = gradient_at_sample(s.volume, size_t(q.x), size_t(q.y), size_t(q.z));
          job.shades[i] = shade_sample(s, g.q, g.per_cell, lit);
        }
      },
      &s.context);
}

}  // namespace

Layer splat(const LayerInput& input, const SplatOptions& options) {
  const Stage stage = make_stage(
      input, {"splat", {RayFunction::composite, RayFunction::maximum, RayFunction::minimum, RayFunction::average, RayFunction::sum}});
  Layer layer;
  layer.rgba.assign(4 * stage.pixels(), 0.0f);
  if (stage.empty) return layer;
  const bool composite = input.item.mode == RayFunction::composite, whole = composite && options.order == SplatOptions::Order::whole;
  using Classify = SplatOptions::Classify;
  bool after = options.classify == Classify::as_item ? input.item.sampling.classify != "pre" : options.classify == Classify::after;
  after = !composite || (after && !whole && !stage.volume.nearest);  // the mean of two labels is none
  const Footprints footprints(stage);
  const SplatList list(stage, footprints, composite && !after);
  const KernelTable table;
  // A sheet is one voxel's smallest edge deep.
  Job job{stage,    footprints, list, table, after, input.item.sampling.step > 0 ? input.item.sampling.step : 2 * stage.volume.step,
          HUGE_VAL, -HUGE_VAL,  {}};
  const Vec3 lo = stage.volume.lo, hi = stage.volume.hi;
  for (int c = 0; c < 8; ++c) {
    const double z = footprints.depth({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z});
    job.nearest = std::min(job.nearest, z - footprints.reach()), job.farthest = std::max(job.farthest, z + footprints.reach());
  }
  job.nearest = std::max(job.nearest, input.projection.near_plane);
  job.farthest = std::max(std::min(job.farthest, input.projection.far_plane), job.nearest);
  if (input.item.shaded && composite && !after) shade_voxels(job);
  const Ink ink(input.item);
  parallel_for(
      size_t(input.projection.height + SplatList::band - 1) / SplatList::band, 1,
      [&](size_t begin, size_t end) {
        for (size_t b = begin; b < end; ++b) {
          Band band(job, b);
          if (whole) band.whole();
          else band.sheets();
          band.write(ink, layer.rgba);
        }
      },
      &input.context);
  return layer;
}

Layer splat(const LayerInput& input) { return splat(input, SplatOptions{}); }

}  // namespace sg::volume
