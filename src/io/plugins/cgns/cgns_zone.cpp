// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/cgns/cgns_zone.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "data/lattice_crop.h"
#include "io/mesh/unread.h"
#include "io/plugins/cgns/cgns_elements.h"
#include "io/volume/component_names.h"

namespace sg::cg {

namespace {

constexpr size_t points_per_chunk = 1 << 15;

/// Sizes of a zone: points and cells along each index, as many as it has.
struct ZoneSize {
  bool structured = false;
  std::vector<size_t> points, cells;
  static size_t product(const std::vector<size_t>& n) {
    uint64_t r = 1;
    for (const size_t k : n)
      if (!multiply(r, k, r)) return SIZE_MAX;
    return r;
  }
};

ZoneSize size_of(const CgFile& file, const Node& zone, const std::vector<Node>& parts) {
  ZoneSize z;
  const Node* type = CgFile::labelled(parts, "ZoneType_t");
  const std::string text = type ? file.text(*type) : "Structured";
  z.structured = text == "Structured";
  if (!z.structured && text != "Unstructured")
    file.fail(fmt::format("is a zone of type '{}'", text), zone, "supported: Structured and Unstructured");
  const std::vector<int64_t> n = file.integers(zone);
  const size_t rank = zone.dims.empty() ? 0 : zone.dims[0];
  if (rank < 1 || rank > 3 || n.size() < 2 * rank) file.fail("does not give its size", zone);
  for (size_t a = 0; a < rank; ++a) {
    if (n[a] < 0 || n[rank + a] < 0) file.fail(fmt::format("has {} points and {} cells", n[a], n[rank + a]), zone);
    z.points.push_back(size_t(n[a])), z.cells.push_back(size_t(n[rank + a]));
  }
  return z;
}

/// Planes of points or cells around the zone, two numbers an index; zeros without.
std::vector<size_t> rind_of(const CgFile& file, const std::vector<Node>& parts, size_t rank) {
  std::vector<size_t> rind(2 * rank, 0);
  if (const Node* r = CgFile::labelled(parts, "Rind_t")) {
    const std::vector<int64_t> n = file.integers(*r);
    if (n.size() != rind.size()) file.fail(fmt::format("has {} numbers, not {}", n.size(), rind.size()), *r);
    for (size_t i = 0; i < n.size(); ++i) {
      if (n[i] < 0) file.fail(fmt::format("has the number {}", n[i]), *r);
      rind[i] = size_t(n[i]);
    }
  }
  return rind;
}

/// The numbers of a node without its rind (or placeholders for them); empty when its size does not fit `n`.
Array inner(const CgFile& file, const Node& node, const std::vector<size_t>& n, const std::vector<size_t>& rind, bool header_only = false) {
  std::vector<size_t> whole = n;
  bool cut = false;
  for (size_t a = 0; a < n.size(); ++a) {
    uint64_t s = 0;
    if (!add(n[a], rind[2 * a], s) || !add(s, rind[2 * a + 1], s)) return {};
    whole[a] = s;
    cut = cut || rind[2 * a] || rind[2 * a + 1];
  }
  if (node.count() != ZoneSize::product(whole)) return {};
  if (header_only) return unread_values(file.number_type(node), ZoneSize::product(n));
  const Array all = file.numbers(node);
  if (!cut) return all;
  std::array<size_t, 3> dims{1, 1, 1}, lo{0, 0, 0}, count{1, 1, 1};
  for (size_t a = 0; a < n.size(); ++a) dims[a] = whole[a], lo[a] = rind[2 * a], count[a] = n[a];
  return crop_block(all, dims, lo, count, {1, 1, 1});
}

/// Components side by side, as many as there are or three; of one type.
Array grouped(const std::vector<Array>& members, bool header_only = false) {
  if (members.size() == 1) return members[0];
  ElementType type = members[0].type();
  for (const Array& a : members)
    if (a.type() != type) type = ElementType::f64;
  const size_t n = members[0].count(), width = std::max<size_t>(members.size(), 3), size = element_size(type);
  if (header_only) return unread_values(type, n, int(width));
  std::byte* out = nullptr;
  Array r = Array::make_raw(type, n, int(width), &out);
  std::vector<Array> from;
  for (const Array& a : members) from.push_back(a.converted(type));
  parallel_for(n, points_per_chunk, [&](size_t begin, size_t end) {
    for (size_t c = 0; c < width; ++c)
      for (size_t i = begin; i < end; ++i) {
        std::byte* to = out + (i * width + c) * size;
        if (c < from.size()) std::memcpy(to, from[c].raw() + i * size, size);
        else std::memset(to, 0, size);
      }
  });
  return r;
}

/// Positions from CoordinateX/Y/Z, or cylindrical CoordinateR/Theta/Z.
Points positions(const CgFile& file, const Node& grid, const ZoneSize& size) {
  const std::vector<Node> parts = file.children(grid);
  const std::vector<size_t> rind = rind_of(file, parts, size.points.size());
  const size_t n = ZoneSize::product(size.points);
  const auto axis = [&](const char* name) {
    const Node* node = CgFile::named(parts, name);
    if (!node) return Array();
    Array a = inner(file, *node, size.points, rind);
    if (a.count() != n) file.fail(fmt::format("holds {} numbers for {} points", node->count(), n), *node);
    return is_float(a.type()) ? a : a.converted(ElementType::f64);
  };
  std::vector<Array> axes = {axis("CoordinateX"), axis("CoordinateY"), axis("CoordinateZ")};
  if (const Array r = axis("CoordinateR"), theta = axis("CoordinateTheta"); axes[0].empty() && n > 0 && !r.empty() && !theta.empty()) {
    double *x = nullptr, *y = nullptr;
    axes[0] = Array::make<double>(n, 1, &x), axes[1] = Array::make<double>(n, 1, &y);
    for (size_t i = 0; i < n; ++i) x[i] = r.get(i) * std::cos(theta.get(i)), y[i] = r.get(i) * std::sin(theta.get(i));
  }
  if (n > 0 && axes[0].empty() && axes[1].empty() && axes[2].empty())
    file.fail("has no CoordinateX, CoordinateY or CoordinateZ", grid, "spherical and auxiliary coordinates are not supported");
  const Array* some = nullptr;
  for (const Array& a : axes)
    if (!a.empty()) some = &a;
  for (Array& a : axes)
    if (a.empty() && some) {
      std::byte* zero = nullptr;
      a = Array::make_raw(some->type(), n, 1, &zero);
      std::memset(zero, 0, a.bytes());
    }
  Points p;
  p.xyz = n > 0 ? grouped(axes) : Array::from_vector(std::vector<double>(), 3);
  return p;
}

class Fields {
 public:
  Fields(const CgFile& file, const Base& base, const ZoneSize& size, size_t cells, const ReadOptions& options, Context& context)
      : file_(file), base_(base), size_(size), cells_(cells), options_(options), context_(context) {}

