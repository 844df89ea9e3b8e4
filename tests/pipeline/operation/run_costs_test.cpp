// SPDX-License-Identifier: Apache-2.0
// What simulators are expected to take, and in how many frames.
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/graph/graph.h"
#include "pipeline/operation/operation.h"
#include "support/test.h"

using namespace sg;

namespace {

std::string explained(const std::string& name, const std::vector<std::string>& words) {
  Graph g;
  return g.explain(g.add_operation(name, words));
}

}  // namespace

TEST_CASE("run costs: every operation with frames tells how many it takes, and longer runs take longer") {
  size_t found = 0;
  for (const Operation& o : operations()) {
    const ParamSet empty = o.make_params();
    if (!empty.schema.find("store") || !empty.schema.find("frame")) continue;
    CAPTURE(o.name);
    ++found;
    REQUIRE(bool(o.estimate));
    const uint64_t in = 1 << 20;
    double before = 0;
    for (const int frames : {0, 1, 4, 100}) {
      ParamSet params = o.make_params();
      set_params(params.schema, {"frame=0.05", "time=" + std::to_string(0.05 * frames)}, o.name);
      const Estimate e = o.estimate(params, o.kind == OperationKind::source ? std::span<const uint64_t>() : std::span(&in, 1));
      REQUIRE(e.frames.has_value());
      CHECK(*e.frames == uint64_t(frames));
      CHECK((e.steps == 0 || e.steps >= uint64_t(frames)));
      CHECK(std::isfinite(e.seconds));
      CHECK((frames == 0 ? e.seconds == 0 : e.seconds > before));
      CHECK(e.bytes < (uint64_t(1) << 30));
      before = e.seconds;
    }
  }
  CHECK(found >= 15);
}

TEST_CASE("run costs: explain tells frames and steps of what runs") {
  CHECK(test::contains(explained("heat", {"time=1", "frame=0.1", "step=0.05"}), ", 10 frames in ~20 steps"));
  CHECK(test::contains(explained("smoke", {"time=0.04", "size=8"}), ", 1 frame in ~1 steps (cfl=2 at speeds of about "));
  // What comes in at 3 passes 0.05 * 3 * 64 = 9.6 cells a frame, at most 2 of them a step.
  CHECK(test::contains(
      explained("smoke", {"time=1", "frame=0.05", "size=64", "bounds=0,1,0,1,0,0", "sides=x0 inflow 3,0,0; x1 open", "lift=0", "weight=0"}),
      ", 20 frames in ~100 steps (cfl=2 at speeds of about 3)"));
  CHECK(test::contains(explained("nbody", {"time=100", "frame=0.1", "step=0.02"}), ", 1000 frames in ~5000 steps"));
  CHECK_FALSE(test::contains(explained("poisson", {}), "frame"));
}

TEST_CASE("run costs: frames that are stored are not computed again") {
  const std::string store = test::fresh_folder("costs") + "run";
  const std::vector<std::string> words{"size=8", "frame=0.1", "store=" + store};
  const auto with = [&](const std::string& time) {
    std::vector<std::string> all = words;
    all.push_back(time);
    return all;
  };
  Graph g;
  Context context;
  g.evaluate(std::vector<Target>{{g.add_operation("smoke", with("time=0.4")), {}}}, context);
  CHECK(test::contains(explained("smoke", with("time=1")), ", 6 frames after the 4 stored in ~"));
  CHECK(test::contains(explained("smoke", with("time=0.2")), ", 2 frames in ~"));
}

TEST_CASE("run costs: a run that grows more costly with what there is tells so") {
  const auto seconds = [](const std::string& name, const std::vector<std::string>& words) {
    const Operation& o = find_operation(name);
    ParamSet p = o.make_params();
    set_params(p.schema, words, name);
    return o.estimate(p, {}).seconds;
  };
  const auto grows = [&](const std::string& name, std::vector<std::string> less, std::vector<std::string> more, double least, double most) {
    CAPTURE(name);
    less.push_back("time=20"), more.push_back("time=20");
    const double ratio = seconds(name, more) / seconds(name, less);
    CHECK(ratio >= least);
    CHECK(ratio <= most);
  };
  grows("reaction_diffusion", {"size=200"}, {"size=400"}, 4, 16);  // cells, and the steps that diffusion allows
  grows("advection_diffusion", {"size=100", "diffusivity=0"}, {"size=200", "diffusivity=0"}, 7, 9);
  grows("liquid", {"size=50"}, {"size=100"}, 4, 9);
  grows("nbody", {"count=1000", "angle=0"}, {"count=2000", "angle=0"}, 3.9, 4.1);
  grows("particle_system", {"count=1000", "rate=0"}, {"count=3000", "rate=0"}, 2.9, 3.1);
  grows("mechanics", {"system=spring_net", "size=5"}, {"system=spring_net", "size=10"}, 10, 30);
  const auto poisson = [&](const char* word) { return seconds("poisson", {"size=128", word}); };
  CHECK(poisson("solver=multigrid") < poisson("solver=cg"));
  CHECK(poisson("solver=cg") < poisson("solver=gauss_seidel"));
}
