// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/lic.h"

#include <algorithm>

#include "filter/mesh/to_unstructured.h"
#include "texture_support.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr along_x(size_t n, size_t m) {
  return flow_2d(n, m, [](double, double, float* u) { u[0] = 2; });
}

DatasetPtr texture_of(const DatasetPtr& d, LicParams p, const DatasetPtr& image = nullptr) {
  Context c;
  if (p.resolution == 0) p.resolution = int64_t(std::max(d->as<UniformGrid>()->dims[0], d->as<UniformGrid>()->dims[1]));
  return lic(d, image, p, c);
}

DatasetPtr picture(size_t n, size_t m, const std::function<float(double, double)>& f) {
  UniformGrid g;
  g.dims = {n, m, 1};
  std::vector<float> v;
  for (size_t j = 0; j < m; ++j)
    for (size_t i = 0; i < n; ++i) v.push_back(f(double(i), double(j)));
  FieldSet fields;
  fields.add({"picture", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(g, fields);
}

}  // namespace

TEST_CASE("lic: white noise keeps 1/L of its variance, and neighbours along the flow share what they share") {
  const DatasetPtr d = along_x(512, 512);
  for (const char* method : {"plain", "fast"})
    for (const int half : {5, 10, 20}) {
      CAPTURE(method);
      CAPTURE(half);
      LicParams p;
      p.length = half, p.contrast = texture::Contrast::none, p.method = *value_of_word<LicMethod>(method);
      const std::vector<float> v = values_of(texture_of(d, p), "lic");
      const Statistics s{v, 512, 512, 32};
      const double L = 2 * half + 1;
      CHECK(s.mean() == doctest::Approx(0.5).epsilon(0.01));
      CHECK(std::abs(s.covariance(0, 0) * 12 * L - 1) < 0.03);
      for (const size_t k : {size_t(1), size_t(half / 2), size_t(half), size_t(2 * half)})
        CHECK(std::abs(s.correlation(k, 0) - (1 - double(k) / L)) < 0.03);
      CHECK(std::abs(s.correlation(size_t(2 * half + 1), 0)) < 0.03);
      for (const size_t k : {1, 2, 7}) CHECK(std::abs(s.correlation(0, k)) < 0.03);
    }
}

TEST_CASE("lic: both methods give the same along straight rows, and alike pictures elsewhere") {
  LicParams p;
  p.length = 12, p.contrast = texture::Contrast::none;
  LicParams fast = p;
  fast.method = LicMethod::fast;
  const DatasetPtr rows = along_x(300, 200);
  const std::vector<float> a = values_of(texture_of(rows, p), "lic"), b = values_of(texture_of(rows, fast), "lic");
  float most = 0;
  for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  CHECK(most < 1e-6f);
  // A line that passes a pixel at the distance d < 1/2 from its middle meets the same pixels as the middle's own with probability 1 - d:
  // three quarters in the mean.
  const DatasetPtr turning = rotation(400);
  for (const char* kernel : {"box", "hanning", "ripple"}) {
    p.kernel = fast.kernel = *value_of_word<texture::LineWeights>(kernel);
    const std::vector<float> c = values_of(texture_of(turning, p), "lic"), e = values_of(texture_of(turning, fast), "lic");
    CAPTURE(kernel);
    CHECK(correlation_of(c, e) > 0.75);
    const Statistics sc{c, 400, 400, 0}, se{e, 400, 400, 0};
    CHECK(se.mean() == doctest::Approx(sc.mean()).epsilon(0.01));
    CHECK(se.covariance(0, 0) == doctest::Approx(sc.covariance(0, 0)).epsilon(0.25));
  }
}

TEST_CASE("lic: what is the same along circles stays when the flow turns in circles") {
  const size_t n = 301;
  const DatasetPtr rings = picture(n, n, [](double x, double y) { return float(std::sin(std::hypot(x - 150, y - 150) / 6)); });
  for (const char* method : {"plain", "fast"}) {
    LicParams p;
    p.length = 60, p.contrast = texture::Contrast::none, p.method = *value_of_word<LicMethod>(method);
    const std::vector<float> v = values_of(texture_of(rotation(n), p, rings), "lic"), r = values_of(rings, "picture");
    double most = 0, squares = 0, count = 0;
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const double radius = std::hypot(double(i) - 150, double(j) - 150);
        if (radius < 8 || radius > 149) continue;
        const double e = std::abs(double(v[i + n * j]) - double(r[i + n * j]));
        most = std::max(most, e), squares += e * e, count += 1;
      }
    CAPTURE(method);
    // Places are rounded to pixels: up to half a pixel, where the slope is 1/6 per pixel; averaged over many places much less.
    CHECK(most < 0.1);
    CHECK(std::sqrt(squares / count) < 0.02);
  }
}

