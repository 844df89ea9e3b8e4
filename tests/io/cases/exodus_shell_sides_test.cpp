// SPDX-License-Identifier: Apache-2.0
// Side sets of shells (Exodus II manual, "Element block parameters"): sides 1 and 2 are the faces, seen from the front and from the back,
// the sides after them the edges in the order of the nodes.
#include "io/io_files.h"
#include "io/netcdf/netcdf_bytes.h"

using namespace sg;
using namespace sg::test;

namespace {

struct ShellFile {
  std::string type;
  std::vector<int32_t> nodes;  ///< of the one element, counted from 1
  std::vector<int32_t> sides;
  std::vector<double> x, y;
  int space = 3;
};

std::string shell_bytes(const ShellFile& o) {
  NcBytes f(2);
  const int n = f.dim("num_nodes", o.x.size()), one = f.dim("num_el_in_blk1", 1), per = f.dim("num_nod_per_el1", o.nodes.size()),
            sides = f.dim("num_side_ss1", o.sides.size());
  f.dim("num_el_blk", 1), f.dim("num_side_sets", 1), f.dim("num_dim", size_t(o.space));
  f.var<double>("coordx", {n}, o.x).var<double>("coordy", {n}, o.y);
  if (o.space == 3) f.var<double>("coordz", {n}, std::vector<double>(o.x.size(), 0));
  f.var<int32_t>("connect1", {one, per}, o.nodes).att("elem_type", o.type);
  f.var<int32_t>("elem_ss1", {sides}, std::vector<int32_t>(o.sides.size(), 1)).var<int32_t>("side_ss1", {sides}, o.sides);
  return f.bytes();
}

struct Side {
  CellType type;
  std::vector<std::pair<double, double>> points;
  Vec3 normal;
};

std::vector<Side> sides_of(const ShellFile& o) {
  const Data data = read_bytes("shell_sides.exo", shell_bytes(o));
  std::vector<Side> all;
  for_each_dataset(data, [&](const std::string& name, const DatasetPtr& d) {
    if (name.find("Side Sets") == std::string::npos) return;
    const auto& mesh = *d->as<UnstructuredMesh>();
    const CellsView cells = cells_view(mesh.cells);
    for (size_t c = 0; c < cells.count; ++c) {
      Side s{mesh.type(c), {}, {}};
      for (size_t k = 0; k < cells.size(c); ++k) {
        const Vec3 p = mesh.points.at(size_t(cells.point(c, k)));
        s.points.emplace_back(p.x, p.y);
      }
      const auto at = [&](size_t k) { return mesh.points.at(size_t(cells.point(c, k))); };
      if (cells.size(c) > 2) s.normal = normalize(cross(at(1) - at(0), at(2) - at(1)));
      all.push_back(std::move(s));
    }
  });
  return all;
}

using SidePoints = std::vector<std::pair<double, double>>;
bool same_points(SidePoints a, SidePoints b) {
  std::sort(a.begin(), a.end()), std::sort(b.begin(), b.end());
  return a == b;
}

const std::vector<double> quad_x{0, 1, 1, 0}, quad_y{0, 0, 1, 1}, tri_x{0, 1, 0}, tri_y{0, 0, 1};

}  // namespace

