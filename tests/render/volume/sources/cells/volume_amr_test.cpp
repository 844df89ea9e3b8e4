// SPDX-License-Identifier: Apache-2.0
// Pictures of AMR grids: no gaps between levels, and what a uniform grid with the same field shows.
#include "render/volume/volume_support.h"
#include "volume_amr_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Chord of a box in front of `from`.
std::pair<double, double> box_chord(Vec3 o, Vec3 d, double from, const Box3& box = {{-1, -1, -1}, {1, 1, 1}}) {
  const Vec3 per(1 / box.size().x, 1 / box.size().y, 1 / box.size().z);
  auto [a, b] = chord((o - box.lo) * per, d * per);
  a = std::max(a, from);
  return a < b ? std::pair{a, b} : std::pair{0.0, 0.0};
}

Vec3 random_place(Random& random, double within) {
  return {random.in(-within, within), random.in(-within, within), random.in(-within, within)};
}

}  // namespace

TEST_CASE("property: rays through AMR grids cross each place once, with the field of a linear function") {
  for (uint64_t seed : property_seeds(60)) {
    CAPTURE(seed);
    Random random(seed);
    DatasetPtr grid = random_amr(random);
    // A blanked box of whole cells of the coarsest level.
    Box3 hole{{1e9, -1e9, 2e9}, {1e9 + 1, 1 - 1e9, 2e9 + 1}};  // none
    if (random.chance(0.4)) {
      const Vec3 h = grid->as<AmrGrid>()->levels[0].spacing;
      for (int a = 0; a < 3; ++a) hole.lo[a] = -1 + h[a] * random.whole(0, 2), hole.hi[a] = hole.lo[a] + h[a];
      grid = with_hole(grid, hole);
    }
    const Association a = random.chance(0.5) ? Association::cell : Association::point;
    const bool constant = random.chance(0.5);
    const Vec3 slope = constant ? Vec3() : random_place(random, 2);
    const auto linear = [&](Vec3 p) { return 3 + dot(slope, p); };
    const VolumeItem item = item_of(with_amr_field(grid, linear, a), a);
    Context context;
    const auto source = volume::cell_source(item, context);
    const auto walker = source->walker();
    for (int k = 0; k < 40; ++k) {
      // From afar and from inside; across anything, along axes, through corners and edges of cells.
      Vec3 o = random_place(random, random.chance(0.5) ? 1 : 5), d = normalize(random_place(random, 1) - o);
      if (random.chance(0.2)) o = {std::round(4 * o.x) / 4, std::round(4 * o.y) / 4, std::round(4 * o.z) / 4};
      if (random.chance(0.2)) d = random.one_of({Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1)});
      bool along_border = false;
      for (int a = 0; a < 3; ++a) along_border = along_border || std::abs(o[a]) == 1 || o[a] == hole.lo[a] || o[a] == hole.hi[a];
      if (along_border) continue;
      const auto [from, to] = box_chord(o, d, 0);
      const auto [out, in] = box_chord(o, d, 0, hole);
      const RaySum sum = gather(*source, *walker, o, d, 0);
      CAPTURE(k);
      CHECK(sum.length == doctest::Approx((to - from) - (in - out)).epsilon(1e-9));
      CHECK(sum.gap < in - out + 1e-9);
      const auto integral = [&](double begin, double end) { return (end - begin) * linear(o + d * (0.5 * (begin + end))); };
      CHECK(sum.integral == doctest::Approx(integral(from, to) - integral(out, in)).epsilon(1e-5));
    }
  }
}

TEST_CASE("property: AMR grids of one value are a homogeneous medium from everywhere") {
  for (uint64_t seed : property_seeds(12)) {
    CAPTURE(seed);
    Random random(seed);
    const Association a = random.chance(0.5) ? Association::cell : Association::point;
    VolumeItem v = item(with_amr_field(
                            random_amr(random), [](Vec3) { return 0.5; }, a),
                        one_color({0.2f, 0.6f, 0.9f}), constant_opacity(0.7));
    v.association = a;
    Vec3 eye = random_place(random, random.chance(0.6) ? 1 : 4), target = random_place(random, 0.9);
    if (random.chance(0.3))
      eye = random.one_of({Vec3(0, 0, 4), Vec3(0, 0, 0), Vec3(0.5, -0.5, 0.25)}),
      target = random.one_of({Vec3(0.1, 0, -1), Vec3(1, 1, 0), Vec3(0, 1, 0.3)});
    const bool parallel = random.chance(0.3);
    Projection p = perspective_view(48, 40, 30, eye, target, {0.1, 0.3, 1});
    if (parallel) p = parallel_view(48, 40, 15, target - eye, {0.1, 0.3, 1}, target);
    const Frame frame = draw(scene_of({v}), p);
    double worst = 0;
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x) {
        const auto ray = p.ray(x + 0.5, y + 0.5);
        const auto [from, to] = box_chord(ray.origin, ray.direction, 0);
        const double truth = 1 - std::exp(-0.7 * (to - from));
        worst = std::max(worst, std::abs(double(frame.rgba[4 * size_t(y * p.width + x) + 3]) - truth));
      }
    CHECK(worst < 1.0 / 512);
  }
}

