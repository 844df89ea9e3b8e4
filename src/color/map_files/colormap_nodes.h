// SPDX-License-Identifier: Apache-2.0
// Control points of colour maps, and even samples of them.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "color/colormap.h"

namespace sg {

struct ColorNode {
  double position;
  Vec3f color;  ///< sRGB; hue in degrees, saturation and value in NodeSpace::hue
};

/// `hue`: as `hsv`, but colours are given in it, so that whole turns and the hues of greys count.
enum class NodeSpace { rgb, hsv, hue, lab, diverging };

/// Between two colours: linear in sRGB, in HSV (hues do not wrap), in CIELAB, or in Msh (Moreland 2009).
Vec3f between(Vec3f a, Vec3f b, double t, NodeSpace space);

/// Hue in degrees, saturation and value in [0,1].
Vec3f hsv_to_rgb(double hue, double saturation, double value);
Vec3f rgb_to_hsv(Vec3f color);

/// Gives a map the colours of sorted nodes, from the first to the last, each at its place; two nodes at one place make a step. Between
/// them the path in other spaces than RGB is sampled finely.
void set_nodes(Colormap& map, std::span<const ColorNode> nodes, NodeSpace space);

/// Result of the lightness analysis: rising or falling, with one extremum near the middle, closed, or none of these (unsafe).
MapKind kind_of_colors(const Colormap& map);

}  // namespace sg
