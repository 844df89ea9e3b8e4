// SPDX-License-Identifier: Apache-2.0
#include "data/cells/cell_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "data/lattice.h"

namespace sg {

namespace {

// Positions of listed points, whatever their type and strides.
struct PointSource {
  View<float> f;
  View<double> d;
  bool is_float = false;
  Vec3 origin;

  explicit PointSource(const Points& p) : origin(p.origin) {
    if (p.count() == 0) return;
    is_float = p.xyz.type() == ElementType::f32;
    if (is_float) f = p.xyz.view<float>();
    else d = p.xyz.view<double>();
  }
  Vec3 operator()(size_t i) const {
    if (is_float) return {origin.x + double(f(i, 0)), origin.y + double(f(i, 1)), origin.z + double(f(i, 2))};
    return {origin.x + d(i, 0), origin.y + d(i, 1), origin.z + d(i, 2)};
  }
};

struct AmrPatch {
  size_t cell_begin, point_begin;
  std::array<size_t, 3> cells, points;
  Vec3 origin, spacing;
};

// The corners of a cell of a lattice: bit a of `corner` steps along the a-th axis that has cells.
constexpr uint8_t box_corners[8] = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr uint8_t ring_corners[8] = {0, 1, 3, 2, 4, 5, 7, 6};

}  // namespace

struct CellReader::Source {
  DatasetPtr dataset;
  enum class Kind { lattice, unstructured, surface, cloud, amr } kind = Kind::cloud;
  size_t count = 0;
  View<uint8_t> ghost, point_ghost;  // data null = none; point_ghost only when a point is hidden
  // Lattices (and the shape of AMR cells): axes with cells, type of the cells.
  std::optional<Lattice> lattice;
  std::array<size_t, 3> cell_dims{1, 1, 1};
  int axes = 0;
  int axis[3] = {0, 1, 2};
  CellType lattice_type = CellType::voxel;
  const uint8_t* corner_order = box_corners;
  size_t corner_step[8][3]{};  // of the corners, from the first one
  size_t corner_id[8]{};
  // Listed points.
  std::optional<PointSource> points;
  // Unstructured.
  const UnstructuredMesh* mesh = nullptr;
  const uint8_t* types = nullptr;
  CellsView cells, faces;
  const int64_t* polyhedron_faces = nullptr;
  View<uint8_t> degrees;
  View<double> weights;
  // Surface: vertices, lines, polygons, strips.
  CellsView part[4];
  size_t part_begin[5] = {0, 0, 0, 0, 0};
  std::vector<AmrPatch> patches;

  explicit Source(DatasetPtr d);
  void open_lattice();
  void open_cell_of_lattice(size_t cell, std::vector<int64_t>& ids, std::vector<Vec3>& at) const;
  void open_unstructured(const UnstructuredMesh& m);
  void open_surface(const SurfaceMesh& m);
  void open_amr(const AmrGrid& g);
  const AmrPatch& patch_of(size_t cell) const;
  size_t surface_part(size_t cell) const {
    size_t p = 0;
    while (cell >= part_begin[p + 1]) ++p;
    return p;
  }
  /// f(point id) for the points of a cell.
  template <class F>
  void each_id(size_t cell, F&& f) const;
};

CellReader::Source::Source(DatasetPtr d) : dataset(std::move(d)) {
  if (!dataset) fail_internal("a cell reader without a dataset");
  const Mesh& m = dataset->mesh();
  count = dataset->cell_count();
  if (is_lattice(m)) open_lattice();
  else if (auto* u = std::get_if<UnstructuredMesh>(&m)) open_unstructured(*u);
  else if (auto* s = std::get_if<SurfaceMesh>(&m)) open_surface(*s);
  else if (auto* g = std::get_if<AmrGrid>(&m)) open_amr(*g);
  else {
    points.emplace(std::get<PointCloud>(m).points);
    count = dataset->point_count();
  }
  if (const Array& g = dataset->cell_ghost(); !g.empty() && kind != Kind::cloud) ghost = g.view<uint8_t>();
  if (const Array& g = dataset->point_ghost(); !g.empty()) {
    const auto v = g.view<uint8_t>();
    const bool any = parallel_reduce(
        v.count, 1 << 18, false,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i)
            if (v[i] & ghost_hidden_point) return true;
          return false;
        },
        [](bool a, bool b) { return a || b; });
    if (any) point_ghost = v;
  }
}

