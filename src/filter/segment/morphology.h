// SPDX-License-Identifier: Apache-2.0
// Labels grown, shrunk, opened, closed and filled.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

enum class Morphology { erode, dilate, open, close, fill };
constexpr auto enum_words(Morphology) {
  using enum Morphology;
  return std::array{Word{"erode", erode}, Word{"dilate", dilate}, Word{"open", open}, Word{"close", close}, Word{"fill", fill}};
}

struct MorphologyParams {
  FieldName field;
  Morphology operation = Morphology::open;
  std::optional<double> radius;
  double background = 0;
  std::vector<int64_t> labels;
  int64_t max_size = 0;
  std::string name;
};
void describe(Schema& s, MorphologyParams& p);

/// Works on the set of all wanted labels (Serra 1982), with a ball of `radius` in units of length whatever the spacing, by exact distances:
///   erode   removes samples within the radius of a background sample;  dilate  adds those within the radius of the set
///   open    erode, then dilate: removes what is thinner than the ball; close   dilate, then erode: closes gaps thinner than the ball
///   fill    adds the background that is enclosed (6 neighbours), in holes of up to max_size samples (0: any)
/// Added samples take the label of the nearest sample that was in the set, removed ones the background. What lies outside the image or
/// has no value neither grows nor erodes, and keeps what it has. The result has the type and, unless `name` is given, the name of the
/// field. Uniform and rectilinear grids, point or cell fields. Throws Error(usage) for numbers that are not labels.
DatasetPtr morphology(const DatasetPtr& in, const MorphologyParams& p, Context& context);

}  // namespace sg
