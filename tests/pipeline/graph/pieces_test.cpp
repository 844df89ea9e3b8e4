// SPDX-License-Identifier: Apache-2.0
// Pieces of results: together they are the whole, each cell once, with the same values at every place.
#include <fmt/format.h>

#include <map>

#include "data/cells/cell_reader.h"
#include "filter/every_mesh.h"
#include "filter/mesh/append.h"
#include "filter/mesh/merge_points.h"
#include "filter/stats/integrate.h"
#include "filter/surface/mass_properties.h"
#include "pipeline/graph/graph.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

// A scalar, a vector and a tensor on the points, and values on the cells, none of them linear.
DatasetPtr with_nonlinear_fields(const DatasetPtr& mesh) {
  DatasetParts parts = mesh->parts();
  const Array xyz = point_positions(mesh->mesh());
  std::vector<double> s, v, t, c, d;
  for (size_t i = 0; i < mesh->point_count(); ++i) {
    const double x = xyz.get(i, 0), y = xyz.get(i, 1), z = xyz.get(i, 2);
    s.push_back(std::sqrt(x * x + y * y + 0.8 * z * z) + 0.01 * std::sin(7 * x));
    for (const double k : {std::sin(2 * x + y), x * y - z, std::cos(z) + x * x}) v.push_back(k);
    for (const double k : {2 + x, 0.1 * y, 0.2, 0.1 * y, 3 + z * z, 0.1 * x, 0.2, 0.1 * x, 1.5}) t.push_back(k);
  }
  CellReader reader(mesh);
  for (size_t i = 0; i < mesh->cell_count(); ++i) {
    reader.open(i);
    const Vec3 m = reader.box().center();
    c.push_back(m.x * m.x - m.y + 0.3 * m.z);
    for (const double k : {m.y, -m.x * m.z, m.z}) d.push_back(k);
  }
  parts.fields.add({"s", Association::point, Array::from_vector(std::move(s)), "", Role::scalars});
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  parts.fields.add({"t", Association::point, Array::from_vector(std::move(t), 9), "", Role::tensors});
  parts.fields.add({"c", Association::cell, Array::from_vector(std::move(c)), "", Role::none});
  parts.fields.add({"d", Association::cell, Array::from_vector(std::move(d), 3), "", Role::none});
  return make_dataset(std::move(parts));
}

struct Kind {
  std::string name;
  DatasetPtr mesh;
};

std::vector<Kind> sample_kinds() {
  std::vector<Kind> r;
  for (const MeshKind& k : every_mesh())
    for (const char* name : {"uniform", "curvilinear", "tetra", "bent hexahedron", "polyhedron", "mixed", "amr", "triangles"})
      if (k.name == name) r.push_back({k.name, with_nonlinear_fields(k.make(6, 1))});
  return r;
}

// What each operation that works by pieces is asked for; those of several inputs get the mesh twice.
const std::map<std::string, std::vector<std::vector<std::string>>>& words() {
  static const std::map<std::string, std::vector<std::vector<std::string>>> all{
      {"contour", {{"field=s", "values=0.7"}, {"field=s", "values=0.5,0.8", "normals=false"}}},
      {"slice", {{"axis=z", "position=0.13"}, {"sphere=0,0,0,0.6"}, {"origin=0,0.1,0", "normal=1,2,3"}}},
      {"clip", {{"axis=x", "position=0.21"}, {"field=s", "value=0.6"}, {"box=-0.4,0.3,-2,2,-2,0.5"}}},
      {"isovolume", {{"field=s", "min=0.4"}, {"field=s", "min=0.4", "max=0.9"}}},
      {"threshold", {{"field=s", "min=0.5"}, {"field=c", "max=0.3"}}},
      {"calc", {{"expr=s*s+v.x"}, {"expr=c*2"}}},
      {"select", {{"keep=s,c"}}},
      {"gradient", {{"field=s"}, {"field=v"}, {"field=c"}}},
      {"divergence", {{"field=v"}}},
      {"curl", {{"field=v"}}},
      {"hessian", {{"field=s"}}},
      {"transform", {{"angle=30", "scale=1,2,1"}, {"scale=-1,1,1"}}},
      {"scale", {{"field=s", "factor=2"}}},
      {"magnitude", {{"field=v"}}},
      {"component", {{"field=v"}}},
      {"vortex_measures", {{"field=v"}}},
      {"quality", {{}}},
  };
  return all;
}

