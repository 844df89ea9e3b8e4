// SPDX-License-Identifier: Apache-2.0
// Pictures of cells: the packets of rays, cell projection, and the walker with the general integral must agree.
#include "base/parallel.h"
#include "color/colormap.h"
#include "render/volume/engines/tets/tet_rays.h"
#include "render/volume/methods/layer.h"
#include "render/volume/rays/integrate.h"
#include "support/test.h"
#include "volume_cells_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double fine_waves(Vec3 p) { return std::sin(7 * p.x) * std::cos(6 * p.y) + p.z; }

VolumeItem look(DatasetPtr data, Association a = Association::point) {
  VolumeItem item = item_of(std::move(data), a);
  item.color.map = find_colormap("sight");
  item.color.lo = -1, item.color.hi = 2;
  item.opacity.points = {{-1, 0}, {-0.4, 0}, {-0.2, 0.5}, {0, 0}, {0.6, 0}, {0.8, 0.9}, {0.9, 0.1}, {2, 0.3}};
  item.unit_distance = 0.2;
  item.shaded = false;
  return item;
}

Camera camera(bool parallel, Vec3 from = {2.2, 1.7, 2.9}) {
  Camera c;
  c.position = from, c.target = {0.5, 0.5, 0.5};
  c.view_angle = 35, c.parallel = parallel, c.parallel_height = 2;
  c.near_plane = 0.01, c.far_plane = 20;
  return c;
}

std::vector<float> by_rays(const VolumeItem& item, const Projection& p, const float* limit = nullptr) {
  Context context;
  const volume::CellVolume v = volume::make_cell_volume(item, context);
  const volume::TetRays rays(v, p, volume::make_medium(item, v), context, 1e-5f);
  std::vector<float> out(4 * size_t(p.width * p.height));
  constexpr int tile = volume::TetRays::tile;
  for (int y = 0; y < p.height; y += tile)
    for (int x = 0; x < p.width; x += tile) {
      const int w = std::min(tile, p.width - x), h = std::min(tile, p.height - y);
      volume::TetRays::Pixel pixels[tile * tile];
      std::vector<float> limits(size_t(w * h));
      for (int k = 0; limit && k < w * h; ++k) limits[size_t(k)] = limit[(y + k / w) * p.width + x + k % w];
      rays.draw(x, y, w, h, limit ? limits.data() : nullptr, pixels);
      for (int k = 0; k < w * h; ++k) {
        float* o = &out[4 * size_t((y + k / w) * p.width + x + k % w)];
        o[0] = pixels[k].r, o[1] = pixels[k].g, o[2] = pixels[k].b, o[3] = 1 - pixels[k].transmittance;
      }
    }
  return out;
}

std::vector<float> by_walker(const VolumeItem& item, const Projection& p, const float* limit = nullptr) {
  Context context;
  const auto source = volume::cell_source(item, context);
  const auto walker = source->walker();
  const volume::Medium medium = volume::make_medium(item, volume::make_cell_volume(item, context));
  const volume::Look look{medium, {1.0 / 4096, 2, 1e-5f}, 1, nullptr, 1, 1};
  std::vector<float> out;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const auto ray = p.ray(x + 0.5, y + 0.5);
      const double per = dot(ray.direction, p.forward), first = dot(ray.origin - p.eye, p.forward);
      const double far = limit ? double(limit[y * p.width + x]) : p.far_plane;
      walker->start(ray.origin, ray.direction, (p.near_plane - first) / per, (far - first) / per);
      volume::RayState state;
      volume::Stretch s[16];
      while (const size_t n = walker->next(s))
        for (size_t i = 0; i < n; ++i) volume::composite(look, s[i], *walker, state);
      out.insert(out.end(), {state.sum.r, state.sum.g, state.sum.b, 1 - state.sum.transmittance});
    }
  return out;
}

std::vector<float> by_projection(const VolumeItem& item, const Projection& p, const float* limit = nullptr) {
  Context context;
  Frame frame(p.width, p.height);
  for (size_t i = 0; limit && i < frame.depth.size(); ++i) frame.depth[i] = limit[i];
  const std::vector<Light> lights = lights_of(Scene{});
  return volume::project_cells({item, p, frame, lights, context}).rgba;
}

double difference(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (size_t i = 0; i < a.size(); ++i) most = std::max(most, double(std::abs(a[i] - b[i])));
  return most;
}
double coverage(const std::vector<float>& a) {
  double sum = 0;
  for (size_t i = 3; i < a.size(); i += 4) sum += double(a[i]);
  return sum / double(a.size() / 4);
}

}  // namespace