TEST_CASE("lic: constant noise stays constant, whatever the kernel, up to the border") {
  const DatasetPtr even = picture(120, 90, [](double, double) { return 0.3f; });
  const DatasetPtr d = flow_2d(120, 90, [](double x, double y, float* u) { u[0] = float(std::sin(y / 9)), u[1] = float(std::cos(x / 7)); });
  for (const char* kernel : {"box", "hanning", "ripple"})
    for (const char* method : {"plain", "fast"}) {
      LicParams p;
      p.kernel = *value_of_word<texture::LineWeights>(kernel), p.method = *value_of_word<LicMethod>(method),
      p.contrast = texture::Contrast::none, p.phase = 0.3;
      float most = 0;
      for (const float x : values_of(texture_of(d, p, even), "lic")) most = std::max(most, std::abs(x - 0.3f));
      CAPTURE(kernel);
      CAPTURE(method);
      CHECK(most < 1e-5f);
    }
}

TEST_CASE("lic: the waves of the ripple kernel move downstream, and phase 1 is phase 0") {
  const DatasetPtr d = along_x(400, 60);
  LicParams p;
  p.kernel = texture::LineWeights::ripple, p.length = 30, p.ripples = 2, p.contrast = texture::Contrast::none;
  auto frame = [&](double phase) {
    p.phase = phase;
    return values_of(texture_of(d, p), "lic");
  };
  const std::vector<float> first = frame(0), next = frame(0.125), end = frame(1);
  CHECK(same_bytes(first, end));
  CHECK(!same_bytes(first, next));
  // The wave moves an eighth of its length (61/2 pixels): 4 pixels to the right.
  auto shifted = [&](int by) {
    std::vector<float> a, b;
    for (size_t j = 0; j < 60; ++j)
      for (int i = 60; i < 340; ++i) a.push_back(first[size_t(i) + 400 * j]), b.push_back(next[size_t(i + by) + 400 * j]);
    return correlation_of(a, b);
  };
  int best = -20;
  for (int by = -20; by <= 20; ++by)
    if (shifted(by) > shifted(best)) best = by;
  CHECK(best >= 2);
  CHECK(best <= 5);
}

TEST_CASE("lic: the same bytes for one thread and eight") {
  const DatasetPtr d = flow_2d(401, 333, [](double x, double y, float* u) {
    u[0] = float(std::sin(y / 31) + 0.3), u[1] = float(std::cos(x / 23));
    if (std::hypot(x - 200, y - 100) < 20) u[0] = u[1] = 0;
    if (x > 300 && x < 310 && y > 200) u[0] = NAN;
  });
  for (const char* method : {"plain", "fast"})
    for (const char* contrast : {"stretch", "equalise"}) {
      LicParams p;
      p.method = *value_of_word<LicMethod>(method), p.contrast = *value_of_word<texture::Contrast>(contrast), p.grain = 1.5, p.passes = 2;
      set_thread_count(1);
      const std::vector<float> one = values_of(texture_of(d, p), "lic");
      set_thread_count(8);
      const std::vector<float> eight = values_of(texture_of(d, p), "lic");
      set_thread_count(0);
      CHECK(same_bytes(one, eight));
    }
}

