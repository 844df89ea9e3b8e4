// SPDX-License-Identifier: Apache-2.0
// XDMF: grids, their attributes, collections in space and in time.
#include "io/xdmf/xdmf.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/formats.h"
#include "io/text/text_scan.h"
#include "io/vtk/vtk_cells.h"

namespace sg {

bool sniff_xdmf(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  for (size_t root = text.find('<'); root != text.npos && root + 5 < text.size(); root = text.find('<', root + 1))
    if (equal_ignoring_case(text.substr(root + 1, 4), "Xdmf")) return is_space(text[root + 5]) || text[root + 5] == '>';
  return false;
}

namespace xdmf {

namespace {

std::string grid_type(pugi::xml_node grid) {
  const std::string type = to_lower(attribute(grid, "GridType", "Type"));
  return type.empty() ? "uniform" : type;
}
bool is_temporal(pugi::xml_node grid) {
  return grid_type(grid) == "collection" && equal_ignoring_case(attribute(grid, "CollectionType"), "Temporal");
}

std::string time_kind(pugi::xml_node time) { return to_lower(attribute(time, "TimeType", "Type")); }

// The numbers of a Time: those of its DataItem, else those that its Value lists.
std::vector<double> time_numbers(const Document& doc, pugi::xml_node time) {
  std::vector<double> numbers;
  if (const pugi::xml_node data = doc.child(time, "DataItem")) {
    const Array a = doc.item(data).values;
    for (size_t i = 0; i < a.count(); ++i) numbers.push_back(a.get(i));
    return numbers;
  }
  const std::string_view text = attribute(time, "Value");
  for (const std::string_view w : words(text)) {
    const auto v = parse_double(w);
    if (!v) doc.fail(fmt::format("has Value=\"{}\"", text), time, "a number");
    numbers.push_back(*v);
  }
  return numbers;
}

// Of a range its beginning.
std::optional<double> own_time(const Document& doc, pugi::xml_node grid) {
  const pugi::xml_node time = doc.child(grid, "Time");
  if (!time) return {};
  const std::vector<double> numbers = time_numbers(doc, time);
  return numbers.empty() ? std::nullopt : std::optional(numbers[0]);
}

/// Times of the grids of a temporal collection: their own, else those of the collection (a list; start, step and count; the ends of a range
/// between which the steps are even), else their places.
std::vector<double> times_of(const Document& doc, pugi::xml_node collection, const std::vector<pugi::xml_node>& grids) {
  std::vector<double> listed, times;
  if (const pugi::xml_node time = doc.child(collection, "Time")) {
    const std::string kind = time_kind(time);
    listed = time_numbers(doc, time);
    if (listed.empty() && (kind == "list" || kind == "hyperslab" || kind == "range"))
      doc.fail("has no DataItem", time, "the times, or start, step and count");
    const std::vector<double> given = listed;
    const bool slab = kind == "hyperslab" && given.size() == 3, range = kind == "range" && given.size() == 2 && grids.size() > 1;
    if (slab || range) listed.resize(grids.size());
    for (size_t i = 0; i < listed.size() && slab; ++i) listed[i] = given[0] + double(i) * given[1];
    for (size_t i = 0; i < listed.size() && range; ++i) listed[i] = given[0] + (given[1] - given[0]) * double(i) / double(grids.size() - 1);
  }
  for (size_t i = 0; i < grids.size(); ++i) {
    const auto own = own_time(doc, grids[i]);
    times.push_back(own ? *own : i < listed.size() ? listed[i] : double(i));
  }
  return times;
}

struct Reader {
  const Document& doc;
  const ReadOptions& options;
  size_t grids = 0;

  Array axis(pugi::xml_node item, size_t n) const {
    const Array a = vtk::as_coordinates(doc.item(item).values);
    if (a.count() != n) doc.fail(fmt::format("has {} coordinates for {} points", a.count(), n), item);
    return a;
  }

