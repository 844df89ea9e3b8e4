// SPDX-License-Identifier: Apache-2.0
// A simulation's own records used where they lie, a filter run on them, and its numbers read back: own_arrays OUT.png
#include <sightglass/sightglass.h>

#include <cmath>
#include <cstdio>

namespace {

struct Node {  // as a simulation might keep them: place and state together
  double x, y, z;
  float temperature, pressure;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    // A sheet of 100 x 100 nodes, bent; two triangles a square.
    constexpr int n = 100;
    auto nodes = std::make_shared<std::vector<Node>>();
    std::vector<int32_t> triangles;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x = i / (n - 1.0), y = j / (n - 1.0), z = 0.2 * std::sin(6.283 * x) * std::sin(6.283 * y);
        nodes->push_back({x, y, z, float(300 + 100 * z), float(x)});
        const int a = j * n + i;
        if (i + 1 < n && j + 1 < n) triangles.insert(triangles.end(), {a, a + 1, a + n + 1, a, a + n + 1, a + n});
      }

    // No copies: the arrays point into the records, and hold them as long as anything needs them.
    const auto points = sg::Array::wrap_strided(&nodes->front().x, nodes->size(), 3, sizeof(Node), nodes);
    const auto heat = sg::Array::wrap_strided(&nodes->front().temperature, nodes->size(), 1, sizeof(Node), nodes);
    const sg::Data sheet = sg::triangle_mesh(points, std::move(triangles)).with_point_field("temperature", heat, "K");

    const sg::Data warm = sheet.run("clip", {{"field", "temperature"}, {"value", 300}});
    const std::vector<double> t = warm.field("temperature").values.numbers();
    const sg::Cells cells = warm.cells();
    std::printf("%zu of %zu cells; the first triangle has %g, %g, %g K\n", warm.cell_count(), sheet.cell_count(),
                t[size_t(cells.ids.get(0))], t[size_t(cells.ids.get(1))], t[size_t(cells.ids.get(2))]);
    std::printf("area %g\n", warm.run("integrate").field("measure").values.get(0));

    sg::Scene().show(warm).show(sheet, "outline").render(800, 600).write(argc > 1 ? argv[1] : "own_arrays.png");
  } catch (const sg::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