TEST_CASE("lic: no value where the flow has none, grey where it rests, the picture itself where it is smeared") {
  const DatasetPtr d = flow_2d(64, 48, [](double x, double y, float* u) {
    u[0] = x < 20 ? 0.0f : 1.0f;
    if (y > 40) u[1] = NAN;
  });
  LicParams p;
  const std::vector<float> v = values_of(texture_of(d, p), "lic");
  CHECK(v[5 + 64 * 10] == 0.5f);
  CHECK(std::isnan(v[30 + 64 * 44]));
  CHECK(v[40 + 64 * 10] >= 0);
  CHECK(v[40 + 64 * 10] <= 1);
  const DatasetPtr image = picture(64, 48, [](double x, double y) { return float(x + 100 * y); });
  const std::vector<float> w = values_of(texture_of(d, p, image), "lic");
  CHECK(!std::isnan(w[5 + 64 * 10]));
  p.still = 1.5;  // faster than anything
  for (const float x : values_of(texture_of(d, p), "lic")) CHECK((x == 0.5f || std::isnan(x)));
}

TEST_CASE("lic: the contrast spreads the greys") {
  const DatasetPtr d = rotation(256);
  LicParams p;
  p.contrast = texture::Contrast::equalise;
  const std::vector<float> v = values_of(texture_of(d, p), "lic");
  for (const double limit : {0.1, 0.5, 0.8}) {
    double below = 0;
    for (const float x : v) below += double(x) < limit;
    CHECK(below / double(v.size()) == doctest::Approx(limit).epsilon(0.02));
  }
  p.contrast = texture::Contrast::stretch;
  double black = 0, white = 0;
  for (const float x : values_of(texture_of(d, p), "lic")) black += x <= 0, white += x >= 1;
  CHECK(black / double(v.size()) == doctest::Approx(0.01).epsilon(0.1));
  CHECK(white / double(v.size()) == doctest::Approx(0.01).epsilon(0.1));
}

TEST_CASE("lic: vectors of two components, planes across any axis and turned grids give the same picture") {
  auto flow = [](double x, double y, float* u) { u[0] = float(std::sin(y / 20)), u[1] = float(std::cos(x / 15)); };
  const DatasetPtr three = flow_2d(150, 100, flow), two = flow_2d(150, 100, flow, 2);
  LicParams p;
  const std::vector<float> v = values_of(texture_of(three, p), "lic");
  CHECK(same_bytes(v, values_of(texture_of(two, p), "lic")));
  // x to y, y to z: an yz plane.
  UniformGrid g;
  g.dims = {1, 150, 100};
  const std::vector<float> u = values_of(three, "v");
  std::vector<float> moved(u.size());
  for (size_t i = 0; i < u.size(); i += 3) moved[i] = 9, moved[i + 1] = u[i], moved[i + 2] = u[i + 1];
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(moved), 3), "", Role::vectors});
  p.resolution = 150;
  CHECK(same_bytes(v, values_of(texture_of(make_dataset(g, fields), p), "lic")));
}

