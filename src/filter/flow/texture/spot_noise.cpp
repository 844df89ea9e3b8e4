// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/spot_noise.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "data/fields/known_looks.h"
#include "filter/flow/texture/frame.h"
#include "filter/flow/texture/pixel_flow.h"

namespace sg {

using namespace texture;

void describe(Schema& s, SpotNoiseParams& p) {
  s("field", p.field, "Vector field that shapes the spots; default: the active vectors.").takes(fields::vectors);
  s("radius", p.radius, "Radius of a spot where there is no flow.").unit("pixels").range(1, 200);
  s("stretch", p.stretch, "Elongation of a spot where the flow is fastest, in radii; it gets correspondingly thinner.").range(0, 20);
  s("density", p.density, "Mean number of spots that cover a pixel.").range(0.1, 50);
  s("bent", p.bent, "Bend spots along the streamlines; false: straight ellipses.");
  s("contrast", p.contrast, "Standard deviation of the texture.").positive();
  s("seed", p.seed, "Random seed of the spots.");
  s("resolution", p.resolution, "Pixels along the longest side; 0: those of the grid, refined to 1024 where coarser.").range(0, 100000);
}

namespace {

// A spot as a band along its streamline: sections at even distances, each with a place, a unit normal and a half width.
struct Spot {
  static constexpr int most = 33;
  int sections = 0;
  float x[most], y[most], nx[most], ny[most], along[most];  // along: -1 to 1, the ends
  float width = 1, value = 1;
  float lo[2], hi[2];
};

class Spots {
 public:
  Spots(const PixelFlow& flow, const SpotNoiseParams& p, double largest) : flow_(flow), p_(p), largest_(largest) {}

  // The spot of a number; false where the flow has no value.
  bool make(uint64_t i, Spot& s) const {
    const uint64_t seed = uint64_t(p_.seed) * 4;
    const double margin = p_.radius;  // spots from outside reach in
    double x[2] = {random_unit(seed, i) * (flow_.n(0) - 1 + 2 * margin) - margin,
                   random_unit(seed + 1, i) * (flow_.n(1) - 1 + 2 * margin) - margin};
    s.value = random_bits(seed + 2, i) & 1 ? 1.0f : -1.0f;
    double v[2];
    if (!flow_.at_nearest(x, v)) return false;
    const double speed = std::hypot(v[0], v[1]), longer = 1 + (largest_ > 0 ? p_.stretch * std::min(1.0, speed / largest_) : 0.0);
    const double half = p_.radius * longer, width = p_.radius / longer;
    s.width = float(std::max(width, 0.7));
    // Sections no longer than a third of the spot's own width or two pixels.
    const int each = std::clamp(int(std::ceil(half / std::max(2.0, width / 1.5))), 2, (Spot::most - 1) / 2);
    const double h = half / each;
    double first[2] = {1, 0};
    if (speed > 0) first[0] = v[0] / speed, first[1] = v[1] / speed;
    s.sections = 2 * each + 1;
    put(s, each, x, first, 0);
    for (const int way : {-1, 1}) {
      double at[2] = {x[0], x[1]}, d[2] = {first[0], first[1]};
      for (int k = 1; k <= each; ++k) {
        // A midpoint step along the direction; where it is lost the spot goes straight on.
        if (p_.bent && speed > 0) {
          const double middle[2] = {at[0] + way * h / 2 * d[0], at[1] + way * h / 2 * d[1]};
          direction(middle, d);
        }
        at[0] += way * h * d[0], at[1] += way * h * d[1];
        double e[2] = {d[0], d[1]};
        if (p_.bent && speed > 0) direction(at, e);
        put(s, each + way * k, at, e, double(way * k) / each);
        d[0] = e[0], d[1] = e[1];
      }
    }
    s.lo[0] = s.lo[1] = HUGE_VALF, s.hi[0] = s.hi[1] = -HUGE_VALF;
    for (int k = 0; k < s.sections; ++k) {
      s.lo[0] = std::min(s.lo[0], s.x[k] - s.width), s.hi[0] = std::max(s.hi[0], s.x[k] + s.width);
      s.lo[1] = std::min(s.lo[1], s.y[k] - s.width), s.hi[1] = std::max(s.hi[1], s.y[k] + s.width);
    }
    return true;
  }

