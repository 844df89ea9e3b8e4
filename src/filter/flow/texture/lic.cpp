// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/lic.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "filter/flow/flow_field.h"
#include "filter/flow/seeds/noise_speed.h"
#include "filter/flow/texture/frame.h"
#include "filter/flow/texture/noise.h"

namespace sg {

using namespace texture;

void describe(Schema& s, LicParams& p) {
  s("field", p.field, "Vector field to average along; default: the active vectors.").takes(fields::vectors);
  s("length", p.length, "How far the average extends along the flow in each direction; default: 20, for sparse dots in solid data 30.")
      .unit("pixels")
      .range(0, 4096);
  s("step", p.step, "Distance between the samples that are averaged.").unit("pixels").range(0.05, 4);
  s("kernel", p.kernel, "Weights along the line: box (uniform), hanning (fading out), ripple (waves moved by phase).");
  s("phase", p.phase, "Phase of the waves of kernel=ripple, in periods: frames with 0, 1/n, 2/n, ... move along the flow.");
  s("ripples", p.ripples, "Number of waves in the length of the kernel.").range(1, 100);
  s("method", p.method, "plain: one line per pixel. fast: long lines whose sums are shared.");
  s("noise", p.noise,
    "What is averaged: white noise, or sparse dots, which become separate strands so that one can see into a volume; auto: white in flat "
    "data, sparse in solid data.");
  s("density", p.density,
    "Fraction of the noise's points that are dots when it is sparse; 0: 0.02 in flat data, 0.0015 in solid data, more where little of it "
    "flows.")
      .range(0, 1);
  s("grain", p.grain, "Grain size of the noise; 0: 1, for sparse dots in solid data 2.").unit("pixels").range(0, 256);
  s("seed", p.seed, "Random seed of the noise.");
  s("image", p.image, "Field of the second input to smear along the flow instead of noise; default: its active scalar or colours.")
      .takes(fields::on_points);
  s("contrast", p.contrast,
    "none: plain averages. stretch: a hundredth of the pixels black, a hundredth white. equalise: all greys equally frequent.");
  s("passes", p.passes, "2: sharpen the texture and average it once more, for finer and clearer lines.").range(1, 4);
  s("still", p.still,
    "Speed up to which there is no texture. Default: 0; where most of a grid is noise (scans of vessels), 2 % of the largest speed.")
      .unit("@field")
      .at_least(0);
  s("resolution", p.resolution, "Pixels along the longest side; 0: those of the grid, refined to 1024 (flat) or 128 (solid) where coarser.")
      .range(0, 100000);
}

namespace {

// Directions of the frame; pixels without value or with a speed up to `still` get none.
Plane<uint32_t> directions_of(const Frame& f, double still, const Context& context) {
  Plane<uint32_t> codes(f.size());
  const size_t d = size_t(f.dimension), block = 1024;
  parallel_for(
      f.size(), 16 * block,
      [&](size_t begin, size_t end) {
        std::vector<float> v(block * d);
        for (size_t first = begin; first < end; first += block) {
          const size_t n = std::min(block, end - first);
          velocity_of(f, first, first + n, v.data());
          encode_directions(f.dimension, v.data(), n, &codes[first]);
          if (still <= 0) continue;
          for (size_t i = 0; i < n; ++i) {
            double square = 0;
            for (size_t a = 0; a < d; ++a) square += double(v[i * d + a]) * f.pitch[a] * double(v[i * d + a]) * f.pitch[a];
            if (!(square > still * still)) codes[first + i] = 0;
          }
        }
      },
      &context);
  return codes;
}

// Part of the pixels that have a direction: a single vessel should have as many strands as a full box.
double flowing_share(const Plane<uint32_t>& codes) {
  const auto still = size_t(std::count(codes.begin(), codes.end(), 0u));
  return std::max(1e-3, double(codes.size() - still) / double(std::max<size_t>(codes.size(), 1)));
}

// The colour of strands.
Field speed_of(const Frame& f) {
  const Field& v = f.fields.require(f.velocity_name, Association::point);
  float* speed = nullptr;
  Field out{"speed", Association::point, Array::make<float>(f.size(), 1, &speed), v.unit, Role::none, known_look("speed")};
  dispatch(v.array, [&](auto view) {
    parallel_for(f.size(), 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        double e = 0;
        for (int c = 0; c < view.components; ++c) e += double(view(i, c)) * double(view(i, c));
        speed[i] = float(std::sqrt(e));
      }
    });
  });
  return out;
}

