// SPDX-License-Identifier: Apache-2.0
// What every test file includes: doctest, the data folder, and checks for errors.
#pragma once
#include <doctest/doctest.h>

#include <string>
#include <string_view>

#include "base/error.h"

namespace sg::test {

/// Folder of real data: $SIGHTGLASS_DATA, else ../shared/data beside the checkout; "" when there is none.
/// Use: TEST_CASE("..." * doctest::skip(sg::test::no_data())) and it counts as SKIPPED.
const std::string& data_folder();
inline bool no_data() { return data_folder().empty(); }
/// Path of a file in the data folder.
std::string data_file(const std::string& name);
/// The checkout, and the folder of the build; without trailing '/'.
const char* source_folder();
const char* build_folder();
/// A fresh folder that is removed when the program ends; with trailing '/'.
const std::string& temp_folder();
/// An empty folder in it; with trailing '/'.
std::string fresh_folder(const std::string& name);

/// The message of the Error that f throws; fails the test when it throws none.
template <class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  FAIL_CHECK("no Error was thrown");
  return "";
}

inline bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// Observed order of convergence: least-squares slope of log(error) against log(h).
double observed_order(const double* h, const double* error, int n);

}  // namespace sg::test
