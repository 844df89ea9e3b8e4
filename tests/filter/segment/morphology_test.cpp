// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/morphology.h"

#include <algorithm>

#include "base/random.h"
#include "filter/segment/distance_map.h"
#include "filter/segment/label_components.h"
#include "segment_support.h"

using namespace sg;
using test::array_of;
using test::image_of;

namespace {

DatasetPtr morph(const DatasetPtr& d, Morphology operation, double radius) {
  MorphologyParams p;
  p.operation = operation, p.radius = radius;
  Context context;
  return morphology(d, p, context);
}
DatasetPtr components_of(const DatasetPtr& d, LabelComponentsParams p = {}) {
  Context context;
  return label_components(d, p, context);
}
DatasetPtr distances(const DatasetPtr& d, DistanceMapParams p = {}) {
  Context context;
  return distance_map(d, p, context);
}
size_t count(const DatasetPtr& d, const char* name, double value) {
  size_t n = 0;
  for (size_t i = 0; i < d->point_count(); ++i) n += array_of(d, name).get(i) == value;
  return n;
}
double hash(Vec3 p, uint64_t seed) {
  return random_unit(seed, uint64_t(std::llround(8 * p.x) + 1000 * (std::llround(8 * p.y) + 1000 * std::llround(8 * p.z))));
}

}  // namespace

TEST_CASE("distance map: equals the search over all samples, on any spacing and in the plane") {
  for (const Vec3 h : {Vec3(1, 1, 1), Vec3(0.5, 2, 3), Vec3(1.25, 1.25, -2.5)})
    for (const size_t nz : {1, 9}) {
      const auto d = image_of<uint8_t>(
          {14, 11, nz}, [](Vec3 p) { return hash(p, 1) < 0.03 ? 1.0 : 0.0; }, h);
      const auto r = distances(d);
      const Array& v = array_of(d, "v");
      for (size_t i = 0; i < v.count(); ++i) {
        const auto at = [&](size_t n) { return Vec3(double(n % 14) * h.x, double(n / 14 % 11) * h.y, double(n / 154) * h.z); };
        double best = HUGE_VAL;
        for (size_t j = 0; j < v.count(); ++j)
          if (v.get(j) == 1) best = std::min(best, length(at(i) - at(j)));
        if (std::isfinite(best)) CHECK(array_of(r, "distance").get(i) == doctest::Approx(best).epsilon(1e-6));
      }
    }
}

TEST_CASE("distance map: uneven axes, both sides, an empty set, samples without a value") {
  RectilinearGrid g;
  g.x = Array::from_vector<double>({0, 1, 4, 9, 10}), g.y = Array::from_vector<double>({0}), g.z = Array::from_vector<double>({0});
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector<float>({0, 1, 0, 0, NAN}), "", Role::none});
  DistanceMapParams p;
  p.both_sides = true;
  const auto r = distances(make_dataset(g, f), p);
  const double expected[] = {1, -1, 3, 8};
  for (size_t i = 0; i < 4; ++i) CHECK(array_of(r, "distance").get(i) == expected[i]);
  CHECK(std::isnan(array_of(r, "distance").get(4)));
  p.both_sides = false, p.min = 5;
  CHECK(std::isinf(array_of(distances(make_dataset(g, f), p), "distance").get(0)));
  p.max = 4;
  CHECK(test::error_of([&] { distances(make_dataset(g, f), p); }).find("above max") != std::string::npos);
}

TEST_CASE("distance map: the same bytes for any number of threads") {
  const auto d = image_of<uint8_t>({70, 60, 50}, [](Vec3 p) { return hash(p, 4) < 0.001 ? 1.0 : 0.0; }, {1, 0.7, 1.3});
  CHECK(test::same_for_threads("distance", [&] { return distances(d); }));
}

TEST_CASE("morphology: a sample grows to the ball of the radius in units of length") {
  const Vec3 h{1, 0.5, 2};
  const auto d = image_of<int16_t>(
      {21, 41, 11}, [&](Vec3 p) { return p == h * Vec3(10, 20, 5) ? 7.0 : 0.0; }, h);
  const auto r = morph(d, Morphology::dilate, 4);
  size_t expected = 0;
  for (int z = -5; z <= 5; ++z)
    for (int y = -20; y <= 20; ++y)
      for (int x = -10; x <= 10; ++x) expected += length(h * Vec3(x, y, z)) <= 4;
  CHECK(count(r, "v", 7) == expected);
  CHECK(array_of(r, "v").type() == ElementType::i16);
  CHECK(count(morph(r, Morphology::erode, 4), "v", 7) == 1);
}

