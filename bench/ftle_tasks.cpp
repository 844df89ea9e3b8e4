// SPDX-License-Identifier: Apache-2.0
// FTLE of the double gyre (T = 15) from 61 steps on a grid, for 512x256 seeds. The peer: ftle_vtk.py.
#include "bench.h"
#include "filter/flow/vortex/ftle.h"
#include "simulate/flow_fields.h"

namespace sg::bench {

void add_ftle_tasks(std::vector<Task>& tasks) {
  tasks.push_back({"ftle_double_gyre", "512x256 seeds x 60 intervals", "sightglass:ftle", "seeds", [] {
                     Series series;
                     std::vector<DatasetPtr> steps;
                     for (int k = 0; k <= 60; ++k) {
                       DoubleGyreParams g;
                       g.grid.size = 201, g.time = 0.25 * k;
                       Context context;
                       steps.push_back(double_gyre(g, context));
                       series.times.push_back(g.time);
                     }
                     series.load = [steps](size_t k) -> Data { return steps[k]; };
                     return [series] {
                       Context context;
                       FtleParams p;
                       p.duration = 15, p.dims = {512, 256, 1};
                       return double(ftle(series, p, context)->point_count());
                     };
                   }});
}

}  // namespace sg::bench
