// SPDX-License-Identifier: Apache-2.0
// From a scene to flat arrays.
#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/fields/field_component.h"
#include "data/lattice.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/surface.h"
#include "render/prepare/glyph_set.h"
#include "render/prepare/picture_set.h"

namespace sg {

namespace raster {

float linear_light(float v) {
  v = std::clamp(v, 0.0f, 1.0f);
  return v <= 0.04045f ? v / 12.92f : float(std::pow((double(v) + 0.055) / 1.055, 2.4));
}

const Vec4f& ColorSource::of(float stored) const {
  const size_t n = table.size() - 3;
  const auto on_scale = [&] {
    if (!scale->labels.empty()) return scale->position(double(stored) + offset);
    return scale->position(stored == first ? scale->lo : stored == last ? scale->hi : double(stored) + offset);  // as rounded as stored
  };
  const double position = linear ? double((stored - first) * slope) : on_scale();
  if (!(position == position)) return table[n + 2];
  if (position < 0) return table[n];
  if (linear ? (stored - last) * slope > 0 : position > 1) return table[n + 1];
  return table[size_t(std::min(position, 1.0) * double(n - 1) + 0.5)];
}

namespace {

constexpr size_t values_per_chunk = 1 << 15;

const Field& color_field(const Dataset& data, const FieldColor& c, const char* where) {
  if (c.association == Association::whole) fail_usage("colours need a point or cell field, not one of the whole dataset", where);
  const Field& f = with_context("colouring", [&]() -> const Field& { return data.fields().require(c.field, c.association); });
  if (!c.direct && c.component >= f.components())
    fail_usage(fmt::format("field '{}' has {} components; there is no component {}", f.name, f.components(), c.component), where,
               fmt::format("give 0 to {}", f.components() - 1));
  return f;
}

/// Linear RGBA of a direct colour field; `any_alpha` tells whether some alpha is below 1.
Array direct_colors(const Field& f, bool& any_alpha) {
  float* out = nullptr;
  Array colors = Array::make<float>(f.array.count(), 4, &out);
  const double unit = is_float(f.array.type()) ? 1.0 : f.array.type() == ElementType::u16 ? 1 / 65535.0 : 1 / 255.0;
  const int n = f.components();
  any_alpha = dispatch(f.array, [&](auto v) {
    return parallel_reduce<bool>(
        v.count, values_per_chunk, false,
        [&](size_t begin, size_t end) {
          bool alpha = false;
          for (size_t i = begin; i < end; ++i) {
            auto part = [&](int c) { return float(double(v(i, c)) * unit); };
            float* q = out + 4 * i;
            for (int c = 0; c < 3; ++c) q[c] = linear_light(part(n >= 3 ? c : 0));
            q[3] = n == 4 || n == 2 ? std::clamp(part(n - 1), 0.0f, 1.0f) : 1.0f;
            if (!(q[3] >= 1)) alpha = true;
          }
          return alpha;
        },
        [](bool a, bool b) { return a || b; });
  });
  return colors;
}

struct Scalars {
  Array values;
  double offset = 0;
  size_t bytes() const { return values.bytes(); }
};

/// The outer faces of a mesh that is no surface.
struct OuterFaces {
  Skin skin;
  size_t bytes() const {
    size_t sum = 0;
    if (const auto* m = skin.surface->as<SurfaceMesh>()) sum += m->points.xyz.bytes() + m->polygons.connectivity.bytes();
    for (const Field& f : skin.surface->fields()) sum += f.array.bytes();
    return sum;
  }
};

/// f32 numbers without losing the small differences of f64 ones far from zero. Near zero small numbers stay what they are: a logarithmic
/// scale tells them apart.
Scalars scalars_of(const Field& f, int component) {
  check_component(f, component, "color");
  const bool single = f.components() == 1 || component >= 0;
  if (single && f.array.type() == ElementType::f32) return {f.array.component(f.components() == 1 ? 0 : component).made_packed(), 0};
  if (!(f.array.type() == ElementType::f64 || element_size(f.array.type()) >= 4)) return {scalar_of(f, component), 0};
  const Array wide = scalar_of(f, component, ElementType::f64);
  const View<double> v = wide.view<double>();
  const FieldStats stats = field_stats(wide);
  Scalars s;
  const Range& r = stats.range[0];
  constexpr double far = 8;  // times the width of the range
  if (!r.empty() && std::max(std::abs(r.lo), std::abs(r.hi)) > far * (r.hi - r.lo)) s.offset = 0.5 * (r.lo + r.hi);
  if (!std::isfinite(s.offset)) s.offset = 0;
  float* out = nullptr;
  s.values = Array::make<float>(v.count, 1, &out);
  parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out[i] = float(v[i] - s.offset);
  });
  return s;
}

/// Whether a pixel of this field may be left out (out of range and not clamped).
bool may_vanish(const Dataset& data, const Field& f, const FieldColor& c) {
  if (c.scale.clamp) return false;
  const Range r = data.range(f, c.component);
  return !r.empty() && (r.lo < std::min(c.scale.lo, c.scale.hi) || r.hi > std::max(c.scale.lo, c.scale.hi));
}

}  // namespace

