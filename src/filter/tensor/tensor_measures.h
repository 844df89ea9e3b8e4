// SPDX-License-Identifier: Apache-2.0
// Fields made of tensors: eigenvalues and eigenvectors, measures of diffusion, colours by direction.
#pragma once
#include "filter/tensor/tensor_field.h"

namespace sg {

enum class EigenvectorsKept { all, first, none };
constexpr auto enum_words(EigenvectorsKept) {
  using enum EigenvectorsKept;
  return std::array{Word{"all", all}, Word{"first", first}, Word{"none", none}};
}

struct TensorEigenParams {
  TensorSource tensors;
  EigenvectorsKept vectors = EigenvectorsKept::all;
};
void describe(Schema& s, TensorEigenParams& p);

/// Adds the fields "eigenvalue 1" to "eigenvalue 3" in descending order and the unit vectors "eigenvector 1" to "eigenvector 3"
/// (`vectors`: all, first, none), right-handed, where the tensors lie (2D: two of each). The sign of an eigenvector means nothing: its
/// largest component is positive. NaN tensors give NaN. f64 for 64-bit fields, else f32.
DatasetPtr tensor_eigen(const DatasetPtr& in, const TensorEigenParams& p, Context& ctx);

/// See tensor_shape.h for the formulas.
enum class TensorMeasure { FA, MD, RA, mode, cl, cp, cs, trace, determinant, norm };
constexpr auto enum_words(TensorMeasure) {
  using enum TensorMeasure;
  return std::array{Word{"FA", FA},     Word{"MD", MD},       Word{"RA", RA},
                    Word{"mode", mode}, Word{"cl", cl},       Word{"cp", cp},
                    Word{"cs", cs},     Word{"trace", trace}, Word{"determinant", determinant},
                    Word{"norm", norm}};
}
/// What cl, cp and cs are divided by: the trace, or the largest eigenvalue.
enum class WestinNorm { trace, largest };
constexpr auto enum_words(WestinNorm) {
  using enum WestinNorm;
  return std::array{Word{"trace", trace}, Word{"largest", largest}};
}
/// What becomes of negative eigenvalues: clip: 0; nan: the whole tensor.
enum class NegativeEigenvalues { keep, clip, absolute, nan };
constexpr auto enum_words(NegativeEigenvalues) {
  using enum NegativeEigenvalues;
  return std::array{Word{"keep", keep}, Word{"clip", clip}, Word{"absolute", absolute}, Word{"nan", nan}};
}

struct TensorMeasuresParams {
  TensorSource tensors;
  std::vector<TensorMeasure> measures = {TensorMeasure::FA, TensorMeasure::MD, TensorMeasure::RA, TensorMeasure::mode,
                                         TensorMeasure::cl, TensorMeasure::cp, TensorMeasure::cs};
  WestinNorm westin = WestinNorm::trace;
  NegativeEigenvalues negative = NegativeEigenvalues::keep;
};
void describe(Schema& s, TensorMeasuresParams& p);

/// Adds one field per measure, named like it (see tensor_shape.h for the formulas): FA, MD, RA, mode, cl, cp, cs, trace, determinant, norm.
/// Diffusion has no negative eigenvalues: when FA, MD, RA, mode or the Westin measures are asked for and some are negative (below -1e-6 of
/// the largest), one warning counts them, and `negative` determines the treatment of such tensors: keep, clip (to 0), absolute, nan. 2D
/// tensors have FA, MD, trace, determinant and norm in the plane. Throws Error(usage) for others of a 2D field.
DatasetPtr tensor_measures(const DatasetPtr& in, const TensorMeasuresParams& p, Context& ctx);

enum class ColorWeight { FA, cl, none };
constexpr auto enum_words(ColorWeight) {
  using enum ColorWeight;
  return std::array{Word{"FA", FA}, Word{"cl", cl}, Word{"none", none}};
}

struct DirectionColorsParams {
  TensorSource tensors;
  int eigenvector = 1;
  ColorWeight weight = ColorWeight::FA;
  double gamma = 1;
};
void describe(Schema& s, DirectionColorsParams& p);

/// Adds the u8 field "direction" of 3 components (role colors): red, green and blue are the absolute x, y and z of an eigenvector, times FA
/// (`weight`: FA, cl, none) to the power 1/gamma (Pajevic, Pierpaoli 1999). NaN tensors are black.
DatasetPtr direction_colors(const DatasetPtr& in, const DirectionColorsParams& p, Context& ctx);

/// The colour of a direction: round(255 |v| weight), v of length 1.
void direction_color(Vec3 v, double weight, uint8_t* rgb);

/// A one-line warning for `count` tensors with negative eigenvalues of `all`; none for 0.
void warn_negative(size_t count, size_t all, const TensorField& t, std::string_view who, std::string_view what_happens, Context& ctx);

}  // namespace sg
