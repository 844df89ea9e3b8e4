// SPDX-License-Identifier: Apache-2.0
// tubes and ribbons: lines with a body.
#pragma once
#include <optional>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct TubesParams {
  std::optional<double> radius;
  FieldName radius_field;
  double ratio = 4;
  int sides = 12;
  bool caps = true;
};
void describe(Schema& s, TubesParams& p);

/// A tube about each line of the mesh (other cells are dropped): rings of `sides` points on frames that do not twist, joined by quads, with
/// point field "Normals" (unit) and all fields carried: those of points to their ring, those of cells to the tube. Radius: `radius`, or
/// from it (where radius_field is least) to ratio times it (where it is largest). Closed lines give closed tubes. Throws Error(usage) for a
/// mesh without lines, and Error(usage) for radii that are not positive.
DatasetPtr tubes(const DatasetPtr& in, const TubesParams& p, Context& context);

struct RibbonsParams {
  std::optional<double> width;
  FieldName width_field;
  double ratio = 4;
  FieldName rotation;
  std::optional<Vec3> normal;
};
void describe(Schema& s, RibbonsParams& p);

/// A flat band along each line, that turns about it as the flow does: by the angle (radians) in `rotation`, on frames that do not twist;
/// streamlines attributes=rotation makes that field, which is taken when it is there. Quads with "Normals", fields as in tubes. The band
/// of a surface's lines may be given its `normal`.
DatasetPtr ribbons(const DatasetPtr& in, const RibbonsParams& p, Context& context);

}  // namespace sg