ColorSource color_source(const DatasetPtr& data, const std::optional<FieldColor>& color, Vec3f constant, const char* where) {
  ColorSource s;
  if (!color) {
    const Vec3f l = linear_light(constant);
    s.constant = {l.x, l.y, l.z, 1};
    return s;
  }
  const Field& f = color_field(*data, *color, where);
  s.per_cell = color->association == Association::cell;
  const std::string key = fmt::format("{}/{}/{}", f.name, int(f.association), color->component);
  if (color->direct) {
    struct Direct {
      Array colors;
      bool alpha = false;
      size_t bytes() const { return colors.bytes(); }
    };
    const auto d = derived(data, "direct/" + key, [&] {
      Direct r;
      r.colors = direct_colors(f, r.alpha);
      return r;
    });
    s.kind = ColorSource::Kind::direct, s.values = d->colors, s.translucent = d->alpha;
    return s;
  }
  s.kind = ColorSource::Kind::scalar;
  if (f.array.type() == ElementType::f32 && f.components() == 1 && f.array.packed()) s.values = f.array;
  else {
    const auto d = derived(data, "scalar/" + key, [&] { return scalars_of(f, color->component); });
    s.values = d->values, s.offset = d->offset;
  }
  const ColorScale& scale = color->scale;
  s.scale = std::make_shared<const ColorScale>(scale);
  ColorTable t = color_table(scale);
  s.table = std::move(t.linear);
  s.table.push_back(t.below), s.table.push_back(t.above), s.table.push_back(t.nan);
  s.nearest = !scale.labels.empty();
  s.linear = scale.kind == ScaleKind::linear && scale.labels.empty() && std::isfinite(1 / (scale.hi - scale.lo));
  s.first = float(scale.lo - s.offset), s.last = float(scale.hi - s.offset), s.slope = float(1 / (scale.hi - scale.lo));
  s.translucent = may_vanish(*data, f, *color) || t.nan.w < 1;
  return s;
}

namespace {

const SurfaceMesh& surface_mesh(const DatasetPtr& data, const char* what) {
  const SurfaceMesh* m = data->as<SurfaceMesh>();
  if (!m) fail_usage(fmt::format("a {} mesh has no lines of its own", data->kind()), what, "take its edges or streamlines first");
  return *m;
}

/// Lines show little of themselves: brighter in the dark, and glossy, so that their bends are seen.
constexpr Material line_material{0.18f, 0.82f, 0.30f, 40, true};

/// Edges of cells where there is no surface under them, at its outline.
constexpr Vec3f outline_color{0.1f, 0.1f, 0.1f};

float luminance(const float* linear) { return 0.2126f * linear[0] + 0.7152f * linear[1] + 0.0722f * linear[2]; }

/// Edges that stand out from most of a surface.
PreparedItem::Contrast contrast_to(const ColorSource& surface) {
  constexpr size_t most_samples = 4096;
  constexpr float dark = 0.1f;
  using Kind = ColorSource::Kind;
  size_t samples = 0, dark_ones = 0;
  const auto see = [&](const float* color) { ++samples, dark_ones += luminance(color) < dark; };
  const size_t n = surface.kind == Kind::constant ? 0 : surface.values.count(), step = std::max<size_t>(1, n / most_samples);
  if (n == 0) see(&surface.constant.x);
  for (size_t i = 0; i < n; i += step) see(surface.kind == Kind::direct ? surface.data() + 4 * i : &surface.of(surface.data()[i]).x);
  return 2 * dark_ones > samples ? PreparedItem::Contrast::lighter : PreparedItem::Contrast::darker;
}

class Preparation {
 public:
  Preparation(PreparedScene& out, Context& context) : out_(out), context_(context) {}

