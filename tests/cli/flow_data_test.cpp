// SPDX-License-Identifier: Apache-2.0
// Flows of real files whose answers are known.
#include <filesystem>

#include "base/file/file.h"
#include "program.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("topology: the steady wake of a cylinder has two centres, one saddle and no periodic orbit" * doctest::skip(no_data())) {
  const std::string f = std::filesystem::absolute(data_file("vectors/cylinder_Re35/cylinder_Re35.case")).string();
  const Ran r = sightglass({"info", f, "-f", "topology"});
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.err.find("3 critical points: 1 saddle; 2 centre; indices sum to 1") != std::string::npos);
  CHECK(r.err.find("periodic orbit") == std::string::npos);
  CHECK(r.err.find("families of closed lines around centres") != std::string::npos);
  CHECK(r.err.find("4 switch points of the border") != std::string::npos);  // front, back, and where the flow leaves on both sides
}

TEST_CASE("topology: eddies without divergence are centres, as many as saddles, without periodic orbits" * doctest::skip(no_data())) {
  const std::string f = std::filesystem::absolute(data_file("vectors/eddy_uv/eddy_uv.nek5000")).string();
  const Ran r = sightglass({"info", f, "-f", "topology separatrices=false"});
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.err.find("56 critical points: 28 saddle; 28 centre; indices sum to 0") != std::string::npos);  // periodic in both directions
  CHECK(r.err.find("periodic orbit") == std::string::npos);
}

TEST_CASE("ftle: ocean currents in metres a second over degrees" * doctest::skip(no_data())) {
  const std::string f = folder_of(
      std::filesystem::absolute(data_file("vectors/globcurrent-2002-01/20020101000000-GLOBCURRENT-L4-CUReul_hs-ALT_SUM-v02.0-fv01.0.nc"))
          .string());
  const auto run = [&](const std::string& words) {
    return sightglass({"info", f + "*.nc", "-f",
                       "calc expr=vec(eastward_eulerian_current_velocity,northward_eulerian_current_velocity,0) name=current", "-f",
                       "ftle size=40 duration=10" + words});
  };
  const Ran r = run(" geographic=true");
  INFO(r.err);
  REQUIRE(r.status == 0);
  // Neighbours in eddies of 200 km at half a metre a second part by e in days, not in seconds.
  const size_t at = r.out.find("ftle");
  REQUIRE(at != std::string::npos);
  const size_t dots = r.out.find("..", at);
  REQUIRE(dots != std::string::npos);
  const double most = std::stod(r.out.substr(dots + 2));
  CHECK(most > 0.1);
  CHECK(most < 1);
  CHECK(run("").err.find("geographic=true converts it") != std::string::npos);
}