TEST_CASE("morphology: opening removes threads and keeps balls, closing closes gaps, both are idempotent and ordered") {
  const auto shape = [](Vec3 p) { return length(p - Vec3(12, 12, 12)) <= 8 || (p.y == 12 && p.z == 12) ? 1.0 : 0.0; };
  const auto d = image_of<uint8_t>({40, 25, 25}, shape);
  const auto open = morph(d, Morphology::open, 2);
  CHECK(array_of(open, "v").get(35 + 40 * (12 + 25 * 12)) == 0);
  CHECK(array_of(open, "v").get(12 + 40 * (12 + 25 * 12)) == 1);
  const auto slit = image_of<uint8_t>({25, 25, 9}, [](Vec3 p) { return p.x == 12 ? 0.0 : p.x < 12 ? 2.0 : 3.0; });
  CHECK(count(morph(slit, Morphology::close, 1.5), "v", 0) == 0);
  CHECK(count(morph(slit, Morphology::open, 3), "v", 2) == 12 * 25 * 9);  // the border of the image does not erode

  const auto noise = image_of<uint8_t>({24, 24, 24}, [](Vec3 p) { return hash(p, 9) < 0.6 ? 1.0 : 0.0; });
  const auto opened = morph(noise, Morphology::open, 1), closed = morph(noise, Morphology::close, 1),
             again = morph(opened, Morphology::open, 1);
  size_t outside = 0, changed = 0;
  for (size_t i = 0; i < noise->point_count(); ++i) {
    outside += array_of(opened, "v").get(i) > array_of(noise, "v").get(i) || array_of(noise, "v").get(i) > array_of(closed, "v").get(i);
    changed += array_of(opened, "v").get(i) != array_of(again, "v").get(i);
  }
  CHECK(outside == 0);
  CHECK(changed == 0);
}

TEST_CASE("morphology: holes are filled with the label around them, unless they are open or too large") {
  const auto shell = [](Vec3 p) {
    const double r = length(p - Vec3(10, 10, 10));
    return r > 8 ? 0.0 : r > 5 ? 4.0 : 0.0;
  };
  const auto d = image_of<float>({21, 21, 21}, shell);
  MorphologyParams p;
  p.operation = Morphology::fill;
  Context context;
  const auto filled = morphology(d, p, context);
  CHECK(array_of(filled, "v").get(10 + 21 * (10 + 21 * 10)) == 4);
  CHECK(array_of(filled, "v").get(0) == 0);
  p.max_size = 10;
  CHECK(array_of(morphology(d, p, context), "v").get(10 + 21 * (10 + 21 * 10)) == 0);
  p.max_size = 0;
  const auto plane = image_of<uint8_t>({9, 9, 1}, [](Vec3 q) { return std::max(std::abs(q.x - 4), std::abs(q.y - 4)) == 3 ? 1.0 : 0.0; });
  CHECK(count(morphology(plane, p, context), "v", 1) == 49);
}

TEST_CASE("morphology: samples without a value stay, and intensities are no labels") {
  const auto d = image_of<float>({5, 5, 1}, [](Vec3 p) { return p.x == 2 ? double(NAN) : p.x < 2 ? 1.0 : 0.0; });
  const auto r = morph(d, Morphology::dilate, 10);
  CHECK(std::isnan(array_of(r, "v").get(2)));
  CHECK(array_of(r, "v").get(4) == 1);
  CHECK(count(morph(d, Morphology::erode, 1), "v", 1) == 10);
  const auto grey = image_of<float>({5, 5, 1}, [](Vec3 p) { return p.x * 0.3; });
  CHECK(test::error_of([&] { morph(grey, Morphology::open, 1); }).find("not a label field") != std::string::npos);
}