  void operator()(const SurfaceItem& given) {
    if (!given.data) fail_usage("the item has no data", "surface");
    if (!(given.opacity > 0)) return;
    SurfaceItem s = given;
    if (!s.data->as<SurfaceMesh>()) {  // any other mesh shows its outer faces
      const auto outer =
          derived(given.data, "outer faces", [&] { return OuterFaces{faces_and_edges(given.data, {.original_cell = false}, context_)}; });
      s.data = outer->skin.surface, s.edge_lines = outer->skin.edges;
    }
    const SurfaceMesh& mesh = surface_mesh(s.data, "surface");
    PreparedItem p = start(PreparedItem::Kind::surface, s.data, s.opacity);
    bool any = false;
    p.triangles = triangulate(s.data, any);
    p.material = s.material, p.made_of = s.made_of, p.copy_of = s.copy_of;
    p.color = color_source(s.data, s.color_by, s.color, "surface");
    if (s.pictures) p.pictures = place_pictures(*s.pictures, s.data);
    p.translucent = s.opacity < 1 || p.color.translucent || (p.pictures && p.pictures->translucent());
    if (!s.flat) p.normals = normals(s, p.triangles);
    if (s.lic && s.lic->strength > 0) take_texture(*s.lic, p);
    const Array positions = p.triangles.positions;
    const Vec3 origin = p.triangles.origin;
    const auto contrast = s.edges && !s.edge_color ? contrast_to(p.color) : PreparedItem::Contrast::none;
    if (p.triangles.count > 0) push(std::move(p), p.triangles.count);
    if (!s.edges || !any) return;
    PreparedItem e = start(PreparedItem::Kind::lines, s.data, s.opacity);
    e.color = color_source(s.data, std::nullopt, s.edge_color.value_or(outline_color), "surface");
    e.contrast = contrast;
    e.width = 1;
    if (const DatasetPtr of = s.edge_lines ? s.edge_lines : s.data; of == s.data) {
      e.segments = derived(of, "edges", [&] { return polygon_edges(*of, mesh); });
      e.positions = positions, e.origin = origin;
    } else {
      const SurfaceMesh& lines = surface_mesh(of, "surface");
      const bool curves = lines.polygons.size() + lines.strips.size() == 0;
      e.segments = curves ? derived(of, "curved edges", [&] { return curved_edges(*of, lines); })
                          : derived(of, "edges", [&] { return polygon_edges(*of, lines); });
      const Positions own = packed_positions(of, lines.points);
      e.positions = own.xyz, e.origin = own.origin;
    }
    const size_t count = e.segments->count();
    push(std::move(e), count);
  }

  void operator()(const LinesItem& s) {
    if (!s.data) fail_usage("the item has no data", "lines");
    const SurfaceMesh& mesh = surface_mesh(s.data, "lines");
    if (!(s.opacity > 0) || !(s.width > 0)) return;
    PreparedItem p = start(PreparedItem::Kind::lines, s.data, s.opacity);
    p.segments = derived(s.data, "segments", [&] { return line_segments(*s.data, mesh); });
    p.color = color_source(s.data, s.color_by, s.color, "lines");
    const Positions positions = packed_positions(s.data, mesh.points);
    p.positions = positions.xyz, p.origin = positions.origin;
    p.width = s.width, p.shaded = s.lit, p.material = line_material, p.made_of = s.made_of;
    p.halo = s.halo, p.halo_color = linear_light(s.halo_color);
    push(std::move(p), p.segments->count());
  }

