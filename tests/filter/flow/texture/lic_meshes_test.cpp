// SPDX-License-Identifier: Apache-2.0
// Statistics of textures on every kind of mesh (correctness.md F9).
#include "filter/every_mesh.h"
#include "filter/flow/texture/lic.h"
#include "filter/flow/texture/surface/surface_lic.h"
#include "texture_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Moments of a texture of up to three axes; NaN does not count, nor what lies within `margin` of the border.
struct Moments {
  std::vector<float> v;
  std::array<size_t, 3> n, margin;
  /// Mean of f(here, there) over all pairs that lie `step` apart along `axis`.
  template <class F>
  double mean_of(int axis, size_t step, F&& f) const {
    std::array<size_t, 3> s{0, 0, 0};
    s[size_t(axis)] = step;
    const size_t ahead = s[0] + n[0] * (s[1] + n[1] * s[2]);
    double sum = 0, count = 0;
    for (size_t k = margin[2]; k + s[2] + margin[2] < n[2]; ++k)
      for (size_t j = margin[1]; j + s[1] + margin[1] < n[1]; ++j)
        for (size_t i = margin[0]; i + s[0] + margin[0] < n[0]; ++i) {
          const float *a = &v[i + n[0] * (j + n[1] * k)], *b = a + ahead;
          if (*a == *a && *b == *b) sum += f(double(*a), double(*b)), count += 1;
        }
    return sum / count;
  }
  double mean() const {
    return mean_of(0, 0, [](double a, double) { return a; });
  }
  double covariance(int axis, size_t step) const {
    const double mu = mean();
    return mean_of(axis, step, [mu](double a, double b) { return (a - mu) * (b - mu); });
  }
};

/// White noise, even in [0, 1), averaged over L = 2 half + 1 samples along one axis.
void check_statistics(const Moments& m, int along, int across, size_t half, double exact) {
  const double L = double(2 * half + 1), variance = m.covariance(0, 0);
  CHECK(m.mean() == doctest::Approx(0.5).epsilon(0.02));
  CHECK(variance * 12 * L == doctest::Approx(1).epsilon(exact));
  for (const size_t k : {half / 2, half, 2 * half}) CHECK(std::abs(m.covariance(along, k) / variance - (1 - double(k) / L)) < exact);
  CHECK(std::abs(m.covariance(along, 2 * half + 1) / variance) < exact);
  for (const size_t k : {1, 5}) CHECK(std::abs(m.covariance(across, k) / variance) < exact);
}

/// The values of a field of a flat surface on its (n+1)^2 lattice of points over [-r,r]^2.
std::vector<float> on_lattice(const DatasetPtr& d, const char* name, int n, double r) {
  std::vector<float> out(size_t(n + 1) * size_t(n + 1), NAN);
  const Array at = point_positions(d->mesh());
  const Array& a = d->fields().require(name, Association::point).array;
  for (size_t i = 0; i < at.count(); ++i) {
    const auto x = size_t(std::lround((at.get(i, 0) / r + 1) * n / 2)), y = size_t(std::lround((at.get(i, 1) / r + 1) * n / 2));
    out[x + size_t(n + 1) * y] = float(a.get(i));
  }
  return out;
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double most = a.size() == b.size() ? 0 : HUGE_VAL;
  for (size_t i = 0; i < a.size() && i < b.size(); ++i) {
    const double off = std::abs(double(a[i]) - double(b[i]));
    most = off <= most ? most : off;  // NaN too
  }
  return most;
}

}  // namespace

TEST_CASE("lic meshes: in every kind of flat mesh white noise keeps 1/L of its variance, and 1 - k/L is shared along the flow (F9)") {
  for (const bool along_y : {false, true}) {
    CAPTURE(along_y);
    const auto texture = [&](const MeshKind& kind, size_t n) {
      Context context;
      const DatasetPtr d = flow::with_velocity(kind.make(6, 1), [&](Vec3) { return along_y ? Vec3(0, 3, 0) : Vec3(2, 0, 0); });
      LicParams p;
      p.resolution = int64_t(n), p.length = 10, p.contrast = texture::Contrast::none,
      p.method = along_y ? LicMethod::fast : LicMethod::plain;
      return values_of(lic(d, nullptr, p, context), "lic");
    };
    const MeshKind& first = flat_meshes()[0];
    const size_t n = 320;
    check_statistics({texture(first, n), {n, n, 1}, {22, 22, 0}}, along_y, !along_y, 10, 0.05);
    // The noise is that of the pixels, so that one kind is as good as another.
    const std::vector<float> wanted = texture(first, 80);
    for (const MeshKind& kind : flat_meshes()) {
      CAPTURE(kind.name);
      CHECK(largest_difference(texture(kind, 80), wanted) < 1e-5);
    }
  }
}

