// SPDX-License-Identifier: Apache-2.0
// LIC along eigenvectors: statistics (F9), circles without seams, creases, isotropic places, and what is refused.
#include "filter/tensor/lines/tensor_lic.h"

#include <functional>

#include "filter/flow/texture/surface/surface_lic.h"
#include "filter/flow/texture/surface/surface_walk.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

using Tensors = std::function<SymTensor(Vec3)>;

/// Triangles with tensors on points or triangles; `flow` as well where it is given.
DatasetPtr triangles(const std::vector<Vec3>& points, std::vector<int32_t> corners, const Tensors& tensors,
                     Association on = Association::point, const std::function<Vec3(Vec3)>& flow = {}) {
  SurfaceMesh m;
  std::vector<double> xyz, v;
  std::vector<SymTensor> d;
  for (const Vec3& p : points)
    for (int c = 0; c < 3; ++c) xyz.push_back(p[c]);
  std::vector<Vec3> at = points;
  if (on == Association::cell) {
    at.clear();
    for (size_t t = 0; t < corners.size() / 3; ++t)
      at.push_back((points[size_t(corners[3 * t])] + points[size_t(corners[3 * t + 1])] + points[size_t(corners[3 * t + 2])]) / 3.0);
  }
  FieldSet f;
  for (const Vec3& p : at) d.push_back(tensors(p));
  f.add(tensor_field(d, on));
  if (flow) {
    for (const Vec3& p : at)
      for (int c = 0; c < 3; ++c) v.push_back(flow(p)[c]);
    f.add({"v", on, Array::from_vector(std::move(v), 3), "", Role::vectors});
  }
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons.connectivity = Array::from_vector(std::move(corners)), m.polygons.fixed = 3;
  return make_dataset(m, f);
}

/// n x n unit squares from the origin, each two triangles; corners[0] is any of the three, so that the frames of triangles differ.
DatasetPtr plane(int n, const Tensors& tensors, const std::function<Vec3(Vec3)>& flow = {}, Association on = Association::point) {
  std::vector<Vec3> p;
  std::vector<int32_t> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) p.push_back({double(i), double(j), 0});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
      if (random_unit(9, uint64_t(j * n + i)) < 0.5) t.insert(t.end(), {b, d, a, c, d, b});
      else t.insert(t.end(), {a, b, c, c, d, a});
    }
  return triangles(p, t, tensors, on, flow);
}

DatasetPtr globe(int n, const Tensors& tensors) {
  std::vector<Vec3> p;
  std::vector<int32_t> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const double th = M_PI * j / n, ph = M_PI * i / n;
      p.push_back({std::sin(th) * std::cos(ph), std::sin(th) * std::sin(ph), std::cos(th)});
      if (j == n) continue;
      const int a = j * 2 * n + i, b = j * 2 * n + (i + 1) % (2 * n);
      t.insert(t.end(), {a, a + 2 * n, b + 2 * n, a, b + 2 * n, b});
    }
  return triangles(p, t, tensors);
}

TensorLicParams plain(int steps, int eigenvector = 1) {
  TensorLicParams p;
  p.eigenvector = eigenvector, p.density = 0, p.steps = steps, p.step = 1, p.kernel = LineFade::box, p.stretch = false;
  return p;
}

DatasetPtr run(const DatasetPtr& d, const TensorLicParams& p) {
  Context context;
  return tensor_lic(d, p, context);
}
View<float> lic_of(const DatasetPtr& d) { return d->fields().require("lic", Association::point).array.view<float>(); }

/// Tangents of circles around c, and the tensor with them as its main eigenvector.
Vec3 tangent(Vec3 p, Vec3 c) {
  const Vec3 r{-(p.y - c.y), p.x - c.x, 0};
  return length(r) > 0 ? r / length(r) : Vec3{};
}

}  // namespace

