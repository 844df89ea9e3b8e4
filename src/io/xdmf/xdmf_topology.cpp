// SPDX-License-Identifier: Apache-2.0
// XDMF: topologies and geometries. Nodes of cells are in VTK's order.
#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/bytes.h"
#include "base/text/text.h"
#include "io/vtk/vtk_cells.h"
#include "io/xdmf/xdmf.h"

namespace sg::xdmf {

namespace {

struct Kind {
  int number;  // in Mixed topologies
  CellType type;
  std::initializer_list<std::string_view> names;
};

// Numbers and names as in the format's documentation.
const Kind kinds[] = {
    {1, CellType::poly_vertex, {"polyvertex"}},
    {2, CellType::poly_line, {"polyline"}},
    {3, CellType::polygon, {"polygon"}},
    {4, CellType::triangle, {"triangle", "tri"}},
    {5, CellType::quad, {"quadrilateral", "quad"}},
    {6, CellType::tetra, {"tetrahedron", "tet"}},
    {7, CellType::pyramid, {"pyramid"}},
    {8, CellType::wedge, {"wedge"}},
    {9, CellType::hexahedron, {"hexahedron", "hex"}},
    {16, CellType::polyhedron, {"polyhedron"}},
    {34, CellType::quadratic_edge, {"edge_3"}},
    {35, CellType::biquadratic_quad, {"quadrilateral_9", "quad_9"}},
    {36, CellType::quadratic_triangle, {"triangle_6", "tri_6"}},
    {37, CellType::quadratic_quad, {"quadrilateral_8", "quad_8"}},
    {38, CellType::quadratic_tetra, {"tetrahedron_10", "tet_10"}},
    {39, CellType::quadratic_pyramid, {"pyramid_13"}},
    {40, CellType::quadratic_wedge, {"wedge_15"}},
    {41, CellType::biquadratic_quadratic_wedge, {"wedge_18"}},
    {48, CellType::quadratic_hexahedron, {"hexahedron_20", "hex_20"}},
    {49, CellType::biquadratic_quadratic_hexahedron, {"hexahedron_24", "hex_24"}},
    {50, CellType::triquadratic_hexahedron, {"hexahedron_27", "hex_27"}},
};

std::string topology_name(pugi::xml_node topology) { return to_lower(attribute(topology, "TopologyType", "Type")); }

// Cell by cell: the number of the kind, for free kinds the number of points, the points; for polyhedra the faces.
class MixedReader {
 public:
  MixedReader(const Document& doc, pugi::xml_node topology, IndexView stream, size_t size, int64_t base)
      : doc_(doc), topology_(topology), stream_(stream), size_(size), base_(base) {}

  void read(std::optional<size_t> cells, UnstructuredMesh& mesh) {
    while (at_ < size_ && (!cells || types_.size() < *cells)) cell();
    if (cells && types_.size() < *cells)
      doc_.fail(fmt::format("has {} cells, not {}", types_.size(), *cells), topology_, "the list of points is too short");
    const bool any = std::find(types_.begin(), types_.end(), uint8_t(CellType::polyhedron)) != types_.end();
    mesh.cells.connectivity = Array::from_vector(std::move(ids_));
    mesh.cells.offsets = Array::from_vector(std::move(offsets_));
    mesh.types = Array::from_vector(std::move(types_));
    if (!any) return;
    mesh.faces.connectivity = Array::from_vector(std::move(face_ids_));
    mesh.faces.offsets = Array::from_vector(std::move(face_offsets_));
    mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces_));
  }

 private:
  int64_t take() {
    if (at_ >= size_) doc_.fail(fmt::format("ends within cell {}", types_.size()), topology_, "the list of points is too short");
    return stream_[at_++];
  }
  int64_t take_point() {
    const int64_t id = take();
    return id < base_ ? -1 : id - base_;
  }
  size_t take_count() {
    const int64_t n = take();
    if (n < 0 || size_t(n) > size_ - at_) doc_.fail(fmt::format("gives cell {} a count of {}", types_.size(), n), topology_);
    return size_t(n);
  }
  void cell() {
    const int64_t number = take();
    const Kind* kind = nullptr;
    for (const Kind& k : kinds)
      if (k.number == number) kind = &k;
    if (!kind) doc_.fail(fmt::format("gives cell {} the unknown kind {}", types_.size(), number), topology_);
    CellType type = kind->type;
    if (type == CellType::polyhedron) {
      polyhedron();
    } else {
      const int fixed = cell_type_info(type).points;
      const size_t n = fixed < 0 ? take_count() : size_t(fixed);
      if (type == CellType::poly_vertex && n == 1) type = CellType::vertex;
      if (type == CellType::poly_line && n == 2) type = CellType::line;
      for (size_t i = 0; i < n; ++i) ids_.push_back(take_point());
    }
    types_.push_back(uint8_t(type));
    offsets_.push_back(int64_t(ids_.size()));
    cell_faces_.push_back(int64_t(face_offsets_.size()) - 1);
  }
  void polyhedron() {
    const auto first = ptrdiff_t(ids_.size());
    for (size_t faces = take_count(); faces > 0; --faces) {
      for (size_t n = take_count(); n > 0; --n) face_ids_.push_back(take_point()), ids_.push_back(face_ids_.back());
      face_offsets_.push_back(int64_t(face_ids_.size()));
    }
    std::sort(ids_.begin() + first, ids_.end());  // the distinct points
    ids_.erase(std::unique(ids_.begin() + first, ids_.end()), ids_.end());
  }

