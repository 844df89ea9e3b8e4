// SPDX-License-Identifier: Apache-2.0
// Zones of a Tecplot ASCII file.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sg::tecplot {

struct Zone {
  std::string title;
  std::string type;  ///< "ORDERED", "FETRIANGLE", ...
  std::array<size_t, 3> dims{1, 1, 1};
  size_t nodes = 0, elements = 0;  ///< of finite-element zones
  bool block = false;
  std::vector<bool> at_cells;  ///< per variable
  std::vector<bool> wide;      ///< per variable: double precision
  std::optional<double> time;
  std::vector<std::vector<double>> values;  ///< per variable; empty = passive
  std::vector<int64_t> connectivity;        ///< from 0
  bool ordered() const { return type == "ORDERED"; }
  size_t points() const { return ordered() ? dims[0] * dims[1] * dims[2] : nodes; }
  size_t cells() const;
  size_t corners() const;  ///< nodes of an element
};

struct File {
  std::string title;
  std::vector<std::string> variables;
  std::vector<Zone> zones;
};

/// Throws Error(data) naming the file and the line.
File parse(std::string_view text, const std::string& where);

}  // namespace sg::tecplot