TEST_CASE("volume cells: a cube of constant value is 1 - exp(-tau L), whatever draws it") {
  for (CellType kind : all_kinds()) {
    CAPTURE(cell_type_info(kind).name);
    VolumeItem item = look(with_field(cube(kind, 2), [](Vec3) { return 1.0; }));
    item.opacity.points = {{0, 0.8646647167633873}, {1, 0.8646647167633873}};  // 1 - exp(-2)
    item.unit_distance = 1;
    Camera c = camera(true, {0.5, 0.5, 4});
    c.parallel_height = 0.8;
    const Projection p = make_projection(c, 20, 20);
    const double truth = 1 - std::exp(-2.0);
    const std::vector<float> walked = by_walker(item, p), projected = by_projection(item, p), rays = by_rays(item, p);
    for (size_t i = 3; i < walked.size(); i += 4) {
      CHECK(double(walked[i]) == doctest::Approx(truth).epsilon(1e-5));
      CHECK(double(projected[i]) == doctest::Approx(truth).epsilon(1e-5));
      CHECK(double(rays[i]) == doctest::Approx(truth).epsilon(1e-5));
    }
  }
}

TEST_CASE("volume cells: packets of rays, projection and the walker draw the same tetrahedra") {
  const VolumeItem item = look(with_field(cube(CellType::tetra, 6, bent), fine_waves));
  for (bool parallel : {false, true})
    for (Vec3 from : {Vec3(2.2, 1.7, 2.9), Vec3(0.5, 0.5, 3), Vec3(0.45, 0.52, 0.4), Vec3(0.5, 0.5, 1.0)}) {
      CAPTURE(parallel);
      CAPTURE(from.x);
      const Projection p = make_projection(camera(parallel, from), 50, 45);
      const std::vector<float> walked = by_walker(item, p);
      CHECK(coverage(walked) > 0.1);
      CHECK(difference(walked, by_rays(item, p)) < 1.0 / 1024);
      CHECK(difference(walked, by_projection(item, p)) < 1.0 / 1024);
    }
}

TEST_CASE("volume cells: fields of cells and meshes with holes look the same by packets, projection and walker") {
  const DatasetPtr points = with_field(cube(CellType::tetra, 5, bent), fine_waves);
  DatasetParts parts = points->parts();
  std::vector<uint8_t> ghost(points->cell_count());
  for (size_t c = 0; c < ghost.size(); ++c) ghost[c] = c % 7 < 2 ? uint8_t(ghost_hidden_cell) : uint8_t(0);
  parts.cell_ghost = Array::from_vector(ghost);
  const Projection p = make_projection(camera(false), 48, 48);
  for (const VolumeItem& item : {look(make_dataset(parts)), look(with_field(parts, fine_waves, true), Association::cell),
                                 look(with_field(cube(CellType::hexahedron, 5, bent), fine_waves, true), Association::cell)}) {
    const std::vector<float> walked = by_walker(item, p);
    CHECK(coverage(walked) > 0.05);
    CHECK(difference(walked, by_rays(item, p)) < 1.0 / 1024);
    CHECK(difference(walked, by_projection(item, p)) < 1.0 / 1024);
  }
}

TEST_CASE("volume cells: nothing is drawn behind an opaque surface or beyond a clipping plane") {
  VolumeItem item = look(with_field(cube(CellType::tetra, 4), fine_waves));
  const Projection p = make_projection(camera(false), 40, 40);
  std::vector<float> depth(40 * 40);
  for (size_t i = 0; i < depth.size(); ++i) depth[i] = i % 3 == 0 ? 0.5f : 3.4f;
  const std::vector<float> walked = by_walker(item, p, depth.data());
  CHECK(difference(walked, by_rays(item, p, depth.data())) < 1.0 / 1024);
  CHECK(difference(walked, by_projection(item, p, depth.data())) < 1.0 / 1024);
  CHECK(coverage(walked) < coverage(by_walker(item, p)));
  // Clipped to its lower half = the lower half of the cells.
  item.clip = {{{0, 0, 1}, 0.5}};
  DatasetParts half = item.data->parts();
  CellMap map(item.data);
  std::vector<uint8_t> ghost(item.data->cell_count());
  for (size_t c = 0; c < ghost.size(); ++c) map.open(c), ghost[c] = map.center().z > 0.5 ? uint8_t(ghost_hidden_cell) : uint8_t(0);
  half.cell_ghost = Array::from_vector(ghost);
  VolumeItem lower = look(make_dataset(half));
  CHECK(difference(by_projection(item, p), by_projection(lower, p)) < 1e-4);
}

