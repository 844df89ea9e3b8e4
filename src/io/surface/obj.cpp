// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: vertices, texture coordinates, normals, faces, lines, points, groups and materials. Where the corners of faces
// take texture coordinates or normals of another number than their vertex, every corner becomes a point of its own (as in VTK);
// otherwise the vertices are the points. "GroupIds" (f32) counts the g statements, "MaterialIds" (i32) numbers the materials;
// their names are notes.
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/label_names.h"
#include "data/fields/texture_coordinates.h"
#include "io/formats.h"
#include "io/surface/obj_materials.h"
#include "io/surface/obj_parse.h"
#include "io/surface/surface_parts.h"
#include "io/text/text_scan.h"
#include "io/write_losses.h"

namespace sg {

namespace {

constexpr size_t kinds = 3;

// The chunks of a file and where the elements of each begin in the whole.
struct ObjFile {
  std::string path;
  std::string_view text;
  std::vector<size_t> borders;
  std::vector<ObjChunk> chunks;
  std::vector<size_t> first_v, first_t, first_n;
  std::array<std::vector<size_t>, kinds> first_cell, first_corner;
  size_t v = 0, t = 0, n = 0;
  std::array<size_t, kinds> cells{}, corners{};
  bool has_t = false, has_n = false;  ///< some corner has one
};

void parse(const MappedFile& file, ObjFile& o, Context& context) {
  o.path = file.path();
  o.text = file.text();
  o.borders = text_chunks(o.text, 1 << 18, false, true);
  const size_t n = o.borders.size() - 1;
  o.chunks.resize(n);
  std::vector<std::exception_ptr> errors(n);
  parallel_for(
      n, 1,
      [&](size_t c, size_t) {
        try {
          parse_obj_chunk(o.text, o.borders[c], o.borders[c + 1], o.path, o.chunks[c]);
        } catch (...) {
          errors[c] = std::current_exception();
        }
      },
      &context);
  for (const auto& e : errors)
    if (e) std::rethrow_exception(e);  // the first in the file, whichever thread met which first

  auto count = [&](std::vector<size_t>& first, auto size) {
    first.resize(n);
    for (size_t c = 0; c < n; ++c) first[c] = size(o.chunks[c]);
    return exclusive_scan(first);
  };
  o.v = count(o.first_v, [](const ObjChunk& c) { return c.xyz.size() / 3; });
  o.t = count(o.first_t, [](const ObjChunk& c) { return c.tcoords.size() / 2; });
  o.n = count(o.first_n, [](const ObjChunk& c) { return c.normals.size() / 3; });
  for (size_t k = 0; k < kinds; ++k) {
    o.cells[k] = count(o.first_cell[k], [k](const ObjChunk& c) { return c.cells[k].lengths.size(); });
    o.corners[k] = count(o.first_corner[k], [k](const ObjChunk& c) { return c.cells[k].v.size(); });
  }
  if (o.v > size_t(INT32_MAX) || o.corners[0] + o.corners[1] + o.corners[2] > size_t(INT32_MAX))
    fail_data("has more than 2^31 vertices or corners", o.path);
}

// Makes the indices of one chunk absolute; fails for those out of range.
void resolve(ObjFile& o, size_t c, ObjCell kind, std::vector<int32_t>& ids, size_t first, size_t total, const char* what) {
  const ObjCells& cells = o.chunks[c].cells[size_t(kind)];
  for (size_t i = 0; i < ids.size(); ++i) {
    int32_t& id = ids[i];
    if (id >= 0 && size_t(id) < total) continue;
    if (id == obj_none) continue;
    const int64_t absolute = id < obj_relative_below ? int64_t(id) - obj_relative + int64_t(first) : int64_t(id);
    if (absolute >= 0 && absolute < int64_t(total)) {
      id = int32_t(absolute);
      continue;
    }
    size_t cell = 0, corner = 0;
    while (cell < cells.lengths.size() && corner + cells.lengths[cell] <= i) corner += cells.lengths[cell++];
    fail_data(
        fmt::format("line {}: {} {} does not exist", obj_cell_line(o.text, o.borders[c], o.borders[c + 1], kind, cell), what, absolute + 1),
        o.path, total ? fmt::format("there are {}", total) : fmt::format("there is no {}", what));
  }
}

void resolve_all(ObjFile& o, Context& context) {
  std::vector<std::exception_ptr> errors(o.chunks.size());
  std::vector<uint8_t> t_used(o.chunks.size()), n_used(o.chunks.size());
  // Files exist whose corners name normals or texture coordinates although the file has none at all: those are left out.
  const bool drop_t = o.t == 0, drop_n = o.n == 0;
  parallel_for(
      o.chunks.size(), 1,
      [&](size_t c, size_t) {
        try {
          for (size_t k = 0; k < kinds; ++k) {
            ObjCells& cells = o.chunks[c].cells[k];
            t_used[c] |= uint8_t(!cells.t.empty()), n_used[c] |= uint8_t(!cells.n.empty());
            if (drop_t) cells.t.clear();
            if (drop_n) cells.n.clear();
            resolve(o, c, ObjCell(k), cells.v, o.first_v[c], o.v, "vertex");
            resolve(o, c, ObjCell(k), cells.t, o.first_t[c], o.t, "texture coordinate");
            resolve(o, c, ObjCell(k), cells.n, o.first_n[c], o.n, "normal");
          }
        } catch (...) {
          errors[c] = std::current_exception();
        }
      },
      &context);
  for (const auto& e : errors)
    if (e) std::rethrow_exception(e);
  o.has_t = std::find(t_used.begin(), t_used.end(), 1) != t_used.end();
  o.has_n = std::find(n_used.begin(), n_used.end(), 1) != n_used.end();
  if (o.has_t && drop_t) context.warn(o.path + ": faces refer to texture coordinates, but there are none");
  if (o.has_n && drop_n) context.warn(o.path + ": faces refer to normals, but there are none");
  o.has_t = o.has_t && !drop_t;
  o.has_n = o.has_n && !drop_n;
}

// Whether every corner takes the texture coordinate and normal with its vertex's number.
bool same_indices(const ObjFile& o) {
  if (!o.has_t && !o.has_n) return true;
  return parallel_reduce(
      o.chunks.size(), 1, true,
      [&](size_t c, size_t) {
        for (const ObjCells& cells : o.chunks[c].cells) {
          for (const auto* ids : {&cells.t, &cells.n})
            for (size_t i = 0; i < ids->size(); ++i)
              if ((*ids)[i] != obj_none && (*ids)[i] != cells.v[i]) return false;
        }
        return true;
      },
      [](bool a, bool b) { return a && b; });
}

// All elements of the chunks one after the other.
Array gather(const ObjFile& o, const std::vector<float> ObjChunk::*values, const std::vector<size_t>& first, size_t total, int n) {
  float* out = nullptr;
  Array a = Array::make<float>(total, n, &out);
  parallel_for(o.chunks.size(), 1, [&](size_t c, size_t) {
    const auto& v = o.chunks[c].*values;
    if (!v.empty()) std::memcpy(out + first[c] * size_t(n), v.data(), v.size() * sizeof(float));
  });
  return a;
}

// Values of the corners of all cells, kinds in order; corners without one get NaN.
Array expand(const ObjFile& o, const Array& values, const std::vector<int32_t> ObjCells::*ids) {
  const auto v = values.view<float>();
  const auto n = size_t(v.components);
  float* out = nullptr;
  Array a = Array::make<float>(o.corners[0] + o.corners[1] + o.corners[2], v.components, &out);
  parallel_for(o.chunks.size(), 1, [&](size_t c, size_t) {
    size_t before = 0;
    for (size_t k = 0; k < kinds; before += o.corners[k++]) {
      const ObjCells& cells = o.chunks[c].cells[k];
      const auto& list = cells.*ids;
      float* to = out + (before + o.first_corner[k][c]) * n;
      for (size_t i = 0; i < cells.v.size(); ++i, to += n) {
        const int32_t id = list.empty() ? obj_none : list[i];
        if (id == obj_none) std::fill(to, to + n, std::nanf(""));
        else std::memcpy(to, v.data + size_t(id) * n, n * sizeof(float));
      }
    }
  });
  return a;
}

CellArray make_cells(const ObjFile& o, size_t k, bool expanded, size_t points_before) {
  CellArray r;
  if (o.cells[k] == 0) return r;
  int32_t* ids = nullptr;
  r.connectivity = Array::make<int32_t>(o.corners[k], 1, &ids);
  const uint32_t n = [&] {
    for (const ObjChunk& c : o.chunks)
      if (!c.cells[k].lengths.empty()) return c.cells[k].lengths[0];
    return 0u;
  }();
  const bool uniform = parallel_reduce(
      o.chunks.size(), 1, true,
      [&](size_t c, size_t) {
        const auto& l = o.chunks[c].cells[k].lengths;
        return std::all_of(l.begin(), l.end(), [&](uint32_t v) { return v == n; });
      },
      [](bool a, bool b) { return a && b; });
  int32_t* offsets = nullptr;
  if (uniform) r.fixed = int(n);
  else r.offsets = Array::make<int32_t>(o.cells[k] + 1, 1, &offsets), offsets[o.cells[k]] = int32_t(o.corners[k]);
  parallel_for(o.chunks.size(), 1, [&](size_t c, size_t) {
    const ObjCells& cells = o.chunks[c].cells[k];
    const size_t at = o.first_corner[k][c];
    if (expanded) std::iota(ids + at, ids + at + cells.v.size(), int32_t(points_before + at));
    else if (!cells.v.empty()) std::memcpy(ids + at, cells.v.data(), cells.v.size() * sizeof(int32_t));
    if (offsets) {
      size_t p = at;
      for (size_t i = 0; i < cells.lengths.size(); ++i) offsets[o.first_cell[k][c] + i] = int32_t(p), p += cells.lengths[i];
    }
  });
  return r;
}

// A run of cells in file order that share group and material.
struct Run {
  std::array<size_t, kinds> begin{};
  int64_t group = 0;
  int32_t material = -1;  ///< place in `materials`, -1 = none
};

struct Labels {
  std::vector<Run> runs;
  std::vector<std::string_view> groups, materials, libraries;
  std::vector<size_t> uses;  ///< runs of each material between usemtl statements
};

Labels find_labels(const ObjFile& o) {
  Labels l;
  l.runs.push_back({});
  int64_t group = -1;
  int32_t material = -1;
  std::vector<std::pair<std::string_view, int32_t>> known;  // sorted by name
  for (size_t c = 0; c < o.chunks.size(); ++c) {
    l.libraries.insert(l.libraries.end(), o.chunks[c].libraries.begin(), o.chunks[c].libraries.end());
    for (const ObjMark& m : o.chunks[c].marks) {
      Run run;
      for (size_t k = 0; k < kinds; ++k) run.begin[k] = o.first_cell[k][c] + m.cells[k];
      if (m.material) {
        const auto at =
            std::lower_bound(known.begin(), known.end(), m.name, [](const auto& a, std::string_view name) { return a.first < name; });
        if (at != known.end() && at->first == m.name) {
          material = at->second;
        } else {
          material = int32_t(l.materials.size());
          known.insert(at, {m.name, material});
          l.materials.push_back(m.name);
          l.uses.push_back(0);
        }
        ++l.uses[size_t(material)];
      } else {
        // Cells before the first g are group 0 too, so that the first g after them begins group 1.
        if (group < 0 && run.begin != std::array<size_t, kinds>{}) group = 0, l.groups.emplace_back();
        ++group;
        l.groups.push_back(m.name);
      }
      run.group = std::max<int64_t>(group, 0);
      run.material = material;
      l.runs.push_back(run);
    }
  }
  return l;
}

// Numbers of the materials. They follow VTK's table (first material, NO_MATERIAL, others in order of appearance), so number 1
// is kept for cells without a material; where no such cells exist and the first material has one run only, it is number 1, as in
// VTK. Unlike VTK, one material has one number everywhere.
int32_t material_number(const Labels& l, int32_t material, bool cells_without) {
  if (material < 0) return 1;
  if (material == 0) return cells_without || l.uses[0] > 1 ? 0 : 1;
  return material + 1;
}

// What the libraries say of the materials, by their numbers.
std::map<int32_t, ObjMaterial> known_materials(const Labels& l, bool without, const std::string& path, Context& context) {
  const auto known = read_obj_materials(path, l.libraries, context);
  std::map<int32_t, ObjMaterial> of_number;
  for (size_t m = 0; m < l.materials.size(); ++m)
    if (const auto found = known.find(std::string(l.materials[m])); found != known.end())
      of_number[material_number(l, int32_t(m), without)] = found->second;
  return of_number;
}

std::shared_ptr<const MaterialTable> table_of(const std::map<int32_t, ObjMaterial>& materials) {
  if (materials.empty()) return nullptr;
  auto table = std::make_shared<MaterialTable>();
  for (const auto& [number, m] : materials) table->looks[number] = m.look;
  return table;
}

// The diffuse colour of each material's cells; light grey where it has none. Empty when no material has one.
Array material_colors(const std::map<int32_t, ObjMaterial>& materials, const int32_t* numbers, size_t cells) {
  std::map<int32_t, Vec3f> of_number;
  for (const auto& [number, m] : materials)
    if (m.diffuse) of_number[number] = *m.diffuse;
  if (of_number.empty()) return {};
  uint8_t* out = nullptr;
  Array colors = Array::make<uint8_t>(cells, 3, &out);
  parallel_for(cells, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto found = of_number.find(numbers[i]);
      const Vec3f c = found != of_number.end() ? found->second : Vec3f(0.8f, 0.8f, 0.8f);
      for (int k = 0; k < 3; ++k) out[3 * i + size_t(k)] = uint8_t(c[k] * 255 + 0.5f);
    }
  });
  return colors;
}