  void operator()(const PointsItem& s) {
    if (!s.data) fail_usage("the item has no data", "points");
    if (!(s.opacity > 0) || !(s.size > 0)) return;
    PreparedItem p = start(PreparedItem::Kind::points, s.data, s.opacity);
    if (s.color_by && s.color_by->association == Association::cell)
      fail_usage(fmt::format("points cannot take the colour of cell field '{}'", s.color_by->field), "points", "use a point field");
    p.color = color_source(s.data, s.color_by, s.color, "points");
    p.width = s.size, p.shaded = s.shaded, p.made_of = s.made_of;
    const Positions positions = positions_of(s.data);
    p.positions = positions.xyz, p.origin = positions.origin;
    if (!s.disc_normals.empty() && !s.disc_radius.empty() && s.opacity >= 1 && !p.color.translucent) {
      auto numbers = [&](const std::string& name, int components) {
        const Field& f = s.data->fields().require(name, Association::point);
        if (f.components() != components)
          fail_usage(fmt::format("field '{}' has {} components, not {}", name, f.components(), components), "points");
        if (f.array.type() == ElementType::f32 && f.array.packed()) return f.array;
        return *derived(s.data, "discs/" + name, [&] { return f.array.converted(ElementType::f32).made_packed(); });
      };
      p.disc_normals = numbers(s.disc_normals, 3), p.disc_radius = numbers(s.disc_radius, 1);
      p.discs = true;
    }
    const bool all = p.discs && s.data->as<PointCloud>() && s.data->point_ghost().empty();  // of the discs: no list says more
    if (!all) p.points = derived(s.data, "points", [&] { return chosen_points(*s.data); });
    push(std::move(p), all ? s.data->point_count() : p.points->size());
  }

  void operator()(const GlyphsItem& s) {
    if (!s.data) fail_usage("the item has no data", "glyphs");
    if (s.shapes.empty() || s.shapes.size() > 255) fail_usage(fmt::format("{} shapes", s.shapes.size()), "glyphs", "give 1 to 255");
    if (!(s.opacity > 0)) return;
    if (s.color_by && s.color_by->association == Association::cell)
      fail_usage(fmt::format("glyphs cannot take the colour of cell field '{}'", s.color_by->field), "glyphs", "use a point field");
    GlyphSet set;
    size_t triangles = 0, segments = 0;
    for (const DatasetPtr& shape : s.shapes) {
      set.shapes.push_back(glyph_shape(shape, s.feature_angle, s.flat));
      const GlyphShape& g = *set.shapes.back();
      set.first_row.push_back(int32_t(set.faces.size() / GlyphShape::row));
      set.faces.insert(set.faces.end(), g.faces.begin(), g.faces.end());
      set.smooth = set.smooth || g.smooth;
      triangles = std::max(triangles, g.triangles), segments = std::max(segments, g.segments.count());
    }
    set.instances = glyph_instances(s.data, s.rule, s.shapes.size());
    set.in_pixels = s.in_pixels;
    if (set.instances->standing > 1000) set.order = derived(s.data, "glyph order", [&] { return glyph_order(*set.instances); });
    const size_t n = set.instances->count();
    for (const auto& [kind, most] : {std::pair{PreparedItem::Kind::surface, triangles}, std::pair{PreparedItem::Kind::lines, segments}}) {
      if (most == 0 || set.instances->standing == 0) continue;
      PreparedItem p = start(kind, s.data, s.opacity);
      p.color = color_source(s.data, s.color_by, s.color, "glyphs");
      p.material = s.material, p.made_of = s.made_of, p.width = s.line_width, p.origin = set.instances->origin;
      p.translucent = s.opacity < 1 || p.color.translucent;
      set.shift = glyph_shift(n, most);
      p.glyphs = std::make_shared<const GlyphSet>(set);
      push(std::move(p), n << set.shift);
    }
  }

  void operator()(const VolumeItem&) {}
  uint32_t id = 0;

 private:
  PreparedItem start(PreparedItem::Kind kind, const DatasetPtr& data, double opacity) const {
    PreparedItem p;
    p.kind = kind, p.data = data, p.id = id, p.opacity = float(std::min(opacity, 1.0));
    return p;
  }

  void push(PreparedItem&& p, size_t count) {
    if (count >= size_t(UINT32_MAX) - next_) fail_usage("the scene has more than 4 billion primitives", "render", "draw it in parts");
    p.first_primitive = next_, p.primitives = uint32_t(count);
    next_ += uint32_t(count);
    out_.items.push_back(std::move(p));
  }

