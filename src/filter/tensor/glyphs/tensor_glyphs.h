// SPDX-License-Identifier: Apache-2.0
// Tensor glyphs as surfaces.
#pragma once
#include "filter/tensor/glyphs/glyph_shapes.h"
#include "filter/tensor/tensor_field.h"

namespace sg {

/// What sizes show.
enum class TensorScale { eigenvalues, log, normalized };
constexpr auto enum_words(TensorScale) {
  using enum TensorScale;
  return std::array{Word{"eigenvalues", eigenvalues}, Word{"log", log}, Word{"normalized", normalized}};
}

/// What the colours show, where that is no field.
enum class TensorColor { direction, fa, sign, none };
constexpr auto enum_words(TensorColor) {
  using enum TensorColor;
  return std::array{Word{"direction", direction}, Word{"FA", fa}, Word{"sign", sign}, Word{"none", none}};
}

struct TensorGlyphsParams {
  TensorSource tensors;
  TensorShape shape = TensorShape::superquadric;
  double gamma = 3;
  double min_ratio = 0.3;
  int64_t count = 0;
  int64_t stride = 0;
  FieldName mask;
  double min_fa = 0;
  std::optional<TensorScale> scale;
  double size = 1.15;
  std::optional<double> factor;
  std::optional<std::string> color;  ///< a word of TensorColor, or a field
  int resolution = 10;
};
void describe(Schema& s, TensorGlyphsParams& p);

/// A SurfaceMesh of one closed surface per tensor (see glyph_shapes.h), with exact normals, at the points (cell fields: at the middles of
/// the cells). Placed at every stride-th point along each axis of a grid; `stride` 0: all points, or where they are more than `count` the
/// finest stride that stays below it; other meshes: the point nearest to the middle of each cube of an even division of space. Hidden
/// points and cells, tensors that are zero or NaN, those with FA below min_fa and those where `mask` is not above 0 get none; a note counts
/// them.
///
/// The longest half axis of all is `size` times half the distance of the glyphs. `scale`: eigenvalues (all alike), normalized (each glyph
/// as large as it may be), log (sizes by the logarithm of the largest eigenvalue, shapes kept), auto: eigenvalues, or log where the largest
/// is more than 5 times the median. With `factor`, half axis = |eigenvalue| * factor.
///
/// Negative eigenvalues count by their absolute value. Point fields: "signed share" ((l1+l2+l3) / (|l1|+|l2|+|l3|): 1 tension, -1
/// compression) and "sign" (i8: -1, 0, 1 of n.s.n in the direction n of the vertex) where there are negative ones; reynolds: "relative
/// normal stress" (n.s.n by the largest absolute eigenvalue, -1 to 1); hwy: "relative shear stress"; always "FA", "eigenvalue 1" to "3",
/// "Normals", the fields of the input (but the tensors), "original_point" or "original_cell". `color`: direction (u8 field "direction" of
/// |eigenvector 1|, paler the lower FA is, role colors), FA, sign, none, or the name of a field; auto: the relative stress of lobes, the
/// signed share where there are negative eigenvalues, else direction.
DatasetPtr tensor_glyphs(const DatasetPtr& in, const TensorGlyphsParams& p, Context& ctx);

}  // namespace sg