void CellReader::Source::open_lattice() {
  kind = Kind::lattice;
  const Mesh& m = dataset->mesh();
  lattice.emplace(m);
  cell_dims = lattice->view().cell_dims();
  for (int a = 0; a < 3; ++a)
    if (lattice->view().dims[size_t(a)] > 1) axis[axes++] = a;
  const bool ring = std::holds_alternative<CurvilinearGrid>(m);
  corner_order = ring ? ring_corners : box_corners;
  lattice_type = axes == 0   ? CellType::vertex
                 : axes == 1 ? CellType::line
                 : axes == 2 ? (ring ? CellType::quad : CellType::pixel)
                             : (ring ? CellType::hexahedron : CellType::voxel);
  for (size_t c = 0; c < size_t(1) << axes; ++c) {
    for (int a = 0; a < axes; ++a) corner_step[c][axis[a]] = corner_order[c] >> a & 1;
    corner_id[c] = lattice->view().id(corner_step[c][0], corner_step[c][1], corner_step[c][2]);
  }
}

// Of millions of cells each costs little: what corners share is found once.
void CellReader::Source::open_cell_of_lattice(size_t cell, std::vector<int64_t>& ids, std::vector<Vec3>& at) const {
  const LatticeView& v = lattice->view();
  const size_t n = size_t(1) << axes;
  ids.resize(n), at.resize(n);
  const size_t i = cell % cell_dims[0], row = cell / cell_dims[0], j = row % cell_dims[1], k = row / cell_dims[1];
  const size_t first = v.id(i, j, k);
  for (size_t c = 0; c < n; ++c) ids[c] = int64_t(first + corner_id[c]);
  if (v.mode != LatticeView::Mode::affine) {
    for (size_t c = 0; c < n; ++c) at[c] = v.position(i + corner_step[c][0], j + corner_step[c][1], k + corner_step[c][2]);
    return;
  }
  Vec3 along[2][2];  // the sums of LatticeView::position() in its order
  for (size_t a = 0; a < 2; ++a)
    for (size_t b = 0; b < 2; ++b) along[a][b] = v.origin + v.step[0] * double(i + a) + v.step[1] * double(j + b);
  const Vec3 up[2] = {v.step[2] * double(k), v.step[2] * double(k + 1)};
  for (size_t c = 0; c < n; ++c) at[c] = along[corner_step[c][0]][corner_step[c][1]] + up[corner_step[c][2]];
}

void CellReader::Source::open_unstructured(const UnstructuredMesh& m) {
  kind = Kind::unstructured;
  mesh = &m;
  points.emplace(m.points);
  cells = cells_view(m.cells), faces = cells_view(m.faces);
  if (!m.types.empty()) types = m.types.view<uint8_t>().data;
  if (!m.polyhedron_faces.empty()) polyhedron_faces = m.polyhedron_faces.view<int64_t>().data;
  if (!m.degrees.empty()) degrees = m.degrees.view<uint8_t>();
  if (!m.weights.empty()) weights = m.weights.view<double>();
}

void CellReader::Source::open_surface(const SurfaceMesh& m) {
  kind = Kind::surface;
  points.emplace(m.points);
  const CellArray* arrays[4] = {&m.vertices, &m.lines, &m.polygons, &m.strips};
  for (size_t p = 0; p < 4; ++p) part[p] = cells_view(*arrays[p]), part_begin[p + 1] = part_begin[p] + part[p].count;
}

void CellReader::Source::open_amr(const AmrGrid& g) {
  kind = Kind::amr;
  axes = g.dimension;
  lattice_type = axes == 3 ? CellType::voxel : CellType::pixel;
  size_t cell = 0, point = 0;
  for (const auto& level : g.levels)
    for (const auto& p : level.patches) {
      const auto n = p.cells();
      const Vec3 lo(double(p.lo[0]), double(p.lo[1]), axes == 3 ? double(p.lo[2]) : 0.0);
      patches.push_back({cell, point, n, {n[0] + 1, n[1] + 1, axes == 3 ? n[2] + 1 : 1}, g.origin + lo * level.spacing, level.spacing});
      const auto& points_of = patches.back().points;
      cell += n[0] * n[1] * n[2], point += points_of[0] * points_of[1] * points_of[2];
    }
}

