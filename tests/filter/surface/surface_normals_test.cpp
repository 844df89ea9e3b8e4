// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "base/parallel.h"
#include "filter/mesh/append.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/surface/feature_edges.h"
#include "filter/surface/normals.h"
#include "filter/surface/polygons.h"
#include "support/test.h"
#include "surface_shapes.h"

using namespace sg;
using namespace sg::test::shapes;

namespace {

Vec3 normal_of(const Dataset& d, size_t i) {
  const Field& n = d.fields().require("Normals", Association::point);
  return {n.array.get(i, 0), n.array.get(i, 1), n.array.get(i, 2)};
}

size_t count_kind(const Dataset& d, int kind) {
  const Field& f = d.fields().require("edge type", Association::cell);
  size_t n = 0;
  for (size_t i = 0; i < f.array.count(); ++i) n += f.array.get(i) == kind;
  return n;
}

}  // namespace

TEST_CASE("normals: of a sphere they point away from the centre, better with finer triangles") {
  Context ctx;
  double h[3], worst[3];
  for (int l = 2; l < 5; ++l) {
    const DatasetPtr d = normals(sphere(l).dataset(), {.feature_angle = 60}, ctx);
    CHECK(d->point_count() == sphere(l).xyz.size() / 3);
    const auto& m = *d->as<SurfaceMesh>();
    double w = 0;
    for (size_t i = 0; i < d->point_count(); ++i) w = std::max(w, length(normal_of(*d, i) - m.points.at(i)));
    h[l - 2] = std::pow(0.5, l), worst[l - 2] = w;
  }
  CHECK(test::observed_order(h, worst, 3) > 0.9);  // at the octahedron's corners the triangles stay uneven
}

TEST_CASE("normals: sharp edges double their points; the angle weights forget how a face is triangulated") {
  Context ctx;
  const DatasetPtr sharp = normals(box().dataset(), {}, ctx);
  CHECK(sharp->point_count() == 24);
  for (size_t i = 0; i < 24; ++i) {
    const Vec3 n = normal_of(*sharp, i);
    CHECK(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) == 1);
    CHECK(dot(n, sharp->as<SurfaceMesh>()->points.at(i) - Vec3(0.5, 0.5, 0.5)) > 0);
  }
  const DatasetPtr round = normals(surface::triangle_surface(box().dataset(), "test", ctx), {.feature_angle = 180}, ctx);
  CHECK(round->point_count() == 8);
  for (size_t i = 0; i < 8; ++i) {
    const Vec3 want = normalize(round->as<SurfaceMesh>()->points.at(i) - Vec3(0.5, 0.5, 0.5));
    CHECK(length(normal_of(*round, i) - want) < 1e-6);
  }
  // A cylinder: smooth round its side, sharp at its lids.
  CHECK(normals(cylinder(36, 1).dataset(), {}, ctx)->point_count() == 4 * 36);
}

TEST_CASE("normals: neighbours are made to agree, closed pieces to face outward") {
  Context ctx;
  Builder b = sphere(3);
  for (size_t t = 0; t < b.ids.size() / 3; t += 3) std::swap(b.ids[3 * t], b.ids[3 * t + 1]);
  const DatasetPtr d = normals(b.dataset(), {.feature_angle = 180}, ctx);
  for (size_t i = 0; i < d->point_count(); i += 7) CHECK(dot(normal_of(*d, i), d->as<SurfaceMesh>()->points.at(i)) > 0.9);
  Builder inside_out = sphere(2);
  for (size_t t = 0; t < inside_out.ids.size() / 3; ++t) std::swap(inside_out.ids[3 * t], inside_out.ids[3 * t + 1]);
  const DatasetPtr kept = normals(inside_out.dataset(), {.feature_angle = 180}, ctx);
  CHECK(dot(normal_of(*kept, 0), kept->as<SurfaceMesh>()->points.at(0)) < -0.9);
  const DatasetPtr out = normals(inside_out.dataset(), {.feature_angle = 180, .orient = Facing::outward}, ctx);
  CHECK(dot(normal_of(*out, 0), out->as<SurfaceMesh>()->points.at(0)) > 0.9);
  CHECK(test::meshes::measure(*out->as<SurfaceMesh>()).volume > 3);
  const DatasetPtr flipped = normals(sphere(2).dataset(), {.feature_angle = 180, .flip = true}, ctx);
  CHECK(dot(normal_of(*flipped, 0), flipped->as<SurfaceMesh>()->points.at(0)) < -0.9);
  // Two pieces at once: each is turned on its own.
  Builder far = sphere(1, 1, {5, 0, 0});
  for (size_t t = 0; t < far.ids.size() / 3; ++t) std::swap(far.ids[3 * t], far.ids[3 * t + 1]);
  const DatasetPtr two = append({Data(sphere(1).dataset()), Data(far.dataset())}, {}, ctx);
  const DatasetPtr turned = normals(two, {.feature_angle = 180, .orient = Facing::outward}, ctx);
  CHECK(test::meshes::measure(*turned->as<SurfaceMesh>()).volume ==
        doctest::Approx(2 * test::meshes::measure(sphere(1).mesh()).volume).epsilon(1e-9));
}

