// SPDX-License-Identifier: Apache-2.0
#include "scene/show/material_words.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/schema/color_params.h"

namespace sg {

bool MaterialShow::any() const {
  return material || base_metalness || specular_roughness || specular_ior || transmission_weight || transmission_depth || coat_weight ||
         transmission_color || emission || thin_walled || dielectric_priority;
}

SurfaceMaterial MaterialShow::made(double size) const {
  SurfaceMaterial m = material ? preset_material(*material, size) : data_material();
  const auto take = [](auto& to, const auto& from) {
    if (from) to = *from;
  };
  take(m.base_metalness, base_metalness), take(m.specular_roughness, specular_roughness), take(m.specular_ior, specular_ior);
  take(m.transmission_weight, transmission_weight), take(m.transmission_depth, transmission_depth), take(m.coat_weight, coat_weight);
  take(m.transmission_color, transmission_color), take(m.emission, emission);
  take(m.thin_walled, thin_walled), take(m.dielectric_priority, dielectric_priority);
  return m;
}

void describe(Schema& s, MaterialShow& p) {
  s("material", p.material,
    "What the surface is made of, where the picture has an integrator; its own colour takes the place of those of a field that is not "
    "stated. sightglass lookdev shows all. Default: plastic of the data's colours.");
  s("base_metalness", p.base_metalness, "Share of metal, instead of the material's.").range(0, 1);
  s("specular_roughness", p.specular_roughness, "From a mirror (0) to a highlight without an edge (1), instead of the material's.")
      .range(0, 1);
  s("specular_ior", p.specular_ior, "Index of refraction, instead of the material's.").range(1, 10);
  s("transmission_weight", p.transmission_weight, "Share of the body that is clear, instead of the material's.").range(0, 1);
  s("transmission_color", p.transmission_color, "Colour of light (red, green, blue) that has passed transmission_depth of the clear body.")
      .unit(linear_color_unit)
      .range(0, 1);
  s("transmission_depth", p.transmission_depth, "Length after which light has that colour; 0 = at once, at the boundary.").at_least(0);
  s("coat_weight", p.coat_weight, "Share of the surface that has a clear coat, instead of the material's.").range(0, 1);
  s("emission", p.emission, "Light that the surface gives off by itself: radiance of red, green and blue.")
      .unit(linear_color_unit)
      .at_least(0);
  s("thin_walled", p.thin_walled, "The surface is a sheet, without a body behind it.");
  s("dielectric_priority", p.dielectric_priority,
    "Of clear bodies that touch or overlap: the one of the highest is there, and refracts against the others. 0 = refracts against air.")
      .range(0, 1000);
}

void describe(Schema& s, MaterialFields& p) {
  s("specular_roughness_by", p.specular_roughness_by,
    "Point field of 0 to 1 that multiplies the roughness, where the picture has an integrator.")
      .takes(fields::point_scalars);
  s("base_metalness_by", p.base_metalness_by, "Point field of 0 to 1 that multiplies the share of metal.").takes(fields::point_scalars);
  s("emission_by", p.emission_by, "Point field that multiplies the light which the surface gives off; where it is negative there is none.")
      .takes(fields::point_scalars);
}

namespace {

// A picture across which the texels rise evenly, and its coordinates along one axis: a value from 0 to `top` lies where the picture has it.
constexpr int rough_steps = 33, metal_steps = 9;

struct Reach {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
};
Reach reach_of(const Field& f) {
  Reach r;
  for (size_t i = 0; i < f.array.count(); ++i)
    if (const double v = f.array.get(i); std::isfinite(v)) r.lo = std::min(r.lo, v), r.hi = std::max(r.hi, v);
  return r;
}

const Field& point_scalar(const Dataset& d, const FieldName& name, const char* parameter) {
  return with_context(parameter, [&]() -> const Field& {
    const Field& f = d.fields().require(name.name, Association::point);
    if (f.components() != 1) fail_usage(fmt::format("field '{}' has {} components, one is wanted", f.name, f.components()), "material");
    return f;
  });
}

// Of a field of shares; what lies outside is told.
Reach shares_of(const Field& f, const char* parameter, Context& context) {
  const Reach r = reach_of(f);
  if (r.lo < 0 || r.hi > 1)
    context.warn(fmt::format("{}={}: its values from {:g} to {:g} are cut to 0 to 1; -f calculate brings them there", parameter, f.name,
                             r.lo, r.hi));
  return {std::clamp(r.lo, 0.0, 1.0), std::clamp(r.hi, 0.0, 1.0)};
}

// u = scale v + offset at the middle of the texel that holds v, of so many texels for 0 to `top`.
struct Ruler {
  double scale, offset;
};
Ruler ruler(int texels, double top) { return {(texels - 1) / (texels * top), 0.5 / texels}; }

TextureLookup along_ruler() {
  TextureLookup l;
  l.wrap_u = l.wrap_v = TextureWrap::clamp, l.filter = TextureFilter::bilinear;
  return l;
}

// Roughness in green along u, metalness in blue along v; steps that no value comes to repeat their neighbours.
std::shared_ptr<const Texture> shares_texture(const std::optional<Reach>& rough, const std::optional<Reach>& metal) {
  const int width = rough ? rough_steps : 1, height = metal ? metal_steps : 1;
  const auto level = [](const std::optional<Reach>& r, int i, int steps) {
    if (!r) return 1.f;
    const double step = 1.0 / (steps - 1), lo = std::floor(r->lo / step) * step, hi = std::ceil(r->hi / step) * step;
    return float(std::clamp(i * step, std::min(lo, hi), std::max(lo, hi)));
  };
  std::vector<Vec4f> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) texels.push_back({0, level(rough, x, rough_steps), level(metal, y, metal_steps), 1});
  return std::make_shared<const Texture>(width, height, std::move(texels));
}

}  // namespace

