// SPDX-License-Identifier: Apache-2.0
#include "pipeline/film/write_series.h"

#include "base/error.h"
#include "support/same_data.h"
#include "support/test.h"

using namespace sg;

namespace {

PipelineFile smoke_run(const std::string& words) {
  return parse_pipeline(
      "sightglass: 1\nsteps:\n  air: {smoke: {size: 12, frame: 0.1" + words + "}}\n  thin: {threshold: {field: density, min: -1}}\n",
      "test");
}

DatasetPtr step_of(const std::string& path, int64_t step) {
  Context context;
  ReadOptions o;
  o.step = step;
  return std::get<DatasetPtr>(read_data(path, o, context));
}

}  // namespace

TEST_CASE("series: a run that is broken off and resumed writes what an unbroken one does") {
  const std::string folder = test::fresh_folder("write_series"), store = ", store: '" + folder + "air.run', store_every: 1";
  Context context;
  const std::string whole = folder + "whole.vtkhdf", broken = folder + "broken.vtkhdf";
  CHECK(write_series(smoke_run(""), {whole, "0:0.5:6", false}, {}, context).steps == 6);
  size_t told = 0;
  const auto stop = [&](size_t, double, const Data&) {
    if (++told == 3) throw Error(ErrorKind::data, "stopped");
  };
  CHECK_THROWS_AS(write_series(smoke_run(store), {broken, "0:0.5:6", false}, {}, context, stop), Error);
  const SeriesWritten rest = write_series(smoke_run(store), {broken, "0:0.5:6", true}, {}, context);
  CHECK(rest.before == 3);
  for (int64_t k = 0; k < 6; ++k)
    for (const char* field : {"density", "velocity"})
      CHECK(test::same_array(step_of(whole, k)->fields().require(field).array, step_of(broken, k)->fields().require(field).array));
  // Where its state is kept is no part of a series; what is computed is.
  CHECK(write_series(smoke_run(""), {broken, "0:0.5:6", true}, {}, context).before == 6);
  CHECK_THROWS_WITH_AS(write_series(smoke_run(", time: 0.1"), {folder + "still.pvd", "0:0.5:6", false}, {}, context),
                       doctest::Contains("time"), Error);
  CHECK_THROWS_AS(write_series(smoke_run(", lift: 2"), {broken, "0:0.5:6", true}, {}, context), Error);
}