TEST_CASE("normals: a Moebius strip is named one-sided; degenerate polygons have no say; fields follow their points") {
  Context ctx;
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view text) { said += text; };
  Builder moebius;
  const int n = 12;
  for (int i = 0; i < n; ++i)
    for (int side : {-1, 1}) {
      const double u = 2 * pi * i / n, r = 1 + 0.3 * side * std::cos(u / 2);
      moebius.point({r * std::cos(u), r * std::sin(u), 0.3 * side * std::sin(u / 2)});
    }
  for (int64_t i = 0; i < n; ++i) {
    const int64_t j = (i + 1) % n, swap = j == 0;
    moebius.polygon({2 * i, 2 * j + swap, 2 * j + 1 - swap, 2 * i + 1});
  }
  (void)normals(moebius.dataset(), {}, ctx);
  CHECK(said.find("one-sided") != std::string::npos);
  Builder b = box();
  b.polygon({0, 0, 1});
  b.polygon({0, 1, 0});
  DatasetParts parts = b.dataset()->parts();
  parts.fields.add({"id", Association::point, Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5, 6, 7}), "", Role::none});
  const DatasetPtr d = normals(make_dataset(parts), {}, ctx);
  for (size_t i = 0; i < 8; ++i) CHECK(length(normal_of(*d, i)) == doctest::Approx(1));
  const Field& id = d->fields().require("id", Association::point);
  for (size_t i = 0; i < d->point_count(); ++i)
    CHECK(d->as<SurfaceMesh>()->points.at(i) == d->as<SurfaceMesh>()->points.at(size_t(id.array.get(i))));
  const DatasetPtr cells = normals(box().dataset(), {.cell_normals = true}, ctx);
  CHECK(cells->fields().require("Cell normals", Association::cell).array.get(0, 2) == -1);
}

TEST_CASE("normals: every mesh kind has them; clouds and lines are refused") {
  Context ctx;
  using namespace test::meshes;
  for (const DatasetPtr& d : {uniform_box(2, 2, 2), solid_box(CellType::tetra, 2), solid_box(CellType::polyhedron, 2),
                              solid_box(CellType::quadratic_hexahedron, 1)}) {
    const DatasetPtr n = normals(d, {}, ctx);
    for (size_t i = 0; i < n->point_count(); ++i) CHECK(length(normal_of(*n, i)) == doctest::Approx(1));
    CHECK(linear_error(*n, n->as<SurfaceMesh>()->points) < 1e-6);
  }
  CHECK(normal_of(*normals(uniform_box(2, 2, 0), {}, ctx), 0).z == doctest::Approx(1));
  SurfaceMesh lines;
  lines.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0}, 3);
  lines.lines = {Array::from_vector(std::vector<int32_t>{0, 1}), {}, 2};
  CHECK(test::error_of([&] { normals(make_dataset(Mesh(lines)), {}, ctx); }).find("no faces") != std::string::npos);
  SurfaceMesh strip;
  strip.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  strip.strips = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), {}, 4};
  const DatasetPtr n = normals(make_dataset(Mesh(strip)), {}, ctx);
  CHECK(n->cell_count() == 2);
  for (size_t i = 0; i < 4; ++i) CHECK(normal_of(*n, i).z == doctest::Approx(1));
}

TEST_CASE("normals: the same bytes for any number of threads") {
  Context ctx;
  const DatasetPtr s = sphere(5).dataset();
  set_thread_count(1);
  const DatasetPtr one = normals(s, {}, ctx);
  set_thread_count(8);
  CHECK(test::meshes::same_surface(*one, *normals(s, {}, ctx)));
  set_thread_count(0);
}

