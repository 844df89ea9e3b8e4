// SPDX-License-Identifier: Apache-2.0
// Lines through every kind of mesh of about 200,000 cells: by walking, and by asking the locator for every place. One thread, meshes and
// indices at hand, RK4 in half cells: what a step costs.
#include <fmt/core.h>

#include <numbers>

#include "bench.h"
#include "data/cells/point_positions.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/trace_line.h"
#include "inputs.h"

namespace sg::bench {

namespace {

Vec3 flow(Vec3 p) {
  const double k = std::numbers::pi;
  return {std::sqrt(3.0) * std::sin(k * p.z) + std::cos(k * p.y), std::sqrt(2.0) * std::sin(k * p.x) + std::sqrt(3.0) * std::cos(k * p.z),
          std::sin(k * p.y) + std::sqrt(2.0) * std::cos(k * p.x)};
}

DatasetPtr with_flow(Mesh mesh) {
  const Array at = point_positions(mesh);
  const View<double> x = at.view<double>();
  float* v = nullptr;
  Array values = Array::make<float>(x.count, 3, &v);
  for (size_t i = 0; i < x.count; ++i) {
    const Vec3 u = flow({x(i, 0), x(i, 1), x(i, 2)});
    for (int c = 0; c < 3; ++c) v[3 * i + size_t(c)] = float(u[c]);
  }
  FieldSet fields;
  fields.add({"u", Association::point, values, "", Role::vectors});
  return make_dataset(std::move(mesh), std::move(fields));
}

Vec3 bent(Vec3 p) {
  const double w = 0.08 * (1 - p.x * p.x) * (1 - p.y * p.y) * (1 - p.z * p.z);
  return p + w * Vec3(std::sin(5 * p.y + 3 * p.z), std::sin(5 * p.z + 3 * p.x), std::sin(5 * p.x + 3 * p.y));
}

/// n^3 bent blocks of [-1,1]^3, each cut into cells whose nodes stand at thirds or halves (`parts`) of the block: rows of x + 3 (y + 3 z)
/// for halves, of x + 2 (y + 2 z) for corners. Polyhedra: the blocks by their faces.
DatasetPtr blocks(size_t n, CellType type, size_t parts, const std::vector<std::vector<int>>& cells) {
  const size_t m = n * parts + 1, row = parts + 1;
  std::vector<float> xyz;
  for (size_t k = 0; k < m; ++k)
    for (size_t j = 0; j < m; ++j)
      for (size_t i = 0; i < m; ++i) {
        const Vec3 p = bent(Vec3(double(i), double(j), double(k)) * (2.0 / double(m - 1)) - Vec3(1, 1, 1));
        xyz.insert(xyz.end(), {float(p.x), float(p.y), float(p.z)});
      }
  UnstructuredMesh mesh;
  std::vector<int64_t> ids, offsets{0}, face_ids, face_offsets{0}, cell_faces{0};
  constexpr int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 4, 7, 3}, {1, 2, 6, 5}};
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i)
        for (const auto& c : cells) {
          const size_t first = ids.size();
          for (const int q : c) {
            const auto u = size_t(q);
            ids.push_back(int64_t(i * parts + u % row + m * (j * parts + u / row % row + m * (k * parts + u / row / row))));
          }
          offsets.push_back(int64_t(ids.size()));
          if (type != CellType::polyhedron) continue;
          for (const auto& f : faces) {
            for (const int q : f) face_ids.push_back(ids[first + size_t(q)]);
            face_offsets.push_back(int64_t(face_ids.size()));
          }
          cell_faces.push_back(int64_t(face_offsets.size()) - 1);
        }
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.cells.offsets = Array::from_vector(std::move(offsets));
  mesh.single_type = type;
  if (type == CellType::polyhedron) {
    mesh.types = Array::from_vector(std::vector<uint8_t>(n * n * n, uint8_t(type)));
    mesh.faces.connectivity = Array::from_vector(std::move(face_ids));
    mesh.faces.offsets = Array::from_vector(std::move(face_offsets));
    mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces));
  }
  return with_flow(std::move(mesh));
}

/// Kuhn's six tetrahedra of a block with nodes in the middles of their edges.
std::vector<std::vector<int>> quadratic_tetrahedra() {
  constexpr int kuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  std::vector<std::vector<int>> out;
  const auto node = [](int a, int b) {  // the middle of two corners (bits x, y, z) among 3^3
    int id = 0;
    for (int axis = 0, step = 1; axis < 3; ++axis, step *= 3) id += step * ((a >> axis & 1) + (b >> axis & 1));
    return id;
  };
  for (const auto& t : kuhn) {
    std::vector<int> c;
    for (const int q : t) c.push_back(node(q, q));
    for (const auto& e : edges) c.push_back(node(t[e[0]], t[e[1]]));
    out.push_back(c);
  }
  return out;
}

DatasetPtr curvilinear(size_t i0, size_t i1, size_t n) {
  CurvilinearGrid g;
  g.dims = {i1 - i0 + 1, n + 1, n + 1};
  std::vector<float> xyz;
  for (size_t k = 0; k <= n; ++k)
    for (size_t j = 0; j <= n; ++j)
      for (size_t i = i0; i <= i1; ++i) {
        const Vec3 p = bent(Vec3(double(i), double(j), double(k)) * (2.0 / double(n)) - Vec3(1, 1, 1));
        xyz.insert(xyz.end(), {float(p.x), float(p.y), float(p.z)});
      }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  return with_flow(std::move(g));
}

