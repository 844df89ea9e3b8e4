// SPDX-License-Identifier: Apache-2.0
// Splatting: each voxel of an affine lattice is thrown onto the picture as the footprint of its kernel.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "render/volume/methods/options.h"
#include "render/volume/methods/splat_list.h"
#include "render/volume/sources/lattice/runs.h"

namespace sg::volume {

namespace {

using Four = float __attribute__((vector_size(16)));

/// Deviations of depth by which a kernel may lean from its middle to its edge (4.3 deviations away) and still be set upright.
constexpr float upright_below = 1.6f;

/// How much of a field that is 1 in the box the kernels of its voxels make of it: along each axis, between 3 voxels outside and the same on
/// the other side. Within the border of the box less arrives than there is, beyond it there is something left.
class Arriving {
 public:
  explicit Arriving(const Volume& v) {
    const double per = 1 / (kernel_sigma * 2.5066282746310002);
    for (int a = 0; a < 3; ++a) {
      lo_[a] = v.lo[a] - fringe, hi_[a] = v.hi[a] + fringe;
      inner_lo_[a] = v.lo[a] + fringe, inner_hi_[a] = v.hi[a] - fringe;
      const size_t n = v.voxels.dims[size_t(a)], count = size_t((hi_[a] - lo_[a]) * steps) + 2;
      std::vector<float>& axis = at_[a];
      for (size_t k = 0; k < count; ++k) {
        const double q = lo_[a] + double(k) / steps;
        double sum = 0;
        for (size_t i = size_t(std::max(0.0, q - fringe)); i < n && double(i) < q + fringe; ++i) {
          const double share = std::min(v.hi[a], double(i) + 0.5) - std::max(v.lo[a], double(i) - 0.5), d = (q - double(i)) / kernel_sigma;
          sum += std::max(0.0, share) * per * exp_negative(0.5 * d * d);
        }
        axis.push_back(std::abs(sum - 1) < 1e-3 ? 1.0f : float(sum));  // ripples of the kernel are not the border's
      }
    }
  }

  /// The mean over the way from a to b.
  double between(Vec3 a, Vec3 b) const {
    bool inner = true;
    for (int i = 0; i < 3; ++i) inner = inner && std::min(a[i], b[i]) > inner_lo_[i] && std::max(a[i], b[i]) < inner_hi_[i];
    if (inner) return 1;
    // Simpson's rule, four parts a voxel.
    const Vec3 d = b - a;
    const int parts = 2 * std::clamp(int(2 * std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)})) + 1, 1, 64);
    double sum = at(a) + at(b);
    for (int i = 1; i < parts; ++i) sum += (i % 2 ? 4 : 2) * at(a + d * (double(i) / parts));
    return sum / (3 * parts);
  }

 private:
  static constexpr double fringe = kernel_reach * kernel_sigma;
  static constexpr int steps = 32;  // in a voxel
  double at(Vec3 q) const {
    double product = 1;
    for (int a = 0; a < 3; ++a) {
      if (!(q[a] > lo_[a] && q[a] < hi_[a])) return 0;
      const double u = (q[a] - lo_[a]) * steps;
      const auto i = std::min(size_t(u), at_[a].size() - 2);
      product *= double(at_[a][i]) + (u - double(i)) * (double(at_[a][i + 1]) - double(at_[a][i]));
    }
    return product;
  }
  Vec3 lo_, hi_, inner_lo_, inner_hi_;
  std::vector<float> at_[3];
};

struct Job {
  const Stage& stage;
  const Footprints& footprints;
  const SplatList& list;
  const KernelTable& table;
  const Arriving* arriving;  // null: voxels are smaller than pixels, which soften the border as they do all else
  bool after;                // classify the sheets' pixels
  double sheet;              // depth of a sheet
  double nearest, farthest;
  std::vector<Shade> shades;  // of the listed voxels, when they are classified and shaded before
};

/// One band of rows, from near to far.
class Band {
 public:
  Band(const Job& job, size_t number) : j_(job), s_(job.stage), number_(number) {
    width_ = s_.projection.width, y0_ = int(number) * SplatList::band, y1_ = std::min(y0_ + SplatList::band, s_.projection.height);
    const size_t n = size_t(width_) * size_t(y1_ - y0_);
    sums_.resize(n);
    composite_ = s_.item.mode == RayFunction::composite;
    if (!composite_) best_.assign(n, NAN), totals_.assign(n, {0, 0});
    lit_ = s_.lit(s_.projection.forward);
    if (!j_.arriving) return;
    for (int y = y0_; y < y1_; ++y)
      for (int x = 0; x < width_; ++x) {
        const PixelRay ray = s_.ray(x, y);
        inside_.push_back({ray.first_depth + ray.enter * ray.per_length, ray.first_depth + ray.leave * ray.per_length});
      }
  }

