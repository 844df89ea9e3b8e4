// SPDX-License-Identifier: Apache-2.0
// Feature edges of a surface, and its silhouette.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct FeatureEdgesParams {
  bool boundary = true, feature = true, non_manifold = true, manifold = false;
  double angle = 30;
};
inline void describe(Schema& s, FeatureEdgesParams& p) {
  s("boundary", p.boundary, "Keep edges of one polygon (open edges).");
  s("feature", p.feature, "Keep edges where two polygons meet at more than the angle.");
  s("non_manifold", p.non_manifold, "Keep edges of three or more polygons.");
  s("manifold", p.manifold, "Keep all other edges of two polygons.");
  s("angle", p.angle, "Smallest angle of a feature edge.").range(0, 180).unit("deg");
}

enum EdgeKind : uint8_t { edge_boundary = 0, edge_non_manifold = 1, edge_feature = 2, edge_manifold = 3 };

/// Lines along the chosen edges, in order of their points, with cell field 'edge type' (u8, EdgeKind) and 'angle' (f64, degrees of the
/// bend; NaN unless there are two polygons). The bend does not depend on how the two polygons are oriented. Point fields
/// are carried, cell fields come from the first polygon of the edge. Other mesh kinds: their surface. O(corners).
DatasetPtr feature_edges(const DatasetPtr& in, const FeatureEdgesParams& p, Context& ctx);

struct SilhouetteParams {
  Vec3 direction{0, 0, 1};
  std::optional<Vec3> from = {};
  bool smooth = true;
  bool boundary = false;
};
inline void describe(Schema& s, SilhouetteParams& p) {
  s("direction", p.direction, "Direction towards the viewer, for parallel projection.");
  s("from", p.from, "Position of the viewer; then 'direction' is not used.").unit("length");
  s("smooth", p.smooth, "Draw lines across triangles, where the point normals turn away; otherwise along edges between polygons.");
  s("boundary", p.boundary, "Add the open edges of the surface.");
}

/// Lines where the surface turns away from the viewer. smooth: the zero set of n.(viewer - x), linear in each triangle, with n the
/// field of role normals, else angle-weighted ones (Hertzmann and Zorin 2000): closed curves on closed surfaces, half an edge
/// length smoother than the triangles. Else: edges between a polygon seen from the front and one seen from behind. Cell field
/// 'edge type' (u8): 4 silhouette, 0 boundary. Point fields are carried. Throws Error(usage) for a direction of no length.
DatasetPtr silhouette(const DatasetPtr& in, const SilhouetteParams& p, Context& ctx);

}  // namespace sg
