// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/lines/tensor_lic.h"

#include <fmt/core.h>

#include "base/error.h"
#include "data/fields/known_looks.h"
#include "filter/flow/texture/surface/surface_convolution.h"
#include "filter/mesh/surface.h"

namespace sg {

void describe(Schema& s, TensorLicParams& p) {
  describe_tensors(s, p.tensors);
  s("eigenvector", p.eigenvector, "In-surface eigenvector to follow: 1 of the larger eigenvalue, 2 of the smaller.").range(1, 2);
  s("density", p.density,
    "Samples along the diagonal of the bounding box: triangles are split until their edges are no longer than the diagonal divided by "
    "this; 0 keeps the triangles of the mesh. Default: 400, or fewer if that would make more than 150 000 to 300 000 triangles.")
      .range(0, 100000);
  s("steps", p.steps, "Steps of each line in each direction.").range(1, 10000);
  s("step", p.step, "Length of a step; 0: half the mean edge of the split triangles.").unit("length").at_least(0);
  s("kernel", p.kernel, "Weights along a line: hann fades out, box is uniform.");
  s("stretch", p.stretch, "Spread the means over 0 to 1 by their known variance; false keeps the means of the noise.");
  s("fade", p.fade,
    "Anisotropy |a - b| / (|a| + |b|) of the two in-surface eigenvalues from which the texture has full contrast; below it fades, since "
    "the direction means little there. 0: full everywhere.")
      .range(0, 1);
  s("isotropic", p.isotropic, "What the texture fades to: noise (lines get shorter, down to grains) or gray (no contrast).");
  s("seed", p.seed, "Random seed of the noise.");
}

namespace {

/// What is not a tensor of this surface is refused before work is done; the name of the field.
std::string accepted(const Dataset& surface, const TensorSource& source, Context& ctx) {
  if (const Field* f = find_tensors(surface, source.field); f && f->role == Role::vectors && !source.order)
    fail_usage(fmt::format("field '{}' holds vectors, not tensors", f->name), "tensor_lic",
               "surface_lic follows vectors; order=plane takes three components as a tensor in the xy-plane");
  const TensorField t = read_tensors(surface, source, "tensor_lic", ctx);
  const Box3 box = surface.bounds();
  if (t.dimension == 2 && box.hi.z - box.lo.z > 1e-6 * box.diagonal())
    fail_usage(fmt::format("field '{}' has {} components, a tensor in the xy-plane, but the surface does not lie in that plane",
                           t.field.name, t.field.components()),
               "tensor_lic", "use tensors of 9 or 6 components, or flat data");
  return t.field.name;
}

/// Mean over the triangles around each point; NaN where none has a value.
std::vector<float> anisotropy_of(const RefinedSurface& r, const std::vector<SymTensor>& d, bool per_triangle) {
  std::vector<double> sum(r.points.size());
  std::vector<uint32_t> count(r.points.size());
  for (size_t i = 0; i < r.triangles.size(); ++i) {
    const auto& t = r.triangles[i];
    const Vec3 e1 = r.points[t[1]] - r.points[t[0]], e2 = r.points[t[2]] - r.points[t[0]];
    for (const uint32_t q : t)
      if (const double a = PlaneTensor(d[per_triangle ? i : q], e1, e2).anisotropy(); a == a) sum[q] += a, ++count[q];
  }
  std::vector<float> mean(r.points.size());
  for (size_t i = 0; i < mean.size(); ++i) mean[i] = count[i] ? float(sum[i] / count[i]) : NAN;
  share_same_places(r, mean.data());
  return mean;
}

}  // namespace

DatasetPtr tensor_lic(const DatasetPtr& in, const TensorLicParams& p, Context& ctx) {
  const DatasetPtr surface = surface_of(in, ctx);
  TensorSource source = p.tensors;
  source.field.name = accepted(*surface, source, ctx);
  const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
  if (mesh.polygons.size() + mesh.strips.size() == 0)
    fail_usage("the data has no faces to carry a texture", "tensor_lic", "take a surface first: faces, contour or slice");
  const double diagonal = in->bounds().diagonal();
  const RefinedSurface r = refine_surface(surface, textured_edge(*surface, diagonal, p.density), most_textured_triangles, ctx);
  Context quiet;  // warnings of the tensors were given for the surface as it came
  TensorField t = read_tensors(*r.dataset, source, "tensor_lic", quiet);
  const bool per_triangle = t.field.association == Association::cell;
  std::vector<float> anisotropy = anisotropy_of(r, t.d, per_triangle), part = anisotropy;
  for (float& x : part) x = !(x >= 0) ? NAN : p.fade > 0 ? std::min(float(x / p.fade), 1.0f) : 1.0f;
  if (p.eigenvector == 2)
    for (SymTensor& d : t.d) d = d * -1.0;
  const SurfaceAxisWalk walk(r, t.d, per_triangle, longest_piece(r, p.step));
  const SurfaceConvolution lines{p.steps, p.step, p.kernel, p.stretch, p.seed};
  const bool gray = p.isotropic == IsotropicLook::gray;
  Array lic = convolve_surface(r, walk, lines, gray ? std::span<const float>() : std::span<const float>(part), ctx);
  if (gray) {
    const View<float> v = lic.view<float>();
    std::vector<float> faded(part.size());
    for (size_t i = 0; i < faded.size(); ++i) faded[i] = part[i] >= 0 ? 0.5f + (v[i] - 0.5f) * part[i] : 0.5f;
    lic = Array::from_vector(std::move(faded));
  }
  return textured_surface(r, {{"lic", Association::point, std::move(lic), "", Role::none, known_look("lic")},
                              {"in-plane anisotropy", Association::point, Array::from_vector(std::move(anisotropy)), "", Role::none}});
}

}  // namespace sg