  /// Voxels come by depth: a sheet is done when the next kernel begins behind it. As many are open as a kernel is deep.
  void sheets() {
    const double reach = j_.footprints.reach();
    const size_t count = size_t(std::ceil((j_.farthest - j_.nearest) / j_.sheet));
    ring_.resize(size_t(2 * reach / j_.sheet) + 3);
    for (Sheet& sheet : ring_) {
      sheet.sums.assign(channels() * sums_.size(), 0.0f);
      sheet.touched.assign(size_t(y1_ - y0_), {width_, -1});
    }
    weights_.resize(size_t(width_));
    size_t next = 0;
    for (const uint32_t* p = j_.list.begin(number_); p < j_.list.end(number_); ++p) {
      const Vec3 q = j_.list.q(*p);
      const double depth = j_.footprints.depth(q) - j_.nearest;
      if (depth + reach <= 0) continue;
      const size_t first = std::max(next, size_t(std::max(0.0, (depth - reach) / j_.sheet)));
      const size_t last = std::min(count, size_t((depth + reach) / j_.sheet) + 1);
      for (; next < std::min(first, count); ++next) composite_sheet(next);
      if (opaque_ == sums_.size() || first >= last) continue;
      Footprint f;
      if (j_.footprints.at(q, f)) spread(f, value(*p), first, last);
    }
    for (; next < count; ++next) composite_sheet(next);
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
  /// Sums of a sheet, a plane of pixels per channel: density times colour and density, or value and length.
  struct Sheet {
    std::vector<float> sums;
    std::vector<std::pair<int, int>> touched;  // per row: the pixels
  };
  size_t channels() const { return j_.after ? 2 : 4; }

  /// What a mode other than composite shows. Kernels reach beyond the box; rays that miss it show nothing.
  double collected(size_t i) const {
    const PixelRay ray = s_.ray(int(i % size_t(width_)), y0_ + int(i / size_t(width_)));
    if (!(ray.leave > ray.enter)) return NAN;
    const auto [total, length] = totals_[i];
    const double base = double(s_.volume.base);
    if (s_.item.mode == RayFunction::sum) return total + base * length;
    if (s_.item.mode == RayFunction::average) return length > 0 ? total / length + base : NAN;
    // Rays that only touch the kernels' fringe show its mean.
    if (!(best_[i] == best_[i])) return length > 0 ? total / length + base : NAN;
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
    if (j_.after) return Four{v.value * v.share, v.share, 0, 0};
    const Transfer::Medium& m = s_.transfer().medium(s_.transfer().index(v.value));
    const Shade shade = j_.shades.empty() ? Shade{} : j_.shades[place];
    const float density = std::min(m.density, 1e20f) * v.share;
    return Four{m.r * shade.diffuse + shade.flash, m.g * shade.diffuse + shade.flash, m.b * shade.diffuse + shade.flash, 1} * density;
  }

  /// A kernel's parts between the planes of the sheets [first, last), added to them.
  void spread(const Footprint& f, Four value, size_t first, size_t last) {
    const auto plane = [&](size_t n) { return float((j_.nearest + double(n) * j_.sheet - double(f.depth)) / double(f.deviation)); };
    // A kernel that leans little is sheared upright: it keeps its sums across and along, and each sheet's share is one number.
    const bool upright = std::abs(f.slope_x) * f.half_x + std::abs(f.slope_y) * f.half_y < upright_below;
    shares_.clear();
    for (size_t n = first; n < last; ++n) shares_.push_back(j_.table.before(plane(n + 1)) - j_.table.before(plane(n)));
    rows(f, [&](int y) {
      int from = width_, to = -1;
      footprint_row(j_.table, f, y, width_,
                    [&](int x, float, float share) { weights_[size_t(x)] = share, from = std::min(from, x), to = x; });
      if (to < from) return;
      for (size_t n = first; n < last; ++n) {
        if (upright && !(shares_[n - first] > 0)) continue;
        Sheet& sheet = ring_[n % ring_.size()];
        auto& [low, high] = sheet.touched[size_t(y - y0_)];
        low = std::min(low, from), high = std::max(high, to);
        const float middle = f.slope_y * (float(y) + 0.5f - f.y) + f.slope_x * (0.5f - f.x), a = plane(n) - middle,
                    b = plane(n + 1) - middle;
        for (size_t c = 0; c < channels(); ++c) {
          float* __restrict out = &sheet.sums[c * sums_.size() + row(y)];
          const float* __restrict weight = weights_.data();
          if (upright) {
            const float amount = value[c] * shares_[n - first];
            for (int x = from; x <= to; ++x) out[x] += amount * weight[x];
          } else {
            for (int x = from; x <= to; ++x) {
              const float lean = f.slope_x * float(x);
              out[x] += value[c] * weight[x] * (j_.table.before(b - lean) - j_.table.before(a - lean));
            }
          }
        }
      }
    });
  }

  /// Share of a sheet that lies in the box, in front of a pixel's surface and between near and far, and what it has to be multiplied by as
  /// the kernels of the border lie partly outside.
  std::pair<float, float> seen(size_t pixel, int x, int y, double z0, double z1) const {
    if (j_.arriving) {
      const auto [enter, leave] = inside_[pixel];
      const double from = std::max(z0, enter), to = std::min(z1, leave);
      if (!(to > from)) return {0, 1};
      const double mean = j_.arriving->between(j_.footprints.q_at(x + 0.5, y + 0.5, z0), j_.footprints.q_at(x + 0.5, y + 0.5, z1));
      return {float((to - from) / (z1 - z0)), float(1 / std::max(mean, 0.01))};
    }
    const double far = std::min(s_.projection.far_plane, double(s_.opaque.depth[size_t(y0_) * size_t(width_) + pixel]));
    const double from = std::max(z0, s_.projection.near_plane), to = std::min(z1, far);
    return {to > from ? float((to - from) / (z1 - z0)) : 0, 1};
  }

  void composite_sheet(size_t number) {
    Sheet& sheet = ring_[number % ring_.size()];
    const double z0 = j_.nearest + double(number) * j_.sheet, z1 = z0 + j_.sheet;
    const size_t n = sums_.size();
    for (int y = y0_; y < y1_; ++y) {
      auto& [first, last] = sheet.touched[size_t(y - y0_)];
      for (int x = first; x <= last; ++x) {
        const size_t at = row(y) + size_t(x);
        float s[4];
        for (size_t c = 0; c < channels(); ++c) s[c] = sheet.sums[c * n + at], sheet.sums[c * n + at] = 0;
        const float amount = s[channels() - 1];
        if (!(amount > 0) || sums_[at].transmittance < opaque_below) continue;
        const auto [in_sight, whole] = seen(at, x, y, z0, z1);
        if (in_sight == 0) continue;
        const float share = in_sight * whole;
        if (!composite_) {
          collect(at, s[0] * whole, amount * whole, in_sight);
        } else if (!j_.after) {
          const float alpha = alpha_of(amount * share), color = alpha / amount;
          blend(at, s[0] * color, s[1] * color, s[2] * color, alpha);
        } else {
          classify(at, x, y, s[0] / amount, amount * share, 0.5 * (z0 + z1));
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

  void collect(size_t at, float sum, float length, float share) {
    totals_[at].first += double(sum) * double(share), totals_[at].second += double(length) * double(share);
    if (!(length > 0.5f * float(j_.sheet))) return;  // the kernels' fringe
    const float value = sum / length;
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
      if (!s_.projection.parallel) s_.light(s_.projection.ray(x_[n] + 0.5, y_[n] + 0.5).direction, lit_);
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
  std::vector<Sheet> ring_;
  std::vector<std::pair<double, double>> inside_;  // depths between which a pixel's ray is in the box and in sight
  std::vector<float> weights_, shares_;
  std::vector<float> best_;                        // modes other than composite
  std::vector<std::pair<double, double>> totals_;  // value times length, length
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
          if (!s.projection.parallel) s.light(s.sight(s.world(q)), lit);
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
  bool after =
      options.classify == Classify::as_item ? input.item.sampling.classify != VolumeClassify::pre : options.classify == Classify::after;
  after = !composite || (after && !whole && !stage.volume.nearest);  // the mean of two labels is none
  const Footprints footprints(stage);
  const SplatList list(stage, footprints, composite && !after);
  const KernelTable table;
  std::optional<Arriving> arriving;
  if (footprints.resolved()) arriving.emplace(stage.volume);
  // A sheet is one voxel's smallest edge deep.
  Job job{stage,
          footprints,
          list,
          table,
          arriving ? &*arriving : nullptr,
          after,
          input.item.sampling.step > 0 ? input.item.sampling.step : 2 * stage.volume.step,
          HUGE_VAL,
          -HUGE_VAL,
          {}};
  const Vec3 lo = stage.volume.lo, hi = stage.volume.hi;
  if (!(footprints.reach() / job.sheet < 100))
    fail_usage(fmt::format("sheets of {} are too thin for kernels with reach {:.4g}", job.sheet, footprints.reach()), "volume",
               "use a longer step, or 0 for one voxel");
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
