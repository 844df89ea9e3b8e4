// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/mass_properties.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/surface.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

struct Sums {
  double area = 0, volume = 0;
  Vec3 area_moment, moment;  // about the reference point
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, xz = 0;

  void add(const Sums& o) {
    area += o.area, volume += o.volume, area_moment += o.area_moment, moment += o.moment;
    xx += o.xx, yy += o.yy, zz += o.zz, xy += o.xy, yz += o.yz, xz += o.xz;
  }
  // The triangle, and the tetrahedron from the reference point to it.
  void add(Vec3 a, Vec3 b, Vec3 c, double sign) {
    const double s = length(cross(b - a, c - a)) / 2, v = sign * dot(a, cross(b, c)) / 6;
    const Vec3 sum = a + b + c;
    area += s, area_moment += sum * (s / 3);
    volume += v, moment += sum * (v / 4);
    auto second = [&](int i, int j) { return v / 20 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]); };
    xx += second(0, 0), yy += second(1, 1), zz += second(2, 2), xy += second(0, 1), yz += second(1, 2), xz += second(0, 2);
  }
};

struct Row {
  bool closed = false;
  double numbers[16] = {};
};

// Only solid cells: then the skin is closed, also where the faces of AMR levels meet without common edges.
bool only_solids(const DatasetPtr& in) {
  if (in->as<AmrGrid>()) return in->as<AmrGrid>()->dimension == 3;
  const auto* m = in->as<UnstructuredMesh>();
  if (!m)
    return !in->as<SurfaceMesh>() && CellReader(in).count() > 0 && [&] {
      CellReader r(in);
      r.open(0);
      return r.dimension() == 3;
    }();
  for (size_t c = 0; c < m->cells.size(); ++c)
    if (cell_type_info(m->type(c)).dimension != 3) return false;
  return m->cells.size() > 0;
}

Row measure(const std::string& name, const DatasetPtr& in, const MassPropertiesParams& p, Context& ctx) {
  DatasetPtr s = surface::triangle_surface(in, "mass_properties", ctx);
  DatasetParts bare;  // fields are not needed
  bare.mesh = s->mesh();
  s = merge_points(make_dataset(std::move(bare)), {}, ctx);
  const SurfaceMesh& mesh = *s->as<SurfaceMesh>();
  const CellsView triangles = cells_view(mesh.polygons);
  const std::vector<Vec3> at = surface::positions(mesh.points);
  const surface::Edges edges = surface::edges_of_polygons(triangles, at.size());
  const surface::Orientation o = surface::orientation(triangles, edges, at, false);
  // Closed: each edge is run along as often in one direction as in the other.
  size_t open = 0;
  for (size_t e = 0; e < edges.size(); ++e) {
    int balance = 0;
    for (const auto& u : edges.of(e)) balance += u.forward != bool(o.flip[u.polygon]) ? 1 : -1;
    open += balance != 0;
  }
  const bool solid = only_solids(in);
  Row row;
  row.closed = triangles.count > 0 && (open == 0 || solid);
  const Vec3 reference = s->bounds().empty() ? Vec3() : s->bounds().center();
  Sums sums = parallel_reduce(
      triangles.count, 1 << 12, Sums(),
      [&](size_t begin, size_t end) {
        Sums part;
        for (size_t t = begin; t < end; ++t) {
          auto corner = [&](size_t k) { return at[size_t(triangles.point(t, k))] - reference; };
          part.add(corner(0), corner(1), corner(2), !solid && o.flip[t] ? -1 : 1);
        }
        return part;
      },
      [](Sums a, const Sums& b) {
        a.add(b);
        return a;
      },
      &ctx);
  const std::string whose = name.empty() ? "the surface" : fmt::format("the surface of '{}'", name);
  if (!row.closed && triangles.count > 0) {
    const std::string what = o.one_sided ? fmt::format("{} has no inside (one-sided)", whose)
                                         : fmt::format("{} is open: {} edges belong to one polygon only", whose, open);
    if (p.must_be_closed) fail_data(what, "mass_properties", "close it first with cap");
    ctx.warn("mass_properties: " + what + "; no volume (cap closes holes)");
  }
  if (triangles.count == 0) ctx.info(fmt::format("mass_properties: {} has no faces", whose));
  const double sign = sums.volume < 0 ? -1 : 1, nan = std::nan(""), v = row.closed ? sums.volume : nan, m = sign * p.density;
  const Vec3 a = sums.area > 0 ? sums.area_moment / sums.area + reference : Vec3(nan, nan, nan), c = sums.moment / v;
  const double xx = sums.xx - v * c.x * c.x, yy = sums.yy - v * c.y * c.y, zz = sums.zz - v * c.z * c.z;
  const double out[16] = {sums.area,
                          a.x,
                          a.y,
                          a.z,
                          sign * v,
                          c.x + reference.x,
                          c.y + reference.y,
                          c.z + reference.z,
                          m * v,
                          m * (yy + zz),
                          m * (xx + zz),
                          m * (xx + yy),
                          -m * (sums.xy - v * c.x * c.y),
                          -m * (sums.yz - v * c.y * c.z),
                          -m * (sums.xz - v * c.x * c.z),
                          0};
  std::copy(out, out + 16, row.numbers);
  return row;
}

}  // namespace

TablePtr mass_properties(const Data& in, const MassPropertiesParams& p, Context& ctx) {
  std::vector<std::string> names;
  std::vector<int32_t> part, closed;
  std::vector<double> columns[15];
  for_each_dataset(in, [&](const std::string& name, const DatasetPtr& d) {
    const Row r = measure(name, d, p, ctx);
    part.push_back(int32_t(names.size()));
    names.push_back(name.empty() ? "all" : name);
    closed.push_back(r.closed);
    for (size_t k = 0; k < 15; ++k) columns[k].push_back(r.numbers[k]);
  });
  if (part.empty()) fail_usage("there is no mesh to measure", "mass_properties");
  auto t = std::make_shared<Table>();
  auto add = [&](const char* name, Array a, std::vector<std::string> words = {}) {
    t->columns.push_back({name, Association::whole, std::move(a), "", Role::none});
    t->labels.push_back(std::move(words));
  };
  add("part", Array::from_vector(std::move(part)), names);
  add("closed", Array::from_vector(std::move(closed)));
  constexpr const char* titles[15] = {"area", "area_x", "area_y", "area_z", "volume", "x",  "y", "z",
                                      "mass", "xx",     "yy",     "zz",     "xy",     "yz", "xz"};
  for (size_t k = 0; k < 15; ++k) add(titles[k], Array::from_vector(std::move(columns[k])));
  return t;
}

}  // namespace sg
