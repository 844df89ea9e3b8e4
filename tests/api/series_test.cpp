// SPDX-License-Identifier: Apache-2.0
// The library for C++ programs: time series that the program makes.
#include <cmath>
#include <set>
#include <stdexcept>

#include "api/api_errors.h"
#include "api/sightglass.h"
#include "support/test.h"

using namespace sightglass;
using sg::test::contains;
using sg::test::refused;

namespace {

// A ball of radius 1 + step, as the field "distance" less that radius.
Data ball_at(size_t step) {
  std::vector<float> f;
  for (int k = -6; k < 7; ++k)
    for (int j = -6; j < 7; ++j)
      for (int i = -6; i < 7; ++i) f.push_back(std::sqrt(float(i * i + j * j + k * k)) - float(1 + step));
  return uniform_grid({13, 13, 13}, {1, 1, 1}, {-6, -6, -6}).with_point_field("f", std::move(f));
}

}  // namespace

TEST_CASE("library: a series of the program's is read step by step, when it is needed") {
  std::vector<size_t> asked;
  const Data growing = series({0, 0.5, 2}, [&](size_t step) { return asked.push_back(step), ball_at(step); });
  CHECK(asked == std::vector<size_t>{0});
  CHECK(growing.times() == std::vector<double>{0, 0.5, 2});
  CHECK(growing.time() == std::optional<double>(0.0));
  const Data surface = growing.run("contour", {{"values", 0}});
  CHECK(asked == std::vector<size_t>{0});  // of what is at hand
  CHECK(surface.times() == growing.times());
  // At other times what lies above runs again: the steps nearest to them.
  for (const auto& [time, step] : {std::pair{0.5, 1}, {0.6, 1}, {99.0, 2}}) {
    const Box b = surface.at(time).bounds();
    CHECK(b.hi[0] == doctest::Approx(1 + step));
    CHECK(asked.back() == size_t(step));
  }
  CHECK(growing.at(2).time() == std::optional<double>(2.0));
  CHECK(growing.at(2).times().empty());
}

TEST_CASE("library: films and operations over time see all steps of a series of the program's") {
  const Data growing = series({0, 1, 2}, [](size_t step) { return ball_at(step); });
  std::vector<double> seen;
  std::set<std::vector<uint8_t>> pictures;
  Scene()
      .show(growing.run("contour", {{"values", 0}}))
      .frames([&](const Frame& f) { seen.push_back(f.time), pictures.emplace(f.image.pixels().begin(), f.image.pixels().end()); }, {}, 60,
              40);
  CHECK(seen == std::vector<double>{0, 1, 2});
  CHECK(pictures.size() == 3);

  // A wind that turns from x to y: dx/dt = 1 - t, dy/dt = t, so that the way from 0 to 1 ends at (1/2, 1/2); between steps it is linear.
  const Data wind = series({0, 1}, [](size_t step) {
    std::vector<float> v;
    for (int i = 0; i < 27; ++i) v.insert(v.end(), {step ? 0.0f : 1.0f, step ? 1.0f : 0.0f, 0.0f});
    return uniform_grid({3, 3, 3}, {1, 1, 1}, {-1, -1, -1}).with_point_field("v", Array(std::move(v), 3));
  });
  const Data lines = wind.run("pathlines", {{"seeds", "points"}, {"points", {0, 0, 0}}});
  const Box b = lines.bounds();
  CHECK(b.hi[0] == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(b.hi[1] == doctest::Approx(0.5).epsilon(1e-3));
}

TEST_CASE("library: what the program's function throws comes out of what asked for the step") {
  struct Mine : std::runtime_error {
    using std::runtime_error::runtime_error;
  };
  const Data broken = series({0, 1}, [](size_t step) {
    if (step == 1) throw Mine("no such run");
    return ball_at(step);
  });
  CHECK_THROWS_AS(broken.at(1), Mine);
  CHECK_THROWS_AS(broken.run("contour", {{"values", 0}}).at(1), Mine);
  CHECK_THROWS_AS(Scene().show(broken).frames([](const Frame&) {}, {}, 32, 24), Mine);
  CHECK_THROWS_AS(series({0}, [](size_t) -> Data { throw Mine("at once"); }), Mine);
  CHECK(broken.run("contour", {{"values", 0}}).cell_count() > 0);  // goes on
}

TEST_CASE("library: series that cannot be are refused, recipes say what they were, and their functions end with them") {
  const auto none = [](size_t) { return ball_at(0); };
  CHECK(contains(refused([&] { series({}, none); }), "a series needs times"));
  CHECK(contains(refused([&] { series({1, 1}, none); }), "time 1 of the series is 1"));
  CHECK(contains(refused([&] { ball_at(0).at(3); }), "does not come from a time series"));
  CHECK(contains(refused([&] { series({0}, [](size_t) { return Data(); }); }), "holds nothing"));
  auto owner = std::make_shared<int>(0);
  std::weak_ptr<int> alive = owner;
  {
    Data held = series({0, 1}, [owner](size_t step) { return ball_at(step); });
    owner.reset();
    const Data surface = held.run("contour", {{"values", 0}});
    held = {};
    CHECK(surface.at(1).cell_count() > 0);  // it came from there
    const std::string recipe = Scene().show(surface).render(32, 24).recipe();
    CHECK(contains(recipe, "time series of a program"));
    CHECK(!contains(recipe, "series:"));
    CHECK(!alive.expired());
  }
  CHECK(alive.expired());
}
