// SPDX-License-Identifier: Apache-2.0
// Lists of numbers as JSON.
#pragma once
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/text/json.h"
#include "base/vec.h"

namespace sg::offline {

/// What is not finite is null: JSON has no word for it.
inline Json number(double v) { return std::isfinite(v) ? Json(v) : Json(); }
inline Json numbers(const std::vector<double>& values) {
  std::vector<Json> list;
  for (const double v : values) list.push_back(number(v));
  return Json(std::move(list));
}
inline Json numbers(std::initializer_list<double> values) { return numbers(std::vector<double>(values)); }
inline Json numbers(Vec3 v) { return numbers({v.x, v.y, v.z}); }
inline Json numbers(Vec3f v) { return numbers({double(v.x), double(v.y), double(v.z)}); }
inline Json numbers(Vec4f v) { return numbers({double(v.x), double(v.y), double(v.z), double(v.w)}); }
inline Json text(std::string_view s) { return Json(std::string(s)); }
inline Json texts(const std::vector<std::string>& values) {
  std::vector<Json> list;
  for (const std::string& v : values) list.push_back(text(v));
  return Json(std::move(list));
}

}  // namespace sg::offline