void add_labels(const ObjFile& o, const std::string& path, bool with_colors, DatasetParts& parts, Context& context) {
  const Labels l = find_labels(o);
  const size_t total = o.cells[0] + o.cells[1] + o.cells[2];
  for (std::string_view name : l.libraries) parts.notes.emplace_back("MaterialLibrary", std::string(name));
  auto run_end = [&](size_t r, size_t k) { return r + 1 < l.runs.size() ? l.runs[r + 1].begin[k] : o.cells[k]; };
  bool without = false;
  for (size_t r = 0; r < l.runs.size(); ++r)
    for (size_t k = 0; k < kinds; ++k) without = without || (l.runs[r].material < 0 && run_end(r, k) > l.runs[r].begin[k]);
  float* group = nullptr;
  int32_t* material = nullptr;
  Array groups = Array::make<float>(total, 1, &group), materials;
  if (!l.materials.empty()) materials = Array::make<int32_t>(total, 1, &material);
  parallel_for(l.runs.size(), 64, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      size_t before = 0;
      for (size_t k = 0; k < kinds; before += o.cells[k++])
        for (size_t i = l.runs[r].begin[k]; i < run_end(r, k); ++i) {
          group[before + i] = float(l.runs[r].group);
          if (material) material[before + i] = material_number(l, l.runs[r].material, without);
        }
    }
  });
  if (material) {
    const auto known = known_materials(l, without, path, context);
    if (with_colors)
      if (Array colors = material_colors(known, material, total); !colors.empty())
        parts.fields.add({"MaterialColors", Association::cell, std::move(colors), "", Role::colors});
    parts.fields.add({"MaterialIds", Association::cell, std::move(materials), "", Role::labels, {}, table_of(known)});
    std::string names;
    LabelNames labels("MaterialIds");  // for legends
    for (size_t m = 0; m < l.materials.size(); ++m) {
      const int32_t number = material_number(l, int32_t(m), without);
      names += fmt::format("{}{} {}", m ? "\n" : "", number, l.materials[m]);
      labels.add(number, std::string(l.materials[m]));
    }
    parts.notes.emplace_back("MaterialNames", names);
    parts.notes.push_back(labels.note());
  }
  // An id, not a value: no picture is coloured by it unless asked.
  parts.fields.add({"GroupIds", Association::cell, std::move(groups), "", Role::global_ids});
  if (!l.groups.empty() && l.groups.size() <= 1000) {
    std::string names;
    for (size_t g = 0; g < l.groups.size(); ++g) names += fmt::format("{}{} {}", g ? "\n" : "", g, l.groups[g]);
    parts.notes.emplace_back("GroupNames", names);
  }
}

