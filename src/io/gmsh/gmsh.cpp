// SPDX-License-Identifier: Apache-2.0
// Gmsh .msh: all elements (of every dimension, in file order) as cells; "physical" and "entity" (and "partition") as cell fields, the
// names of physical groups as names of their numbers (of "group" where groups of several dimensions share numbers). Data sections become
// fields; those of element nodes that differ between elements open the mesh there. Values that a section does not give are NaN.
#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "base/file/file.h"
#include "base/text/text.h"
#include "data/fields/label_names.h"
#include "io/formats.h"
#include "io/gmsh/elements.h"
#include "io/gmsh/msh_file.h"

namespace sg {

namespace gmsh {

namespace {

bool wanted(const ReadOptions& options, std::string_view name) {
  return options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end();
}

std::vector<double> times_of(const MshFile& f) {
  std::vector<double> t;
  for (const DataSection& d : f.data)
    if (d.time) t.push_back(*d.time);
  std::sort(t.begin(), t.end());
  t.erase(std::unique(t.begin(), t.end()), t.end());
  return t.size() > 1 ? t : std::vector<double>();
}

// The physical groups of the elements with their names. Gmsh numbers the groups of each dimension on their own: where two share a number,
// "group" numbers all of them.
void add_groups(const MshFile& f, DatasetParts& parts) {
  const auto dimension_of = [&](size_t element) { return int64_t(cell_type_info(element_type(f.element_types[element])->cell).dimension); };
  std::map<std::pair<int64_t, int64_t>, int32_t> groups;
  for (size_t e = 0; e < f.physical.size(); ++e)
    if (f.physical[e] != 0) groups[{dimension_of(e), f.physical[e]}] = f.physical[e];
  std::set<int64_t> numbers;
  bool shared = false;
  for (const auto& [group, number] : groups) shared |= !numbers.insert(number).second;

  LabelNames names(shared ? "group" : "physical");
  int32_t last = 0;
  for (auto& [group, number] : groups) {
    constexpr std::string_view kinds[] = {"points", "curves", "surfaces", "volumes"};
    if (shared) number = ++last;
    const auto known = f.names.find(group);
    if (known != f.names.end()) names.add(number, known->second);
    else if (shared || !f.names.empty()) names.add(number, fmt::format("{} {}", kinds[size_t(group.first)], group.second));
  }
  if (!names.empty() && std::find(f.physical.begin(), f.physical.end(), 0) != f.physical.end()) names.add(0, "no group");
  if (!names.empty()) parts.notes.push_back(names.note());
  if (shared) {
    std::vector<int32_t> of(f.physical.size());
    for (size_t e = 0; e < of.size(); ++e)
      if (f.physical[e] != 0) of[e] = groups[{dimension_of(e), f.physical[e]}];
    parts.fields.add(cell_ids("group", std::move(of)));
  }
  parts.fields.add(cell_ids("physical", f.physical));
}

// Of each name and kind the section of that time, else the last one before it, else the first.
std::vector<const DataSection*> sections_at(const MshFile& f, std::optional<double> time) {
  std::vector<const DataSection*> chosen;
  for (const DataSection& d : f.data) {
    auto it = std::find_if(chosen.begin(), chosen.end(), [&](const DataSection* c) { return c->name == d.name && c->kind == d.kind; });
    if (it == chosen.end()) chosen.push_back(&d);
    else if (time && d.time && *d.time <= *time && (!(*it)->time || *(*it)->time > *time || *(*it)->time < *d.time)) *it = &d;
  }
  return chosen;
}

Array node_or_element_values(MshInput& in, const DataSection& d, const TagIndex& index, size_t n) {
  double* out = nullptr;
  const auto c = size_t(d.components);
  Array a = Array::make<double>(n, int(c), &out);
  std::fill_n(out, n * c, std::nan(""));
  in.text.seek(d.begin);
  for (int64_t i = 0; i < d.entries; ++i) {
    const int64_t tag = in.integer("a tag"), at = index.find(tag);
    for (size_t k = 0; k < c; ++k) {
      const double v = in.real("a value");
      if (at >= 0) out[size_t(at) * c + k] = v;
    }
  }
  return a;
}

// Values per corner of every cell, in the cells' own order of nodes; NaN where none are given.
std::vector<double> corner_values(MshInput& in, const MshFile& f, const DataSection& d, const TagIndex& elements,
                                  const std::vector<size_t>& cell_begin) {
  const auto c = size_t(d.components);
  std::vector<double> out(cell_begin.back() * c, std::nan("")), values;
  in.text.seek(d.begin);
  for (int64_t i = 0; i < d.entries; ++i) {
    const int64_t element = elements.find(in.integer("a tag"));
    const int64_t nodes = in.count("the number of nodes", 2, false);
    values.resize(size_t(nodes) * c);
    for (double& v : values) v = in.real("a value");
    if (element < 0) continue;
    const auto e = size_t(element);
    const ElementType& t = *element_type(f.element_types[e]);
    for (size_t k = 0; k < t.from.size(); ++k)
      if (t.from[k] < size_t(nodes))
        std::copy_n(values.begin() + ptrdiff_t(t.from[k] * c), c, out.begin() + ptrdiff_t((cell_begin[e] + k) * c));
  }
  return out;
}

struct Cells {
  std::vector<int64_t> points;  ///< places of nodes, cell after cell
  std::vector<size_t> begin{0};
};

Cells cells_of(const MshFile& f, const TagIndex& nodes, const std::string& where) {
  Cells r;
  for (size_t e = 0; e < f.element_tags.size(); ++e) {
    const ElementType& t = *element_type(f.element_types[e]);
    for (uint32_t k : t.from) {
      const int64_t tag = f.element_nodes[f.element_begin[e] + k], at = nodes.find(tag);
      if (at < 0) fail_data(fmt::format("element {} has node {}, which does not exist", f.element_tags[e], tag), where);
      r.points.push_back(at);
    }
    r.begin.push_back(r.points.size());
  }
  return r;
}

// Gives corners whose values differ points of their own. Returns the node of each point.
std::vector<int64_t> open_mesh(Cells& cells, size_t nodes, const std::vector<std::vector<double>>& values,
                               const std::vector<size_t>& width) {
  std::vector<int64_t> source(nodes), head(nodes, -1), next(nodes, -1), corner(nodes, -1);
  for (size_t i = 0; i < nodes; ++i) source[i] = int64_t(i);
  auto same = [&](int64_t a, size_t b) {
    for (size_t s = 0; s < values.size(); ++s)
      for (size_t k = 0; k < width[s]; ++k) {
        const double x = values[s][size_t(a) * width[s] + k], y = values[s][b * width[s] + k];
        if (x != y && !(std::isnan(x) && std::isnan(y))) return false;
      }
    return true;
  };
  auto given = [&](size_t i) {
    for (size_t s = 0; s < values.size(); ++s)
      for (size_t k = 0; k < width[s]; ++k)
        if (!std::isnan(values[s][i * width[s] + k])) return true;
    return false;
  };
  std::vector<int64_t> point(cells.points.size(), -1);
  for (size_t i = 0; i < cells.points.size(); ++i) {
    if (!given(i)) continue;
    const auto node = size_t(cells.points[i]);
    int64_t p = head[node], last = -1;
    while (p >= 0 && !same(corner[size_t(p)], i)) last = p, p = next[size_t(p)];
    if (p < 0) {
      p = int64_t(node);  // the first keeps the node's own number
      if (head[node] >= 0) {
        p = int64_t(source.size());
        source.push_back(int64_t(node)), next.push_back(-1), corner.push_back(-1);
        next[size_t(last)] = p;
      } else {
        head[node] = p;
      }
      corner[size_t(p)] = int64_t(i);
    }
    point[i] = p;
  }
  // Elements without values stay with the node's own number.
  for (size_t i = 0; i < point.size(); ++i)
    if (point[i] >= 0) cells.points[i] = point[i];
  return source;
}

Role role_of(int64_t components) { return components == 3 ? Role::vectors : components == 9 ? Role::tensors : Role::none; }

// $ElementNodeData sections: values per corner of every cell.
struct CornerData {
  std::vector<const DataSection*> sections;
  std::vector<std::vector<double>> values;
  std::vector<size_t> width;
};

// The data at one time: fields of nodes and elements, and values at corners.
std::pair<std::vector<Field>, CornerData> data_fields(MshInput& in, const MshFile& f, const ReadOptions& options,
                                                      std::optional<double> time, const TagIndex& nodes, const TagIndex& elements,
                                                      const std::vector<size_t>& cell_begin) {
  std::vector<Field> fields;
  CornerData corners;
  for (const DataSection* d : sections_at(f, time)) {
    if (!wanted(options, d->name)) continue;
    if (d->kind == DataSection::element_node) {
      corners.values.push_back(corner_values(in, f, *d, elements, cell_begin));
      corners.width.push_back(size_t(d->components));
      corners.sections.push_back(d);
      continue;
    }
    const bool at_nodes = d->kind == DataSection::node;
    Field field;
    field.name = d->name;
    field.association = at_nodes ? Association::point : Association::cell;
    field.array = node_or_element_values(in, *d, at_nodes ? nodes : elements, at_nodes ? f.node_tags.size() : f.element_tags.size());
    field.role = role_of(d->components);
    fields.push_back(std::move(field));
  }
  return {std::move(fields), std::move(corners)};
}

DatasetPtr make(MshInput& in, const MshFile& f, const ReadOptions& options, const std::string& where) {
  const TagIndex nodes(f.node_tags), elements(f.element_tags);
  const size_t n = f.node_tags.size();
  Cells cells = cells_of(f, nodes, where);
  DatasetParts parts;
  const std::vector<double> times = times_of(f);
  if (!times.empty()) parts.time = times[chosen_step(times, options, where)];

  const auto [fields, corners] = data_fields(in, f, options, parts.time, nodes, elements, cells.begin);
  const std::vector<std::vector<double>>& corner = corners.values;
  const std::vector<size_t>& width = corners.width;
  std::vector<int64_t> source;
  if (!corner.empty()) source = open_mesh(cells, n, corner, width);
  const size_t points = source.empty() ? n : source.size();

  UnstructuredMesh mesh;
  MixedCells list;
  for (size_t e = 0; e < f.element_tags.size(); ++e)
    list.add(element_type(f.element_types[e])->cell, std::span(cells.points).subspan(cells.begin[e], cells.begin[e + 1] - cells.begin[e]));
  list.finish(mesh);
  auto at_points = [&](const double* from, size_t c) {
    double* out = nullptr;
    Array a = Array::make<double>(points, int(c), &out);
    for (size_t p = 0; p < points; ++p) std::copy_n(from + (source.empty() ? p : size_t(source[p])) * c, c, out + p * c);
    return a;
  };
  mesh.points.xyz = at_points(f.xyz.data(), 3);
  parts.mesh = std::move(mesh);

  for (Field field : fields) {
    if (field.association == Association::point && !source.empty())
      field.array = at_points(field.array.view<double>().data, size_t(field.components()));
    parts.fields.add(std::move(field));
  }
  for (size_t s = 0; s < corner.size(); ++s) {
    double* out = nullptr;
    Array a = Array::make<double>(points, int(width[s]), &out);
    std::fill_n(out, points * width[s], std::nan(""));
    for (size_t i = 0; i < cells.points.size(); ++i)
      for (size_t k = 0; k < width[s]; ++k)
        if (const double v = corner[s][i * width[s] + k]; !std::isnan(v)) out[size_t(cells.points[i]) * width[s] + k] = v;
    Field field;
    field.name = corners.sections[s]->name;
    field.array = std::move(a);
    field.role = role_of(corners.sections[s]->components);
    parts.fields.add(std::move(field));
  }
  add_groups(f, parts);
  parts.fields.add(cell_ids("entity", f.entity));
  if (f.partitioned) parts.fields.add(cell_ids("partition", f.partition));
  return make_dataset(std::move(parts));
}

}  // namespace
}  // namespace gmsh

bool sniff_gmsh(std::span<const std::byte> head) {
  std::string_view s(reinterpret_cast<const char*>(head.data()), head.size());
  while (!s.empty() && (s[0] == '\n' || s[0] == '\r' || s[0] == ' ')) s.remove_prefix(1);
  return s.starts_with("$MeshFormat");
}

Data read_gmsh(const std::string& path, const ReadOptions& options, Context&) {
  const MappedFile file(path);
  gmsh::MshInput in(file.text(), path);
  const gmsh::MshFile f = gmsh::parse_msh(in);
  return gmsh::make(in, f, options, path);
}

std::vector<double> times_of_gmsh(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  gmsh::MshInput in(file.text(), path);
  return gmsh::times_of(gmsh::parse_msh(in));
}

}  // namespace sg
