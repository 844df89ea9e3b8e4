// SPDX-License-Identifier: Apache-2.0
// Light on lines: a line has a tangent rather than a normal, and is lit as the thin cylinder it represents. Internal to raster/.
#pragma once
#include "render/shade/shade.h"

namespace sg::raster {

/// Light and gloss of a line with unit `tangent` seen along `to_viewer` (unit). Diffuse: Lambert's law averaged over the visible half of
/// the cylinder (Mallo, Peikert, Sigg, Sadlo 2005), 1 for a line across a light that shines from the viewer; specular: the highlight of the
/// brightest normal, sqrt(1 - (H.T)^2)^power with the half vector H (Zoeckler, Stalling, Hege 1996 with Blinn's model), times the cosine
/// under which that normal is seen: what is lit from behind has no highlight.
void light_line(const Material& material, std::span<const Lamp> lamps, Vec3 tangent, Vec3 to_viewer, float& light, float& gloss);

/// Tangent of segment i at the place s (0 to 1) on it: between the tangents at its ends, which are the means of the segments that meet
/// there.
Vec3 line_tangent(const PreparedItem& item, size_t i, double s);

}  // namespace sg::raster