Request piece(int k, int n, int ghosts = 0) {
  Request r;
  r.piece = k, r.pieces = n, r.ghost_levels = ghosts;
  return r;
}

bool is_number_of_input(const std::string& name) { return name.starts_with("original_") || name == "part"; }

using Place = std::array<int64_t, 3>;
Place place_of(const Array& xyz, size_t i) {
  Place p;
  for (int a = 0; a < 3; ++a) p[size_t(a)] = int64_t(std::llround(xyz.get(i, a) * 1e6));
  return p;
}

// Points of cells that are not hidden.
std::vector<char> own_points(const DatasetPtr& d) {
  std::vector<char> own(d->point_count(), 0);
  CellReader reader(d);
  for (size_t c = 0; c < d->cell_count(); ++c) {
    if (reader.hidden(c)) continue;
    reader.open(c);
    for (const int64_t id : reader.ids()) own[size_t(id)] = 1;
  }
  return own;
}

// Every point field of the part has the values of the whole where the whole has one point at that place.
std::string other_values(const DatasetPtr& whole, const DatasetPtr& part) {
  std::multimap<Place, size_t> at;
  const Array xyz = point_positions(whole->mesh()), of_part = point_positions(part->mesh());
  const std::vector<char> seen = own_points(whole), own = own_points(part);
  for (size_t i = 0; i < whole->point_count(); ++i)
    if (seen[i]) at.emplace(place_of(xyz, i), i);
  for (size_t i = 0; i < part->point_count(); ++i) {
    if (!own[i]) continue;
    bool found = false;
    for (int64_t dx = -1; dx <= 1 && !found; ++dx)
      for (int64_t dy = -1; dy <= 1 && !found; ++dy)
        for (int64_t dz = -1; dz <= 1 && !found; ++dz) {
          Place p = place_of(of_part, i);
          p[0] += dx, p[1] += dy, p[2] += dz;
          const auto [first, last] = at.equal_range(p);
          if (first == last) continue;
          found = true;
          if (std::next(first) != last) continue;  // points of several parts: which is meant?
          for (const Field& f : part->fields()) {
            if (f.association != Association::point || is_number_of_input(f.name)) continue;
            const Field* g = whole->fields().find(f.name, Association::point);
            if (!g) return fmt::format("the whole has no '{}'", f.name);
            for (int c = 0; c < f.components(); ++c) {
              const double x = f.array.get(i, c), y = g->array.get(first->second, c);
              if (std::abs(x - y) > 2e-5 * (1 + std::abs(y)) || std::isnan(x) != std::isnan(y))
                return fmt::format("'{}' is {}, not {}, at {}, {}, {}", f.name, x, y, of_part.get(i, 0), of_part.get(i, 1),
                                   of_part.get(i, 2));
            }
          }
        }
    if (!found) return fmt::format("a point at {}, {}, {} that the whole has not", of_part.get(i, 0), of_part.get(i, 1), of_part.get(i, 2));
  }
  return "";
}

size_t visible_cells(const DatasetPtr& d) {
  size_t n = 0;
  CellReader reader(d);
  for (size_t c = 0; c < d->cell_count(); ++c) n += !reader.hidden(c);
  return n;
}

std::vector<DatasetPtr> parts_of(const Data& data) {
  std::vector<DatasetPtr> r;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { r.push_back(d); });
  return r;
}

// What tells the pieces from the whole, "" = nothing.
std::string compare(const DatasetPtr& whole, const std::vector<DatasetPtr>& pieces) {
  size_t cells = 0;
  std::vector<Data> all;
  for (const DatasetPtr& p : pieces) {
    cells += visible_cells(p), all.emplace_back(p);
    if (const std::string other = other_values(whole, p); !other.empty()) return other;
  }
  if (cells != visible_cells(whole)) return fmt::format("{} cells, not {}", cells, visible_cells(whole));
  if (cells == 0) return "";
  Context context;
  const TablePtr a = integrate(whole, {}, context), b = integrate(append(all, {.part = false}, context), {}, context);
  const auto column = [](const Table& t, const char* name) -> const Array& {
    for (const Field& f : t.columns)
      if (f.name == name) return f.array;
    throw Error(ErrorKind::internal, "no such column");
  };
  const auto integrals = [&](const Table& t) {
    std::map<std::string, std::pair<double, double>> r;
    for (size_t i = 0; i < t.columns[0].array.count(); ++i) {
      const std::string& field = t.labels[0][size_t(column(t, "field").get(i))];
      if (!is_number_of_input(field))
        r[fmt::format("{} {} {}", field, column(t, "association").get(i), column(t, "component").get(i))] = {column(t, "integral").get(i),
                                                                                                             column(t, "measure").get(i)};
    }
    return r;
  };
  const auto x = integrals(*a), y = integrals(*b);
  if (x.size() != y.size()) return fmt::format("{} integrals, not {}", y.size(), x.size());
  for (const auto& [what, value] : x) {
    const auto found = y.find(what);
    if (found == y.end()) return "no integral of " + what;
    const double other = found->second.first;
    if (std::abs(value.first - other) > 1e-5 * (value.second + std::abs(value.first)))
      return fmt::format("the integral of {} is {}, not {}", what, other, value.first);
  }
  return "";
}

}  // namespace

