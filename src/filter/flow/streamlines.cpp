// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/streamlines.h"

#include "base/parallel.h"
#include "filter/flow/line_attributes.h"

namespace sg {

void describe(Schema& s, StreamlinesParams& p) {
  s("field", p.field, "Velocity: a point or cell field of 2 or 3 components; default: the active vectors.");
  s("direction", p.direction, "Along the flow, against it, or both from each seed, as one line.").choices({"forward", "backward", "both"});
  describe(s, p.integration);
  describe(s, p.stop);
  describe(s, p.seeds);
  s("attributes", p.attributes,
    "What lines carry beside speed, time, length and velocity: the mesh's other fields; the vorticity; how the flow turns about the line.")
      .choices({"fields", "vorticity", "rotation", "none"});
}

DatasetPtr lines_dataset(const TracedLines& lines, const std::string& velocity_name, const std::string& unit) {
  const size_t n = lines.points.size(), count = lines.lines();
  Box3 box;
  for (const Vec3& p : lines.points) box.add(p);
  SurfaceMesh mesh;
  float *xyz = nullptr, *speed = nullptr, *time = nullptr, *arc = nullptr, *v = nullptr;
  mesh.points.xyz = Array::make<float>(n, 3, &xyz);
  // Small numbers far from zero keep their digits; those about zero stay as they are.
  const Vec3 far = box.empty() ? Vec3() : box.center();
  if (!box.empty() && length(far) > 8 * box.diagonal()) mesh.points.origin = far;
  FieldSet fields;
  fields.add({"speed", Association::point, Array::make<float>(n, 1, &speed), unit, Role::scalars});
  fields.add({velocity_name, Association::point, Array::make<float>(n, 3, &v), unit, Role::vectors});
  fields.add({"time", Association::point, Array::make<float>(n, 1, &time), "", Role::none});
  fields.add({"length", Association::point, Array::make<float>(n, 1, &arc), "", Role::none});
  parallel_for(n, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 x = lines.points[i] - mesh.points.origin;
      for (int a = 0; a < 3; ++a) xyz[3 * i + size_t(a)] = float(x[a]), v[3 * i + size_t(a)] = float(lines.velocity[i][a]);
      speed[i] = float(length(lines.velocity[i])), time[i] = float(lines.time[i]), arc[i] = float(lines.arc[i]);
    }
  });
  std::vector<int64_t> ids(n);
  for (size_t i = 0; i < n; ++i) ids[i] = int64_t(i);
  mesh.lines.connectivity = Array::from_vector(std::move(ids));
  mesh.lines.offsets = Array::from_vector(std::vector<int64_t>(lines.begin.begin(), lines.begin.end()));
  std::vector<uint8_t> stop(count);
  for (size_t i = 0; i < count; ++i) stop[i] = uint8_t(lines.stop[i]);
  fields.add({"seed", Association::cell, Array::from_vector(lines.seed), "", Role::none});
  fields.add({"stop", Association::cell, Array::from_vector(std::move(stop)), "", Role::labels});
  DatasetParts parts{std::move(mesh), std::move(fields), {}, {}, {}, {}};
  std::string words;
  for (int r = 0; r <= int(StopReason::error); ++r) words += fmt::format("{}{} {}", r ? ", " : "", r, stop_reason_name(StopReason(r)));
  parts.notes.emplace_back("stop", words);
  return make_dataset(std::move(parts));
}

namespace {

std::string no_line_hint(const FlowParts& parts, std::span<const Vec3> seeds) {
  const Box3 b = parts.bounds();
  size_t in = 0;
  for (const Vec3& s : seeds) {
    bool all = true;
    for (int a = 0; a < 3; ++a) all = all && s[a] >= b.lo[a] && s[a] <= b.hi[a];
    in += all;
  }
  if (in > 0) return "the flow has no value there: hidden cells, holes, or NaN";
  return fmt::format("the mesh lies in x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g}", b.lo.x, b.hi.x, b.lo.y, b.hi.y, b.lo.z,
                     b.hi.z);
}

}  // namespace

Data streamlines(const std::vector<Data>& inputs, const StreamlinesParams& p, Context& context) {
  const FlowParts parts(inputs[0], p.field.name, "streamlines", context);
  const double largest = parts.largest_speed();
  const TraceOptions options = trace_options(p.integration, p.stop, largest);
  std::vector<DatasetPtr> meshes;
  for (const FlowField& f : parts.fields()) meshes.push_back(f.dataset());
  // Random seeds where something flows: not in the still parts around a vessel.
  PartsCursor cursor(parts);
  const SeedPlace flows = [&](Vec3 x) {
    Vec3 v;
    return cursor(x, v) && (length(v) > 1e-3 * largest || !(largest > 0));
  };
  const std::vector<Vec3> at = make_seeds(p.seeds, meshes, seed_mesh_of(inputs, "streamlines"), flows, context);
  const TraceDirection direction = p.direction == "both"      ? TraceDirection::both
                                   : p.direction == "forward" ? TraceDirection::forward
                                                              : TraceDirection::backward;
  const TracedLines lines = trace_lines(parts, at, direction, options, context);
  if (lines.lines() == 0) fail_usage(fmt::format("none of {} seeds lies in the flow", at.size()), "streamlines", no_line_hint(parts, at));
  if (lines.lines() < at.size())
    context.info(fmt::format("streamlines: {} of {} seeds lie outside the flow", at.size() - lines.lines(), at.size()));
  const DatasetPtr plain = lines_dataset(lines, parts.name(), parts.fields().front().field().unit);
  const auto asked = [&](std::string_view word) { return std::find(p.attributes.begin(), p.attributes.end(), word) != p.attributes.end(); };
  DatasetParts out = plain->parts();
  out.time = meshes.front()->time();
  const auto add = [&](FieldSet more) {
    for (const Field& f : more)
      if (!out.fields.find(f.name, f.association)) out.fields.add(f);
  };
  if (asked("vorticity") || asked("rotation")) add(rotation_along(parts, lines, asked("vorticity"), asked("rotation"), context));
  if (asked("fields")) add(fields_along(parts, lines, parts.name(), context));
  return make_dataset(std::move(out));
}

}  // namespace sg
