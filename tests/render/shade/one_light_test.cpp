// SPDX-License-Identifier: Apache-2.0
// One light model for all that is drawn: an isosurface has the same colours as a mesh and as a volume.
#include "filter/scalar/contour/contour.h"
#include "render/render.h"
#include "render/shade/blinn_phong.h"
#include "render/shade/exp.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

constexpr int width = 240, height = 200;

/// A lobed ball, of smooth normals at this resolution.
DatasetPtr ball() {
  return grid(cube(81, -1, 1), [](Vec3 p) { return length(p) * (1 + 0.15 * p.x * p.y + 0.1 * std::sin(2 * p.z)); });
}

Frame drawn(Item item, const Camera& camera, const std::vector<Light>& lights) {
  Scene scene;
  scene.lights = lights;
  scene.items.push_back(std::move(item));
  scene.background = {0, 0, 0};
  Context context;
  RenderOptions options;
  options.width = width, options.height = height, options.samples = 1;
  return render(scene, camera, options, context);
}

/// Are all pixels within `r` of this one covered in both?
bool inside(const Frame& a, const Frame& b, int x, int y, int r) {
  for (int j = y - r; j <= y + r; ++j)
    for (int i = x - r; i <= x + r; ++i) {
      if (i < 0 || j < 0 || i >= width || j >= height) return false;
      const size_t at = size_t(j) * width + size_t(i);
      if (a.ids[at] == 0 || b.ids[at] == 0) return false;
    }
  return true;
}

}  // namespace

TEST_CASE("light: a contour and the ray-cast isosurface of the same field have the same colours") {
  const DatasetPtr data = ball();
  const Vec3f base{0.8f, 0.35f, 0.2f};  // sRGB
  Context context;
  ContourParams params;
  params.field.name = "f", params.values = {0.6};
  SurfaceItem mesh;
  mesh.data = contour(data, params, context), mesh.color = base;
  VolumeItem rays = item(data, one_color({srgb_decode(base.x), srgb_decode(base.y), srgb_decode(base.z)}), {});
  rays.opacity.points = {{0, 1}};
  rays.mode = RayFunction::isosurface, rays.levels = {0.6}, rays.shaded = true;
  struct View {
    const char* about;
    bool parallel;
    float specular, power;
    std::vector<Light> lights;
  };
  const View views[] = {{"the default lights", false, 0.18f, 32, {}},
                        {"parallel rays", true, 0.18f, 32, {}},
                        {"a sharp highlight", false, 0.6f, 100, {}},
                        {"a power that is not whole", false, 0.5f, 12.5f, {}},
                        {"one light from the side, in the world", false, 0.4f, 20, {{{1, 0.3, 0.2}, false, 1}}}};
  for (const View& v : views) {
    CAPTURE(v.about);
    Camera camera;
    camera.position = {1.2, 0.9, 3}, camera.target = {0, 0, 0}, camera.up = {0, 1, 0};
    camera.parallel = v.parallel, camera.parallel_height = 1.6;
    mesh.material.specular = v.specular, mesh.material.power = v.power;
    rays.light.specular = double(v.specular), rays.light.power = double(v.power);
    const Frame a = drawn(mesh, camera, v.lights), b = drawn(rays, camera, v.lights);
    const Image first = to_image(a), second = to_image(b);
    int compared = 0, worst = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (!inside(a, b, x, y, 4)) continue;
        ++compared;
        for (size_t k = 0; k < 3; ++k) {
          worst = std::max(worst, std::abs(int(first.at(x, y)[k]) - int(second.at(x, y)[k])));
        }
      }
    CHECK(compared > 8000);
    CHECK(worst <= 2);
  }
}

TEST_CASE("light: the defaults of surfaces are those of volumes") {
  const Material surface, volume = material_of(VolumeLight{});
  CHECK(surface.ambient == volume.ambient);
  CHECK(surface.diffuse == volume.diffuse);
  CHECK(surface.specular == volume.specular);
  CHECK(surface.power == volume.power);
}

TEST_CASE("light: exp(-x) and powers keep their errors") {
  for (int i = 0; i <= 4000; ++i) {
    const float x = float(i) * 0.0225f;
    CHECK(std::abs(double(exp_minus(x)) - std::exp(-double(x))) <= 2.5e-7 * std::exp(-double(x)) + 1e-37);
  }
  for (float power : {0.0f, 1.0f, 7.0f, 32.0f, 12.5f, 300.0f})
    for (int i = 0; i <= 100; ++i) {
      const float h = float(i) / 100;
      CHECK(double(power_of(h, power)) == doctest::Approx(std::pow(double(h), double(power))).epsilon(2e-5));
    }
}
