// SPDX-License-Identifier: Apache-2.0
// How wrong pictures of volumes are: ours and VTK's (bench/vtk_volume_picture.py) against the midpoint rule at a hundredth of a voxel in
// double precision, at every sixteenth pixel of every sixteenth row. Emission is the value itself, so no colour space is in the way. Lit
// scenes have the peers' headlight and material; VTK's light is another than ours where the field hardly changes, and it takes the viewer
// to look along the middle of the picture everywhere.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/error.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "bench.h"
#include "inputs.h"
#include "render/render.h"
#include "render/volume/rays/light_model.h"

namespace sg::bench {

namespace {

constexpr int pixels = 1024, every = 16;

struct ErrorScene {
  const char* name;
  std::vector<Vec2> opacity;
  bool shaded = false;
};
const std::vector<Vec2> bands{{-3, 0}, {-.9, 0}, {-.6, .15}, {-.3, 0}, {.2, 0}, {.5, .3}, {.8, 0}, {1.6, 0}, {2, .8}, {4, .8}};
const ErrorScene error_scenes[] = {
    {"bands", bands},
    {"lit", bands, true},
    {"fog", {{-3, .002}, {4, .01}}},
};

VolumeItem grey_item(const ErrorScene& scene, size_t n, double tolerance) {
  VolumeItem item;
  item.data = field_grid(n), item.field = "f";
  item.color.map.colors.clear();
  for (int i = 0; i <= 1024; ++i) {
    const float c = float(i) / 1024, s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
    item.color.map.colors.push_back({s, s, s});
  }
  item.color.lo = -3, item.color.hi = 4;
  item.opacity.points = scene.opacity;
  item.unit_distance = 2.0 / 255, item.shaded = scene.shaded;
  item.light.ambient = 0.2, item.light.diffuse = 0.7, item.light.specular = 0.3, item.light.power = 20;  // the peers'
  if (tolerance > 0) item.sampling.tolerance = tolerance;
  else item.sampling.step = 1.0 / double(n - 1);
  return item;
}

/// The trilinear field.
double value_at(const float* f, size_t n, Vec3 p) {
  size_t c[3];
  double g[3];
  for (int a = 0; a < 3; ++a) {
    const double u = std::clamp((p[a] + 1) * (double(n - 1) / 2), 0.0, double(n - 1));
    c[a] = std::min(size_t(u), n - 2), g[a] = u - double(c[a]);
  }
  double v = 0;
  for (size_t k = 0; k < 8; ++k)
    v += (k & 1 ? g[0] : 1 - g[0]) * (k & 2 ? g[1] : 1 - g[1]) * (k & 4 ? g[2] : 1 - g[2]) *
         double(f[c[0] + (k & 1) + n * (c[1] + (k >> 1 & 1) + n * (c[2] + (k >> 2)))]);
  return v;
}

/// Differences over a cell to both sides, in the outermost cells of the field that goes on as a parabola; per world length.
Vec3 gradient(const float* f, size_t n, Vec3 p) {
  const double h = 2 / double(n - 1);
  Vec3 g;
  for (int a = 0; a < 3; ++a) {
    const auto at = [&](double along) {
      Vec3 q = p;
      q[a] = along;
      return value_at(f, n, q);
    };
    const auto beyond = [&](double along) {
      const double border = along < 0 ? -1 : 1, inwards = along < 0 ? h : -h, out = (border - along) / inwards;
      if (!(out > 0)) return at(along);
      // Between the outermost layer and the one that the parabola through three has outside.
      const double outside = 3 * at(border) - 3 * at(border + inwards) + at(border + 2 * inwards);
      return at(border) + out * (outside - at(border));
    };
    g[a] = (beyond(p[a] + h) - beyond(p[a] - h)) / (2 * h);
  }
  return g;
}

/// Emission along the ray through a place of the picture.
double brute_force(const VolumeItem& item, const float* f, size_t n, const Projection& view, double x, double y) {
  const Projection::Ray ray = view.ray(x, y);
  double from = 0, to = 1e9;
  for (int a = 0; a < 3; ++a) {
    const double t0 = (-1 - ray.origin[a]) / ray.direction[a], t1 = (1 - ray.origin[a]) / ray.direction[a];
    from = std::max(from, std::min(t0, t1)), to = std::min(to, std::max(t0, t1));
  }
  if (!(from < to)) return 0;
  const double per_voxel = double(n - 1) / 2;
  const auto steps = size_t((to - from) * per_voxel * 100) + 1;
  const double h = (to - from) / double(steps);
  // As for every lit volume: a change by 0.002 of the range over a cell is a surface.
  const Range range = item.data->range(item.data->fields()[0]);
  const auto edge = float(1 / per_voxel), per_scale = float(1 / (0.002 * (range.hi - range.lo)));
  volume::LitRay lit;
  lit.direction = Vec3f(ray.direction);
  lit.material = material_of(item.light);
  lit.lights.push_back(seen_along({view.forward * -1.0, 1}, ray.direction));
  double sum = 0, pass = 1;
  for (size_t i = 0; i < steps && pass > 1e-7; ++i) {
    const Vec3 p = ray.origin + ray.direction * (from + (double(i) + 0.5) * h);
    const double v = value_at(f, n, p);
    const double opacity = item.opacity.at(v);
    if (!(opacity > 0)) continue;
    const double alpha = 1 - std::exp(std::log1p(-opacity) * h / item.unit_distance);
    double emission = std::clamp((v + 3) / 7, 0.0, 1.0);
    if (item.shaded) {
      const volume::Lit l = volume::light_at(lit, Vec3f(gradient(f, n, p)), edge, per_scale);
      emission = emission * double(l.diffuse) + double(l.specular);
    }
    sum += pass * alpha * emission, pass *= 1 - alpha;
  }
  return sum;
}

std::vector<double> reference(const VolumeItem& item, size_t n, double shift_x, double shift_y) {
  const float* f = item.data->fields()[0].array.view<float>().data;
  const Projection view = make_projection(peers_camera(0), pixels, pixels);
  constexpr size_t across = pixels / every;
  std::vector<double> want(across * across);
  parallel_for(want.size(), 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      want[i] = brute_force(item, f, n, view, double(i % across * every) + shift_x, double(i / across * every) + shift_y);
  });
  return want;
}

struct Error {
  double largest = 0, rms = 0;
};
template <class Picture>
Error compare(const std::vector<double>& want, const Picture& picture) {
  constexpr size_t across = pixels / every;
  Error e;
  for (size_t i = 0; i < want.size(); ++i) {
    const double off = std::abs(picture(i % across * every, i / across * every) - want[i]);
    e.largest = std::max(e.largest, off), e.rms += off * off / double(want.size());
  }
  e.rms = std::sqrt(e.rms);
  return e;
}

double told(bool& before, const char* whose, const ErrorScene& scene, size_t n, Error e) {
  if (!std::exchange(before, true))
    std::fprintf(stderr, "%s, %s %zu^3: largest error %.5f, root mean square %.6f\n", whose, scene.name, n, e.largest, e.rms);
  return 1e6 * e.largest;
}

Task ours(const ErrorScene& scene, size_t n, double tolerance) {
  const char* label = tolerance > 0 ? "tolerance 1/512" : "half-voxel steps";
  return {"volume_error", fmt::format("{} {}^3", scene.name, n), fmt::format("sightglass:raycast({})", label), "millionths", [=, &scene] {
            Scene s;
            s.transparent = true;
            s.lights = {{{0, 0, 1}, true, 1}};  // the peers' headlight
            s.items.emplace_back(grey_item(scene, n, tolerance));
            const auto shared = std::make_shared<Scene>(std::move(s));
            const std::vector<double> want = reference(std::get<VolumeItem>(shared->items[0]), n, 0.5, 0.5);
            return [=, &scene, before = false]() mutable {
              Context context;
              RenderOptions o;
              o.width = o.height = pixels, o.samples = 1;
              const Frame f = render(*shared, peers_camera(0), o, context);
              return told(before, label, scene, n, compare(want, [&](size_t x, size_t y) { return double(f.rgba[4 * (y * pixels + x)]); }));
            };
          }};
}

/// Of the picture that the script left in the data folder. The rays that fit it best count: through corners or middles of pixels.
Task theirs(const ErrorScene& scene, size_t n, const std::string& file) {
  return {"volume_error", fmt::format("{} {}^3", scene.name, n), "vtkFixedPointVolumeRayCastMapper(half-voxel steps)", "millionths",
          [=, &scene] {
            const auto picture = std::make_shared<MappedFile>(file);
            if (picture->size() != size_t(pixels) * pixels) fail_data("not a picture of 1024 x 1024 bytes", file);
            const VolumeItem item = grey_item(scene, n, 0);
            std::vector<std::vector<double>> want;
            for (const double x : {0.0, 0.5, 1.0})
              for (const double y : {0.0, 0.5, 1.0}) want.push_back(reference(item, n, x, y));
            return [=, &scene, before = false]() mutable {
              Error best{2, 2};
              for (const auto& w : want)
                if (const Error e = compare(w, [&](size_t x, size_t y) { return double(uint8_t(picture->text()[y * pixels + x])) / 255; });
                    e.rms < best.rms)
                  best = e;
              return told(before, "VTK", scene, n, best);
            };
          }};
}

}  // namespace

void add_volume_error_tasks(std::vector<Task>& t, const std::string& folder) {
  for (const ErrorScene& scene : error_scenes)
    for (const size_t n : {256, 512}) {
      t.push_back(ours(scene, n, 0));
      t.push_back(ours(scene, n, 1.0 / 512));
      const std::string file = fmt::format("{}/vtk_{}_{}.raw", folder, scene.name, n);
      if (std::FILE* there = std::fopen(file.c_str(), "rb")) std::fclose(there), t.push_back(theirs(scene, n, file));
    }
}

}  // namespace sg::bench