TEST_CASE("pieces: of every operation that works by pieces, they are the whole: cells, integrals, values at every place") {
  const std::vector<Kind> meshes = sample_kinds();
  REQUIRE(meshes.size() >= 7);
  for (const Operation& o : operations()) {
    if (o.pieces.result != PieceWork::Result::of_piece) continue;
    int answered = 0;
    const auto found = words().find(std::string(o.name));
    const std::vector<std::vector<std::string>> sets = found == words().end() ? std::vector<std::vector<std::string>>{{}} : found->second;
    for (const Kind& kind : meshes)
      for (const std::vector<std::string>& set : sets) {
        Graph g;
        const NodeId data = g.add_data(kind.mesh);
        const std::vector<NodeId> inputs(size_t(std::max({1, o.min_inputs, o.max_inputs < 0 ? 2 : 1})), data);
        const NodeId node = g.add_operation(std::string(o.name), set, inputs);
        Context context;
        Data whole;
        try {
          whole = g.evaluate(node, {}, context);
        } catch (const Error&) {
          continue;  // not for this kind of mesh
        }
        ++answered;
        const std::vector<DatasetPtr> wholes = parts_of(whole);
        for (const int n : {1, 2, 3, 5}) {
          std::vector<std::vector<DatasetPtr>> pieces(wholes.size());
          for (int k = 0; k < n; ++k) {
            const std::vector<DatasetPtr> of = parts_of(g.evaluate(node, piece(k, n), context));
            REQUIRE(of.size() == wholes.size());
            for (size_t i = 0; i < of.size(); ++i) pieces[i].push_back(of[i]);
          }
          for (size_t i = 0; i < wholes.size(); ++i)
            CHECK_MESSAGE(compare(wholes[i], pieces[i]) == "",
                          fmt::format("{} {} of {} in {}", o.name, set.empty() ? "" : set[0], kind.name, n));
        }
      }
    CHECK_MESSAGE(answered > 0, o.name << " answers for no mesh: give it words");
  }
}

TEST_CASE("pieces: the surfaces of pieces close where they meet") {
  Context context;
  for (const Kind& kind : sample_kinds()) {
    if (kind.name == "triangles" || kind.name == "amr") continue;  // AMR: surfaces of levels meet without common edges
    CAPTURE(kind.name);
    Graph g;
    const NodeId data = g.add_data(kind.mesh);
    for (const NodeId node : {g.add_operation("contour", {"field=s", "values=0.7"}, {data}), g.add_operation("faces", {}, {data})})
      for (const int n : {1, 2, 3, 5}) {
        std::vector<Data> pieces;
        for (int k = 0; k < n; ++k) pieces.push_back(g.evaluate(node, piece(k, n), context));
        const DatasetPtr all = merge_points(append(pieces, {.part = false}, context), {.tolerance = 1e-6}, context);
        const TablePtr t = mass_properties(all, {}, context), whole = mass_properties(g.evaluate(node, {}, context), {}, context);
        CHECK(t->columns[1].array.get(0) == whole->columns[1].array.get(0));
        CHECK(t->columns[2].array.get(0) == doctest::Approx(whole->columns[2].array.get(0)).epsilon(1e-6));
      }
  }
}

