// SPDX-License-Identifier: Apache-2.0
// A few words can ask for more than any machine has: said before anything is made, with what it would take.
#include "data/memory/memory_budget.h"
#include "render/render.h"
#include "support/test.h"

#include "pipeline/graph/graph.h"

using namespace sg;

namespace {

std::string error_of_steps(std::vector<std::pair<std::string, std::vector<std::string>>> steps) {
  return test::error_of([&] {
    Graph g{GraphOptions{}};
    Context context;
    NodeId last = g.add_operation(steps[0].first, steps[0].second);
    for (size_t i = 1; i < steps.size(); ++i) last = g.add_operation(steps[i].first, steps[i].second, {last});
    g.evaluate(last, {}, context);
  });
}

bool has(const std::string& error, std::initializer_list<const char*> parts) {
  INFO(error);
  for (const char* p : parts)
    if (error.find(p) == std::string::npos) return false;
  return true;
}

}  // namespace

TEST_CASE("memory estimates: a mesh appended to itself forty times is refused before anything is made") {
  const std::string error = test::error_of([] {
    Graph g{GraphOptions{}};
    Context context;
    NodeId last = g.add_operation("sphere", {"size=5"});
    for (int i = 0; i < 40; ++i) last = g.add_operation("append", {}, {last, last});
    g.evaluate(last, {}, context);
  });
  CHECK(has(error, {"append", "nested steps"}));
}

TEST_CASE("memory estimates: what append would make is told with what is allowed") {
  set_memory_limit(size_t(1) << 20);
  const std::string error = test::error_of([] {
    Graph g{GraphOptions{}};
    Context context;
    NodeId last = g.add_operation("sphere", {"size=9"});
    for (int i = 0; i < 12; ++i) last = g.add_operation("append", {}, {last, last});
    g.evaluate(last, {}, context);
  });
  set_memory_limit(0);
  CHECK(has(error, {"append", "meshes as one need", "1.0 MiB allowed", "--memory"}));
}

TEST_CASE("memory estimates: a thousand million seeds, places or glyphs are refused at once") {
  const char* many = "count=1000000000";
  for (const char* kind : {"random", "ball", "sphere", "grid", "plane"})
    CHECK(has(error_of_steps({{"abc", {"size=9"}}, {"seeds", {std::string("seeds=") + kind, many}}}), {"seeds need", "count", "--memory"}));
  CHECK(
      has(error_of_steps({{"abc", {"size=9"}}, {"seeds", {"seeds=grid", "counts=1000000,1000000,1000000"}}}), {"seeds need", "--memory"}));
  CHECK(has(error_of_steps({{"abc", {"size=9"}}, {"streamlines", {many}}}), {"seeds need", "--memory"}));
  for (const char* mode : {"random", "even"})
    CHECK(has(error_of_steps({{"abc", {"size=9"}}, {"glyph_points", {std::string("mode=") + mode, many}}}),
              {"glyphs need", "glyph_points", "--memory"}));
  CHECK(has(error_of_steps({{"abc", {"size=9"}}, {"glyphs", {many}}}), {"glyphs need", "--memory"}));
}

TEST_CASE("memory estimates: what a few words ask for is refused before the system promises more than the machine has") {
  CHECK(has(error_of_steps({{"abc", {"size=9"}}, {"resample", {"size=5000"}}}), {"of this machine", "--memory"}));
  CHECK(has(error_of_steps({{"abc", {"size=9"}}, {"resize", {"dims=5000,5000,5000"}}}), {"5000x5000x5000 points need", "--memory"}));
  CHECK(has(error_of_steps({{"abc", {"size=9"}}, {"ftle", {"size=5000", "duration=1"}}}), {"5000x5000x5000 seeds need", "--memory"}));
}

TEST_CASE("memory estimates: the frames of a picture count") {
  Context context;
  RenderOptions options;
  options.width = options.height = 8000;
  set_memory_limit(size_t(256) << 20);
  const std::string error = test::error_of([&] { render(Scene{}, Camera{}, options, context); });
  set_memory_limit(0);
  CHECK(has(error, {"8000x8000 pixels need", "256.0 MiB allowed", "--size", "--memory"}));
}
