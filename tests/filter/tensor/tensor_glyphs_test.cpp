// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/glyphs/tensor_glyphs.h"

#include "filter/mesh/mesh_meshes.h"
#include "filter/tensor/glyphs/glyph_shapes.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

const SymTensor oblique = rotated(diagonal(4, 2, 1), random_rotation(21));

TensorGlyphsParams of_shape(TensorShape shape, int resolution = 10) {
  TensorGlyphsParams p;
  p.shape = shape, p.resolution = resolution, p.factor = 1, p.min_ratio = 0.01;
  return p;
}
DatasetPtr glyph(const SymTensor& d, const TensorGlyphsParams& p) {
  Context context;
  return tensor_glyphs(tensor_points({d}), p, context);
}
double volume(const DatasetPtr& d) { return meshes::measure(*d->as<SurfaceMesh>()).volume; }
Vec3 vec(const DatasetPtr& d, const char* field, size_t i) {
  const Array& a = d->fields().require(field).array;
  return {a.get(i, 0), a.get(i, 1), a.get(i, 2)};
}

// Largest angle between the given normals and the mean normals of the faces at the vertices, which meet them as the mesh gets finer.
double normal_error(const DatasetPtr& d) {
  const auto& m = *d->as<SurfaceMesh>();
  const CellsView c = cells_view(m.polygons);
  std::vector<Vec3> mean(m.points.count());
  for (size_t f = 0; f < c.count; ++f)
    for (size_t k = 0; k < c.size(f); ++k) {
      const size_t n = c.size(f);
      const Vec3 p = m.points.at(size_t(c.point(f, k))), q = m.points.at(size_t(c.point(f, (k + 1) % n))),
                 r = m.points.at(size_t(c.point(f, (k + n - 1) % n)));
      mean[size_t(c.point(f, k))] += cross(q - p, r - p);
    }
  double worst = 0;
  for (size_t i = 0; i < mean.size(); ++i) worst = std::max(worst, 1 - dot(normalize(mean[i]), vec(d, "Normals", i)));
  return std::acos(1 - worst);
}

}  // namespace

TEST_CASE("tensor_glyphs: an ellipsoid has the eigenvalues as half axes, exact normals, a closed surface and its volume") {
  const DatasetPtr g = glyph(oblique, of_shape(TensorShape::ellipsoid));
  const auto& m = *g->as<SurfaceMesh>();
  const Eigen3 e = eigen_of(oblique);
  for (size_t i = 0; i < m.points.count(); ++i) {
    const Vec3 p = m.points.at(i);
    Vec3 gradient;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double x = dot(p, e.vector[k]) / e.value[k];
      sum += x * x, gradient += e.vector[k] * (x / e.value[k]);
    }
    CHECK(sum == doctest::Approx(1).epsilon(1e-5));
    CHECK(length(vec(g, "Normals", i) - normalize(gradient)) < 1e-5);
  }
  CHECK(meshes::measure(m).closed);
  double h[4], off[4];
  for (int i = 0; i < 4; ++i) {
    const int n = 8 << i;
    h[i] = 1.0 / n, off[i] = std::abs(volume(glyph(oblique, of_shape(TensorShape::ellipsoid, n))) - 4.0 / 3 * M_PI * 8);
  }
  CHECK(observed_order(h, off, 4) == doctest::Approx(2).epsilon(0.05));
}

TEST_CASE("tensor_glyphs: cuboids and cylinders have their volumes; a cylinder lies along what differs most") {
  CHECK(volume(glyph(oblique, of_shape(TensorShape::cuboid))) == doctest::Approx(8 * 8).epsilon(1e-5));
  const double m = 2 * 40, polygon = m / 2 * std::sin(2 * M_PI / m);
  CHECK(volume(glyph(oblique, of_shape(TensorShape::cylinder, 40))) == doctest::Approx(polygon * 2 * 8).epsilon(1e-5));
  for (const auto& [d, axis] : {std::pair(diagonal(5, 1, 1), 0), std::pair(diagonal(5, 5, 1), 2)}) {
    const DatasetPtr c = glyph(d, of_shape(TensorShape::cylinder));
    int lids = 0;
    for (size_t i = 0; i < c->point_count(); ++i) lids += std::abs(vec(c, "Normals", i)[axis]) == 1;
    CHECK(lids == int(c->point_count() / 2));
  }
}

