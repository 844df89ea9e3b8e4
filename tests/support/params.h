// SPDX-License-Identifier: Apache-2.0
// Parameters of an operation from the words that users type.
#pragma once
#include <string>
#include <vector>

#include "base/schema/schema.h"

namespace sg::test {

template <class P>
P params_of(const std::vector<std::string>& words) {
  P p;
  Schema s = schema_of(p);
  set_params(s, words, "test");
  return p;
}

}  // namespace sg::test
