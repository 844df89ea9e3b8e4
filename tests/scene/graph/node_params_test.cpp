// SPDX-License-Identifier: Apache-2.0
#include "scene/graph/node_params.h"

#include "support/test.h"

using namespace sg;

namespace {

Affine affine(const std::vector<std::string>& words) {
  NodeParams p;
  Schema schema = schema_of(p);
  set_params(schema, words, "node");
  return affine_of(p.place, schema, "node 'n'");
}
std::string node_refusal(const std::vector<std::string>& words) {
  return test::error_of([&] { affine(words); });
}

}  // namespace

TEST_CASE("node: scale, then rotation about the centre, then translation; a matrix instead") {
  const Affine a = affine({"scale=2,3,4", "angle=90", "translate=10,0,0"});
  CHECK(a(Vec3(1, 0, 0)) == Vec3(10, 2, 0));
  CHECK(a(Vec3(0, 1, 0)) == Vec3(7, 0, 0));
  CHECK(affine({"center=1,1,0", "angle=180", "scale=2"})(Vec3(1, 1, 0)) == Vec3(1, 1, 0));
  CHECK(affine({"center=1,1,0", "angle=180", "scale=2"})(Vec3(2, 1, 0)) == Vec3(-1, 1, 0));
  CHECK(affine({"matrix=0,-1,0,5,1,0,0,6,0,0,1,7,0,0,0,1"})(Vec3(1, 0, 0)) == Vec3(5, 7, 7));
  CHECK(affine({}) == Affine());
}

TEST_CASE("node: the same rotation as axis with angle, quaternion of any length, Euler angles and matrix") {
  const Affine a = affine({"axis=0,1,0", "angle=90"});
  for (const Vec3 p : {Vec3(1, 2, 3), Vec3(-1, 0, 0.5)})
    for (const Affine& b : {affine({"quaternion=0,3,0,3"}), affine({"euler=0,90,0", "order=zyz"}), affine({"euler=0,90,0", "order=zyx"})})
      CHECK(length(a(p) - b(p)) < 4e-15);
}

TEST_CASE("node: what is stated twice, flattens or is not finite is refused, with the node's name") {
  CHECK(test::contains(node_refusal({"angle=5", "euler=1,2,3"}), "stated twice"));
  CHECK(test::contains(node_refusal({"order=zyx"}), "without euler"));
  CHECK(test::contains(node_refusal({"scale=1,0,1"}), "flattens"));
  CHECK(test::contains(node_refusal({"scale=1,2"}), "two numbers"));
  CHECK(test::contains(node_refusal({"scale=1e200"}), "flattens"));
  CHECK(test::contains(node_refusal({"translate=inf,0,0"}), "node"));
  CHECK(test::contains(node_refusal({"quaternion=0,0,0,0"}), "no rotation"));
  CHECK(test::contains(node_refusal({"quaternion=1,0"}), "2 numbers"));
  CHECK(test::contains(node_refusal({"axis=0,0,0", "angle=3"}), "axis is zero"));
  CHECK(test::contains(node_refusal({"matrix=1,2,3"}), "node 'n'"));
  CHECK(test::contains(node_refusal({"matrix=1,0,0,0,0,1,0,0,0,0,1,0,0,0,1,1"}), "last row"));
  CHECK(test::contains(node_refusal({"matrix=1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1", "scale=2"}), "both stated"));
}
