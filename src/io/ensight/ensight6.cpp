// SPDX-License-Identifier: Apache-2.0
#include "io/ensight/ensight6.h"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>

#include "base/bytes.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "io/ensight/variables.h"
#include "io/mesh/blanking.h"
#include "io/mesh/unread.h"
#include "io/volume/brick.h"

namespace sg::ensight {

namespace {

bool is_part(const std::string& line) { return to_lower(line).starts_with("part"); }

class GeometryReader {
 public:
  GeometryReader(Stream& s, Context& context) : s_(s), context_(context) {}

  Geometry run() {
    if (s_.form() != Form::ascii && s_.peek().find("inary") != std::string::npos) s_.line("the form");
    if (s_.peek() == "BEGIN TIME STEP") s_.keyword("BEGIN TIME STEP");
    Geometry g;
    g.description = s_.line("a description");
    s_.line("a description");
    const std::string nodes = stated_ids(s_, "node id"), elements = stated_ids(s_, "element id");
    node_ids_ = nodes == "given", node_numbers_ = node_ids_ || nodes == "ignore";
    element_numbers_ = elements == "given" || elements == "ignore";
    read_nodes(g);
    while (is_part(s_.peek())) {
      g.parts.push_back(part());
      context_.check();
    }
    if (const std::string k = s_.peek(); !s_.at_end() && k != "END TIME STEP")
      s_.fail(fmt::format("found '{}' where a part was expected", k.substr(0, 40)));
    return g;
  }

 private:
  // In text the number of a node stands before its place, in binary files all numbers come first.
  void read_nodes(Geometry& g) {
    if (const std::string k = to_lower(s_.keyword("coordinates")); k != "coordinates")
      s_.fail(fmt::format("found '{}' where 'coordinates' was expected", k.substr(0, 40)));
    const size_t n = g.nodes = s_.count("nodes", 12);
    std::vector<int32_t> numbers;
    if (s_.form() == Form::ascii && node_numbers_) {
      const Array rows = s_.reals(4 * n, "nodes");
      const auto v = rows.view<float>();
      for (size_t i = 0; i < n; ++i) {
        constexpr float exact = 1 << 24;
        if (!(std::abs(v[4 * i]) < exact))
          s_.fail(fmt::format("the node number {} is too large", v[4 * i]), "numbers below 16,777,216 are read");
        numbers.push_back(int32_t(v[4 * i]));
      }
      xyz_ = Array(Array(rows.buffer(), ElementType::f32, n, 3, 4, 16, 4).made_packed());
    } else {
      if (node_numbers_) numbers = s_.integers(n, "node numbers");
      const Array rows = s_.reals(3 * n, "nodes");
      xyz_ = Array(rows.buffer(), ElementType::f32, n, 3);
    }
    if (!node_ids_) return;
    for (size_t i = 0; i < n; ++i) place_of_[numbers[i]] = int64_t(i);
  }

  int64_t place(int32_t number) const {
    if (node_ids_) {
      const auto at = place_of_.find(number);
      if (at == place_of_.end()) s_.fail(fmt::format("an element has the node {}, which is not listed", number));
      return at->second;
    }
    if (number < 1 || size_t(number) > xyz_.count())
      s_.fail(fmt::format("an element has the node {}, but nodes are 1 to {}", number, xyz_.count()));
    return number - 1;
  }