TEST_CASE("property: an AMR grid with a linear field looks as the uniform grid with that field does") {
  for (uint64_t seed : property_seeds(8)) {
    CAPTURE(seed);
    Random random(seed);
    const Association a = random.chance(0.5) ? Association::cell : Association::point;
    const Vec3 slope = normalize(random_place(random, 1) + Vec3(0.01, 0, 0)) * 0.4;
    const auto linear = [&](Vec3 p) { return 1 + dot(slope, p); };
    OpacityCurve opacity;
    opacity.points = {{0.4, 0.1}, {0.9, 0.0}, {1.1, 0.8}, {1.6, 0.4}};
    VolumeItem refined = item(with_amr_field(random_amr(random), linear, a), grey(0.4, 1.6), opacity);
    refined.association = a, refined.shaded = random.chance(0.5);
    VolumeItem even = refined;
    even.data = grid(cube(4, -1, 1), linear), even.association = Association::point;
    const Vec3 eye = random_place(random, random.chance(0.5) ? 1 : 4), target = random_place(random, 0.9);
    const Projection p = perspective_view(32, 28, 24, eye, target, {0.1, 0.3, 1});
    CAPTURE(int(a));
    CAPTURE(refined.shaded);
    CHECK(largest_difference(draw(scene_of({refined}), p), draw(scene_of({even}), p)) < 2.0 / 512);
  }
}

TEST_CASE("volume cells: polyhedra with corners amid their edges have no gaps") {
  // 2^3 cubes with a corner amid each edge: faces of eight corners.
  constexpr int64_t n = 2, m = 2 * n + 1;
  std::vector<double> xyz;
  for (int64_t i = 0; i < m * m * m; ++i)
    for (int64_t at : {i % m, i / m % m, i / m / m}) xyz.push_back(double(at) / double(n) - 1);
  std::vector<int64_t> ids, offsets{0}, faces, face_offsets{0}, cell_faces{0};
  for (int64_t c = 0; c < n * n * n; ++c) {
    const int64_t low = 2 * (c % n + m * (c / n % n + m * (c / n / n))), axis[3] = {1, m, m * m};
    std::vector<int64_t> own;
    for (int a = 0; a < 3; ++a)
      for (int side = 0; side < 2; ++side) {
        const int64_t u = axis[(a + 1) % 3], v = axis[(a + 2) % 3], at = low + 2 * side * axis[a];
        std::vector<int64_t> ring{at, at + u, at + 2 * u, at + 2 * u + v, at + 2 * u + 2 * v, at + u + 2 * v, at + 2 * v, at + v};
        if (side == 0) std::reverse(ring.begin(), ring.end());
        faces.insert(faces.end(), ring.begin(), ring.end());
        face_offsets.push_back(int64_t(faces.size()));
        own.insert(own.end(), ring.begin(), ring.end());
      }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    ids.insert(ids.end(), own.begin(), own.end());
    offsets.push_back(int64_t(ids.size()));
    cell_faces.push_back(int64_t(face_offsets.size()) - 1);
  }
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  mesh.single_type = CellType::polyhedron;
  mesh.faces = {Array::from_vector(std::move(faces)), Array::from_vector(std::move(face_offsets)), 0};
  mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces));
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  for (bool by_cell : {false, true}) {
    VolumeItem v = item(with_field(
                            parts, [](Vec3) { return 0.5; }, by_cell),
                        one_color({0.2f, 0.6f, 0.9f}), constant_opacity(0.7));
    v.association = by_cell ? Association::cell : Association::point;
    for (VolumeMethod method : {VolumeMethod::ray, VolumeMethod::cells})
      for (Vec3 eye : {Vec3(2.3, 1.7, 3.1), Vec3(0.3, 0.1, -0.2), Vec3(0, 0, 3)}) {
        v.method = method;
        const Projection p = perspective_view(40, 36, 26, eye, {0.1, -0.2, 0.3});
        const Frame frame = draw(scene_of({v}), p);
        double worst = 0;
        for (int y = 0; y < p.height; ++y)
          for (int x = 0; x < p.width; ++x) {
            const auto ray = p.ray(x + 0.5, y + 0.5);
            const auto [from, to] = box_chord(ray.origin, ray.direction, 0);
            worst = std::max(worst, std::abs(double(frame.rgba[4 * size_t(y * p.width + x) + 3]) - (1 - std::exp(-0.7 * (to - from)))));
          }
        CAPTURE(int(method));
        CHECK(worst < 1.0 / 512);
      }
  }
}