// Colours 0..1 as bytes; vertices without one are white.
Array make_colors(const ObjFile& o) {
  uint8_t* out = nullptr;
  Array a = Array::make<uint8_t>(o.v, 3, &out);
  parallel_for(o.chunks.size(), 1, [&](size_t c, size_t) {
    const ObjChunk& chunk = o.chunks[c];
    for (size_t i = 0; i < chunk.xyz.size(); ++i) {
      const float v = i < chunk.colors.size() ? chunk.colors[i] : std::nanf("");
      out[o.first_v[c] * 3 + i] = v != v ? uint8_t(255) : uint8_t(std::clamp(v, 0.0f, 1.0f) * 255 + 0.5f);
    }
  });
  return a;
}

// Per-vertex values when the corners' numbers are those of the vertices; vertices that have none get NaN.
Array fit(const Array& a, size_t count) {
  if (a.count() == count) return a;
  const auto n = size_t(a.components());
  float* out = nullptr;
  Array r = Array::make<float>(count, a.components(), &out);
  const size_t have = std::min(count, a.count()) * n;
  std::memcpy(out, a.view<float>().data, have * sizeof(float));
  std::fill(out + have, out + count * n, std::nanf(""));
  return r;
}

// What write_obj() makes of a surface without points; any other text without a vertex is not an OBJ file.
bool only_comments(std::string_view text) {
  bool comment = false;
  while (!text.empty()) {
    const std::string_view line = trim(text.substr(0, text.find('\n')));
    if (!line.empty() && line[0] != '#') return false;
    comment = comment || !line.empty();
    text.remove_prefix(std::min(text.size(), text.find('\n') == std::string_view::npos ? text.size() : text.find('\n') + 1));
  }
  return comment;
}

}  // namespace

