// SPDX-License-Identifier: Apache-2.0
// Shear-warp (Lacroute, Levoy 1994): slices are sheared (and, in perspective, scaled) so that all rays become perpendicular to them,
// composited scanline by scanline into an intermediate picture on the plane of one slice, which is then warped onto the screen.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/volume/methods/shear_factors.h"

namespace sg::volume {

namespace {

using Four = float __attribute__((vector_size(16)));

struct WarpJob {
  const Stage& stage;
  const Factors& factors;
  const EncodedVolume* encoded = nullptr;  // composite
  std::vector<Shade> shades;               // by direction code, where there is a surface
  std::vector<Four> entries;               // straight colour and alpha of a slice at `length`
  double length = 1;                       // world length between two slices on the middle ray
  bool limited = false;                    // surfaces, or near and far, cut the volume
};

/// The part of a ray that is seen, in slices.
struct Limit {
  float from, to;
};

/// A few rows of the intermediate picture.
class Rows {
 public:
  Rows(const WarpJob& job, int v0, int v1) : j_(job), f_(job.factors), s_(job.stage), v0_(v0), v1_(v1) {
    const size_t n = size_t(f_.width) * size_t(v1 - v0);
    sums_.resize(n);
    ni_ = s_.volume.voxels.dims[size_t(f_.axes.i)], nj_ = s_.volume.voxels.dims[size_t(f_.axes.j)];
    lo_ = permuted(s_.volume.lo, f_.axes), hi_ = permuted(s_.volume.hi, f_.axes);
    next_.resize(n);
    for (size_t p = 0; p < n; ++p) next_[p] = int(p % size_t(f_.width));
    if (!f_.parallel || j_.limited) along_rays();
    for (Row& r : cache_) r.at.assign(ni_ + 3, Four{0, 0, 0, 0});
  }

  void composite() {
    const size_t nk = s_.volume.voxels.dims[size_t(f_.axes.k)];
    for (size_t n = 0; n < nk; ++n) {
      const size_t k = f_.rising ? n : nk - 1 - n;
      for (int v = v0_; v < v1_; ++v) scanline(k, v);
    }
  }

  void extremes(std::vector<float>& best) {
    const size_t nk = s_.volume.voxels.dims[size_t(f_.axes.k)];
    const bool most = s_.item.mode == RayFunction::maximum;
    for (size_t k = 0; k < nk; ++k) {
      if (double(k) > hi_.z) continue;
      const double scale = f_.scale(double(k)), shift = f_.shift_i(double(k));
      for (int v = v0_; v < v1_; ++v) {
        size_t j;
        float fj;
        int from, to;
        if (!across(k, v, 0, j, fj) || !reach(scale, shift, lo_.x, hi_.x, from, to)) continue;
        float* out = &best[size_t(v) * size_t(f_.width)];
        for (int u = from; u <= to; ++u) {
          if (!seen(v, u, k)) continue;
          const float x = float(std::clamp(scale * u + shift, 0.0, double(ni_ - 1))), fi = x - std::floor(x);
          const size_t i = size_t(x), i1 = std::min(i + 1, ni_ - 1), j1 = std::min(j + 1, nj_ - 1);
          const auto mix = [](float a, float b, float t) { return t == 0 ? a : a + t * (b - a); };
          const float value = mix(mix(voxel(i, j, k), voxel(i1, j, k), fi), mix(voxel(i, j1, k), voxel(i1, j1, k), fi), fj);
          if (value == value && (!(out[u] == out[u]) || (most ? value > out[u] : value < out[u]))) out[u] = value;
        }
      }
    }
  }

  const Gathered* row(int v) const { return &sums_[size_t(v - v0_) * size_t(f_.width)]; }

 private:
  /// A decoded scanline, one voxel beyond each end.
  struct Row {
    size_t k = size_t(-1), j = size_t(-1);
    std::vector<Four> at;
    const EncodedVolume::Run *begin = nullptr, *end = nullptr;
  };

  size_t index(int v, int u) const { return size_t(v - v0_) * size_t(f_.width) + size_t(u); }
  float voxel(size_t i, size_t j, size_t k) const {
    size_t at[3];
    at[f_.axes.i] = i, at[f_.axes.j] = j, at[f_.axes.k] = k;
    return value_at(s_.volume, at[0], at[1], at[2]);
  }

