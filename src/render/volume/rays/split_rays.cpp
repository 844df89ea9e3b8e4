// SPDX-License-Identifier: Apache-2.0
#include "render/volume/rays/split_rays.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "data/bricked.h"
#include "render/composite/over.h"

namespace sg::volume {

namespace {

constexpr int most_splits = 6;
constexpr size_t part_pixels = size_t(1) << 22;  // of a finer picture at once
constexpr int tile = 16;                         // of Knobs::wanted

const VolumeItem* rays_through(const Item& item) {
  const auto* v = std::get_if<VolumeItem>(&item);
  return v && v->method == VolumeMethod::ray && v->data ? v : nullptr;
}

double cell_size(const Dataset& data) {
  double smallest = HUGE_VAL;
  if (const auto* g = data.as<UniformGrid>()) {
    for (int a = 0; a < 3; ++a)
      if (g->dims[size_t(a)] > 1) smallest = std::min(smallest, std::abs(g->spacing[a]));
  } else if (const auto* r = data.as<RectilinearGrid>()) {
    for (const Array* axis : {&r->x, &r->y, &r->z})
      for (size_t i = 1; i < axis->count(); ++i) {
        const double edge = std::abs(axis->get(i) - axis->get(i - 1));
        if (edge > 0) smallest = std::min(smallest, edge);
      }
  } else if (data.cell_count() > 0) {
    const Vec3 size = data.bounds().hi - data.bounds().lo;
    smallest = std::cbrt(size.x * size.y * size.z / double(data.cell_count()));
  }
  return smallest > 0 ? smallest : HUGE_VAL;
}

struct Window {
  int x0, y0, x1, y1;
  bool holds(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

// Of the pixels that volumes may cover.
Window window_of_volumes(const Scene& scene, const Projection& p) {
  double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
  for (const Item& item : scene.items) {
    const VolumeItem* v = rays_through(item);
    if (!v) continue;
    // A grid may be drawn half a cell beyond its points where it has one layer only.
    Box3 b = v->data->bounds();
    const double more = 0.5 * std::min(cell_size(*v->data), b.diagonal());
    b.lo = b.lo - Vec3{more, more, more}, b.hi = b.hi + Vec3{more, more, more};
    for (int c = 0; c < 8; ++c) {
      const Vec3 at = p.to_pixel({c & 1 ? b.hi.x : b.lo.x, c & 2 ? b.hi.y : b.lo.y, c & 4 ? b.hi.z : b.lo.z});
      if (!p.parallel && !(at.z > 0.5 * p.near_plane)) return {0, 0, p.width, p.height};
      for (int a = 0; a < 2; ++a) lo[a] = std::min(lo[a], at[a]), hi[a] = std::max(hi[a], at[a]);
    }
  }
  const auto from = [](double v, int size) { return int(std::clamp(std::floor(v) - 1, 0.0, double(size))); };
  const auto to = [](double v, int size) { return int(std::clamp(std::ceil(v) + 1, 0.0, double(size))); };
  return {from(lo[0], p.width), from(lo[1], p.height), to(hi[0], p.width), to(hi[1], p.height)};
}

/// Rows of a picture: the rays of each pixel as a tree, whose branches go on with the light that their stem has left.
class SplitRays {
 public:
  SplitRays(const std::vector<RaySlab>& slabs, const Scene& scene, const Projection& projection, const FragmentLists& fragments,
            Frame& frame, const Knobs& knobs, const CastPart& cast)
      : slabs_(slabs), scene_(scene), projection_(projection), fragments_(fragments), frame_(frame), knobs_(knobs), cast_(cast) {
    for (Item& item : scene_.items)
      if (auto* v = std::get_if<VolumeItem>(&item)) {
        v->sampling.antialias = VolumeAntialias::none, v->sampling.tolerance = v->sampling.within() / double(slabs.size());
        dark_ = std::min(dark_, float(0.2 * v->sampling.within()));
        if (!first_id_) first_id_ = uint32_t(&item - scene_.items.data()) + 1;
      }
  }

  void draw(const Window& window) {
    window_ = window, width_ = window.x1 - window.x0, height_ = window.y1 - window.y0, finer_ = 1;
    rays_.assign(size_t(width_) * size_t(height_), {});
    for (const RaySlab& slab : slabs_) split(slab.finer), draw(slab);
    join();
  }

 private:
  struct Ray {
    Gathered sum;
    float half = HUGE_VALF;  // depth where half of the light is gone
    uint32_t id = 0;
  };

  // Each ray becomes as many as make `finer` x `finer` a pixel.
  void split(int finer) {
    const size_t n = size_t(finer / finer_), width = size_t(width_ * finer_);
    std::vector<Ray> branches(rays_.size() * n * n);
    parallel_for(rays_.size() / width * n, 16, [&](size_t begin, size_t end) {
      for (size_t y = begin; y < end; ++y)
        for (size_t x = 0; x < width * n; ++x) branches[y * width * n + x] = rays_[y / n * width + x / n];
    });
    rays_ = std::move(branches), finer_ = finer;
  }

  void draw(const RaySlab& slab) {
    Projection p = window_of(projection_, window_.x0, window_.y0, width_, height_, finer_);
    p.near_plane = slab.from, p.far_plane = slab.to;
    Frame fine(p.width, p.height);
    const int across = (p.width + tile - 1) / tile, down = (p.height + tile - 1) / tile;
    std::vector<uint8_t> tiles(size_t(across) * size_t(down));
    // What is opaque or translucent is the same for all rays of a pixel.
    parallel_for(size_t(down), 1, [&](size_t begin, size_t end) {
      for (int y = int(begin) * tile; y < std::min(int(end) * tile, p.height); ++y)
        for (int x = 0; x < p.width; ++x) {
          const size_t from = pixel(x, y), to = size_t(y) * size_t(p.width) + size_t(x);
          fine.depth[to] = frame_.depth[from], fine.ids[to] = frame_.ids[from];
          if (within(slab, frame_.depth[from])) std::copy_n(&frame_.rgba[4 * from], 4, &fine.rgba[4 * to]);
          if (rays_[to].sum.transmittance >= dark_ && wanted(from)) tiles[size_t(y / tile) * size_t(across) + size_t(x / tile)] = 1;
        }
    });
    Knobs knobs = knobs_;
    knobs.wanted = &tiles;
    cast_(scene_, p, among(slab, p), fine, knobs);
    parallel_for(rays_.size(), 4096, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) go_on(rays_[i], slab, &fine.rgba[4 * i], fine.depth[i], fine.ids[i]);
    });
  }

