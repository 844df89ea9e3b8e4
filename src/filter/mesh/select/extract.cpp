// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/extract.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/trusted.h"
#include "filter/mesh/select/id_set.h"
#include "filter/mesh/select/lattice_cells.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

constexpr size_t ids_per_chunk = 1 << 13;

// Chosen lists of a CellArray, their ids in a new numbering.
template <class CellOf, class Number>
CellArray chosen_lists(const CellsView& v, size_t count, const CellOf& cell_of, const Number& number, std::string_view who) {
  CellArray r;
  if (count == 0) return r;
  std::vector<size_t> start((count + ids_per_chunk - 1) / ids_per_chunk);
  parallel_for(count, ids_per_chunk, [&](size_t begin, size_t end) {
    size_t n = 0;
    for (size_t i = begin; i < end; ++i) n += v.size(cell_of(i));
    start[begin / ids_per_chunk] = n;
  });
  const size_t ids = exclusive_scan(start);
  if (ids > size_t(INT32_MAX)) fail_usage("the result has more than 2^31 corners", std::string(who), "take a part of the mesh first");
  int32_t *to = nullptr, *offset = nullptr;
  r.connectivity = Array::make<int32_t>(ids, 1, &to);
  if (v.fixed > 0) r.fixed = v.fixed;
  else r.offsets = Array::make<int32_t>(count + 1, 1, &offset);
  parallel_for(count, ids_per_chunk, [&](size_t begin, size_t end) {
    size_t at = start[begin / ids_per_chunk];
    for (size_t i = begin; i < end; ++i) {
      const size_t c = cell_of(i);
      if (offset) offset[i] = int32_t(at);
      for (size_t k = v.begin(c); k < v.end(c); ++k) to[at++] = number(v.connectivity[k]);
    }
  });
  if (offset) offset[count] = int32_t(ids);
  return r;
}

void mark_points(IdSet& used, const CellsView& v, std::span<const int64_t> cells, int64_t first) {
  parallel_for(cells.size(), ids_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto c = size_t(cells[i] - first);
      for (size_t k = v.begin(c); k < v.end(c); ++k) used.add(size_t(v.connectivity[k]));
    }
  });
}

void extract_unstructured(const UnstructuredMesh& m, std::span<const int64_t> cells, DatasetParts& out, std::vector<int64_t>& points,
                          std::string_view who) {
  const CellsView v = cells_view(m.cells), faces = cells_view(m.faces);
  const bool polyhedra = !m.polyhedron_faces.empty();
  const int64_t* first_face = polyhedra ? m.polyhedron_faces.view<int64_t>().data : nullptr;
  IdSet used(m.points.count());
  mark_points(used, v, cells, 0);
  std::vector<int64_t> kept_faces, face_start(1, 0);
  if (polyhedra) {
    for (int64_t c : cells) {
      for (int64_t f = first_face[c]; f < first_face[c + 1]; ++f) kept_faces.push_back(f);
      face_start.push_back(int64_t(kept_faces.size()));
    }
    mark_points(used, faces, kept_faces, 0);
  }
  used.number();
  points = used.members();
  auto number = [&](int64_t id) { return int32_t(used.rank(size_t(id))); };
  UnstructuredMesh r;
  r.points = gather_points(m.points, points);
  r.cells = chosen_lists(
      v, cells.size(), [&](size_t i) { return size_t(cells[i]); }, number, who);
  r.single_type = m.single_type;
  if (!m.types.empty()) r.types = gather(m.types, cells);
  if (!m.degrees.empty()) r.degrees = gather(m.degrees, cells);
  if (!m.weights.empty()) r.weights = gather(m.weights, points);
  if (!kept_faces.empty()) {
    r.faces = chosen_lists(
        faces, kept_faces.size(), [&](size_t i) { return size_t(kept_faces[i]); }, number, who);
    r.polyhedron_faces = Array::from_vector(std::move(face_start));
  }
  out.mesh = std::move(r);
}

