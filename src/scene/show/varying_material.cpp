// SPDX-License-Identifier: Apache-2.0
#include "scene/show/varying_material.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace sg {

namespace {

using enum MaterialFactor;

struct Row {
  MaterialFactor factor;
  const char* parameter;  ///< of SurfaceMaterial
  const char* what;
  double SurfaceMaterial::*number;
  std::optional<double> MaterialShow::*stated;
  double full = 1;  ///< where nothing is stated; of indices of refraction that is the material's
};
constexpr Row rows[] = {
    {roughness, "specular_roughness", "the roughness", &SurfaceMaterial::specular_roughness, &MaterialShow::specular_roughness},
    {specular, "specular_weight", "how much the boundary reflects", &SurfaceMaterial::specular_weight, &MaterialShow::specular_weight},
    {ior, "specular_ior", "the index of refraction", &SurfaceMaterial::specular_ior, &MaterialShow::specular_ior},
    {metalness, "base_metalness", "the share of metal", &SurfaceMaterial::base_metalness, &MaterialShow::base_metalness},
    {transmission, "transmission_weight", "the share of the body that is clear", &SurfaceMaterial::transmission_weight,
     &MaterialShow::transmission_weight},
    {subsurface, "subsurface_weight", "the share of the body in which light wanders", &SurfaceMaterial::subsurface_weight,
     &MaterialShow::subsurface_weight},
    {subsurface_anisotropy, "subsurface_anisotropy", "the mean cosine of the turns of light there", &SurfaceMaterial::subsurface_anisotropy,
     &MaterialShow::subsurface_anisotropy, 0.99},
    {coat, "coat_weight", "the share of the clear coat", &SurfaceMaterial::coat_weight, &MaterialShow::coat_weight},
    {coat_roughness, "coat_roughness", "the roughness of that coat", &SurfaceMaterial::coat_roughness, &MaterialShow::coat_roughness},
    {coat_ior, "coat_ior", "the index of refraction of that coat", &SurfaceMaterial::coat_ior, &MaterialShow::coat_ior},
    {retro, "retro_weight", "the share that reflects light back", &SurfaceMaterial::retro_weight, &MaterialShow::retro_weight}};

struct ColorRow {
  MaterialFactor factor;
  const char* parameter;
  const char* what;
};
constexpr ColorRow color_rows[] = {{transmission_color, "transmission_color", "the colour of light that has passed the boundary"},
                                   {coat_color, "coat_color", "the colour that what is below the coat has through it"},
                                   {subsurface_radius, "subsurface_radius", "how far light gets below the surface"}};

bool is_index(MaterialFactor f) { return f == ior || f == coat_ior; }

}  // namespace

bool VaryingMaterial::any_picture() const {
  return !emission_picture.empty() || std::any_of(pictures.begin(), pictures.end(), [](const std::string& f) { return !f.empty(); });
}

bool VaryingMaterial::any_field() const {
  return !emission_by.empty() || !specular_direction.empty() || specular_anisotropy ||
         std::any_of(by.begin(), by.end(), [](const FieldName& f) { return !f.empty(); });
}

