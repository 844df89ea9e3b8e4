// SPDX-License-Identifier: Apache-2.0
// PLY: vertices with their properties as point fields, faces with theirs as cell fields. nx ny nz become "Normals", red green
// blue [alpha] "RGB" or "RGBA", s t (u v, texture_u texture_v) "TCoords"; every other scalar keeps its name. Lists other than
// the faces' vertex indices are skipped. Edges are read as lines where there are no faces. Our own files keep the names of fields in
// comments ("field vertex nx 3 Wall normals": three properties from nx on).
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/texture_coordinates.h"
#include "io/formats.h"
#include "io/surface/ply_body.h"
#include "io/surface/surface_parts.h"
#include "io/write_losses.h"

namespace sg {

bool sniff_ply(std::span<const std::byte> head) {
  return head.size() >= 4 && std::memcmp(head.data(), "ply", 3) == 0 &&
         (head[3] == std::byte('\n') || head[3] == std::byte('\r') || head[3] == std::byte(' '));
}

namespace {

// Several properties that make one field.
struct Group {
  std::string_view field;
  Role role;
  std::array<std::string_view, 4> properties;
};
constexpr Group groups[] = {
    {"Normals", Role::normals, {"nx", "ny", "nz", ""}},
    {"Normals", Role::normals, {"normal_x", "normal_y", "normal_z", ""}},
    {"RGBA", Role::colors, {"red", "green", "blue", "alpha"}},
    {"RGB", Role::colors, {"red", "green", "blue", ""}},
    {"RGBA", Role::colors, {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"}},
    {"RGB", Role::colors, {"diffuse_red", "diffuse_green", "diffuse_blue", ""}},
    {"RGBA", Role::colors, {"r", "g", "b", "a"}},
    {"RGB", Role::colors, {"r", "g", "b", ""}},
    {"TCoords", Role::tcoords, {"s", "t", "", ""}},
    {"TCoords", Role::tcoords, {"u", "v", "", ""}},
    {"TCoords", Role::tcoords, {"texture_u", "texture_v", "", ""}},
};

void direct(PlyProperty& p, std::byte* out, size_t stride, ElementType type) { p.out = out, p.out_stride = stride, p.out_type = type; }

constexpr std::string_view field_comment = "field";

struct Reader {
  const ReadOptions& options;
  DatasetParts parts;

  bool wanted(const std::string& name) const {
    return !options.header_only &&
           (options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end());
  }

  // Makes a field of each property (or group of them) and lets decode_ply fill it. `used` properties are left out.
  void add_fields(PlyElement& e, Association association, std::vector<bool> used, const PlyHeader& header) {
    add_named_fields(e, association, used, header);
    for (const Group& g : groups) {
      std::vector<size_t> found;
      for (std::string_view name : g.properties)
        if (const int k = name.empty() ? -1 : e.find(name); k >= 0 && !used[size_t(k)] && !e.properties[size_t(k)].list)
          found.push_back(size_t(k));
      const size_t n = size_t(std::count_if(g.properties.begin(), g.properties.end(), [](std::string_view s) { return !s.empty(); }));
      if (found.size() != n) continue;
      ElementType type = e.properties[found[0]].type;
      for (const size_t k : found) {
        used[k] = true;
        if (e.properties[k].type != type) type = ElementType::f32;
      }
      // VTK's types: normals and texture coordinates are f32.
      if (g.role != Role::colors) type = ElementType::f32;
      if (!wanted(std::string(g.field))) continue;
      std::byte* out = nullptr;
      Array a = Array::make_raw(type, e.count, int(n), &out);
      for (size_t c = 0; c < n; ++c) direct(e.properties[found[c]], out + c * element_size(type), n * element_size(type), type);
      parts.fields.add({std::string(g.field), association, std::move(a), "", g.role});
    }
    for (size_t k = 0; k < e.properties.size(); ++k) {
      PlyProperty& p = e.properties[k];
      if (used[k] || p.list || !wanted(p.name) || parts.fields.find(p.name, association)) continue;
      std::byte* out = nullptr;
      Array a = Array::make_raw(p.type, e.count, 1, &out);
      direct(p, out, element_size(p.type), p.type);
      parts.fields.add({p.name, association, std::move(a), "", Role::none});
    }
  }

  // Fields whose names are in comments of our own files. A comment that does not fit the properties is only a comment.
  void add_named_fields(PlyElement& e, Association association, std::vector<bool>& used, const PlyHeader& header) {
    for (const auto& [key, text] : header.notes) {
      const auto w = words(text);
      if (key != "comment" || w.size() < 5 || w[0] != field_comment || w[1] != e.name) continue;
      const int first = e.find(w[2]);
      const auto n = parse_int(w[3]);
      if (first < 0 || !n || *n < 1 || size_t(*n) > e.properties.size() - size_t(first)) continue;
      const auto begin = size_t(first), end = begin + size_t(*n);
      const std::string name(trim(std::string_view(text).substr(size_t(w[4].data() - text.data()))));
      bool fits = !parts.fields.find(name, association);
      for (size_t k = begin; k < end; ++k)
        fits = fits && !used[k] && !e.properties[k].list && e.properties[k].type == e.properties[begin].type;
      if (!fits) continue;
      Role role = Role::none;
      for (const Group& g : groups)
        if (g.properties[0] == e.properties[begin].name && size_t(*n) == (g.properties[3].empty() ? g.properties[2].empty() ? 2 : 3 : 4))
          role = g.role;
      std::fill(used.begin() + ptrdiff_t(begin), used.begin() + ptrdiff_t(end), true);
      if (!wanted(name)) continue;
      const ElementType type = e.properties[begin].type;
      std::byte* out = nullptr;
      Array a = Array::make_raw(type, e.count, int(*n), &out);
      for (size_t k = begin; k < end; ++k)
        direct(e.properties[k], out + (k - begin) * element_size(type), size_t(*n) * element_size(type), type);
      parts.fields.add({name, association, std::move(a), "", role});
    }
  }

  void prepare_vertices(PlyElement& e, SurfaceMesh& mesh, const PlyHeader& header) {
    const std::string& path = header.path;
    if (e.count > size_t(INT32_MAX)) fail_data(fmt::format("{} vertices are more than a surface can have", e.count), path);
    std::vector<bool> used(e.properties.size(), false);
    ElementType type = ElementType::f32;
    std::array<int, 3> xyz{};
    for (size_t a = 0; a < 3; ++a) {
      xyz[a] = e.find(std::string_view("xyz").substr(a, 1));
      if (xyz[a] < 0 || e.properties[size_t(xyz[a])].list) fail_data(fmt::format("the vertices have no '{}'", "xyz"[a]), path);
      const ElementType t = e.properties[size_t(xyz[a])].type;
      if (t != ElementType::f32 && element_size(t) >= 4) type = ElementType::f64;  // 32-bit integers do not fit into f32
      used[size_t(xyz[a])] = true;
    }
    const size_t size = element_size(type);
    std::byte* out = nullptr;
    mesh.points.xyz = Array::make_raw(type, e.count, 3, &out);
    for (size_t a = 0; a < 3; ++a) direct(e.properties[size_t(xyz[a])], out + a * size, 3 * size, type);
    add_fields(e, Association::point, used, header);
  }
};

int index_list(const PlyElement& e) {
  for (std::string_view name : {"vertex_indices", "vertex_index", "vertex_indexes"})
    if (const int k = e.find(name); k >= 0 && e.properties[size_t(k)].list) return k;
  return -1;
}

CellArray cells_of(PlyElement& e) {
  CellArray c;
  c.connectivity = std::move(e.lists.ids);
  c.offsets = std::move(e.lists.offsets);
  c.fixed = e.lists.fixed;
  if (c.fixed == 0 && c.offsets.empty()) c.fixed = 3;  // no cells, or cells without points
  return c;
}

// A list of strips may hold several, with -1 between them.
CellArray strips_of(const PlyElement& e) {
  const CellArray lists = cells_of(const_cast<PlyElement&>(e));
  const CellsView v = cells_view(lists);
  std::vector<int32_t> ids;
  std::vector<int32_t> offsets{0};
  for (size_t c = 0; c < v.count; ++c) {
    for (size_t k = v.begin(c); k < v.end(c); ++k) {
      const int64_t id = v.connectivity[k];
      if (id >= 0) ids.push_back(int32_t(id));
      if ((id < 0 || k + 1 == v.end(c)) && size_t(offsets.back()) < ids.size()) offsets.push_back(int32_t(ids.size()));
    }
  }
  CellArray r;
  r.connectivity = Array::from_vector(std::move(ids));
  r.offsets = Array::from_vector(std::move(offsets));
  return r;
}

}  // namespace

Data read_ply(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  PlyHeader h = parse_ply_header(file);
  check_ply_counts(file, h);
  PlyElement *vertex = nullptr, *face = nullptr, *strip = nullptr, *edge = nullptr;
  for (PlyElement& e : h.elements) {
    if (e.name == "vertex" && !vertex) vertex = &e;
    else if (e.name == "face" && !face) face = &e;
    else if ((e.name == "tristrips" || e.name == "tristrip") && !strip) strip = &e;
    else if (e.name == "edge" && !edge) edge = &e;
    else context.info(fmt::format("{}: element '{}' is ignored", path, e.name));
  }
  if (!vertex) fail_data("there is no element 'vertex'", path);

  Reader r{options, {}};
  SurfaceMesh mesh;
  r.prepare_vertices(*vertex, mesh, h);
  if (strip) {
    strip->wanted_list = index_list(*strip);
    if (strip->wanted_list < 0) fail_data("the element 'tristrips' has no list 'vertex_indices'", path);
  }
  if (face) {
    face->wanted_list = index_list(*face);
    if (face->wanted_list < 0 && face->count > 0) fail_data("the faces have no list 'vertex_indices'", path);
    // Cell fields are numbered over all cells, so they require a mesh of faces only.
    if (!strip || strip->count == 0) r.add_fields(*face, Association::cell, std::vector<bool>(face->properties.size(), false), h);
    else context.warn(path + ": face properties are ignored, since there are triangle strips");
  }
  std::byte* ends = nullptr;
  const bool lines = edge && edge->count > 0 && (!face || face->count == 0) && !strip;
  if (lines) {
    for (const char* name : {"vertex1", "vertex2"})
      if (edge->find(name) < 0 || edge->properties[size_t(edge->find(name))].list)
        fail_data(fmt::format("the edges have no '{}'", name), path);
    mesh.lines.connectivity = Array::make_raw(ElementType::i32, edge->count * 2, 1, &ends);
    mesh.lines.fixed = 2;
    direct(edge->properties[size_t(edge->find("vertex1"))], ends, 8, ElementType::i32);
    direct(edge->properties[size_t(edge->find("vertex2"))], ends + 4, 8, ElementType::i32);
  } else if (edge && edge->count > 0) {
    context.info(path + ": edges are ignored, since there are faces");
  }
  decode_ply(file, h, context);
  if (face && face->wanted_list >= 0) mesh.polygons = cells_of(*face);
  if (strip) mesh.strips = strips_of(*strip);
  r.parts.mesh = std::move(mesh);
  std::erase_if(h.notes, [](const auto& note) { return note.second.starts_with(std::string(field_comment) + " "); });
  r.parts.notes = std::move(h.notes);
  return make_dataset(std::move(r.parts));
}

namespace {

std::string_view ply_type(ElementType t) {
  constexpr std::string_view names[] = {"uchar", "char", "ushort", "short", "uint", "int", "double", "double", "float", "double"};
  return names[size_t(t)];
}

// One property to write: a component of a field.
struct Column {
  std::string name;
  Array values;  ///< one component, of a type that PLY has
};

// `comments` gets the names of fields that are not clear from their properties.
std::vector<Column> columns_of(const Dataset& d, Association association, std::string& comments, WriteLosses& losses) {
  std::vector<Column> r;
  for (const Field& f : d.fields()) {
    if (f.association != association) continue;
    const int n = f.components();
    std::string name = f.name;
    for (char& c : name)
      if (c == ' ' || c == '\t' || c == '\n' || c == '\r') c = '_';
    const bool wide = element_size(f.array.type()) == 8;
    const bool down = f.role == Role::tcoords && n == 2 && runs_down(f.name);
    if (wide && !down) losses.rounds(f, ElementType::f64);
    losses.drops_unit(f);
    const std::string own_name = down ? "TCoords" : f.name;
    if (down) losses.renames(f, own_name), losses.rounds(f, ElementType::f32);
    const Array a = down ? turned_round(f.array) : wide ? f.array.converted(ElementType::f64) : f.array;
    const size_t first = r.size();
    for (int c = 0; c < n; ++c) {
      std::string column = n == 1 ? name : fmt::format("{}_{}", name, c);
      if (f.role == Role::normals && n == 3) column = std::string("n") + "xyz"[c];
      if (f.role == Role::colors && (n == 3 || n == 4)) column = std::array{"red", "green", "blue", "alpha"}[size_t(c)];
      if (f.role == Role::tcoords && n == 2) column = c ? "t" : "s";
      const bool taken = column == "x" || column == "y" || column == "z" ||
                         std::any_of(r.begin(), r.end(), [&](const Column& o) { return o.name == column; });
      r.push_back({taken ? column + "_" : column, a.component(c)});
    }
    if (n > 0 && (n > 1 || r[first].name != own_name) && own_name.find_first_of("\r\n") == std::string::npos && trim(own_name) == own_name)
      comments += fmt::format("comment {} {} {} {} {}\n", field_comment, association == Association::point ? "vertex" : "face",
                              r[first].name, n, own_name);
    else if (n > 1) losses.splits(f);
    else if (n > 0) losses.renames(f, r[first].name);
  }
  return r;
}

void append(std::string& out, bool binary, const Array& a, size_t i) {
  dispatch(a, [&](auto v) {
    const auto x = v[i];
    if (binary) out.append(reinterpret_cast<const char*>(&x), sizeof x);
    else if constexpr (sizeof x == 1) out += fmt::format("{} ", int(x));
    else out += fmt::format("{} ", x);
  });
}

}  // namespace

void write_ply(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const DatasetPtr d = single_dataset(data, "writing PLY");
  const SurfaceMesh& mesh = surface_to_write(*d, "PLY", path);
  if (mesh.lines.size() || mesh.vertices.size()) context.warn(path + ": lines and vertices are not written; PLY holds faces");
  const PolygonList faces = surface_polygons(mesh);
  std::string comments;
  WriteLosses losses(path, "PLY");
  const std::vector<Column> of_points = columns_of(*d, Association::point, comments, losses),
                            of_faces = columns_of(*d, Association::cell, comments, losses);
  losses.leaves_out(*d, Association::whole);
  losses.tell(context);
  const Vec3 o = mesh.points.origin;
  const bool wide = mesh.points.xyz.type() == ElementType::f64 || o.x != 0 || o.y != 0 || o.z != 0;
  size_t longest = 0;
  for (size_t c = 0; c + 1 < faces.offsets.size(); ++c) longest = std::max(longest, faces.offsets[c + 1] - faces.offsets[c]);

  std::string text = fmt::format("ply\nformat {} 1.0\ncomment written by sightglass\n{}element vertex {}\n",
                                 options.binary ? "binary_little_endian" : "ascii", comments, d->point_count());
  for (const char c : {'x', 'y', 'z'}) text += fmt::format("property {} {}\n", wide ? "double" : "float", c);
  for (const Column& c : of_points) text += fmt::format("property {} {}\n", ply_type(c.values.type()), c.name);
  text += fmt::format("element face {}\nproperty list {} int vertex_indices\n", faces.source.size(), longest < 256 ? "uchar" : "uint");
  for (const Column& c : of_faces) text += fmt::format("property {} {}\n", ply_type(c.values.type()), c.name);
  text += "end_header\n";

  AtomicFile file(path);
  auto put = [&](auto x) {
    if (options.binary) text.append(reinterpret_cast<const char*>(&x), sizeof x);
    else if constexpr (sizeof x == 1) text += fmt::format("{} ", int(x));
    else text += fmt::format("{} ", x);
  };
  auto end_row = [&] {
    if (!options.binary) text.back() = '\n';
    if (text.size() > (1 << 20)) file.write(text), text.clear();
  };
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 p = mesh.points.at(i);
    for (int a = 0; a < 3; ++a) wide ? put(p[a]) : put(float(p[a]));
    for (const Column& c : of_points) append(text, options.binary, c.values, i);
    end_row();
  }
  for (size_t f = 0; f < faces.source.size(); ++f) {
    const size_t n = faces.offsets[f + 1] - faces.offsets[f];
    longest < 256 ? put(uint8_t(n)) : put(uint32_t(n));
    for (size_t k = faces.offsets[f]; k < faces.offsets[f + 1]; ++k) put(int32_t(faces.ids[k]));
    for (const Column& c : of_faces) append(text, options.binary, c.values, faces.source[f]);
    end_row();
  }
  file.write(text);
  file.commit();
}

}  // namespace sg
