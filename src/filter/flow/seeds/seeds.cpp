// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/seeds/seeds.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/random.h"
#include "data/cells/mesh_dimension.h"
#include "data/cells/point_positions.h"
#include "data/lattice.h"
#include "data/memory/memory_budget.h"
#include "filter/flow/seeds/random_places.h"

namespace sg {

void describe(Schema& s, SeedParams& p) {
  s("seeds", p.seeds,
    "Where lines begin: random points in the mesh, a list of points, a line, a plane, a sphere (its surface), a ball, a grid in a box, the "
    "points of the second input (mesh), or the pixels of a picture as second input laid over the plane, bright ones more often; default: "
    "whatever the other parameters imply.");
  s("points", p.points, "Points as x,y,z,x,y,z,...").unit("length");
  s("from", p.from, "First point of the line.").unit("length");
  s("to", p.to, "Last point of the line.").unit("length");
  s("center", p.center, "Centre of the plane, sphere, ball or box; default: that of the mesh.").unit("length");
  s("normal", p.normal, "Normal of the plane; default: the mesh's shortest axis.");
  s("radius", p.radius, "Radius of the sphere or ball; default: a tenth of the mesh's diagonal.").unit("length").positive();
  s("size", p.size, "Edge lengths of the plane (two) or box (three); default: those of the mesh.").unit("length").at_least(0);
  s("counts", p.counts, "Seeds along the edges of the plane (two) or box (three); default: spread evenly from count.").range(1, 1e6);
  s("count", p.count,
    "Number of seeds (a mesh gives all its points); 0: 200, on a line 40, at random on surfaces 60 (random streamlines: fewer where they "
    "would crowd).")
      .range(0, 1e9);
  s("random_seed", p.random_seed, "Random seed: another number gives other points.");
}

SeedKind seed_kind(const SeedParams& p, bool mesh) {
  if (p.seeds) return *p.seeds;
  if (mesh) return SeedKind::mesh;
  if (!p.points.empty()) return SeedKind::points;
  if (p.from || p.to) return SeedKind::line;
  if (p.radius) return SeedKind::sphere;
  if (p.normal || p.size.size() == 2 || p.counts.size() == 2) return SeedKind::plane;
  if (p.size.size() == 3 || p.counts.size() == 3) return SeedKind::grid;
  return SeedKind::random;
}

int64_t seed_count(const SeedParams& p, SeedKind kind, int dimension) {
  if (p.count > 0) return p.count;
  return kind == SeedKind::line ? 40 : kind == SeedKind::random && dimension < 3 ? 60 : 200;
}

std::vector<Vec3> points_of(const Dataset& mesh) {
  const Array a = point_positions(mesh.mesh());
  const View<double> v = a.view<double>();
  std::vector<Vec3> out(v.count);
  for (size_t i = 0; i < v.count; ++i) out[i] = {v(i, 0), v(i, 1), v(i, 2)};
  return out;
}

DatasetPtr seed_mesh_of(const std::vector<Data>& inputs, std::string_view who) {
  if (inputs.size() < 2) return nullptr;
  if (std::holds_alternative<TablePtr>(inputs[1]))
    fail_usage("the second input, which holds the seeds, is a table", std::string(who), "turn its rows into points first: table_to_points");
  return single_dataset(inputs[1], who);
}

namespace {

// Even numbers along the edges of a box whose product is about `count`; edges without length take one.
std::array<size_t, 3> even_counts(Vec3 size, double count) {
  const double largest = std::max({size.x, size.y, size.z});
  int axes = 0;
  double product = 1;
  for (int a = 0; a < 3; ++a)
    if (size[a] > 1e-9 * largest) ++axes, product *= size[a];
  std::array<size_t, 3> n{1, 1, 1};
  if (axes == 0) return n;
  const double h = std::pow(product / count, 1.0 / axes);
  for (int a = 0; a < 3; ++a)
    if (size[a] > 1e-9 * largest) n[size_t(a)] = size_t(std::clamp(std::nearbyint(size[a] / h), 1.0, std::max(1.0, count)));
  return n;
}

// n places in [-1/2, 1/2]: the ends for two and more.
double along(size_t i, size_t n) { return n < 2 ? 0.0 : double(i) / double(n - 1) - 0.5; }

std::vector<Vec3> listed(const SeedParams& p) {
  if (p.points.empty() || p.points.size() % 3 != 0)
    fail_usage(fmt::format("{} numbers do not make points", p.points.size()), "seeds", "give three numbers per point: points=x,y,z,x,y,z");
  std::vector<Vec3> out;
  for (size_t i = 0; i < p.points.size(); i += 3) out.emplace_back(p.points[i], p.points[i + 1], p.points[i + 2]);
  return out;
}

std::vector<Vec3> on_line(const SeedParams& p) {
  if (!p.from || !p.to) fail_usage("a line of seeds needs two ends", "seeds", p.from ? "add to=x,y,z" : "add from=x,y,z");
  std::vector<Vec3> out;
  for (int64_t i = 0; i < p.count; ++i)
    out.push_back(p.count < 2 ? lerp(*p.from, *p.to, 0.5) : lerp(*p.from, *p.to, double(i) / double(p.count - 1)));
  return out;
}

// A rectangle of seeds: middle, unit axes, edges.
struct Rectangle {
  Vec3 center, u, v;
  double a = 0, b = 0;
};

Rectangle rectangle(const SeedParams& p, const Box3& box) {
  const Vec3 extent = box.size();
  Vec3 normal = p.normal.value_or(Vec3(0, 0, 0));
  if (!p.normal) normal[extent.x <= extent.y && extent.x <= extent.z ? 0 : extent.y <= extent.z ? 1 : 2] = 1;
  const double l = length(normal);
  if (!(l > 0) || !std::isfinite(l)) fail_usage("the plane has no direction", "seeds normal", "give normal=x,y,z other than 0,0,0");
  normal = normal / l;
  if (!p.size.empty() && p.size.size() != 2)
    fail_usage(fmt::format("a plane has 2 edges, but got {}", p.size.size()), "seeds size", "size=a,b");
  if (!p.counts.empty() && p.counts.size() != 2)
    fail_usage(fmt::format("a plane has 2 edges, but got {} counts", p.counts.size()), "seeds counts", "counts=m,n");
  // The axes of the plane follow those of space: u has no part along the axis that is nearest to the normal's next.
  const Vec3 pick = std::abs(normal.x) >= std::abs(normal.y) && std::abs(normal.x) >= std::abs(normal.z) ? Vec3(0, 1, 0)
                    : std::abs(normal.y) >= std::abs(normal.z)                                           ? Vec3(0, 0, 1)
                                                                                                         : Vec3(1, 0, 0);
  const Vec3 u = normalize(pick - normal * dot(pick, normal)), v = cross(normal, u);
  const auto reach = [&](Vec3 d) { return std::abs(d.x) * extent.x + std::abs(d.y) * extent.y + std::abs(d.z) * extent.z; };
  return {p.center.value_or(box.center()), u, v, p.size.empty() ? reach(u) : p.size[0], p.size.empty() ? reach(v) : p.size[1]};
}

std::vector<Vec3> on_plane(const SeedParams& p, const Box3& box) {
  const Rectangle r = rectangle(p, box);
  std::array<size_t, 3> n = even_counts({r.a, r.b, 0}, double(p.count));
  if (!p.counts.empty()) n = {size_t(p.counts[0]), size_t(p.counts[1]), 1};
  std::vector<Vec3> out;
  for (size_t j = 0; j < n[1]; ++j)
    for (size_t i = 0; i < n[0]; ++i) out.push_back(r.center + r.u * (r.a * along(i, n[0])) + r.v * (r.b * along(j, n[1])));
  return out;
}

// Pixels of a picture that is laid over the plane, bright ones more often: about as many as requested.
std::vector<Vec3> of_pixels(const SeedParams& p, const Box3& box, const DatasetPtr& picture) {
  if (!picture || !is_lattice(picture->mesh()) || lattice_dims(picture->mesh())[2] != 1)
    fail_usage("seeding from pixels needs a picture as second input", "seeds",
               "give a PNG file, or any grid of one layer, as second input");
  const Field* f = picture->fields().with_role(Role::scalars);
  for (const Field& g : picture->fields())
    if (!f && g.association == Association::point) f = &g;
  if (!f || f->association != Association::point) fail_usage("the picture has no point field", "seeds");
  const Rectangle r = rectangle(p, box);
  const auto dims = lattice_dims(picture->mesh());
  const int channels = std::min(f->components(), 3);  // without the alpha channel
  std::vector<double> bright(dims[0] * dims[1]);
  double sum = 0;
  for (size_t i = 0; i < bright.size(); ++i) {
    double total = 0;
    for (int c = 0; c < channels; ++c) total += f->array.get(i, c);
    bright[i] = total > 0 ? total : 0;  // NaN too
    sum += bright[i];
  }
  std::vector<Vec3> out;
  if (!(sum > 0) || !std::isfinite(sum)) fail_usage("the picture is black: no pixel is bright enough for a seed", "seeds");
  for (size_t i = 0; i < bright.size(); ++i)
    if (random_unit(uint64_t(p.random_seed), i) < bright[i] / sum * double(p.count))
      out.push_back(r.center + r.u * (r.a * along(i % dims[0], dims[0])) + r.v * (r.b * along(i / dims[0], dims[1])));
  return out;
}

std::vector<Vec3> in_sphere(const SeedParams& p, const Box3& box, bool ball) {
  const Vec3 center = p.center.value_or(box.center());
  const double r = p.radius.value_or(box.diagonal() / 10);
  std::vector<Vec3> out;
  const uint64_t key = uint64_t(p.random_seed);
  for (int64_t i = 0; i < p.count; ++i) {
    // On the sphere evenly by a spiral with the golden angle; in the ball at random.
    const double z = ball ? 2 * random_unit(key, uint64_t(3 * i)) - 1 : 1 - (2 * double(i) + 1) / double(p.count);
    const double turn = ball ? 2 * M_PI * random_unit(key, uint64_t(3 * i + 1)) : M_PI * (3 - std::sqrt(5.0)) * double(i);
    const double s = std::sqrt(std::max(0.0, 1 - z * z)), l = ball ? r * std::cbrt(random_unit(key, uint64_t(3 * i + 2))) : r;
    out.push_back(center + Vec3(s * std::cos(turn), s * std::sin(turn), z) * l);
  }
  return out;
}

std::vector<Vec3> in_grid(const SeedParams& p, const Box3& box) {
  if (!p.size.empty() && p.size.size() != 3)
    fail_usage(fmt::format("a box has 3 edges, but got {}", p.size.size()), "seeds size", "size=a,b,c");
  if (!p.counts.empty() && p.counts.size() != 3)
    fail_usage(fmt::format("a box has 3 edges, but got {} counts", p.counts.size()), "seeds counts", "counts=l,m,n");
  const Vec3 size = p.size.empty() ? box.size() : Vec3(p.size[0], p.size[1], p.size[2]);
  std::array<size_t, 3> n = even_counts(size, double(p.count));
  if (!p.counts.empty()) n = {size_t(p.counts[0]), size_t(p.counts[1]), size_t(p.counts[2])};
  const Vec3 center = p.center.value_or(box.center());
  // Inside by half a gap: seeds on the border of the mesh would leave it at once.
  const auto place = [](size_t i, size_t m) { return (double(i) + 0.5) / double(m) - 0.5; };
  std::vector<Vec3> out;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) out.push_back(center + size * Vec3(place(i, n[0]), place(j, n[1]), place(k, n[2])));
  return out;
}

std::vector<Vec3> of_mesh(const DatasetPtr& mesh) {
  if (!mesh) fail_usage("there is no second input to take seeds from", "seeds", "give a mesh as second input, or use seeds=random");
  std::vector<Vec3> all = points_of(*mesh);
  if (all.empty()) fail_usage("the second input has no points", "seeds");
  return all;
}

}  // namespace