void describe(Schema& s, VaryingMaterial& p) {
  const auto field = [&](const char* parameter, MaterialFactor f, std::string help) {
    s(fmt::format("{}_by", parameter), p.by[size_t(f)], std::move(help)).takes(fields::point_scalars);
  };
  const auto picture = [&](const char* parameter, MaterialFactor f, std::string help) {
    s(fmt::format("{}_picture", parameter), p.pictures[size_t(f)], std::move(help)).unit("file");
  };
  for (const Row& r : rows) {
    field(r.parameter, r.factor,
          is_index(r.factor) ? fmt::format("Point field of numbers from 1 on that are {}.", r.what)
                             : fmt::format("Point field of 0 to 1 that multiplies {}, where the picture has an integrator.", r.what));
    picture(r.parameter, r.factor,
            is_index(r.factor) ? fmt::format("Picture in which black stands for 1 as {}, full red for {}.", r.what, r.parameter)
                               : fmt::format("Picture that multiplies {} by its red; placed as `picture`.", r.what));
  }
  for (const ColorRow& r : color_rows) {
    field(r.parameter, r.factor, fmt::format("Point field of 0 to 1 that multiplies {}.", r.what));
    picture(r.parameter, r.factor, fmt::format("Picture whose colours multiply {}; placed as `picture`.", r.what));
  }
  s("emission_by", p.emission_by, "Point field that multiplies the light which the surface gives off; where it is negative there is none.")
      .takes(fields::point_scalars);
  s("emission_picture", p.emission_picture, "Picture whose colours multiply the light which the surface gives off; placed as `picture`.")
      .unit("file");
  s("specular_anisotropy", p.specular_anisotropy,
    "How much highlights are stretched along specular_direction, as on brushed metal. Default: 0.8 where that is stated.")
      .range(0, 1);
  s("specular_direction", p.specular_direction,
    "Point field of vectors along which highlights are stretched, across the strokes of a brush.")
      .takes(fields::point_vectors);
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

const Field& point_scalar(const Dataset& d, const FieldName& name, const std::string& parameter) {
  return with_context(parameter, [&]() -> const Field& {
    const Field& f = d.fields().require(name.name, Association::point);
    if (f.components() != 1) fail_usage(fmt::format("field '{}' has {} components, one is wanted", f.name, f.components()), "material");
    return f;
  });
}

/// A picture of two texels, black where the field is `lo` and `top` bright where it is `hi`.
SurfacePicture ramp(const Field& f, double lo, double hi, double top = 1) {
  const double per = 0.5 / (hi - lo);
  SurfacePicture on;
  on.coordinates = f.name, on.place = {per, 0, 0.25 - per * lo, 0, 0, 0.5};
  on.lookup.wrap_u = on.lookup.wrap_v = TextureWrap::clamp, on.lookup.filter = TextureFilter::bilinear;
  const auto most = float(top);
  on.texture = std::make_shared<const Texture>(2, 1, std::vector<Vec4f>{{0, 0, 0, 1}, {most, most, most, 1}});
  return on;
}

/// The values of a field as shares of `most`, which becomes the largest of them where they are indices of refraction.
SurfacePicture shares_of(const Field& f, const std::string& parameter, bool index, double& most, Context& context) {
  const Reach r = reach_of(f);
  if (index) {
    if (r.lo < 1)
      context.warn(fmt::format("{}={}: its values from {:g} to {:g} are cut to 1 at least, as indices of refraction are", parameter, f.name,
                               r.lo, r.hi));
    most = std::clamp(r.hi, 1.001, 10.0);
    return ramp(f, 1, most);
  }
  if (r.lo < 0 || r.hi > 1)
    context.warn(
        fmt::format("{}={}: its values from {:g} to {:g} are cut to 0 to 1; -f calc brings them there", parameter, f.name, r.lo, r.hi));
  return ramp(f, 0, 1);
}

bool has(const SurfacePictures& pictures, MaterialFactor factor) {
  for (const SurfaceFactors& p : pictures.factors)
    for (const FactorChannel& c : p.channels)
      if (c.factor == factor) return true;
  return false;
}

/// What is of a coat, of clear matter, or of what light wanders in shows nothing where there is none of it.
void tell_what_shows_nothing(const SurfaceMaterial& m, const SurfacePictures& pictures, Context& context) {
  struct Need {
    double of;
    const char* weight;
    std::initializer_list<MaterialFactor> factors;
  };
  for (const Need& need : {Need{m.coat_weight, "coat_weight", {coat_roughness, coat_ior, coat_color}},
                           Need{m.transmission_weight, "transmission_weight", {transmission_color}},
                           Need{m.subsurface_weight, "subsurface_weight", {subsurface_radius, subsurface_anisotropy}}})
    if (need.of == 0 && std::any_of(need.factors.begin(), need.factors.end(), [&](MaterialFactor f) { return has(pictures, f); }))
      context.warn(fmt::format("a field or picture of the material shows nothing, because {0} is 0: {0}=1 shows it", need.weight));
}

void apply_emission(const VaryingMaterial& p, const MaterialShow& stated, const PictureShow& where, const Dataset& data,
                    SurfaceMaterial& material, SurfacePictures& pictures, Context& context) {
  if (p.emission_by.empty() && p.emission_picture.empty()) return;
  if (!p.emission_by.empty() && !p.emission_picture.empty())
    fail_usage("both a field and a picture are to multiply the light that the surface gives off", "emission_picture", "leave one out");
  if (!stated.emission) material.emission = {1, 1, 1};
  if (!p.emission_picture.empty()) {
    pictures.emission = picture_in_file(data, where, p.emission_picture, TexelEncoding::srgb);
    return;
  }
  const Field& f = point_scalar(data, p.emission_by, "emission_by");
  if (const double top = reach_of(f).hi; top > 0) {
    pictures.emission = ramp(f, 0, top, top);
  } else {
    context.warn(fmt::format("emission_by={}: it is nowhere above 0, so that nothing shines", f.name));
    material.emission = {};
  }
}

void apply_direction(const VaryingMaterial& p, const Dataset& data, SurfaceMaterial& material, SurfacePictures& pictures) {
  material.specular_anisotropy = p.specular_anisotropy.value_or(p.specular_direction.empty() ? material.specular_anisotropy : 0.8);
  if (!p.specular_direction.empty()) {
    const Field& f = with_context("specular_direction",
                                  [&]() -> const Field& { return data.fields().require(p.specular_direction.name, Association::point); });
    if (f.components() != 3)
      fail_usage(fmt::format("field '{}' has {} components, a direction has 3", f.name, f.components()), "specular_direction");
    pictures.stretched_along = f.name;
  } else if (material.specular_anisotropy > 0) {
    fail_usage("nothing says along what highlights are stretched", "specular_anisotropy",
               "specular_direction=FIELD names a point field of vectors");
  }
}

}  // namespace