Data read_obj(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  ObjFile o;
  parse(file, o, context);
  resolve_all(o, context);
  if (o.v == 0 && !only_comments(o.text)) fail_data("there are no vertices", path, "an OBJ file has lines like 'v 1 2 3' and 'f 1 2 3'");

  DatasetParts parts;
  SurfaceMesh mesh;
  const bool expanded = !same_indices(o);
  auto add = [&](const char* name, Array a, Role role) {
    if (options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end())
      parts.fields.add({name, Association::point, std::move(a), "", role});
  };
  const Array xyz = gather(o, &ObjChunk::xyz, o.first_v, o.v, 3);
  mesh.points.xyz = expanded ? expand(o, xyz, &ObjCells::v) : xyz;
  if (o.has_t) {
    const Array t = gather(o, &ObjChunk::tcoords, o.first_t, o.t, 2);
    add("TCoords", expanded ? expand(o, t, &ObjCells::t) : fit(t, o.v), Role::tcoords);
  }
  if (o.has_n) {
    const Array n = gather(o, &ObjChunk::normals, o.first_n, o.n, 3);
    add("Normals", expanded ? expand(o, n, &ObjCells::n) : fit(n, o.v), Role::normals);
  }
  if (std::any_of(o.chunks.begin(), o.chunks.end(), [](const ObjChunk& c) { return !c.colors.empty(); })) {
    const Array colors = make_colors(o);
    if (!expanded) {
      add("RGB", colors, Role::colors);
    } else {
      add("RGB", expand(o, colors.converted(ElementType::f32), &ObjCells::v).converted(ElementType::u8), Role::colors);
    }
  }
  CellArray* lists[kinds] = {&mesh.vertices, &mesh.lines, &mesh.polygons};
  size_t before = 0;
  for (size_t k = 0; k < kinds; before += o.corners[k++]) *lists[k] = make_cells(o, k, expanded, before);
  const bool vertex_colors = parts.fields.with_role(Role::colors);
  const bool asked =
      options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), "MaterialColors") != options.fields.end();
  add_labels(o, path, asked && !vertex_colors, parts, context);
  parts.mesh = std::move(mesh);
  return make_dataset(std::move(parts));
}

