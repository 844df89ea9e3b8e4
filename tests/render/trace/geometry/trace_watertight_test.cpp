// SPDX-License-Identifier: Apache-2.0
// Rays that go for the edges and corners of a closed mesh never pass it.
#include "trace_support.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;

namespace {

/// Rays from `start` at points of every triangle's edges that leak out, or in from outside.
size_t leaks(const Triangles& tree, Vec3f start) {
  size_t n = 0;
  for (uint32_t t = 0; t < tree.count(); ++t) {
    const auto c = tree.corners(t);
    for (uint64_t k = 0; k < 3; ++k)
      for (uint64_t s = 0; s < 8; ++s) {
        const float w = s == 0 ? 0 : s == 1 ? 0.5f : uniform(17 + k, 8 * t + s, 0, 1);
        const Vec3f at = lerp(c[k], c[(k + 1) % 3], w);
        const Ray ray{start, normalize(at - start)};
        Hit h;
        n += !tree.nearest(ray, h) || !tree.blocked(ray);
        Hit packet[2];
        const Ray two[2] = {ray, {start, normalize(at * 1.00001f - start)}};
        n += (tree.nearest(two, 2, packet) & 1) == 0;
      }
  }
  return n;
}

}  // namespace

TEST_CASE("trace: no ray slips between triangles that share an edge or a corner") {
  const Triangles ball = ball_mesh(40).tree(), cube = cube_mesh(1).tree();
  CHECK(leaks(ball, {0, 0, 0}) == 0);
  CHECK(leaks(ball, {0.3f, -0.2f, 0.65f}) == 0);
  CHECK(leaks(ball, {0.7f, 0.6f, -0.1f}) == 0);
  CHECK(leaks(cube, {0, 0, 0}) == 0);
  CHECK(leaks(cube, {0.999f, -0.3f, 0.7f}) == 0);
}

TEST_CASE("trace: nor does one through small and long triangles, near and far") {
  TestMesh thin = ball_mesh(30);
  for (size_t i = 0; i < thin.xyz.size(); i += 3) thin.xyz[i] *= 1e-3f, thin.xyz[i + 1] *= 0.05f;  // a blade
  const Triangles blade = thin.tree();
  CHECK(leaks(blade, {0, 0, 0}) == 0);
  CHECK(leaks(blade, {1e-4f, 0.01f, -0.4f}) == 0);
  TestMesh small = ball_mesh(30);
  for (float& v : small.xyz) v = v * 1e-4f + 0.7f;
  const Triangles dot = small.tree();
  CHECK(leaks(dot, {0.7f, 0.7f, 0.7f}) == 0);
  size_t passed = 0;
  for (size_t i = 0; i < 20000; ++i) {  // from afar through its middle
    const Vec3f from = any_place(3, i, 1), to = Vec3f(0.7f, 0.7f, 0.7f) + any_place(4, i, 2e-5);
    passed += !dot.blocked({from, normalize(to - from)});
  }
  CHECK(passed == 0);
}

TEST_CASE("trace: a line from far away crosses a closed mesh an even number of times, edges and corners included") {
  const Triangles ball = ball_mesh(24).tree();
  size_t missed = 0;
  for (uint32_t t = 0; t < ball.count(); ++t)
    for (size_t k = 0; k < 3; ++k) {
      const Vec3f corner = ball.corners(t)[k], out = normalize(corner), from = corner * 5.0f;
      Hit near;
      // Straight through the corner and the ball's middle: both sides are met.
      missed += !ball.nearest({from, -out}, near);
      Hit far;
      missed += !ball.nearest({corner * 0.5f, -out}, far);
    }
  CHECK(missed == 0);
}