TEST_CASE("label components: faces, edges and corners, in space and in the plane") {
  // Three samples in a chain over a corner and an edge, and one apart.
  const auto chain = [](Vec3 p) {
    return p == Vec3(1, 1, 1) || p == Vec3(2, 2, 2) || p == Vec3(2, 3, 3) || p == Vec3(6, 6, 6) ? 1.0 : 0.0;
  };
  const auto d = image_of<uint8_t>({8, 8, 8}, chain);
  for (const auto& [connectivity, parts] : {std::pair{6, 4}, {18, 3}, {26, 2}}) {
    LabelComponentsParams p;
    p.connectivity = connectivity;
    CHECK(array_of(components_of(d, p), "component sizes").count() == size_t(parts));
  }
  const auto diagonal = image_of<uint8_t>({4, 4, 1}, [](Vec3 p) { return p.x == p.y ? 1.0 : 0.0; });
  LabelComponentsParams p;
  CHECK(array_of(components_of(diagonal, p), "component sizes").count() == 4);
  p.connectivity = 18;
  CHECK(array_of(components_of(diagonal, p), "component sizes").count() == 1);
  p.connectivity = 7;
  CHECK(test::error_of([&] { components_of(diagonal, p); }).find("6, 18 or 26") != std::string::npos);
}

TEST_CASE("label components: equal to flooding sample by sample on random labels, for any number of threads") {
  const auto d = image_of<int16_t>({31, 23, 40}, [](Vec3 p) { return std::floor(3 * hash(p, 3)) - 1; });
  for (const int connectivity : {6, 18, 26}) {
    LabelComponentsParams p;
    p.connectivity = connectivity;
    const auto r = components_of(d, p);
    const Array &v = array_of(d, "v"), &c = array_of(r, "component");
    // Neighbours of one label have one number, and each part is one flood.
    std::vector<uint8_t> seen(v.count(), 0);
    size_t floods = 0, wrong = 0;
    for (size_t s = 0; s < v.count(); ++s) {
      if (v.get(s) == 0) wrong += c.get(s) != 0;
      if (v.get(s) == 0 || seen[s]) continue;
      ++floods;
      std::vector<size_t> stack{s};
      seen[s] = 1;
      size_t size = 0;
      while (!stack.empty()) {
        const size_t i = stack.back();
        stack.pop_back();
        ++size;
        wrong += c.get(i) != c.get(s);
        for (int n = 0; n < 27; ++n) {
          const int x = n % 3 - 1, y = n / 3 % 3 - 1, z = n / 9 - 1, far = std::abs(x) + std::abs(y) + std::abs(z);
          if (far == 0 || far > (connectivity == 6 ? 1 : connectivity == 18 ? 2 : 3)) continue;
          const size_t a = i % 31 + size_t(x), b = i / 31 % 23 + size_t(y), e = i / 713 + size_t(z);
          if (a >= 31 || b >= 23 || e >= 40) continue;
          const size_t j = a + 31 * (b + 23 * e);
          if (!seen[j] && v.get(j) == v.get(s)) seen[j] = 1, stack.push_back(j);
        }
      }
      wrong += array_of(r, "component sizes").get(size_t(c.get(s)) - 1) != double(size);
    }
    CHECK(wrong == 0);
    CHECK(floods == array_of(r, "component sizes").count());
    CHECK(test::same_for_threads("component", [&] { return components_of(d, p); }));
  }
}

TEST_CASE("label components: the largest, the small, labels together, nothing at all") {
  const auto d = image_of<uint8_t>({12, 3, 1}, [](Vec3 p) { return p.x < 5 ? 1.0 : p.x < 7 ? 2.0 : p.x == 9 ? 3.0 : 0.0; });
  LabelComponentsParams p;
  p.keep = 1;
  CHECK(count(components_of(d, p), "component", 1) == 15);
  CHECK(count(components_of(d, p), "component", 2) == 0);
  p.keep = 0, p.min_size = 4;
  CHECK(array_of(components_of(d, p), "component sizes").count() == 2);
  p.min_size = 1, p.by_label = false;
  CHECK(array_of(components_of(d, p), "component sizes").get(0) == 21);
  p.labels = {99};
  CHECK(array_of(components_of(d, p), "component sizes").count() == 0);
}
