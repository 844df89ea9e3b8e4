// SPDX-License-Identifier: Apache-2.0
// Every way to the nearest triangle finds the one that looking at all of them finds.
#include <hwy/targets.h>

#include <cstring>

#include "base/parallel.h"
#include "render/trace/geometry/triangle_test.h"
#include "trace_support.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;

namespace {

bool same(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof(Hit)) == 0; }

/// The nearest by the binary tree.
bool nearest_by_bvh(const Triangles& tree, const Bvh& bvh, const Ray& ray, Hit& hit) {
  const ShearedRay r(ray);
  bool found = false;
  Ray limited = ray;
  limited.t_max = hit.t;
  bvh.along(limited, [&](uint32_t i) {
    const auto c = tree.corners(i);
    float t = 0, u = 0, v = 0;
    if (meet_triangle(r, c[0], c[1], c[2], hit.t, t, u, v) && (t < hit.t || !found || i < hit.primitive))
      hit.t = t, hit.primitive = i, hit.u = u, hit.v = v, found = true;
    return hit.t;
  });
  return found;
}

Bvh bvh_of(const Triangles& tree, const TreeLimits& limits = {}) {
  std::vector<Box3f> boxes;
  for (uint32_t i = 0; i < tree.count(); ++i) {
    Box3f b;
    for (const Vec3f& p : tree.corners(i))
      for (int a = 0; a < 3; ++a) b.lo[a] = std::min(b.lo[a], p[a]), b.hi[a] = std::max(b.hi[a], p[a]);
    boxes.push_back(b);
  }
  Context context;
  return Bvh(boxes, limits, context);
}

/// How many of the rays some way answers in another way than looking at all triangles does.
template <class MakeRay>
size_t disagreements(const Triangles& tree, size_t rays, MakeRay&& make_ray) {
  const Bvh bvh = bvh_of(tree);
  size_t wrong = 0, hits = 0;
  std::vector<Ray> packet;
  std::vector<Hit> expected;
  std::vector<bool> met;
  for (size_t i = 0; i < rays; ++i) {
    const Ray ray = make_ray(i);
    Hit truth, wide_hit, binary;
    truth.t = wide_hit.t = binary.t = ray.t_max;
    const bool found = tree.nearest_by_reference(ray, truth);
    wrong += tree.nearest(ray, wide_hit) != found || !same(truth, wide_hit);
    wrong += nearest_by_bvh(tree, bvh, ray, binary) != found || !same(truth, binary);
    wrong += tree.blocked(ray) != found;
    hits += found;
    packet.push_back(ray), expected.push_back(truth), met.push_back(found);
    if (packet.size() < 48 && i + 1 < rays) continue;
    Hit out[stream_rays];
    for (size_t k = 0; k < packet.size(); ++k) out[k].t = packet[k].t_max;
    const uint64_t bits = tree.nearest(packet.data(), int(packet.size()), out);
    for (size_t k = 0; k < packet.size(); ++k) wrong += bool(bits >> k & 1) != met[k] || !same(out[k], expected[k]);
    packet.clear(), expected.clear(), met.clear();
  }
  CHECK(hits > rays / 20);
  return wrong;
}

}  // namespace

TEST_CASE("trace: all traversals return the nearest triangle of looking at all, for random rays") {
  const Triangles tree = soup(300, 0.2, 1).tree();
  CHECK(disagreements(tree, 100000, [](size_t i) { return Ray{any_place(2, i, 1.5), any_direction(3, i)}; }) == 0);
}

TEST_CASE("trace: and for those along the axes, with limits, in bundles, from triangles, and through flat boxes") {
  const Triangles tree = soup(300, 0.2, 4).tree();
  auto axis = [](size_t i) {
    Vec3f d;
    d[int(i % 3)] = i % 2 ? 1.0f : -1.0f;
    return d;
  };
  CHECK(disagreements(tree, 20000, [&](size_t i) { return Ray{any_place(5, i, 1), axis(i / 16)}; }) == 0);
  CHECK(disagreements(tree, 20000, [&](size_t i) { return Ray{any_place(6, i, 1), any_direction(7, i), uniform(8, i, 0, 1)}; }) == 0);
  CHECK(
      disagreements(tree, 20000, [&](size_t i) {  // neighbours
        return Ray{{0, 0, 3}, normalize(Vec3f(uniform(9, i / 16, -0.2, 0.2), uniform(10, i / 16, -0.2, 0.2), -1) + any_place(11, i, 0.02))};
      }) == 0);
  CHECK(disagreements(tree, 20000, [&](size_t i) {  // starts at corners and inside
          const auto c = tree.corners(uint32_t(i % 300));
          return Ray{i % 2 ? c[i % 3] : (c[0] + c[1] + c[2]) / 3.0f, any_direction(12, i)};
        }) == 0);
  TestMesh flat = soup(300, 0.2, 13);
  for (size_t i = 0; i < flat.xyz.size(); i += 3) flat.xyz[i + 2] = i % 2 ? 0.25f : -0.5f;  // some in a plane, others between both
  for (size_t i = 0; i < flat.xyz.size(); i += 27) flat.xyz[i + 2] = flat.xyz[i + 5] = flat.xyz[i + 8] = 0.25f;
  CHECK(disagreements(flat.tree(), 20000, [&](size_t i) { return Ray{any_place(14, i, 1), i % 4 ? any_direction(15, i) : axis(i)}; }) == 0);
}

