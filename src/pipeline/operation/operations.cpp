// SPDX-License-Identifier: Apache-2.0
// The table of operations, made of operations.def, and what some of them need beside a function.
#include "pipeline/operation/operation_table.h"

#include "io/io.h"

#define SG_OPERATION_HEADERS
#include "pipeline/operation/operations.def"
#undef SG_OPERATION_HEADERS

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

// What several rows say of the kinds that they take.
constexpr auto takes_lines = takes(kinds::with_cells - kinds::amr, "streamlines, isolines, feature_edges or slice of a surface make lines");
constexpr auto takes_solids = takes(kinds::solids, "in a plane and on surfaces the counterpart is a point: critical_points");

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
