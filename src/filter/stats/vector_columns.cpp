// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/vector_columns.h"

#include <algorithm>

namespace sg {

std::vector<VectorColumns> vector_columns(const Table& t, const std::array<int, 3>& but) {
  const auto find = [&](const std::string& name) {
    for (size_t i = 0; i < t.columns.size(); ++i)
      if (t.columns[i].name == name) return int(i);
    return -1;
  };
  const auto number = [&](int i) {
    return i >= 0 && !t.words(size_t(i)) && t.columns[size_t(i)].components() == 1 && std::find(but.begin(), but.end(), i) == but.end();
  };
  std::vector<VectorColumns> found;
  for (size_t i = 0; i < t.columns.size(); ++i) {
    const std::string& x = t.columns[i].name;
    if (x.size() < 3 || !x.ends_with("_x") || !number(int(i))) continue;
    const std::string name = x.substr(0, x.size() - 2);
    const int y = find(name + "_y"), z = find(name + "_z");
    if (!number(y) || find(name) >= 0 || (z >= 0 && !number(z))) continue;
    VectorColumns v{name, {i, size_t(y)}};
    if (z >= 0) v.columns.push_back(size_t(z));
    found.push_back(std::move(v));
  }
  return found;
}

Field joined(const Table& t, const VectorColumns& v) {
  const size_t n = t.columns[v.columns[0]].array.count(), width = v.columns.size();
  const bool narrow =
      std::all_of(v.columns.begin(), v.columns.end(), [&](size_t c) { return t.columns[c].array.type() == ElementType::f32; });
  Field f{v.name, Association::point, {}, t.columns[v.columns[0]].unit, Role::vectors};
  const auto fill = [&](auto* to) {
    for (size_t i = 0; i < n; ++i)
      for (size_t c = 0; c < width; ++c) *to++ = static_cast<std::remove_reference_t<decltype(*to)>>(t.columns[v.columns[c]].array.get(i));
  };
  if (narrow) {
    float* to = nullptr;
    f.array = Array::make<float>(n, int(width), &to);
    fill(to);
  } else {
    double* to = nullptr;
    f.array = Array::make<double>(n, int(width), &to);
    fill(to);
  }
  return f;
}

}  // namespace sg