  /// Length of a slice and what is seen, for the ray of each pixel.
  void along_rays() {
    factor_.resize(sums_.size());
    if (j_.limited) limits_.resize(sums_.size());
    for (int v = v0_; v < v1_; ++v)
      for (int u = 0; u < f_.width; ++u) {
        double place[3], per_slice[3];
        const double pi = f_.u0 + u / f_.resolution, pj = f_.v0 + v / f_.resolution;
        place[f_.axes.i] = pi, place[f_.axes.j] = pj, place[f_.axes.k] = f_.plane;
        const double gap = f_.plane - f_.eye.z;
        per_slice[f_.axes.i] = f_.parallel ? f_.shear_i : (pi - f_.eye.x) / gap;
        per_slice[f_.axes.j] = f_.parallel ? f_.shear_j : (pj - f_.eye.y) / gap;
        per_slice[f_.axes.k] = 1;
        const Vec3 step = s_.to_world * Vec3{per_slice[0], per_slice[1], per_slice[2]};
        factor_[index(v, u)] = float(length(step) / j_.length);
        if (j_.limited) limits_[index(v, u)] = limit(s_.world({place[0], place[1], place[2]}), dot(step, s_.projection.forward));
      }
  }

  Limit limit(Vec3 world, double depth_per_slice) const {
    const Projection& p = s_.projection;
    const Vec3 at = p.to_pixel(world);
    if (!p.parallel && !(at.z > 0)) return {1, -1};
    const size_t x = size_t(std::clamp(at.x, 0.0, p.width - 1.0)), y = size_t(std::clamp(at.y, 0.0, p.height - 1.0));
    const double far = std::min(p.far_plane, double(s_.opaque.depth[y * size_t(p.width) + x]));
    double from = f_.plane + (p.near_plane - at.z) / depth_per_slice, to = f_.plane + (far - at.z) / depth_per_slice;
    if (from > to) std::swap(from, to);
    return {float(from), float(to)};
  }

  bool seen(int v, int u, size_t k) const {
    if (limits_.empty()) return true;
    const Limit& l = limits_[index(v, u)];
    return float(k) >= l.from && float(k) <= l.to;
  }

  /// The scanlines j, j+1 that a row of the picture lies between; beyond the box (by at most `margin`) the outermost.
  bool across(size_t k, int v, double margin, size_t& j, float& fj) const {
    const double y = f_.scale(double(k)) * v + f_.shift_j(double(k));
    if (!(y >= lo_.y - margin - 1e-9 && y <= hi_.y + margin + 1e-9)) return false;
    const double inside = std::clamp(y, 0.0, double(nj_ - 1));
    j = std::min(size_t(inside), nj_ - 2), fj = float(inside - double(j));
    return true;
  }

  /// Pixels whose voxel coordinate lies in [from, to].
  bool reach(double scale, double shift, double from, double to, int& first, int& last) const {
    first = int(std::max(0.0, std::ceil((from - shift) / scale - 1e-9)));
    last = int(std::min(double(f_.width - 1), std::floor((to - shift) / scale + 1e-9)));
    return first <= last;
  }

  const Row& decode(size_t k, size_t j) {
    for (Row& r : cache_)
      if (r.k == k && r.j == j) return r;
    Row& r = cache_[j & 1];
    for (const auto* run = r.begin; run < r.end; ++run)
      std::fill(r.at.begin() + run->begin + 1, r.at.begin() + run->end + 1, Four{0, 0, 0, 0});
    r.at.front() = r.at[ni_ + 1] = Four{0, 0, 0, 0};
    r.k = k, r.j = j;
    const EncodedVolume::Slice& slice = j_.encoded->slices[k];
    r.begin = slice.runs.data() + slice.first_run[j], r.end = slice.runs.data() + slice.first_run[j + 1];
    size_t at = slice.first_voxel[j];
    for (const auto* run = r.begin; run < r.end; ++run)
      for (uint32_t i = run->begin; i < run->end; ++i, ++at) {
        Four c = j_.entries[slice.entry[at]];
        if (!slice.surface.empty()) {
          const float surface = float(slice.surface[at]) * (1.0f / 255);
          const Shade& shade = j_.shades[slice.normal[at]];
          const float d = 1 + surface * (shade.diffuse - 1), white = surface * shade.flash;
          c[0] = c[0] * d + white, c[1] = c[1] * d + white, c[2] = c[2] * d + white;
        }
        r.at[i + 1] = Four{c[0] * c[3], c[1] * c[3], c[2] * c[3], c[3]};
      }
    if (lo_.x < 0) r.at.front() = r.at[1], r.at[ni_ + 1] = r.at[ni_];  // the outer halves of cells
    return r;
  }