  Mesh lattice(pugi::xml_node topology, pugi::xml_node geometry, const std::array<size_t, 3>& dims) const {
    const std::string kind = to_lower(attribute(geometry, "GeometryType", "Type"));
    const auto items = doc.children(geometry, "DataItem");
    if (kind == "origin_dxdydz" || kind == "origin_dxdy") {
      const size_t rank = kind == "origin_dxdy" ? 2 : 3;
      if (items.size() != 2) doc.fail(fmt::format("has {} items", items.size()), geometry, "origin and spacing are needed");
      const Array origin = doc.item(items[0]).values, spacing = doc.item(items[1]).values;
      if (origin.count() != rank || spacing.count() != rank)
        doc.fail(fmt::format("has {} and {} numbers", origin.count(), spacing.count()), geometry, fmt::format("{} each are needed", rank));
      UniformGrid g;
      g.dims = dims;
      for (size_t a = 0; a < rank; ++a) {  // slowest axis first, as the dimensions
        g.origin[int(a)] = origin.get(rank - 1 - a);
        g.spacing[int(a)] = spacing.get(rank - 1 - a);
      }
      return g;
    }
    if (kind == "vxvyvz" || kind == "vxvy") {
      const size_t rank = kind == "vxvy" ? 2 : 3;
      if (items.size() != rank) doc.fail(fmt::format("has {} items", items.size()), geometry, fmt::format("{}", rank));
      RectilinearGrid g;
      g.x = axis(items[0], dims[0]), g.y = axis(items[1], dims[1]);
      g.z = rank == 3 ? axis(items[2], dims[2]) : Array::from_vector(std::vector<double>{0});
      if (rank == 2 && dims[2] != 1) doc.fail("has no z coordinates", geometry, "VXVYVZ");
      return g;
    }
    CurvilinearGrid g;
    g.dims = dims;
    g.points = read_points(doc, geometry);
    if (g.points.count() != dims[0] * dims[1] * dims[2])
      doc.fail(fmt::format("has {} points for a grid of {}x{}x{}", g.points.count(), dims[0], dims[1], dims[2]), topology);
    return g;
  }

  Mesh mesh_of(pugi::xml_node grid) const {
    const pugi::xml_node topology = doc.child(grid, "Topology"), geometry = doc.child(grid, "Geometry");
    if (!topology || !geometry) doc.fail(fmt::format("has no {}", topology ? "Geometry" : "Topology"), grid, "the file is not complete");
    if (const auto dims = lattice_of(doc, topology)) return lattice(topology, geometry, *dims);
    return read_topology(doc, topology, read_points(doc, geometry));
  }