namespace {

// What of the fields becomes part of the vertices and groups; null: nothing.
struct ObjFields {
  const Field *normals = nullptr, *tcoords = nullptr, *colors = nullptr, *group = nullptr;
};

ObjFields fields_to_write(const Dataset& d, const std::string& path, Context& context) {
  ObjFields r;
  for (const Field& f : d.fields()) {
    if (f.association != Association::point) continue;
    if (f.role == Role::normals && f.components() == 3) r.normals = &f;
    if (f.role == Role::tcoords && f.components() == 2) r.tcoords = &f;
    if (f.role == Role::colors && f.components() >= 3 && f.array.type() == ElementType::u8) r.colors = &f;
  }
  r.group = d.fields().find("GroupIds", Association::cell);
  if (r.group && r.group->components() != 1) r.group = nullptr;
  WriteLosses losses(path, "OBJ");
  for (const Field& f : d.fields()) {
    const char* name = &f == r.normals   ? "Normals"
                       : &f == r.tcoords ? "TCoords"
                       : &f == r.colors  ? "RGB"
                       : &f == r.group   ? "GroupIds"
                                         : nullptr;
    if (!name) {
      losses.leaves_out(f);
      continue;
    }
    losses.renames(f, name);
    losses.drops_unit(f);
    if (&f == r.normals || &f == r.tcoords) losses.rounds(f, ElementType::f32);
    if (&f == r.colors && f.components() > 3) losses.also(fmt::format("drops the opacity of '{}'", f.name));
  }
  losses.tell(context);
  return r;
}

}  // namespace