  void add(const Node& solution) {
    const std::vector<Node> parts = file_.children(solution);
    const Node* location = CgFile::labelled(parts, "GridLocation_t");
    const std::string where = location ? file_.text(*location) : "Vertex";
    if (where != "Vertex" && where != "CellCenter") {
      context_.info(fmt::format("{}: {} is on {}, which is not supported; it is left out", file_.path(), solution.path, where));
      return;
    }
    const Association association = where == "Vertex" ? Association::point : Association::cell;
    std::vector<size_t> n = association == Association::point ? size_.points : size_.cells;
    const std::vector<size_t> rind = rind_of(file_, parts, n.size());
    std::vector<const Node*> nodes;
    std::vector<std::string> names;
    for (const Node& p : parts)
      if (p.label == "DataArray_t" && p.type != "C1") nodes.push_back(&p), names.push_back(p.name);
    for (const NameGroup& group : group_components(names, base_.physical_dimension == 2)) {
      if (!wanted(group, names)) continue;
      std::vector<Array> members;
      for (const size_t k : group.members) {
        Array a = inner(file_, *nodes[k], n, rind, options_.header_only);
        // An unstructured mesh may have fewer cells than its zone states: those of lower dimension are left out.
        const size_t expected = association == Association::point ? ZoneSize::product(size_.points) : cells_;
        if (a.count() == expected && expected > 0) members.push_back(std::move(a));
        else
          context_.warn(fmt::format("{}: {} holds {} numbers for {} {}; it is left out", file_.path(), nodes[k]->path, nodes[k]->count(),
                                    expected, association == Association::point ? "points" : "cells"));
      }
      if (members.size() != group.members.size()) continue;
      const Role role = members.size() == 1 ? Role::none : members.size() <= 3 ? Role::vectors : Role::tensors;
      std::string name = group.name;
      if (fields.find(name, association)) name += " of " + solution.name;  // several solutions at once
      fields.add({std::move(name), association, grouped(members, options_.header_only), unit_of(*nodes[group.members[0]]), role});
    }
  }

