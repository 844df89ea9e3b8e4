// SPDX-License-Identifier: Apache-2.0
// The text headers of an AMReX or BoxLib plotfile. Source: AMReX documentation, "Plotfile Format", and amrex/Src/Base/AMReX_VisMF.
//
//   plt00010/Header            version, names, dimension, time, levels, domains, spacing; boxes in space and where the data are
//            Level_0/Cell_H    boxes of cells, and for each box file and byte of its FAB
//            Level_0/Cell_D_*  FABs: a line of text (number format, box, components), then the numbers, one component after the other
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace sg::amrex {

struct Box {
  std::array<long long, 3> lo{0, 0, 0}, hi{0, 0, 0};
};

/// Where the numbers of one box lie.
struct Fab {
  std::string file;
  uint64_t offset = 0;
};

struct Level {
  Vec3 spacing{1, 1, 1};
  std::array<int, 3> ratio{1, 1, 1};  ///< to the level above
  std::vector<Box> boxes;
  std::vector<Fab> fabs;
};

struct Plotfile {
  std::vector<std::string> names;
  int dimension = 3;
  double time = 0;
  Vec3 lo{0, 0, 0};  ///< corner of the domain
  Box domain;        ///< of level 0
  std::vector<Level> levels;
};

/// Reads Header and all Cell_H. Throws Error(data) that names file and line.
Plotfile read_headers(const std::string& folder);

/// Reads "((0,0,0) (7,7,7) (0,0,0))" at the begin of `text` and drops it; false when it is none.
bool take_box(std::string_view& text, int dimension, Box& box);

}  // namespace sg::amrex
