// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include "contour_support.h"
#include "filter/surface/surfels.h"

using namespace sg;

namespace {

// Waves with noise, so that all patterns of corners come up; a few cells wide of a word in x.
template <class T>
DatasetPtr waves(double scale, bool other_field, bool holes) {
  UniformGrid g;
  g.dims = {139, 31, 26};
  g.origin = {-3, 1, 2}, g.spacing = {0.5, 0.25, 0.75};
  std::vector<T> v;
  std::vector<float> w;
  uint32_t random = 1;
  for (int k = 0; k < 26; ++k)
    for (int j = 0; j < 31; ++j)
      for (int i = 0; i < 139; ++i) {
        random = random * 1664525u + 1013904223u;
        const double noise = double(random >> 8) / (1 << 24);
        v.push_back(T(scale * (3 + std::sin(0.2 * i) + std::cos(0.3 * j + 0.1 * k) + 0.7 * noise)));
        w.push_back(float(i + j * k));
        if (holes && noise < 0.001) v.back() = T(NAN);
      }
  FieldSet f;
  f.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  if (other_field) f.add({"w", Association::point, Array::from_vector(std::move(w)), "", Role::none});
  return make_dataset(g, f);
}

bool same(const Array& a, const Array& b) {
  return a.count() == b.count() && (a.bytes() == 0 || std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}

void check_same(const DatasetPtr& a, const DatasetPtr& b) {
  REQUIRE(a->fields().size() == b->fields().size());
  for (const Field& f : a->fields()) CHECK(same(f.array, b->fields().require(f.name).array));
  if (const auto* m = a->as<SurfaceMesh>()) {
    CHECK(same(m->points.xyz, b->as<SurfaceMesh>()->points.xyz));
    CHECK(same(m->polygons.connectivity, b->as<SurfaceMesh>()->polygons.connectivity));
  } else {
    CHECK(same(a->as<PointCloud>()->points.xyz, b->as<PointCloud>()->points.xyz));
  }
}

template <class Make>
void check_targets(Make&& make) {
  const std::vector<DatasetPtr> best = make();
  for (int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    CAPTURE(target);
    const std::vector<DatasetPtr> other = make();
    for (size_t i = 0; i < best.size(); ++i) check_same(best[i], other[i]);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace

TEST_CASE("contour and surfels: the same bytes with all vector instructions") {
  const auto check = [](const DatasetPtr& d, double value) {
    check_targets([&] {
      const DatasetPtr fresh = make_dataset(d->parts());
      Context context;
      std::vector<DatasetPtr> r;
      for (int again = 0; again < 2; ++again) r.push_back(test::contour_at(fresh, value));  // without an index, then with it
      r.push_back(surfels(fresh, {.value = value}, context));
      CHECK(r[0]->point_count() > 3000);
      check_same(r[0], r[1]);
      return r;
    });
  };
  check(waves<float>(1, false, false), 3.2);
  check(waves<float>(1, true, true), 2.7);
  check(waves<double>(1e3, true, false), 3200);
  check(waves<uint8_t>(40, false, false), 130);
  check(waves<int8_t>(20, false, false), 66.5);
  check(waves<uint16_t>(9000, true, false), 30000);
  check(waves<int16_t>(900, false, false), 3000);
}

TEST_CASE("contour: the cells that bits alone count are counted as the table does") {
  // Each pattern of corners in a cell of its own, the rest of the grid outside: counts that do not fit the triangles would be seen.
  std::vector<float> v(size_t(4) * 4 * 4 * 256, 0.0f);
  for (size_t p = 0; p < 256; ++p)
    for (size_t c = 0; c < 8; ++c)
      if (p >> c & 1) v[4 * p + 1 + (c & 1) + 1024 * (1 + (c >> 1 & 1) + 4 * (1 + (c >> 2)))] = 1;
  const DatasetPtr d = test::grid_of<float>({1024, 4, 4}, v);
  for (const ContourTopology topology : {ContourTopology::trilinear, ContourTopology::fixed}) {
    Context context;
    ContourParams p;
    p.values = {0.5};
    p.topology = topology;
    const DatasetPtr r = contour(d, p, context);
    validate(r->mesh());
    const SurfaceMesh& m = *r->as<SurfaceMesh>();
    std::map<std::pair<int64_t, int64_t>, int> sides;  // closed: each edge once in both directions
    for (size_t t = 0; t < m.polygons.connectivity.count() / 3; ++t)
      for (size_t e = 0; e < 3; ++e) {
        const auto a = int64_t(m.polygons.connectivity.get(3 * t + e)), b = int64_t(m.polygons.connectivity.get(3 * t + (e + 1) % 3));
        ++sides[{a, b}];
      }
    bool closed = true;
    for (const auto& [edge, n] : sides) closed = closed && n == 1 && sides.count({edge.second, edge.first}) == 1;
    CHECK(closed);
    CHECK(r->cell_count() > 2000);
  }
}