  /// A slice stands for the slab of half a slice to each side. [from, to] in slices: the part of a ray in it and in the box.
  struct Part {
    double from, to;
    /// Only where the coordinate x + slope * t lies in [lo, hi].
    void keep(double x, double slope, double lo, double hi) {
      if (slope == 0) {
        if (x < lo || x > hi) to = from;
        return;
      }
      const double a = (lo - x) / slope, b = (hi - x) / slope;
      from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
    }
  };
  double slope_i(int u) const { return f_.parallel ? f_.shear_i : (f_.u0 + u / f_.resolution - f_.eye.x) / (f_.plane - f_.eye.z); }
  double slope_j(int v) const { return f_.parallel ? f_.shear_j : (f_.v0 + v / f_.resolution - f_.eye.y) / (f_.plane - f_.eye.z); }

  /// Two scanlines of a slice under a row of the picture.
  struct Span {
    size_t k;
    int v;
    double scale, shift;
    float fj;
    const Row *a, *b;
    Part part;
    int whole_from, whole_to;  // pixels whose rays cross the whole slab inside the box
  };

  void scanline(size_t k, int v) {
    size_t j;
    float fj;
    const double lean_j = slope_j(v), lean_i = std::max(std::abs(slope_i(0)), std::abs(slope_i(f_.width - 1)));
    if (!across(k, v, 0.5 * std::abs(lean_j), j, fj)) return;
    Part part{std::max(-0.5, lo_.z - double(k)), std::min(0.5, hi_.z - double(k))};
    part.keep(f_.scale(double(k)) * v + f_.shift_j(double(k)), lean_j, lo_.y, hi_.y);
    if (!(part.to > part.from)) return;
    const Row &a = decode(k, j), &b = decode(k, j + 1);
    if (a.begin == a.end && b.begin == b.end) return;
    Span span{k, v, f_.scale(double(k)), f_.shift_i(double(k)), fj, &a, &b, part, f_.width, -1};
    int inside_from, inside_to;
    if (!reach(span.scale, span.shift, lo_.x - 0.5 * lean_i, hi_.x + 0.5 * lean_i, inside_from, inside_to)) return;
    if (part.to - part.from == 1 && limits_.empty())
      reach(span.scale, span.shift, lo_.x + 0.5 * lean_i, hi_.x - 0.5 * lean_i, span.whole_from, span.whole_to);
    // Runs of either scanline, joined where they overlap; a voxel is felt less than one voxel away, an outermost one beyond.
    const EncodedVolume::Run *p = a.begin, *q = b.begin;
    const auto take = [&](bool always, int64_t end, int64_t& from, int64_t& to) {
      const bool left = p < a.end, right = q < b.end;
      if (!left && !right) return false;
      const EncodedVolume::Run*& r = !right || (left && p->begin <= q->begin) ? p : q;
      if (!always && int64_t(r->begin) - 1 >= end) return false;
      from = r->begin == 0 ? -int64_t(ni_) : int64_t(r->begin) - 1, to = r->end == ni_ ? 2 * int64_t(ni_) : int64_t(r->end), ++r;
      return true;
    };
    int64_t from, to;
    while (take(true, 0, from, to)) {
      int64_t more_from, more_to;
      while (take(false, to, more_from, more_to)) to = std::max(to, more_to);
      int first, last;
      if (reach(span.scale, span.shift, double(from), double(to), first, last))
        blend(span, std::max(first, inside_from), std::min(last, inside_to));
    }
  }

  int next_open(int* next, int u) const {
    while (u < f_.width && next[u] != u) {
      if (next[u] < f_.width) next[u] = next[next[u]];
      u = next[u];
    }
    return u;
  }

