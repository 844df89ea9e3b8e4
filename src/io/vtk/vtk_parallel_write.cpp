// SPDX-License-Identifier: Apache-2.0
// Writing of parallel VTK XML files: the pieces of one mesh in files of their own, then the file that names them.
#include <fmt/core.h>

#include <algorithm>
#include <climits>

#include "base/text/text.h"
#include "data/lattice.h"
#include "io/formats.h"
#include "io/vtk/vtk_parts_folder.h"
#include "io/vtk/xml/vtk_xml_encode.h"

namespace sg {

namespace vtk {
namespace {

using Index3 = std::array<long long, 3>;

struct Form {
  std::string_view extension;  ///< of the pieces
  const char* element;
  bool lattice;
};
constexpr Form forms[] = {{"vti", "PImageData", true},
                          {"vtr", "PRectilinearGrid", true},
                          {"vts", "PStructuredGrid", true},
                          {"vtu", "PUnstructuredGrid", false},
                          {"vtp", "PPolyData", false}};

std::string array_text(ElementType type, std::string_view name, int components) {
  return fmt::format("      <PDataArray{}/>\n", attributes_text({{"type", std::string(xml_type_name(type))},
                                                                 {"Name", std::string(name)},
                                                                 {"NumberOfComponents", std::to_string(components)}}));
}

struct Piece {
  std::string name;  ///< of the part, for messages
  DatasetPtr data;
  Index3 lo{0, 0, 0}, hi{0, 0, 0};           ///< points of a grid, by their indices in the whole
  Index3 own_lo{0, 0, 0}, own_hi{-1, 0, 0};  ///< cells that are not ghosts; none when hi < lo
};

Index3 cells_end(const Piece& p) {  // of all its cells, inclusive; a flat axis has one cell
  Index3 r = p.hi;
  for (size_t a = 0; a < 3; ++a) r[a] = std::max(p.lo[a], p.hi[a] - 1);
  return r;
}

// The box of the cells that are not copies of another piece's.
void find_own_cells(Piece& p) {
  const Index3 last = cells_end(p);
  const Array& ghost = p.data->cell_ghost();
  if (ghost.empty()) {
    p.own_lo = p.lo, p.own_hi = last;
    return;
  }
  const Index3 n{last[0] - p.lo[0] + 1, last[1] - p.lo[1] + 1, last[2] - p.lo[2] + 1};
  bool any = false;
  for (size_t c = 0; c < ghost.count(); ++c) {
    if (uint8_t(ghost.get(c)) & ghost_duplicate) continue;
    const auto i = static_cast<long long>(c);
    const Index3 at{p.lo[0] + i % n[0], p.lo[1] + i / n[0] % n[1], p.lo[2] + i / (n[0] * n[1])};
    for (size_t a = 0; a < 3; ++a) {
      p.own_lo[a] = any ? std::min(p.own_lo[a], at[a]) : at[a];
      p.own_hi[a] = any ? std::max(p.own_hi[a], at[a]) : at[a];
    }
    any = true;
  }
}

long long cells_between(const Index3& lo, const Index3& hi) {
  long long n = 1;
  for (size_t a = 0; a < 3; ++a) n *= std::max(0ll, hi[a] - lo[a] + 1);
  return n;
}

Index3 start_of(const Mesh& mesh) {
  if (auto* u = std::get_if<UniformGrid>(&mesh)) return u->extent_start;
  if (auto* r = std::get_if<RectilinearGrid>(&mesh)) return r->extent_start;
  return std::get<CurvilinearGrid>(mesh).extent_start;
}

const char* const many_grids = "write collections of arbitrary grids to .vtm";

// The whole grid, of which each piece is a box; together their own cells are all of its cells, each once.
struct Whole {
  Index3 lo{0, 0, 0}, hi{0, 0, 0};
  Vec3 zero;              ///< uniform grids: where index 0 0 0 lies
  Index3 shift{0, 0, 0};  ///< taken from all indices, so that the first point keeps its position to the last bit
  int ghost_levels = 0;