  // XX XY XZ YY YZ ZZ as rows of the whole tensor, so that the order need not be known.
  static Array whole_tensors(const Array& six) {
    constexpr int from[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    std::byte* out = nullptr;
    const size_t size = element_size(six.type());
    Array r = Array::make_raw(six.type(), six.count(), 9, &out);
    for (size_t i = 0; i < six.count(); ++i)
      for (int c = 0; c < 9; ++c, out += size) std::memcpy(out, six.raw() + (i * 6 + size_t(from[c])) * size, size);
    return r;
  }

  void add_attribute(pugi::xml_node a, size_t points, size_t cells, DatasetParts& parts) const {
    const std::string name = find_attribute(a, "Name") ? find_attribute(a, "Name").value() : fmt::format("unnamed {}", parts.fields.size());
    const auto& wanted = options.fields;
    if (!wanted.empty() && !vtk::is_ghost_name(name) && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) return;
    const std::string center = to_lower(attribute(a, "Center")), type = to_lower(attribute(a, "AttributeType", "Type"));
    Association on = Association::point;
    if (center == "cell") on = Association::cell;
    else if (center == "grid") on = Association::whole;
    else if (!center.empty() && center != "node") {
      doc.context().warn(fmt::format("{}: attributes on '{}' are ignored", doc.where(a), center));
      return;
    }
    if (attribute(a, "ItemType") == "FiniteElementFunction") {
      doc.context().warn(fmt::format("{}: finite element functions are ignored", doc.where(a)));
      return;
    }
    const pugi::xml_node data = doc.child(a, "DataItem");
    if (!data) doc.fail("has no DataItem", a, "the file is not complete");
    Array values = doc.item(data).values.made_packed();
    const size_t tuples = on == Association::point ? points : on == Association::cell ? cells : 1;
    size_t components = tuples > 0 ? values.count() / tuples : 1;
    if (on == Association::whole && (type.empty() || type == "scalar")) components = 1;
    if (on != Association::whole && (components * tuples != values.count() || (components == 0 && tuples > 0)))
      doc.fail(fmt::format("has {} numbers for {} {}s", values.count(), tuples, association_name(on)), a);
    if (components == 0 || components > 1 << 20) components = 1;
    const auto size = ptrdiff_t(element_size(values.type()));
    values = Array(values.buffer(), values.type(), values.count() / components, int(components),
                   size_t(values.raw() - values.buffer().data), size * ptrdiff_t(components), size);
    if (type == "tensor6" && components == 6) values = whole_tensors(values);
    const Role role = type == "globalid"                                       ? Role::global_ids
                      : type.starts_with("tensor") && values.components() == 9 ? Role::tensors
                                                                               : Role::none;
    parts.fields.add({name, on, std::move(values), {}, role});
  }

  DatasetPtr uniform(pugi::xml_node grid, std::optional<double> time) {
    DatasetParts parts;
    parts.time = time ? time : own_time(doc, grid);
    parts.mesh = mesh_of(grid);
    const size_t points = point_count(parts.mesh), cells = cell_count(parts.mesh);
    if (!options.header_only)
      for (const pugi::xml_node& a : doc.children(grid, "Attribute")) add_attribute(a, points, cells, parts);
    vtk::take_ghosts(parts);
    return with_context(fmt::format("reading {}", doc.where(grid)), [&] { return make_dataset(std::move(parts)); });
  }

  Data grid_data(pugi::xml_node grid, int depth, std::optional<double> time) {
    doc.context().check();
    if (depth > deepest || ++grids > 1000000) doc.fail("nests grids too deeply", grid);
    const std::string type = grid_type(grid);
    if (type == "uniform") return uniform(grid, time);
    if (type != "collection" && type != "tree")
      doc.fail(fmt::format("is a grid of type '{}', which is not supported", type), grid, "use Uniform, Collection or Tree");
    const auto inner = doc.children(grid, "Grid");
    if (is_temporal(grid)) {
      if (inner.empty()) doc.fail("is a series without grids", grid);
      const std::vector<double> times = times_of(doc, grid, inner);
      const size_t step = chosen_step(times, options, doc.path());
      return grid_data(inner[step], depth + 1, times[step]);
    }
    auto out = std::make_shared<Collection>();
    const auto here = time ? time : own_time(doc, grid);
    for (const pugi::xml_node& g : inner) out->parts.push_back({name_of(g, out->parts.size()), grid_data(g, depth + 1, here)});
    return CollectionPtr(out);
  }

  static std::string name_of(pugi::xml_node grid, size_t i) {
    const std::string name = find_attribute(grid, "Name").value();
    return name.empty() ? fmt::format("grid {}", i) : name;
  }
};

// A grid that only lends its mesh to others is not data of its own.
std::vector<pugi::xml_node> top_grids(const Document& doc) {
  const pugi::xml_node domain = doc.child(doc.root(), "Domain");
  if (!domain) fail_data("has no Domain", doc.path(), "the file is truncated or not complete");
  std::vector<pugi::xml_node> all = doc.children(domain, "Grid"), used;
  for (const pugi::xml_node& g : all)
    if (!doc.is_borrowed(g) || doc.child(g, "Attribute")) used.push_back(g);
  if (all.empty()) doc.fail("has no Grid", domain);
  return used.empty() ? all : used;
}

// The first series in the tree, in the order of the file.
std::vector<double> first_times(const Document& doc, const std::vector<pugi::xml_node>& grids, int depth) {
  for (const pugi::xml_node& g : grids) {
    if (grid_type(g) == "uniform" || depth > deepest) continue;
    const auto inner = doc.children(g, "Grid");
    if (is_temporal(g) && !inner.empty()) return times_of(doc, g, inner);
    if (auto t = first_times(doc, inner, depth + 1); !t.empty()) return t;
  }
  return {};
}

}  // namespace
}  // namespace xdmf

Data read_xdmf(const std::string& path, const ReadOptions& options, Context& context) {
  xdmf::Document doc(path, context);
  doc.note_references();
  xdmf::Reader reader{doc, options};
  const auto grids = xdmf::top_grids(doc);
  if (grids.size() == 1) return reader.grid_data(grids[0], 0, {});
  auto out = std::make_shared<Collection>();
  for (const pugi::xml_node& g : grids) out->parts.push_back({xdmf::Reader::name_of(g, out->parts.size()), reader.grid_data(g, 0, {})});
  return CollectionPtr(out);
}

std::vector<double> times_of_xdmf(const std::string& path, const ReadOptions&, Context& context) {
  xdmf::Document doc(path, context);
  doc.note_references();
  return xdmf::first_times(doc, xdmf::top_grids(doc), 0);
}

}  // namespace sg