void write_obj(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  const DatasetPtr d = single_dataset(data, "writing OBJ");
  const SurfaceMesh& mesh = surface_to_write(*d, "OBJ", path);
  const auto [normals, tcoords, colors, group] = fields_to_write(*d, path, context);
  AtomicFile file(path);
  std::string text = "# written by sightglass\n";
  auto flush = [&](size_t limit) {
    if (text.size() > limit) file.write(text), text.clear();
  };
  const Vec3 o = mesh.points.origin;
  const bool wide = mesh.points.xyz.type() == ElementType::f64 || o.x != 0 || o.y != 0 || o.z != 0;
  const Array places = !tcoords ? Array() : runs_down(tcoords->name) ? turned_round(tcoords->array) : tcoords->array;
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 p = mesh.points.at(i);
    if (wide) text += fmt::format("v {} {} {}", p.x, p.y, p.z);
    else text += fmt::format("v {} {} {}", float(p.x), float(p.y), float(p.z));
    if (colors)
      text +=
          fmt::format(" {:.4g} {:.4g} {:.4g}", colors->array.get(i, 0) / 255, colors->array.get(i, 1) / 255, colors->array.get(i, 2) / 255);
    text += '\n';
    if (tcoords) text += fmt::format("vt {} {}\n", float(places.get(i, 0)), float(places.get(i, 1)));
    if (normals)
      text +=
          fmt::format("vn {} {} {}\n", float(normals->array.get(i, 0)), float(normals->array.get(i, 1)), float(normals->array.get(i, 2)));
    flush(1 << 20);
  }
  double in_group = std::nan("");
  auto cell = [&](const char* word, const int64_t* ids, size_t n, bool corners, size_t number) {
    if (group && group->array.get(number) != in_group)
      text += fmt::format("g group{}\n", exact_number(in_group = group->array.get(number)));
    text += word;
    for (size_t k = 0; k < n; ++k) {
      const int64_t id = ids[k] + 1;
      if (corners && tcoords && normals) text += fmt::format(" {}/{}/{}", id, id, id);
      else if (corners && tcoords) text += fmt::format(" {}/{}", id, id);
      else if (corners && normals) text += fmt::format(" {}//{}", id, id);
      else text += fmt::format(" {}", id);
    }
    text += '\n';
    flush(1 << 20);
  };
  size_t number = 0;
  auto simple = [&](const char* word, const CellArray& cells) {
    const CellsView v = cells_view(cells);
    std::vector<int64_t> ids;
    for (size_t c = 0; c < v.count; ++c, ++number) {
      ids.clear();
      for (size_t k = v.begin(c); k < v.end(c); ++k) ids.push_back(v.connectivity[k]);
      if (ids.size() >= (word[0] == 'l' ? 2u : 1u)) cell(word, ids.data(), ids.size(), false, number);
    }
  };
  simple("p", mesh.vertices);
  simple("l", mesh.lines);
  const PolygonList faces = surface_polygons(mesh);
  for (size_t f = 0; f < faces.source.size(); ++f)
    if (const size_t n = faces.offsets[f + 1] - faces.offsets[f]; n >= 3)
      cell("f", faces.ids.data() + faces.offsets[f], n, true, faces.source[f]);
  file.write(text);
  file.commit();
}

}  // namespace sg