void extract_surface(const SurfaceMesh& m, std::span<const int64_t> cells, DatasetParts& out, std::vector<int64_t>& points,
                     std::string_view who) {
  const CellArray* parts[4] = {&m.vertices, &m.lines, &m.polygons, &m.strips};
  SurfaceMesh r;
  CellArray* results[4] = {&r.vertices, &r.lines, &r.polygons, &r.strips};
  std::span<const int64_t> of_part[4];
  int64_t first[4], at = 0;
  IdSet used(m.points.count());
  for (int k = 0; k < 4; ++k) {
    first[k] = at;
    at += int64_t(parts[k]->size());
    const auto begin = std::lower_bound(cells.begin(), cells.end(), first[k]), end = std::lower_bound(cells.begin(), cells.end(), at);
    of_part[k] = cells.subspan(size_t(begin - cells.begin()), size_t(end - begin));
    mark_points(used, cells_view(*parts[k]), of_part[k], first[k]);
  }
  used.number();
  points = used.members();
  auto number = [&](int64_t id) { return int32_t(used.rank(size_t(id))); };
  for (int k = 0; k < 4; ++k)
    *results[k] = chosen_lists(
        cells_view(*parts[k]), of_part[k].size(), [&, k](size_t i) { return size_t(of_part[k][i] - first[k]); }, number, who);
  r.points = gather_points(m.points, points);
  out.mesh = std::move(r);
}

// Cells of lattices and AMR patches as lists of point ids: `corners` per cell, in the order of the VTK type.
class BoxCells {
 public:
  explicit BoxCells(const Mesh& mesh) {
    if (auto* g = std::get_if<AmrGrid>(&mesh)) {
      axes_ = g->dimension;
      for (const auto& level : g->levels)
        for (const auto& patch : level.patches) {
          const auto n = patch.cells();
          homes_.push_back({patch.cell_offset, patch.point_offset, {n[0], n[1], n[2]}, {n[0] + 1, n[1] + 1, axes_ == 3 ? n[2] + 1 : 1}});
        }
      std::sort(homes_.begin(), homes_.end(), [](const Home& a, const Home& b) { return a.first_cell < b.first_cell; });
      type_ = axes_ == 3 ? CellType::voxel : CellType::pixel;
    } else {
      const auto d = lattice_dims(mesh);
      homes_.push_back({0, 0, {std::max<size_t>(d[0], 2) - 1, std::max<size_t>(d[1], 2) - 1, std::max<size_t>(d[2], 2) - 1}, d});
      axes_ = int(d[0] > 1) + int(d[1] > 1) + int(d[2] > 1);
      bool box = !std::holds_alternative<CurvilinearGrid>(mesh);
      if (auto* g = std::get_if<UniformGrid>(&mesh))  // voxels and pixels lie along the axes: those of turned grids do not
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) box = box && (r == c || g->direction.m[r][c] == 0);
      if (auto* g = std::get_if<UniformGrid>(&mesh); g && !box && axes_ == 3)  // no hexahedron is inside out
        mirrored_ = dot(cross(g->direction.column(0) * g->spacing[0], g->direction.column(1) * g->spacing[1]),
                        g->direction.column(2) * g->spacing[2]) < 0;
      const CellType types[] = {CellType::vertex, CellType::line, box ? CellType::pixel : CellType::quad,
                                box ? CellType::voxel : CellType::hexahedron};
      type_ = types[axes_];
    }
  }
  CellType type() const { return type_; }
  size_t corners() const { return size_t(1) << axes_; }
  void read(size_t cell, int64_t* ids) const {
    const Home& h =
        *(std::upper_bound(homes_.begin(), homes_.end(), cell, [](size_t c, const Home& home) { return c < home.first_cell; }) - 1);
    const size_t local = cell - h.first_cell;
    const size_t at[3] = {local % h.cells[0], local / h.cells[0] % h.cells[1], local / (h.cells[0] * h.cells[1])};
    size_t stride[3] = {1, h.points[0], h.points[0] * h.points[1]}, step[3], n = 0;
    for (int a = 0; a < 3; ++a)
      if (h.points[size_t(a)] > 1) step[n++] = stride[a];
    const size_t first = h.first_point + at[0] * stride[0] + at[1] * stride[1] + at[2] * stride[2];
    const bool ring = type_ == CellType::quad || type_ == CellType::hexahedron;
    for (size_t c = 0; c < corners(); ++c) {
      const size_t x = (ring ? (c ^ (c >> 1)) & 1 : c & 1) ^ size_t(mirrored_);
      size_t id = first;
      if (n > 0) id += x * step[0];
      if (n > 1) id += (c >> 1 & 1) * step[1];
      if (n > 2) id += (c >> 2 & 1) * step[2];
      ids[c] = int64_t(id);
    }
  }

 private:
  struct Home {
    size_t first_cell, first_point;
    std::array<size_t, 3> cells, points;
  };
  std::vector<Home> homes_;
  int axes_ = 3;
  bool mirrored_ = false;
  CellType type_ = CellType::voxel;
};