 private:
  static void put(Spot& s, int k, const double* x, const double* d, double along) {
    s.x[k] = float(x[0]), s.y[k] = float(x[1]), s.nx[k] = float(-d[1]), s.ny[k] = float(d[0]), s.along[k] = float(along);
  }
  void direction(const double* x, double* d) const {
    double v[2];
    if (!flow_.at_nearest(x, v)) return;
    const double speed = std::hypot(v[0], v[1]);
    // Turns of more than a right angle are those at critical points: no band goes round such a corner.
    if (speed > 0 && v[0] * d[0] + v[1] * d[1] > 0) d[0] = v[0] / speed, d[1] = v[1] / speed;
  }
  const PixelFlow& flow_;
  const SpotNoiseParams& p_;
  double largest_;
};

// Adds the part of a spot that lies in [x0, x1) x [y0, y1) to sums of that tile. A pixel between two sections takes its place along and
// across from them; pixels where a band overlaps itself on the inside of a bend take both.
void draw(const Spot& s, int x0, int y0, int x1, int y1, float* sums) {
  const float w = s.width;
  for (int k = 0; k + 1 < s.sections; ++k) {
    // A quad: corners p +- w n. Its pixels: those on the inner side of both sections' normals and within w of the middle line.
    const float ax = s.x[k], ay = s.y[k], bx = s.x[k + 1], by = s.y[k + 1];
    const float lx = std::min(std::min(ax - w * s.nx[k], ax + w * s.nx[k]), std::min(bx - w * s.nx[k + 1], bx + w * s.nx[k + 1]));
    const float hx = std::max(std::max(ax - w * s.nx[k], ax + w * s.nx[k]), std::max(bx - w * s.nx[k + 1], bx + w * s.nx[k + 1]));
    const float ly = std::min(std::min(ay - w * s.ny[k], ay + w * s.ny[k]), std::min(by - w * s.ny[k + 1], by + w * s.ny[k + 1]));
    const float hy = std::max(std::max(ay - w * s.ny[k], ay + w * s.ny[k]), std::max(by - w * s.ny[k + 1], by + w * s.ny[k + 1]));
    const int i0 = std::max(x0, int(std::ceil(lx))), i1 = std::min(x1 - 1, int(std::floor(hx)));
    const int j0 = std::max(y0, int(std::ceil(ly))), j1 = std::min(y1 - 1, int(std::floor(hy)));
    // Directions of the two sections (normals turned back).
    const float tax = s.ny[k], tay = -s.nx[k], tbx = s.ny[k + 1], tby = -s.nx[k + 1];
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        const float px = float(i), py = float(j);
        const float da = (px - ax) * tax + (py - ay) * tay;  // beyond the first section?
        const float db = (bx - px) * tbx + (by - py) * tby;  // before the second?
        if (!(da >= 0 && db > 0)) continue;
        const float t = da / (da + db), u = 1 - t;
        const float mx = u * ax + t * bx, my = u * ay + t * by, nx = u * s.nx[k] + t * s.nx[k + 1], ny = u * s.ny[k] + t * s.ny[k + 1];
        const float across = ((px - mx) * nx + (py - my) * ny) / w, along = u * s.along[k] + t * s.along[k + 1];
        const float r2 = across * across + along * along;
        if (r2 >= 1) continue;
        sums[size_t(i - x0) + size_t(x1 - x0) * size_t(j - y0)] += s.value * (1 - r2) * (1 - r2);
      }
  }
}

struct Sums {
  double n = 0, sum = 0, squares = 0;
};

// Mean 0 and the requested standard deviation; NaN where the flow has no value.
void standardise(const PixelFlow& flow, double deviation, float* v, size_t n, const Context& context) {
  parallel_for(n, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (!flow.has_value(i)) v[i] = std::numeric_limits<float>::quiet_NaN();
  });
  const Sums s = parallel_reduce(
      n, 1 << 14, Sums(),
      [&](size_t begin, size_t end) {
        Sums r;
        for (size_t i = begin; i < end; ++i)
          if (v[i] == v[i]) r.n += 1, r.sum += double(v[i]), r.squares += double(v[i]) * double(v[i]);
        return r;
      },
      [](Sums a, Sums b) {
        return Sums{a.n + b.n, a.sum + b.sum, a.squares + b.squares};
      },
      &context);
  const double mean = s.n > 0 ? s.sum / s.n : 0, variance = s.n > 0 ? s.squares / s.n - mean * mean : 0;
  const double scale = variance > 0 ? deviation / std::sqrt(variance) : 0;
  parallel_for(n, 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) v[i] = float((double(v[i]) - mean) * scale);
  });
}

}  // namespace

