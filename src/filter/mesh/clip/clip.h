// SPDX-License-Identifier: Apache-2.0
// Meshes cut along a surface: one side, the other, or both.
#pragma once
#include "filter/mesh/slice/implicit_function.h"

namespace sg {

/// Which side stays.
enum class ClipSide { inside, outside, both };
constexpr auto enum_words(ClipSide) {
  using enum ClipSide;
  return std::array{Word{"inside", inside}, Word{"outside", outside}, Word{"both", both}};
}

struct ClipParams : ImplicitParams {
  FieldName field = {};
  int component = -1;
  std::optional<double> value = {};
  ClipSide keep = ClipSide::inside;
};
inline void describe(Schema& s, ClipParams& p) {
  describe_implicit(s, p);
  s("field", p.field, "Clip by the values of a point field instead of a shape.").takes(fields::on_points);
  s("component", p.component, "Component of the field; -1: the magnitude of a field of several.").at_least(-1);
  s("value", p.value, "With field (or alone, for the active scalar): the inside has at least this value; default: the middle of the range.")
      .unit("@field");
  s("keep", p.keep,
    "Part to keep. inside: behind the plane, within the shape, or at or above the value; outside: the rest; both: a collection of the "
    "two.");
  describe_curved_tolerance(s, p.tolerance);
}

/// The part of a mesh inside a shape (or at least at a value of a field), outside of it, or a collection of both parts, named inside and
/// outside. Cells that are not cut stay as they are, in input order, and come first; cut ones become tetrahedra, pyramids, wedges and
/// hexahedra (triangles, quads, polygons, lines), polyhedra and prisms polyhedra, that share points and faces with their neighbours'. Both
/// sides share the cut, so that their volumes add up to the whole to rounding; cells with bent faces (flat to less than rounding of the
/// coordinates) that are cut fall into pieces over the middles of these faces for it. The function is linear
/// along edges; where a shape is curved, cut points are moved along their edges onto it. A face of four corners of alternating
/// signs is divided by the asymptotic decider, as contour does. A box is cut plane by plane, exactly: its faces, edges and corners are
/// sharp wherever they lie; outside of it, the parts behind the planes follow each other, and where an edge of the box runs through cells a
/// face may meet two. Curved cells are made linear first, to the tolerance (see tessellate). AMR: leaves. A SurfaceMesh stays one, a
/// PointCloud stays one, all others become an UnstructuredMesh. Fields are carried, 'original_cell' added. Ghost cells, and cells with a
/// NaN value, are left out. `surface`: a closed surface or a solid mesh to clip with. Throws Error(usage) for a shape together with a
/// field, cell fields, and what implicit_function() refuses. O(cells), parallel.
Data clip(const DatasetPtr& in, const DatasetPtr& surface, const ClipParams& p, Context& ctx);
inline Data clip(const DatasetPtr& in, const ClipParams& p, Context& ctx) { return clip(in, nullptr, p, ctx); }

struct IsovolumeParams {
  FieldName field = {};
  int component = -1;
  std::optional<double> min = {}, max = {};
  double tolerance = 1e-3;
};
inline void describe(Schema& s, IsovolumeParams& p) {
  s("field", p.field, "Point field; default: the active scalar.").takes(fields::on_points);
  s("component", p.component, "Component of the field; -1: the magnitude of a field of several.").at_least(-1);
  s("min", p.min, "Smallest value to keep; default: no limit.").unit("@field");
  s("max", p.max, "Largest value to keep; default: no limit.").unit("@field");
  describe_curved_tolerance(s, p.tolerance);
}

/// The part of a mesh between two values of a field, cut exactly along both in one pass; results and errors as of clip(). Throws
/// Error(usage) for min above max.
DatasetPtr isovolume(const DatasetPtr& in, const IsovolumeParams& p, Context& ctx);

}  // namespace sg
