// SPDX-License-Identifier: Apache-2.0
// VTKHDF files, writing: uniform grids, unstructured and surface meshes, point clouds, AMR grids; one partition, one step. Version 1.0
// where that has the kind (so that VTK 9.1 reads it), else 2.0, 2.5 with polyhedra.
#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/text/text.h"
#include "data/lattice.h"
#include "io/plugins/hdf5/h5_write.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf_out.h"
#include "io/write_losses.h"

namespace sg {

namespace vtkhdf {

std::string safe_name(std::string name, std::vector<std::string>& used) {
  for (char& c : name)
    if (c == '/') c = '_';
  if (name.empty() || name == ".") name = "unnamed";
  while (std::find(used.begin(), used.end(), name) != used.end()) name += "_";
  used.push_back(name);
  return name;
}

const char* attribute_of(Role role) {
  constexpr std::pair<Role, const char*> roles[] = {{Role::scalars, "Scalars"}, {Role::vectors, "Vectors"},
                                                    {Role::normals, "Normals"}, {Role::tcoords, "TCoords"},
                                                    {Role::tensors, "Tensors"}, {Role::global_ids, "GlobalIds"}};
  for (const auto& [r, attribute] : roles)
    if (r == role) return attribute;
  return nullptr;
}

Array coordinates(const Points& p) {
  if (p.origin == Vec3{0, 0, 0}) return p.xyz;
  double* out = nullptr;
  Array a = Array::make<double>(p.count(), 3, &out);
  for (size_t i = 0; i < p.count(); ++i)
    for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = p.at(i)[c];
  return a;
}

Array wide(const Array& ids) { return ids.converted(ElementType::i64); }

void write_head(h5::Writer& w, const std::string& at, const char* type, int64_t major, int64_t minor) {
  w.group(at);
  w.numbers<int64_t>(at, "Version", {major, minor});
  w.text(at, "Type", type);
}

void write_head(h5::Writer& w, const std::string& at, const UniformGrid& g) {
  std::vector<int64_t> extent;
  std::vector<double> direction;
  Vec3 back{0, 0, 0};
  for (size_t a = 0; a < 3; ++a) {
    extent.insert(extent.end(), {g.extent_start[a], g.extent_start[a] + static_cast<long long>(g.dims[a]) - 1});
    back[int(a)] = g.spacing[int(a)] * double(g.extent_start[a]);
    for (size_t b = 0; b < 3; ++b) direction.push_back(g.direction.m[a][b]);
  }
  const Vec3 origin = g.origin - g.direction * back;  // of the point with index 0 0 0
  w.numbers<int64_t>(at, "WholeExtent", extent);
  w.numbers<double>(at, "Origin", {origin.x, origin.y, origin.z});
  w.numbers<double>(at, "Spacing", {g.spacing.x, g.spacing.y, g.spacing.z});
  w.numbers<double>(at, "Direction", direction);
}

void refuse_kind(const Dataset& d, const std::string& path) {
  fail_usage(fmt::format("VTKHDF has no grids of kind {}", d.kind()), path, "write .vtr or .vts, or convert it to cells first");
}

namespace {

using h5::Writer;

struct Out {
  Writer& w;
  const Dataset& d;
  std::string at;  ///< the group
  WriteLosses& losses;