  FieldSet fields;

 private:
  bool wanted(const NameGroup& group, const std::vector<std::string>& names) const {
    if (options_.fields.empty()) return true;
    for (const std::string& f : options_.fields) {
      if (f == group.name || f.starts_with(group.name + " of ")) return true;
      for (const size_t k : group.members)
        if (names[k] == f) return true;
    }
    return false;
  }
  // DimensionalUnits: five words of 32 characters; given only where a single one is not "Null" or "UserDefined".
  std::string unit_of(const Node& array) const {
    const std::vector<Node> parts = file_.children(array, "Descriptor_t");
    for (const Node& d : parts)
      if (d.name == "Units" || d.name == "units") return file_.text(d);
    return {};
  }

  const CgFile& file_;
  const Base& base_;
  const ZoneSize& size_;
  size_t cells_;
  const ReadOptions& options_;
  Context& context_;
};

/// The name that ZoneIterativeData gives for the step ("FlowSolutionPointers", "GridCoordinatesPointers"); "" without.
std::string pointed(const CgFile& file, const Base& base, const std::vector<Node>& zone, const char* which) {
  const Node* data = CgFile::labelled(zone, "ZoneIterativeData_t");
  if (!data || !base.has_steps) return {};
  const std::vector<Node> parts = file.children(*data);
  const Node* list = CgFile::named(parts, which);
  if (!list) return {};
  const std::vector<std::string> names = file.names(*list);
  return base.step < names.size() ? names[base.step] : std::string();
}

}  // namespace

DatasetPtr read_zone(const CgFile& file, const Base& base, const Node& zone, const ReadOptions& options, Context& context) {
  const std::vector<Node> parts = file.children(zone);
  const ZoneSize size = size_of(file, zone, parts);
  const std::string grid_name = pointed(file, base, parts, "GridCoordinatesPointers");
  const Node* grid = grid_name.empty() ? nullptr : CgFile::named(parts, grid_name);
  if (!grid) grid = CgFile::labelled(parts, "GridCoordinates_t");
  if (!grid) file.fail("has no coordinates", zone);
  DatasetParts result;
  size_t cells = 0;
  Points points = positions(file, *grid, size);
  if (size.structured) {
    CurvilinearGrid g;
    for (size_t a = 0; a < size.points.size(); ++a) g.dims[a] = size.points[a];
    cells = 1;
    for (const size_t d : g.dims) cells *= std::max<size_t>(d, 2) - 1;
    g.points = std::move(points);
    result.mesh = std::move(g);
  } else {
    UnstructuredMesh mesh = zone_cells(file, parts, base.cell_dimension, base.version);
    cells = mesh.cells.size();
    mesh.points = std::move(points);
    result.mesh = std::move(mesh);
  }
  Fields fields(file, base, size, cells, options, context);
  const std::string solution = pointed(file, base, parts, "FlowSolutionPointers");
  for (const Node& n : parts) {
    if (n.label != "FlowSolution_t" && n.label != "DiscreteData_t") continue;
    context.check();
    if (n.label == "DiscreteData_t" || solution.empty() || n.name == solution) fields.add(n);
  }
  result.fields = std::move(fields.fields);
  result.notes = base.notes;
  for (const Node& n : parts)
    if (n.label == "FamilyName_t" || n.label == "AdditionalFamilyName_t") result.notes.emplace_back("family", file.text(n));
    else if (n.label == "Descriptor_t") result.notes.emplace_back(n.name, file.text(n));
  if (const Node* bc = CgFile::labelled(parts, "ZoneBC_t"))
    for (const Node& n : file.children(*bc, "BC_t")) result.notes.emplace_back("boundary " + n.name, file.text(n));
  result.time = base.time;
  return with_context(fmt::format("reading {}", zone.path), [&] { return make_dataset(std::move(result)); });
}

}  // namespace sg::cg