  static NormalSet normals(const SurfaceItem& s, const TriangleSet& triangles) {
    const FieldSet& fields = s.data->fields();
    const Field* f = nullptr;
    if (!s.normals.empty()) {
      f = &fields.require(s.normals, Association::point);
      if (f->components() != 3)
        fail_usage(fmt::format("field '{}' has {} components and cannot hold normals", f->name, f->components()), "surface",
                   "normals have 3 components");
    } else {
      for (const Field& g : fields)
        if (g.role == Role::normals && g.association == Association::point && g.components() == 3 && !f) f = &g;
    }
    if (f && f->array.type() == ElementType::f32 && f->array.packed()) return {f->array, {}};
    if (f) return {*derived(s.data, "normals/" + f->name, [&] { return f->array.converted(ElementType::f32).made_packed(); }), {}};
    const char* among = s.part_of ? "whole" : "own";
    return *derived(s.data, fmt::format("smooth/{}/{}", s.feature_angle, among), [&] {
      bool any = false;
      const TriangleSet whole = s.part_of ? triangulate(s.part_of, any) : TriangleSet();
      return smooth_normals(triangles, s.feature_angle, s.part_of ? &whole : nullptr);
    });
  }

  static Positions positions_of(const DatasetPtr& data) {
    if (auto* m = data->as<SurfaceMesh>()) return packed_positions(data, m->points);
    if (auto* m = data->as<PointCloud>()) return packed_positions(data, m->points);
    if (auto* m = data->as<UnstructuredMesh>()) return packed_positions(data, m->points);
    if (auto* m = data->as<CurvilinearGrid>()) return packed_positions(data, m->points);
    if (!is_lattice(data->mesh()))
      fail_usage(fmt::format("the points of a {} mesh cannot be drawn", data->kind()), "points", "draw its surface or resample it");
    return *derived(data, "positions", [&] { return lattice_positions(*data); });
  }

  static Positions lattice_positions(const Dataset& data) {
    const Lattice lattice(data.mesh());
    const LatticeView& v = lattice.view();
    float* out = nullptr;
    Positions r{Array::make<float>(v.points(), 3, &out), data.bounds().center()};
    parallel_for(v.dims[1] * v.dims[2], 16, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row)
        for (size_t i = 0; i < v.dims[0]; ++i) {
          const Vec3 p = v.position(i, row % v.dims[1], row / v.dims[1]) - r.origin;
          float* q = out + 3 * v.id(i, row % v.dims[1], row / v.dims[1]);
          q[0] = float(p.x), q[1] = float(p.y), q[2] = float(p.z);
        }
    });
    return r;
  }

  static std::vector<uint32_t> chosen_points(const Dataset& data) {
    std::vector<uint32_t> points;
    if (auto* m = data.as<SurfaceMesh>(); m && m->vertices.size() > 0) {
      const CellsView v = cells_view(m->vertices);
      for (size_t c = 0; c < v.count; ++c)
        for (size_t k = 0; k < v.size(c); ++k) points.push_back(uint32_t(v.point(c, k)));
    } else {
      if (data.point_count() >= UINT32_MAX) fail_usage("more than 4 billion points", "points", "draw only part of them");
      points.resize(data.point_count());
      for (size_t i = 0; i < points.size(); ++i) points[i] = uint32_t(i);
    }
    if (const Array& ghost = data.point_ghost(); !ghost.empty())
      std::erase_if(points, [&](uint32_t p) { return int(ghost.get(p)) & ghost_hidden_point; });
    return points;
  }

  PreparedScene& out_;
  Context& context_;
  uint32_t next_ = 0;
};

}  // namespace
}  // namespace raster

PreparedScenePtr prepare_scene(const Scene& scene, Context& context) {
  auto out = std::make_shared<PreparedScene>();
  raster::Preparation preparation(*out, context);
  for (const Item& item : scene.items) {
    context.check();
    ++preparation.id;
    std::visit(preparation, item);
  }
  out->lights = lights_of(scene);
  return out;
}

uint32_t PreparedScene::item_of(uint32_t primitive) const {
  auto it = std::upper_bound(items.begin(), items.end(), primitive,
                             [](uint32_t p, const raster::PreparedItem& i) { return p < i.first_primitive; });
  do --it;
  while (it->primitives == 0);
  return uint32_t(it - items.begin());
}

}  // namespace sg
