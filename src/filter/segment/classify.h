// SPDX-License-Identifier: Apache-2.0
// Tissue classes by a Gaussian mixture, with partial volume and a smooth bias field.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct ClassifyParams {
  FieldName field, mask;
  int classes = 3;
  bool background = true;
  bool partial_volume = true;
  int bias_degree = 4;
  double smoothness = 1;
  int iterations = 200;
  double tolerance = 1e-5;
};
void describe(Schema& s, ClassifyParams& p);

/// Each sample of a uniform or rectilinear grid is one of `classes` tissues, a mix of two that are neighbours in intensity, or (with
/// `background`) nothing. The means, deviations and shares of the classes and a bias field exp(polynomial of `bias_degree`) are
/// estimated together by expectation-maximisation (Wells et al. 1996, Van Leemput et al. 1999) on at most 100000 evenly chosen samples
/// (averaged with their neighbours for the bias, which noise must not influence; then unsmoothed for means, deviations and shares), from
/// the optimal split of the histogram; in a mix every proportion is equally likely (Shattuck et al. 2001). Then the shares of every
/// sample are found by mean-field sweeps with a Potts prior of strength `smoothness` over the six neighbours (a neighbour counts by the
/// inverse of its distance).
/// Adds "label" (u8; 0: nothing, background or outside the mask; 1 to classes by rising intensity: the class with the largest
/// share), "fraction_1" ... (f32, expected shares; NaN where nothing is known) and, when estimated, "bias" (f32, geometric mean 1 over
/// tissue), and fields of the whole "class means" and "class deviations" (darkest first, background included). Logs what it found
/// and after how many iterations (stop: the mean log-likelihood rises by less than `tolerance`).
/// Throws Error(usage) when there are fewer different values than classes.
DatasetPtr classify(const DatasetPtr& in, const ClassifyParams& p, Context& context);

}  // namespace sg
