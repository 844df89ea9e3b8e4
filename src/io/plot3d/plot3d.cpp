// SPDX-License-Identifier: Apache-2.0
// PLOT3D: a grid file, and next to it a solution (q) and a function file. Layout: see layout.h.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/file/file_fence.h"
#include "base/text/json.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/mesh/blanking.h"
#include "io/mesh/unread.h"
#include "io/plot3d/layout.h"

namespace sg {

using namespace plot3d;

namespace {

struct Files {
  std::string grid, solution, function;
  bool named = false;  // by a meta file: they must be right
};

/// Files next to a grid: NAME.q and NAME.f (.fun), or for NAMExyz.EXT also NAMEq.EXT and NAMEf.EXT.
std::string companion(const std::string& grid, const std::vector<std::string>& extensions, const std::string& letter) {
  const std::string name = file_name_of(grid);
  const size_t dot = name.rfind('.');
  const std::string stem = name.substr(0, dot), ext = dot == std::string::npos ? "" : name.substr(dot);
  std::vector<std::string> tries;
  for (const std::string& e : extensions) tries.push_back(stem + "." + e);
  for (const std::string& tail : {std::string("xyz"), std::string("XYZ"), std::string("grid"), std::string("g")})
    if (stem.ends_with(tail)) {
      const std::string base = stem.substr(0, stem.size() - tail.size());
      tries.push_back(base + letter + ext);
      for (const std::string& e : extensions) tries.push_back(base + letter + "." + e);
    }
  for (const std::string& t : tries)
    if (const std::string path = path_beside(grid, t); path != grid && file_exists(path)) return path;
  return {};
}

Array component(const Numbers& n, const Layout& l, size_t at, size_t points, bool look_only) {
  if (look_only) return unread_values(n.type(l), points);
  std::byte* out = nullptr;
  Array a = Array::make_raw(n.type(l), points, 1, &out);
  n.copy(l, at, points, n.type(l), out, 1);
  return a;
}

/// Three components that lie one after the other; of two the third is 0.
Array vectors_of(const Numbers& n, const Layout& l, size_t at, size_t points) {
  const ElementType type = n.type(l);
  std::byte* out = nullptr;
  Array a = Array::make_raw(type, points, 3, &out);
  if (l.dimensions == 2) std::memset(out, 0, a.bytes());
  for (size_t c = 0; c < size_t(l.dimensions); ++c)
    n.copy(l, at + c * points * n.real_size(l), points, type, out + c * element_size(type), 3);
  return a;
}

DatasetParts read_grid(const Numbers& n, const Layout& l, size_t g, const ReadOptions& o) {
  DatasetParts d;
  CurvilinearGrid m;
  m.dims = l.sizes[g];
  const size_t points = m.dims[0] * m.dims[1] * m.dims[2];
  m.points.xyz = vectors_of(n, l, l.begin[g], points);
  if (l.iblank) {
    const size_t at = l.begin[g] + points * size_t(l.dimensions) * n.real_size(l);
    std::vector<int32_t> blank(points);
    std::vector<uint8_t> ghost(points), cells(lattice_cell_count(m.dims));
    for (size_t i = 0; i < points; ++i) {
      blank[i] = int32_t(n.integer(at + i * n.integer_size(), l.big_endian).value_or(0));
      ghost[i] = blank[i] == 0 ? uint8_t(ghost_hidden_point) : uint8_t(0);
    }
    hide_cells(m.dims, ghost.data(), cells.data());
    d.point_ghost = Array::from_vector(std::move(ghost));
    d.cell_ghost = Array::from_vector(std::move(cells));
    if (is_wanted(o.fields, "IBlank")) d.fields.add({"IBlank", Association::point, Array::from_vector(std::move(blank)), "", Role::none});
  }
  d.mesh = std::move(m);
  return d;
}

// Quantities of the solution, for a perfect gas with the format's ratio of specific heats and gas constant 1 (Walatka et al. 1990,
// PLOT3D User's Manual: functions 200, 110, 120): u = m / rho, p = (gamma - 1)(E - rho u.u / 2), T = p / rho.
void add_derived(const ReadOptions& o, DatasetParts& d) {
  constexpr double gamma = 1.4;
  const bool velocity = is_wanted(o.fields, "Velocity"), pressure = is_wanted(o.fields, "Pressure"),
             temperature = is_wanted(o.fields, "Temperature");
  const Field *rho = d.fields.find("Density"), *m = d.fields.find("Momentum"), *e = d.fields.find("StagnationEnergy");
  if (o.header_only || !rho || !m || !e || !(velocity || pressure || temperature)) return;
  const size_t count = rho->array.count();
  std::vector<double> u(3 * count), p(count), t(count);
  for (size_t i = 0; i < count; ++i) {
    const double density = rho->array.get(i), over = density != 0 ? 1 / density : 1;
    double square = 0;
    for (int a = 0; a < 3; ++a) {
      u[3 * i + size_t(a)] = m->array.get(i, a) * over;
      square += m->array.get(i, a) * m->array.get(i, a);
    }
    p[i] = (gamma - 1) * (e->array.get(i) - 0.5 * square * over);
    t[i] = p[i] * over;
  }
  const ElementType type = rho->array.type();
  auto add = [&](bool wanted, const char* name, std::vector<double> v, int components, Role role) {
    if (wanted) d.fields.add({name, Association::point, Array::from_vector(std::move(v), components).converted(type), "", role});
  };
  add(velocity, "Velocity", std::move(u), 3, Role::none);
  add(pressure, "Pressure", std::move(p), 1, Role::none);
  add(temperature, "Temperature", std::move(t), 1, Role::none);
}

void add_solution(const Numbers& n, const Layout& l, size_t g, const ReadOptions& o, DatasetParts& d) {
  const size_t points = point_count(d.mesh), real = n.real_size(l);
  const auto k = size_t(l.dimensions);
  // A new record begins behind the four conditions.
  const size_t first = l.begin[g] + 4 * real + (l.records ? 8 : 0);
  auto add = [&](const char* name, Array a, Role role) { d.fields.add({name, Association::point, std::move(a), "", role}); };
  if (is_wanted(o.fields, "Density")) add("Density", component(n, l, first, points, o.header_only), Role::scalars);
  if (is_wanted(o.fields, "Momentum"))
    add("Momentum", o.header_only ? unread_values(n.type(l), points, 3) : vectors_of(n, l, first + points * real, points), Role::vectors);
  if (is_wanted(o.fields, "StagnationEnergy"))
    add("StagnationEnergy", component(n, l, first + (k + 1) * points * real, points, o.header_only), Role::none);
  add_derived(o, d);
  if (is_wanted(o.fields, "Properties")) {
    // Mach number, angle of attack, Reynolds number, time; the fifth is the ratio of specific heats that the format takes for granted.
    std::vector<double> v(5, 1.4);
    for (size_t i = 0; i < 4; ++i) v[i] = n.real(l, l.begin[g] + i * real);
    d.fields.add({"Properties", Association::whole, Array::from_vector(std::move(v)).converted(n.type(l)), "", Role::none});
  }
}

void add_functions(const Numbers& n, const Layout& l, size_t g, const ReadOptions& o, DatasetParts& d) {
  const size_t points = point_count(d.mesh);
  for (int f = 0; f < l.fields[g]; ++f) {
    const std::string name = fmt::format("Function{}", f);
    if (!is_wanted(o.fields, name)) continue;
    d.fields.add({name, Association::point, component(n, l, l.begin[g] + size_t(f) * points * n.real_size(l), points, o.header_only), "",
                  Role::none});
  }
}

/// A file next to the grid, open, with its layout; nothing when it does not belong to it.
struct Opened {
  Numbers numbers;
  Layout layout;
};
std::optional<Opened> open_beside(const std::string& path, Kind kind, const Layout& grid, bool must, Context& context) {
  if (path.empty()) return {};
  Numbers n{MappedFile(path)};
  std::optional<Layout> l = find_layout(n, kind, &grid);
  if (l) return Opened{std::move(n), std::move(*l)};
  const std::string what = fmt::format("its length and sizes do not match the grid ({})", grid.describe());
  if (must) fail_data(what, path);
  context.warn(fmt::format("{} is left out: {}", path, what));
  return {};
}

Data read_files(const Files& files, std::optional<double> time, const ReadOptions& o, Context& context) {
  const Numbers n{MappedFile(files.grid)};
  const std::optional<Layout> l = find_layout(n, Kind::grid);
  if (!l)
    fail_data(
        "is not a PLOT3D grid: its length matches no combination of byte order, records, precision, dimensions, blanking and number of "
        "grids",
        files.grid, "a grid file begins with its sizes; for raw numbers give --dims and --type");
  context.info(fmt::format("{}: {}", files.grid, l->describe()));
  const auto q = open_beside(files.solution, Kind::solution, *l, files.named, context);
  const auto f = open_beside(files.function, Kind::function, *l, files.named, context);
  auto r = std::make_shared<Collection>();
  for (size_t g = 0; g < l->sizes.size(); ++g) {
    context.check();
    DatasetParts d = read_grid(n, *l, g, o);
    if (q) {
      add_solution(q->numbers, q->layout, g, o, d);
      const double t = q->numbers.real(q->layout, q->layout.begin[g] + 3 * q->numbers.real_size(q->layout));
      if (!time && std::isfinite(t)) d.time = t;
    }
    if (time) d.time = time;
    if (f) add_functions(f->numbers, f->layout, g, o, d);
    r->parts.push_back({fmt::format("grid {}", g + 1), make_dataset(std::move(d))});
  }
  if (r->parts.size() == 1) return r->parts[0].data;
  return r;
}

struct MetaStep {
  double time = 0;
  Files files;
};

std::vector<MetaStep> read_meta(const std::string& path) {
  const MappedFile file(path);
  const Json j = parse_json(file.text(), path);
  std::vector<MetaStep> steps;
  if (!j["filenames"].is_list())
    fail_data("is not a PLOT3D meta file", path, R"(like {"filenames": [{"time": 0, "xyz": "a.xyz", "q": "a.q"}]})");
  for (const Json& e : j["filenames"].items()) {
    MetaStep s;
    auto name = [&](const char* key) { return e[key].is_text() ? named_file(path, e[key].text()) : std::string(); };
    if (name("xyz").empty()) fail_data(fmt::format("entry {} of \"filenames\" names no \"xyz\"", steps.size()), path);
    s.time = e["time"].number();
    s.files = {name("xyz"), name("q"), name("function"), true};
    steps.push_back(std::move(s));
  }
  std::stable_sort(steps.begin(), steps.end(), [](const MetaStep& a, const MetaStep& b) { return a.time < b.time; });
  if (steps.empty()) fail_data("\"filenames\" is empty", path);
  return steps;
}

}  // namespace

bool sniff_plot3d(std::span<const std::byte> whole) { return find_layout(Numbers(whole), Kind::grid).has_value(); }

Data read_plot3d(const std::string& path, const ReadOptions& options, Context& context) {
  Files f{path, companion(path, {"q", "Q", "sol"}, "q"), companion(path, {"f", "fun", "F", "FUN"}, "f"), false};
  return read_files(f, {}, options, context);
}

bool sniff_plot3d_meta(std::span<const std::byte> head) {
  const std::string_view t = trim({reinterpret_cast<const char*>(head.data()), head.size()});
  return t.starts_with('{') && t.find("\"filenames\"") != std::string_view::npos && t.find("\"xyz\"") != std::string_view::npos;
}

std::vector<double> times_plot3d_meta(const std::string& path, const ReadOptions&, Context&) {
  std::vector<double> t;
  for (const MetaStep& s : read_meta(path)) t.push_back(s.time);
  return t;
}

Data read_plot3d_meta(const std::string& path, const ReadOptions& options, Context& context) {
  const std::vector<MetaStep> steps = read_meta(path);
  const size_t step = chosen_step(times_plot3d_meta(path, options, context), options, path);
  return read_files(steps[step].files, steps[step].time, options, context);
}

}  // namespace sg