TEST_CASE("tensor_lic: on a plane the variance is 1/L, the correlation 1 - k/L along the eigenvector and 0 across (F9)") {
  const int n = 512, steps = 10, L = 2 * steps + 1;
  // Eigenvalues 3 along x, -1 along y, and 20 across the plane, which must not count.
  const DatasetPtr d = plane(n, [](Vec3) { return diagonal(3, -1, 20); });
  for (const int which : {1, 2}) {
    const DatasetPtr r = run(d, plain(steps, which));
    const View<float> v = lic_of(r);
    const auto at = [&](int i, int j) { return double(v[size_t(j * (n + 1) + i)]); };
    double mean = 0, square = 0, count = 0;
    for (int j = L; j <= n - L; ++j)
      for (int i = L; i <= n - L; ++i, ++count) mean += at(i, j), square += at(i, j) * at(i, j);
    mean /= count;
    const double variance = square / count - mean * mean;
    CHECK(mean == doctest::Approx(0.5).epsilon(0.01));
    CHECK(variance == doctest::Approx(1.0 / 12 / L).epsilon(0.03));
    for (const int k : {3, 7, 14, 20, 40}) {
      double along = 0, across = 0, pairs = 0;
      for (int j = L; j <= n - L - 40; ++j)
        for (int i = L; i <= n - L - 40; ++i, ++pairs) {
          const double a = at(i, j) - mean, x = at(i + k, j) - mean, y = at(i, j + k) - mean;
          along += a * (which == 2 ? y : x), across += a * (which == 2 ? x : y);
        }
      CHECK(along / pairs / variance == doctest::Approx(std::max(0.0, 1 - double(k) / L)).epsilon(0.03).scale(1));
      CHECK(std::abs(across / pairs / variance) < 0.03);
    }
  }
}

TEST_CASE("tensor_lic: a constant tensor gives the texture of its eigenvector, whatever its angle and size, on points and on cells") {
  const int n = 28;
  Listener quiet;
  for (const double angle : {0.3, 1.2, 1.5707, 2.0, 2.9})
    for (const double size : {1.0, 1e-200, 1e200})
      for (const Association on : {Association::point, Association::cell}) {
        const Vec3 e{std::cos(angle), std::sin(angle), 0}, other{-e.y, e.x, 0};
        const DatasetPtr d = plane(
            n, [&](Vec3) { return outer(e, 2 * size) + outer(other, -1 * size); }, [&](Vec3) { return e; }, on);
        SurfaceLicParams q;
        q.density = 0, q.steps = 12, q.step = 1;
        TensorLicParams p;
        p.density = 0, p.steps = 12, p.step = 1;
        const DatasetPtr a = run(d, p), b = surface_lic(d, q, quiet.context);
        double worst = 0;
        int cut = 0;  // corners of the plane that lines only touch: noise here, neutral there
        for (size_t i = 0; i < a->point_count(); ++i)
          if (lic_of(b)[i] == 0.5f) ++cut;
          else worst = std::max(worst, double(std::abs(lic_of(a)[i] - lic_of(b)[i])));
        CHECK(worst < 1e-5);
        CHECK(cut <= 2);
      }
}

TEST_CASE("tensor_lic: circles have no seam where stored eigenvectors change their sign") {
  const int n = 96;
  const Vec3 c{48.3, 47.9, 0};
  const auto turning = [&](Vec3 p) { return outer(tangent(p, c)); };
  const DatasetPtr d = plane(n, turning, [&](Vec3 p) { return tangent(p, c); });
  Listener quiet;
  SurfaceLicParams q;
  q.density = 0, q.steps = 30, q.step = 0.5;
  TensorLicParams p;
  p.density = 0, p.steps = 30, p.step = 0.5;
  const DatasetPtr a = run(d, p), b = surface_lic(d, q, quiet.context);
  // Everywhere outside of the middle the texture of the vectors, also along the axes, where the eigenvectors' signs are cut.
  double worst_axis = 0, sum = 0, count = 0;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const Vec3 r = Vec3{double(i), double(j), 0} - c;
      if (length(r) < 8) continue;
      const double apart = std::abs(double(lic_of(a)[size_t(j * (n + 1) + i)]) - double(lic_of(b)[size_t(j * (n + 1) + i)]));
      sum += apart, ++count;
      if (std::min(std::abs(r.x), std::abs(r.y)) < 1) worst_axis = std::max(worst_axis, apart);
    }
  CHECK(sum / count < 0.01);
  CHECK(worst_axis < 0.1);

  // Around once, both ways: the line is back, and has turned by 360 degrees on its way.
  Context context;
  const RefinedSurface s = refine_surface(d, 0, 1 << 20, context);
  std::vector<SymTensor> t;
  for (const Vec3& x : s.points) t.push_back(turning(x));
  const SurfaceAxisWalk walk(s, t, false);
  int lines = 0;
  for (uint32_t k = 0; k < s.triangles.size(); k += 301) {
    const Vec3 from = s.points[s.triangles[k][0]];
    const double radius = length(from - c);
    if (radius < 15 || radius > 45) continue;
    for (const int way : {-1, 1}) {
      SurfaceAxisWalk::Place at = walk.start(k, s.triangles[k][0]);
      double turned = 0;
      for (int i = 0; i < 64; ++i) {
        const Vec3 before = walk.position(at) - c;
        REQUIRE(walk.advance(at, 2 * M_PI * radius / 64, way));
        const Vec3 after = walk.position(at) - c;
        turned += std::atan2(cross(before, after).z, dot(before, after));
      }
      CHECK(std::abs(turned) == doctest::Approx(2 * M_PI).epsilon(0.002));
      CHECK(length(walk.position(at) - from) < 0.3);
      ++lines;
    }
  }
  CHECK(lines > 60);
}

