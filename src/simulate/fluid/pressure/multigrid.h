// SPDX-License-Identifier: Apache-2.0
// The discrete Laplacian between walls, and a multigrid cycle that nearly inverts it.
#pragma once
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "simulate/fluid/walls/walls.h"

namespace sg::fluid {

/// (A p)_i = sum over the faces of cell i of c w (p_i - p_neighbour), where w is the open share of the face (0: solid) and c its area
/// divided by the distance of the middles, 1 on the finest level. At open sides p is 0 on the border itself, half a cell away: there c is
/// twice as large. A is symmetric, positive semidefinite; cells without an open face ("dry") take no part.
///
/// precondition() is one symmetric V-cycle: red-black Gauss-Seidel before, black-red after, linear interpolation between the middles of
/// cells (Trottenberg, Oosterlee, Schueller 2001, 2.8.4) and its transpose for residuals, walls coarsened by averages of their open
/// shares, cells that are all but solid closed. As a preconditioner of conjugate gradients it needs no more at obstacles (McAdams, Sifakis,
/// Teran 2010).
template <class T>
class Multigrid {
 public:
  Multigrid(std::array<size_t, 3> cells, Walls<T> walls);

  void apply(const Lattice<T>& x, Lattice<T>& out, const Context& context) const;
  /// x = M b with M symmetric, positive definite where A is, about the inverse of A. `spare` is as large as they are.
  void precondition(const Lattice<T>& b, Lattice<T>& x, Lattice<T>& spare, const Context& context);
  const Walls<T>& walls() const { return levels_.front().walls; }
  /// Cells of air, one byte each, in which p is 0: they take no part. Where the list is empty there are none. A coarse cell is air where
  /// any of its fine ones is (McAdams, Sifakis, Teran 2010).
  void set_air(std::vector<uint8_t> air);
  size_t levels() const { return levels_.size(); }

 private:
  struct Stencil {  // fine places that one coarse place takes part in, along an axis
    int first = 0, count = 0;
    T weight[4] = {};
  };
  struct Level {
    std::array<size_t, 3> n{};
    std::array<T, 3> coupling{1, 1, 1};
    Walls<T> walls;
    std::vector<uint8_t> air;                    // cells; empty where there are none
    std::vector<uint8_t> plain;                  // rows of cells whose faces are all open inside, and alike along y and z
    std::array<std::vector<Stencil>, 3> coarse;  // of the next level
    Lattice<T> x, b, r;                          // of all but the finest
  };
  template <class F>
  static void each_row(const Level& l, const Lattice<T>& x, const Context& context, F&& f);
  template <class F>
  static void each_sum(const Level& l, const Lattice<T>& x, const Context& context, F&& f);
  static void find_plain_rows(Level& l);
  static void clear_air(const Level& l, size_t row, T* to);
  void cycle(size_t level, const Lattice<T>& b, Lattice<T>& x, Lattice<T>& r, const Context& context);
  void smooth(const Level& l, const Lattice<T>& b, Lattice<T>& x, int color, const Context& context) const;
  void residual(const Level& l, const Lattice<T>& b, const Lattice<T>& x, Lattice<T>& r, const Context& context) const;
  static void restrict_to(const Level& fine, const Lattice<T>& r, Lattice<T>& b, const Context& context);
  static void prolong(const Level& fine, const Lattice<T>& coarse, Lattice<T>& x, const Context& context);

  std::vector<Level> levels_;
};

}  // namespace sg::fluid
