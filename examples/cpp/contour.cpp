// SPDX-License-Identifier: Apache-2.0
// A dataset built from numbers in memory, its contour, and a picture of both: contour OUT.png
#include <sightglass/operations.h>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv) {
  try {
    // Two charges on a grid of 64^3 points in the cube from -1 to 1; x is fastest.
    constexpr size_t n = 64;
    constexpr double step = 2.0 / (n - 1);
    std::vector<float> potential;
    for (size_t k = 0; k < n; ++k)
      for (size_t j = 0; j < n; ++j)
        for (size_t i = 0; i < n; ++i) {
          const double x = -1 + double(i) * step, y = -1 + double(j) * step, z = -1 + double(k) * step;
          potential.push_back(float(1 / std::hypot(x - 0.5, y, z) - 1 / std::hypot(x + 0.5, y, z)));
        }
    const sg::Data grid =
        sg::uniform_grid({n, n, n}, {step, step, step}, {-1, -1, -1}).with_point_field("potential", std::move(potential), "V");

    const sg::Data surfaces = grid.run(sg::ops::Contour{.field = "potential", .values = {-2, -1, 1, 2}});
    std::printf("%s\n", surfaces.summary().c_str());

    sg::Scene scene;
    scene.show(surfaces, sg::shows::Surface{.field = "potential", .opacity = 0.6}).show(grid, "outline");
    scene.camera({{"azimuth", 20}}).picture({{"title", "Two charges"}});
    scene.render(800, 600).write(argc > 1 ? argv[1] : "contour.png");
  } catch (const sg::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
