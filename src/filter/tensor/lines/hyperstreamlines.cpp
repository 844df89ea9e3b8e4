// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/lines/hyperstreamlines.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/cells/point_positions.h"
#include "data/field_ops.h"
#include "filter/tensor/lines/line_sections.h"

namespace sg {

namespace {

std::vector<Vec3> seeds_for(const DatasetPtr& in, const DatasetPtr& seeds, const HyperstreamlinesParams& p) {
  if (seeds) {
    const Array xyz = point_positions(seeds->mesh());
    std::vector<Vec3> r(xyz.count());
    for (size_t i = 0; i < r.size(); ++i) r[i] = {xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)};
    return r;
  }
  return p.seeds.empty() ? even_places(in->bounds(), p.count) : listed_places(p.seeds, "hyperstreamlines");
}

// One number a line point, each `repeat` times.
template <class F>
Field along(const TensorLines& lines, std::string name, size_t repeat, std::string unit, Role role, F&& f) {
  float* out = nullptr;
  Array a = Array::make<float>(lines.points.size() * repeat, 1, &out);
  for (size_t i = 0; i < lines.points.size(); ++i) std::fill_n(out + i * repeat, repeat, float(f(i)));
  return {std::move(name), Association::point, a, std::move(unit), role};
}

void add_line_fields(FieldSet& out, const TensorLines& lines, const std::vector<int64_t>& line_of_cell) {
  std::vector<int64_t> line, seed;
  std::vector<int32_t> stop;
  for (int64_t l : line_of_cell) {
    line.push_back(l), seed.push_back(lines.seed[size_t(l)]);
    stop.push_back(int32_t(lines.stop_forward[size_t(l)]));
  }
  out.add({"line", Association::cell, Array::from_vector(std::move(line)), "", Role::labels});
  out.add({"seed", Association::cell, Array::from_vector(std::move(seed)), "", Role::labels});
  out.add({"stop", Association::cell, Array::from_vector(std::move(stop)), "", Role::labels});
}

std::vector<double> lengths_from_start(const TensorLines& lines) {
  std::vector<double> r(lines.points.size());
  for (size_t l = 0; l < lines.lines(); ++l)
    for (size_t i = lines.begin[l]; i < lines.begin[l + 1]; ++i) r[i] = lines.arc[i] - lines.arc[lines.begin[l]];
  return r;
}

}  // namespace

void describe(Schema& s, HyperstreamlinesParams& p) {
  describe_tensors(s, p.tensors);
  s("eigenvector", p.eigenvector, "Eigenvector to follow; 1 belongs to the largest eigenvalue, 3 to the smallest.").range(1, 3);
  s("seeds", p.seeds, "Seed points x,y,z,x,y,z,...; default: the points of a second input, else a regular lattice.");
  s("count", p.count, "Approximate number of seeds of the regular lattice in the bounding box.").range(1, 1e7);
  s("direction", p.direction, "Direction from a seed; the sign of an eigenvector is a convention (largest component positive).");
  s("section", p.section, "Cross-section of the line: an ellipse or a cross whose half axes are the other two eigenvalues, or none.");
  s("factor", p.factor,
    "Half axes of the cross-section are the absolute eigenvalues times this; default: from the values and the size of the data.")
      .positive();
  s("max_radius", p.max_radius,
    "Larger cross-sections are scaled down to this radius, with their ratio kept; default: 3 % of the diagonal of the data.")
      .positive()
      .unit("length");
  s("min_radius", p.min_radius, "Shorter half axes are drawn at this length; 0: exact; default: 0.1 % of the diagonal of the data.")
      .at_least(0)
      .unit("length");
  s("sides", p.sides, "Number of sides of an elliptic cross-section.").range(3, 256);
  s("step", p.step, "Length of a step.").positive().unit("cells");
  s("max_length", p.max_length, "Maximum length of each half of a line; default: four times the diagonal of the data.")
      .positive()
      .unit("length");
  s("max_steps", p.max_steps, "Maximum number of steps of each half of a line.").range(1, 1e7);
  s("min_gap", p.min_gap, "End a line where its eigenvalue is closer to the next one than this share of the largest absolute eigenvalue.")
      .range(0, 1);
  s("min_eigenvalue", p.min_eigenvalue, "End a line where the absolute value of its eigenvalue is below this.").at_least(0);
  s("interpolation", p.interpolation, "Interpolate the components of the tensor, or its logarithm (positive tensors only).");
  s("fields", p.fields, "Fields of the input to carry along the lines; default: all except the tensors.");
}