  FragmentLists among(const RaySlab& slab, const Projection& p) const {
    FragmentLists out;
    if (fragments_.empty()) return out;
    out.start.reserve(rays_.size() + 1), out.start.push_back(0);
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x) {
        const size_t from = pixel(x, y);
        for (size_t i = fragments_.start[from]; i < fragments_.start[from + 1]; ++i)
          if (within(slab, fragments_.fragments[i].depth)) out.fragments.push_back(fragments_.fragments[i]);
        out.start.push_back(uint32_t(out.fragments.size()));
      }
    return out;
  }

  // `half` is where the slab alone has taken half; what came before it moves that place to the front, evenly in optical depth.
  void go_on(Ray& ray, const RaySlab& slab, const float rgba[4], float half, uint32_t id) const {
    const float before = ray.sum.transmittance;
    ray.sum.behind(rgba);
    if (!(before > 0.5f) || ray.sum.transmittance > 0.5f) return;
    const float wanted = std::log(2 * before), all = std::log(before / std::max(ray.sum.transmittance, 1e-6f));
    const auto from = float(slab.from), to = float(std::min(slab.to, 2 * slab.from));
    ray.half = half < HUGE_VALF ? from + (half - from) * std::min(1.0f, wanted / 0.6931472f) : from + (to - from) * wanted / all;
    ray.id = half < HUGE_VALF ? id : first_id_;
  }

  void join() {
    parallel_for(size_t(height_), 4, [&](size_t begin, size_t end) {
      for (int y = int(begin); y < int(end); ++y)
        for (int x = 0; x < width_; ++x) join(x, y);
    });
  }

  void join(int x, int y) {
    const size_t p = pixel(x * finer_, y * finer_);
    float sum[4] = {}, depth = 0;
    uint32_t id = 0;
    int picked = 0;
    for (int j = 0; j < finer_; ++j)
      for (int i = 0; i < finer_; ++i) {
        const Ray& r = rays_[size_t(y * finer_ + j) * size_t(width_ * finer_) + size_t(x * finer_ + i)];
        sum[0] += r.sum.r, sum[1] += r.sum.g, sum[2] += r.sum.b, sum[3] += 1 - r.sum.transmittance;
        if (r.half < HUGE_VALF) depth += r.half, id = r.id, ++picked;
      }
    const int all = finer_ * finer_;
    for (size_t k = 0; k < 4; ++k) frame_.rgba[4 * p + k] = sum[k] / float(all);
    if (2 * picked >= all && !(frame_.depth[p] < HUGE_VALF)) frame_.depth[p] = depth / float(picked), frame_.ids[p] = id;
  }

