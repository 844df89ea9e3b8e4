// SPDX-License-Identifier: Apache-2.0
// The one place that knows all operations: their headers here, one line each in operations.def.
#include "pipeline/operation/operation_table.h"

#include "filter/field/basics.h"
#include "filter/field/calc/calc.h"
#include "filter/field/derivatives/derivatives.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/field/join_fields.h"
#include "filter/field/sampling/gaussian_smooth.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/field/sampling/resize.h"
#include "filter/flow/fronts/stream_surface.h"
#include "filter/flow/fronts/unsteady_surfaces.h"
#include "filter/flow/lines/even_streamlines.h"
#include "filter/flow/lines/tubes.h"
#include "filter/flow/seeds/seeds.h"
#include "filter/flow/streamlines.h"
#include "filter/flow/texture/advect.h"
#include "filter/flow/texture/lic.h"
#include "filter/flow/texture/spot_noise.h"
#include "filter/flow/texture/surface/surface_lic.h"
#include "filter/flow/topology/closed_orbits.h"
#include "filter/flow/topology/critical_points.h"
#include "filter/flow/topology/separatrices.h"
#include "filter/flow/topology/topology.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/streaklines.h"
#include "filter/flow/unsteady/timelines.h"
#include "filter/flow/vortex/core_lines.h"
#include "filter/flow/vortex/ftle.h"
#include "filter/flow/vortex/measures.h"
#include "filter/flow/vortex/parallel_vectors.h"
#include "filter/flow/vortex/ridges.h"
#include "filter/flow/vortex/shear_lines.h"
#include "filter/glyph/choose.h"
#include "filter/glyph/trails.h"
#include "filter/mesh/append.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/select/components.h"
#include "filter/mesh/select/crop.h"
#include "filter/mesh/select/extract_ids.h"
#include "filter/mesh/select/piece.h"
#include "filter/mesh/select/threshold.h"
#include "filter/mesh/slice/slice.h"
#include "filter/mesh/tessellate_cells.h"
#include "filter/mesh/to_unstructured.h"
#include "filter/mesh/transform/transform.h"
#include "filter/probe/probe.h"
#include "filter/probe/resample.h"
#include "filter/scalar/bands.h"
#include "filter/scalar/contour/contour.h"
#include "filter/scalar/isolines.h"
#include "filter/scalar/line_labels.h"
#include "filter/segment/classify.h"
#include "filter/segment/dice.h"
#include "filter/segment/distance_map.h"
#include "filter/segment/label_components.h"
#include "filter/segment/label_surface.h"
#include "filter/segment/morphology.h"
#include "filter/segment/otsu.h"
#include "filter/segment/region_grow.h"
#include "filter/segment/watershed.h"
#include "filter/stats/integrate.h"
#include "filter/stats/statistics.h"
#include "filter/stats/table_to_points.h"
#include "filter/surface/cap.h"
#include "filter/surface/clean.h"
#include "filter/surface/curvature.h"
#include "filter/surface/feature_edges.h"
#include "filter/surface/mass_properties.h"
#include "filter/surface/normals.h"
#include "filter/surface/quality.h"
#include "filter/surface/smooth.h"
#include "filter/surface/surfels.h"
#include "filter/tensor/degenerate/degenerate_lines.h"
#include "filter/tensor/degenerate/degenerate_points.h"
#include "filter/tensor/diffusion/tensor_fit.h"
#include "filter/tensor/glyphs/tensor_glyphs.h"
#include "filter/tensor/lines/hyperstreamlines.h"
#include "filter/tensor/lines/tensor_lic.h"
#include "filter/tensor/lines/tractography.h"
#include "filter/tensor/stress_measures.h"
#include "filter/tensor/tensor_measures.h"
#include "io/io.h"
#include "pipeline/file/gradient_images.h"
#include "simulate/drift.h"
#include "simulate/flow_fields.h"
#include "simulate/point_load.h"
#include "simulate/scalar_fields.h"
#include "simulate/tissue_phantom.h"

// Headers of the operations, sorted.

namespace sg {

namespace {

// Beside the fields wanted, those that its lists name.
Request request_of_transform(const ParamSet& params, const Request& wanted) {
  Request r = detail::request_carried(params, wanted);
  const FieldLawParams& p = params.as<TransformParams>().fields;
  for (const auto* names : {&p.turn, &p.keep, &p.gradients, &p.axial})
    for (const std::string& name : *names) add_field(r, name);
  return r;
}

// A plane across an axis at a known place needs the cells around it alone.
Request request_of_slice(const ParamSet& params, const Request& wanted) {
  Request r = detail::request_carried(params, wanted);
  const auto& p = params.as<SliceParams>();
  if (!p.function.empty()) return Request{};
  if (!p.positions.empty() || p.planes != CutPlanes::none) return r;
  int axis = axis_number(p.axis);
  std::optional<double> at = p.position;
  if (axis < 0 && p.origin)
    for (int a = 0; a < 3; ++a)
      if (p.normal[a] != 0 && p.normal[(a + 1) % 3] == 0 && p.normal[(a + 2) % 3] == 0) axis = a, at = (*p.origin)[a];
  if (axis < 0 || !at) return r;
  Box3 box{{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};
  box.lo[axis] = box.hi[axis] = *at;
  r.region = box;
  return r;
}

// Operations that take a mesh to cut with as an optional second input.
template <class P, class F>
Data with_second_mesh(std::string_view name, const std::vector<Data>& in, const P& p, Context& ctx, F f) {
  const DatasetPtr second = in.size() > 1 ? single_dataset(in[1], name) : nullptr;
  return map_parts(in[0], name, ctx, [&](const DatasetPtr& d, Context& part) -> Data { return f(d, second, p, part); });
}

Data clip_with(const std::vector<Data>& in, const ClipParams& p, Context& ctx) {
  return with_second_mesh("clip", in, p, ctx, [](auto&&... a) { return clip(a...); });
}

Data slice_by(const std::vector<Data>& in, const SliceParams& p, Context& ctx) {
  return with_second_mesh("slice", in, p, ctx, [](auto&&... a) { return slice(a...); });
}

Data hyperstreamlines_from(const std::vector<Data>& in, const HyperstreamlinesParams& p, Context& ctx) {
  return with_second_mesh("hyperstreamlines", in, p, ctx, [](auto&&... a) { return hyperstreamlines(a...); });
}

Data tractography_from(const std::vector<Data>& in, const TractographyParams& p, Context& ctx) {
  return with_second_mesh("tractography", in, p, ctx, [](auto&&... a) { return tractography(a...); });
}

// An expression may name any field.
Request request_of_clip(const ParamSet& params, const Request& wanted) {
  Request r = detail::request_carried(params, wanted);
  const auto& p = params.as<ClipParams>();
  if (!p.function.empty()) return Request{};
  return r;
}

Request request_of_extract(const ParamSet& params, const Request& wanted) {
  const auto& p = params.as<ExtractParams>();
  return p.region.function.empty() ? detail::request_carried(params, wanted) : Request{};
}

}  // namespace

std::span<const Operation> operations() {
  set_shape_reader([](const std::string& path, Context& context) { return single_dataset(read_data(path, {}, context), "glyphs"); });
  // The first entry only keeps the array from being empty.
  static constexpr Operation table[] = {
      Operation{},
#include "pipeline/operation/operations.def"
  };
  return std::span<const Operation>(table).subspan(1);
}

}  // namespace sg
