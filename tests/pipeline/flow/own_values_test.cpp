// SPDX-License-Identifier: Apache-2.0
// Lines and surfaces of a flow have values of their own; the velocity may be called as one of them.
#include "filter/flow/flow_meshes.h"
#include "pipeline/operation/operation.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("flow: a velocity that is called as a value of the lines stays, and so does the value under another name") {
  const DatasetPtr mesh = make_dataset(uniform({6, 6, 6}, {-1, -1, -1}, {1, 1, 1}));
  for (const char* name : {"speed", "time", "length", "age", "seed parameter", "texture coordinates", "release time"}) {
    DatasetParts parts = mesh->parts();
    parts.fields.add({name, Association::point,
                      at_points<float>(
                          mesh->mesh(), [](Vec3) { return Vec3(3, 4, 0); }, 3),
                      "", Role::vectors});
    const Data flow = make_dataset(std::move(parts));
    struct Run {
      const char* operation;
      std::vector<std::string> words;
    };
    const Run runs[] = {{"streamlines", {"count=5", "attributes=vorticity,rotation"}},
                        {"stream_surface", {"from=-0.9,-0.9,-0.5", "to=-0.9,-0.9,0.5", "spacing=0.2"}}};
    for (const Run& run : runs) {
      CAPTURE(name);
      CAPTURE(run.operation);
      Context context;
      const Data out = run_operation(find_operation(run.operation), {flow}, run.words, context);
      const DatasetPtr d = single_dataset(out, "test");
      const Field& velocity = d->fields().require(name, Association::point);
      REQUIRE(velocity.components() == 3);
      CHECK(velocity.array.count() > 5);
      for (size_t i = 0; i < velocity.array.count(); ++i) {
        CHECK(velocity.array.get(i, 0) == 3);
        CHECK(velocity.array.get(i, 1) == 4);
      }
      const Field& speed = d->fields().require(name == std::string("speed") ? "speed_2" : "speed", Association::point);
      CHECK(speed.components() == 1);
      CHECK(d->range(speed).lo == 5);
      CHECK(d->range(speed).hi == 5);
    }
    for (const char* op : {"pathlines", "streaklines", "path_surface", "streak_surface"}) {
      CAPTURE(name);
      CAPTURE(op);
      const Operation& o = find_operation(op);
      Context context;
      const Series series{{0, 0.05, 0.1}, [&](size_t) { return flow; }};
      const Data out = o.run_series(series, {}, make_params(o, {}), context);
      for_each_dataset(out, [&](const std::string&, const DatasetPtr& d) {
        const Field& velocity = d->fields().require(name, Association::point);
        REQUIRE(velocity.components() == 3);
        for (size_t i = 0; i < velocity.array.count(); ++i) CHECK(velocity.array.get(i, 1) == 4);
      });
    }
  }
}
