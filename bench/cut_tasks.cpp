// SPDX-License-Identifier: Apache-2.0
// Slices, clips, thresholds and outer faces of grids and of tetrahedra.
#include "bench.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/select/threshold.h"
#include "filter/mesh/slice/slice.h"
#include "inputs.h"

namespace sg::bench {

namespace {

using Input = std::function<DatasetPtr()>;

Task cutting(const char* task, const char* size, const char* unit, const Input& input,
             const std::function<DatasetPtr(const DatasetPtr&, Context&)>& f) {
  return {task, size, std::string("sightglass:") + task, unit, [=] {
            const DatasetPtr d = input();
            return [=] {
              Context context;
              return double(f(d, context)->cell_count());
            };
          }};
}

DatasetPtr oblique_slice(const DatasetPtr& d, Context& context) {
  SliceParams p;
  p.origin = Vec3{0.03, -0.02, 0.05};
  p.normal = {0.48, 0.36, 0.8};
  return slice(d, p, context);
}

DatasetPtr upper_threshold(const DatasetPtr& d, Context& context) {
  ThresholdParams p;
  p.min = 0.5;
  return threshold(d, p, context);
}

DatasetPtr scalar_clip(const DatasetPtr& d, Context& context) {
  ClipParams p;
  p.value = 0.0;
  return std::get<DatasetPtr>(clip(d, p, context));
}

DatasetPtr plane_clip(const DatasetPtr& d, Context& context) {
  ClipParams p;
  p.origin = Vec3{0.03, -0.02, 0.05};
  p.normal = {-0.48, -0.36, -0.8};  // the side in front, as the peers
  return std::get<DatasetPtr>(clip(d, p, context));
}

DatasetPtr outer_faces(const DatasetPtr& d, Context& context) { return faces(d, {}, context); }

}  // namespace

void add_cut_tasks(std::vector<Task>& tasks) {
  const auto grid = [](size_t n) { return [n] { return field_grid(n); }; };
  const auto tets = [](size_t n) { return [n] { return tetrahedra(n); }; };
  tasks.push_back(cutting("slice_oblique", "uniform512", "polygons", grid(512), oblique_slice));
  tasks.push_back(cutting("slice_oblique", "tet5M", "polygons", tets(94), oblique_slice));
  tasks.push_back(cutting("threshold", "uniform256", "cells kept", grid(256), upper_threshold));
  tasks.push_back(cutting("threshold", "tet5M", "cells kept", tets(94), upper_threshold));
  tasks.push_back(cutting("clip_scalar", "uniform256", "cells out", grid(256), scalar_clip));
  tasks.push_back(cutting("clip_scalar", "tet5M", "cells out", tets(94), scalar_clip));
  tasks.push_back(cutting("clip_plane", "uniform256", "cells out", grid(256), plane_clip));
  tasks.push_back(cutting("clip_plane", "tet5M", "cells out", tets(94), plane_clip));
  tasks.push_back(cutting("external_faces", "tet5M", "faces", tets(94), outer_faces));
  tasks.push_back(cutting(
      "external_faces", "hex1M", "faces", [] { return hexahedra(100); }, outer_faces));
}

}  // namespace sg::bench