TEST_CASE("tensor_lic: eigenvector 2 of a turning tensor runs straight out") {
  const int n = 64;
  const Vec3 c{32, 32, 0};
  const DatasetPtr d = plane(n, [&](Vec3 p) { return outer(tangent(p, c)); });
  Context context;
  const RefinedSurface s = refine_surface(d, 0, 1 << 20, context);
  std::vector<SymTensor> t;
  for (const Vec3& x : s.points) t.push_back(outer(tangent(x, c), -1));
  const SurfaceAxisWalk walk(s, t, false);
  int lines = 0;
  for (uint32_t k = 0; k < s.triangles.size(); k += 101) {
    const Vec3 from = s.points[s.triangles[k][0]] - c;
    if (length(from) < 14 || length(from) > 22) continue;
    double length_after[2];
    for (const int way : {0, 1}) {
      SurfaceAxisWalk::Place at = walk.start(k, s.triangles[k][0]);
      for (int i = 0; i < 16; ++i) REQUIRE(walk.advance(at, 0.5, way == 0 ? -1 : 1));
      const Vec3 to = walk.position(at) - c;
      CHECK(dot(from, to) / length(from) / length(to) > 1 - 1e-4);
      length_after[way] = length(to) - length(from);
    }
    CHECK(std::abs(length_after[0]) == doctest::Approx(8).epsilon(0.001));
    CHECK(length_after[0] * length_after[1] < 0);  // one in, one out
    ++lines;
  }
  CHECK(lines > 10);
}