TEST_CASE("pieces: a piece of what needs the whole is cut out of it, and the whole is computed once") {
  Graph g;
  const NodeId data = g.add_data(sample_kinds()[0].mesh);
  const NodeId node = g.add_operation("calc", {"expr=component+0"}, {g.add_operation("components", {}, {data})});
  Context context;
  size_t cells = 0;
  for (int k = 0; k < 3; ++k) cells += visible_cells(single_dataset(g.evaluate(node, piece(k, 3), context), "test"));
  CHECK(cells == single_dataset(g.evaluate(node, {}, context), "test")->cell_count());
  std::string kept;
  const Target target{node, piece(1, 3)};
  for (const PlannedStep& s : g.plan({&target, 1})) kept += s.does + (s.state == PlannedStep::State::cached ? " kept, " : ", ");
  CHECK(kept.find("components kept") != std::string::npos);
  CHECK(request_text(piece(1, 3, 2)) == "piece=1/3/2");
}

TEST_CASE("pieces: layers of ghosts add up on the way to the reader, and what is chosen from all of the data needs the whole") {
  const auto up = [](const char* name, const std::vector<std::string>& words, const Request& wanted, bool together = false) {
    const Operation& o = find_operation(name);
    return request_text(upstream_request(o, make_params(o, words), wanted, 0, together));
  };
  CHECK(up("calc", {"expr=s"}, piece(1, 4)) == "piece=1/4");
  CHECK(up("gradient", {"field=s"}, piece(1, 4)) == "piece=1/4/4");
  CHECK(up("gradient", {"field=s"}, piece(1, 4, 2)) == "piece=1/4/6");
  CHECK(up("cell_to_point", {}, piece(1, 4, 1)) == "piece=1/4/2");
  CHECK(up("contour", {"field=s", "values=1"}, piece(1, 4)) == "piece=1/4/1");
  CHECK(up("contour", {"field=s", "values=1"}, piece(1, 4, 1)) == "everything");  // it leaves ghosts out
  CHECK(up("contour", {"field=s"}, piece(1, 4)) == "everything");
  CHECK(up("contour", {"field=s"}, piece(1, 4), true) == "piece=1/4/1");
  CHECK(up("label_components", {}, piece(1, 4)) == "everything");
  CHECK(up("integrate", {}, piece(1, 4)) == "everything");
  CHECK(up("integrate", {}, piece(1, 4), true) == "piece=1/4");
}

TEST_CASE("pieces: files are read in pieces with the ghosts that an operation needs") {
  Context context;
  for (const Kind& kind : sample_kinds())
    for (const char* ending : {".vti", ".vtu", ".pvtu"}) {
      if ((kind.name == "uniform") != (std::string(ending) == ".vti") || kind.name == "amr" || kind.name == "triangles" ||
          kind.name == "curvilinear")
        continue;
      CAPTURE(kind.name);
      CAPTURE(std::string(ending));
      const std::string path = temp_folder() + "pieces of " + kind.name + ending;
      write_data(path, kind.mesh, {.pieces = std::string(ending) == ".pvtu" ? 4 : 1}, context);
      Graph g;
      const NodeId read = g.add_read(path);
      for (const NodeId node :
           {read, g.add_operation("gradient", {"field=s"}, {read}), g.add_operation("threshold", {"field=s", "min=0.5"}, {read})}) {
        const DatasetPtr whole = single_dataset(g.evaluate(node, {}, context), "test");
        std::vector<DatasetPtr> pieces;
        for (int k = 0; k < 3; ++k) pieces.push_back(single_dataset(g.evaluate(node, piece(k, 3), context), "test"));
        CHECK(compare(whole, pieces) == "");
      }
      ReadOptions mine;
      mine.piece = 1, mine.pieces = 2;
      const NodeId half = g.add_read(path, mine);  // the user's piece is the whole here
      size_t cells = 0;
      for (int k = 0; k < 3; ++k) cells += visible_cells(single_dataset(g.evaluate(half, piece(k, 3), context), "test"));
      CHECK(cells == visible_cells(single_dataset(g.evaluate(half, {}, context), "test")));
    }
}

TEST_CASE("pieces: each point belongs to one piece") {
  Context context;
  for (const Kind& kind : sample_kinds()) {
    if (kind.name == "amr") continue;
    CAPTURE(kind.name);
    Graph g;
    const NodeId data = g.add_data(kind.mesh);
    for (const int ghosts : {0, 1}) {
      size_t own = 0;
      for (int k = 0; k < 3; ++k) {
        const DatasetPtr d = single_dataset(g.evaluate(data, piece(k, 3, ghosts), context), "test");
        for (size_t i = 0; i < d->point_count(); ++i) own += d->point_ghost().empty() || d->point_ghost().get(i) == 0;
      }
      CHECK(own == kind.mesh->point_count());
    }
  }
}
