// SPDX-License-Identifier: Apache-2.0
// Fourier volume rendering (Dunne, Napel, Rutt 1990; Malzbender 1993; Totsuka, Levoy 1993): the transform of a parallel projection is
// the slice through the middle of the volume's transform that lies across the rays. What is projected is the trilinear field: its
// transform is that of the samples, repeated without end, times that of the tent.
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "render/volume/methods/fft.h"
#include "render/volume/methods/spectrum.h"

namespace sg::volume {

namespace {

/// The picture of line integrals on a grid of its own, as a plane that repeats.
struct XRay {
  size_t size = 0;   // points along either side
  double pitch = 1;  // world length between them
  Vec3 centre;       // world place that point 0 is the picture of
  std::vector<float> values;

  /// Catmull and Rom's cubic between the points; x to the right, y up, from the centre.
  double at(double x, double y) const;
};

double XRay::at(double x, double y) const {
  const auto weights = [](double f, double w[4]) {
    w[0] = f * (-0.5 + f * (1 - 0.5 * f)), w[1] = 1 + f * f * (-2.5 + 1.5 * f);
    w[2] = f * (0.5 + f * (2 - 1.5 * f)), w[3] = f * f * (-0.5 + 0.5 * f);
  };
  const double u = x / pitch, v = y / pitch, iu = std::floor(u), iv = std::floor(v);
  double wu[4], wv[4], sum = 0;
  weights(u - iu, wu), weights(v - iv, wv);
  const auto wrapped = [&](double i) {
    const int64_t n = int64_t(size), r = int64_t(i) % n;
    return size_t(r < 0 ? r + n : r);
  };
  for (int j = 0; j < 4; ++j) {
    const float* row = &values[size * wrapped(iv - 1 + j)];
    double line = 0;
    for (int i = 0; i < 4; ++i) line += wu[i] * double(row[wrapped(iu - 1 + i)]);
    sum += wv[j] * line;
  }
  return sum;
}

/// sin(pi k) / (pi k)
double sinc(double k) {
  if (std::abs(k) < 1e-4) return 1 - 1.6449340668482264 * k * k;
  double c, s;
  cos_sin_turns(0.5 * k, c, s);
  return s / (3.14159265358979323846 * k);
}

/// How the brightness of the field fades along the view: near + per_depth * (depth - that of the centre).
struct Fade {
  double middle = 1, per_depth = 0;
};

Fade fade_of(const Stage& s, Vec3 centre) {
  const double cue = std::clamp(s.item.light.depth_cue, 0.0, 1.0);
  if (!(cue > 0)) return {};
  double nearest = HUGE_VAL, farthest = -HUGE_VAL;
  for (int c = 0; c < 8; ++c) {
    const Vec3 lo = s.volume.lo, hi = s.volume.hi;
    const double z = dot(s.world({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z}) - centre, s.projection.forward);
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  const double per = cue / (farthest - nearest);
  return {1 + nearest * per, -per};
}

/// The slice of the spectrum across the view: points (a, b) turns per world length along right and up, a in rows.
class Slice {
 public:
  Slice(const Stage& s, const Spectrum& spectrum, Fade fade) : spectrum_(spectrum), fade_(fade) {
    const Projection& p = s.projection;
    for (int a = 0; a < 3; ++a) {
      const Vec3 edge = s.to_world.column(a);
      right_[a] = dot(edge, p.right), up_[a] = dot(edge, p.up), forward_[a] = dot(edge, p.forward);
    }
    volume_ = std::abs(determinant(s.to_world));
  }

  Spectrum::Value at(double a, double b) const {
    const Vec3 k = right_ * a + up_ * b;
    const double tent = sinc(k.x) * sinc(k.y) * sinc(k.z), scale = volume_ * tent * tent;
    if (fade_.per_depth == 0) {
      const Spectrum::Value v = spectrum_.at(k);
      return {float(scale * double(v.re)), float(scale * double(v.im))};
    }
    // The transform of depth times the field is i/2pi times the derivative of its transform along the view.
    const auto v = spectrum_.with_slopes(k);
    double re = 0, im = 0;
    for (int axis = 0; axis < 3; ++axis)
      re += forward_[axis] * double(v[size_t(axis) + 1].re), im += forward_[axis] * double(v[size_t(axis) + 1].im);
    const double per = fade_.per_depth / 6.283185307179586;
    return {float(scale * (fade_.middle * double(v[0].re) - per * im)), float(scale * (fade_.middle * double(v[0].im) + per * re))};
  }

 private:
  const Spectrum& spectrum_;
  Fade fade_;
  Vec3 right_, up_, forward_;
  double volume_ = 1;
};

/// Rows of a square array, then (after changing rows and columns about) the others.
void inverse_2d(std::vector<float>& re, std::vector<float>& im, size_t n, const Context& context) {
  const Fft<float> fft(n);
  for (int pass = 0; pass < 2; ++pass) {
    parallel_for(
        n, 16,
        [&](size_t begin, size_t end) {
          std::vector<float> a(n), b(n);
          for (size_t row = begin; row < end; ++row) fft.transform(&im[n * row], &re[n * row], a.data(), b.data());
        },
        &context);
    constexpr size_t block = 32;
    parallel_for((n + block - 1) / block, 1, [&](size_t begin, size_t end) {
      for (size_t y0 = begin * block; y0 < std::min(n, end * block); y0 += block)
        for (size_t x0 = y0; x0 < n; x0 += block)
          for (size_t y = y0; y < std::min(n, y0 + block); ++y)
            for (size_t x = std::max(x0, y + 1); x < std::min(n, x0 + block); ++x)
              std::swap(re[n * y + x], re[n * x + y]), std::swap(im[n * y + x], im[n * x + y]);
    });
  }
}

/// Two points per smallest edge of a voxel; wide enough for the volume from any side.
XRay project(const Stage& s, const Spectrum& spectrum, bool fades) {
  XRay x;
  x.centre = s.world(spectrum.centre());
  double edge = HUGE_VAL, reach = 0;
  for (int a = 0; a < 3; ++a) edge = std::min(edge, length(s.to_world.column(a)));
  for (int c = 0; c < 8; ++c) {
    const Vec3 lo = s.volume.lo, hi = s.volume.hi;
    const Vec3 d = s.world({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z}) - x.centre;
    reach = std::max({reach, std::abs(dot(d, s.projection.right)), std::abs(dot(d, s.projection.up))});
  }
  double across = 0;  // of a voxel: the tent reaches one beyond the box
  for (int a = 0; a < 3; ++a) across += length(s.to_world.column(a));
  x.pitch = 0.5 * edge;
  const double wanted = 2 * (reach + across) / x.pitch;
  if (wanted > 8192) {
    fail_usage(fmt::format("method=fourier would need a slice of {:.0f} points squared", wanted), "volume",
               "use method=ray, which needs none");
  }
  x.size = fft_size(size_t(wanted) + 1);
  const size_t n = x.size;
  std::vector<float> re(n * n), im(n * n);
  const double per = 1 / (double(n) * x.pitch);
  const Slice slice(s, spectrum, fades ? fade_of(s, x.centre) : Fade{});
  // The picture is real: the other half of the slice mirrors this one.
  parallel_for(
      n / 2 + 1, 4,
      [&](size_t begin, size_t end) {
        for (size_t j = begin; j < end; ++j)
          for (size_t i = 0; i < n; ++i) {
            if ((j == 0 || j == n / 2) && i > n / 2) continue;
            // The highest frequency stands for itself and its opposite.
            if (i == n / 2 || j == n / 2) continue;
            const auto turns = [&](size_t m) { return (m <= n / 2 ? double(m) : double(m) - double(n)) * per; };
            const Spectrum::Value v = slice.at(turns(i), turns(j));
            re[n * j + i] = v.re, im[n * j + i] = v.im;
            const size_t oi = (n - i) % n, oj = (n - j) % n;
            if (oi != i || oj != j) re[n * oj + oi] = v.re, im[n * oj + oi] = -v.im;
          }
      },
      &s.context);
  inverse_2d(re, im, n, s.context);
  const float scale = float(per * per);
  for (float& v : re) v *= scale;
  x.values = std::move(re);
  return x;
}

}  // namespace

Layer fourier(const LayerInput& input) {
  const Stage stage = make_stage(input, {"fourier", {RayFunction::sum, RayFunction::average}, false, false, false, true});
  Layer layer;
  layer.rgba.assign(4 * stage.pixels(), 0.0f);
  if (stage.empty) return layer;
  const XRay xray = project(stage, *Spectrum::of(stage), true);
  // Outlines are as soft as the samples lie apart: an average over what the ray crosses of the box would be that of nothing there. So the
  // samples are counted as they are summed.
  XRay count;
  const bool mean = input.item.mode == RayFunction::average;
  if (mean) count = project(stage, *Spectrum::of(stage, Spectrum::Of::ones), false);
  const double least = stage.volume.samples->lo + double(stage.volume.base), most = stage.volume.samples->hi + double(stage.volume.base);
  const Projection& p = input.projection;
  const Ink ink(input.item);
  const double centre_x = dot(xray.centre - p.eye, p.right), centre_y = dot(xray.centre - p.eye, p.up);
  parallel_for(
      size_t(p.height), 8,
      [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y)
          for (int x = 0; x < p.width; ++x) {
            const size_t pixel = y * size_t(p.width) + size_t(x);
            // A line integral cannot be cut: it is drawn where nothing lies in the volume or before it.
            const PixelRay cut = stage.ray(x, int(y));
            const Projection::Ray ray = p.ray(x + 0.5, double(y) + 0.5);
            const Course whole = course(stage.volume, ray.origin, ray.direction, -HUGE_VAL, HUGE_VAL);
            const double chord = whole.leave - whole.enter;
            if (!(chord > 0) || cut.enter > whole.enter || cut.leave < whole.leave) continue;
            const double at_x = (x + 0.5 - p.middle_x()) / p.scale - centre_x, at_y = (p.middle_y() - double(y) - 0.5) / p.scale - centre_y;
            double value = xray.at(at_x, at_y);
            if (mean) {
              const double crossed = count.at(at_x, at_y);
              if (!(crossed > 0) || !(least <= most)) continue;
              // No mean lies beyond the samples; a depth cue makes less of them.
              value = std::clamp(value / crossed, input.item.light.depth_cue > 0 ? std::min(least, 0.0) : least,
                                 input.item.light.depth_cue > 0 ? std::max(most, 0.0) : most);
            }
            ink.draw(value, &layer.rgba[4 * pixel]);
          }
      },
      &input.context);
  return layer;
}

}  // namespace sg::volume