std::vector<Vec3> make_seeds(const SeedParams& given, const std::vector<DatasetPtr>& parts, const DatasetPtr& mesh, const SeedPlace& accept,
                             Context& context) {
  SeedParams p = given;
  const SeedKind kind = seed_kind(p, bool(mesh));
  int dimension = 0;
  for (const DatasetPtr& d : parts) dimension = std::max(dimension, mesh_dimension(*d));
  p.count = seed_count(p, kind, dimension);
  Box3 box;
  for (const DatasetPtr& d : parts) box.add(d->bounds());
  if (kind == SeedKind::mesh) return of_mesh(mesh);
  if (kind == SeedKind::points) return listed(p);
  double count = double(p.count);
  if (!p.counts.empty() && (kind == SeedKind::plane || kind == SeedKind::grid))
    count = std::accumulate(p.counts.begin(), p.counts.end(), 1.0, [](double a, int64_t b) { return a * double(b); });
  constexpr double bytes_a_seed = 100;  // its place, where that lies in the mesh, the point that is made of it
  need_memory(count * bytes_a_seed, fmt::format("{:.0f} seeds", count), "seeds", "use fewer: count, counts");
  if (kind == SeedKind::line) return on_line(p);
  if (kind == SeedKind::plane) return on_plane(p, box);
  if (kind == SeedKind::pixels) return of_pixels(p, box, mesh);
  if (kind == SeedKind::sphere || kind == SeedKind::ball) return in_sphere(p, box, kind == SeedKind::ball);
  if (kind == SeedKind::grid) return in_grid(p, box);
  std::vector<Vec3> out = random_places(parts, size_t(p.count), uint64_t(p.random_seed), accept, context);
  if (!p.seeds)
    context.info(
        fmt::format("seeds: {} random points in the mesh; seeds=, points=, from= and to=, radius=, normal= choose others", out.size()));
  return out;
}

Data seeds(const std::vector<Data>& inputs, const SeedsParams& p, Context& context) {
  std::vector<DatasetPtr> parts;
  for_each_dataset(inputs[0], [&](const std::string&, const DatasetPtr& d) { parts.push_back(d); });
  if (parts.empty()) fail_usage("needs a mesh but got a table", "seeds", "turn its rows into points first: table_to_points");
  const std::vector<Vec3> at = make_seeds(p.seeds, parts, seed_mesh_of(inputs, "seeds"), {}, context);
  double* xyz = nullptr;
  int64_t* number = nullptr;
  PointCloud cloud;
  cloud.points.xyz = Array::make<double>(at.size(), 3, &xyz);
  FieldSet fields;
  fields.add({"seed", Association::point, Array::make<int64_t>(at.size(), 1, &number), "", Role::none});
  for (size_t i = 0; i < at.size(); ++i) {
    for (int a = 0; a < 3; ++a) xyz[3 * i + size_t(a)] = at[i][a];
    number[i] = int64_t(i);
  }
  return make_dataset(std::move(cloud), std::move(fields));
}

}  // namespace sg
