// SPDX-License-Identifier: Apache-2.0
// What the library's errors say.
#pragma once
#include <functional>
#include <string>

#include "api/sightglass.h"

namespace sg::test {

/// The message of the Error that f throws; "" when it throws none.
inline std::string refused(const std::function<void()>& f) {
  try {
    f();
  } catch (const sightglass::Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace sg::test
