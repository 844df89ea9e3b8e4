// SPDX-License-Identifier: Apache-2.0
// The table of operations, made of operations.def, and what some of them need beside a function.
#include "pipeline/operation/operation_table.h"

#include <fmt/format.h>

#include "base/text/text.h"
#include "io/io.h"

#define SG_OPERATION_HEADERS
#include "pipeline/operation/operations.def"
#undef SG_OPERATION_HEADERS

namespace sg {

namespace {

void add_names_in(const std::string& expression, Request& up) {
  for (const std::string& name : names_in_expression(expression)) add_field(up, name);
}

// The fields that a function names; a field of the name of a coordinate goes before it.
void ask_of_shape(const ImplicitParams& p, Request& up) {
  if (p.function.empty()) return;
  add_names_in(p.function, up);
  add_field(up, "x"), add_field(up, "y"), add_field(up, "z");
}

// A plane whose place is not stated goes through the middle of the data.
bool chooses_plane(const ImplicitParams& p) {
  if (names_shape(p)) return false;
  if (p.planes != CutPlanes::none || p.axis == CutAxis::none) return !p.origin;
  return !p.position && p.positions.empty();
}

bool slice_chooses(const ParamSet& params) { return chooses_plane(params.as<SliceParams>()); }

bool clip_chooses(const ParamSet& params) {
  const auto& p = params.as<ClipParams>();
  return p.field.empty() && !p.value ? chooses_plane(p) : !p.value;
}

// Of two limits one may be enough, which divides bent cells otherwise.
bool isovolume_chooses(const ParamSet& params) {
  const auto& p = params.as<IsovolumeParams>();
  return p.min && p.max;
}

template <class P, std::vector<double> (*choose)(const Dataset&, const P&, const Context&)>
std::string chosen_values(const Dataset& data, const ParamSet& params, const Context& context) {
  std::vector<std::string> numbers;
  for (const double v : choose(data, params.as<P>(), context)) numbers.push_back(exact_number(v));
  return fmt::format("{}", fmt::join(numbers, ","));
}
std::string chosen_scale(const Dataset& data, const ParamSet& params, const Context& context) {
  return exact_number(choose_warp_scale(data, params.as<WarpParams>(), context));
}

void ask_of_calc(const ParamSet& params, const Request&, size_t, Request& up) { add_names_in(params.as<CalcParams>().expr, up); }

void ask_of_mesh_heat(const ParamSet& params, const Request&, size_t, Request& up) {
  const auto& p = params.as<HeatOnMeshParams>();
  for (const std::string* e : {&p.initial, &p.held, &p.value, &p.source, &p.diffusivity}) add_names_in(*e, up);
}

// What is not kept is not needed, but has to be there.
void ask_of_select(const ParamSet& params, const Request&, size_t, Request& up) {
  const auto& p = params.as<SelectParams>();
  if (!p.keep.empty()) up.all_fields = false, up.fields.clear();
  for (const auto* names : {&p.keep, &p.drop})
    for (const std::string& name : *names) add_field(up, name);
}

// A scalar is displaced along the normals of its surface, which are a field.
void ask_of_warp(const ParamSet& params, const Request&, size_t, Request& up) {
  if (!params.as<WarpParams>().direction) up.all_fields = true, up.fields.clear();
}

// Roles in the result depend on all fields of the first.
void ask_of_join_fields(const ParamSet& params, const Request&, size_t input, Request& up) {
  if (const auto& p = params.as<JoinFieldsParams>(); input == 0 || p.fields.empty()) up.all_fields = true, up.fields.clear();
  else up = Request::only(p.fields, up);
}

// A plane across an axis at a known place needs the cells around it alone.
void ask_of_slice(const ParamSet& params, const Request&, size_t input, Request& up) {
  const auto& p = params.as<SliceParams>();
  if (input > 0) return;
  ask_of_shape(p, up);
  if (!p.function.empty() || !p.positions.empty() || p.planes != CutPlanes::none) return;
  int axis = axis_number(p.axis);
  std::optional<double> at = p.position;
  if (axis < 0 && p.origin)
    for (int a = 0; a < 3; ++a)
      if (p.normal[a] != 0 && p.normal[(a + 1) % 3] == 0 && p.normal[(a + 2) % 3] == 0) axis = a, at = (*p.origin)[a];
  if (axis < 0 || !at) return;
  Box3 box{{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL, HUGE_VAL}};
  box.lo[axis] = box.hi[axis] = *at;
  up.region = box;
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

void ask_of_clip(const ParamSet& params, const Request&, size_t input, Request& up) {
  const auto& p = params.as<ClipParams>();
  if (input > 0) return;
  ask_of_shape(p, up);
  // A value alone is one of the active scalar.
  if (p.value && p.field.empty()) up.all_fields = true, up.fields.clear();
}

void ask_of_extract(const ParamSet& params, const Request&, size_t, Request& up) { ask_of_shape(params.as<ExtractParams>().region, up); }

// The pixels of a picture have values, other seeds are places alone.
void ask_of_seeds(const ParamSet& params, const Request&, size_t input, Request& up) {
  const ParamDecl* seeds = params.schema.find("seeds");
  if (input > 0 && seeds && value_of_word<SeedKind>(param_text(*seeds)) == SeedKind::pixels) up.all_fields = true;
}

// The field of the picture, where there is one.
void ask_of_lic(const ParamSet& params, const Request&, size_t input, Request& up) {
  if (input == 0) return;
  const FieldName& image = params.as<LicParams>().image;
  if (image.empty()) up.all_fields = true;
  else add_field(up, image.name);
}

// Where nobody says what is carried, scalars and colours are.
void ask_of_advect(const ParamSet& params, const Request&, size_t input, Request& up) {
  const auto& p = params.as<AdvectParams>();
  if (input > 0) up = Request::only({}, up);
  if (p.carry.empty()) up.all_fields = true, up.fields.clear();
  for (const std::string& name : p.carry) add_field(up, name);
}

void ask_of_glyphs(const ParamSet& params, const Request&, size_t, Request& up) {
  const auto& p = params.as<GlyphsParams>();
  if (p.size_by && !value_of_word<GlyphSize>(*p.size_by)) add_field(up, *p.size_by);
}

// In a file of gradient images their b-values and directions are fields, unless files are named.
void ask_of_tensor_fit(const ParamSet& params, const Request&, size_t, Request& up) {
  const auto& p = params.as<TensorFitParams>();
  if (p.fields.empty() && p.field.empty()) up.all_fields = true, up.fields.clear();
}

void ask_of_silhouette(const ParamSet& params, const Request&, size_t, Request& up) {
  if (params.as<SilhouetteParams>().smooth) up.all_fields = true, up.fields.clear();  // normals by their role
}

void ask_of_traction(const ParamSet& params, const Request&, size_t, Request& up) {
  if (!params.as<TractionParams>().normal) up.all_fields = true, up.fields.clear();  // normals by their role
}

// Coordinates that are not named are chosen among the columns.
void ask_of_table_to_points(const ParamSet& params, const Request&, size_t, Request& up) {
  const auto& p = params.as<TableToPointsParams>();
  if (p.x.empty() || p.y.empty() || p.z.empty()) up.all_fields = true, up.fields.clear();
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
