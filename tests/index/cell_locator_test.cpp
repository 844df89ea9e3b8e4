// SPDX-License-Identifier: Apache-2.0
#include "index/cell_locator.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "index/locator_meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

// Points in the box and around it; every third near a cell: a corner, the middle of two or three corners, or a little off.
class Places {
 public:
  Places(const DatasetPtr& d, double slack) : reader_(d), box_(d->bounds()), slack_(slack) {}
  Vec3 operator()(size_t i) {
    auto u = [&](size_t k) { return random_unit(77, 8 * i + k); };
    if (i % 3 != 0) return box_.lo + box_.size() * (Vec3(u(0), u(1), u(2)) * 1.2 - Vec3(0.1, 0.1, 0.1));
    reader_.open(size_t(u(0) * double(reader_.count())));
    const auto at = reader_.at();
    Vec3 sum;
    const int n = 1 + int(u(1) * 3);
    for (int k = 0; k < n; ++k) sum += at[size_t(u(size_t(2 + k)) * double(at.size()))];
    const double off = i % 2 ? 0.0 : u(6) < 0.5 ? 0.3 * slack_ : 20 * slack_;
    return sum / double(n) + Vec3(off, -off, off) * 0.5;
  }

 private:
  CellReader reader_;
  Box3 box_;
  double slack_;
};

constexpr size_t grain = 1000;

}  // namespace

TEST_CASE("locator: the cell of 100,000 points is the one that a look at every cell finds, on every mesh kind") {
  for (const NamedMesh& mesh : all_meshes()) {
    CAPTURE(mesh.name);
    Context context;
    const CellLocator locator(mesh.data, context);
    const EveryCell model(mesh.data);
    std::atomic<size_t> wrong{0}, inside{0};
    const bool far = mesh.name == "tetrahedra, far away";
    parallel_for(mesh.finds, grain, [&](size_t begin, size_t end) {
      LocatorCursor cursor(locator);
      EveryCell every(model);
      Places places(mesh.data, every.slack());
      CellPlace place;
      for (size_t i = begin; i < end; ++i) {
        const Vec3 x = places(i);
        const int64_t cell = cursor.find(x), expected = every.find(x);
        // Far from zero, what is on a face and what is not is a matter of the last digits.
        if (far && cell != expected) wrong += cell >= 0 && !every.probe().open(size_t(cell)).locate(x, place, 1e-6);
        else wrong += cell != expected;
        inside += cell >= 0;
      }
    });
    CHECK(wrong == 0);
    CHECK(inside > mesh.finds / 10);
  }
}

