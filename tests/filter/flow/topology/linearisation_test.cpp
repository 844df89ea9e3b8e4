// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/linearisation.h"

#include "base/random.h"
#include "filter/flow/topology/topology_support.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;
using enum CriticalType;

namespace {

Mat3 plane(double a, double b, double c, double d) { return matrix(a, b, 0, c, d, 0, 0, 0, 0); }

CriticalType plane_type(const Mat3& m) { return linearise_in_plane(m, {1, 0, 0}, {0, 1, 0}).type; }

// A random turn and stretch: m' = s m s^-1 has the same eigenvalues.
Mat3 similar(const Mat3& m, uint64_t seed) {
  Mat3 s;
  do {
    for (int i = 0; i < 9; ++i) s.m[i / 3][i % 3] = 2 * random_unit(seed, uint64_t(i)) - 1;
    seed += 1000;
  } while (std::abs(determinant(s)) < 0.2);
  return s * m * inverse(s);
}

}  // namespace

TEST_CASE("linearisation: the classes of the plane are those of the eigenvalues") {
  CHECK(plane_type(plane(1, 0, 0, -2)) == saddle);
  CHECK(plane_type(plane(0, 1, 1, 0)) == saddle);
  CHECK(plane_type(plane(-1, 0.5, 0, -2)) == attracting_node);
  CHECK(plane_type(plane(-1, 0, 0, -1)) == attracting_node);
  CHECK(plane_type(plane(-1, 1, 0, -1)) == attracting_node);  // one eigenvector
  CHECK(plane_type(plane(3, 1, 1, 2)) == repelling_node);
  CHECK(plane_type(plane(-0.1, 1, -1, -0.1)) == attracting_focus);
  CHECK(plane_type(plane(0.1, 1, -1, 0.1)) == repelling_focus);
  CHECK(plane_type(plane(0, 2, -1, 0)) == centre);
  CHECK(plane_type(plane(1, 1, 1, 1)) == degenerate);
  CHECK(plane_type(plane(0, 0, 0, 0)) == degenerate);
  CHECK(linearise_in_plane(plane(1, 0, 0, -2), {1, 0, 0}, {0, 1, 0}).index == -1);
  for (const Mat3& m : {plane(-1, 0, 0, -2), plane(1, 0, 0, 2), plane(0, 1, -1, 0), plane(.1, 1, -1, .1)})
    CHECK(linearise_in_plane(m, {1, 0, 0}, {0, 1, 0}).index == 1);
}

TEST_CASE("linearisation: the classes of space are those of the eigenvalues, whatever the axes") {
  const struct {
    Mat3 m;
    CriticalType type;
    int index;
  } cases[] = {{matrix(-1, 0, 0, 0, -2, 0, 0, 0, -3), attracting_node, -1},
               {matrix(1, 0, 0, 0, 2, 0, 0, 0, 3), repelling_node, 1},
               {matrix(-1, 2, 0, -2, -1, 0, 0, 0, -3), attracting_focus, -1},
               {matrix(1, 2, 0, -2, 1, 0, 0, 0, 0.3), repelling_focus, 1},
               {matrix(-1, 0, 0, 0, 2, 0, 0, 0, 3), saddle_1_in, -1},
               {matrix(-1, 0, 0, 0, -2, 0, 0, 0, 3), saddle_2_in, 1},
               {matrix(0.5, 2, 0, -2, 0.5, 0, 0, 0, -1), spiral_saddle_1_in, -1},
               {matrix(-0.5, 2, 0, -2, -0.5, 0, 0, 0, 1), spiral_saddle_2_in, 1},
               {matrix(0, 2, 0, -2, 0, 0, 0, 0, 1), centre, 1},
               {matrix(0, 1, 0, -1, 0, 0, 0, 0, 0), degenerate, 0},
               {matrix(-2, 0, 0, 0, -2, 0, 0, 0, -2), attracting_node, -1},
               {matrix(2, 0, 0, 0, 2, 0, 0, 0, -2), saddle_1_in, -1}};
  for (const auto& c : cases)
    for (uint64_t turn = 0; turn < 20; ++turn) {
      const Mat3 m = turn ? similar(c.m, turn) : c.m;
      const Linearisation l = linearise(m);
      CAPTURE(int(c.type));
      CAPTURE(turn);
      CHECK(l.type == c.type);
      CHECK(l.index == c.index);
      // Each vector is one: m v = lambda v, and for pairs m (x + i y) = (a + i b)(x + i y) up to the vectors' lengths.
      for (size_t k = 0; k < 3; ++k) {
        if (l.im[k] == 0) CHECK(length(m * l.vector[k] - l.re[k] * l.vector[k]) < 1e-5);
        else if (l.im[k] > 0) CHECK(std::abs(dot(normalize(cross(l.vector[k], l.vector[k + 1])), normalize(m * l.vector[k]))) < 1e-6);
      }
    }
}
