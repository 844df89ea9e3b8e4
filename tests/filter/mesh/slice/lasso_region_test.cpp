// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/slice/lasso_region.h"

#include <numbers>

#include "data/cells/shape/cell_map.h"
#include "filter/every_mesh.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/select/extract_ids.h"
#include "filter/mesh/select/threshold.h"
#include "filter/mesh/slice/slice.h"
#include "support/property.h"

using namespace sg;
using namespace sg::test;

namespace {

// [-1,1]^3 in n^3 cells, or the box from lo to hi.
DatasetPtr block_of(size_t n, Vec3 lo = {-1, -1, -1}, Vec3 hi = {1, 1, 1}) {
  UniformGrid g;
  g.dims = {n + 1, n + 1, n + 1};
  g.origin = lo, g.spacing = (hi - lo) / double(n);
  return make_dataset(g);
}

double measure_of(const DatasetPtr& d) {
  CellMap map(d);
  std::vector<double> weights;
  double sum = 0;
  for (size_t c = 0; c < d->cell_count(); ++c) {
    map.open(c);
    weights.resize(map.reader().ids().size());
    map.integration_weights(weights);
    for (const double w : weights) sum += w;
  }
  return sum;
}

std::string lasso_refusal(const ImplicitParams& region) {
  ExtractParams p;
  p.region = region;
  Context context;
  return error_of([&] { extract(block_of(2), p, context); });
}

// The letter L: a square of 2 without its upper right quarter, in the plane z = 5.
const std::vector<double> letter = {-1, -1, 5, 1, -1, 5, 1, 0, 5, 0, 0, 5, 0, 1, 5, -1, 1, 5};

}  // namespace

TEST_CASE("lasso: a square along an axis selects the cells of the box") {
  Context context;
  const DatasetPtr d = block_of(10);
  ExtractParams box, lasso;
  box.region.box = {-0.35, 0.75, -0.55, 0.45, -9, 9};
  lasso.region.lasso = {-0.35, -0.55, 7, 0.75, -0.55, 7, 0.75, 0.45, 7, -0.35, 0.45, 7};
  const DatasetPtr a = extract(d, box, context), b = extract(d, lasso, context);
  CHECK(a->cell_count() == 4 * 4 * 10);  // whole cells of 0.2 between the ends
  CHECK(b->cell_count() == a->cell_count());
  CHECK(b->bounds().lo == a->bounds().lo);
  CHECK(b->bounds().hi == a->bounds().hi);
  box.by_center = lasso.by_center = true;
  CHECK(extract(d, lasso, context)->cell_count() == 6 * 5 * 10);  // centres from -0.3 to 0.7 and from -0.5 to 0.3
  CHECK(extract(d, box, context)->cell_count() == 6 * 5 * 10);
}

TEST_CASE("lasso: an outline that is not convex, and one that crosses itself, by the even-odd rule") {
  Context context;
  ExtractParams p;
  p.region.lasso = letter;
  CHECK(extract(block_of(8), p, context)->cell_count() == 8 * 8 * 8 * 3 / 4);
  // Two squares, one within the other, gone round the same way: the inner one is a hole.
  p.region.lasso = {-1,   -1,   0, 1,   -1,   0, 1,   1,   0, -1,   1,   0, -1,   -1,   0,
                    -0.5, -0.5, 0, 0.5, -0.5, 0, 0.5, 0.5, 0, -0.5, 0.5, 0, -0.5, -0.5, 0};
  p.by_center = true;
  CHECK(extract(block_of(8), p, context)->cell_count() == 8 * 8 * 8 * 3 / 4);
  p.invert = true;
  CHECK(extract(block_of(8), p, context)->cell_count() == 8 * 8 * 8 / 4);
}

TEST_CASE("lasso: distances from the outline, in the plane and scaled by the depth") {
  const LassoRegion l(letter, {}, "clip");
  CHECK(l.distance({-0.5, -0.5, 0}) == doctest::Approx(-0.5));
  CHECK(l.distance({0.5, 0.5, -100}) == doctest::Approx(0.5));
  CHECK(l.distance({2, 2, 3}) == doctest::Approx(std::sqrt(5.0)));  // from (1, 0) and from (0, 1)
  const LassoRegion seen(letter, Vec3(0, 0, 0), "clip");
  CHECK(seen.distance({-0.5, -0.5, 5}) == doctest::Approx(-0.5));
  CHECK(seen.distance({-1, -1, 10}) == doctest::Approx(-1));
  CHECK(seen.distance({0, 3, 5}) == doctest::Approx(2));
  CHECK(seen.distance({3, 4, 0}) == 5);
  CHECK(seen.distance({3, 4, 1e-9}) == doctest::Approx(5).epsilon(1e-8));  // continuous
  CHECK(seen.distance({0, 0, -2}) == 2);
  CHECK_FALSE(seen.holds({-0.5, -0.5, -5}));
}

