// SPDX-License-Identifier: Apache-2.0
#include "simulate/mechanics/examples.h"

namespace sg::mechanics {

SpringNet::SpringNet(int size, double mass, double length, double stiffness, double gravity) : mass_(mass), gravity_(gravity) {
  const double step = length / (size - 1);
  const auto at = [&](int i, int j) { return i + size * j; };
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      rest_.push_back({i * step, j * step, 0});
      if (!(j == size - 1 && (i == 0 || i == size - 1))) free_.push_back(at(i, j));
      const double across = step * std::sqrt(2.0);
      if (i + 1 < size) springs_.push_back({at(i, j), at(i + 1, j), step, stiffness, true});
      if (j + 1 < size) springs_.push_back({at(i, j), at(i, j + 1), step, stiffness, true});
      if (i + 1 < size && j + 1 < size) {
        springs_.push_back({at(i, j), at(i + 1, j + 1), across, stiffness / 4, false});
        springs_.push_back({at(i + 1, j), at(i, j + 1), across, stiffness / 4, false});
      }
    }
}

std::vector<double> SpringNet::start() const {
  std::vector<double> q;
  for (const int i : free_)
    for (int a = 0; a < 3; ++a) q.push_back(rest_[size_t(i)][a]);
  return q;
}

std::vector<std::pair<int, int>> SpringNet::rods() const {
  std::vector<std::pair<int, int>> r;
  for (const Spring& s : springs_)
    if (s.side) r.emplace_back(s.a, s.b);
  return r;
}

}  // namespace sg::mechanics