  // Of the picture, by a place in the finer one.
  size_t pixel(int x, int y) const { return size_t(window_.y0 + y / finer_) * size_t(frame_.width) + size_t(window_.x0 + x / finer_); }
  bool within(const RaySlab& slab, float depth) const {
    const bool first = &slab == &slabs_.front(), last = &slab == &slabs_.back();
    return (first || double(depth) >= slab.from) && (last || double(depth) < slab.to);
  }
  bool wanted(size_t p) const {
    if (!knobs_.wanted) return true;
    const size_t width = size_t(frame_.width), across = (width + tile - 1) / tile;
    return (*knobs_.wanted)[p / width / tile * across + p % width / tile];
  }

  const std::vector<RaySlab>& slabs_;
  Scene scene_;  // with the tolerances of a slab
  const Projection& projection_;
  const FragmentLists& fragments_;
  Frame& frame_;
  const Knobs& knobs_;
  const CastPart& cast_;
  float dark_ = 1;  // less light makes no difference
  uint32_t first_id_ = 0;
  // Of the rows at hand:
  Window window_{};
  int width_ = 0, height_ = 0, finer_ = 1;
  std::vector<Ray> rays_;
};

// What volumes do not reach has its fragments still to come.
void composite_outside(const Window& window, const FragmentLists& fragments, Frame& frame) {
  if (fragments.empty()) return;
  parallel_for(size_t(frame.height), 16, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y)
      for (int x = 0; x < frame.width; ++x) {
        if (window.holds(x, int(y))) continue;
        const size_t p = y * size_t(frame.width) + size_t(x);
        Gathered sum;
        for (size_t i = fragments.start[p]; i < fragments.start[p + 1]; ++i) sum.behind(fragments.fragments[i].rgba);
        float* out = &frame.rgba[4 * p];
        sum.behind(out);
        out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
      }
  });
}

}  // namespace

std::vector<RaySlab> ray_slabs(const Scene& scene, const Projection& p) {
  double cell = HUGE_VAL, nearest = HUGE_VAL, farthest = -HUGE_VAL;
  bool whole = p.parallel;
  for (const Item& item : scene.items) {
    const VolumeItem* v = rays_through(item);
    if (!v) continue;
    whole = whole || !info_of(v->mode).in_parts;
    if (v->sampling.antialias != VolumeAntialias::split) continue;
    if (v->data->bricks())
      fail_usage("antialias=split is for volumes in memory; this one is drawn from a file whose levels are already averages of cells",
                 "volume", "use antialias=none, or allow more --memory");
    cell = std::min(cell, cell_size(*v->data));
    const Box3 b = v->data->bounds();
    for (int c = 0; c < 8; ++c) {
      const double z = p.to_eye({c & 1 ? b.hi.x : b.lo.x, c & 2 ? b.hi.y : b.lo.y, c & 4 ? b.hi.z : b.lo.z}).z;
      nearest = std::min(nearest, z), farthest = std::max(farthest, z);
    }
  }
  if (!(cell < HUGE_VAL) || !(farthest > p.near_plane)) return {};
  const auto splits = [&](double z) {  // a hair less: pixels of just a cell
    const double pixels = (p.parallel ? 1 : std::max(z, p.near_plane)) / (p.scale * cell);
    return int(std::clamp(std::ceil(std::log2(pixels) - 1e-6), 0.0, double(most_splits)));
  };
  const int first = splits(nearest), last = splits(farthest);
  if (last == 0) return {};
  if (whole || first == last) return {{p.near_plane, p.far_plane, 1 << last}};
  std::vector<RaySlab> slabs;
  const auto end = [&](int k) { return std::clamp(std::ldexp(p.scale * cell, k), p.near_plane, p.far_plane); };
  for (int k = first; k <= last; ++k) {
    const RaySlab s{k == first ? p.near_plane : end(k - 1), k == last ? p.far_plane : end(k), 1 << k};
    if (s.to > s.from) slabs.push_back(s);
  }
  return slabs;
}

void draw_in_slabs(const std::vector<RaySlab>& slabs, const Scene& scene, const Projection& projection, const FragmentLists& fragments,
                   Frame& frame, const Knobs& knobs, const CastPart& cast) {
  const Window all = window_of_volumes(scene, projection);
  SplitRays rays(slabs, scene, projection, fragments, frame, knobs, cast);
  const size_t finest = size_t(slabs.back().finer), row = size_t(std::max(all.x1 - all.x0, 1)) * finest * finest;
  const int rows = int(std::clamp(part_pixels / row, size_t(1), size_t(frame.height)));
  if (all.x1 > all.x0)
    for (int y = all.y0; y < all.y1; y += rows) rays.draw({all.x0, y, all.x1, std::min(y + rows, all.y1)});
  composite_outside(all, fragments, frame);
}

}  // namespace sg::volume