  void blend(const Span& s, int first, int last) {
    int* next = &next_[index(s.v, 0)];
    Gathered* sums = &sums_[index(s.v, 0)];
    for (int u = next_open(next, first); u <= last; u = next_open(next, u + 1)) {
      const double place = s.scale * u + s.shift;
      float length = f_.parallel ? 1 : factor_[index(s.v, u)];
      if (u < s.whole_from || u > s.whole_to) {
        Part part = s.part;
        part.keep(place, slope_i(u), lo_.x, hi_.x);
        if (!limits_.empty()) {
          const Limit& l = limits_[index(s.v, u)];
          part.from = std::max(part.from, double(l.from) - double(s.k)), part.to = std::min(part.to, double(l.to) - double(s.k));
        }
        if (!(part.to > part.from)) continue;
        length *= float(part.to - part.from);
      }
      const double x = std::clamp(place, lo_.x, hi_.x), whole = std::floor(x);
      const size_t i = size_t(int64_t(whole) + 1);
      const float fi = float(x - whole), w11 = fi * s.fj, w01 = fi - w11, w10 = s.fj - w11, w00 = 1 - fi - w10;
      Four c = s.a->at[i] * w00 + s.a->at[i + 1] * w01 + s.b->at[i] * w10 + s.b->at[i + 1] * w11;
      float alpha = c[3];
      if (!(alpha > 0)) continue;
      if (length != 1 && alpha < 1) {
        // The ray meets the slices at an angle of its own, or is cut.
        alpha = alpha_of(length * log_table(alpha));
        c *= alpha / c[3];
      }
      sums[u].behind(c[0], c[1], c[2], alpha);
      if (sums[u].transmittance < opaque_below) next[u] = u + 1;
    }
  }

  /// -log(1 - alpha) by straight lines between 4096 entries; beyond the last the medium is as good as opaque.
  static float log_table(float alpha) {
    static const std::vector<float> table = [] {
      std::vector<float> t(4098);
      for (int i = 0; i < 4098; ++i) t[size_t(i)] = i < 4096 ? float(minus_log_one_minus(i / 4096.0)) : 16;
      return t;
    }();
    if (alpha < 0.002f) return alpha * (1 + alpha * 0.5f);
    const float at = alpha * 4096;
    const int i = std::min(int(at), 4096);
    return table[size_t(i)] + (at - float(i)) * (table[size_t(i) + 1] - table[size_t(i)]);
  }

  const WarpJob& j_;
  const Factors& f_;
  const Stage& s_;
  int v0_, v1_;
  size_t ni_, nj_;
  Vec3 lo_, hi_;
  std::vector<Gathered> sums_;
  std::vector<int> next_;  // per row: the next pixel that is not opaque yet, from here on
  std::vector<float> factor_;
  std::vector<Limit> limits_;
  Row cache_[2];
};

bool cut_by_surfaces(const Stage& s) {
  for (const float d : s.opaque.depth)
    if (d < HUGE_VALF) return true;
  for (int c = 0; c < 8; ++c) {
    const Vec3 lo = s.volume.lo, hi = s.volume.hi;
    const double z = s.projection.to_eye(s.world({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z})).z;
    if (z < s.projection.near_plane || z > s.projection.far_plane) return true;
  }
  return false;
}

/// Tables of the view: colour and alpha of the entries, light by direction, lengths.
WarpJob make_job(const Stage& s, const Factors& f) {
  const Volume& v = s.volume;
  WarpJob job{s, f, nullptr, {}, {}, 1, cut_by_surfaces(s)};
  const Vec3 centre = (v.lo + v.hi) * 0.5, along = v.to_q * s.sight(s.world(centre));
  job.length = 1 / std::abs(along[f.axes.k]);
  if (s.item.mode != RayFunction::composite) return job;
  const int count = s.transfer().linear_table().count + 3;
  for (int i = 0; i < count; ++i) {
    const Transfer::Medium& m = s.transfer().medium(i);
    job.entries.push_back(Four{m.r, m.g, m.b, segment_alpha(m.density, job.length)});
  }
  if (!s.item.shaded) return job;
  const LitRay lit = s.lit(s.sight(s.world(centre)));
  job.shades.resize(65536);
  parallel_for(job.shades.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) job.shades[i] = shade_normal(direction_of(uint16_t(i)), 1, lit);
  });
  return job;
}