const AmrPatch& CellReader::Source::patch_of(size_t cell) const {
  auto it = std::upper_bound(patches.begin(), patches.end(), cell, [](size_t c, const AmrPatch& p) { return c < p.cell_begin; });
  return *std::prev(it);
}

template <class F>
void CellReader::Source::each_id(size_t cell, F&& f) const {
  auto lattice_ids = [&](size_t base, size_t local, const std::array<size_t, 3>& n, const std::array<size_t, 3>& dims) {
    const size_t i = local % n[0], j = local / n[0] % n[1], k = local / n[0] / n[1];
    const size_t first = base + i + dims[0] * (j + dims[1] * k);
    const size_t step[3] = {1, dims[0], dims[0] * dims[1]};
    for (int c = 0; c < 1 << axes; ++c) {
      size_t id = first;
      for (int a = 0; a < axes; ++a)
        if (corner_order[c] >> a & 1) id += step[axis[a]];
      f(id);
    }
  };
  switch (kind) {
    case Kind::lattice: lattice_ids(0, cell, cell_dims, lattice->view().dims); return;
    case Kind::amr: {
      const AmrPatch& p = patch_of(cell);
      lattice_ids(p.point_begin, cell - p.cell_begin, p.cells, p.points);
      return;
    }
    case Kind::unstructured:
      for (size_t i = cells.begin(cell), end = cells.end(cell); i < end; ++i) f(size_t(cells.connectivity[i]));
      return;
    case Kind::surface: {
      const size_t p = surface_part(cell), c = cell - part_begin[p];
      for (size_t i = part[p].begin(c), end = part[p].end(c); i < end; ++i) f(size_t(part[p].connectivity[i]));
      return;
    }
    case Kind::cloud: f(cell); return;
  }
}

CellReader::CellReader(DatasetPtr dataset) : source_(std::make_shared<const Source>(std::move(dataset))), count_(source_->count) {}

int CellReader::dimension() const { return cell_type_info(type_).dimension; }

void CellReader::open(size_t cell) {
  const Source& s = *source_;
  cell_ = cell;
  if (!weights_.empty()) weights_.clear();
  if (!face_begin_.empty()) face_begin_.clear(), face_nodes_.clear();
  orders_ = {0, 0, 0};
  if (cell >= count_) fail_internal(fmt::format("cell {} of {} was requested", cell, count_));
  if (s.kind == Source::Kind::unstructured) return open_unstructured(cell);
  if (s.kind == Source::Kind::lattice) {
    type_ = s.lattice_type;
    return s.open_cell_of_lattice(cell, ids_, at_);
  }
  ids_.clear(), at_.clear();
  s.each_id(cell, [&](size_t id) { ids_.push_back(int64_t(id)); });
  switch (s.kind) {
    case Source::Kind::amr: {
      type_ = s.lattice_type;
      const AmrPatch& p = s.patch_of(cell);
      const size_t local = cell - p.cell_begin;
      const Vec3 lo(double(local % p.cells[0]), double(local / p.cells[0] % p.cells[1]), double(local / p.cells[0] / p.cells[1]));
      for (int c = 0; c < 1 << s.axes; ++c)
        at_.push_back(p.origin + (lo + Vec3(double(c & 1), double(c >> 1 & 1), double(c >> 2))) * p.spacing);
      return;
    }
    case Source::Kind::lattice:
    case Source::Kind::unstructured: return;  // above
    case Source::Kind::surface: {
      const size_t n = ids_.size();
      switch (s.surface_part(cell)) {
        case 0: type_ = n == 1 ? CellType::vertex : CellType::poly_vertex; break;
        case 1: type_ = n == 2 ? CellType::line : CellType::poly_line; break;
        case 2: type_ = n == 3 ? CellType::triangle : n == 4 ? CellType::quad : CellType::polygon; break;
        default: type_ = CellType::triangle_strip; break;
      }
      break;
    }
    case Source::Kind::cloud: type_ = CellType::vertex; break;
  }
  for (int64_t id : ids_) at_.push_back((*s.points)(size_t(id)));
}