DatasetPtr hyperstreamlines(const DatasetPtr& in, const DatasetPtr& second, const HyperstreamlinesParams& p, Context& ctx) {
  const TensorSampler sampler(in, p.tensors, p.interpolation, "hyperstreamlines", ctx);
  if (p.eigenvector > sampler.dimension())
    fail_usage("on a surface there are two eigenvectors", "hyperstreamlines", "choose eigenvector 1 or 2");
  const std::vector<Vec3> seeds = seeds_for(in, second, p);
  const double diagonal = in->bounds().diagonal();
  TensorLineOptions o;
  o.eigenvector = p.eigenvector - 1;
  o.direction = p.direction;
  o.step = p.step, o.max_length = p.max_length.value_or(4 * diagonal), o.max_steps = p.max_steps;
  o.min_gap = p.min_gap, o.min_eigenvalue = p.min_eigenvalue;
  const TensorLines lines = trace_tensor_lines(sampler, seeds, o, ctx);
  if (lines.lines() < seeds.size())
    ctx.info(fmt::format("hyperstreamlines: {} of {} seeds give no line (outside, without a value, or without a unique direction)",
                         seeds.size() - lines.lines(), seeds.size()));

  DatasetParts parts;
  size_t repeat = 1;
  std::vector<int64_t> line_of_cell;
  Array normals;
  if (p.section == TensorSection::line) {
    parts.mesh = lines_as_mesh(lines);
    for (size_t l = 0; l < lines.lines(); ++l)
      if (lines.begin[l + 1] - lines.begin[l] > 1) line_of_cell.push_back(int64_t(l));
  } else {
    SectionOptions s;
    s.shape = p.section == TensorSection::cross ? SectionOptions::Shape::cross : SectionOptions::Shape::ellipse;
    const double usual = usual_half_axis(lines, o.eigenvector);
    s.factor = p.factor.value_or(usual > 0 ? 0.012 * diagonal / usual : 1);
    s.max_radius = p.max_radius.value_or(0.03 * diagonal);
    s.min_radius = p.min_radius.value_or(0.001 * diagonal);
    s.sides = p.sides;
    LineSurface surface = sections_around(lines, o.eigenvector, s, ctx);
    if (!p.factor) ctx.info(fmt::format("hyperstreamlines: factor {:.4g}", s.factor));
    if (surface.limited > 0)
      ctx.info(fmt::format("hyperstreamlines: {} of {} cross-sections are scaled down to max_radius {:.4g}", surface.limited,
                           lines.points.size(), s.max_radius));
    repeat = surface.per_section;
    line_of_cell = std::move(surface.line);
    normals = surface.normals;
    parts.mesh = std::move(surface.mesh);
  }
  const std::string& unit = sampler.tensors().field.unit;
  parts.fields.add(along(lines, "eigenvalue", repeat, unit, Role::scalars, [&](size_t i) { return lines.eigen[i].value[o.eigenvector]; }));
  for (int k = 0; k < 3; ++k)
    parts.fields.add(
        along(lines, fmt::format("eigenvalue {}", k + 1), repeat, unit, Role::none, [&](size_t i) { return lines.eigen[i].value[k]; }));
  const std::vector<double> length = lengths_from_start(lines);
  parts.fields.add(along(lines, "length", repeat, "", Role::none, [&](size_t i) { return length[i]; }));
  if (!normals.empty()) parts.fields.add({"Normals", Association::point, normals, "", Role::normals});
  carry_along(parts.fields, sampler, lines.points, p.fields, repeat, ctx);
  add_line_fields(parts.fields, lines, line_of_cell);
  parts.time = in->time();
  return make_dataset(std::move(parts));
}

}  // namespace sg
