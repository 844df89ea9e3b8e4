// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "data/memory/memo.h"
#include "pipeline/graph/graph.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("graph: a contour whose value is changed again and again builds an index of its input and gives the same surfaces") {
  Graph graph;
  Context context;
  const NodeId source = graph.add_operation("tangle", {"size=40"});
  const DatasetPtr input = std::get<DatasetPtr>(graph.evaluate(source, {}, context));
  const char* values[] = {"values=0", "values=1", "values=2.5", "values=-0.5"};
  for (size_t k = 0; k < std::size(values); ++k) {
    const auto result = std::get<DatasetPtr>(graph.evaluate(graph.add_operation("contour", {values[k]}, {source}), {}, context));
    CHECK((input->memo().bytes() > 0) == (k > 0));  // the second contour makes it
    Graph other;
    const auto alone = std::get<DatasetPtr>(
        other.evaluate(other.add_operation("contour", {values[k]}, {other.add_operation("tangle", {"size=40"})}), {}, context));
    const Array &a = result->as<SurfaceMesh>()->polygons.connectivity, &b = alone->as<SurfaceMesh>()->polygons.connectivity;
    REQUIRE(a.count() > 0);
    REQUIRE(a.count() == b.count());
    CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  }
  CHECK(std::get<DatasetPtr>(graph.evaluate(source, {}, context)) == input);  // the same data all the time
}