  const Document& doc_;
  pugi::xml_node topology_;
  IndexView stream_;
  size_t size_, at_ = 0;
  int64_t base_;  // number of the first point; kinds and counts are not shifted
  std::vector<int64_t> ids_, offsets_{0}, face_ids_, face_offsets_{0}, cell_faces_{0};
  std::vector<uint8_t> types_;
};

std::optional<size_t> element_count(const Document& doc, pugi::xml_node topology) {
  for (const char* name : {"NumberOfElements", "Dimensions"})
    if (find_attribute(topology, name)) return product(dimensions(doc, topology, name), doc.where(topology));
  return {};
}

Array shifted(const Array& ids, int64_t base) {
  if (base == 0) return ids;
  int64_t* out = nullptr;
  const Array a = Array::make<int64_t>(ids.count(), 1, &out);
  const IndexView v = index_view(ids);
  for (size_t i = 0; i < a.count(); ++i) out[i] = v[i] < base ? -1 : v[i] - base;
  return a;
}

// The points of each cell in the order that the attribute Order gives: its k-th number is the place of point k in the list.
Array in_order(const Document& doc, pugi::xml_node topology, const Array& ids, size_t n) {
  const std::vector<size_t> order = dimensions(doc, topology, "Order");
  if (order.empty() || std::is_sorted(order.begin(), order.end())) return ids;
  std::vector<size_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (size_t k = 0; k < sorted.size(); ++k)
    if (sorted.size() != n || sorted[k] != k)
      doc.fail(fmt::format("has Order=\"{}\"", attribute(topology, "Order")), topology, fmt::format("each of 0 to {} once", n - 1));
  int64_t* out = nullptr;
  const Array a = Array::make<int64_t>(ids.count(), 1, &out);
  const IndexView v = index_view(ids);
  for (size_t cell = 0; cell + n <= a.count(); cell += n)
    for (size_t k = 0; k < n; ++k) out[cell + k] = v[cell + order[k]];
  return a;
}

// Cells of one kind; `width` is the last dimension of the list of points.
void read_uniform(const Document& doc, pugi::xml_node topology, const Kind& kind, const Array& ids, size_t width,
                  std::optional<size_t> cells, UnstructuredMesh& mesh) {
  const int fixed = cell_type_info(kind.type).points;
  size_t n = size_t(std::max(fixed, 0));
  if (fixed < 0) {
    const std::string_view nodes = attribute(topology, "NodesPerElement");
    const auto said = parse_int(nodes);
    if (!nodes.empty() && (!said || *said < 1 || *said > 1 << 20)) doc.fail(fmt::format("has NodesPerElement=\"{}\"", nodes), topology);
    n = said ? size_t(*said) : width > 0 ? width : kind.type == CellType::poly_vertex ? 1 : kind.type == CellType::poly_line ? 2 : 0;
    if (n == 0 || n > 1 << 20) doc.fail("does not say how many points a cell has", topology, "NodesPerElement");
  }
  const size_t count = cells.value_or(ids.count() / n);
  uint64_t want = 0;
  if (!multiply(count, n, want) || want > ids.count())
    doc.fail(fmt::format("has {} point ids for {} cells of {}", ids.count(), count, n), topology, "the list of points is too short");
  mesh.cells.connectivity = in_order(doc, topology, ids.slice(0, want), n);
  mesh.cells.fixed = int(n);
  mesh.single_type = kind.type == CellType::poly_vertex && n == 1 ? CellType::vertex
                     : kind.type == CellType::poly_line && n == 2 ? CellType::line
                                                                  : kind.type;
}

}  // namespace

bool is_topology(pugi::xml_node topology, std::string_view suffix) {
  const std::string name = topology_name(topology);
  return name == "2d" + std::string(suffix) || name == "3d" + std::string(suffix);
}

std::optional<std::array<size_t, 3>> lattice_of(const Document& doc, pugi::xml_node topology) {
  if (!is_topology(topology, "smesh") && !is_topology(topology, "rectmesh") && !is_topology(topology, "corectmesh")) return {};
  const std::vector<size_t> d = dimensions(doc, topology, find_attribute(topology, "Dimensions") ? "Dimensions" : "NumberOfElements");
  const size_t rank = topology_name(topology)[0] == '2' ? 2 : 3;
  if (d.size() != rank && !(rank == 2 && d.size() == 3 && d[0] == 1))
    doc.fail(fmt::format("has {} dimensions", d.size()), topology, fmt::format("give {}, slowest first", rank));
  std::array<size_t, 3> dims{1, 1, 1};
  for (size_t a = 0; a < d.size(); ++a) dims[a] = d[d.size() - 1 - a];
  for (const size_t n : dims)
    if (n == 0) doc.fail("has a dimension of 0 points", topology);
  product(d, doc.where(topology));
  return dims;
}

