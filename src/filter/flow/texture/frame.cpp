// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/frame.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/flow/flow_field.h"
#include "filter/probe/probe.h"
#include "filter/probe/resample.h"

namespace sg::texture {

namespace {

constexpr double flat_enough = 1e-9;

// Points along each axis for pixels as square as whole numbers allow.
std::array<size_t, 3> wanted_dims(const double* extent, const size_t* own, int64_t resolution, int dimension) {
  const double longest = std::max({extent[0], extent[1], extent[2]});
  size_t most = 1;
  double finest = HUGE_VAL;  // the input's own
  for (int a = 0; a < 3; ++a)
    if (extent[a] > flat_enough * longest) {
      if (own[a] > 1) finest = std::min(finest, extent[a] / double(own[a] - 1));
      most = std::max(most, own[a]);
    }
  const int64_t least = dimension == 2 ? 1024 : 128;
  double pitch = 0;
  if (resolution > 0) pitch = longest / double(resolution - 1);
  else if (std::isfinite(finest)) pitch = finest / std::max(1.0, std::ceil(double(least - 1) / (longest / finest) - 1e-6));
  else pitch = longest / double(least - 1);
  std::array<size_t, 3> dims{1, 1, 1};
  for (int a = 0; a < 3; ++a)
    if (extent[a] > flat_enough * longest) dims[size_t(a)] = size_t(std::clamp(std::llround(extent[a] / pitch) + 1, 2LL, 1LL << 31));
  return dims;
}

// The grid over the input's box; a uniform grid keeps its directions.
struct Target {
  UniformGrid grid;
  bool same = false;
  double pixels_per_cell = HUGE_VAL;
};

Target target_grid(const Dataset& d, int64_t resolution, std::string_view who) {
  Target t;
  double extent[3];
  size_t own[3] = {1, 1, 1};
  if (is_lattice(d.mesh())) std::copy_n(lattice_dims(d.mesh()).data(), 3, own);
  const auto* u = d.as<UniformGrid>();
  const Box3 box = d.bounds();
  if (box.empty() || !std::isfinite(box.diagonal()) || d.cell_count() == 0)
    fail_usage(fmt::format("a mesh of kind {} with {} cells cannot carry a texture", d.kind(), d.cell_count()), std::string(who));
  for (int a = 0; a < 3; ++a) extent[a] = u ? std::abs(u->spacing[a]) * double(own[a] - 1) : box.size()[a];
  const double longest = std::max({extent[0], extent[1], extent[2]});
  int axes = 0;
  for (int a = 0; a < 3; ++a) {
    if (!(extent[a] > flat_enough * longest)) extent[a] = 0, own[a] = std::min<size_t>(own[a], u || d.as<RectilinearGrid>() ? 1 : own[a]);
    axes += extent[a] > 0;
  }
  if (axes < 2) fail_usage("the data extends along one axis only", std::string(who), "use a flat or a solid mesh");
  if (!u && !d.as<RectilinearGrid>()) {
    // The numbers of points along the axes of a curved grid, or of cells, say little about pixels: their density decides.
    const double per_axis = std::pow(double(d.point_count()), 1.0 / axes);
    for (int a = 0; a < 3; ++a) own[a] = extent[a] > 0 ? std::max<size_t>(2, size_t(per_axis * extent[a] / longest)) : 1;
  }
  const auto dims = wanted_dims(extent, own, resolution, axes);
  double points = 1;
  for (const size_t n : dims) points *= double(n);
  if (points >= 2147483648.0)
    fail_usage(fmt::format("the texture would have {:.3g} pixels", points), std::string(who),
               "at most 2^31 are allowed: use a smaller resolution");
  t.same = u && dims == u->dims;
  if (t.same) {
    double least = HUGE_VAL, most = 0;
    for (int a = 0; a < 3; ++a)
      if (dims[size_t(a)] > 1) least = std::min(least, std::abs(u->spacing[a])), most = std::max(most, std::abs(u->spacing[a]));
    t.same = most <= 1.02 * least;
  }
  if (t.same) {
    t.grid = *u;
    return t;
  }
  t.grid.dims = dims;
  t.grid.origin = u ? u->origin : box.lo;
  if (u) t.grid.direction = u->direction;
  for (int a = 0; a < 3; ++a) {
    t.grid.spacing[a] = dims[size_t(a)] > 1 ? extent[a] / double(dims[size_t(a)] - 1) : 1.0;
    if (own[a] > 1 && extent[a] > 0) t.pixels_per_cell = std::min(t.pixels_per_cell, double(dims[size_t(a)] - 1) / double(own[a] - 1));
    if (u && u->spacing[a] < 0) t.grid.spacing[a] = -t.grid.spacing[a];
  }
  return t;
}

// The fields of d at the points of the grid. A uniform grid is taken in its own frame, so that turned ones need no search.
FieldSet fields_on(const DatasetPtr& d, const UniformGrid& grid, Context& context) {
  DatasetPtr from = d;
  UniformGrid to = grid;
  if (const auto* u = d->as<UniformGrid>()) {
    DatasetParts parts = d->parts();
    UniformGrid plain = *u;
    plain.origin = {0, 0, 0}, plain.direction = {};
    for (int a = 0; a < 3; ++a) plain.spacing[a] = std::abs(plain.spacing[a]), to.spacing[a] = std::abs(to.spacing[a]);
    parts.mesh = plain;
    from = make_dataset(std::move(parts));
    to.origin = {0, 0, 0}, to.direction = {};
  }
  const DatasetPtr at = probe(make_dataset(to), from, {}, context);
  return at->fields();
}

Array cells_without_value(const UniformGrid& grid, const Field& valid) {
  const View<uint8_t> v = valid.array.view<uint8_t>();
  size_t missing = 0;
  for (size_t i = 0; i < v.count; ++i) missing += v[i] == 0;
  if (missing == 0) return {};
  const auto& n = grid.dims;
  const size_t cx = std::max<size_t>(n[0], 2) - 1, cy = std::max<size_t>(n[1], 2) - 1, cz = std::max<size_t>(n[2], 2) - 1;
  uint8_t* out = nullptr;
  Array a = Array::make<uint8_t>(cx * cy * cz, 1, &out);
  parallel_for(cy * cz, 16, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t i = 0; i < cx; ++i) {
        bool all = true;
        for (size_t c = 0; c < 8; ++c) {
          const size_t x = i + (c & 1), y = row % cy + (c >> 1 & 1), z = row / cy + (c >> 2);
          if (x < n[0] && y < n[1] && z < n[2]) all = all && v[x + n[0] * (y + n[1] * z)] != 0;
        }
        out[row * cx + i] = all ? 0 : uint8_t(ghost_hidden_cell);
      }
  });
  return a;
}

}  // namespace