TEST_CASE("lic meshes: rings stay rings where the flow turns, in every kind of flat mesh (F9)") {
  const size_t n = 101;
  const double c = double(n - 1) / 2;
  UniformGrid g;
  g.dims = {n, n, 1};
  std::vector<float> ring;
  for (size_t j = 0; j < n; ++j)
    for (size_t i = 0; i < n; ++i) ring.push_back(float(std::sin(std::hypot(double(i) - c, double(j) - c) / 6)));
  FieldSet fields;
  fields.add({"picture", Association::point, Array::from_vector(std::vector<float>(ring)), "", Role::scalars});
  const DatasetPtr image = make_dataset(g, fields);
  for (const MeshKind& kind : flat_meshes()) {
    CAPTURE(kind.name);
    Context context;
    LicParams p;
    p.resolution = int64_t(n), p.length = 30, p.contrast = texture::Contrast::none;
    const DatasetPtr d = flow::with_velocity(kind.make(9, 1), [](Vec3 x) { return Vec3(-x.y, x.x, 0); });
    const std::vector<float> v = values_of(lic(d, image, p, context), "lic");
    double squares = 0, most = 0, count = 0;
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const double radius = std::hypot(double(i) - c, double(j) - c), off = std::abs(double(v[i + n * j]) - double(ring[i + n * j]));
        if (radius < 8 || radius > c - 1) continue;
        squares += off * off, count += 1, most = off <= most ? most : off;
      }
    CHECK(most < 0.1);
    CHECK(std::sqrt(squares / count) < 0.02);
  }
}

TEST_CASE("lic meshes: surface_lic has the statistics on flat triangles, quads, polygons, strips, grids and cells (F9)") {
  const int n = 160, half = 10;
  for (const MeshKind& kind : flat_meshes()) {
    // Means along steps of one edge: points must be even, and faces flat and straight.
    const std::string& name = kind.name;
    if (name != "flat uniform" && name != "triangles" && name != "quads" && name != "polygons" && name != "strips" &&
        name.find(" cells") == name.npos)
      continue;
    CAPTURE(name);
    Context context;
    SurfaceLicParams p;
    p.density = 0, p.steps = half, p.step = 2.0 / n, p.kernel = LineFade::box, p.stretch = false;
    const DatasetPtr d = flow::with_velocity(kind.make(n, 1), [](Vec3) { return Vec3(1.5, 0, 0); });
    const std::vector<float> v = on_lattice(surface_lic(d, p, context), "lic", n, 1);
    CHECK(largest_difference(v, v) == 0);  // no place is left out
    const auto m = size_t(n + 1);
    check_statistics({v, {m, m, 1}, {22, 22, 0}}, 0, 1, half, 0.1);
  }
}

TEST_CASE("lic meshes: volumes of texture have the statistics in every kind of solid mesh (F9)") {
  const auto texture = [](const MeshKind& kind, size_t n) {
    Context context;
    const DatasetPtr mesh = kind.make(4, 1);
    // A turned grid gives a turned volume, of which the flow along an axis is the same again.
    const auto* u = mesh->as<UniformGrid>();
    const Vec3 along = u ? u->direction.column(1) : Vec3(0, 1, 0);
    LicParams p;
    p.resolution = int64_t(n), p.length = 4, p.contrast = texture::Contrast::none, p.noise = LicNoise::white;
    return lic(flow::with_velocity(mesh, [&](Vec3) { return along; }), nullptr, p, context);
  };
  const std::vector<float> wanted = values_of(texture(solid_meshes()[0], 14), "lic");
  for (const MeshKind& kind : solid_meshes()) {
    CAPTURE(kind.name);
    // Bent boxes leave corners of the volume empty, and lines end at their faces.
    const bool bent = kind.name == "curvilinear" || kind.name.find("bent") == 0 || kind.name.find("curved") == 0;
    if (bent || kind.name == "rotated" || kind.name == "uniform") {
      const DatasetPtr t = texture(kind, bent ? 32 : 40);
      const std::vector<float> v = values_of(t, "lic");
      const size_t aside = bent ? 6 : 0, margin = bent ? 10 : 5;
      check_statistics({v, t->as<UniformGrid>()->dims, {aside, margin, aside}}, 1, 0, 4, bent ? 0.12 : 0.06);
    } else {  // the noise is that of the voxels: one kind is as good as another
      CHECK(largest_difference(values_of(texture(kind, 14), "lic"), wanted) < 1e-5);
    }
  }
}
