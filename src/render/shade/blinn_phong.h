// SPDX-License-Identifier: Apache-2.0
// The light model of all that is drawn, surfaces and volumes alike (Blinn 1977), for one place; blinn_phong-inl.h is the same for vectors.
//
//   light = ambient + diffuse sum I max(n.l, 0), times the colour
//   gloss = specular sum I [n.l > 0] max(n.h, 0)^power, added
//
// with the normal n on the side that is seen, l towards a lamp, h halfway between l and the viewer.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "render/shade/lamp.h"
#include "scene/items/material.h"

namespace sg {

/// h^power by squaring for whole powers (all the usual ones), else by the library.
inline float power_of(float h, float power) {
  int n = int(power);
  if (float(n) != power || n < 0 || n > 4096) return std::pow(h, power);
  float result = 1;
  for (; n > 0; n >>= 1, h *= h)
    if (n & 1) result *= h;
  return result;
}

/// The sums over the lamps, without the material's shares.
struct Reflected {
  float diffuse = 0, specular = 0;

  /// A lamp with n.l and n.h, of whose light `share` arrives.
  void add(const SeenLamp& lamp, float n_l, float n_h, float power, float share = 1) {
    if (!(n_l > 0)) return;
    diffuse += lamp.intensity * n_l * share;
    specular += lamp.intensity * share * power_of(std::max(0.0f, n_h), power);
  }
};

/// Of a normal that is `n` times `per_length` (unit then, on the side that is seen).
inline Reflected reflected(const std::vector<SeenLamp>& lamps, Vec3f n, float per_length, float power) {
  Reflected sum;
  for (const SeenLamp& l : lamps) sum.add(l, per_length * dot(n, l.light), per_length * dot(n, l.half), power);
  return sum;
}

/// Light and gloss of a unit normal seen along `to_viewer` (unit); 1 and 0 for what is not lit.
void light_point(const Material& material, std::span<const Lamp> lamps, Vec3f normal, Vec3f to_viewer, float& light, float& gloss);

}  // namespace sg