void extract_boxes(const Dataset& in, std::span<const int64_t> cells, DatasetParts& out, std::vector<int64_t>& points,
                   std::string_view who) {
  const BoxCells box(in.mesh());
  const size_t corners = box.corners();
  if (cells.size() * corners > size_t(INT32_MAX))
    fail_usage("the result has more than 2^31 corners", std::string(who), "take a part of the mesh first");
  IdSet used(in.point_count());
  parallel_for(cells.size(), ids_per_chunk, [&](size_t begin, size_t end) {
    int64_t ids[8];
    for (size_t i = begin; i < end; ++i) {
      box.read(size_t(cells[i]), ids);
      for (size_t c = 0; c < corners; ++c) used.add(size_t(ids[c]));
    }
  });
  used.number();
  points = used.members();
  UnstructuredMesh r;
  int32_t* to = nullptr;
  r.cells.connectivity = Array::make<int32_t>(cells.size() * corners, 1, &to);
  r.cells.fixed = int(corners);
  r.single_type = box.type();
  parallel_for(cells.size(), ids_per_chunk, [&](size_t begin, size_t end) {
    int64_t ids[8];
    for (size_t i = begin; i < end; ++i) {
      box.read(size_t(cells[i]), ids);
      for (size_t c = 0; c < corners; ++c) to[i * corners + c] = int32_t(used.rank(size_t(ids[c])));
    }
  });
  r.points = points_of(in.mesh(), points);
  out.mesh = std::move(r);
}

// Boxes of a lattice of three axes, by bits: runs of cells need no look at each. `ids` of the cells are written where `listed`.
void extract_lattice(const Dataset& in, const BitRows& g, const Bits& cells, const BitRanks& rank, bool listed, UnstructuredMesh& r,
                     Plane<uint32_t>& ids, std::string_view who) {
  constexpr size_t rows = 64;
  std::vector<size_t> first((g.rows() + rows - 1) / rows);
  parallel_for(g.rows(), rows, [&](size_t begin, size_t end) {
    size_t n = 0;
    for (size_t w = begin * g.words; w < end * g.words; ++w) n += count_bits(cells[w]);
    first[begin / rows] = n;
  });
  const size_t count = exclusive_scan(first);
  if (count * 8 > size_t(INT32_MAX)) fail_usage("the result has more than 2^31 corners", std::string(who), "take a part of the mesh first");
  if (listed) ids.resize(count);
  const LatticeCellKind kind = lattice_cell_kind(in.mesh());
  int32_t* to = nullptr;
  r.cells.connectivity = Array::make<int32_t>(count * 8, 1, &to);
  r.cells.fixed = 8;
  r.single_type = kind.type;
  parallel_for(g.rows(), rows, [&](size_t begin, size_t end) {
    const size_t at = first[begin / rows];
    write_lattice_cells(g, kind, cells, rank, begin, end, to + 8 * at, listed ? ids.data() + at : nullptr);
  });
}

// The chosen points' share of an array of all points.
Array chosen_points(const Array& a, const BitRows& g, const BitRanks& rank) {
  std::byte* to = nullptr;
  Array r = Array::make_raw(a.type(), rank.total, a.components(), &to);
  copy_lattice_points(a, g, rank, to);
  return r;
}

// The cells whose byte is not zero, ascending.
std::vector<int64_t> chosen_cells(const std::vector<uint8_t>& keep) {
  std::vector<size_t> start((keep.size() + ids_per_chunk - 1) / ids_per_chunk);
  parallel_for(keep.size(), ids_per_chunk, [&](size_t begin, size_t end) {
    size_t n = 0;
    for (size_t c = begin; c < end; ++c) n += keep[c] != 0;
    start[begin / ids_per_chunk] = n;
  });
  std::vector<int64_t> r(exclusive_scan(start));
  parallel_for(keep.size(), ids_per_chunk, [&](size_t begin, size_t end) {
    size_t at = start[begin / ids_per_chunk];
    for (size_t c = begin; c < end; ++c)
      if (keep[c]) r[at++] = int64_t(c);
  });
  return r;
}

}  // namespace

