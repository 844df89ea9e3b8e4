// SPDX-License-Identifier: Apache-2.0
#include "pipeline/hostile/hostile_random.h"

#include <fmt/format.h>

#include "data/cells/shape/cell_shape.h"
#include "filter/every_mesh.h"

namespace sg::test::hostile {

namespace {

double coordinate(Random& r) { return r.chance(0.3) ? r.whole(-2, 2) : r.in(-2, 2); }

// A length of everyday, now and then of the ends of double and float.
double any_scale(Random& r) {
  if (r.chance(0.8)) return 1;
  return r.chance(0.7) ? r.magnitude(1e-12, 1e12) : r.chance(0.7) ? r.magnitude(1e-40, 1e40) : r.one_of({1e-300, 1e300, 5e-324, 1e154});
}

Points random_points(Random& r, size_t n) {
  std::vector<double> xyz;
  const double scale = any_scale(r);
  const int flat = r.chance(0.3) ? r.whole(1, 7) : 0;  // axes without extent
  const double bad = r.chance(0.06) ? r.one_of({double(NAN), HUGE_VAL, -HUGE_VAL, 1e308}) : 0;
  for (size_t i = 0; i < n; ++i)
    for (int a = 0; a < 3; ++a) xyz.push_back(flat >> a & 1 ? 0.5 : scale * coordinate(r));
  if (bad != 0 && n > 0) xyz[size_t(r.whole(0, int(xyz.size()) - 1))] = bad;
  Points p;
  if (r.chance(0.5)) {
    std::vector<float> narrow;
    for (const double v : xyz) narrow.push_back(float(std::clamp(v, -3e38, 3e38)));
    p.xyz = Array::from_vector(std::move(narrow), 3);
  } else {
    p.xyz = Array::from_vector(std::move(xyz), 3);
  }
  if (r.chance(0.15)) p.origin = {r.magnitude(1, 1e15), -r.magnitude(1, 1e9), 0};
  return p;
}

std::array<size_t, 3> random_dims(Random& r) {
  std::array<size_t, 3> d{};
  for (size_t& n : d) n = size_t(r.chance(0.2) ? 1 : r.whole(2, 5));
  return d;
}

Mesh random_lattice(Random& r) {
  const std::array<size_t, 3> dims = random_dims(r);
  const int kind = r.whole(0, 2);
  if (kind == 0) {
    UniformGrid g;
    g.dims = dims;
    const double scale = any_scale(r);
    g.spacing = scale * Vec3(r.in(0.1, 1), r.in(0.1, 1), r.in(0.1, 1));
    if (r.chance(0.3)) g.origin = {r.magnitude(1e-3, 1e15), r.in(-1, 1), 0};
    if (r.chance(0.3)) {
      const double c = std::cos(r.in(0, 6)), s = std::sqrt(1 - c * c);
      g.direction = Mat3{{{c, -s, 0}, {s, c, 0}, {0, 0, r.chance(0.5) ? 1.0 : -1.0}}};
    }
    if (r.chance(0.3)) g.extent_start = {r.whole(-5, 5), r.whole(0, 1000000), -3};
    return g;
  }
  if (kind == 1) {
    RectilinearGrid g;
    const double scale = any_scale(r);
    auto axis = [&](size_t n) {
      std::vector<double> x{scale * r.in(-2, 2)};
      const double sign = r.chance(0.3) ? -1 : 1;
      while (x.size() < n) x.push_back(x.back() + sign * scale * r.magnitude(1e-6, 2));
      return Array::from_vector(std::move(x));
    };
    g.x = axis(dims[0]), g.y = axis(dims[1]), g.z = axis(dims[2]);
    return g;
  }
  CurvilinearGrid g;
  g.dims = dims;
  g.points = random_points(r, dims[0] * dims[1] * dims[2]);
  if (r.chance(0.7)) {  // in order, not shuffled
    std::vector<double> xyz;
    for (size_t i = 0; i < g.points.count(); ++i) {
      const double c[3] = {double(i % dims[0]), double(i / dims[0] % dims[1]), double(i / dims[0] / dims[1])};
      for (const double v : c) xyz.push_back(v + r.in(-0.2, 0.2));
    }
    g.points = {Array::from_vector(std::move(xyz), 3), {}};
  }
  return g;
}

CellArray random_cells(Random& r, size_t points, int lo, int hi, int most) {
  std::vector<int64_t> ids, offsets{0};
  for (int n = points == 0 ? 0 : r.whole(0, most); n > 0; --n) {
    for (int k = r.whole(lo, hi); k > 0; --k) ids.push_back(r.whole(0, int(points) - 1));
    offsets.push_back(int64_t(ids.size()));
  }
  CellArray c;
  if (offsets.size() == 1) return c;
  c.connectivity = Array::from_vector(std::move(ids)), c.offsets = Array::from_vector(std::move(offsets));
  return c;
}

Mesh random_surface(Random& r) {
  SurfaceMesh s;
  const auto n = size_t(r.whole(0, 12));
  s.points = random_points(r, n);
  const int parts = r.whole(1, 15);
  if (parts & 1) s.vertices = random_cells(r, n, 1, 2, 3);
  if (parts & 2) s.lines = random_cells(r, n, 2, 6, 4);
  if (parts & 4) s.polygons = random_cells(r, n, 3, r.chance(0.5) ? 3 : 8, 12);
  if (parts & 8) s.strips = random_cells(r, n, 3, 6, 3);
  return s;
}

// Cells of all types one after the other; their corners in no order at all, or a good cell of each.
Mesh random_unstructured(Random& r) {
  using enum CellType;
  static const std::vector<std::pair<CellType, int>> types{{vertex, 1},
                                                           {poly_vertex, 3},
                                                           {line, 2},
                                                           {poly_line, 4},
                                                           {triangle, 3},
                                                           {triangle_strip, 5},
                                                           {polygon, 5},
                                                           {pixel, 4},
                                                           {quad, 4},
                                                           {tetra, 4},
                                                           {voxel, 8},
                                                           {hexahedron, 8},
                                                           {wedge, 6},
                                                           {pyramid, 5},
                                                           {pentagonal_prism, 10},
                                                           {hexagonal_prism, 12},
                                                           {quadratic_edge, 3},
                                                           {quadratic_triangle, 6},
                                                           {quadratic_quad, 8},
                                                           {quadratic_tetra, 10},
                                                           {quadratic_hexahedron, 20},
                                                           {quadratic_wedge, 15},
                                                           {quadratic_pyramid, 13},
                                                           {biquadratic_quad, 9},
                                                           {triquadratic_hexahedron, 27},
                                                           {quadratic_linear_quad, 6},
                                                           {quadratic_linear_wedge, 12},
                                                           {biquadratic_quadratic_wedge, 18},
                                                           {biquadratic_quadratic_hexahedron, 24},
                                                           {biquadratic_triangle, 7},
                                                           {cubic_line, 4},
                                                           {quadratic_polygon, 8},
                                                           {triquadratic_pyramid, 19},
                                                           {lagrange_curve, 4},
                                                           {lagrange_triangle, 10},
                                                           {lagrange_quad, 9},
                                                           {lagrange_tetra, 20},
                                                           {lagrange_hexahedron, 27},
                                                           {lagrange_wedge, 18},
                                                           {lagrange_pyramid, 14},
                                                           {bezier_curve, 3},
                                                           {bezier_triangle, 6},
                                                           {bezier_quad, 9},
                                                           {bezier_tetra, 10},
                                                           {bezier_hexahedron, 27},
                                                           {bezier_wedge, 18}};
  const bool orderly = r.chance(0.5);
  UnstructuredMesh m;
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> kinds;
  const int loose = r.whole(4, 12);
  Points points = random_points(r, size_t(loose));
  for (size_t i = 0; i < points.count(); ++i)
    for (int a = 0; a < 3; ++a) xyz.push_back(points.xyz.get(i, a));
  for (int n = r.whole(0, 6); n > 0; --n) {
    const auto& [type, corners] = types[size_t(r.whole(0, int(types.size()) - 1))];
    const CellShape* shape = CellShape::find(type, size_t(corners));
    for (int k = 0; k < corners; ++k) {
      if (orderly && shape) {
        const Vec3 p = shape->node(size_t(k));
        ids.push_back(int64_t(xyz.size() / 3));
        for (int a = 0; a < 3; ++a) xyz.push_back(p[a] + (a == 0 ? n : 0) + r.in(-0.05, 0.05));
      } else {
        ids.push_back(r.whole(0, loose - 1));
      }
    }
    offsets.push_back(int64_t(ids.size())), kinds.push_back(uint8_t(type));
  }
  m.points.xyz = Array::from_vector(std::move(xyz), 3), m.points.origin = points.origin;
  m.cells.connectivity = Array::from_vector(std::move(ids)), m.cells.offsets = Array::from_vector(std::move(offsets));
  m.types = Array::from_vector(std::move(kinds));
  return m;
}

Mesh random_mesh(Random& r) {
  switch (r.whole(0, 9)) {
    case 0:
    case 1:
    case 2: return random_lattice(r);
    case 3:
    case 4: return random_surface(r);
    case 5:
    case 6: return random_unstructured(r);
    case 7: return PointCloud{random_points(r, size_t(r.chance(0.2) ? r.whole(0, 1) : r.whole(2, 20)))};
    default: {
      const auto& kinds = every_mesh();
      const MeshKind& kind = kinds[size_t(r.whole(0, int(kinds.size()) - 1))];
      return kind.make(r.chance(0.3) ? 4 : 2, any_scale(r))->mesh();
    }
  }
}

enum class Habit { noise, smooth, flat, nan, infinite, huge, tiny, whole };

double random_value(Random& r, Habit habit, size_t i, double constant) {
  switch (habit) {
    case Habit::smooth: return std::sin(0.3 * double(i) + constant);
    case Habit::flat: return constant;
    case Habit::nan: return r.chance(0.3) ? NAN : r.in(-1, 1);
    case Habit::infinite: return r.chance(0.2) ? (r.chance(0.5) ? HUGE_VAL : -HUGE_VAL) : r.in(-1, 1);
    case Habit::huge: return (r.chance(0.5) ? 1 : -1) * r.magnitude(1e30, 1.7e308);
    case Habit::tiny: return (r.chance(0.5) ? 1 : -1) * r.magnitude(5e-324, 1e-30);
    case Habit::whole: return r.whole(-3, 5);
    default: return r.in(-1, 1);
  }
}

template <class T>
Array random_array(Random& r, size_t n, int components) {
  const Habit habit = r.chance(0.5) ? r.one_of({Habit::noise, Habit::smooth, Habit::whole})
                                    : r.one_of({Habit::flat, Habit::nan, Habit::infinite, Habit::huge, Habit::tiny});
  const double constant = r.in(-3, 3);
  std::vector<T> v(n * size_t(components));
  for (size_t i = 0; i < v.size(); ++i) {
    const double x = random_value(r, habit, i, constant);
    if constexpr (std::is_floating_point_v<T>) {
      v[i] = std::isfinite(x) ? T(std::clamp(x, -double(std::numeric_limits<T>::max()), double(std::numeric_limits<T>::max()))) : T(x);
    } else {  // the ends of the type for what it cannot hold
      v[i] = habit == Habit::huge    ? (x > 0 ? std::numeric_limits<T>::max() : std::numeric_limits<T>::min())
             : std::isfinite(x)      ? T(int64_t(std::clamp(20 * x, -100.0, 100.0)))
             : std::is_unsigned_v<T> ? T(7)
                                     : T(-7);
    }
  }
  return Array::from_vector(std::move(v), components);
}

Array random_array(Random& r, size_t n) {
  const int components = r.one_of({1, 1, 1, 2, 3, 3, 3, 4, 6, 6, 9, 9, 5, 16});
  switch (r.whole(0, 13)) {
    case 0: return random_array<uint8_t>(r, n, components);
    case 1: return random_array<int8_t>(r, n, components);
    case 2: return random_array<uint16_t>(r, n, components);
    case 3: return random_array<int16_t>(r, n, components);
    case 4: return random_array<uint32_t>(r, n, components);
    case 5: return random_array<int32_t>(r, n, components);
    case 6: return random_array<uint64_t>(r, n, components);
    case 7: return random_array<int64_t>(r, n, components);
    case 8:
    case 9:
    case 10: return random_array<float>(r, n, components);
    default: return random_array<double>(r, n, components);
  }
}

FieldSet random_fields(Random& r, size_t points, size_t cells) {
  FieldSet fields;
  for (int n = r.whole(0, 5); n > 0; --n) {
    const Association a = r.chance(0.65) ? Association::point : r.chance(0.95) ? Association::cell : Association::whole;
    const size_t count = a == Association::point ? points : a == Association::cell ? cells : 1;
    // The latter ones are what operations call their own results.
    Field f{r.one_of<const char*>({"s",
                                   "v",
                                   "t",
                                   "labels",
                                   "GlobalIds",
                                   "x y",
                                   "s",
                                   "v",
                                   "t",
                                   "labels",
                                   "speed",
                                   "time",
                                   "length",
                                   "seed",
                                   "stop",
                                   "age",
                                   "normals",
                                   "gradient",
                                   "vorticity",
                                   "rotation",
                                   "distance",
                                   "label",
                                   "bias",
                                   "count",
                                   "band",
                                   "component",
                                   "value",
                                   "radius",
                                   "angle",
                                   "curvature",
                                   "texture coordinates",
                                   "lic",
                                   "tensor"}),
            a, random_array(r, count), "", Role::none};
    if (r.chance(0.7)) {
      switch (f.components()) {
        case 1: f.role = r.one_of({Role::scalars, Role::scalars, Role::labels, Role::global_ids}); break;
        case 2: f.role = r.one_of({Role::vectors, Role::tcoords}); break;
        case 3: f.role = r.one_of({Role::vectors, Role::vectors, Role::normals, Role::colors, Role::tcoords}); break;
        case 4: f.role = Role::colors; break;
        default: f.role = Role::tensors;
      }
    }
    fields.add(std::move(f));
  }
  return fields;
}

Array random_ghosts(Random& r, size_t n) {
  std::vector<uint8_t> ghosts(n);
  for (uint8_t& g : ghosts)
    if (r.chance(0.3)) g = uint8_t(r.one_of({1, 2, 8, 32, 33}));
  return Array::from_vector(std::move(ghosts));
}

std::string number(Random& r, double lo, double hi, bool whole) {
  if (r.chance(0.08))
    return r.one_of<const char*>({"nan", "inf", "-inf", "1e300", "-1e300", "1e-300", "2147483647", "-2147483648", "9223372036854775807",
                                  "1e9", "1e8", "4294967296"});
  const bool bounded_below = std::isfinite(lo), bounded_above = std::isfinite(hi);
  if (r.chance(0.25)) {  // an end, or just outside
    const double end = bounded_above && (!bounded_below || r.chance(0.5)) ? hi : bounded_below ? lo : 0;
    return fmt::format("{}", end + r.one_of({0.0, 0.0, 1.0, -1.0, 1e-9, -1e-9}) * (whole ? 1 : 1));
  }
  const double from = bounded_below ? lo : bounded_above ? hi - 10 : -3, to = bounded_above ? std::min(hi, from + 1000) : from + 8;
  const double v = r.chance(0.5) ? r.in(from, std::min(to, from + 8)) : r.in(from, to);
  return whole ? fmt::format("{}", int64_t(std::floor(v))) : fmt::format("{}", v);
}

std::string list(Random& r, const std::function<std::string()>& one) {
  std::string s;
  const int n = r.chance(0.1) ? 0 : r.one_of({1, 1, 2, 2, 3, 3, 3, 6, 6, 9});
  for (int i = 0; i < n; ++i) s += (i ? "," : "") + one();
  return s;
}

std::string field_name(Random& r, const Data& data) {
  std::vector<std::string> names{"nothing", "none"};
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    for (const std::string& n : d->fields().names())
      for (int i = 0; i < 5; ++i) names.push_back(n);
  });
  return names[size_t(r.whole(0, int(names.size()) - 1))];
}