bool has_room(const Dataset& d) {
  const Box3 box = d.bounds();
  if (box.empty() || d.cell_count() == 0) return false;
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  if ((size.x > flat_enough * longest) + (size.y > flat_enough * longest) + (size.z > flat_enough * longest) < 2) return false;
  // Curves in a plane have an extent too.
  const auto types = cell_type_counts(d.mesh());
  return std::any_of(types.begin(), types.end(),
                     [](const auto& t) { return t.first.find("Line") == t.first.npos && t.first.find("Vertex") == t.first.npos; });
}

Vec3 Frame::to_pixels(Vec3 world) const {
  const Vec3 d = world - grid.origin;
  Vec3 p;
  for (int a = 0; a < dimension; ++a) p[a] = dot(grid.direction.column(axis[a]), d) / grid.spacing[axis[a]];
  return p;
}

Frame make_frame(const DatasetPtr& input, const std::string& field, int64_t resolution, std::string_view who, Context& context) {
  const Field* named = &flow_field_of(*input, field, who);
  Frame f;
  f.velocity_name = named->name;
  f.time = input->time(), f.notes = input->notes();
  DatasetPtr data = input;
  if (named->association == Association::cell) {
    const DatasetPtr averaged = cell_to_point(input, {{named->name}}, context);
    DatasetParts parts = input->parts();
    Field v = averaged->fields().require(named->name, Association::point);
    parts.fields.remove(named->name, Association::cell);
    parts.fields.add(std::move(v));
    data = make_dataset(std::move(parts));
  }
  const Target target = target_grid(*data, resolution, who);
  f.grid = target.grid;
  if (!target.same && std::isfinite(target.pixels_per_cell)) f.pixels_per_cell = std::max(1.0, target.pixels_per_cell);
  f.dimension = 0;
  for (int a = 0; a < 3; ++a)
    if (f.grid.dims[size_t(a)] > 1) {
      f.axis[f.dimension] = a, f.n[f.dimension] = int32_t(f.grid.dims[size_t(a)]), f.pitch[f.dimension] = std::abs(f.grid.spacing[a]);
      ++f.dimension;
    }
  if (target.same) {
    f.fields = data->fields();
    f.hidden_cells = data->cell_ghost();
  } else {
    context.info(fmt::format("{}: sampled on {} x {}{} points", who, f.n[0], f.n[1], f.dimension == 3 ? fmt::format(" x {}", f.n[2]) : ""));
    f.fields = fields_on(data, f.grid, context);
    const Field valid = f.fields.require("valid", Association::point);
    if (!data->fields().find("valid", Association::point)) f.fields.remove("valid", Association::point);
    f.hidden_cells = cells_without_value(f.grid, valid);
    const View<uint8_t> v = valid.array.view<uint8_t>();
    size_t held = 0;
    for (size_t i = 0; i < v.count; ++i) held += v[i] != 0;
    if (held == 0)
      fail_usage(fmt::format("no point of the grid lies in the mesh of {}", data->kind()), std::string(who),
                 "flat data must lie in a plane across an axis, solid data must have volume cells; for curved surfaces use surface_lic");
  }
  return f;
}

