// SPDX-License-Identifier: Apache-2.0
#include "simulate/run/frames.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file/file.h"
#include "simulate/fluid/smoke.h"
#include "support/test.h"

using namespace sg;

namespace {

SmokeParams plume() {
  SmokeParams p;
  p.size = 16, p.frame = 0.05, p.swirl = 0.5, p.obstacle = {0.5, 0.5, 1.1, 0.15}, p.obstacle_velocity = {0.1, 0, 0}, p.lift = 3;
  return p;
}

std::string bytes_of(const DatasetPtr& d) {
  std::string out;
  for (const char* name : {"density", "temperature", "velocity", "pressure"}) {
    const Array& a = d->fields().require(name).array;
    out.append(reinterpret_cast<const char*>(a.raw()), a.count() * size_t(a.components()) * sizeof(float));
  }
  return out;
}

// A frame by a program that has just begun: nothing is kept in memory but for the run of other parameters.
DatasetPtr afresh(const SmokeParams& p) {
  Context context;
  SmokeParams other;
  other.size = 8;
  smoke(other, context);
  return smoke(p, context);
}

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

}  // namespace

TEST_CASE("runs: one that was broken off goes on from its stored state to the bytes of an unbroken one") {
  const std::string folder = test::fresh_folder("runs");
  SmokeParams p = plume();
  p.time = 0.05 * 9;
  const std::string unbroken = bytes_of(afresh(p));
  SmokeParams stored = p;
  stored.store = folder + "run", stored.store_every = 3;
  stored.time = 0.05 * 5;
  afresh(stored);
  CHECK(StateFile(stored.store).frame() == 5);
  stored.time = p.time;
  CHECK(bytes_of(afresh(stored)) == unbroken);
  CHECK(StateFile(stored.store).frame() == 9);
  // An earlier frame is computed from the beginning, and leaves the later state alone.
  SmokeParams early = stored;
  early.time = 0.05 * 2;
  SmokeParams early_plain = p;
  early_plain.time = early.time;
  CHECK(bytes_of(afresh(early)) == bytes_of(afresh(early_plain)));
  CHECK(StateFile(stored.store).frame() == 9);
}

TEST_CASE("runs: a state of another run, a damaged and a cut one are refused") {
  const std::string folder = test::fresh_folder("runs");
  SmokeParams p = plume();
  p.time = 0.05, p.store = folder + "run";
  afresh(p);
  SmokeParams other = p;
  other.lift = 1;
  CHECK_THROWS_WITH_AS(afresh(other), doctest::Contains("another run"), Error);
  Context context;
  smoke(plume(), context);  // the other one's run is no longer kept
  SmokeParams same = other;
  same.store.clear(), same.time = 0.05;
  smoke(same, context);  // kept in memory, not stored
  CHECK_THROWS_WITH_AS(smoke(other, context), doctest::Contains("another run"), Error);
  CHECK(StateFile(p.store).frame() == 1);
  const std::string whole = contents(p.store);
  std::string damaged = whole;
  damaged[damaged.size() / 2] ^= 1;
  p.time = 0.1;
  write(p.store, damaged);
  CHECK_THROWS_WITH_AS(afresh(p), doctest::Contains("damaged"), Error);
  for (const size_t length : {size_t(0), size_t(5), size_t(20), whole.size() / 3, whole.size() - 1}) {
    write(p.store, whole.substr(0, length));
    CHECK_THROWS_AS(afresh(p), Error);
  }
  write(p.store, whole);
  CHECK_NOTHROW(afresh(p));
}

TEST_CASE("runs: frames before the time asked for, and times beyond a million frames") {
  FrameParams p;
  p.frame = 0.1;
  for (const double t : {0.0, 0.05, 0.099}) CHECK((p.time = t, frame_at(p, "x")) == 0);
  CHECK((p.time = 0.3, frame_at(p, "x")) == 3);  // 0.3 / 0.1 is just below 3 in doubles
  p.time = 1e6;
  CHECK_THROWS_WITH_AS(frame_at(p, "x"), doctest::Contains("million"), Error);
}
