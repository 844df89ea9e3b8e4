// SPDX-License-Identifier: Apache-2.0
#include "io/ensight/geometry.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/mesh/blanking.h"
#include "io/volume/brick.h"

namespace sg::ensight {

namespace {

constexpr Element elements[] = {
    {"point", CellType::vertex, 1},
    {"bar2", CellType::line, 2},
    {"bar3", CellType::quadratic_edge, 3},
    {"tria3", CellType::triangle, 3},
    {"tria6", CellType::quadratic_triangle, 6},
    {"quad4", CellType::quad, 4},
    {"quad8", CellType::quadratic_quad, 8},
    {"tetra4", CellType::tetra, 4},
    {"tetra10", CellType::quadratic_tetra, 10},
    {"pyramid5", CellType::pyramid, 5},
    {"pyramid13", CellType::quadratic_pyramid, 13},
    {"penta6", CellType::wedge, 6},
    {"penta15", CellType::quadratic_wedge, 15},
    {"hexa8", CellType::hexahedron, 8},
    {"hexa20", CellType::quadratic_hexahedron, 20},
    {"nsided", CellType::polygon, -1},
    {"nfaced", CellType::polyhedron, -2},
};

/// Collects the cells of an unstructured part, section by section.
class CellCollector {
 public:
  CellCollector(Stream& s, Part& part) : s_(s), part_(part) {}

  void add(const Element& e, const std::string& name, bool ids) {
    const bool polyhedra = e.nodes == -2;
    const size_t n = s_.count("elements", 4);
    if (ids) s_.skip_numbers(n, "element ids");
    part_.sections.push_back({name, part_.cells, n});
    types_.insert(types_.end(), n, uint8_t(e.type));
    ghost_.insert(ghost_.end(), n, name.starts_with("g_") ? uint8_t(ghost_duplicate) : uint8_t(0));
    any_ghost_ = any_ghost_ || (name.starts_with("g_") && n > 0);
    part_.cells += n;
    if (polyhedra) return add_faces(n);
    if (e.nodes > 0) add_fixed(e, n);
    else add_polygons(n);
    if (any_faces_) cell_faces_.insert(cell_faces_.end(), n, int64_t(face_end_.size()) - 1);
  }

  void finish() {
    UnstructuredMesh m;
    m.points.xyz = xyz;
    const bool one_type = std::all_of(types_.begin(), types_.end(), [&](uint8_t t) { return t == types_[0]; });
    if (!types_.empty() && one_type) m.single_type = CellType(types_[0]);
    const int fixed = types_.empty() || !one_type ? 0 : cell_type_info(m.single_type).points;
    m.cells.connectivity = Array::from_vector(std::move(ids_));
    if (fixed > 0) m.cells.fixed = fixed;
    else m.cells.offsets = Array::from_vector(std::move(end_));
    if (!one_type) m.types = Array::from_vector(std::move(types_));
    if (any_faces_) {
      m.faces.connectivity = Array::from_vector(std::move(face_ids_));
      m.faces.offsets = Array::from_vector(std::move(face_end_));
      m.polyhedron_faces = Array::from_vector(std::move(cell_faces_));
    }
    if (any_ghost_) part_.data.cell_ghost = Array::from_vector(std::move(ghost_));
    part_.data.mesh = std::move(m);
  }

  Array xyz;

 private:
  int32_t id(int32_t one_based) const {
    if (one_based < 1 || size_t(one_based) > part_.points)
      s_.fail(fmt::format("part {}: an earlier element has the node {}, but nodes are 1 to {}", part_.number, one_based, part_.points));
    return one_based - 1;
  }

  std::vector<int32_t> sizes(size_t n, int32_t least, std::string_view what, uint64_t& sum) const {
    std::vector<int32_t> v = s_.integers(n, what);
    sum = 0;
    for (const int32_t k : v) {
      if (k < least) s_.fail(fmt::format("{}: {} is too few", what, k));
      sum += uint64_t(k);
    }
    return v;
  }

  void add_fixed(const Element& e, size_t n) {
    uint64_t total = 0;
    if (!multiply(n, uint64_t(e.nodes), total)) s_.fail(fmt::format("{} elements", n));
    const std::vector<int32_t> v = s_.integers(total, fmt::format("nodes of {}", e.name));
    const auto k = size_t(e.nodes);
    const size_t at = ids_.size();
    ids_.resize(at + total);
    for (size_t i = 0; i < total; ++i) ids_[at + i] = id(v[i]);
    if (e.type == CellType::quadratic_edge)
      for (size_t i = at; i < ids_.size(); i += 3) std::swap(ids_[i + 1], ids_[i + 2]);
    for (size_t c = 0; c < n; ++c) end_.push_back(int64_t(at + (c + 1) * k));
  }