void apply(const VaryingMaterial& p, const MaterialShow& stated, const PictureShow& where, const Dataset& data, SurfaceMaterial& material,
           SurfacePictures& pictures, Context& context) {
  const auto add = [&](SurfacePicture on, MaterialFactor factor) { pictures.factors.push_back({std::move(on), {{factor, 0}}}); };
  for (const Row& r : rows) {
    const FieldName& by = p.by[size_t(r.factor)];
    const std::string& file = p.pictures[size_t(r.factor)];
    if (!(stated.*r.stated) && !is_index(r.factor) && (!by.empty() || !file.empty() || has(pictures, r.factor)))
      material.*r.number = r.full;
    const std::string parameter = fmt::format("{}_by", r.parameter);
    if (!by.empty())
      add(shares_of(point_scalar(data, by, parameter), parameter, is_index(r.factor), material.*r.number, context), r.factor);
    if (!file.empty()) add(picture_in_file(data, where, file, TexelEncoding::linear), r.factor);
  }
  for (const ColorRow& r : color_rows) {
    const std::string parameter = fmt::format("{}_by", r.parameter);
    double one = 1;
    if (const FieldName& by = p.by[size_t(r.factor)]; !by.empty())
      add(shares_of(point_scalar(data, by, parameter), parameter, false, one, context), r.factor);
    if (const std::string& file = p.pictures[size_t(r.factor)]; !file.empty())
      add(picture_in_file(data, where, file, r.factor == subsurface_radius ? TexelEncoding::linear : TexelEncoding::srgb), r.factor);
  }
  if (has(pictures, transmission_color) && material.transmission_depth > 0 && !material.thin_walled)
    fail_usage("the colour of a clear body does not change over its surface", "transmission_color",
               "transmission_depth=0 colours what passes the boundary; a volume within the glass has colours inside");
  apply_emission(p, stated, where, data, material, pictures, context);
  apply_direction(p, data, material, pictures);
  tell_what_shows_nothing(material, pictures, context);
}

}  // namespace sg