TEST_CASE("tensor_lic: lines go on across creases, right angles too, as on the unfolded surface") {
  for (const int sides : {3, 4, 6}) {
    const double side = 2 * std::sin(M_PI / sides);
    std::vector<Vec3> p;
    std::vector<int32_t> corners;
    for (int k = 0; k < sides; ++k)
      for (const double z : {0.0, 30.0}) p.push_back({std::cos(2 * k * M_PI / sides), std::sin(2 * k * M_PI / sides), z});
    for (int k = 0; k < sides; ++k) {
      const int a = 2 * k, b = 2 * ((k + 1) % sides);
      corners.insert(corners.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
    Context context;
    const RefinedSurface prism =
        refine_surface(triangles(p, corners, [](Vec3) { return SymTensor{1, 0, 0, 0, 0, 0}; }), 0.7, 1 << 20, context);
    for (const double slope : {0.0, 0.5, 20.0}) {
      std::vector<SymTensor> around;
      for (const auto& t : prism.triangles) {
        const Vec3 c = (prism.points[t[0]] + prism.points[t[1]] + prism.points[t[2]]) / 3.0;
        const double middle = (std::floor(std::atan2(c.y, c.x) / (2 * M_PI / sides)) + 0.5) * 2 * M_PI / sides;
        around.push_back(outer({-std::sin(middle), std::cos(middle), slope}));
      }
      const SurfaceAxisWalk helix(prism, around, true);
      uint32_t start = 0;
      for (uint32_t t = 0; t < prism.triangles.size(); ++t)  // half way up
        if (std::abs(prism.points[prism.triangles[t][0]].z - 15) < 0.5) start = t;
      SurfaceAxisWalk::Place at = helix.start(start, prism.triangles[start][0]);
      const Vec3 from = helix.position(at);
      // Twice around; when steep 10 up or down, almost along the edges.
      const double around_by = slope > 1 ? 10 / slope : 2 * sides * side;
      REQUIRE(helix.advance(at, around_by * std::sqrt(1 + slope * slope), 1));
      const Vec3 to = helix.position(at);
      CHECK(std::abs(std::abs(to.z - from.z) - around_by * slope) < 1e-6);
      if (slope < 1) CHECK(std::hypot(to.x - from.x, to.y - from.y) < 1e-6);
    }
  }
}

TEST_CASE("tensor_lic: on a sphere the texture of the latitudes' tensor is constant along them, that of the other along meridians") {
  const DatasetPtr d = globe(40, [](Vec3 p) { return outer(tangent(p, {0, 0, 0}), 2) + outer(p, 50); });  // 50 across the surface
  for (const int which : {1, 2}) {
    TensorLicParams p = plain(which == 1 ? 400 : 15, which);
    p.step = 0.05;
    CAPTURE(which);
    const DatasetPtr r = run(d, p);
    const View<float> v = lic_of(r);
    double along = 0, across = 0;  // squared differences of neighbours
    for (int j = 12; j < 28; ++j)
      for (int i = 0; i < 80; ++i) {
        const double a = double(v[size_t(j * 80 + i)]), b = double(v[size_t(j * 80 + (i + 1) % 80)]),
                     c = double(v[size_t((j + 1) * 80 + i)]);
        (which == 1 ? along : across) += (a - b) * (a - b), (which == 1 ? across : along) += (a - c) * (a - c);
      }
    CHECK(along < 0.2 * across);
  }
}

TEST_CASE("tensor_lic: isotropic tensors keep the noise or are gray, and the texture fades towards them") {
  const int n = 64;
  const DatasetPtr same = plane(n, [](Vec3) { return diagonal(0.1, 0.1, 7); });
  TensorLicParams p = plain(5);
  DatasetPtr r = run(same, p);
  size_t noise = 0;
  for (size_t i = 0; i < r->point_count(); ++i) noise += lic_of(r)[i] == float(random_unit(1, i));
  CHECK(noise == r->point_count());
  const View<float> measure = r->fields().require("in-plane anisotropy", Association::point).array.view<float>();
  CHECK(measure[77] < 1e-12f);
  p.isotropic = IsotropicLook::gray;
  r = run(same, p);
  for (size_t i = 0; i < r->point_count(); ++i) REQUIRE(lic_of(r)[i] == 0.5f);
  // Zero tensors too.
  r = run(plane(8, [](Vec3) { return SymTensor{}; }), plain(5));
  for (size_t i = 0; i < r->point_count(); ++i) REQUIRE(lic_of(r)[i] == float(random_unit(1, i)));

  // (1 + a) and (1 - a) have the anisotropy a, here growing from 0 at the left to 0.64 at the right; full from 0.32 on.
  const DatasetPtr growing = plane(n, [](Vec3 q) { return diagonal(1 + q.x / 100, 1 - q.x / 100, 0); });
  TensorLicParams f = plain(20);
  f.kernel = LineFade::hann, f.fade = 0.32;
  const auto column_variance = [&](const DatasetPtr& d, int i) {
    double mean = 0, square = 0;
    for (int j = 0; j <= n; ++j) {
      const double x = double(lic_of(d)[size_t(j * (n + 1) + i)]);
      mean += x / (n + 1), square += x * x / (n + 1);
    }
    return square - mean * mean;
  };
  r = run(growing, f);
  CHECK(r->fields().require("in-plane anisotropy", Association::point).array.view<float>()[40] == doctest::Approx(0.4));
  CHECK(column_variance(r, 0) > 0.06);  // plain noise has 1/12
  CHECK(column_variance(r, 48) < 0.01);
  f.isotropic = IsotropicLook::gray;
  const DatasetPtr gray = run(growing, f);
  CHECK(column_variance(gray, 1) < 1e-4);
  for (int j = 0; j <= n; ++j) CHECK(lic_of(gray)[size_t(j * (n + 1) + 40)] == lic_of(r)[size_t(j * (n + 1) + 40)]);
  // Without fading the lines are as long everywhere that a direction is.
  f.fade = 0;
  CHECK(column_variance(run(growing, f), 5) < 0.02);
}

TEST_CASE("tensor_lic: NaN tensors are neutral, lines end there; flat grids and skins of solids carry the texture") {
  const DatasetPtr holes =
      run(plane(16, [](Vec3 p) { return p.x < 8 ? SymTensor{NAN, NAN, NAN, NAN, NAN, NAN} : diagonal(1, 0, 0); }), plain(5));
  for (int j = 0; j <= 16; ++j)
    for (int i = 0; i <= 16; ++i) {
      const float x = lic_of(holes)[size_t(j * 17 + i)];
      REQUIRE((i < 8) == (x == 0.5f));
      REQUIRE((x >= 0 && x <= 1));
    }
  CHECK(holes->fields()[0].name == "lic");
  const DatasetPtr flat = tensor_grid({33, 17, 1}, {0, 0, 0}, {32, 16, 0}, [](Vec3) { return diagonal(2, 1, 0); });
  TensorLicParams p;
  p.density = 100, p.steps = 8;
  const DatasetPtr r = run(flat, p);
  CHECK(r->as<SurfaceMesh>());
  CHECK(r->point_count() > 2000);
  CHECK(r->fields().find("tensor", Association::point));
  const DatasetPtr solid = run(tensor_grid({5, 5, 5}, {0, 0, 0}, {1, 1, 1}, [](Vec3) { return diagonal(3, 2, 1); }), p);
  size_t outside = 0;
  for (size_t i = 0; i < solid->point_count(); ++i) outside += !(lic_of(solid)[i] >= 0 && lic_of(solid)[i] <= 1);
  CHECK(outside == 0);
  CHECK(solid->bounds().hi.z == 1);
}

TEST_CASE("tensor_lic: 1 and 8 threads give the same bytes") {
  const DatasetPtr d = globe(12, [](Vec3 p) { return outer({std::sin(3 * p.z), p.x, p.y}) + outer({p.z, 0.3, 0}, -0.5); });
  for (const IsotropicLook isotropic : {IsotropicLook::noise, IsotropicLook::gray}) {
    TensorLicParams p;
    p.density = 80, p.steps = 8, p.isotropic = isotropic, p.fade = 0.3;
    const auto [one, eight] = with_threads([&] { return run(d, p); });
    CHECK(one->point_count() > 5000);
    CHECK(equal_fields(*one, *eight));
  }
}

TEST_CASE("tensor_lic: what is no tensor, no surface or too fine is refused, asymmetric tensors are named once") {
  const DatasetPtr d = plane(
      4, [](Vec3) { return diagonal(2, 1, 0); },
      [](Vec3) {
        return Vec3{1, 0, 0};
      });
  TensorLicParams p;
  p.tensors.field = {"v"};
  CHECK_THROWS_WITH_AS(run(d, p), doctest::Contains("'v' holds vectors"), Error);
  p.tensors.field = {"tensr"};
  CHECK_THROWS_AS(run(d, p), Error);
  DatasetParts parts = d->parts();
  parts.fields = {};
  parts.fields.add(d->fields().require("v"));
  CHECK_THROWS_WITH_AS(run(make_dataset(parts), {}), doctest::Contains("no tensor field"), Error);
  parts.fields.add({"s", Association::point, Array::from_vector<float>(std::vector<float>(25, 1.0f)), ""});
  p.tensors.field = {"s"};
  CHECK_THROWS_WITH_AS(run(make_dataset(parts), p), doctest::Contains("not a tensor"), Error);
  // 2D tensors on a sphere.
  DatasetParts round = globe(4, [](Vec3) { return SymTensor{}; })->parts();
  round.fields = {};
  round.fields.add({"t", Association::point, Array::from_vector<float>(std::vector<float>(4 * 40, 1.0f), 4), ""});
  CHECK_THROWS_WITH_AS(run(make_dataset(round), {}), doctest::Contains("xy-plane"), Error);
  p = {};
  p.density = 1e5;
  CHECK_THROWS_WITH_AS(run(d, p), doctest::Contains("density"), Error);
  CHECK_THROWS_WITH_AS(run(tensor_points({diagonal(1, 2, 3)}), {}), doctest::Contains("faces"), Error);

  DatasetParts skew = d->parts();
  skew.fields = {};
  std::vector<double> v;
  for (int i = 0; i < 25; ++i) v.insert(v.end(), {1, 1, 0, 0, 0, 0, 0, 0, 0});
  skew.fields.add({"t", Association::point, Array::from_vector(std::move(v), 9), ""});
  Listener heard;
  tensor_lic(make_dataset(skew), plain(5), heard.context);
  CHECK(heard.warnings.find("25 of 25") != std::string::npos);
  CHECK(heard.warnings.find("not symmetric") == heard.warnings.rfind("not symmetric"));
}