  Index3 index(const Index3& i) const { return {i[0] - shift[0], i[1] - shift[1], i[2] - shift[2]}; }
};

void check_uniform(const std::vector<Piece>& pieces, const Whole& whole, const std::string& path) {
  const auto& first = std::get<UniformGrid>(pieces[0].data->mesh());
  for (const Piece& p : pieces) {
    const auto& g = std::get<UniformGrid>(p.data->mesh());
    const Index3 i = whole.index(p.lo);
    const Vec3 there = whole.zero + first.direction * (first.spacing * Vec3(double(i[0]), double(i[1]), double(i[2])));
    bool same = g.spacing == first.spacing && length(there - g.origin) <= 1e-6 * length(first.spacing) + 1e-12 * length(there);
    for (int k = 0; k < 9; ++k) same = same && g.direction.m[k / 3][k % 3] == first.direction.m[k / 3][k % 3];
    if (!same) fail_usage(fmt::format("part '{}' lies on a different grid from part '{}'", p.name, pieces[0].name), path, many_grids);
  }
}

void check_rectilinear(const std::vector<Piece>& pieces, const Whole& whole, const std::string& path) {
  for (size_t a = 0; a < 3; ++a) {
    std::vector<double> at(size_t(whole.hi[a] - whole.lo[a] + 1), std::numeric_limits<double>::quiet_NaN());
    for (const Piece& p : pieces) {
      const auto& g = std::get<RectilinearGrid>(p.data->mesh());
      const Array& axis = a == 0 ? g.x : a == 1 ? g.y : g.z;
      for (size_t i = 0; i < axis.count(); ++i) {
        double& known = at[size_t(p.lo[a] - whole.lo[a]) + i];
        if (known == known && known != axis.get(i))
          fail_usage(fmt::format("part '{}' has {} = {} where another part has {}", p.name, "xyz"[a], axis.get(i), known), path,
                     many_grids);
        known = axis.get(i);
      }
    }
  }
}

Whole whole_of(std::vector<Piece>& pieces, const std::string& path) {
  Whole w;
  for (Piece& p : pieces) {
    const auto dims = lattice_dims(p.data->mesh());
    p.lo = start_of(p.data->mesh());
    for (size_t a = 0; a < 3; ++a) p.hi[a] = p.lo[a] + static_cast<long long>(dims[a]) - 1;
    find_own_cells(p);
  }
  w.lo = pieces[0].lo, w.hi = pieces[0].hi;
  for (const Piece& p : pieces)
    for (size_t a = 0; a < 3; ++a) {
      w.lo[a] = std::min(w.lo[a], p.lo[a]), w.hi[a] = std::max(w.hi[a], p.hi[a]);
      if (p.own_hi[a] < p.own_lo[a]) continue;
      const long long layers = std::max(p.own_lo[a] - p.lo[a], cells_end(p)[a] - p.own_hi[a]);
      w.ghost_levels = std::max(w.ghost_levels, int(std::min(layers, 1ll << 20)));
    }
  for (size_t a = 0; a < 3; ++a)
    if (w.hi[a] - w.lo[a] > 1ll << 40) fail_usage("the parts lie too far apart to be pieces of one grid", path, many_grids);
  // The box of all own cells; copies may lie around it.
  Index3 first{LLONG_MAX, LLONG_MAX, LLONG_MAX}, last{LLONG_MIN, LLONG_MIN, LLONG_MIN};
  for (const Piece& p : pieces)
    for (size_t a = 0; a < 3 && p.own_hi[0] >= p.own_lo[0]; ++a)
      first[a] = std::min(first[a], p.own_lo[a]), last[a] = std::max(last[a], p.own_hi[a]);
  long long cells = 0;
  for (size_t i = 0; i < pieces.size(); ++i) {
    cells += cells_between(pieces[i].own_lo, pieces[i].own_hi);
    for (size_t k = 0; k < i; ++k) {
      Index3 lo, hi;
      for (size_t a = 0; a < 3; ++a)
        lo[a] = std::max(pieces[i].own_lo[a], pieces[k].own_lo[a]), hi[a] = std::min(pieces[i].own_hi[a], pieces[k].own_hi[a]);
      if (cells_between(lo, hi) > 0)
        fail_usage(fmt::format("parts '{}' and '{}' share cells, so they are not pieces of one grid", pieces[k].name, pieces[i].name), path,
                   many_grids);
    }
  }
  const long long all = first[0] > last[0] ? 0 : cells_between(first, last);
  if (cells != all) fail_usage(fmt::format("the parts have {} of the {} cells of the grid around them", cells, all), path, many_grids);
  return w;
}

// Where index 0 0 0 lies. When adding up rounds, indices are counted from the first point instead.
void place_uniform(const std::vector<Piece>& pieces, Whole& w) {
  const auto first = std::find_if(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.lo == w.lo; });
  const auto& g = std::get<UniformGrid>((first == pieces.end() ? pieces[0] : *first).data->mesh());
  const Vec3 step = g.direction * (g.spacing * Vec3(double(g.extent_start[0]), double(g.extent_start[1]), double(g.extent_start[2])));
  w.zero = g.origin - step;
  if (w.zero + step == g.origin) return;
  w.zero = g.origin, w.shift = g.extent_start;
}

std::string extent_text(const Whole& w, const Index3& lo, const Index3& hi) {
  const Index3 a = w.index(lo), b = w.index(hi);
  return fmt::format("{} {} {} {} {} {}", a[0], b[0], a[1], b[1], a[2], b[2]);
}

// Data that shapes high-order cells, if a mesh has it (write_dataset writes it as f64 besides the fields).
Array shaping_of(const Dataset& d, Association association) {
  const auto* u = d.as<UnstructuredMesh>();
  return !u ? Array() : association == Association::point ? u->weights : u->degrees;
}

// The arrays of that association that all pieces have with one type and number of components.
std::string shared_arrays(const std::vector<Piece>& pieces, Association association, const char* element) {
  constexpr std::pair<Role, std::string_view> roles[] = {{Role::scalars, "Scalars"}, {Role::vectors, "Vectors"},
                                                         {Role::normals, "Normals"}, {Role::tcoords, "TCoords"},
                                                         {Role::tensors, "Tensors"}, {Role::global_ids, "GlobalIds"}};
  std::string text, attributes;
  const bool point = association == Association::point;
  for (const Field& f : pieces[0].data->fields()) {
    if (f.association != association) continue;
    bool all = true;
    for (const Piece& p : pieces) {
      const Field* g = p.data->fields().find(f.name, association);
      all = all && g && g->array.type() == f.array.type() && g->components() == f.components();
    }
    if (!all) continue;
    text += array_text(f.array.type(), f.name, f.components());
    for (const auto& [role, name] : roles)
      if (f.role == role && attributes.find(fmt::format(" {}=", name)) == std::string::npos)
        attributes += attributes_text({{name, f.name}});
  }
  const std::string_view shaping = point ? "RationalWeights" : "HigherOrderDegrees";
  bool ghosts = false, shaped = true;
  for (const Piece& p : pieces) {
    ghosts = ghosts || !(point ? p.data->point_ghost() : p.data->cell_ghost()).empty();
    shaped = shaped && !shaping_of(*p.data, association).empty();
  }
  if (shaped) {
    attributes += attributes_text({{shaping, std::string(shaping)}});
    if (!pieces[0].data->fields().find(shaping, association))
      text += array_text(ElementType::f64, shaping, shaping_of(*pieces[0].data, association).components());
  }
  if (ghosts) text += array_text(ElementType::u8, "vtkGhostType", 1);
  return fmt::format("    <{}{}>\n{}    </{}>\n", element, attributes, text, element);
}

const Points* points_of(const Mesh& mesh) {
  if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) return &u->points;
  if (auto* s = std::get_if<SurfaceMesh>(&mesh)) return &s->points;
  if (auto* c = std::get_if<CurvilinearGrid>(&mesh)) return &c->points;
  if (auto* p = std::get_if<PointCloud>(&mesh)) return &p->points;
  return nullptr;
}

// What pieces share, when one of them has it.
struct Common {
  bool wide = false;  ///< f64 positions
  bool point_ghosts = false, cell_ghosts = false;
};

bool is_wide(const Mesh& mesh) {
  if (auto* r = std::get_if<RectilinearGrid>(&mesh))
    return r->x.type() != ElementType::f32 || r->y.type() != ElementType::f32 || r->z.type() != ElementType::f32;
  const Points* p = points_of(mesh);
  return p && p->count() > 0 && (p->xyz.type() == ElementType::f64 || !(p->origin == Vec3{0, 0, 0}));
}

// A piece as all pieces are written: positions of one type, ghosts in all when they are in one.
DatasetPtr like_the_others(const DatasetPtr& d, const Common& common) {
  DatasetParts parts = d->parts();
  auto widen = [&](auto& m) {
    if constexpr (requires { m.points.xyz; }) {
      m.points.xyz = m.points.xyz.converted(ElementType::f64);
    } else if constexpr (requires { m.x; }) {
      for (Array* a : {&m.x, &m.y, &m.z}) *a = a->converted(ElementType::f64);
    }
  };
  if (common.wide) std::visit(widen, parts.mesh);
  auto zeros = [](size_t n) { return Array::from_vector(std::vector<uint8_t>(n, 0)); };
  if (common.point_ghosts && parts.point_ghost.empty()) parts.point_ghost = zeros(d->point_count());
  if (common.cell_ghosts && parts.cell_ghost.empty()) parts.cell_ghost = zeros(d->cell_count());
  return make_dataset(std::move(parts));
}

std::vector<Piece> pieces_of(const Data& data, const Form& form, const std::string& path) {
  std::vector<Piece> pieces;
  for_each_dataset(data, [&](const std::string& name, const DatasetPtr& d) {
    const std::string_view right = extension_for(d->mesh());
    if (right != form.extension && !(right == "vtp" && form.extension == "vtu"))
      fail_usage(fmt::format("part '{}' is a mesh of kind {}, which cannot be a piece of a .{}", name, d->kind(), extension_of(path)), path,
                 "write collections of arbitrary meshes to .vtm");
    pieces.push_back({name, d});
  });
  if (pieces.empty()) fail_usage("there is no mesh to write", path);
  return pieces;
}

std::string geometry_text(const std::vector<Piece>& pieces, const Form& form, bool wide) {
  const ElementType type = wide ? ElementType::f64 : ElementType::f32;
  if (points_of(pieces[0].data->mesh())) return "    <PPoints>\n" + array_text(type, "Points", 3) + "    </PPoints>\n";
  if (form.extension != "vtr") return "";
  return "    <PCoordinates>\n" + array_text(type, "x", 1) + array_text(type, "y", 1) + array_text(type, "z", 1) + "    </PCoordinates>\n";
}

}  // namespace
}  // namespace vtk