TEST_CASE("volume cells: projection draws meshes of any kind as tetrahedra, and lattices too") {
  const Projection p = make_projection(camera(false), 40, 40);
  const auto soft = [](DatasetPtr data) {
    VolumeItem item = look(std::move(data));
    item.opacity.points = {{-1, 0}, {2, 0.6}};
    return item;
  };
  const std::vector<float> tets = by_projection(soft(with_field(cube(CellType::tetra, 12), fine_waves)), p);
  for (CellType kind : linear_kinds()) {
    CAPTURE(cell_type_info(kind).name);
    CHECK(difference(tets, by_projection(soft(with_field(cube(kind, 12), fine_waves)), p)) < 0.025);
  }
  UniformGrid g;
  g.dims = {13, 13, 13}, g.spacing = Vec3(1, 1, 1) / 12.0;
  std::vector<float> f;
  for (size_t i = 0; i < 13 * 13 * 13; ++i)
    f.push_back(float(fine_waves(Vec3(double(i % 13), double(i / 13 % 13), double(i / 169)) / 12.0)));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(f), "", Role::scalars});
  CHECK(difference(tets, by_projection(soft(make_dataset(g, fields)), p)) < 0.02);
}

TEST_CASE("volume cells: pictures are the same bytes for any number of threads") {
  const Projection p = make_projection(camera(false), 64, 64);
  const DatasetPtr data = with_field(cube(CellType::tetra, 16, bent), fine_waves);
  std::vector<float> first[2];
  for (int threads : {1, 8}) {
    set_thread_count(threads);
    const VolumeItem item = look(make_dataset(data->parts()));  // nothing kept from the run before
    const std::vector<float> pictures[2] = {by_rays(item, p), by_projection(item, p)};
    for (int k = 0; k < 2; ++k) {
      if (threads == 1) first[k] = pictures[k];
      CHECK(first[k] == pictures[k]);
    }
  }
  set_thread_count(0);
}

TEST_CASE("volume cells: a shaded projection is lit, and unknown wishes are refused") {
  VolumeItem item = look(with_field(cube(CellType::tetra, 6), fine_waves));
  const Projection p = make_projection(camera(false), 32, 32);
  const std::vector<float> plain = by_projection(item, p);
  item.shaded = true;
  const std::vector<float> lit = by_projection(item, p);
  double alpha = 0;
  for (size_t i = 3; i < lit.size(); i += 4) alpha = std::max(alpha, double(std::abs(lit[i] - plain[i])));
  CHECK(alpha < 2e-3);
  CHECK(difference(plain, lit) > 0.02);
  item.mode = RayFunction::maximum;
  CHECK(error_of([&] { by_projection(item, p); }).find("method=ray") != std::string::npos);
}

TEST_CASE("volume cells: lit packets shade as the general integral does") {
  const VolumeItem item = look(with_field(cube(CellType::tetra, 8, bent), fine_waves));
  const Projection p = make_projection(camera(false), 48, 48);
  Context context;
  const volume::CellVolume v = volume::make_cell_volume(item, context);
  const volume::Medium medium = volume::make_medium(item, v);
  const float per_scale = float(1 / (0.002 * (v.range.hi - v.range.lo)));
  volume::TetRays rays(v, p, medium, context, 1e-5f);
  const Vec3 lamp = normalize(Vec3(1, 2, 3));
  rays.light({Lamp{lamp, 0.9f, 2.1f}}, item.light, per_scale);
  const auto source = volume::cell_source(item, context);
  const auto walker = source->walker();
  double most = 0, sum = 0, change = 0;
  for (int y = 0; y < 48; y += 16)
    for (int x = 0; x < 48; x += 16) {
      volume::TetRays::Pixel pixels[256];
      rays.draw(x, y, 16, 16, nullptr, pixels);
      for (int k = 0; k < 256; ++k) {
        const auto ray = p.ray(x + k % 16 + 0.5, y + k / 16 + 0.5);
        volume::LitRay lit;
        lit.direction = Vec3f(ray.direction);
        lit.lights.push_back(seen_along({lamp, 0.9f}, ray.direction));
        lit.material = material_of(item.light);
        const volume::Look look{medium, {1.0 / 4096, 2, 1e-5f}, 1, &lit, per_scale, float(v.mesh->edge)};
        const volume::Look dark{medium, {1.0 / 4096, 2, 1e-5f}, 1, nullptr, per_scale, float(v.mesh->edge)};
        volume::RayState state, plain;
        walker->start(ray.origin, ray.direction, 0, 20);
        volume::Stretch s[16];
        while (const size_t n = walker->next(s))
          for (size_t i = 0; i < n; ++i) {
            volume::composite(look, s[i], *walker, state);
            volume::composite(dark, s[i], *walker, plain);
          }
        const double d =
            std::max({std::abs(state.sum.r - pixels[k].r), std::abs(state.sum.g - pixels[k].g), std::abs(state.sum.b - pixels[k].b)});
        most = std::max(most, d), sum += d;
        change = std::max(change, double(std::abs(state.sum.r - plain.sum.r)));
        CHECK(std::abs(state.sum.transmittance - pixels[k].transmittance) < 1e-3f);
      }
    }
  CHECK(change > 0.05);
  CHECK(sum / (48 * 48) < 2e-3);
  CHECK(most < 0.2);  // where the gradient turns to the other side within one cell
}