TEST_CASE("exodus sides of shells: SHELL4 has two faces and four edges") {
  for (const char* type : {"SHELL", "SHELL4", "QUAD4"}) {
    CAPTURE(type);
    const auto s = sides_of({type, {1, 2, 3, 4}, {1, 2, 3, 4, 5, 6}, quad_x, quad_y});
    REQUIRE(s.size() == 6);
    CHECK(s[0].type == CellType::quad);
    CHECK(s[0].points == SidePoints{{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    CHECK(s[0].normal == Vec3(0, 0, 1));
    CHECK(s[1].type == CellType::quad);
    CHECK(same_points(s[1].points, s[0].points));
    CHECK(s[1].normal == Vec3(0, 0, -1));
    const SidePoints edges[4] = {{{0, 0}, {1, 0}}, {{1, 0}, {1, 1}}, {{1, 1}, {0, 1}}, {{0, 1}, {0, 0}}};
    for (size_t e = 0; e < 4; ++e) {
      CHECK(s[2 + e].type == CellType::line);
      CHECK(s[2 + e].points == edges[e]);
    }
  }
}

TEST_CASE("exodus sides of shells: SHELL3 has two faces and three edges") {
  for (const char* type : {"SHELL3", "TRISHELL3", "TRI3", "triangle"}) {
    CAPTURE(type);
    const auto s = sides_of({type, {1, 2, 3}, {1, 2, 3, 4, 5}, tri_x, tri_y});
    REQUIRE(s.size() == 5);
    CHECK(s[0].type == CellType::triangle);
    CHECK(s[0].points == SidePoints{{0, 0}, {1, 0}, {0, 1}});
    CHECK(s[1].type == CellType::triangle);
    CHECK(s[1].normal == Vec3(0, 0, -1));
    const SidePoints edges[3] = {{{0, 0}, {1, 0}}, {{1, 0}, {0, 1}}, {{0, 1}, {0, 0}}};
    for (size_t e = 0; e < 3; ++e) CHECK(s[2 + e].points == edges[e]);
  }
}

TEST_CASE("exodus sides of shells: the nodes in the middle of edges belong to faces and edges") {
  // A square of side 2 with the middles of its edges, and its centre for SHELL9.
  const std::vector<double> x{0, 2, 2, 0, 1, 2, 1, 0, 1}, y{0, 0, 2, 2, 0, 1, 2, 1, 1};
  for (const size_t n : {size_t(8), size_t(9)}) {
    ShellFile o{"SHELL" + std::to_string(n), {}, {1, 2, 3, 6}, x, y};
    for (size_t k = 0; k < n; ++k) o.nodes.push_back(int32_t(k + 1));
    const auto s = sides_of(o);
    REQUIRE(s.size() == 4);
    for (size_t f = 0; f < 2; ++f) {
      CHECK(s[f].type == (n == 8 ? CellType::quadratic_quad : CellType::biquadratic_quad));
      REQUIRE(s[f].points.size() == n);
      // Each middle lies between its corners, on the back as well.
      for (size_t k = 0; k < 4; ++k) {
        const auto a = s[f].points[k], b = s[f].points[(k + 1) % 4], middle = s[f].points[4 + k];
        CHECK(middle == std::pair((a.first + b.first) / 2, (a.second + b.second) / 2));
      }
    }
    CHECK(s[2].type == CellType::quadratic_edge);
    CHECK(s[2].points == SidePoints{{0, 0}, {2, 0}, {1, 0}});
    CHECK(s[3].points == SidePoints{{0, 2}, {0, 0}, {0, 1}});
  }
  const auto s = sides_of({"SHELL6", {1, 2, 3, 4, 5, 6}, {2, 4}, {0, 2, 0, 1, 1, 0}, {0, 0, 2, 0, 1, 1}});
  REQUIRE(s.size() == 2);
  CHECK(s[0].type == CellType::quadratic_triangle);
  CHECK(s[1].points == SidePoints{{2, 0}, {0, 2}, {1, 1}});
}

TEST_CASE("exodus sides of shells: a side beyond the last is refused, and in the plane sides are edges") {
  CHECK(contains(refusal("shell_sides.exo", shell_bytes({"SHELL4", {1, 2, 3, 4}, {7}, quad_x, quad_y})), "1..6"));
  CHECK(contains(refusal("shell_sides.exo", shell_bytes({"SHELL3", {1, 2, 3}, {6}, tri_x, tri_y})), "1..5"));
  const auto s = sides_of({"QUAD4", {1, 2, 3, 4}, {1, 4}, quad_x, quad_y, 2});
  REQUIRE(s.size() == 2);
  CHECK(s[0].points == SidePoints{{0, 0}, {1, 0}});
  CHECK(s[1].points == SidePoints{{0, 1}, {0, 0}});
  CHECK(contains(refusal("shell_sides.exo", shell_bytes({"QUAD4", {1, 2, 3, 4}, {5}, quad_x, quad_y, 2})), "1..4"));
}
