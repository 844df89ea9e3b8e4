// SPDX-License-Identifier: Apache-2.0
// First pictures of flows whose outside tells nothing.
#include <cmath>

#include "filter/mesh/to_unstructured.h"
#include "scene/look/look.h"
#include "support/test.h"

using namespace sg;

namespace {

// n^3 points of a room with a vortex in it, as a solid mesh; `bulge` lifts the middle of its roof.
DatasetPtr room(size_t n, const char* vectors, double bulge = 0) {
  CurvilinearGrid g;
  g.dims = {n, n, n};
  std::vector<float> xyz, u, p;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const double step = 2 / double(n - 1), x = step * double(i) - 1, y = step * double(j) - 1, z = step * double(k) - 1;
        const double lift = bulge * std::cos(1.5 * x) * std::cos(1.5 * y) * (z + 1);
        xyz.insert(xyz.end(), {float(x), float(y), float(z + lift)});
        u.insert(u.end(), {float(-y), float(x), float(0.1 * z)});
        p.push_back(float(x * y + z));
      }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"p", Association::point, Array::from_vector(std::move(p)), "", Role::scalars});
  parts.fields.add({vectors, Association::point, Array::from_vector(std::move(u), 3), "", Role::vectors});
  return make_dataset(std::move(parts));
}

std::string filter_of(const DatasetPtr& d, const std::string& field = "") {
  Context context;
  Look look = choose_look(*d, field, "vts");
  show_flow(look, d, field, context);
  return look.filter.empty() ? "" : look.filter[0] + " " + look.filter.at(1);
}

}  // namespace

TEST_CASE("first look: a flow in a closed box is shown by its streamlines") {
  Context context;
  CHECK(filter_of(room(9, "velocity")) == "streamlines field=velocity");
  CHECK(filter_of(to_unstructured(room(9, "velocity"), {}, context)) == "streamlines field=velocity");
  CHECK(filter_of(room(9, "velocity", 0.3)) == "");  // its shape tells something
  CHECK(filter_of(room(9, "displacement")) == "");
  CHECK(filter_of(room(4, "velocity")) == "");  // few cells
  CHECK(filter_of(room(9, "velocity"), "p") == "");
}