  void add_polygons(size_t n) {
    uint64_t total = 0;
    const std::vector<int32_t> k = sizes(n, 1, "nodes per polygon", total);
    const std::vector<int32_t> v = s_.integers(total, "nodes of polygons");
    for (const int32_t x : v) ids_.push_back(id(x));
    for (const int32_t x : k) end_.push_back(end_.back() + x);
  }

  // A polyhedron: number of faces, nodes per face, nodes.
  void add_faces(size_t n) {
    if (!any_faces_) cell_faces_.resize(part_.cells - n + 1, 0), any_faces_ = true;
    uint64_t faces = 0, total = 0;
    const std::vector<int32_t> per_cell = sizes(n, 1, "faces per polyhedron", faces);
    const std::vector<int32_t> per_face = sizes(faces, 1, "nodes per face", total);
    const std::vector<int32_t> v = s_.integers(total, "nodes of faces");
    std::vector<int32_t> distinct;
    size_t face = 0, at = 0;
    for (const int32_t f : per_cell) {
      const size_t begin = at;
      for (int32_t i = 0; i < f; ++i, ++face) {
        at += size_t(per_face[face]);
        face_end_.push_back(face_end_.back() + per_face[face]);
      }
      distinct.clear();
      for (size_t i = begin; i < at; ++i) {
        face_ids_.push_back(id(v[i]));
        distinct.push_back(face_ids_.back());
      }
      std::sort(distinct.begin(), distinct.end());
      distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
      ids_.insert(ids_.end(), distinct.begin(), distinct.end());
      end_.push_back(int64_t(ids_.size()));
      cell_faces_.push_back(int64_t(face_end_.size()) - 1);
    }
  }

  Stream& s_;
  Part& part_;
  std::vector<int32_t> ids_;
  std::vector<int64_t> end_{0};
  std::vector<uint8_t> types_, ghost_;
  bool any_ghost_ = false, any_faces_ = false;
  std::vector<int32_t> face_ids_;
  std::vector<int64_t> face_end_{0}, cell_faces_;
};

class Reader {
 public:
  Reader(Stream& s, Context& context) : s_(s), context_(context) {}

  Geometry run() {
    if (s_.form() != Form::ascii && s_.peek().find("inary") != std::string::npos) s_.line("the form");
    if (s_.peek() == "BEGIN TIME STEP") s_.keyword("BEGIN TIME STEP");
    Geometry g;
    g.description = s_.line("a description");
    if (to_lower(s_.peek()).starts_with("node id")) {  // one line of description was left out
    } else {
      s_.line("a description");
    }
    node_ids_ = listed("node id");
    element_ids_ = listed("element id");
    if (to_lower(s_.peek()) == "extents") s_.keyword("extents"), s_.skip_numbers(6, "extents");
    for (;;) {
      const std::string k = to_lower(s_.peek());
      if (k.empty() || k == "end time step" || !k.starts_with("part")) break;
      g.parts.push_back(part());
      context_.check();
    }
    const std::string k = s_.peek();
    if (!s_.at_end() && k != "END TIME STEP") s_.fail(fmt::format("found '{}' where a part was expected", k.substr(0, 40)));
    return g;
  }

 private:
  bool listed(const std::string& what) {
    const std::string how = stated_ids(s_, what);
    return how == "given" || how == "ignore";
  }

  Part part() {
    Part p;
    s_.keyword("part");
    p.number = s_.integer("the number of a part");
    p.name = s_.line("the name of a part");
    const std::string k = to_lower(s_.peek());
    if (k.starts_with("block")) block(p, words(k));
    else unstructured(p, k);
    return p;
  }

  void unstructured(Part& p, const std::string& first) {
    CellCollector cells(s_, p);
    if (first == "coordinates") {
      s_.keyword("coordinates");
      p.points = s_.count("nodes", 12);
      if (node_ids_) s_.skip_numbers(p.points, "node ids");
      cells.xyz = coordinates(p.points);
    } else {
      cells.xyz = coordinates(0);
    }
    for (;;) {
      const std::string k = to_lower(s_.peek());
      const Element* e = find_element(k);
      if (!e) break;
      s_.keyword("an element type");
      cells.add(*e, k, element_ids_);
      context_.check();
    }
    cells.finish();
  }

  Array coordinates(size_t n) {
    const Array x = s_.reals(n, "x"), y = s_.reals(n, "y"), z = s_.reals(n, "z");
    return interleaved(x, y, z);
  }

  static bool says(const std::vector<std::string_view>& w, std::string_view word) { return std::find(w.begin(), w.end(), word) != w.end(); }