TEST_CASE("property: lasso: holds() is distance() <= 0, and distances change no faster than places") {
  for (const uint64_t seed : property_seeds(40)) {
    CAPTURE(seed);
    Random random(seed);
    const auto place = [&](double r) { return Vec3(random.in(-r, r), random.in(-r, r), random.in(-r, r)); };
    const Vec3 n = normalize(place(1)), u = normalize(cross(n, Vec3(0.3, 0.5, 0.7))), v = cross(n, u), middle = place(2);
    std::vector<double> corners;
    std::vector<Vec3> at;
    for (int k = 0, count = random.whole(3, random.chance(0.5) ? 60 : 600); k < count; ++k) {
      const Vec3 c = middle + u * random.in(-1, 1) + v * random.in(-1, 1);
      corners.insert(corners.end(), {c.x, c.y, c.z});
      at.push_back(c);
    }
    std::optional<Vec3> eye;
    if (random.chance(0.5)) eye = middle + n * random.in(1, 3) + u * random.in(-0.5, 0.5);
    const LassoRegion region(corners, eye, "clip");
    for (int k = 0; k < 200; ++k) {
      const Vec3 x = middle + place(1.5), step = place(0.1);
      CHECK(region.holds(x) == (region.distance(x) <= 0));
      // Along the rays the outline widens: by less than its own reach over the eye's distance.
      const double most = eye ? 1 + 4 / std::abs(dot(*eye - middle, n)) : 1;
      CHECK(std::abs(region.distance(x + step) - region.distance(x)) <= most * length(step) + 1e-12);
    }
    if (eye) continue;
    CHECK(std::abs(region.distance(at[0] + n * 100.0)) < 1e-9);
    // From the nearest edge of all, wherever the place lies.
    for (int k = 0; k < 100; ++k) {
      const Vec3 x = middle + place(k < 50 ? 1.5 : 50), flat = x - n * dot(n, x - middle);
      double nearest = HUGE_VAL;
      for (size_t i = 0; i < at.size(); ++i) {
        const Vec3 a = at[i], along = at[(i + 1) % at.size()] - a;
        nearest = std::min(nearest, length(a + along * std::clamp(dot(flat - a, along) / dot(along, along), 0.0, 1.0) - flat));
      }
      CHECK(std::abs(region.distance(x)) == doctest::Approx(nearest).epsilon(1e-9));
    }
  }
}

TEST_CASE("lasso: clipping along the rays through the eye leaves a pyramid, converging to its volume") {
  Context context;
  ClipParams p;
  p.lasso = {-0.5, -0.5, 1, 0.5, -0.5, 1, 0.5, 0.5, 1, -0.5, 0.5, 1};
  p.lasso_eye = Vec3(0, 0, 0);
  std::vector<double> errors;
  for (const size_t n : {9, 18, 36}) {
    const DatasetPtr kept = std::get<DatasetPtr>(clip(block_of(n, {-0.7, -0.7, -0.5}, {0.7, 0.7, 1}), p, context));
    errors.push_back(std::abs(measure_of(kept) - 1.0 / 3));
    CHECK(kept->bounds().lo.z > -0.1);  // nothing behind the eye
  }
  CHECK(errors[2] < 2e-3);
  CHECK(errors[1] < errors[0] / 2.5);
  CHECK(errors[2] < errors[1] / 2.5);
}

TEST_CASE("lasso: slices are its walls; a circle of many corners has the area of a cylinder") {
  Context context;
  SliceParams p;
  for (int k = 0; k < 400; ++k) {
    const double a = 2 * std::numbers::pi * k / 400;
    p.lasso.insert(p.lasso.end(), {0.6 * std::cos(a), 0.6 * std::sin(a), 0});
  }
  const DatasetPtr wall = slice(block_of(40), p, context);
  CHECK(measure_of(wall) == doctest::Approx(2 * std::numbers::pi * 0.6 * 2).epsilon(1e-3));
}

TEST_CASE("lasso: outlines that have no inside are refused") {
  ImplicitParams p;
  p.lasso = {0, 0, 0, 1, 0};
  CHECK(lasso_refusal(p).find("whole corners") != std::string::npos);
  p.lasso = {0, 0, 0, 1, 0, 0};
  CHECK(lasso_refusal(p).find("three corners or more, not 2") != std::string::npos);
  p.lasso = {0, 0, 0, 1, 1, 1, 3, 3, 3, 7, 7, 7};
  CHECK(lasso_refusal(p).find("one line") != std::string::npos);
  p.lasso = {2, 2, 2, 2, 2, 2, 2, 2, 2};
  CHECK(lasso_refusal(p).find("one line") != std::string::npos);
  p.lasso = {0, 0, 0, 1, 0, 0, 0, HUGE_VAL, 0};
  CHECK(lasso_refusal(p).find("not finite") != std::string::npos);
  p.lasso = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  p.lasso_eye = Vec3(5, 5, 0);
  CHECK(lasso_refusal(p).find("in the plane") != std::string::npos);
  p.lasso_eye = Vec3(5, 5, 1), p.box = {0, 1, 0, 1, 0, 1};
  CHECK(lasso_refusal(p).find("both given") != std::string::npos);
  p.box.clear(), p.lasso.clear();
  CHECK(lasso_refusal(p).find("lasso_eye needs a lasso") != std::string::npos);
}

TEST_CASE("threshold: by the mean of a cell's points") {
  Context context;
  const DatasetPtr d = with_values(block_of(4), "x", 1, [](Vec3 p, double* x) { *x = p.x; });
  ThresholdParams p;
  p.field.name = "x", p.min = -0.25;
  CHECK(threshold(d, p, context)->cell_count() == 2 * 16);  // points at -1, -0.5, ..., 1
  p.mean = true;
  CHECK(threshold(d, p, context)->cell_count() == 3 * 16);  // means at -0.75, -0.25, ...
  p.invert = true;
  CHECK(threshold(d, p, context)->cell_count() == 1 * 16);
}