TEST_CASE("tensor_glyphs: superquadrics are ellipsoids for gamma 0, balls where all is equal, sharp where it is not") {
  TensorGlyphsParams p = of_shape(TensorShape::superquadric, 12);
  p.gamma = 0;
  const DatasetPtr round = glyph(oblique, p), ellipsoid = glyph(oblique, of_shape(TensorShape::ellipsoid, 12));
  CHECK(equal_bytes(round->as<SurfaceMesh>()->points.xyz, ellipsoid->as<SurfaceMesh>()->points.xyz));
  p.gamma = 3;
  const DatasetPtr ball = glyph(diagonal(2, 2, 2), p);
  for (size_t i = 0; i < ball->point_count(); ++i) CHECK(length(ball->as<SurfaceMesh>()->points.at(i)) == doctest::Approx(2));
  p.resolution = 100;
  // Line-like: round across the first axis (a cylinder), flat lids; disc-like: round about the third. In between a box.
  const double line = volume(glyph(diagonal(8, 1, 1), p)) / 8, disc = volume(glyph(diagonal(8, 8, 1), p)) / 64,
               box = volume(glyph(diagonal(6, 3, 0.1), p)) / 1.8;
  CHECK(line == doctest::Approx(2 * M_PI).epsilon(0.03));
  CHECK(disc == doctest::Approx(2 * M_PI).epsilon(0.06));
  CHECK(box > 2 * M_PI);
  CHECK(box < 8);
  p.resolution = 200;
  CHECK(normal_error(glyph(diagonal(3, 2.5, 2), p)) < 0.05);
  CHECK(meshes::measure(*glyph(oblique, p)->as<SurfaceMesh>()).closed);
}

TEST_CASE("tensor_glyphs: Reynolds lobes have radius |n.s.n| and its sign, HWY the shear stress; normals fit the surfaces") {
  const SymTensor s = rotated(diagonal(3, -1, -2), random_rotation(2));
  const DatasetPtr r = glyph(s, of_shape(TensorShape::reynolds, 20)), h = glyph(s, of_shape(TensorShape::hwy, 20));
  const Array &relative = r->fields().require("relative normal stress").array, &sign = r->fields().require("sign").array;
  size_t positive = 0;
  for (size_t i = 0; i < r->point_count(); ++i) {
    const Vec3 p = r->as<SurfaceMesh>()->points.at(i);
    if (length(p) > 0.05) {
      const double nsn = s.along(normalize(p));
      CHECK(length(p) == doctest::Approx(std::abs(nsn)).epsilon(1e-4));
      CHECK(relative.get(i) == doctest::Approx(nsn / 3).epsilon(1e-3));
      CHECK(sign.get(i) == (nsn > 0 ? 1 : -1));
      positive += nsn > 0;
    }
    const Vec3 q = h->as<SurfaceMesh>()->points.at(i);
    if (length(q) > 0.05) {
      const Vec3 n = normalize(q);
      CHECK(length(q) == doctest::Approx(length(s * n - n * s.along(n))).epsilon(1e-4));
    }
  }
  CHECK(positive > 100);
  // Away from where lobes meet in a point.
  CHECK(normal_error(glyph(rotated(diagonal(3, 2, 1), random_rotation(2)), of_shape(TensorShape::reynolds, 100))) < 0.02);
}