// What words without a list of choices are made of: formulas, places, opacities, planes, transfer functions ...
std::string any_text(Random& r, const Data& data) {
  if (r.chance(0.3)) return field_name(r, data);
  return r.one_of<const char*>({"",
                                "auto",
                                "none",
                                "all",
                                "0:0,1:1",
                                "0:0,0.5:1,0.5:0,1:0.3",
                                "0:black,1:white",
                                "@0:0,@1:1",
                                "1,0,0,0",
                                "box -1,1,-1,1,-1,1",
                                "0,0,0;1,1,1",
                                "s*2",
                                "s/0",
                                "mag(v)",
                                "sqrt(-s)",
                                "x+y*z",
                                "0:1:11",
                                "-1:nan:3",
                                "0:1:999999999",
                                "gradient",
                                "curvature",
                                "second_derivative",
                                "triangle 0 1 0 1 0.5 red",
                                "rectangle 0 0 0 1 1 #ffffff",
                                "point",
                                "red",
                                "#12345",
                                "1e300",
                                "viridis",
                                "grey",
                                "histogram",
                                "boundaries",
                                "\xff\xfe",
                                "x\ny",
                                "0",
                                "1",
                                "-1",
                                "0.5"});
}

}  // namespace

DatasetPtr random_dataset(Random& r) {
  for (;;) try {
      DatasetParts parts;
      parts.mesh = random_mesh(r);
      const size_t points = point_count(parts.mesh), cells = cell_count(parts.mesh);
      parts.fields = random_fields(r, points, cells);
      if (r.chance(0.1)) parts.cell_ghost = random_ghosts(r, cells);
      if (r.chance(0.05)) parts.point_ghost = random_ghosts(r, points);
      if (r.chance(0.2)) parts.time = r.in(-1, 10);
      return make_dataset(std::move(parts));
    } catch (const Error&) {  // what no reader lets through either
      continue;
    }
}