DatasetPtr extract_marked(const DatasetPtr& in, const std::vector<uint8_t>& keep, std::string_view who) {
  const auto d = lattice_dims(in->mesh());
  if (!is_lattice(in->mesh()) || d[0] < 2 || d[1] < 2 || d[2] < 2 || in->point_count() > size_t(INT32_MAX))
    return extract_cells(in, chosen_cells(keep), who);
  const BitRows g(d);
  Bits cells(g.size());
  parallel_for(g.rows(), 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % g.ny, k = row / g.ny;
      const bool any = j + 1 < g.ny && k + 1 < g.nz;
      const uint8_t* from = keep.data() + (any ? (g.nx - 1) * (j + (g.ny - 1) * k) : 0);
      for (size_t w = 0; w < g.words; ++w) {
        uint8_t bytes[64] = {};
        for (size_t i = 0; any && i < 64 && 64 * w + i + 1 < g.nx; ++i) bytes[i] = from[64 * w + i] != 0;
        cells[row * g.words + w] = packed_bits(bytes);
      }
    }
  });
  return extract_lattice_cells(in, cells, who);
}

DatasetPtr extract_lattice_cells(const DatasetPtr& in, const Bits& cells, std::string_view who) {
  const BitRows g(lattice_dims(in->mesh()));
  Bits used;
  used_points(g, cells, used);
  BitRanks rank;
  rank.number(used);
  bool listed = !in->cell_ghost().empty();
  for (const Field& f : in->fields()) listed = listed || f.association == Association::cell;
  DatasetParts out;
  UnstructuredMesh mesh;
  Plane<uint32_t> ids;
  extract_lattice(*in, g, cells, rank, listed, mesh, ids, who);
  if (auto* c = in->as<CurvilinearGrid>()) {
    mesh.points = {chosen_points(c->points.xyz, g, rank), c->points.origin};
  } else {
    double* xyz = nullptr;
    mesh.points.xyz = Array::make<double>(rank.total, 3, &xyz);
    write_lattice_positions(Lattice(in->mesh()).view(), g, rank, xyz);
  }
  out.mesh = std::move(mesh);
  for (const Field& f : in->fields())
    if (f.association == Association::point) out.fields.add(f.with(chosen_points(f.array, g, rank)));
  carry_gathered(out.fields, in->fields(), Association::cell, std::span<const uint32_t>(ids), Association::cell);
  carry_whole(out.fields, in->fields());
  if (!in->point_ghost().empty()) out.point_ghost = chosen_points(in->point_ghost(), g, rank);
  if (!in->cell_ghost().empty()) out.cell_ghost = gather(in->cell_ghost(), std::span<const uint32_t>(ids));
  out.notes = in->notes();
  out.time = in->time();
  return make_trusted_dataset(std::move(out));
}

DatasetPtr extract_cells(const DatasetPtr& in, std::span<const int64_t> cells, std::string_view who) {
  DatasetParts out;
  std::vector<int64_t> points;
  const bool cloud = in->as<PointCloud>() != nullptr;
  if (cloud) {
    points.assign(cells.begin(), cells.end());
    out.mesh = PointCloud{gather_points(in->as<PointCloud>()->points, points)};
  } else if (auto* m = in->as<UnstructuredMesh>()) {
    extract_unstructured(*m, cells, out, points, who);
  } else if (auto* s = in->as<SurfaceMesh>()) {
    extract_surface(*s, cells, out, points, who);
  } else {
    extract_boxes(*in, cells, out, points, who);
  }
  carry_gathered(out.fields, in->fields(), Association::point, points, Association::point);
  if (!cloud) carry_gathered(out.fields, in->fields(), Association::cell, cells, Association::cell);
  carry_whole(out.fields, in->fields());
  if (!in->point_ghost().empty()) out.point_ghost = gather(in->point_ghost(), points);
  if (!cloud && !in->cell_ghost().empty()) out.cell_ghost = gather(in->cell_ghost(), cells);
  out.notes = in->notes();
  out.time = in->time();
  return make_dataset(std::move(out));
}

}  // namespace sg
