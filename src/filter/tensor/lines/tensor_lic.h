// SPDX-License-Identifier: Apache-2.0
// tensor_lic: the eigenvectors of a tensor field as a texture on a surface.
#pragma once
#include "filter/flow/texture/line_fade.h"
#include "filter/tensor/tensor_field.h"

namespace sg {

/// What the texture fades to where tensors have no direction.
enum class IsotropicLook { noise, gray };
constexpr auto enum_words(IsotropicLook) {
  using enum IsotropicLook;
  return std::array{Word{"noise", noise}, Word{"gray", gray}};
}

struct TensorLicParams {
  TensorSource tensors;
  int eigenvector = 1;
  std::optional<double> density = {};
  int steps = 40;
  double step = 0;
  LineFade kernel = LineFade::hann;
  bool stretch = true;
  double fade = 0.05;
  IsotropicLook isotropic = IsotropicLook::noise;
  int64_t seed = 1;
};
void describe(Schema& s, TensorLicParams& p);

/// Line integral convolution as surface_lic does it (its mesh, noise, steps and kernels) along the eigenvectors of the tensors in the
/// surface: of P T P, P the projection on each triangle's plane, the larger eigenvalue (1) or the smaller (2) of the two in it; the one
/// across does not count. Tensors are linear in each triangle, by their components; lines keep their sign from triangle to triangle, across
/// creases by unfolding them, so that nothing shows where stored eigenvectors flip.
///
/// Where the eigenvalues a, b are nearly equal the direction has no meaning: with |a - b| / (|a| + |b|), the anisotropy, below `fade`,
/// lines get shorter in proportion, down to the plain noise (isotropic=noise), or the contrast gets weaker, down to 0.5 (gray). 0.5 where
/// the tensor is NaN. Any mesh: of solids the skin is taken, of flat grids their cells. Result: a SurfaceMesh of triangles with the point
/// fields "lic" (f32, 0..1; role scalars) and "in-plane anisotropy" (f32, mean over the triangles around) before those of the input. Throws
/// Error(usage) for what read_tensors refuses, vectors, 2D tensors on surfaces outside of the xy-plane, data without faces, and more than
/// 64 million triangles. Parallel, O(points * steps).
DatasetPtr tensor_lic(const DatasetPtr& in, const TensorLicParams& p, Context& ctx);

}  // namespace sg