TEST_CASE("lic: coarse grids are refined, bent and broken ones sampled; the fields come along") {
  const DatasetPtr d = flow_2d(41, 21, [](double x, double y, float* u) { u[0] = float(1 + y / 10), u[1] = float(x / 40); });
  Context c;
  const DatasetPtr out = lic(d, nullptr, {}, c);
  const UniformGrid& g = *out->as<UniformGrid>();
  CHECK(g.dims == std::array<size_t, 3>{1041, 521, 1});  // times 26
  const std::vector<float> v = values_of(out, "v");
  CHECK(v[3 * (26 * 7 + 1041 * 26 * 5) + 0] == doctest::Approx(1.5));
  CHECK(g.origin + g.spacing * Vec3(1040, 520, 0) == Vec3(40, 20, 0));
  LicParams p;
  p.resolution = 201;
  CHECK(lic(d, nullptr, p, c)->as<UniformGrid>()->dims == std::array<size_t, 3>{201, 101, 1});

  // Two triangles: half a square is empty, and its cells are hidden.
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  mesh.cells.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2});
  mesh.cells.fixed = 3, mesh.single_type = CellType::triangle;
  FieldSet fields;
  fields.add({"w", Association::cell, Array::from_vector(std::vector<double>{1, 2, 0}, 3), "", Role::vectors});
  const DatasetPtr half = lic(make_dataset(mesh, fields), nullptr, p, c);
  const std::vector<float> t = values_of(half, "lic");
  CHECK(t[20 + 201 * 20] == t[20 + 201 * 20]);
  CHECK(std::isnan(t[180 + 201 * 180]));
  CHECK(half->cell_ghost().view<uint8_t>()[20 + 200 * 20] == 0);
  CHECK(half->cell_ghost().view<uint8_t>()[180 + 200 * 180] == ghost_hidden_cell);
}

TEST_CASE("lic: the same linear flow has the same texture on every kind of mesh") {
  const size_t n = 21;
  const DatasetPtr uniform = flow_2d(n, n, [](double x, double y, float* u) { u[0] = float(1 + 0.02 * y), u[1] = float(0.25 + 0.03 * x); });
  RectilinearGrid r;
  std::vector<double> axis;
  for (size_t i = 0; i < n; ++i) axis.push_back(double(i));
  r.x = Array::from_vector(std::vector<double>(axis)), r.y = Array::from_vector(std::vector<double>(axis));
  r.z = Array::from_vector(std::vector<double>{0});
  CurvilinearGrid c;
  c.dims = {n, n, 1};
  std::vector<float> xyz, bent;
  for (size_t j = 0; j < n; ++j)
    for (size_t i = 0; i < n; ++i) {
      // Inner points are shifted, and the linear flow with them.
      const bool inner = i > 0 && j > 0 && i + 1 < n && j + 1 < n;
      const double x = double(i) + (inner ? 0.2 * std::sin(double(3 * j + i)) : 0),
                   y = double(j) + (inner ? 0.2 * std::cos(double(5 * i)) : 0);
      xyz.insert(xyz.end(), {float(x), float(y), 0});
      bent.insert(bent.end(), {float(1 + 0.02 * y), float(0.25 + 0.03 * x), 0});
    }
  c.points.xyz = Array::from_vector(std::move(xyz), 3);
  FieldSet of_bent;
  of_bent.add({"v", Association::point, Array::from_vector(std::move(bent), 3), "", Role::vectors});
  const DatasetPtr curvilinear = make_dataset(c, of_bent);
  Context context;
  LicParams p;
  p.resolution = 201;
  const std::vector<float> wanted = values_of(lic(uniform, nullptr, p, context), "lic");
  for (const DatasetPtr& d : {make_dataset(r, uniform->fields()), curvilinear, to_unstructured(curvilinear, {}, context),
                              to_unstructured(uniform, {}, context)}) {
    CAPTURE(d->kind());
    CHECK(correlation_of(wanted, values_of(lic(d, nullptr, p, context), "lic")) > 0.97);
  }
}

