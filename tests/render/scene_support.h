// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace sg::test {

inline Scene scene_of(std::vector<Item> items) {
  Scene s;
  s.items = std::move(items);
  return s;
}

}  // namespace sg::test