void apply(const MaterialFields& fields, const MaterialShow& stated, const Dataset& data, SurfaceMaterial& material,
           SurfacePictures& pictures, Context& context) {
  if (!fields.specular_roughness_by.empty() || !fields.base_metalness_by.empty()) {
    std::optional<Reach> rough, metal;
    SurfacePicture on;
    on.lookup = along_ruler(), on.place = {0, 0, 0.5, 0, 0, 0.5};
    if (!fields.specular_roughness_by.empty()) {
      const Field& f = point_scalar(data, fields.specular_roughness_by, "specular_roughness_by");
      rough = shares_of(f, "specular_roughness_by", context);
      const Ruler r = ruler(rough_steps, 1);
      on.coordinates = f.name, on.place[0] = r.scale, on.place[2] = r.offset;
      if (!stated.specular_roughness) material.specular_roughness = 1;
    }
    if (!fields.base_metalness_by.empty()) {
      const Field& f = point_scalar(data, fields.base_metalness_by, "base_metalness_by");
      metal = shares_of(f, "base_metalness_by", context);
      const Ruler r = ruler(metal_steps, 1);
      (rough ? on.second_coordinates : on.coordinates) = f.name;
      on.place[rough ? 4 : 3] = r.scale, on.place[5] = r.offset;
      if (!stated.base_metalness) material.base_metalness = 1;
    }
    on.texture = shares_texture(rough, metal);
    pictures.metallic_roughness = std::move(on);
  }
  if (!fields.emission_by.empty()) {
    const Field& f = point_scalar(data, fields.emission_by, "emission_by");
    const double top = reach_of(f).hi;
    if (!stated.emission) material.emission = {1, 1, 1};
    if (!(top > 0)) {
      context.warn(fmt::format("emission_by={}: it is nowhere above 0, so that nothing shines", f.name));
      material.emission = {};
      return;
    }
    SurfacePicture on;
    const Ruler r = ruler(2, top);
    on.lookup = along_ruler(), on.place = {r.scale, 0, r.offset, 0, 0, 0.5}, on.coordinates = f.name;
    const auto most = float(top);
    on.texture = std::make_shared<const Texture>(2, 1, std::vector<Vec4f>{{0, 0, 0, 1}, {most, most, most, 1}});
    pictures.emission = std::move(on);
  }
}

}  // namespace sg
