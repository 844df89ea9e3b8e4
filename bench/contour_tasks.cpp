// SPDX-License-Identifier: Apache-2.0
// Contours of grids and of tetrahedra, once and again and again.
#include <fmt/core.h>

#include "bench.h"
#include "filter/scalar/contour/contour.h"
#include "inputs.h"

namespace sg::bench {

namespace {

// The ten values that the peers' scripts ask for in turn.
constexpr double values_in_turn[] = {-1.5, -1.2, -0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9, 1.2};

Task contouring(const char* size, bool normals, const std::function<DatasetPtr()>& input) {
  return {"contour", size, fmt::format("sightglass:contour(normals={})", normals ? "on" : "off"), "triangles", [=] {
            const DatasetPtr d = input();
            return [=] {
              Context context;
              ContourParams p;
              p.values = {0};
              p.normals = normals;
              return double(contour(d, p, context)->cell_count());
            };
          }};
}

Task in_turn(const char* size, const std::function<DatasetPtr()>& input) {
  return {"contour_10_isovalues", size, "sightglass:contour", "triangles (sum of 10)", [=] {
            const DatasetPtr d = input();
            return [=] {
              double triangles = 0;
              const DatasetPtr fresh = make_dataset(d->parts());  // knows nothing from the run before: what an index costs is counted
              for (double value : values_in_turn) {
                Context context;
                ContourParams p;
                p.values = {value};
                p.normals = false;
                triangles += double(contour(fresh, p, context)->cell_count());
              }
              return triangles;
            };
          }};
}

}  // namespace

void add_contour_tasks(std::vector<Task>& tasks) {
  const auto grid = [](size_t n) { return [n] { return field_grid(n); }; };
  const auto tets = [](size_t n) { return [n] { return tetrahedra(n); }; };
  tasks.push_back(contouring("uniform256", true, grid(256)));
  tasks.push_back(contouring("uniform512", true, grid(512)));
  tasks.push_back(contouring("tet1M", true, tets(55)));
  tasks.push_back(contouring("tet5M", true, tets(94)));
  tasks.push_back(in_turn("uniform256", grid(256)));
  tasks.push_back(in_turn("tet5M", tets(94)));
}

}  // namespace sg::bench