Data random_data(Random& r) {
  if (r.chance(0.1)) {
    auto c = std::make_shared<Collection>();
    for (int n = r.whole(0, 3); n > 0; --n) c->parts.push_back({r.chance(0.5) ? "part" : fmt::format("part {}", n), random_dataset(r)});
    return CollectionPtr(std::move(c));
  }
  if (r.chance(0.03)) {
    auto t = std::make_shared<Table>();
    const auto rows = size_t(r.whole(0, 6));
    for (const char* name : {"x", "y", "s"})
      t->columns.push_back({name, Association::whole, random_array<double>(r, rows, 1), "", Role::none});
    return TablePtr(std::move(t));
  }
  return random_dataset(r);
}

std::string random_word(Random& r, const ParamDecl& d, const Data& data) {
  const auto text = [&]() -> std::string {
    if (!d.choices_.empty() && !r.chance(0.03)) return d.choices_[size_t(r.whole(0, int(d.choices_.size()) - 1))];
    return any_text(r, data);
  };
  const auto real = [&] { return number(r, d.lo, d.hi, false); };
  const auto whole = [&] { return number(r, d.lo, d.hi, true); };
  const auto value = [&]() -> std::string {
    switch (d.ref.type()) {
      case ParamType::boolean: return r.chance(0.5) ? "true" : "false";
      case ParamType::integer: return whole();
      case ParamType::number: return real();
      case ParamType::word: return text();
      case ParamType::field: return field_name(r, data);
      case ParamType::point: return real() + "," + real() + "," + real();
      case ParamType::integers: return list(r, whole);
      case ParamType::numbers: return list(r, real);
      case ParamType::words: return list(r, text);
    }
    return {};
  };
  return d.name + "=" + value();
}

std::vector<std::string> random_words(Random& r, const Schema& schema, const Data& data, double chance) {
  std::vector<std::string> words;
  for (const ParamDecl& d : schema.decls())
    if (d.unit_ != "file" && d.unit_ != "new file" && r.chance(chance)) words.push_back(random_word(r, d, data));
  return words;
}

std::vector<std::string> small_sizes(const Schema& schema, std::string_view operation, const std::vector<Data>& inputs) {
  std::vector<std::string> r;
  for (const char* name : {"size", "resolution", "density"}) {
    const ParamDecl* d = schema.find(name);
    const bool surface_texture = d && d->name == "density" && !schema.find("resolution");
    if (d && (d->ref.type() == ParamType::integer || surface_texture)) r.push_back(d->name + "=8");
  }
  Box3 box;
  if (!inputs.empty()) for_each_dataset(inputs[0], [&](const std::string&, const DatasetPtr& d) { box.add(d->bounds()); });
  const double spacing = box.diagonal() / 15;
  if (operation.ends_with("_surface") && schema.find("spacing") && spacing > 0 && std::isfinite(spacing))
    r.push_back(fmt::format("spacing={}", spacing));
  return r;
}

}  // namespace sg::test::hostile