TEST_CASE("feature_edges: kinds of edges of a box, an open cylinder and a fin") {
  Context ctx;
  const DatasetPtr b = feature_edges(box().dataset(), {}, ctx);
  CHECK(b->cell_count() == 12);
  CHECK(count_kind(*b, edge_feature) == 12);
  CHECK(b->fields().require("angle", Association::cell).array.get(3) == doctest::Approx(90));
  CHECK(feature_edges(box().dataset(), {.angle = 91}, ctx)->cell_count() == 0);
  const DatasetPtr c = feature_edges(cylinder(24, 1, false).dataset(), {.manifold = true}, ctx);
  CHECK(count_kind(*c, edge_boundary) == 48);
  CHECK(count_kind(*c, edge_manifold) == 24);
  Builder fin = box();
  const int64_t p = fin.point({-1, 0, 0}), q = fin.point({-1, 1, 0});
  fin.polygon({0, 2, q, p});
  const DatasetPtr f = feature_edges(fin.dataset(), {}, ctx);
  CHECK(count_kind(*f, edge_non_manifold) == 1);
  CHECK(count_kind(*f, edge_boundary) == 3);
  CHECK(count_kind(*f, edge_feature) == 11);
  // Orientation does not matter.
  Builder turned = box();
  std::swap(turned.ids[0], turned.ids[2]);
  CHECK(count_kind(*feature_edges(turned.dataset(), {}, ctx), edge_feature) == 12);
  CHECK(feature_edges(test::meshes::solid_box(CellType::tetra, 3), {}, ctx)->cell_count() == 36);
  CHECK(feature_edges(sphere(3).dataset(), {}, ctx)->cell_count() == 0);
}

TEST_CASE("silhouette: a sphere has the great circle, from far and from near, smooth or along edges") {
  Context ctx;
  double h[4], error[4];
  for (int l = 2; l < 6; ++l) {
    const DatasetPtr d = silhouette(sphere(l).dataset(), {.direction = {1, 2, 3}}, ctx);
    const auto& m = *d->as<SurfaceMesh>();
    const CellsView lines = cells_view(m.lines);
    double sum = 0;
    for (size_t i = 0; i < lines.count; ++i) sum += length(m.points.at(size_t(lines.point(i, 0))) - m.points.at(size_t(lines.point(i, 1))));
    double off = 0;
    for (size_t i = 0; i < m.points.count(); ++i) off = std::max(off, std::abs(dot(m.points.at(i), normalize(Vec3(1, 2, 3)))));
    CHECK(off < 0.1 * std::pow(0.5, l - 2));
    DatasetParts exact = sphere(l).dataset()->parts();  // with the true normals the zero set lies in a plane
    exact.fields.add({"N", Association::point, Array::from_vector(sphere(l).xyz, 3), "", Role::normals});
    const DatasetPtr plane = silhouette(make_dataset(exact), {.direction = {1, 2, 3}}, ctx);
    for (size_t i = 0; i < plane->point_count(); ++i) CHECK(std::abs(dot(plane->as<SurfaceMesh>()->points.at(i), Vec3(1, 2, 3))) < 1e-6);
    h[l - 2] = std::pow(0.5, l), error[l - 2] = std::abs(sum - 2 * pi);
    CHECK(d->fields().require("edge type", Association::cell).array.get(0) == 4);
  }
  CHECK(test::observed_order(h, error, 4) > 1.8);
  const DatasetPtr near = silhouette(sphere(5).dataset(), {.from = Vec3{0, 0, 2}}, ctx);
  for (size_t i = 0; i < near->point_count(); i += 5) CHECK(near->as<SurfaceMesh>()->points.at(i).z == doctest::Approx(0.5).epsilon(0.01));
  const DatasetPtr edges = silhouette(sphere(5).dataset(), {.direction = {1, 2, 3}, .smooth = false}, ctx);
  CHECK(edges->cell_count() > 60);
  for (size_t i = 0; i < edges->point_count(); ++i)
    CHECK(std::abs(dot(edges->as<SurfaceMesh>()->points.at(i), normalize(Vec3(1, 2, 3)))) < 0.1);
  CHECK(test::error_of([&] { silhouette(sphere(1).dataset(), {.direction = {0, 0, 0}}, ctx); }).find("no length") != std::string::npos);
  const DatasetPtr open = silhouette(cylinder(36, 1, false).dataset(), {.direction = {0, 1, 0.1}, .boundary = true}, ctx);
  CHECK(count_kind(*open, 0) == 72);
  CHECK(count_kind(*open, 4) >= 2);
}
