// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

#include "base/context.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("error: the message holds where, problem, hint and the chain of what was being done") {
  try {
    with_context("running 'contour' (step 2)",
                 [] { with_context("reading 'a.vti'", [] { fail_data("ends early", "a.vti:3", "copy it again"); }); });
    FAIL("no error");
  } catch (const Error& e) {
    CHECK(std::string(e.what()) == "a.vti:3: ends early; copy it again (while reading 'a.vti', while running 'contour' (step 2))");
    CHECK(e.kind() == ErrorKind::data);
    CHECK(e.problem() == "ends early");
    CHECK(e.where() == "a.vti:3");
    CHECK(e.hint() == "copy it again");
    CHECK(e.context().size() == 2);
  }
  CHECK(std::string(Error(ErrorKind::usage, "only this").what()) == "only this");
}

TEST_CASE("error: kinds have the exit codes of the command line") {
  CHECK(Error(ErrorKind::usage, "x").exit_code() == 2);
  CHECK(Error(ErrorKind::data, "x").exit_code() == 3);
  CHECK(Error(ErrorKind::internal, "x").exit_code() == 4);
  CHECK(Error(ErrorKind::cancelled, "x").exit_code() == 130);
  CHECK_THROWS_AS(fail_internal("x"), Error);
}

TEST_CASE("error: the nearest name forgives slips, swaps, case and missing ends, and knows when nothing is near") {
  const std::vector<std::string> names{"temperature", "pressure", "velocity", "T"};
  CHECK(nearest_name("tempreature", names) == "temperature");
  CHECK(nearest_name("TEMPERATURE", names) == "temperature");
  CHECK(nearest_name("temp", names) == "temperature");
  CHECK(nearest_name("presure", names) == "pressure");
  CHECK(nearest_name("t", names) == "T");
  CHECK(nearest_name("density_of_states", names).empty());
  CHECK(nearest_name("x", {}).empty());
  CHECK(unknown_name_hint("velocty", names) == "did you mean 'velocity'? available: temperature, pressure, velocity, T");
  CHECK(unknown_name_hint("x", {}) == "none are available");
  std::vector<std::string> many;
  for (int i = 0; i < 30; ++i) many.push_back("name_number_" + std::to_string(i));
  CHECK(unknown_name_hint("zzzzzzzzzzzzzzzzzzzzzzzzzzzzzz", many).ends_with("name_number_23, ... (30 in all)"));
}

TEST_CASE("context: a part reports within its share, logs to its parent and stops with it") {
  Context whole;
  std::vector<double> seen;
  std::string log;
  whole.on_progress = [&](double f, std::string_view) { seen.push_back(f); };
  whole.on_log = [&](LogLevel level, std::string_view text) { log += (level == LogLevel::warning ? "!" : "") + std::string(text); };
  whole.memory_limit = 7;
  Context part(whole, 0.5, 0.75);
  part.progress(0, "a");
  part.progress(1, "b");
  part.warn("careful");
  CHECK(seen == std::vector<double>{0.5, 0.75});
  CHECK(log == "!careful");
  CHECK(part.memory_limit == 7);
  Context inner(part, 0, 0.5);
  inner.progress(1, "c");
  CHECK(seen.back() == 0.625);
  inner.check();
  whole.cancel();
  CHECK(test::error_of([&] { inner.check(); }) == "cancelled");
  Context other;
  Context silent(other, 0, 1);
  silent.progress(1, "nobody listens");
  silent.cancel();
  CHECK(silent.cancelled());
  CHECK_FALSE(other.cancelled());
}
