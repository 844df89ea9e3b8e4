// SPDX-License-Identifier: Apache-2.0
#include "render/prepare/picture_set.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::raster {

namespace {

constexpr size_t points_per_chunk = 1 << 15;

Array placed(const Array& coordinates, const Array* second, const std::array<double, 6>& p) {
  const Array ys = second ? second->converted(ElementType::f64) : Array();
  const double* y_of = second ? reinterpret_cast<const double*>(ys.raw()) : nullptr;
  float* out = nullptr;
  Array uv = Array::make<float>(coordinates.count(), 2, &out);
  dispatch(coordinates, [&](auto v) {
    parallel_for(v.count, points_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const double x = double(v(i, 0)), y = y_of ? y_of[i] : v.components > 1 ? double(v(i, 1)) : 0;
        out[2 * i] = float(p[0] * x + p[1] * y + p[2]), out[2 * i + 1] = float(p[3] * x + p[4] * y + p[5]);
      }
    });
  });
  return uv;
}

std::optional<PlacedPicture> placed(const std::optional<SurfacePicture>& picture, const DatasetPtr& data) {
  if (!picture) return {};
  const auto field = [&](const std::string& name) -> const Field& {
    return with_context("picture", [&]() -> const Field& { return data->fields().require(name, Association::point); });
  };
  const Field& f = field(picture->coordinates);
  const Field* second = picture->second_coordinates.empty() ? nullptr : &field(picture->second_coordinates);
  const auto& p = picture->place;
  if (!second && f.components() < 2 && (p[1] != 0 || p[4] != 0))
    fail_usage(fmt::format("field '{}' has {} component, texture coordinates have 2", f.name, f.components()), "picture");
  const std::string key =
      fmt::format("picture/{}/{}/{},{},{},{},{},{}", f.name, picture->second_coordinates, p[0], p[1], p[2], p[3], p[4], p[5]);
  return PlacedPicture{picture->texture, picture->lookup,
                       *derived(data, key, [&] { return placed(f.array, second ? &second->array : nullptr, p); })};
}

std::optional<IsolineSet> placed(const std::optional<SurfaceIsolines>& lines, const DatasetPtr& data) {
  if (!lines || lines->values.empty()) return {};
  FieldColor by;
  by.field = lines->field, by.component = lines->component;
  const ColorSource values = color_source(data, by, {}, "isolines");
  IsolineSet set{values.values, {}, float(lines->width), linear_light(lines->color)};
  for (const double v : lines->values) set.levels.push_back(float(v - values.offset));
  return set;
}

Array directions(const DatasetPtr& data, const std::string& name) {
  const Field& f = with_context("specular_direction", [&]() -> const Field& { return data->fields().require(name, Association::point); });
  if (f.components() != 3) fail_usage(fmt::format("field '{}' has {} components, directions have 3", f.name, f.components()), "picture");
  return f.array.converted(ElementType::f32);
}

}  // namespace

std::shared_ptr<const PictureSet> place_pictures(const SurfacePictures& pictures, const DatasetPtr& data) {
  auto set = std::make_shared<PictureSet>();
  set->tint = pictures.tint, set->color = placed(pictures.color, data);
  set->emission = placed(pictures.emission, data);
  set->normal = placed(pictures.normal, data), set->normal_scale = pictures.normal_scale;
  set->occlusion = placed(pictures.occlusion, data), set->occlusion_strength = pictures.occlusion_strength;
  for (const SurfaceFactors& f : pictures.factors) set->factors.push_back({*placed(f.picture, data), f.channels});
  set->isolines = placed(pictures.isolines, data);
  if (!pictures.stretched_along.empty()) set->stretched_along = directions(data, pictures.stretched_along);
  set->alpha = pictures.alpha, set->cutoff = pictures.cutoff;
  return set;
}

}  // namespace sg::raster
