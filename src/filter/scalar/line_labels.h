// SPDX-License-Identifier: Apache-2.0
// Where the numbers of contour lines go.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct LineLabelsParams {
  FieldName field = {};
  double spacing = 0;
  double width = 0;
  Vec3 normal{0, 0, 1};
};
inline void describe(Schema& s, LineLabelsParams& p) {
  s("field", p.field, "Field shown by the labels; default: 'contour value', else the active scalar.").takes(fields::scalars);
  s("spacing", p.spacing, "Distance between labels along a line; 0: a third of the diagonal.").at_least(0).unit("length");
  s("width", p.width, "Width of a label; 0: 5 % of the diagonal. Lines shorter than two widths get none.").at_least(0).unit("length");
  s("normal", p.normal, "Direction towards the viewer, from which the text is upright.");
}

/// Right and up of the page for a reader in direction `normal`: up is z, or y for a reader above or below.
std::pair<Vec3, Vec3> label_page(Vec3 normal);

/// Places for labels along the lines of a mesh, as a point cloud: fields 'value' (f64), 'angle' (f64, degrees from the reader's right,
/// above -90 up to 90, so that text is never upside down) and 'line' (i32, number of the joined line), and 'normal' of the whole. Each line
/// (see polylines) is cut into equal stretches of about the spacing; a label is put at the straightest part of its stretch, at ties nearest
/// to its middle, at least 1.2 widths from all earlier labels. Throws Error(usage) for meshes without lines and for a zero normal.
DatasetPtr line_labels(const DatasetPtr& in, const LineLabelsParams& p, Context& ctx);

}  // namespace sg