TEST_CASE("trace: of triangles at the same place the first is met") {
  TestMesh m = cube_mesh(0.5f);
  for (int copy = 0; copy < 40; ++copy)
    for (size_t i = 0; i < 36; ++i) m.corners.push_back(m.corners[i]);
  const Triangles tree = m.tree();
  size_t later = 0;
  for (size_t i = 0; i < 2000; ++i) {
    Hit h;
    if (tree.nearest({any_place(1, i, 0.4), any_direction(2, i)}, h)) later += h.primitive >= 12;
    else ++later;
  }
  CHECK(later == 0);
}

TEST_CASE("trace: nothing is met in empty sets, at triangles without area or with corners that are no numbers") {
  CHECK_FALSE(TestMesh{}.tree().blocked({{0, 0, 1}, {0, 0, -1}}));
  CHECK(TestMesh{}.tree().bounds().empty());
  TestMesh m{{0, 0, 0, 1, 0, 0, 2, 0, 0, NAN, 0, 0, 0, 1, 0, INFINITY, 1, 1, -1, -1, 0, 1, -1, 0, 0, 1, 0},
             {0, 1, 2, 3, 4, 0, 5, 4, 0, 0, 0, 0, 6, 7, 8}};
  const Triangles tree = m.tree();
  Hit h;
  REQUIRE(tree.nearest({{0.1f, 0, 1}, {0, 0, -1}}, h));
  CHECK(h.primitive == 4);
  CHECK(h.t == 1);
  CHECK_FALSE(tree.blocked({{1.5f, 0, 1}, {0, 0, -1}}));
  CHECK_FALSE(tree.blocked({{NAN, 0, 1}, {0, 0, -1}}));
  CHECK_FALSE(tree.blocked({{0, 0, 1}, {0, 0, 0}}));
  CHECK_FALSE(tree.blocked({{0, 0, 1}, {0, INFINITY, -1}}));
}

TEST_CASE("trace: a million triangles at one place are a tree like any other") {
  TestMesh m{{-1, -1, 0, 1, -1, 0, 0, 1, 0}, {}};
  m.corners.resize(3'000'000);
  for (size_t i = 0; i < m.corners.size(); ++i) m.corners[i] = uint32_t(i % 3);
  const Triangles tree = m.tree();
  Hit h;
  REQUIRE(tree.nearest({{0, 0, 1}, {0, 0, -1}}, h));
  CHECK(h.primitive == 0);
  CHECK(tree.blocked({{0, 0, 1}, {0, 0, -1}}));
  CHECK_FALSE(tree.blocked({{0, 0, 1}, {0, 0, 1}}));
}

TEST_CASE("trace: the same bytes for every vector width and number of threads") {
  const TestMesh m = ball_mesh(120);
  auto answers = [&] {
    const Triangles tree = m.tree();
    std::vector<Hit> hits;
    for (size_t i = 0; i < 4096; ++i) {
      Hit h;
      Ray r{any_place(1, i, 1.2), any_direction(2, i)};
      tree.nearest(r, h);
      h.object = tree.blocked(r);
      hits.push_back(h);
    }
    for (size_t i = 0; i < 256; ++i) {
      Ray rays[packet_rays];
      Hit out[packet_rays];
      for (size_t k = 0; k < packet_rays; ++k)
        rays[k] = {
            {0, 0, 3},
            normalize(Vec3f(uniform(3, i, -0.3, 0.3) + 0.002f * float(k % 4), uniform(4, i, -0.3, 0.3) + 0.002f * float(k / 4), -1))};
      tree.nearest(rays, packet_rays, out);
      hits.insert(hits.end(), out, out + packet_rays);
    }
    std::vector<char> bytes(hits.size() * sizeof(Hit) + tree.tree().nodes().size() * sizeof(WideNode));
    std::memcpy(bytes.data(), hits.data(), hits.size() * sizeof(Hit));
    std::memcpy(bytes.data() + hits.size() * sizeof(Hit), tree.tree().nodes().data(), tree.tree().nodes().size() * sizeof(WideNode));
    return bytes;
  };
  const auto expected = answers();
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    CHECK(answers() == expected);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  for (const int threads : {1, 2, 7}) {
    set_thread_count(threads);
    CHECK(answers() == expected);
  }
  set_thread_count(0);
}