void velocity_of(const Frame& f, size_t begin, size_t end, float* out) {
  const Field& v = f.fields.require(f.velocity_name, Association::point);
  const int components = v.components(), d = f.dimension;
  if (f.grid.direction == Mat3()) {
    // The usual case: the grid's axes are the world's.
    float scale[3];
    int axis[3];
    for (int a = 0; a < d; ++a) axis[a] = f.axis[a], scale[a] = axis[a] < components ? float(1 / f.grid.spacing[axis[a]]) : 0.0f;
    for (int a = 0; a < d; ++a) axis[a] = std::min(axis[a], components - 1);
    dispatch(v.array, [&](auto view) {
      const bool packed = view.packed();
      const auto* x = view.data;
      if (packed && d == 2)
        for (size_t i = begin; i < end; ++i, out += 2) {
          const auto* u = x + i * size_t(components);
          out[0] = float(u[axis[0]]) * scale[0], out[1] = float(u[axis[1]]) * scale[1];
        }
      else
        for (size_t i = begin; i < end; ++i, out += d)
          for (int a = 0; a < d; ++a) out[a] = float(view(i, axis[a])) * scale[a];
    });
    return;
  }
  Vec3 along[3];
  for (int a = 0; a < d; ++a) along[a] = f.grid.direction.column(f.axis[a]) / f.grid.spacing[f.axis[a]];
  dispatch(v.array, [&](auto view) {
    for (size_t i = begin; i < end; ++i, out += d) {
      const Vec3 x{double(view(i, 0)), double(view(i, 1)), components > 2 ? double(view(i, 2)) : 0.0};
      for (int a = 0; a < d; ++a) out[a] = float(dot(along[a], x));
    }
  });
}

Plane<float> velocity_of(const Frame& f, const Context& context) {
  Plane<float> v(f.size() * size_t(f.dimension));
  parallel_for(
      f.size(), 1 << 14, [&](size_t begin, size_t end) { velocity_of(f, begin, end, &v[begin * size_t(f.dimension)]); }, &context);
  return v;
}

DatasetPtr frame_dataset(const Frame& f, std::vector<Field> more) {
  DatasetParts parts;
  parts.mesh = f.grid;
  parts.fields = f.fields;
  for (Field& field : more) parts.fields.add(std::move(field));
  parts.cell_ghost = f.hidden_cells;
  parts.time = f.time, parts.notes = f.notes;
  return make_dataset(std::move(parts));
}

Array field_on_frame(const Frame& f, const DatasetPtr& from, const Field& field, std::string_view who) {
  Context context;
  Field taken = field;
  if (!(from->as<UniformGrid>() && field.association == Association::point && field.array.count() == f.size())) {
    const auto* u = from->as<UniformGrid>();
    if (!u) fail_usage(fmt::format("an image must be a uniform grid, not {}", from->kind()), std::string(who), "use resample to make one");
    // The picture is stretched over the frame, first axis to first axis.
    UniformGrid plain;
    std::vector<size_t> sides;
    for (const size_t n : u->dims)
      if (n > 1) sides.push_back(n);
    if (sides.size() != size_t(f.dimension))
      fail_usage(fmt::format("the image has {} axes, the flow {}", sides.size(), f.dimension), std::string(who));
    UniformGrid to;
    for (size_t a = 0; a < sides.size(); ++a) {
      plain.dims[a] = sides[a], to.dims[a] = size_t(f.n[a]);
      to.spacing[int(a)] = double(sides[a] - 1) / double(f.n[a] - 1);
    }
    DatasetParts parts;
    parts.mesh = plain;
    parts.fields.add(field);
    const DatasetPtr at = probe(make_dataset(to), make_dataset(std::move(parts)), {}, context);
    taken = at->fields().require(field.name);
  }
  return taken.array.converted(ElementType::f32).made_packed();
}

}  // namespace sg::texture