DatasetPtr spot_noise(const DatasetPtr& input, const SpotNoiseParams& p, Context& context) {
  const Frame f = make_frame(input, p.field.name, p.resolution, "spot_noise", context);
  if (f.dimension == 3)
    fail_usage("spot noise is flat, but the data is solid", "spot_noise",
               "take a slice first (-f 'slice axis=z'), or use lic noise=sparse");
  const PixelFlow flow(f, context);
  const double area = 3.14159265358979 * p.radius * p.radius;
  const double count = std::ceil((f.n[0] + 2 * p.radius) * (f.n[1] + 2 * p.radius) * p.density / area);
  if (count > 4e6)
    fail_usage(fmt::format("{:.3g} spots are too many", count), "spot_noise",
               "use a larger radius, a lower density or a smaller resolution");
  std::vector<Spot> spots(static_cast<size_t>(count));
  const Spots maker(flow, p, flow.largest_speed());
  parallel_for(
      spots.size(), 256,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
          if (!maker.make(i, spots[i])) spots[i].sections = 0;
      },
      &context);

  // Which tiles a spot touches, in the order of the spots.
  constexpr int edge = 64;
  const int tx = (f.n[0] + edge - 1) / edge, ty = (f.n[1] + edge - 1) / edge;
  std::vector<std::vector<uint32_t>> of_tile(size_t(tx) * size_t(ty));
  for (size_t i = 0; i < spots.size(); ++i) {
    const Spot& s = spots[i];
    if (s.sections == 0) continue;
    auto tile = [&](float v, int most) { return std::clamp(int(std::floor(v / edge)), 0, most - 1); };
    for (int y = tile(s.lo[1], ty); y <= tile(s.hi[1], ty); ++y)
      for (int x = tile(s.lo[0], tx); x <= tile(s.hi[0], tx); ++x) of_tile[size_t(x + tx * y)].push_back(uint32_t(i));
  }
  float* out = nullptr;
  Array result = Array::make<float>(f.size(), 1, &out);
  parallel_for(
      of_tile.size(), 1,
      [&](size_t begin, size_t end) {
        std::vector<float> sums;
        for (size_t t = begin; t < end; ++t) {
          const int x0 = int(t % size_t(tx)) * edge, y0 = int(t / size_t(tx)) * edge;
          const int x1 = std::min(x0 + edge, f.n[0]), y1 = std::min(y0 + edge, f.n[1]);
          sums.assign(size_t(x1 - x0) * size_t(y1 - y0), 0.0f);
          for (const uint32_t i : of_tile[t]) draw(spots[i], x0, y0, x1, y1, sums.data());
          for (int j = y0; j < y1; ++j)
            std::copy_n(&sums[size_t(j - y0) * size_t(x1 - x0)], x1 - x0, out + size_t(j) * size_t(f.n[0]) + size_t(x0));
        }
      },
      &context);
  standardise(flow, p.contrast, out, f.size(), context);
  return frame_dataset(f, {{"spot noise", Association::point, std::move(result), "", Role::none, known_look("spot noise")}});
}

Data spot_noise_of(const Data& input, const SpotNoiseParams& p, Context& context) {
  return over_parts(input, "spot_noise", context, [&](const DatasetPtr& d) { return spot_noise(d, p, context); });
}

}  // namespace sg
