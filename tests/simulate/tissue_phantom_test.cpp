// SPDX-License-Identifier: Apache-2.0
#include "simulate/tissue_phantom.h"

#include <cstring>

#include "base/parallel.h"
#include "support/test.h"

using namespace sg;

namespace {
DatasetPtr run(TissuePhantomParams p) {
  Context context;
  return tissue_phantom(p, context);
}
}  // namespace

TEST_CASE("tissue phantom: noise, bias and shares are what was asked") {
  TissuePhantomParams p;
  p.grid.size = 48;
  const auto d = run(p);
  const auto& f = d->fields();
  const Array &truth = f.require("truth").array, &signal = f.require("intensity").array, &bias = f.require("truth_bias").array;
  Range range;
  double air = 0, n_air = 0, square = 0, n_white = 0, tissue[4] = {};
  for (size_t i = 0; i < truth.count(); ++i) {
    const int t = int(truth.get(i));
    ++tissue[t];
    double shares = 0;
    for (const char* name : {"truth_fraction_1", "truth_fraction_2", "truth_fraction_3"}) shares += f.require(name).array.get(i);
    CHECK(shares <= 1.00001);
    if (t > 0) range.add({bias.get(i), bias.get(i)});
    if (shares == 0) air += signal.get(i) * signal.get(i), ++n_air;
    if (f.require("truth_fraction_3").array.get(i) == 1) {
      const double e = signal.get(i) - 100 * bias.get(i);
      square += e * e, ++n_white;
    }
  }
  CHECK(range.lo == doctest::Approx(0.8).epsilon(0.02));
  CHECK(range.hi == doctest::Approx(1.2).epsilon(0.02));
  CHECK(std::sqrt(air / n_air) == doctest::Approx(5 * std::sqrt(2.0)).epsilon(0.02));  // Rayleigh: two channels
  CHECK(std::sqrt(square / n_white) == doctest::Approx(5).epsilon(0.04));
  for (const double t : tissue) CHECK(t > 1000);
}

TEST_CASE("tissue phantom: the same bytes for any number of threads, other noise for another seed") {
  TissuePhantomParams p;
  p.grid.size = 24;
  const auto a = run(p);
  set_thread_count(1);
  const auto b = run(p);
  set_thread_count(0);
  p.seed = 2;
  const auto c = run(p);
  const auto bytes = [](const DatasetPtr& d) { return d->fields().require("intensity").array; };
  CHECK(std::memcmp(bytes(a).raw(), bytes(b).raw(), bytes(a).bytes()) == 0);
  CHECK(std::memcmp(bytes(a).raw(), bytes(c).raw(), bytes(a).bytes()) != 0);
  p.means = {1, 2};
  CHECK(test::error_of([&] { run(p); }).find("give four") != std::string::npos);
}