/// The place of a screen pixel's ray on the intermediate picture; false where it misses the volume.
bool warped(const Stage& s, const Factors& f, const PixelRay& r, double& u, double& v) {
  if (!(r.leave > r.enter)) return false;
  const Vec3 start = permuted(r.start, f.axes), along = permuted(r.along, f.axes);
  if (along.z == 0) return false;
  const double t = (f.plane - start.z) / along.z;
  if (!s.projection.parallel && !(t > 0)) return false;
  u = (start.x + t * along.x - f.u0) * f.resolution, v = (start.y + t * along.y - f.v0) * f.resolution;
  return u > -1 && v > -1 && u < f.width && v < f.height;
}

/// The four pixels around a place with their weights.
template <class F>
void around(const Factors& f, double u, double v, F&& each) {
  const int x = int(std::floor(u)), y = int(std::floor(v));
  const float fx = float(u - x), fy = float(v - y);
  for (int c = 0; c < 4; ++c) {
    const int px = x + (c & 1), py = y + (c >> 1);
    if (px < 0 || py < 0 || px >= f.width || py >= f.height) continue;
    each(size_t(py) * size_t(f.width) + size_t(px), (c & 1 ? fx : 1 - fx) * (c & 2 ? fy : 1 - fy));
  }
}

template <class F>
void each_ray(const Stage& s, const Factors& f, Layer& layer, F&& draw) {
  const int width = s.projection.width;
  parallel_for(
      size_t(s.projection.height), 8,
      [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y)
          for (int x = 0; x < width; ++x) {
            double u, v;
            if (warped(s, f, s.ray(x, int(y)), u, v)) draw(u, v, &layer.rgba[4 * (y * size_t(width) + size_t(x))]);
          }
      },
      &s.context);
}

void draw_composite(const WarpJob& job, const Factors& f, Layer& layer) {
  std::vector<Gathered> picture(size_t(f.width) * size_t(f.height));
  parallel_for(
      size_t(f.height), 16,
      [&](size_t begin, size_t end) {
        Rows rows(job, int(begin), int(end));
        rows.composite();
        std::copy(rows.row(int(begin)), rows.row(int(begin)) + (end - begin) * size_t(f.width),
                  picture.begin() + ptrdiff_t(begin * size_t(f.width)));
      },
      &job.stage.context);
  each_ray(job.stage, f, layer, [&](double u, double v, float* out) {
    around(f, u, v, [&](size_t p, float w) {
      const Gathered& g = picture[p];
      out[0] += w * g.r, out[1] += w * g.g, out[2] += w * g.b, out[3] += w * (1 - g.transmittance);
    });
  });
}

void draw_extremes(const WarpJob& job, const Factors& f, Layer& layer) {
  std::vector<float> best(size_t(f.width) * size_t(f.height), NAN);
  parallel_for(
      size_t(f.height), 16, [&](size_t begin, size_t end) { Rows(job, int(begin), int(end)).extremes(best); }, &job.stage.context);
  const Ink ink(job.stage.item);
  each_ray(job.stage, f, layer, [&](double u, double v, float* out) {
    float sum = 0, weights = 0;
    around(f, u, v, [&](size_t p, float w) {
      if (best[p] == best[p]) sum += w * best[p], weights += w;
    });
    if (weights > 0) ink.draw(double(sum / weights) + double(job.stage.volume.base), out);
  });
}

}  // namespace

Layer shear_warp(const LayerInput& input, const ShearWarpOptions& options) {
  const Stage stage = make_stage(input, {"shear_warp", {RayFunction::composite, RayFunction::maximum, RayFunction::minimum}});
  Layer layer;
  layer.rgba.assign(4 * stage.pixels(), 0.0f);
  if (stage.empty) return layer;
  const Factors factors = factorise(stage, options);
  WarpJob job = make_job(stage, factors);
  if (input.item.mode != RayFunction::composite) {
    draw_extremes(job, factors, layer);
    return layer;
  }
  const auto encoded = encoded_volume(stage, factors.axes.k);
  job.encoded = encoded.get();
  draw_composite(job, factors, layer);
  return layer;
}

Layer shear_warp(const LayerInput& input) { return shear_warp(input, ShearWarpOptions{}); }

}  // namespace sg::volume
