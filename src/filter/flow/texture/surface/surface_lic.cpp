// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/surface/surface_lic.h"

#include "base/error.h"
#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "filter/flow/flow_field.h"
#include "filter/flow/texture/surface/surface_convolution.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

std::vector<Vec3> vectors_of(const Field& f) {
  std::vector<Vec3> out(f.array.count());
  dispatch(f.array, [&](auto v) {
    parallel_for(v.count, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = {double(v(i, 0)), double(v(i, 1)), f.components() > 2 ? double(v(i, 2)) : 0.0};
    });
  });
  return out;
}

}  // namespace

DatasetPtr surface_lic(const DatasetPtr& in, const SurfaceLicParams& p, Context& context) {
  const DatasetPtr surface = surface_of(in, context);
  flow_field_of(*surface, p.field.name, "surface_lic");  // complains before work is done
  const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
  if (mesh.polygons.size() + mesh.strips.size() == 0)
    fail_usage("the data has no faces to carry a texture", "surface_lic", "take a surface first: faces, contour or slice");
  const double diagonal = in->bounds().diagonal();
  const RefinedSurface r = refine_surface(surface, textured_edge(*surface, diagonal, p.density), most_textured_triangles, context);
  const Field& f = flow_field_of(*r.dataset, p.field.name, "surface_lic");
  const std::vector<Vec3> vectors = vectors_of(f);
  const SurfaceWalk walk(r, vectors, f.association == Association::cell, longest_piece(r, p.step));
  const SurfaceConvolution lines{p.steps, p.step, p.kernel, p.stretch, p.seed};
  return textured_surface(r,
                          {{"lic", Association::point, convolve_surface(r, walk, lines, {}, context), "", Role::none, known_look("lic")}});
}

}  // namespace sg