bool has_value(const Frame& f, size_t pixel) {
  float v[3] = {};
  velocity_of(f, pixel, pixel + 1, v);
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

// What is to be averaged when there is an image.
Array image_of(const Frame& f, const DatasetPtr& image, const LicParams& p) {
  const Field* field = nullptr;
  if (!p.image.empty()) field = &image->fields().require(p.image.name, Association::point);
  if (!field) field = image->fields().active(1);
  if (!field) field = image->fields().with_role(Role::colors);
  if (!field) field = image->fields().active(0);
  if (!field || field->association != Association::point)
    fail_usage("the image has no point field", "lic", "name one of the second input's fields with image=NAME");
  return field_on_frame(f, image, *field, "lic");
}

// One component: convolved as often as requested, into `out`.
void average(const DirectionGrid& directions, const float* what, const LicParams& p, double reach, float* out, const Context& context) {
  DirectionGrid grid = directions;
  const Weights weights = kernel_weights(p.kernel, int(std::lround(reach / p.step)), p.phase, p.ripples);
  Plane<float> between;
  grid.noise = what;
  for (int pass = 0; pass < p.passes; ++pass) {
    if (pass > 0) {
      between = sharpened({out, grid.size()}, grid.n, context);
      for (float& x : between) x = x == x ? x : 0.5f;
      grid.noise = between.data();
    }
    (p.method == LicMethod::fast ? convolve_fast : convolve_plain)(grid, weights, float(p.step), out, context);
    context.progress(double(pass + 1) / double(p.passes), "averaging along the flow");
  }
}

}  // namespace

DatasetPtr lic(const DatasetPtr& input, const DatasetPtr& image, const LicParams& p, Context& context) {
  if (!image && !p.image.empty()) fail_usage("image names a field of a second input, but there is no second input", "lic image");
  const Frame f = make_frame(input, p.field.name, p.resolution, "lic", context);
  const double still = p.still.value_or(noise_speed(*input, flow_field_of(*input, p.field.name, "lic")));
  if (!p.still && still > 0) context.info(fmt::format("lic: most of '{}' is noise: still={:.3g}", f.velocity_name, still));
  const Plane<uint32_t> codes = directions_of(f, still, context);
  DirectionGrid grid;
  grid.dimension = f.dimension;
  std::copy_n(f.n, 3, grid.n);
  grid.codes = codes.data();

  const bool solid = f.dimension == 3,
             sparse = !image && (p.noise.value_or(solid ? LicNoise::sparse : LicNoise::white) == LicNoise::sparse);
  const double reach = p.length.value_or(sparse && solid ? 30 : 20);
  const size_t n = f.size();
  Array what;
  Plane<float> noise;
  if (image) what = image_of(f, image, p);
  else {
    noise = grained_noise(f.n, uint64_t(p.seed),
                          p.grain > 0       ? p.grain
                          : sparse && solid ? 2
                                            : 1,
                          sparse,
                          p.density > 0 ? p.density
                          : solid       ? std::min(0.0015 / flowing_share(codes), 0.02)
                                        : 0.02);
  }
  const int components = image ? what.components() : 1;
  const float* from = image ? what.view<float>().data : noise.data();
  float* out = nullptr;
  Array result = Array::make<float>(n, components, &out);
  size_t without = 0;
  for (int k = 0; k < components; ++k) {
    Plane<float> one, averaged;
    const float* source = from;
    float* target = out;
    if (components > 1) {
      one.resize(n), averaged.resize(n);
      for (size_t i = 0; i < n; ++i) one[i] = from[i * size_t(components) + size_t(k)];
      source = one.data(), target = averaged.data();
    }
    average(grid, source, p, reach, target, context);
    if (components == 1 && !image) set_contrast({target, n}, p.contrast, sparse, context);
    // Where nothing flows: the image as it is, or the grey of no texture.
    without = parallel_reduce(
        n, 1 << 15, size_t(0),
        [&](size_t begin, size_t end) {
          size_t count = 0;
          for (size_t i = begin; i < end; ++i) {
            if (codes[i] != 0) continue;
            ++count;
            target[i] = !has_value(f, i) ? std::numeric_limits<float>::quiet_NaN() : image ? source[i] : sparse ? 0.0f : 0.5f;
          }
          return count;
        },
        [](size_t a, size_t b) { return a + b; }, &context);
    if (components > 1)
      for (size_t i = 0; i < n; ++i) out[i * size_t(components) + size_t(k)] = averaged[i];
  }
  if (without == n) context.warn(fmt::format("lic: '{}' does not flow anywhere, so there is no texture", f.velocity_name));
  std::vector<Field> made{{"lic", Association::point, std::move(result), "", Role::none, known_look("lic")}};
  if (solid && !f.fields.find("speed")) made.push_back(speed_of(f));
  return frame_dataset(f, std::move(made));
}

Data lic_of(const std::vector<Data>& inputs, const LicParams& p, Context& context) {
  const DatasetPtr image = inputs.size() > 1 ? single_dataset(inputs[1], "lic") : nullptr;
  return over_parts(inputs[0], "lic", context, [&](const DatasetPtr& d) { return lic(d, image, p, context); });
}

}  // namespace sg