// The way of most cells: no more than the copies.
void CellReader::open_unstructured(size_t cell) {
  const Source& s = *source_;
  type_ = s.types ? CellType(s.types[cell]) : s.mesh->single_type;
  const size_t begin = s.cells.begin(cell), n = s.cells.end(cell) - begin;
  ids_.resize(n), at_.resize(n);
  if (s.cells.connectivity.wide) {
    std::copy_n(static_cast<const int64_t*>(s.cells.connectivity.data) + begin, n, ids_.data());
  } else {
    std::copy_n(static_cast<const int32_t*>(s.cells.connectivity.data) + begin, n, ids_.data());
  }
  const PointSource& points = *s.points;
  for (size_t k = 0; k < n; ++k) at_[k] = points(size_t(ids_[k]));
  if (type_ < CellType::lagrange_curve) return;
  if (s.degrees.data) orders_ = cell_orders(*s.mesh, cell);
  if (orders_[0] == 0) orders_.fill(high_order_of(type_, n));
  for (int a = dimension(); a < 3; ++a) orders_[size_t(a)] = 0;
  if (s.weights.data && is_bezier(type_))
    for (int64_t id : ids_) weights_.push_back(s.weights[size_t(id)]);
}

Box3 CellReader::box() const {
  Box3 b;
  for (Vec3 p : at_) b.add(p);
  if (is_high_order(type_) && !is_bezier(type_) && type_ != CellType::quadratic_polygon && !b.empty()) {
    // A parabola leaves the range of its nodes by up to an eighth; higher orders by more.
    const Vec3 margin = b.size() * (orders_[0] > 2 || orders_[1] > 2 || orders_[2] > 2 || type_ == CellType::cubic_line ? 0.25 : 0.15);
    b.lo -= margin, b.hi += margin;
  }
  return b;
}

bool CellReader::hidden(size_t cell) const {
  const Source& s = *source_;
  if (s.ghost.data && s.ghost[cell] & (ghost_duplicate | ghost_refined_cell | ghost_hidden_cell)) return true;
  bool hidden = false;
  if (s.point_ghost.data) s.each_id(cell, [&](size_t id) { hidden = hidden || (s.point_ghost[id] & ghost_hidden_point); });
  return hidden;
}

size_t CellReader::face_count() {
  if (!face_begin_.empty()) return face_begin_.size() - 1;
  face_begin_.push_back(0);
  if (type_ != CellType::polyhedron) {
    if (dimension() != 3) return 0;
    const CellFaces& faces = cell_faces(type_, ids_.size(), orders_);
    face_begin_ = faces.begin;
    face_nodes_ = faces.nodes;
    return faces.size();
  }
  const Source& s = *source_;
  // Places of point ids, by bisection in a sorted copy.
  std::vector<std::pair<int64_t, uint32_t>> places;
  for (uint32_t i = 0; i < ids_.size(); ++i) places.emplace_back(ids_[i], i);
  std::sort(places.begin(), places.end());
  for (auto f = size_t(s.polyhedron_faces[cell_]); f < size_t(s.polyhedron_faces[cell_ + 1]); ++f) {
    for (size_t i = s.faces.begin(f); i < s.faces.end(f); ++i) {
      const int64_t id = s.faces.connectivity[i];
      const auto it = std::lower_bound(places.begin(), places.end(), std::make_pair(id, uint32_t(0)));
      if (it == places.end() || it->first != id) {
        face_begin_.clear(), face_nodes_.clear();
        fail_data(fmt::format("a face of polyhedron {} has point {}, which the cell does not list", cell_, id));
      }
      face_nodes_.push_back(it->second);
    }
    face_begin_.push_back(uint32_t(face_nodes_.size()));
  }
  return face_begin_.size() - 1;
}

std::span<const uint32_t> CellReader::face(size_t f) {
  face_count();
  return std::span<const uint32_t>(face_nodes_).subspan(face_begin_[f], face_begin_[f + 1] - face_begin_[f]);
}

}  // namespace sg
