// SPDX-License-Identifier: Apache-2.0
// Tecplot ASCII: ordered zones become curvilinear grids, finite-element zones unstructured meshes; several zones a collection. Zones of
// different solution times are steps. Values are f32 unless the zone states DOUBLE.
#include <fmt/core.h>

#include <algorithm>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/tecplot/tecplot_parse.h"
#include "io/text/mesh_text.h"

namespace sg {

namespace tecplot {

namespace {

// Places of x, y and z among the variables; -1 where there is none.
std::array<int, 3> coordinates(const std::vector<std::string>& variables) {
  std::array<int, 3> r{-1, -1, -1};
  for (size_t v = 0; v < variables.size(); ++v) {
    std::string name = to_lower(variables[v]);
    name = name.substr(0, name.find_first_of(" [(,;"));  // "X [m]"
    if (name.starts_with("coordinate")) name = name.substr(10);
    for (size_t a = 0; a < 3; ++a)
      if (r[a] < 0 && name == std::string(1, char('x' + a))) r[a] = int(v);
  }
  if (r[0] >= 0 || r[1] >= 0 || r[2] >= 0) return r;
  // Without names the first variables are the coordinates.
  for (size_t a = 0; a < std::min<size_t>(variables.size(), 3); ++a) r[a] = int(a);
  if (variables.size() <= 3) r[2] = variables.size() == 3 ? -1 : r[2];
  return r;
}

Array numbers(const std::vector<double>& v, bool wide) {
  return wide ? Array::from_vector(v) : Array::from_vector(std::vector<float>(v.begin(), v.end()));
}

DatasetPtr dataset_of(const File& file, const Zone& z, const ReadOptions& options, const std::string& where) {
  if (z.values.size() != file.variables.size() || z.wide.size() != file.variables.size())
    fail_data(fmt::format("VARIABLES names {} variables after a zone with {}", file.variables.size(), z.values.size()), where,
              "name them once, before the zones");
  const std::array<int, 3> at = coordinates(file.variables);
  bool wide = false;
  for (int v : at) wide = wide || (v >= 0 && z.wide[size_t(v)]);
  std::vector<double> xyz(z.points() * 3, 0.0);
  for (size_t a = 0; a < 3; ++a) {
    if (at[a] < 0 || z.values[size_t(at[a])].empty()) continue;
    const auto& v = z.values[size_t(at[a])];
    if (v.size() != z.points()) fail_data(fmt::format("the coordinate '{}' is given at cells", file.variables[size_t(at[a])]), where);
    for (size_t i = 0; i < v.size(); ++i) {
      if (!std::isfinite(v[i]))
        fail_data(fmt::format("the coordinate '{}' of point {} is not finite", file.variables[size_t(at[a])], i + 1), where);
      xyz[3 * i + a] = v[i];
    }
  }
  Points points{wide ? Array::from_vector(std::move(xyz), 3) : Array::from_vector(std::vector<float>(xyz.begin(), xyz.end()), 3)};
  DatasetParts parts;
  if (z.ordered()) {
    CurvilinearGrid grid;
    grid.dims = z.dims;
    grid.points = std::move(points);
    parts.mesh = std::move(grid);
  } else {
    UnstructuredMesh mesh;
    mesh.points = std::move(points);
    mesh.cells.fixed = int(z.corners());
    mesh.cells.connectivity = Array::from_vector(std::vector<int32_t>(z.connectivity.begin(), z.connectivity.end()));
    mesh.single_type = z.type == "FELINESEG"         ? CellType::line
                       : z.type == "FETRIANGLE"      ? CellType::triangle
                       : z.type == "FEQUADRILATERAL" ? CellType::quad
                       : z.type == "FETETRAHEDRON"   ? CellType::tetra
                                                     : CellType::hexahedron;
    if (z.elements == 0) mesh.cells = {};
    parts.mesh = std::move(mesh);
  }
  for (size_t v = 0; v < file.variables.size(); ++v) {
    if (z.values[v].empty() || int(v) == at[0] || int(v) == at[1] || int(v) == at[2]) continue;
    const std::string& name = file.variables[v];
    if (!options.fields.empty() && std::find(options.fields.begin(), options.fields.end(), name) == options.fields.end()) continue;
    Field f;
    f.name = name;
    f.association = z.at_cells[v] ? Association::cell : Association::point;
    f.array = numbers(z.values[v], z.wide[v]);
    parts.fields.add(std::move(f));
  }
  if (!file.title.empty()) parts.notes.emplace_back("title", file.title);
  parts.time = z.time;
  return make_dataset(std::move(parts));
}

std::vector<double> times_of(const File& file) {
  std::vector<double> t;
  for (const Zone& z : file.zones)
    if (z.time) t.push_back(*z.time);
  std::sort(t.begin(), t.end());
  t.erase(std::unique(t.begin(), t.end()), t.end());
  return t.size() > 1 ? t : std::vector<double>();
}

}  // namespace
}  // namespace tecplot

bool sniff_tecplot(std::span<const std::byte> head) {
  std::string_view s(reinterpret_cast<const char*>(head.data()), head.size());
  if (s.find('\0') != std::string_view::npos) return false;
  bool title = false;
  while (!s.empty()) {
    const size_t end = std::min(s.find('\n'), s.size());
    const std::string_view line = trim(s.substr(0, end));
    s.remove_prefix(std::min(end + 1, s.size()));
    if (line.empty() || line[0] == '#') continue;
    auto begins = [&](std::string_view w) {
      return line.size() > w.size() && equal_ignoring_case(line.substr(0, w.size()), w) && trim(line.substr(w.size())).starts_with('=');
    };
    if (begins("VARIABLES")) return true;
    if (begins("FILETYPE")) continue;
    if (!begins("TITLE") || title) return false;
    title = true;
  }
  return false;
}

Data read_tecplot(const std::string& path, const ReadOptions& options, Context&) {
  const MappedFile file(path);
  const tecplot::File f = tecplot::parse(file.text(), path);
  const std::vector<double> times = tecplot::times_of(f);
  std::optional<double> time;
  if (!times.empty()) time = times[chosen_step(times, options, path)];
  auto parts = std::make_shared<Collection>();
  for (size_t k = 0; k < f.zones.size(); ++k) {
    const tecplot::Zone& z = f.zones[k];
    if (time && z.time && *z.time != *time) continue;
    parts->parts.push_back({z.title.empty() ? fmt::format("zone {}", k + 1) : z.title, tecplot::dataset_of(f, z, options, path)});
  }
  if (parts->parts.size() == 1) return parts->parts[0].data;
  return CollectionPtr(parts);
}

std::vector<double> times_of_tecplot(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  return tecplot::times_of(tecplot::parse(file.text(), path));
}

}  // namespace sg
