// SPDX-License-Identifier: Apache-2.0
// Two films: of a flow in time, made by the library, and of a camera that goes around a simulation as it runs: film FLOW_{n}.png ORBIT.webm
#include <sightglass/operations.h>

#include <cmath>
#include <cstdio>

namespace {

// A simulation: heat that spreads on a grid of n^3 points.
struct Heat {
  static constexpr size_t n = 24;
  std::vector<float> now = std::vector<float>(n * n * n, 0.0f);
  Heat() { now[(n / 2 * n + n / 2) * n + n / 3] = 1000; }
  void step() {
    std::vector<float> next = now;
    for (size_t i = n * n; i < now.size() - n * n; ++i)
      next[i] += 0.15f * (now[i - 1] + now[i + 1] + now[i - n] + now[i + n] + now[i - n * n] + now[i + n * n] - 6 * now[i]);
    now = next;
  }
};

}  // namespace

int main(int argc, char** argv) {
  try {
    // What has a time follows it: the source of a flow here, a series of files as well.
    const sg::Data flow = sg::source("double_gyre", {{"dims", {101, 51, 1}}});
    sg::Context work;
    work.on_progress([](double fraction, std::string_view) { std::fprintf(stderr, "\r%3.0f%%", 100 * fraction); });
    sg::Scene scene;
    scene.show(flow, sg::shows::Surface{.field = "velocity"}).picture({{"title", "Double gyre at {t}"}});
    scene.film(argc > 1 ? argv[1] : "flow_{n}.png", sg::settings::Film{.times = "0:10:5"}, 640, 360, work);
    std::fprintf(stderr, "\n");

    // Pictures of its own the program adds one by one.
    sg::Film orbit(argc > 2 ? argv[2] : "orbit_{n}.png", {{"fps", 10}});
    Heat heat;
    for (int i = 0; i < 20; ++i) {
      for (int k = 0; k < 5; ++k) heat.step();
      const sg::Data grid = sg::uniform_grid({Heat::n, Heat::n, Heat::n}).with_point_field("T", heat.now, "K");
      const double angle = i * 3.1416 / 20;
      sg::Scene picture;
      picture.show(grid.run("contour", {{"values", {0.1, 1}}}), "surface", {{"opacity", 0.5}}).show(grid, "outline");
      picture.camera({{"position", {12 + 75 * std::cos(angle), 12 + 75 * std::sin(angle), 35}}});
      orbit.add(picture.render(320, 240));
    }
    orbit.finish();
  } catch (const sg::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