/// 46^3 cells, of which the middle is refined into (2 x 23)^3.
DatasetPtr nested() {
  AmrGrid g;
  const long long n = 46, a = 11, b = 34;
  g.origin = {-1, -1, -1};
  g.levels.resize(2);
  const double h = 2.0 / double(n);
  g.levels[0].spacing = {h, h, h}, g.levels[0].ratio = {1, 1, 1};
  g.levels[1].spacing = {h / 2, h / 2, h / 2};
  g.levels[0].patches.push_back({{0, 0, 0}, {n - 1, n - 1, n - 1}, 0, 0});
  g.levels[1].patches.push_back(
      {{2 * a, 2 * a, 2 * a}, {2 * b + 1, 2 * b + 1, 2 * b + 1}, size_t(n * n * n), size_t((n + 1) * (n + 1) * (n + 1))});
  DatasetParts parts = with_flow(Mesh(g))->parts();
  std::vector<uint8_t> ghost(cell_count(parts.mesh));
  for (long long k = a; k <= b; ++k)
    for (long long j = a; j <= b; ++j)
      for (long long i = a; i <= b; ++i) ghost[size_t(i + n * (j + n * k))] = ghost_refined_cell;
  parts.cell_ghost = Array::from_vector(std::move(ghost));
  return make_dataset(std::move(parts));
}

std::vector<DatasetPtr> mesh_of(const std::string& kind) {
  if (kind == "tetrahedra") return {with_flow(tetrahedra(32)->mesh())};
  if (kind == "hexahedra") return {with_flow(hexahedra(58)->mesh())};
  if (kind == "curvilinear") return {curvilinear(0, 58, 58)};
  if (kind == "four blocks") return {curvilinear(0, 14, 56), curvilinear(14, 28, 56), curvilinear(28, 42, 56), curvilinear(42, 56, 56)};
  if (kind == "wedges") return {blocks(46, CellType::wedge, 1, {{0, 1, 3, 4, 5, 7}, {0, 3, 2, 4, 7, 6}})};
  if (kind == "pyramids")  // about the middle of the block
    return {
        blocks(32, CellType::pyramid, 2,
               {{0, 2, 8, 6, 13}, {20, 18, 24, 26, 13}, {2, 0, 18, 20, 13}, {6, 8, 26, 24, 13}, {0, 6, 24, 18, 13}, {8, 2, 20, 26, 13}})};
  if (kind == "polyhedra") return {blocks(58, CellType::polyhedron, 1, {{0, 1, 3, 2, 4, 5, 7, 6}})};
  if (kind == "quadratic tetrahedra") return {blocks(32, CellType::quadratic_tetra, 2, quadratic_tetrahedra())};
  if (kind == "quadratic hexahedra")
    return {blocks(58, CellType::quadratic_hexahedron, 2, {{0, 2, 8, 6, 18, 20, 26, 24, 1, 5, 7, 3, 19, 23, 25, 21, 9, 11, 17, 15}})};
  return {nested()};
}

/// How velocities were found before there was a walk.
struct ByLocator {
  const FlowField& field;
  LocatorCursor locator;
  explicit ByLocator(const FlowField& f) : field(f), locator(*f.locator()) {}
  int64_t cell = -1;
  double size = 1;
  bool operator()(Vec3 x, double, Vec3& v) {
    const int64_t c = locator.find_any(x);
    if (c < 0) return false;
    v = {};
    for (size_t k = 0; k < locator.ids().size(); ++k) v += field.at_point(size_t(locator.ids()[k])) * locator.weights()[k];
    if (c != cell) {
      cell = c;
      CellMap& map = locator.map();
      if (map.reader().cell() != size_t(c)) map.open(size_t(c));
      const Vec3 s = map.reader().box().size();
      size = std::cbrt(s.x * s.y * s.z);
    }
    return std::isfinite(v.x + v.y + v.z);
  }
  double cell_length() const { return size; }
  Vec3 snap(Vec3 x) { return x; }
};

template <class Flow>
double steps_of(Flow&& flow) {
  TraceOptions o;
  o.scheme = Scheme::rk4, o.max_steps = 300, o.closed = false;
  size_t steps = 0;
  for (int s = 0; s < 100; ++s) {
    TracedLines line;
    const double g = 1.22074408460575947536;
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
      const double q = 0.5 + (s + 1) * std::pow(g, -(a + 1));
      x[a] = 1.6 * (q - std::floor(q)) - 0.8;
    }
    Vec3 v;
    if (!flow(x, 0, v)) continue;
    line.points.push_back(x), line.velocity.push_back(v), line.time.push_back(0), line.arc.push_back(0);
    trace_line(flow, 0, 1, o, line);
    steps += line.points.size() - 1;
  }
  return double(steps);
}

}  // namespace

void add_walk_tasks(std::vector<Task>& t) {
  for (const char* kind : {"tetrahedra", "hexahedra", "curvilinear", "four blocks", "wedges", "pyramids", "polyhedra",
                           "quadratic tetrahedra", "quadratic hexahedra", "amr"})
    for (const bool walk : {true, false}) {
      if (!walk && std::string(kind) == "four blocks") continue;
      t.push_back({"walk", fmt::format("{} of 200k cells x 100 lines x <=300 steps", kind),
                   fmt::format("sightglass:{}", walk ? "walk" : "locator"), "steps", [=] {
                     auto parts = std::make_shared<Collection>();
                     for (const DatasetPtr& d : mesh_of(kind)) parts->parts.push_back({"", Data(d)});
                     Context context;
                     auto flows = std::make_shared<FlowParts>(Data(CollectionPtr(parts)), "u", "bench", context);
                     if (!walk) flows->fields().front().locator();
                     return [=] {
                       if (walk) return steps_of(PartsCursor(*flows));
                       return steps_of(ByLocator(flows->fields().front()));
                     };
                   }});
    }
}

}  // namespace sg::bench
