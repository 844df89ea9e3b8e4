// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/picture_lights.h"

#include <fmt/core.h>

#include <cmath>
#include <variant>

#include "base/error.h"
#include "base/file/file.h"
#include "data/dataset.h"
#include "data/memory/memory_budget.h"
#include "image/image.h"
#include "io/io.h"

namespace sg {

namespace {

// Points of a grid run from the lower left.
LinearPicture picture_of(const Data& data, const std::string& path) {
  const auto* dataset = std::get_if<DatasetPtr>(&data);
  const auto* grid = dataset ? (*dataset)->as<UniformGrid>() : nullptr;
  if (!grid || grid->dims[2] != 1 || grid->dims[0] < 1 || grid->dims[1] < 1)
    fail_data("is no picture of one layer", path, "give a picture of all directions, twice as wide as high");
  const Field* field = nullptr;
  for (const Field& f : (*dataset)->fields())
    if (f.association == Association::point && !field) field = &f;
  if (!field) fail_data("has no pixels", path, "give a picture of all directions");
  const double pixels = double(grid->dims[0]) * double(grid->dims[1]);
  if (pixels > 0x1p26) fail_data(fmt::format("has {} x {} pixels", grid->dims[0], grid->dims[1]), path, "make it smaller: 8192 x 4096 do");
  LinearPicture p;
  p.width = int(grid->dims[0]), p.height = int(grid->dims[1]);
  p.pixels.resize(grid->dims[0] * grid->dims[1]);
  const Array& a = field->array;
  const bool bytes = a.type() == ElementType::u8, words = a.type() == ElementType::u16;
  const auto linear = [&](double v) { return bytes || words ? srgb_decode(float(v / (bytes ? 255.0 : 65535.0))) : float(v); };
  for (size_t y = 0; y < grid->dims[1]; ++y)
    for (size_t x = 0; x < grid->dims[0]; ++x) {
      const size_t from = (grid->dims[1] - 1 - y) * grid->dims[0] + x;
      Vec3f& to = p.pixels[y * grid->dims[0] + x];
      for (int c = 0; c < 3; ++c) to[c] = linear(a.get(from, a.components() < 3 ? 0 : c));
    }
  return p;
}

/// Whether a volume of the scene has such light; `unstated`: what one has that says nothing.
template <class Is>
bool any_volume(const Scene& scene, VolumeLighting unstated, Is&& is) {
  return std::any_of(scene.items.begin(), scene.items.end(), [&](const Item& item) {
    const auto* v = std::get_if<VolumeItem>(&item);
    return v && is(v->scattering.light.value_or(unstated));
  });
}

}  // namespace

std::shared_ptr<const LinearPicture> read_environment(const std::string& path, Context& context) {
  const MappedFile file(path);
  LinearPicture p;
  if (file.text().starts_with("v/1\x01"))
    fail_usage("OpenEXR is not read", path, "write it as Radiance .hdr, e.g. with: oiiotool sky.exr -o sky.hdr");
  if (file.text().starts_with("#?")) p = decode_hdr({file.data(), file.size()}, path);
  else p = picture_of(read_data(path, {}, context), path);
  for (size_t i = 0; i < p.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (!(p.pixels[i][c] >= 0 && p.pixels[i][c] <= 1e30f))
        fail_data(
            fmt::format("pixel {},{} is {}; light is finite and not negative", i % size_t(p.width), i / size_t(p.width), p.pixels[i][c]),
            path, "pixels of light are between 0 and 1e30");
  constexpr double bytes_of_pixel = 64;  // with what directions are drawn by
  need_memory(double(p.pixels.size()) * bytes_of_pixel, "the picture of an environment", path, "make it smaller");
  return std::make_shared<const LinearPicture>(std::move(p));
}

std::string note_of_lost_light(const StatedPicture& s, const Scene& scene) {
  if (follows_light(scene, s)) return {};
  std::string lost;
  const auto add = [&](const char* what) { lost += (lost.empty() ? "" : ", ") + std::string(what); };
  bool shaped = false;
  for (const LightParams& l : s.lighting.lights) {
    const auto* far = std::get_if<DirectionalLightParams>(&l);
    shaped = shaped || !far || far->angle > 1;
  }
  if (shaped)
    add(any_volume(scene, VolumeLighting::emission, [](VolumeLighting l) { return l == VolumeLighting::map; })
            ? "lights are directions alone, without size, distance and colour, whose shadows are those of volumes with light=map"
            : "lights are directions alone, without size, distance, colour and shadows");
  if (s.lighting.environment) add("the environment is left out");
  if (s.camera.aperture > 0) add("the aperture is left out");
  if (const LightOptions paths; s.picture.light.noise != paths.noise || s.picture.light.paths != paths.paths)
    add("noise and paths are those of pictures by paths of light");
  return lost.empty() ? "" : fmt::format("{}: --integrator path shows what is stated", lost);
}

std::string note_of_lit_matter(const StatedPicture& s, const Scene& scene, const std::vector<Legend>& legends) {
  const VolumeLighting unstated = s.picture.integrator ? VolumeLighting::path : VolumeLighting::emission;
  if (legends.empty() || !any_volume(scene, unstated, [](VolumeLighting l) { return l != VolumeLighting::emission; })) return {};
  return "volumes in light: the legend's colours are those of the matter, the picture's are those of the light that it scatters";
}

}  // namespace sg