TEST_CASE("tensor_glyphs: strides, counts, cells, masks and what gets none") {
  Listener l;
  const DatasetPtr grid =
      tensor_grid({21, 21, 21}, {0, 0, 0}, {2, 2, 2}, [](Vec3 p) { return p.x > 1.95 ? SymTensor{} : diagonal(3, 2, 1); });
  TensorGlyphsParams p;
  p.resolution = 4, p.stride = 10;
  const size_t nv = glyph(oblique, of_shape(TensorShape::superquadric, 4))->point_count();
  CHECK(tensor_glyphs(grid, p, l.context)->point_count() == 18 * nv);  // 27 less a face of zeros
  CHECK(l.notes.find("tensors get no glyph") != std::string::npos);
  p.stride = 0, p.count = 100;
  const DatasetPtr few = tensor_glyphs(grid, p, l.context);
  CHECK(few->point_count() <= 100 * nv);
  CHECK(few->point_count() > 50 * nv);
  CHECK(l.notes.find("stride 5 along each axis") != std::string::npos);
  // The longest axis is the distance.
  CHECK(few->fields().require("eigenvalue 1").array.get(0) == 3);
  p.scale = TensorScale::eigenvalues;
  const DatasetPtr scaled = tensor_glyphs(grid, p, l.context);
  const Box3 first = [&] {
    Box3 b;
    for (size_t i = 0; i < nv; ++i) b.add(scaled->as<SurfaceMesh>()->points.at(i));
    return b;
  }();
  CHECK(first.size().x == doctest::Approx(0.5 * p.size).epsilon(1e-5));
  // Unstructured: evenly thinned; cells: at their middles.
  const DatasetPtr tets = solid_mesh("tetra", 6, 1, [](Vec3) { return 0.0; });
  const DatasetPtr with = with_tensors(
      tets, [](Vec3 q) { return diagonal(2 + q.x, 1, 1); }, places(tets->as<UnstructuredMesh>()->points.xyz));
  p.count = 40;
  const DatasetPtr thin = tensor_glyphs(with, p, l.context);
  CHECK(thin->point_count() <= 40 * nv);
  CHECK(thin->point_count() >= 15 * nv);
  CHECK(thin->bounds().diagonal() > 0.7 * with->bounds().diagonal());
  DatasetParts parts = with->parts();
  parts.fields = {};
  parts.fields.add(tensor_field(std::vector<SymTensor>(with->cell_count(), diagonal(1, 2, 3)), Association::cell));
  std::vector<int32_t> mask(with->cell_count(), 0);
  mask[7] = 1;
  parts.fields.add({"mask", Association::cell, Array::from_vector(mask), "", Role::labels});
  p.mask = {"mask"};
  const DatasetPtr one = tensor_glyphs(make_dataset(std::move(parts)), p, l.context);
  CHECK(one->point_count() == nv);
  CHECK(one->fields().require("original_cell").array.get(0) == 7);
}

TEST_CASE("tensor_glyphs: sizes by eigenvalue, normalized and by logarithm; colours by direction, by sign, by any field") {
  Context context;
  const DatasetPtr in = tensor_points({diagonal(100, 0, 0), diagonal(10, 0, 0), diagonal(1, 0, 0), diagonal(1, 0, 0)});
  auto lengths = [&](std::optional<TensorScale> scale) {
    TensorGlyphsParams p;
    p.shape = TensorShape::cuboid, p.scale = scale;
    const DatasetPtr g = tensor_glyphs(in, p, context);
    std::vector<double> r;
    for (size_t i = 0; i < 4; ++i) {
      Box3 b;
      for (size_t k = 0; k < 24; ++k) b.add(g->as<SurfaceMesh>()->points.at(24 * i + k));
      r.push_back(b.size().x);
    }
    return r;
  };
  const auto e = lengths(TensorScale::eigenvalues), n = lengths(TensorScale::normalized), l = lengths(TensorScale::log);
  CHECK(e[0] / e[1] == doctest::Approx(10).epsilon(1e-4));
  CHECK(n[0] / n[2] == doctest::Approx(1).epsilon(1e-4));
  CHECK(l[0] > l[1]);
  CHECK(l[1] > l[2]);
  CHECK(l[0] / l[2] < 10);
  CHECK(lengths({}) == l);
  TensorGlyphsParams p;
  const DatasetPtr g = tensor_glyphs(in, p, context);
  CHECK(g->fields().require("direction").role == Role::colors);
  CHECK(g->fields().require("direction").array.get(0, 0) == 255);
  const DatasetPtr stress = tensor_points({diagonal(1, 0, -1), diagonal(2, 1, -1)});
  const DatasetPtr s = tensor_glyphs(stress, p, context);
  CHECK(s->fields().require("signed share").role == Role::scalars);
  CHECK(s->fields().require("signed share").array.get(s->point_count() - 1) == doctest::Approx(0.5));
  CHECK(s->fields().find("direction") == nullptr);
  p.color = "FA";
  CHECK(tensor_glyphs(in, p, context)->fields().with_role(Role::scalars)->name == "FA");
  p.color = "heat";
  CHECK(error_of([&] { tensor_glyphs(in, p, context); }).find("'heat'") != std::string::npos);
  CHECK(tensor_glyphs(tensor_points({SymTensor{}, diagonal(NAN, 1, 1)}), {}, context)->point_count() == 0);
}