  std::string operator()(const std::string& name) const { return at + "/" + name; }
};

void head(const Out& o, const char* type, int64_t major, int64_t minor) { write_head(o.w, o.at, type, major, minor); }

// Fields of one association; `lattice` has the dimensions of a grid (x first), or is empty for lists.
void write_fields(const Out& o, const std::string& group, Association association, const std::vector<size_t>& lattice) {
  o.w.group(o(group));
  auto put = [&](const std::string& name, const Array& a) {
    std::vector<hsize_t> dims(lattice.rbegin(), lattice.rend());
    if (dims.empty()) return o.w.list(o(group + "/" + name), a);
    if (a.components() > 1) dims.push_back(hsize_t(a.components()));
    o.w.array(o(group + "/" + name), a, dims);
  };
  std::vector<std::string> used;
  for (const Field& f : o.d.fields()) {
    if (f.association != association) continue;
    const std::string name = safe_name(f.name, used);
    o.losses.renames(f, name);
    put(name, f.array);
    if (!f.unit.empty()) o.w.text(o(group + "/" + name), "units", f.unit);
    if (const char* attribute = attribute_of(f.role); attribute && o.d.fields().with_role(f.role) == &f)
      o.w.text(o(group), attribute, name);
  }
  // What shapes high-order cells: the mesh's own, unless the file that was read kept it as a field.
  const auto* u = o.d.as<UnstructuredMesh>();
  const Array shape = !u || association == Association::whole ? Array() : association == Association::point ? u->weights : u->degrees;
  const char* shaping = association == Association::point ? "RationalWeights" : "HigherOrderDegrees";
  if (!shape.empty()) {
    if (!o.d.fields().find(shaping, association)) put(shaping, shape.converted(ElementType::f64));
    o.w.text(o(group), shaping, shaping);
  }
  const Array& ghost = association == Association::point ? o.d.point_ghost() : o.d.cell_ghost();
  if (association != Association::whole && !ghost.empty()) put("vtkGhostType", ghost);
}

/// Offsets and ids of a list of cells, with their numbers.
void write_list(const Out& o, const std::string& at, const CellArray& cells) {
  const size_t n = cells.size();
  const CellsView v = cells_view(cells);
  int64_t* offsets = nullptr;
  const Array starts = Array::make<int64_t>(n + 1, 1, &offsets);
  for (size_t i = 0; i <= n; ++i) offsets[i] = i == 0 ? 0 : int64_t(v.end(i - 1));
  o.w.count(o(at + "NumberOfCells"), n);
  o.w.count(o(at + "NumberOfConnectivityIds"), size_t(offsets[n]));
  o.w.list(o(at + "Offsets"), starts);
  o.w.list(o(at + "Connectivity"), wide(cells.connectivity.slice(0, size_t(offsets[n]))));
}

void write_points(const Out& o, const Points& p) {
  o.w.count(o("NumberOfPoints"), p.count());
  if (p.count() > 0) o.w.list(o("Points"), coordinates(p));
  else o.w.array(o("Points"), Array::from_vector(std::vector<float>{}), {0, 3});
}

void write(const Out& o, const UniformGrid& g) {
  head(o, "ImageData", 1, 0);
  write_head(o.w, o.at, g);
  std::vector<size_t> points(g.dims.begin(), g.dims.end()), cells;
  for (const size_t n : points) cells.push_back(std::max<size_t>(n - 1, 1));
  write_fields(o, "PointData", Association::point, points);
  write_fields(o, "CellData", Association::cell, cells);
}

void write_faces(const Out& o, const UnstructuredMesh& m) {
  const CellsView v = cells_view(m.faces);
  std::vector<int64_t> offsets{0}, numbers(m.faces.size());
  for (size_t f = 0; f < v.count; ++f) offsets.push_back(int64_t(v.end(f)));
  std::iota(numbers.begin(), numbers.end(), int64_t(0));
  const auto ids = size_t(offsets.back());
  o.w.count(o("NumberOfFaces"), numbers.size());
  o.w.count(o("NumberOfFaceConnectivityIds"), ids);
  o.w.count(o("NumberOfPolyhedronToFaceIds"), numbers.size());
  o.w.list(o("FaceConnectivity"), wide(m.faces.connectivity.slice(0, ids)));
  o.w.list(o("FaceOffsets"), Array::from_vector(std::move(offsets)));
  o.w.list(o("PolyhedronToFaces"), Array::from_vector(std::move(numbers)));
  o.w.list(o("PolyhedronOffsets"), m.polyhedron_faces);
}

void write(const Out& o, const UnstructuredMesh& m) {
  const bool faces = !m.polyhedron_faces.empty();
  head(o, "UnstructuredGrid", faces ? 2 : 1, faces ? 5 : 0);
  write_points(o, m.points);
  write_list(o, "", m.cells);
  std::vector<uint8_t> types(m.cells.size());
  for (size_t c = 0; c < types.size(); ++c) types[c] = uint8_t(m.type(c));
  o.w.list(o("Types"), Array::from_vector(std::move(types)));
  if (faces) write_faces(o, m);
  write_fields(o, "PointData", Association::point, {});
  write_fields(o, "CellData", Association::cell, {});
}

void write(const Out& o, const SurfaceMesh& m) {
  head(o, "PolyData", 2, 0);
  write_points(o, m.points);
  for (const auto& [name, list] : {std::pair("Vertices", &m.vertices), std::pair("Lines", &m.lines), std::pair("Polygons", &m.polygons),
                                   std::pair("Strips", &m.strips)}) {
    o.w.group(o(name));
    write_list(o, std::string(name) + "/", *list);
  }
  write_fields(o, "PointData", Association::point, {});
  write_fields(o, "CellData", Association::cell, {});
}

void write(const Out& o, const PointCloud& m) {
  SurfaceMesh s;
  s.points = m.points;
  write(o, s);
  o.w.text(o.at, "Kind", "points");  // ours: a surface without cells is another thing
}

void write(const Out& o, const AmrGrid& g) {
  head(o, "OverlappingAMR", 1, 0);
  o.w.numbers<double>(o.at, "Origin", {g.origin.x, g.origin.y, g.origin.z});
  o.w.text(o.at, "GridDescription", g.dimension == 2 ? "XY" : "XYZ");
  for (size_t l = 0; l < g.levels.size(); ++l) {
    const auto& level = g.levels[l];
    DatasetParts slice;  // the fields of this level
    size_t cell = SIZE_MAX, cell_end = 0, point = SIZE_MAX, point_end = 0;
    std::vector<int64_t> boxes;
    for (const auto& p : level.patches) {
      const auto c = p.cells();
      cell = std::min(cell, p.cell_offset), cell_end = std::max(cell_end, p.cell_offset + c[0] * c[1] * c[2]);
      const size_t n = (c[0] + 1) * (c[1] + 1) * (g.dimension == 2 ? 1 : c[2] + 1);
      point = std::min(point, p.point_offset), point_end = std::max(point_end, p.point_offset + n);
      for (size_t a = 0; a < 3; ++a) boxes.insert(boxes.end(), {p.lo[a], g.dimension == 2 && a == 2 ? p.lo[a] - 1 : p.hi[a]});
    }
    const std::string at = o(fmt::format("Level{}", l));
    o.w.group(at);
    o.w.numbers<double>(at, "Spacing", {level.spacing.x, level.spacing.y, level.spacing.z});
    o.w.array(at + "/AMRBox", Array::from_vector(std::move(boxes), 6), {level.patches.size(), 6});
    for (const auto& [data, association] : {std::pair("PointData", Association::point), std::pair("CellData", Association::cell)}) {
      const bool points = association == Association::point;
      const size_t from = level.patches.empty() ? 0 : points ? point : cell, to = level.patches.empty() ? 0 : points ? point_end : cell_end;
      o.w.group(at + "/" + data);
      std::vector<std::string> used;
      for (const Field& f : o.d.fields())
        if (f.association == association) {
          const std::string safe = safe_name(f.name, used), name = at + "/" + data + "/" + safe;
          o.losses.renames(f, safe);
          o.w.list(name, f.array.slice(from, to));
          if (!f.unit.empty()) o.w.text(name, "units", f.unit);
        }
      const Array& ghost = points ? o.d.point_ghost() : o.d.cell_ghost();
      if (!ghost.empty()) o.w.list(at + "/" + data + "/vtkGhostType", ghost.slice(from, to));
    }
  }
}

void write_kind(const Out& o) {
  std::visit(
      [&](const auto& mesh) {
        using M = std::remove_cvref_t<decltype(mesh)>;
        if constexpr (std::is_same_v<M, RectilinearGrid> || std::is_same_v<M, CurvilinearGrid>) refuse_kind(o.d, o.w.path());
        else write(o, mesh);
      },
      o.d.mesh());
  write_fields(o, "FieldData", Association::whole, {});
  if (!o.d.time()) return;
  o.w.list(o("FieldData/TimeValue"), Array::from_vector(std::vector<double>{*o.d.time()}));
}

}  // namespace
}  // namespace vtkhdf

void write_vtkhdf(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const DatasetPtr d = single_dataset(data, "a VTKHDF file");
  const Compression compression = options.compression.value_or(Compression::none);
  if (compression != Compression::none && compression != Compression::zlib)
    fail_usage(fmt::format("VTKHDF files cannot be compressed with '{}'", word_of(compression)), path, "use zlib or none");
  const h5::Turn turn;
  h5::Writer writer(path, compression == Compression::zlib, context);
  WriteLosses losses(path, "VTKHDF");
  vtkhdf::write_kind({writer, *d, "/VTKHDF", losses});
  writer.commit();
  losses.tell(context);
}

}  // namespace sg
