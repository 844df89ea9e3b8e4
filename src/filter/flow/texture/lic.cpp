// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/lic.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "filter/flow/texture/contrast.h"
#include "filter/flow/texture/convolution.h"
#include "filter/flow/texture/frame.h"
#include "filter/flow/texture/noise.h"

namespace sg {

using namespace texture;

void describe(Schema& s, LicParams& p) {
  s("field", p.field, "Vector field along which is averaged; default: the active vectors.");
  s("length", p.length, "How far the average reaches along the flow, each way.").unit("pixels").range(0, 4096);
  s("step", p.step, "Distance of the places that are averaged.").unit("pixels").range(0.05, 4);
  s("kernel", p.kernel, "Weights along the line: box, hanning (fading), ripple (waves that phase moves).")
      .choices({"box", "hanning", "ripple"});
  s("phase", p.phase, "Where the waves of kernel=ripple stand, in periods: frames of 0, 1/n, 2/n, ... move along the flow.");
  s("ripples", p.ripples, "Waves in the length of the kernel.").range(1, 100);
  s("method", p.method, "plain: a line for each pixel. fast: long lines that share their sums.").choices({"plain", "fast"});
  s("noise", p.noise, "What is averaged: white noise, or sparse dots (the one to look into volumes).").choices({"white", "sparse"});
  s("density", p.density, "Part of the pixels that are dots of sparse noise.").range(1e-6, 1);
  s("grain", p.grain, "Size of the grains of the noise.").unit("pixels").range(1, 256);
  s("seed", p.seed, "Another number, another noise.");
  s("image", p.image, "Field of the second input that is smeared along the flow in place of noise; default: its active scalar or colours.");
  s("contrast", p.contrast, "none: plain averages. stretch: a hundredth of the pixels black, a hundredth white. equalise: all greys alike.")
      .choices({"none", "stretch", "equalise"});
  s("passes", p.passes, "2: the texture is sharpened and averaged once more, for finer and clearer lines.").range(1, 4);
  s("still", p.still, "Speed up to which there is no texture.").unit("@field").at_least(0);
  s("resolution", p.resolution, "Pixels along the longest side; 0: those of the grid, coarse ones refined to 1024 (flat) or 128 (solid).")
      .range(0, 100000);
}

namespace {

// Directions of the frame; pixels without value or with a speed up to `still` get none.
std::vector<uint32_t> directions_of(const Frame& f, double still, const Context& context) {
  std::vector<uint32_t> codes(f.size());
  const size_t d = size_t(f.dimension);
  parallel_for(
      f.size(), 1 << 14,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const float* v = &f.velocity[i * d];
          if (still > 0) {
            double square = 0;
            for (size_t a = 0; a < d; ++a) square += double(v[a]) * f.pitch[a] * double(v[a]) * f.pitch[a];
            if (!(square > still * still)) continue;
          }
          codes[i] = encode_direction(f.dimension, v);
        }
      },
      &context);
  return codes;
}

struct Smeared {
  std::vector<float> values;  // of `components` each
  int components = 1;
};

// What is to be averaged when there is an image, one component after the other.
Smeared image_of(const Frame& f, const DatasetPtr& image, const LicParams& p, Context& context) {
  const Field* field = nullptr;
  if (!p.image.empty()) field = &image->fields().require(p.image.name, Association::point);
  if (!field) field = image->fields().active(1);
  if (!field) field = image->fields().with_role(Role::colors);
  if (!field) field = image->fields().active(0);
  if (!field || field->association != Association::point)
    fail_usage("the image has no point field", "lic", "image=NAME names one of the second input's");
  Smeared s;
  s.components = field->components();
  s.values = field_on_frame(f, image, *field, "lic", context);
  return s;
}

}  // namespace

DatasetPtr lic(const DatasetPtr& input, const DatasetPtr& image, const LicParams& p, Context& context) {
  const int steps = int(std::lround(p.length / p.step));
  if (!image && !p.image.empty()) fail_usage("image names a field of a second input, and there is none", "lic image");
  const Frame f = make_frame(input, p.field.name, p.resolution, "lic", context);
  if (!(f.largest_speed > 0)) context.warn(fmt::format("lic: '{}' is zero everywhere, there is no texture", f.velocity_name));
  const std::vector<uint32_t> codes = directions_of(f, p.still, context);
  DirectionGrid grid;
  grid.dimension = f.dimension;
  std::copy_n(f.n, 3, grid.n);
  grid.codes = codes.data();
  const Weights weights = kernel_weights(p.kernel, steps, p.phase, p.ripples);

  Smeared what;
  if (image) what = image_of(f, image, p, context);
  else what.values = grained_noise(f.n, uint64_t(p.seed), p.grain, p.noise == "sparse", p.density);
  const size_t n = f.size(), c = size_t(what.components);
  float* out = nullptr;
  Array result = Array::make<float>(n, what.components, &out);
  for (size_t k = 0; k < c; ++k) {
    std::vector<float> one, averaged;
    if (c > 1) {
      one.resize(n);
      for (size_t i = 0; i < n; ++i) one[i] = what.values[i * c + k];
    }
    const std::vector<float>* from = c > 1 ? &one : &what.values;
    for (int pass = 0; pass < p.passes; ++pass) {
      grid.noise = from->data();
      averaged =
          p.method == "fast" ? convolve_fast(grid, weights, float(p.step), context) : convolve_plain(grid, weights, float(p.step), context);
      context.progress(double(k * size_t(p.passes) + size_t(pass) + 1) / double(c * size_t(p.passes)), "averaging");
      if (pass + 1 == p.passes) break;
      one = sharpened(averaged, f.n, context);
      for (float& x : one) x = x == x ? x : 0.5f;
      from = &one;
    }
    if (c == 1) set_contrast(averaged, p.contrast, p.noise == "sparse" && !image, context);
    const size_t d = size_t(f.dimension);
    const float neutral = p.noise == "sparse" ? 0.0f : 0.5f;
    parallel_for(n, 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        float x = averaged[i];
        if (codes[i] == 0) {
          bool value = true;
          for (size_t a = 0; a < d; ++a) value = value && std::isfinite(f.velocity[i * d + a]);
          x = !value ? std::numeric_limits<float>::quiet_NaN() : image ? what.values[i * c + k] : neutral;
        }
        out[i * c + k] = x;
      }
    });
  }
  return frame_dataset(f, {{"lic", Association::point, std::move(result), "", Role::none}});
}

Data lic_of(const std::vector<Data>& inputs, const LicParams& p, Context& context) {
  const DatasetPtr image = inputs.size() > 1 ? single_dataset(inputs[1], "lic") : nullptr;
  return map_datasets(inputs[0], [&](const DatasetPtr& d) { return lic(d, image, p, context); });
}

}  // namespace sg
