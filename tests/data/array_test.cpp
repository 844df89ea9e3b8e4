// SPDX-License-Identifier: Apache-2.0
#include "data/array.h"

#include "data/dataset.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("array: strides see any layout without a copy") {
  const Array a = Array::from_vector<float>({1, 2, 3, 4, 5, 6}, 3);
  CHECK(a.count() == 2);
  CHECK(a.component(1).get(1) == 5);
  const Array planar(a.buffer(), ElementType::f32, 3, 2, 0, 4, 12);  // the same bytes as xxxyyy
  CHECK(planar.get(2, 0) == 3);
  CHECK(planar.get(2, 1) == 6);
  CHECK_FALSE(planar.packed());
  CHECK(planar.made_packed().view<float>().data[1] == 4);
  CHECK_THROWS_AS(Array(a.buffer(), ElementType::f64, 4, 1), Error);
}

TEST_CASE("array: components and slices of an empty array are empty") {
  const Array none(Buffer{}, ElementType::f32, 0, 3);
  CHECK(none.component(1).count() == 0);
  CHECK(none.component(2).components() == 1);
  CHECK(none.slice(0, 0).count() == 0);
}

TEST_CASE("array: conversion rounds and clamps") {
  const Array a = Array::from_vector<double>({-1, 1.5, 300, NAN});
  const Array b = a.converted(ElementType::u8);
  CHECK(b.get(0) == 0);
  CHECK(b.get(1) == 2);
  CHECK(b.get(2) == 255);
  CHECK(b.get(3) == 0);
}

TEST_CASE("field stats: NaN and infinities are counted and left out of the range") {
  std::vector<float> v(100001, 1.f);
  v[7] = NAN, v[70000] = INFINITY, v[100000] = -3, v[5] = 9;
  const FieldStats s = field_stats(Array::from_vector(v));
  CHECK(s.range[0].lo == -3);
  CHECK(s.range[0].hi == 9);
  CHECK(s.nan == 1);
  CHECK(s.infinite == 1);
  const FieldStats none = field_stats(Array::from_vector<float>({NAN, NAN}));
  CHECK(none.range[0].empty());
  CHECK(none.nan == 2);
}

TEST_CASE("dataset: lengths and indices are checked when it is made") {
  UniformGrid g;
  g.dims = {3, 2, 1};
  FieldSet f;
  f.add({"a", Association::point, Array::from_vector<float>({1, 2, 3}), "", Role::scalars});
  CHECK(test::error_of([&] { make_dataset(g, f); }).find("'a' has 3 tuples for 6 points") != std::string::npos);

  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  m.polygons.fixed = 3;
  m.polygons.connectivity = Array::from_vector<int32_t>({0, 1, 3});
  CHECK(test::error_of([&] { make_dataset(m); }).find("point id 3") != std::string::npos);
  m.polygons.connectivity = Array::from_vector<int32_t>({0, 1, 2});
  const DatasetPtr d = make_dataset(m);
  CHECK(d->cell_count() == 1);
  CHECK(d->bounds().hi == Vec3(1, 1, 0));
}
