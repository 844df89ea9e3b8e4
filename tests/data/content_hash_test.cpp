// SPDX-License-Identifier: Apache-2.0
#include "data/content_hash.h"

#include <vector>

#include "support/test.h"

using namespace sg;

namespace {

SurfaceMesh square() {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  m.polygons.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 0, 2, 3}), m.polygons.fixed = 3;
  return m;
}

std::string hash_of(Mesh m) { return content_hash(*make_dataset(std::move(m)), {}); }

}  // namespace

TEST_CASE("content hash: numbers count, not where and how they lie") {
  const std::string hash = hash_of(square());
  CHECK(hash.size() == 32);
  CHECK(hash_of(square()) == hash);
  {  // every second tuple of a longer list, from the second on
    SurfaceMesh m = square();
    const std::vector<float> wide{9, 9, 9, 0, 0, 0, 9, 9, 9, 1, 0, 0, 9, 9, 9, 1, 1, 0, 9, 9, 9, 0, 1, 0};
    m.points.xyz = Array(Array::from_vector(wide).buffer(), ElementType::f32, 4, 3, 12, 24, 4);
    CHECK_FALSE(m.points.xyz.packed());
    CHECK(hash_of(m) == hash);
  }
  {  // short indices, and offsets in place of a fixed number of corners
    SurfaceMesh m = square();
    m.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 0, 2, 3});
    CHECK(hash_of(m) == hash);
    m.polygons.offsets = Array::from_vector(std::vector<int64_t>{0, 3, 6}), m.polygons.fixed = 0;
    CHECK(hash_of(m) == hash);
  }
  {
    SurfaceMesh m = square();
    m.polygons.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 0, 3, 2});
    CHECK(hash_of(m) != hash);
    m = square(), m.points.origin.x = 1e-9;
    CHECK(hash_of(m) != hash);
    m = square(), std::swap(m.polygons, m.strips);
    CHECK(hash_of(m) != hash);
    m = square(), m.points.xyz = m.points.xyz.converted(ElementType::f64);
    CHECK(hash_of(m) != hash);
  }
}

TEST_CASE("content hash: of the fields that are asked for, their names and values, and of what is hidden") {
  DatasetParts parts;
  parts.mesh = square();
  parts.fields.add({"a", Association::point, Array::from_vector(std::vector<double>{1, 2, 3, 4}), "", Role::scalars});
  parts.fields.add({"b", Association::point, Array::from_vector(std::vector<double>{1, 2, 3, 4}), "", Role::scalars});
  const DatasetPtr d = make_dataset(parts);
  const Field &a = d->fields().require("a"), &b = d->fields().require("b");
  const std::string none = content_hash(*d, {}), of_a = content_hash(*d, {&a});
  CHECK(none == hash_of(square()));
  CHECK(content_hash(*d, {&a}) == of_a);  // from the memo
  CHECK(of_a != none);
  CHECK(content_hash(*d, {&b}) != of_a);
  CHECK(content_hash(*d, {&a, &b}) != of_a);
  parts.fields.add({"b", Association::point, Array::from_vector(std::vector<double>{1, 2, 3, 5}), "", Role::scalars});
  const DatasetPtr other = make_dataset(parts);
  CHECK(content_hash(*other, {&other->fields().require("a")}) == of_a);
  CHECK(content_hash(*other, {&other->fields().require("b")}) != content_hash(*d, {&b}));
  parts.cell_ghost = Array::from_vector(std::vector<uint8_t>{0, ghost_hidden_cell});
  CHECK(content_hash(*make_dataset(parts), {}) != none);
}