  Part part() {
    Part p;
    const std::string line = s_.keyword("part");
    const auto w = words(line);
    const auto number = w.size() > 1 ? parse_int(w[1]) : std::nullopt;
    if (!number || *number < 0 || *number > 1'000'000'000) s_.fail(fmt::format("'{}' does not number a part", line), "write e.g. 'part 1'");
    p.number = int(*number);
    p.name = s_.line("the name of a part");
    const std::string k = to_lower(s_.peek());
    if (k.starts_with("block")) block(p, k.find("iblanked") != k.npos);
    else unstructured(p);
    return p;
  }

  void unstructured(Part& p) {
    std::vector<int64_t> ids, ends{0};
    std::vector<uint8_t> types;
    for (;;) {
      const std::string k = to_lower(s_.peek());
      const Element* e = find_element(k);
      if (!e) break;
      s_.keyword("an element type");
      if (e->nodes < 0) s_.fail(fmt::format("elements '{}' belong to EnSight Gold", e->name));
      const size_t n = s_.count("elements", 4 * size_t(e->nodes)), nodes = size_t(e->nodes);
      p.sections.push_back({k, p.cells, n});
      size_t row = nodes, skipped = 0;
      if (element_numbers_) {
        if (s_.form() == Form::ascii) ++row, skipped = 1;
        else s_.skip_numbers(n, "element numbers");
      }
      uint64_t total = 0;
      if (!multiply(n, row, total)) s_.fail(fmt::format("{} elements", n));
      const std::vector<int32_t> v = s_.integers(total, fmt::format("nodes of {}", e->name));
      for (size_t i = 0; i < n; ++i) {
        const size_t begin = ids.size();
        for (size_t j = 0; j < nodes; ++j) ids.push_back(place(v[i * row + skipped + j]));
        if (e->type == CellType::quadratic_edge) std::swap(ids[begin + 1], ids[begin + 2]);
        ends.push_back(int64_t(ids.size()));
      }
      types.insert(types.end(), n, uint8_t(e->type));
      p.cells += n;
    }
    // The nodes of this part alone, in the order of the file.
    p.nodes = ids;
    std::sort(p.nodes.begin(), p.nodes.end());
    p.nodes.erase(std::unique(p.nodes.begin(), p.nodes.end()), p.nodes.end());
    for (int64_t& id : ids) id = std::lower_bound(p.nodes.begin(), p.nodes.end(), id) - p.nodes.begin();
    p.points = p.nodes.size();
    UnstructuredMesh m;
    m.points.xyz = gather(xyz_, p.nodes);
    m.cells.connectivity = Array::from_vector(std::move(ids));
    m.cells.offsets = Array::from_vector(std::move(ends));
    m.types = Array::from_vector(std::move(types));
    p.data.mesh = std::move(m);
  }

  void block(Part& p, bool blanked) {
    s_.keyword("block");
    p.structured = true;
    const std::vector<int32_t> size = s_.integers(3, "the size of a block");
    CurvilinearGrid g;
    for (size_t a = 0; a < 3; ++a) {
      if (size[a] < 1) s_.fail(fmt::format("a block of {} x {} x {} nodes", size[0], size[1], size[2]));
      g.dims[a] = size_t(size[a]);
    }
    p.points = checked_product({g.dims[0], g.dims[1], g.dims[2]}, s_.path());
    p.cells = lattice_cell_count(g.dims);
    const Array x = s_.reals(p.points, "x"), y = s_.reals(p.points, "y"), z = s_.reals(p.points, "z");
    g.points.xyz = interleaved(x, y, z);
    if (blanked) {
      const std::vector<int32_t> blank = s_.integers(p.points, "iblank values");
      std::vector<uint8_t> points(p.points), cells(p.cells);
      for (size_t i = 0; i < p.points; ++i) points[i] = blank[i] == 0 ? uint8_t(ghost_hidden_point) : uint8_t(0);
      hide_cells(g.dims, points.data(), cells.data());
      p.data.point_ghost = Array::from_vector(std::move(points)), p.data.cell_ghost = Array::from_vector(std::move(cells));
    }
    p.data.mesh = std::move(g);
  }

  Stream& s_;
  Context& context_;
  bool node_ids_ = false, node_numbers_ = false, element_numbers_ = false;
  Array xyz_;
  std::unordered_map<int32_t, int64_t> place_of_;
};

Array in_our_order(const Array& a, VariableKind kind) {
  if (kind != VariableKind::tensor_symm) return a;
  float* out = nullptr;
  Array r = Array::make<float>(a.count(), 6, &out);
  const auto v = a.view<float>();
  for (size_t i = 0; i < a.count(); ++i)
    for (int c = 0; c < 6; ++c) out[6 * i + size_t(component_of(kind, c))] = v.data[6 * i + size_t(c)];
  return r;
}

class VariableReader {
 public:
  VariableReader(Stream& s, const Variable& v, const std::string& name, Geometry& g, bool look_only)
      : s_(s), v_(v), name_(name), g_(g), look_only_(look_only) {}