void write_vtk_parallel(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  using namespace vtk;
  const std::string extension = extension_of(path).substr(1);  // of the pieces
  const Form& form = *std::find_if(std::begin(forms), std::end(forms), [&](const Form& f) { return f.extension == extension; });
  std::vector<Piece> pieces = pieces_of(data, form, path);
  Common common;
  for (const Piece& p : pieces) {
    common.wide = common.wide || is_wide(p.data->mesh());
    common.point_ghosts = common.point_ghosts || !p.data->point_ghost().empty();
    common.cell_ghosts = common.cell_ghosts || !p.data->cell_ghost().empty();
  }
  Whole whole;
  if (form.lattice) whole = whole_of(pieces, path);
  if (extension == "vti") place_uniform(pieces, whole), check_uniform(pieces, whole, path);
  if (extension == "vtr") check_rectilinear(pieces, whole, path);

  XmlAttributes attributes;
  if (form.lattice) attributes.emplace_back("WholeExtent", extent_text(whole, whole.lo, whole.hi));
  attributes.emplace_back("GhostLevel", std::to_string(form.lattice ? whole.ghost_levels : int(common.cell_ghosts)));
  if (auto* g = pieces[0].data->as<UniformGrid>()) {
    std::string direction;
    for (int i = 0; i < 9; ++i) direction += (i ? " " : "") + exact_number(g->direction.m[i / 3][i % 3]);
    attributes.insert(attributes.end(),
                      {{"Origin", point_text(whole.zero)}, {"Spacing", point_text(g->spacing)}, {"Direction", direction}});
  }
  PartsFolder folder(path);
  std::string text = fmt::format("<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <{}{}>\n",
                                 form.element, form.element, attributes_text(attributes));
  text += shared_arrays(pieces, Association::point, "PPointData") + shared_arrays(pieces, Association::cell, "PCellData");
  text += geometry_text(pieces, form, common.wide);
  for (size_t i = 0; i < pieces.size(); ++i) {
    const GridPlace place{whole.index(pieces[i].lo), whole.zero};
    write_dataset(folder.file(i, extension), *like_the_others(pieces[i].data, common), options, context, form.lattice ? &place : nullptr);
    XmlAttributes of_piece;
    if (form.lattice) of_piece.emplace_back("Extent", extent_text(whole, pieces[i].lo, pieces[i].hi));
    of_piece.emplace_back("Source", folder.name(i, extension));
    text += fmt::format("    <Piece{}/>\n", attributes_text(of_piece));
  }
  folder.commit(text + fmt::format("  </{}>\n</VTKFile>\n", form.element));
}

}  // namespace sg