TEST_CASE("locator: the answer does not depend on what was asked before") {
  for (const NamedMesh& mesh : search_meshes()) {
    CAPTURE(mesh.name);
    Context context;
    const CellLocator locator(mesh.data, context);
    LocatorCursor along(locator);
    Places places(mesh.data, 0);
    size_t wrong = 0;
    for (size_t i = 0; i < 100; ++i) {
      LocatorCursor fresh(locator);
      const Vec3 x = places(i);
      wrong += along.find(x) != fresh.find(x);
      wrong += along.find(x) != fresh.find(x);  // and again, the last cell being the right one
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("locator: weights reproduce a linear field in every cell") {
  auto linear = [](Vec3 p) { return 2 * p.x - p.y + 0.5 * p.z; };
  for (const NamedMesh& mesh : search_meshes()) {
    if (mesh.data->as<PointCloud>()) continue;
    CAPTURE(mesh.name);
    Context context;
    const CellLocator locator(mesh.data, context);
    LocatorCursor cursor(locator);
    CellReader reader(mesh.data);
    Places places(mesh.data, 0);
    double worst = 0, unity = 0;
    size_t found = 0, wrong = 0;
    for (size_t i = 0; i < (mesh.name == "curved" ? 500 : 3000); ++i) {
      const Vec3 x = places(i);
      const int64_t cell = cursor.find(x);
      if (cell < 0) continue;
      ++found;
      reader.open(size_t(cell));
      wrong += cursor.ids().size() != reader.ids().size();
      double sum = 0, one = 0;
      for (size_t k = 0; k < reader.ids().size(); ++k) {
        wrong += cursor.ids()[k] != reader.ids()[k];
        sum += cursor.weights()[k] * linear(reader.at()[k] - mesh.data->bounds().lo);
        one += cursor.weights()[k];
      }
      worst = std::max(worst, std::abs(sum - linear(cursor.place().nearest - mesh.data->bounds().lo)));
      unity = std::max(unity, std::abs(one - 1));
    }
    CHECK(found > 50);
    CHECK(wrong == 0);
    CHECK(worst < (mesh.name == "tetrahedra, far away" ? 1e-7 : 1e-6));  // flat meshes: x may lie beside the surface
    CHECK(unity < 1e-9);
  }
}

TEST_CASE("locator: the nearest point is the one that a look at every cell finds, on every mesh kind") {
  for (const NamedMesh& mesh : all_meshes()) {
    CAPTURE(mesh.name);
    Context context;
    const CellLocator locator(mesh.data, context);
    const EveryCell model(mesh.data);
    const bool far = mesh.name == "tetrahedra, far away";
    std::atomic<size_t> wrong{0}, outside{0};
    parallel_for(mesh.nearest, std::clamp<size_t>(mesh.nearest / 20, 5, grain), [&](size_t begin, size_t end) {
      LocatorCursor cursor(locator);
      EveryCell every(model);
      const Box3 b = mesh.data->bounds();
      for (size_t i = begin; i < end; ++i) {
        const Vec3 x = b.lo + b.size() * (Vec3(random_unit(3, 3 * i), random_unit(3, 3 * i + 1), random_unit(3, 3 * i + 2)) * 1.2 -
                                          Vec3(0.1, 0.1, 0.1));
        const NearestPlace p = cursor.nearest(x);
        const auto [cell, d2] = every.nearest(x);
        wrong += std::abs(std::sqrt(p.distance2) - std::sqrt(d2)) > (far ? 1e-7 : 1e-9);
        Vec3 at;
        if (p.cell != cell)
          wrong += std::abs(std::sqrt(every.probe().nearest(size_t(p.cell), x, at)) - std::sqrt(d2)) > (far ? 1e-7 : 1e-9);  // a tie
        wrong += std::abs(length(p.at - x) - std::sqrt(p.distance2)) > 1e-7;
        outside += d2 > 0;
        const double radius = std::sqrt(p.distance2);
        if (radius > 0 && i % 20 == 0)
          wrong += cursor.nearest(x, 0.99 * radius).cell >= 0 || cursor.nearest(x, 1.01 * radius).cell != p.cell;
      }
    });
    CHECK(wrong == 0);
    CHECK(outside > mesh.nearest / 5);
  }
}

TEST_CASE("locator: the first hit of a ray is the one that a look at every cell finds, on every mesh kind") {
  for (const NamedMesh& mesh : all_meshes()) {
    if (mesh.data->as<PointCloud>()) continue;  // no ray meets a point
    CAPTURE(mesh.name);
    Context context;
    const CellLocator locator(mesh.data, context);
    const EveryCell model(mesh.data);
    const bool exact = !mesh.data->as<UniformGrid>() && !mesh.data->as<RectilinearGrid>();
    std::atomic<size_t> wrong{0}, hits{0};
    parallel_for(mesh.rays, 200, [&](size_t begin, size_t end) {
      LocatorCursor cursor(locator);
      EveryCell every(model);
      const Box3 b = mesh.data->bounds();
      const double size = b.diagonal();
      for (size_t i = begin; i < end; ++i) {
        auto u = [&](size_t k) { return random_unit(9, 8 * i + k); };
        const Vec3 x = b.center() + Vec3(u(0) - 0.5, u(1) - 0.5, u(2) - 0.5) * size;
        Vec3 d = b.center() + Vec3(u(3) - 0.5, u(4) - 0.5, u(5) - 0.5) * (0.5 * size) - x;
        if (i % 4 == 0) d = Vec3(i % 12 == 0, i % 12 == 4, i % 12 == 8) * (u(6) < 0.5 ? -1.0 : 1.0);  // along an axis
        const auto got = cursor.first_hit(x, d, 0, 5);
        const auto [cell, t] = every.hit(x, d, 0, 5);
        hits += cell >= 0;
        if (!got || cell < 0) wrong += got.has_value() != (cell >= 0);
        else wrong += exact ? got->cell != cell || got->t != t : std::abs(got->t - t) > 1e-9 || got->cell != cell;
        if (got) wrong += std::abs(length(got->normal) - 1) > 1e-9;
      }
    });
    CHECK(wrong == 0);
    CHECK(hits > mesh.rays / 50);
  }
}

TEST_CASE("locator: no ray from inside leaves a closed surface, through edges and corners neither") {
  const DatasetPtr mesh = ball(20, false);
  Context context;
  const CellLocator locator(mesh, context);
  LocatorCursor cursor(locator);
  CellReader reader(mesh);
  size_t lost = 0;
  for (size_t i = 0; i < 20000; ++i) {
    reader.open(i % reader.count());
    const auto at = reader.at();
    const Vec3 from =
        i % 3 ? Vec3(random_unit(1, 3 * i), random_unit(1, 3 * i + 1), random_unit(1, 3 * i + 2)) * 0.5 - Vec3(.25, .25, .25) : Vec3();
    const double t = random_unit(2, i);
    const Vec3 aim = i % 2 ? at[i % 3] : lerp(at[0], at[1], t);
    const auto hit = cursor.first_hit(from, aim - from);
    lost += !hit || std::abs(hit->t - 1) > 1e-9;
  }
  CHECK(lost == 0);
}

TEST_CASE("locator: rays along the axes, from the surface itself and within a plane of boxes without thickness") {
  CellList m;
  for (Vec3 p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) m.point(p);
  m.cell(CellType::quad, {0, 1, 2, 3});
  Context context;
  const CellLocator locator(m.dataset(), context);
  LocatorCursor cursor(locator);
  const auto down = cursor.first_hit({0.25, 0.5, 2}, {0, 0, -1});
  REQUIRE(down);
  CHECK(down->t == 2);
  CHECK(std::abs(down->normal.z) == 1);
  CHECK(cursor.first_hit({0.25, 0.5, 0}, {0, 0, -1})->t == 0);   // starts on it
  CHECK(cursor.first_hit({0, 0, 0}, {0.3, 0.2, 1})->t == 0);     // and on its corner
  CHECK(cursor.first_hit({1, 0.5, 3}, {0, 0, -1})->t == 3);      // down its edge
  CHECK(!cursor.first_hit({0.25, 0.5, 2}, {0, 0, 1}));           // behind
  CHECK(!cursor.first_hit({0.25, 0.5, 2}, {0, 0, -1}, 0, 1.9));  // too short
  CHECK(!cursor.first_hit({0.25, 0.5, 2}, {0, 0, -1}, 2.1));     // starts behind it
  CHECK(!cursor.first_hit({-1, 0.5, 0}, {1, 0, 0}));             // within its plane
  CHECK(!cursor.first_hit({1.0001, 0.5, 2}, {0, 0, -1}));        // beside
  CHECK(!cursor.first_hit({0.25, 0.5, 2}, {0, 0, 0}));           // no direction
  CHECK(!cursor.first_hit({NAN, 0.5, 2}, {0, 0, -1}));
  CHECK(cursor.find({0.25, 0.5, 0}) == 0);
  CHECK(cursor.find({0.25, 0.5, 1e-3}) == -1);
  CHECK(cursor.find({NAN, 0, 0}) == -1);
}

TEST_CASE("locator: a solid is left where it was entered from inside, with the normal outward") {
  const DatasetPtr mesh = block_cells("tetra", 1, 0).dataset();
  Context context;
  const CellLocator locator(mesh, context);
  LocatorCursor cursor(locator);
  const auto hit = cursor.first_hit({-3, 0.1, 0.2}, {1, 0, 0});
  REQUIRE(hit);
  CHECK(hit->t == doctest::Approx(2));
  CHECK(hit->normal.x == doctest::Approx(-1));
  const auto in = cursor.first_hit({0.9, 0.1, 0.2}, {1, 0, 0});
  REQUIRE(in);
  CHECK(in->t == doctest::Approx(0.1));
  CHECK(in->normal.x == doctest::Approx(1));
}

TEST_CASE("locator: AMR answers with the finest cell and never with a refined one") {
  const DatasetPtr mesh = amr();
  Context context;
  const CellLocator locator(mesh, context);
  LocatorCursor cursor(locator);
  CellReader reader(mesh);
  size_t fine = 0, refined = 0;
  for (size_t i = 0; i < 5000; ++i) {
    const Vec3 x = Vec3(random_unit(1, 3 * i), random_unit(1, 3 * i + 1), random_unit(1, 3 * i + 2)) * 2 - Vec3(1, 1, 1);
    const int64_t cell = cursor.find(x);
    REQUIRE(cell >= 0);
    refined += reader.hidden(size_t(cell));
    reader.open(size_t(cell));
    fine += reader.box().size().x < 0.1;
  }
  CHECK(fine > 10);
  CHECK(refined == 0);
}

TEST_CASE("locator: meshes without cells answer nothing") {
  for (const DatasetPtr& d :
       {CellList().dataset(), make_dataset(SurfaceMesh{{Array::from_vector(std::vector<float>{}, 3), {}}, {}, {}, {}, {}}), cloud(0)}) {
    Context context;
    const CellLocator locator(d, context);
    LocatorCursor cursor(locator);
    CHECK(cursor.find({0, 0, 0}) == -1);
    CHECK(cursor.ids().empty());
    CHECK(cursor.nearest({0, 0, 0}).cell == -1);
    CHECK(!cursor.first_hit({0, 0, 0}, {1, 0, 0}));
  }
}

TEST_CASE("locator: the box of a curved cell holds all of it") {
  CellReader reader(block_cells("curved", 3, 0.2).dataset());
  CellMap map(block_cells("curved", 3, 0.2).dataset());
  size_t out = 0;
  for (size_t c = 0; c < reader.count(); ++c) {
    map.open(c);
    const Box3 b = cell_box(map.reader());
    for (size_t i = 0; i < 200; ++i) {
      double r[3] = {random_unit(c, 3 * i), random_unit(c, 3 * i + 1), random_unit(c, 3 * i + 2)};
      std::sort(r, r + 3);
      const Vec3 x = map.position({r[0], r[1] - r[0], r[2] - r[1]});
      for (int a = 0; a < 3; ++a) out += x[a] < b.lo[a] || x[a] > b.hi[a];
    }
  }
  CHECK(out == 0);
}