  void run() {
    if (s_.peek() == "BEGIN TIME STEP") s_.keyword("BEGIN TIME STEP");
    s_.line("a description");
    const bool on_cells = v_.association == Association::cell;
    if (!on_cells && !is_part(s_.peek()) && g_.nodes > 0) {
      const Array all = tuples(g_.nodes);
      for (Part& p : g_.parts)
        if (!p.structured) put(p, look_only_ ? unread_values(ElementType::f32, p.points, v_.components()) : gather(all, p.nodes));
    }
    while (is_part(s_.peek())) {
      Part& p = part(s_.keyword("part"));
      if (!p.structured) {
        on_elements(p);
        continue;
      }
      if (const std::string line = to_lower(s_.keyword("block")); !line.starts_with("block"))
        s_.fail(fmt::format("found '{}' where 'block' was expected in part {}", line.substr(0, 40), p.number));
      put(p, components_in_turn(on_cells ? p.cells : p.points));
    }
    if (const std::string k = s_.peek(); !s_.at_end() && k != "END TIME STEP")
      s_.fail(fmt::format("found '{}' where a part was expected", k.substr(0, 40)));
  }

 private:
  // The components of each node or element together.
  Array tuples(size_t n) {
    const int k = v_.components();
    uint64_t total = 0;
    if (!multiply(n, uint64_t(k), total)) s_.fail(fmt::format("{} values", n));
    if (look_only_) {
      s_.skip_numbers(total, "values");
      return unread_values(ElementType::f32, n, k);
    }
    const Array a = s_.reals(total, "values");
    return in_our_order(Array(a.buffer(), ElementType::f32, n, k), v_.kind);
  }

  // Blocks: one component after the other.
  Array components_in_turn(size_t n) {
    const auto k = size_t(v_.components());
    if (look_only_) {
      for (size_t c = 0; c < k; ++c) s_.skip_numbers(n, "values");
      return unread_values(ElementType::f32, n, int(k));
    }
    float* out = nullptr;
    Array r = Array::make<float>(n, int(k), &out);
    for (size_t c = 0; c < k; ++c) {
      const Array a = s_.reals(n, "values");
      const auto v = a.view<float>();
      for (size_t i = 0; i < n; ++i) out[k * i + c] = v[i];
    }
    return in_our_order(r, v_.kind);
  }

  void on_elements(Part& p) {
    const auto k = size_t(v_.components());
    float* out = nullptr;
    Array all = look_only_ ? unread_values(ElementType::f32, p.cells, int(k)) : Array::make<float>(p.cells, int(k), &out);
    if (out) std::fill_n(out, p.cells * k, std::numeric_limits<float>::quiet_NaN());
    std::vector<bool> done(p.sections.size());
    for (;;) {
      const std::string line = to_lower(s_.peek());
      const Element* e = line.empty() ? nullptr : find_element(line);
      if (!e) break;
      s_.keyword("an element type");
      size_t i = 0;
      while (i < done.size() && (done[i] || find_element(p.sections[i].type) != e)) ++i;
      if (i == done.size()) s_.fail(fmt::format("part {} has no (further) elements '{}'", p.number, e->name));
      done[i] = true;
      const Section& section = p.sections[i];
      const Array a = tuples(section.count);
      if (out) std::copy_n(a.made_packed().view<float>().data, section.count * k, out + section.first * k);
    }
    put(p, all);
  }

  void put(Part& p, Array values) {
    const Role role = v_.kind == VariableKind::vector ? Role::vectors : Role::none;
    p.data.fields.add({name_, v_.association, std::move(values), "", role});
  }

  Part& part(const std::string& line) {
    const auto w = words(line);
    const auto number = w.size() > 1 ? parse_int(w[1]) : std::nullopt;
    if (number)
      for (Part& p : g_.parts)
        if (p.number == *number) return p;
    s_.fail(fmt::format("'{}' is not in the geometry", line.substr(0, 40)));
  }

  Stream& s_;
  const Variable& v_;
  const std::string& name_;
  Geometry& g_;
  bool look_only_;
};

}  // namespace

Geometry read_geometry6(Stream& s, Context& context) { return GeometryReader(s, context).run(); }

void read_variable6(Stream& s, const Variable& v, const std::string& name, Geometry& geometry, bool look_only) {
  VariableReader(s, v, name, geometry, look_only).run();
}

}  // namespace sg::ensight