  void block(Part& p, const std::vector<std::string_view>& views) {
    const std::vector<std::string> kept(views.begin(), views.end());
    const std::vector<std::string_view> w(kept.begin(), kept.end());
    s_.keyword("block");
    p.structured = true;
    const std::vector<int32_t> size = s_.integers(3, "the size of a block");
    std::array<size_t, 3> dims{};
    std::array<long long, 3> start{0, 0, 0};
    for (size_t a = 0; a < 3; ++a) {
      if (size[a] < 1) s_.fail(fmt::format("a block of {} x {} x {} nodes", size[0], size[1], size[2]));
      dims[a] = size_t(size[a]);
    }
    if (says(w, "range")) {
      const std::vector<int32_t> r = s_.integers(6, "the range of a block");
      for (size_t a = 0; a < 3; ++a) {
        const int32_t lo = r[2 * a], hi = r[2 * a + 1];
        if (lo < 1 || hi < lo || hi > size[a]) s_.fail(fmt::format("a range from {} to {} in {} nodes", lo, hi, size[a]));
        dims[a] = size_t(hi - lo) + 1, start[a] = lo - 1;
      }
    }
    p.points = checked_product({dims[0], dims[1], dims[2]}, s_.path());
    p.cells = lattice_cell_count(dims);
    if (says(w, "uniform")) {
      const Array v = s_.reals(6, "origin and spacing");
      UniformGrid g;
      g.dims = dims, g.extent_start = start;
      g.origin = {v.get(0), v.get(1), v.get(2)};
      for (int a = 0; a < 3; ++a) g.spacing[a] = dims[size_t(a)] == 1 && v.get(size_t(a) + 3) == 0 ? 1 : v.get(size_t(a) + 3);
      p.data.mesh = g;
    } else if (says(w, "rectilinear")) {
      RectilinearGrid g;
      g.x = s_.reals(dims[0], "x"), g.y = s_.reals(dims[1], "y"), g.z = s_.reals(dims[2], "z");
      g.extent_start = start;
      p.data.mesh = g;
    } else {
      CurvilinearGrid g;
      g.dims = dims, g.extent_start = start;
      g.points.xyz = coordinates(p.points);
      p.data.mesh = g;
    }
    block_flags(p, dims, says(w, "iblanked"));
  }

  void block_flags(Part& p, const std::array<size_t, 3>& dims, bool iblanked) {
    std::vector<uint8_t> cells;
    if (iblanked) {
      const std::vector<int32_t> blank = s_.integers(p.points, "iblank values");
      std::vector<uint8_t> points(p.points);
      for (size_t i = 0; i < p.points; ++i) points[i] = blank[i] == 0 ? uint8_t(ghost_hidden_point) : uint8_t(0);
      cells.resize(p.cells);
      hide_cells(dims, points.data(), cells.data());
      p.data.point_ghost = Array::from_vector(std::move(points));
    }
    for (;;) {
      const std::string k = to_lower(s_.peek());
      if (k == "ghost_flags") {
        s_.keyword(k);
        const std::vector<int32_t> flags = s_.integers(p.cells, "ghost flags");
        cells.resize(p.cells);
        for (size_t i = 0; i < p.cells; ++i)
          if (flags[i] != 0) cells[i] |= uint8_t(ghost_duplicate);
      } else if (k == "node_ids") {
        s_.keyword(k), s_.skip_numbers(p.points, "node ids");
      } else if (k == "element_ids") {
        s_.keyword(k), s_.skip_numbers(p.cells, "element ids");
      } else {
        break;
      }
    }
    if (!cells.empty()) p.data.cell_ghost = Array::from_vector(std::move(cells));
  }

  Stream& s_;
  Context& context_;
  bool node_ids_ = false, element_ids_ = false;
};

}  // namespace

std::string stated_ids(Stream& s, const std::string& what) {
  const std::string k = to_lower(s.keyword(what));
  if (!k.starts_with(what))
    s.fail(fmt::format("found '{}' where '{} ...' was expected", k.substr(0, 40), what),
           "is this a geometry of the type that the case states?");
  const std::string how(words(k).back());
  if (how != "off" && how != "given" && how != "assign" && how != "ignore")
    s.fail(fmt::format("'{}' does not state the {}s", k, what), "use off, given, assign or ignore");
  return how;
}

Geometry read_geometry(Stream& s, Context& context) { return Reader(s, context).run(); }

const Element* find_element(std::string_view line) {
  const auto w = words(line);
  if (w.empty()) return nullptr;
  const std::string name = to_lower(w[0]);
  for (const Element& e : elements)
    if (name == e.name || (name.starts_with("g_") && name.substr(2) == e.name)) return &e;
  return nullptr;
}

Array interleaved(const Array& x, const Array& y, const Array& z) {
  float* out = nullptr;
  Array a = Array::make<float>(x.count(), 3, &out);
  const auto vx = x.view<float>(), vy = y.view<float>(), vz = z.view<float>();
  parallel_for(x.count(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out[3 * i] = vx[i], out[3 * i + 1] = vy[i], out[3 * i + 2] = vz[i];
  });
  return a;
}

}  // namespace sg::ensight
