// SPDX-License-Identifier: Apache-2.0
#include "scene/show/material_words.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/schema/color_params.h"

namespace sg {

bool MaterialShow::any() const {
  return material || metal || base_metalness || specular_weight || specular_roughness || specular_ior || transmission_weight ||
         transmission_depth || transmission_color || subsurface_weight || subsurface_radius || subsurface_anisotropy || coat_weight ||
         coat_color || coat_roughness || coat_ior || retro_weight || emission || thin_walled || dielectric_priority;
}

SurfaceMaterial MaterialShow::made(double size) const {
  SurfaceMaterial m = material ? preset_material(*material, size) : data_material();
  const auto take = [](auto& to, const auto& from) {
    if (from) to = *from;
  };
  take(m.base_metalness, base_metalness), take(m.specular_weight, specular_weight), take(m.specular_roughness, specular_roughness);
  take(m.specular_ior, specular_ior);
  take(m.transmission_weight, transmission_weight), take(m.transmission_depth, transmission_depth);
  take(m.transmission_color, transmission_color), take(m.subsurface_weight, subsurface_weight);
  take(m.subsurface_radius, subsurface_radius), take(m.subsurface_anisotropy, subsurface_anisotropy);
  take(m.coat_weight, coat_weight), take(m.coat_color, coat_color), take(m.coat_roughness, coat_roughness), take(m.coat_ior, coat_ior);
  take(m.retro_weight, retro_weight), take(m.emission, emission);
  take(m.thin_walled, thin_walled), take(m.dielectric_priority, dielectric_priority);
  if (metal) {
    m.metal = metal;
    if (!base_metalness && m.base_metalness == 0 && m.retro_weight == 0) m.base_metalness = 1;
    if (m.base_metalness == 1) m.base_color = preset_material(*value_of_word<MaterialPreset>(word_of(*metal)), size).base_color;
  }
  return m;
}

void describe(Schema& s, MaterialShow& p) {
  s("material", p.material,
    "What the surface is made of, where the picture has an integrator; its own colour takes the place of those of a field that is not "
    "stated. sightglass lookdev shows all. Default: plastic of the data's colours.");
  s("metal", p.metal,
    "The metal is this one, by its measured index of refraction, instead of one of the surface's colour. All is metal where neither "
    "base_metalness nor the material says how much.");
  s("base_metalness", p.base_metalness, "Share of metal, instead of the material's.").range(0, 1);
  s("specular_weight", p.specular_weight,
    "How much the boundary reflects, of what its index of refraction says, instead of the material's; 0 = matte.")
      .range(0, 1);
  s("specular_roughness", p.specular_roughness, "From a mirror (0) to a highlight without an edge (1), instead of the material's.")
      .range(0, 1);
  s("specular_ior", p.specular_ior, "Index of refraction, instead of the material's.").range(1, 10);
  s("transmission_weight", p.transmission_weight, "Share of the body that is clear, instead of the material's.").range(0, 1);
  s("transmission_color", p.transmission_color, "Colour of light (red, green, blue) that has passed transmission_depth of the clear body.")
      .unit(linear_color_unit)
      .range(0, 1);
  s("transmission_depth", p.transmission_depth, "Length after which light has that colour; 0 = at once, at the boundary.").at_least(0);
  s("subsurface_weight", p.subsurface_weight, "Share of the body in which light wanders below the surface, instead of the material's.")
      .range(0, 1);
  s("subsurface_radius", p.subsurface_radius, "How far red, green and blue light get there on average, in the data's lengths.").at_least(0);
  s("subsurface_anisotropy", p.subsurface_anisotropy, "Mean cosine of the turns that it takes there; above 0 goes forward.")
      .range(-0.99, 0.99);
  s("coat_weight", p.coat_weight, "Share of the surface that has a clear coat, instead of the material's.").range(0, 1);
  s("coat_color", p.coat_color, "Colour (red, green, blue) that what is below the coat has through it.")
      .unit(linear_color_unit)
      .range(0, 1);
  s("coat_roughness", p.coat_roughness, "Roughness of that coat, instead of the material's.").range(0, 1);
  s("coat_ior", p.coat_ior, "Index of refraction of that coat, instead of the material's.").range(1, 10);
  s("retro_weight", p.retro_weight, "Share of the surface that reflects light back to where it comes from, instead of the material's.")
      .range(0, 1);
  s("emission", p.emission, "Light that the surface gives off by itself: radiance of red, green and blue.")
      .unit(linear_color_unit)
      .at_least(0);
  s("thin_walled", p.thin_walled, "The surface is a sheet, without a body behind it.");
  s("dielectric_priority", p.dielectric_priority,
    "Of clear bodies that touch or overlap: the one of the highest is there, and refracts against the others. 0 = refracts against air.")
      .range(0, 1000);
}

Vec3f own_color(const SurfaceMaterial& m) {
  const Vec3f own(m.base_color);
  return {srgb_encode(own.x), srgb_encode(own.y), srgb_encode(own.z)};
}

bool MaterialFields::any() const {
  for (const FieldName* f : {&specular_roughness_by, &base_metalness_by, &transmission_weight_by, &subsurface_weight_by, &coat_weight_by,
                             &coat_roughness_by, &emission_by})
    if (!f->empty()) return true;
  return false;
}

void describe(Schema& s, MaterialFields& p) {
  s("specular_roughness_by", p.specular_roughness_by,
    "Point field of 0 to 1 that multiplies the roughness, where the picture has an integrator.")
      .takes(fields::point_scalars);
  s("base_metalness_by", p.base_metalness_by, "Point field of 0 to 1 that multiplies the share of metal.").takes(fields::point_scalars);
  s("transmission_weight_by", p.transmission_weight_by, "Point field of 0 to 1 that multiplies the share of the body that is clear.")
      .takes(fields::point_scalars);
  s("subsurface_weight_by", p.subsurface_weight_by, "Point field of 0 to 1 that multiplies the share of the body in which light wanders.")
      .takes(fields::point_scalars);
  s("coat_weight_by", p.coat_weight_by, "Point field of 0 to 1 that multiplies the share of the clear coat.").takes(fields::point_scalars);
  s("coat_roughness_by", p.coat_roughness_by, "Point field of 0 to 1 that multiplies the roughness of that coat.")
      .takes(fields::point_scalars);
  s("emission_by", p.emission_by, "Point field that multiplies the light which the surface gives off; where it is negative there is none.")
      .takes(fields::point_scalars);
}

namespace {

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

/// A picture of two texels, black and `top` bright, in which a value of the field lies where the picture has it.
SurfacePicture ramp(const Field& f, double top) {
  SurfacePicture on;
  on.coordinates = f.name, on.place = {0.5 / top, 0, 0.25, 0, 0, 0.5};
  on.lookup.wrap_u = on.lookup.wrap_v = TextureWrap::clamp, on.lookup.filter = TextureFilter::bilinear;
  const auto most = float(top);
  on.texture = std::make_shared<const Texture>(2, 1, std::vector<Vec4f>{{0, 0, 0, 1}, {most, most, most, 1}});
  return on;
}

}  // namespace

void apply(const MaterialFields& fields, const MaterialShow& stated, const Dataset& data, SurfaceMaterial& material,
           SurfacePictures& pictures, Context& context) {
  using enum MaterialFactor;
  struct Row {
    const char* parameter;
    const FieldName& field;
    MaterialFactor factor;
    double& value;
    bool stated;
  };
  Row rows[] = {
      {"specular_roughness_by", fields.specular_roughness_by, roughness, material.specular_roughness,
       stated.specular_roughness.has_value()},
      {"base_metalness_by", fields.base_metalness_by, metalness, material.base_metalness, stated.base_metalness.has_value()},
      {"transmission_weight_by", fields.transmission_weight_by, transmission, material.transmission_weight,
       stated.transmission_weight.has_value()},
      {"subsurface_weight_by", fields.subsurface_weight_by, subsurface, material.subsurface_weight, stated.subsurface_weight.has_value()},
      {"coat_weight_by", fields.coat_weight_by, coat, material.coat_weight, stated.coat_weight.has_value()},
      {"coat_roughness_by", fields.coat_roughness_by, coat_roughness, material.coat_roughness, stated.coat_roughness.has_value()}};
  for (const Row& row : rows) {
    if (row.field.empty()) continue;
    const Field& f = point_scalar(data, row.field, row.parameter);
    if (const Reach r = reach_of(f); r.lo < 0 || r.hi > 1)
      context.warn(fmt::format("{}={}: its values from {:g} to {:g} are cut to 0 to 1; -f calculate brings them there", row.parameter,
                               f.name, r.lo, r.hi));
    pictures.factors.push_back({ramp(f, 1), {{row.factor, 0}}});
  }
  for (const Row& row : rows)
    for (const SurfaceFactors& p : pictures.factors)
      for (const FactorChannel& c : p.channels)
        if (c.factor == row.factor && !row.stated) row.value = 1;
  if (fields.emission_by.empty()) return;
  const Field& f = point_scalar(data, fields.emission_by, "emission_by");
  const double top = reach_of(f).hi;
  if (!stated.emission) material.emission = {1, 1, 1};
  if (!(top > 0)) {
    context.warn(fmt::format("emission_by={}: it is nowhere above 0, so that nothing shines", f.name));
    material.emission = {};
    return;
  }
  pictures.emission = ramp(f, top);
}

}  // namespace sg