UnstructuredMesh read_topology(const Document& doc, pugi::xml_node topology, Points points) {
  UnstructuredMesh mesh;
  mesh.points = std::move(points);
  const std::string name = topology_name(topology);
  const bool mixed = name == "mixed";
  const Kind* kind = nullptr;
  for (const Kind& k : kinds)
    for (const std::string_view n : k.names)
      if (n == name) kind = &k;
  if (!kind && !mixed) doc.fail(fmt::format("has the type '{}', which is not supported", name), topology);
  const std::optional<size_t> cells = element_count(doc, topology);
  const pugi::xml_node data = doc.child(topology, "DataItem");
  if (!data && kind && kind->type != CellType::poly_vertex && cell_type_info(kind->type).points > 0) {  // one cell after the other
    std::vector<int64_t> ids(mesh.points.count());
    std::iota(ids.begin(), ids.end(), int64_t(0));
    read_uniform(doc, topology, *kind, Array::from_vector(std::move(ids)), 0, cells, mesh);
    return mesh;
  }
  if (!data) {  // vertices without a list are all points
    if (!kind || kind->type != CellType::poly_vertex) doc.fail("has no DataItem", topology, "the point ids of its cells");
    const size_t n = std::min(cells.value_or(mesh.points.count()), mesh.points.count());
    std::vector<int64_t> ids(n);
    std::iota(ids.begin(), ids.end(), int64_t(0));
    mesh.cells = {Array::from_vector(std::move(ids)), {}, 1};
    mesh.single_type = CellType::vertex;
    return mesh;
  }
  const Item item = doc.item(data);
  if (is_float(item.values.type())) doc.fail("has point ids that are not whole numbers", data, "NumberType=\"Int\"");
  const auto base = parse_int(attribute(topology, "BaseOffset")).value_or(0);
  const Array ids = vtk::as_indices(item.values);
  if (mixed || kind->type == CellType::polyhedron) {
    if (!mixed) doc.fail("consists of polyhedra only", topology, "TopologyType=\"Mixed\"");
    MixedReader(doc, topology, index_view(ids), ids.count(), base).read(cells, mesh);
    const Array types = mesh.types;
    mesh.types = {};
    vtk::set_types(mesh, types);
  } else {
    read_uniform(doc, topology, *kind, shifted(ids, base), item.dims.size() > 1 ? item.dims.back() : 0, cells, mesh);
  }
  return mesh;
}

Points read_points(const Document& doc, pugi::xml_node geometry) {
  const std::string kind = to_lower(attribute(geometry, "GeometryType", "Type"));
  const auto items = doc.children(geometry, "DataItem");
  std::vector<Array> axes;  // one per axis
  const bool flat = kind == "xy" || kind == "x_y";
  if (kind.empty() || kind == "xyz" || kind == "xy") {
    if (items.size() != 1) doc.fail(fmt::format("has {} items", items.size()), geometry, "one");
    const Array all = vtk::as_coordinates(doc.item(items[0]).values).made_packed();
    const int n = flat ? 2 : 3;
    if (all.count() % size_t(n)) doc.fail(fmt::format("has {} numbers, not {} for each point", all.count(), n), geometry);
    const Array tuples(all.buffer(), all.type(), all.count() / size_t(n), n, size_t(all.raw() - all.buffer().data),
                       n * ptrdiff_t(element_size(all.type())), ptrdiff_t(element_size(all.type())));
    if (!flat) return {tuples};
    axes = {tuples.component(0), tuples.component(1)};
  } else if (kind == "x_y_z" || kind == "x_y") {
    if (items.size() != (flat ? 2u : 3u)) doc.fail(fmt::format("has {} items", items.size()), geometry, flat ? "x and y" : "x, y and z");
    for (const pugi::xml_node& i : items) axes.push_back(vtk::as_coordinates(doc.item(i).values));
  } else {
    doc.fail(fmt::format("is of type '{}', which does not fit its topology", kind), geometry, "use XYZ, XY, X_Y_Z or X_Y");
  }
  bool wide = false;
  for (const Array& a : axes) {
    wide = wide || a.type() == ElementType::f64;
    if (a.count() != axes[0].count())
      doc.fail(fmt::format("has {} and {} coordinates", axes[0].count(), a.count()), geometry, "both must have the same number");
  }
  auto fill = [&](auto* out) {
    using T = std::remove_pointer_t<decltype(out)>;
    for (size_t a = 0; a < 3; ++a)
      for (size_t i = 0; i < axes[0].count(); ++i) out[3 * i + a] = a < axes.size() ? T(axes[a].get(i)) : T(0);
  };
  Array xyz;
  if (wide) {
    double* out = nullptr;
    xyz = Array::make<double>(axes[0].count(), 3, &out);
    fill(out);
  } else {
    float* out = nullptr;
    xyz = Array::make<float>(axes[0].count(), 3, &out);
    fill(out);
  }
  return {xyz};
}

}  // namespace sg::xdmf