TEST_CASE("tensor_glyphs: the same bytes for 1 and 8 threads") {
  const DatasetPtr grid = tensor_grid({9, 9, 9}, {0, 0, 0}, {2, 2, 2},
                                      [](Vec3 p) { return rotated(diagonal(3, 2, p.x - 1), random_rotation(uint64_t(8 * p.y))); });
  for (const TensorShape shape : {TensorShape::superquadric, TensorShape::reynolds, TensorShape::cylinder}) {
    const auto [a, b] = with_threads([&] {
      Context c;
      TensorGlyphsParams p;
      p.shape = shape;
      return tensor_glyphs(grid, p, c);
    });
    CHECK(a->point_count() > 1000);
    CHECK(equal_fields(*a, *b));
    CHECK(equal_bytes(a->as<SurfaceMesh>()->points.xyz, b->as<SurfaceMesh>()->points.xyz));
  }
}

TEST_CASE("tensor_glyphs: a long and narrow box gets fewer and larger glyphs, and a few large tensors do not make the others tiny") {
  Listener l;
  TensorGlyphsParams p;
  p.resolution = 4;
  const size_t nv = glyph(oblique, of_shape(TensorShape::superquadric, 4))->point_count();
  const DatasetPtr plate = tensor_grid({81, 17, 3}, {0, 0, 0}, {8, 1.6, 0.2}, [](Vec3) { return diagonal(3, 2, 1); });
  const DatasetPtr few = tensor_glyphs(plate, p, l.context);
  CHECK(few->point_count() / nv <= 180);
  CHECK(few->point_count() / nv >= 40);
  // One in eight is four times as large: drawn as large as 1.6 times the usual, which fills the distance.
  const DatasetPtr mixed = tensor_grid({5, 5, 5}, {0, 0, 0}, {4, 4, 4}, [](Vec3 x) {
    const bool large = x.x > 3.5 && x.y > 1.5;
    return diagonal(large ? 4 : 1, 0.5, 0.5);
  });
  const DatasetPtr m = tensor_glyphs(mixed, p, l.context);
  const auto width = [&](size_t g) {
    Box3 b;
    for (size_t i = 0; i < nv; ++i) b.add(m->as<SurfaceMesh>()->points.at(g * nv + i));
    return b.size().x;
  };
  CHECK(width(0) == doctest::Approx(p.size / 1.6).epsilon(1e-4));
  CHECK(width(4 + 5 * 4) == doctest::Approx(p.size).epsilon(1e-4));
  CHECK(l.notes.find("1.6 times") != std::string::npos);
  p.scale = TensorScale::eigenvalues;
  const DatasetPtr asked = tensor_glyphs(mixed, p, l.context);
  Box3 b;
  for (size_t i = 0; i < nv; ++i) b.add(asked->as<SurfaceMesh>()->points.at(i));
  CHECK(b.size().x == doctest::Approx(0.25 * p.size).epsilon(1e-4));
}
