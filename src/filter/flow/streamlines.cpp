// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/streamlines.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/random.h"
#include "data/trusted.h"
#include "filter/flow/geographic.h"
#include "filter/flow/line_attributes.h"
#include "filter/flow/line_mesh.h"
#include "filter/flow/seeds/noise_speed.h"

namespace sg {

void describe(Schema& s, StreamlinesParams& p) {
  s("field", p.field, "Velocity: point or cell field of 2 or 3 components; default: the active vectors.").takes(fields::vectors);
  s("direction", p.direction, "Trace along the flow, against it, or both ways from each seed as one line.");
  describe(s, p.integration);
  describe(s, p.stop);
  describe(s, p.seeds);
  s("geographic", p.geographic, "x and y are in degrees and the velocity is in m/s: convert it (times in seconds, lengths in degrees).");
  s("attributes", p.attributes,
    "Fields of the lines besides speed, time, length and velocity: the mesh's other fields; the vorticity; the rotation of the flow about "
    "the line.");
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
  if (in > 0) return "the flow has no value there (hidden cells, holes or NaN)";
  return fmt::format("the mesh extends over x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g}", b.lo.x, b.hi.x, b.lo.y, b.hi.y,
                     b.lo.z, b.hi.z);
}

// How many of these lines can still be distinguished, lines of a default picture drawn on the box that they fill: those that cover a good
// half of its shadow in space, two fifths of it when flat.
size_t most_apart(const Dataset& lines, const std::string& velocity, const Box3& box) {
  const Vec3 e = box.size();
  const bool flat = std::min({e.x, e.y, e.z}) < 1e-6 * box.diagonal();
  const double shadow = (e.x * e.y + e.y * e.z + e.z * e.x) * (flat ? 0.4 : 0.3), width = box.diagonal() / 400;
  const auto& all = lines.as<SurfaceMesh>()->lines;
  const View<float> arc = lines.fields().require(own_value("length", velocity), Association::point).array.view<float>();
  double sum = 0;
  size_t n = 0;
  while (n < all.size() && sum * width < shadow) {
    const auto first = size_t(all.offsets.get(n)), last = size_t(all.offsets.get(n + 1)) - 1;
    sum += double(arc[last]) - double(arc[first]), ++n;
  }
  return std::max<size_t>(n, 10);
}

Data converted(const Data& data, std::string field) {
  flow_meshes(data, field, "streamlines");
  return geographic_flow(data, field, 1, "streamlines");
}

}  // namespace

Data streamlines(const std::vector<Data>& inputs, const StreamlinesParams& p, Context& context) {
  const FlowParts parts(p.geographic ? converted(inputs[0], p.field.name) : inputs[0], p.field.name, "streamlines", context);
  if (!p.geographic) warn_of_degrees(*parts.fields().front().dataset(), parts.fields().front().field(), "streamlines", context);
  const double largest = parts.largest_speed();
  if (!(largest > 0)) fail_usage(fmt::format("field '{}' is zero or NaN everywhere: there is no flow", parts.name()), "streamlines");
  StopParams stop = p.stop;
  // Lines that circle would fill the picture.
  if (!stop.max_length && !stop.max_time) stop.max_length = 1.5 * parts.bounds().diagonal();
  if (stop.min_speed == StopParams().min_speed)  // not given
    for (const FlowField& f : parts.fields())
      if (noise_speed(*f.dataset(), f.dataset()->fields().require(parts.name())) > 0) {
        stop.min_speed = 0.02;
        context.info(fmt::format(
            "most of '{}' is noise: lines end where the speed is below 2 % of its largest value; min_speed=0 shows all", parts.name()));
        break;
      }
  const TraceOptions options = trace_options(p.integration, stop, largest);
  std::vector<DatasetPtr> meshes;
  for (const FlowField& f : parts.fields()) meshes.push_back(f.dataset());
  PartsCursor cursor(parts);
  // Seeds without a given place go where the flow is strong: into vessels, not into the still parts around them.
  double much = 0;
  uint64_t asked = 0;
  const bool chosen = p.seeds.seeds.has_value();
  const SeedPlace flows = [&](Vec3 x) {
    Vec3 v;
    const double chance = random_unit(uint64_t(p.seeds.random_seed) + 17, asked++);
    if (!cursor(x, v)) return false;
    if (!(much > 0)) much = parts.mean_speed();
    const double s = length(v) / much;
    return chosen ? s > 0 : chance < s * s && length(v) > options.min_speed;
  };
  std::vector<Vec3> at = make_seeds(p.seeds, meshes, seed_mesh_of(inputs, "streamlines"), flows, context);
  const std::string& unit = parts.fields().front().field().unit;
  const auto trace = [&](std::span<const Vec3> from) {
    if (parts.count() == 1)
      if (const auto by_packets = packets::trace(parts.fields().front(), from, p.direction, options, context))
        return lines_dataset(*by_packets, parts.name(), unit);
    return lines_dataset(trace_lines(parts, from, p.direction, options, context), parts.name(), unit);
  };
  DatasetPtr lines = trace(at);
  if (p.seeds.count == 0 && seed_kind(p.seeds, inputs.size() > 1) == SeedKind::random)
    if (const size_t most = most_apart(*lines, parts.name(), parts.bounds()); most < lines->cell_count()) {
      const int64_t last = lines->fields().require("seed", Association::cell).array.view<int64_t>()[most - 1];
      context.info(
          fmt::format("streamlines: {} of {}, as many as can be told apart; count= sets another number", most, lines->cell_count()));
      at.resize(size_t(last) + 1);
      lines = trace(at);
    }
  const size_t count = lines->cell_count();
  if (count == 0) fail_usage(fmt::format("none of {} seeds lies in the flow", at.size()), "streamlines", no_line_hint(parts, at));
  if (count < at.size()) context.info(fmt::format("streamlines: {} of {} seeds lie outside the flow", at.size() - count, at.size()));
  DatasetParts out = lines->parts();
  out.time = meshes.front()->time();
  const auto add = [&](const FieldSet& more) {
    for (const Field& f : more)
      if (!out.fields.find(f.name, f.association)) out.fields.add(f);
  };
  const auto wanted = [&](LineAttribute a) { return std::find(p.attributes.begin(), p.attributes.end(), a) != p.attributes.end(); };
  const bool vorticity = wanted(LineAttribute::vorticity), rotation = wanted(LineAttribute::rotation);
  if (vorticity || rotation) add(rotation_along(parts, *lines, parts.name(), vorticity, rotation, context));
  if (wanted(LineAttribute::fields)) add(fields_along(parts, *lines, parts.name(), context));
  const DatasetPtr traced = make_trusted_dataset(std::move(out));
  return p.geographic ? in_metres(traced, parts.name(), 1) : traced;
}

}  // namespace sg
