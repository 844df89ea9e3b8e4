// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/overlay/overlay.h"

#include <fstream>

#include "support/test.h"

using namespace sg;

namespace {

bool maps(const std::string& library) {
  std::ifstream lines("/proc/self/maps");
  for (std::string line; std::getline(lines, line);)
    if (line.find(library) != line.npos) return true;
  return false;
}

}  // namespace

TEST_CASE("text: Pango that cannot be loaded is an error that names the package to install") {
  const std::string missing = test::error_of([] { load_text_library("libpangocairo-0.9.so.7"); });
  CHECK(missing.find("libpangocairo-0.9.so.7") != missing.npos);
  CHECK(missing.find("install the package libpangocairo-1.0-0") != missing.npos);
  const std::string other = test::error_of([] { load_text_library("libm.so.6"); });
  CHECK(other.find("libm.so.6 has no function cairo_clip") != other.npos);
}

TEST_CASE("text: with the first overlay Pango is there, and measures") {
  const Overlay overlay(64, 32, false);
  CHECK(maps("libpangocairo"));
  const TextExtent one = overlay.measure("m", {.size = 10}), two = overlay.measure("mm", {.size = 10});
  CHECK(one.lines == 1);
  CHECK(two.width == doctest::Approx(2 * one.width).epsilon(0.01));
}