TEST_CASE("lic: a solid grid gives a volume of texture that varies across the flow more than along it") {
  UniformGrid g;
  g.dims = {48, 40, 36};
  std::vector<float> u(3 * 48 * 40 * 36, 0.0f);
  for (size_t i = 1; i < u.size(); i += 3) u[i] = 1;  // along y
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(u), 3), "", Role::vectors});
  const DatasetPtr d = make_dataset(g, fields);
  for (const char* method : {"plain", "fast"}) {
    LicParams p;
    p.resolution = 48, p.length = 8, p.contrast = texture::Contrast::none, p.method = *value_of_word<LicMethod>(method),
    p.noise = LicNoise::white;
    const std::vector<float> v = values_of(texture_of(d, p), "lic");
    double along = 0, across = 0, n = 0;
    for (size_t k = 0; k + 1 < 36; ++k)
      for (size_t j = 10; j + 10 < 40; ++j)
        for (size_t i = 0; i + 1 < 48; ++i) {
          const size_t at = i + 48 * (j + 40 * k);
          auto square = [](double x) { return x * x; };
          along += square(double(v[at + 48]) - double(v[at])), across += square(double(v[at + 1]) - double(v[at])), n += 1;
        }
    // White noise, 17 samples: differences of neighbours are 2 (1/L) of a variance along and 2 across, over L.
    CHECK(along / across == doctest::Approx(1.0 / 17).epsilon(0.1));
    CHECK(across / n == doctest::Approx(2.0 / 12 / 17).epsilon(0.05));
  }
  LicParams p;
  p.noise = LicNoise::sparse, p.resolution = 48, p.density = 0.02, p.grain = 1;
  const std::vector<float> v = values_of(texture_of(d, p), "lic");
  double empty = 0;
  for (const float x : v) empty += x == 0;
  CHECK(empty / double(v.size()) == doctest::Approx(std::pow(0.98, 40)).epsilon(0.25));
}

TEST_CASE("lic: bad inputs are named") {
  Context c;
  LicParams p;
  CHECK(error_of([&] { lic(picture(8, 8, [](double, double) { return 1.0f; }), nullptr, p, c); }).find("no vector field") !=
        std::string::npos);
  p.field.name = "picture";
  CHECK(error_of([&] { lic(picture(8, 8, [](double, double) { return 1.0f; }), nullptr, p, c); }).find("1 component") != std::string::npos);
  p = {};
  CHECK(error_of([&] { lic(along_x(8, 1), nullptr, p, c); }).find("one axis") != std::string::npos);
  p.image.name = "x";
  CHECK(error_of([&] { lic(along_x(8, 8), nullptr, p, c); }).find("second input") != std::string::npos);
  CHECK(error_of([&] { lic(along_x(8, 8), along_x(8, 8), p, c); }).find("available: v") != std::string::npos);
  p = {};
  p.resolution = 100000;
  CHECK(error_of([&] { lic(along_x(8, 8), nullptr, p, c); }).find("2^31") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 1, 0}, 3);
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::vector<float>{1, 0, 0, 1, 0, 0}, 3), "", Role::vectors});
  p = {};
  CHECK(error_of([&] { lic(make_dataset(cloud, fields), nullptr, p, c); }).find("cannot carry a texture") != std::string::npos);
  bool warned = false;
  c.on_log = [&](LogLevel l, std::string_view) { warned = warned || l == LogLevel::warning; };
  lic(flow_2d(32, 32, [](double, double, float*) {}), nullptr, p, c);
  CHECK(warned);
}

TEST_CASE("lic: solid data get sparse strands and their speed without being asked, flat data white noise") {
  UniformGrid g;
  g.dims = {40, 30, 30};
  std::vector<float> u(3 * 40 * 30 * 30, 0.0f);
  for (size_t i = 1; i < u.size(); i += 3) u[i] = 3, u[i + 1] = 4;
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(u), 3), "m/s", Role::vectors});
  const DatasetPtr d = make_dataset(g, fields);
  LicParams p;
  p.resolution = 40;
  const DatasetPtr solid = texture_of(d, p);
  const std::vector<float> v = values_of(solid, "lic");
  CHECK(std::count(v.begin(), v.end(), 0.0f) > ptrdiff_t(v.size() / 2));
  CHECK(*std::max_element(v.begin(), v.end()) == 1);
  const Field& speed = solid->fields().require("speed");
  CHECK(speed.array.get(777) == doctest::Approx(5));
  CHECK(speed.unit == "m/s");
  const std::vector<float> flat = values_of(texture_of(along_x(64, 64), {}), "lic");
  CHECK(std::count(flat.begin(), flat.end(), 0.0f) < ptrdiff_t(flat.size() / 10));
}
