// SPDX-License-Identifier: Apache-2.0
// The colour scale that is chosen for the first field of a dataset.
#pragma once
#include "scene/choose/scale.h"

namespace sg::test {

/// What is said of the choice is added to `log`.
inline ColorScale chosen_scale(const DatasetPtr& d, const ColoringParams& p = {}, std::string* log = nullptr) {
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) {
    if (log) *log += std::string(text) + "\n";
  };
  return choose_scale(*d, d->fields()[0], p, context);
}

}  // namespace sg::test
