// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/scene_part.h"

#include "pipeline/picture/picture.h"
#include "support/test.h"

using namespace sg;

namespace {

PipelineFile scene_file(const std::string& rest) {
  return parse_pipeline("sightglass: 1\nsteps:\n  a: {gyroid: {size: 8}}\n  b: {contour: {}, from: a}\n" + rest, "s.yaml",
                        picture_vocabulary());
}
std::string scene_refusal(const std::string& rest) {
  return test::error_of([&] {
    const PipelineFile f = scene_file(rest);
    build_graph(f);
  });
}

}  // namespace

TEST_CASE("scene in pipeline files: nodes follow their parents, shows know their node, and the text comes back") {
  const PipelineFile f = scene_file(
      "scene:\n  - node: car\n    translate: [1, 2, 3]\n    show: [{surface: {color: red}, of: b}, outline]\n    children:\n"
      "      - {node: wheel, instances: [{}, {translate: [0, 2, 0], angle: 90}], keys: [{time: 0}, {time: 2, angle: 90}],\n"
      "         show: [{lines: {}, of: b}], children: [{node: bolt, instances: {of: b, vectors: n, scale: 0.1}}]}\n"
      "  - {node: lamp, visible: false}\n"
      "show: [{volume: {}, of: a}]\n");
  REQUIRE(f.scene.size() == 4);
  CHECK(f.scene[0].words == std::vector<std::string>{"translate=1,2,3"});
  CHECK(f.scene[1].parent == 0);
  CHECK(f.scene[1].instances == std::vector<std::vector<std::string>>{{}, {"translate=0,2,0", "angle=90"}});
  CHECK(f.scene[1].keys.size() == 2);
  CHECK(f.scene[2].parent == 1);
  CHECK(f.scene[2].at == "b");
  CHECK(f.scene[2].at_words == std::vector<std::string>{"vectors=n", "scale=0.1"});
  CHECK(f.scene[3].parent == -1);
  REQUIRE(f.show.size() == 4);
  CHECK(f.show[0].kind == "volume");  // beside the scene: where the data lie
  CHECK(f.show[0].node == -1);
  CHECK(f.show[1].node == 0);
  CHECK(f.show[2].node == 0);
  CHECK(f.show[3].node == 1);
  const std::string text = emit_pipeline(f);
  const PipelineFile again = parse_pipeline(text, "s.yaml", picture_vocabulary());
  CHECK(again == f);
  CHECK(emit_pipeline(again) == text);
  PipelineFile other = f;
  other.scene[0].words = {"translate=1,2,4"};
  CHECK_FALSE(other == f);
}

TEST_CASE("scene in pipeline files: mistakes are told by line and name") {
  CHECK(test::contains(scene_refusal("scene: {node: a}"), "list of nodes"));
  CHECK(test::contains(scene_refusal("scene: [{translate: [1, 0, 0]}]"), "has no name"));
  CHECK(test::contains(scene_refusal("scene:\n  - {node: a, show: [outline]}\n  - {node: a}"), "s.yaml:7: scene: there are two nodes 'a'"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [surfce]}]"), "did you mean 'surface'"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [{surface: {}, of: c}]}]"), "there is no step 'c'"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [outline], instances: {of: c}}]"),
                       "node 'a', instances: there is no step 'c'"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [outline], instances: {scale: 2}}]"), "name of a step"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [outline], instances: []}]"), "list of transforms"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [outline], keys: 3}]"), "list of transforms"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [outline], show: [outline]}]"), "twice"));
  CHECK(test::contains(scene_refusal("scene: [{node: a, show: [outline], scale: {x: 2}}]"), "not a map"));
}
