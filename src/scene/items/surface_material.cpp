// SPDX-License-Identifier: Apache-2.0
#include "scene/items/surface_material.h"

#include <cmath>

namespace sg {

ConductorIndex index_of(Metal metal) {
  switch (metal) {
    case Metal::gold: return {{0.121f, 0.498f, 1.468f}, {9.765f, 2.266f, 1.776f}};
    case Metal::silver: return {{0.057f, 0.055f, 0.043f}, {4.467f, 3.550f, 2.586f}};
    case Metal::copper: return {{0.227f, 1.039f, 1.294f}, {3.301f, 2.627f, 2.360f}};
    case Metal::aluminium: return {{1.190f, 0.770f, 0.466f}, {6.785f, 5.792f, 4.682f}};
    case Metal::iron: return {{2.924f, 2.918f, 2.548f}, {3.074f, 2.939f, 2.750f}};
    case Metal::titanium: return {{2.743f, 2.507f, 2.242f}, {3.835f, 3.399f, 3.015f}};
    case Metal::chromium: return {{3.244f, 3.117f, 2.287f}, {3.286f, 3.337f, 3.117f}};
    case Metal::nickel: return {{2.033f, 1.903f, 1.729f}, {4.187f, 3.574f, 2.895f}};
  }
  return {};
}

void describe(Schema& s, SurfaceMaterial& m) {
  s("base_color", m.base_color, "Colour of the body, or of metal seen straight on, where the surface has no colours of its own.")
      .range(0, 1);
  s("base_metalness", m.base_metalness, "Share of metal.").range(0, 1);
  s("metal", m.metal, "The metal is this one, by its measured index of refraction, instead of one of the base colour.");
  s("specular_weight", m.specular_weight, "How much the boundary reflects, of what its index of refraction says; 0 = matte.").range(0, 1);
  s("specular_roughness", m.specular_roughness, "From a mirror (0) to a highlight without an edge (1).").range(0, 1);
  s("specular_anisotropy", m.specular_anisotropy, "How much highlights are stretched, as on brushed metal.").range(0, 1);
  s("specular_ior", m.specular_ior, "Index of refraction.").range(1, 10);
  s("transmission_weight", m.transmission_weight, "Share of the body that is clear.").range(0, 1);
  s("transmission_color", m.transmission_color, "Colour of light that has passed transmission_depth of the clear body.").range(0, 1);
  s("transmission_depth", m.transmission_depth, "Length after which light has that colour; 0 = at once, at the boundary.").at_least(0);
  s("subsurface_weight", m.subsurface_weight, "Share of the diffuse body in which light wanders below the surface; of thin walls, passes.")
      .range(0, 1);
  s("subsurface_radius", m.subsurface_radius, "Mean free path below the surface, of red, green and blue.").at_least(0);
  s("subsurface_anisotropy", m.subsurface_anisotropy, "Mean cosine of scattering below the surface; positive = forward.")
      .range(-0.99, 0.99);
  s("coat_weight", m.coat_weight, "Share of the surface that has a clear coat.").range(0, 1);
  s("coat_color", m.coat_color, "Colour of what is below the coat, seen through it twice.").range(0, 1);
  s("coat_roughness", m.coat_roughness, "Roughness of the coat.").range(0, 1);
  s("coat_ior", m.coat_ior, "Index of refraction of the coat.").range(1, 10);
  s("retro_weight", m.retro_weight, "Share of the surface that reflects light back to where it comes from.").range(0, 1);
  s("dielectric_priority", m.dielectric_priority,
    "Of clear bodies that touch or overlap, where each refracts against the other: the one of the highest is there; 0 = refracts against "
    "air.")
      .range(0, 1000);
  s("emission", m.emission, "Light that the surface gives off by itself: radiance of red, green and blue.").at_least(0);
  s("thin_walled", m.thin_walled, "The surface is a sheet, without a body behind it.");
}

void check(const SurfaceMaterial& m) {
  SurfaceMaterial checked;
  Schema given, schema = schema_of(checked);
  SurfaceMaterial copy = m;
  describe(given, copy);
  for (const ParamDecl& d : given.decls())
    if (const Value v = d.ref.get(); !std::holds_alternative<std::monostate>(v)) set_value(schema, d.name, v, "material");
}

namespace {

SurfaceMaterial of_metal(Metal metal, double roughness) {
  const ConductorIndex n = index_of(metal);
  SurfaceMaterial m;
  // The colour of metals of one colour: their reflectance at normal incidence.
  for (int i = 0; i < 3; ++i) {
    const double eta = double(n.eta[i]), k2 = double(n.k[i]) * double(n.k[i]);
    m.base_color[i] = ((eta - 1) * (eta - 1) + k2) / ((eta + 1) * (eta + 1) + k2);
  }
  m.base_metalness = 1, m.metal = metal, m.specular_roughness = roughness;
  return m;
}

SurfaceMaterial of_glass(double ior, double roughness) {
  SurfaceMaterial m;
  m.transmission_weight = 1, m.specular_ior = ior, m.specular_roughness = roughness;
  return m;
}

}  // namespace

SurfaceMaterial data_material() {
  SurfaceMaterial m;
  m.specular_roughness = 0.45, m.specular_weight = 0.6;
  return m;
}

SurfaceMaterial preset_material(MaterialPreset preset, double size) {
  SurfaceMaterial m;
  switch (preset) {
    case MaterialPreset::matte: m.specular_weight = 0; return m;
    case MaterialPreset::paper: m.specular_weight = 0, m.thin_walled = true, m.subsurface_weight = 0.3; return m;
    case MaterialPreset::plastic: m.specular_roughness = 0.1; return m;
    case MaterialPreset::satin: m.specular_roughness = 0.5; return m;
    case MaterialPreset::mirror: m.base_color = {1, 1, 1}, m.base_metalness = 1, m.specular_roughness = 0; return m;
    case MaterialPreset::gold: return of_metal(Metal::gold, 0.2);
    case MaterialPreset::silver: return of_metal(Metal::silver, 0.2);
    case MaterialPreset::copper: return of_metal(Metal::copper, 0.25);
    case MaterialPreset::aluminium: return of_metal(Metal::aluminium, 0.3);
    case MaterialPreset::iron: return of_metal(Metal::iron, 0.4);
    case MaterialPreset::titanium: return of_metal(Metal::titanium, 0.35);
    case MaterialPreset::chromium: return of_metal(Metal::chromium, 0.1);
    case MaterialPreset::nickel: return of_metal(Metal::nickel, 0.25);
    case MaterialPreset::glass: return of_glass(1.5, 0);
    case MaterialPreset::frosted_glass: return of_glass(1.5, 0.4);
    case MaterialPreset::thin_glass:
      m = of_glass(1.5, 0);
      m.thin_walled = true;
      return m;
    case MaterialPreset::water: return of_glass(1.333, 0);
    case MaterialPreset::diamond: return of_glass(2.417, 0);
    case MaterialPreset::wax:
      m.base_color = {0.9, 0.75, 0.5}, m.subsurface_weight = 1, m.specular_roughness = 0.4, m.specular_ior = 1.44;
      m.subsurface_radius = Vec3{0.04, 0.02, 0.01} * size;
      return m;
    case MaterialPreset::skin:  // of a head of 40 cm from corner to corner: diffuse mean free paths of "skin1" (Jensen et al. 2001)
      m.base_color = {0.75, 0.47, 0.34}, m.subsurface_weight = 1, m.specular_roughness = 0.45, m.specular_ior = 1.4;
      m.subsurface_radius = Vec3{0.0092, 0.0034, 0.0017} * size;
      return m;
    case MaterialPreset::car_paint:
      m.base_color = {0.6, 0.05, 0.04}, m.base_metalness = 0.5, m.specular_roughness = 0.5, m.coat_weight = 1;
      return m;
    case MaterialPreset::retroreflector: m.retro_weight = 1, m.specular_roughness = 0.3; return m;
  }
  return m;
}

}  // namespace sg
