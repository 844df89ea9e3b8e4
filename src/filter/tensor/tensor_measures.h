// SPDX-License-Identifier: Apache-2.0
// Fields made of tensors: eigenvalues and eigenvectors, measures of diffusion, colours by direction.
#pragma once
#include "filter/tensor/tensor_field.h"

namespace sg {

struct TensorEigenParams {
  TensorSource tensors;
  std::string vectors = "all";
};
void describe(Schema& s, TensorEigenParams& p);

/// Adds the fields "eigenvalue 1" to "eigenvalue 3" in descending order and the unit vectors "eigenvector 1" to "eigenvector 3"
/// (`vectors`: all, first, none), right-handed, where the tensors lie (2D: two of each). The sign of an eigenvector means nothing: its
/// largest component is positive. NaN tensors give NaN. f64 for 64-bit fields, else f32.
DatasetPtr tensor_eigen(const DatasetPtr& in, const TensorEigenParams& p, Context& ctx);

struct TensorMeasuresParams {
  TensorSource tensors;
  std::vector<std::string> measures = {"FA", "MD", "RA", "mode", "cl", "cp", "cs"};
  std::string westin = "trace";
  std::string negative = "keep";
};
void describe(Schema& s, TensorMeasuresParams& p);

/// Adds one field per measure, named like it (see tensor_shape.h for the formulas): FA, MD, RA, mode, cl, cp, cs, trace, determinant, norm.
/// Diffusion has no negative eigenvalues: when FA, MD, RA, mode or the Westin measures are asked for and some are negative (below -1e-6 of
/// the largest), one warning counts them, and `negative` says what becomes of such tensors: keep, clip (to 0), absolute, nan. 2D tensors
/// have FA, MD, trace, determinant and norm in the plane. Throws Error(usage) for others of a 2D field.
DatasetPtr tensor_measures(const DatasetPtr& in, const TensorMeasuresParams& p, Context& ctx);

struct DirectionColorsParams {
  TensorSource tensors;
  int eigenvector = 1;
  std::string weight = "FA";
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
