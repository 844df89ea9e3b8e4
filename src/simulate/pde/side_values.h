// SPDX-License-Identifier: Apache-2.0
// The values on the walls of a room.
#pragma once
#include "data/dataset.h"
#include "simulate/pde/room.h"

namespace sg::pde {

class SideValues {
 public:
  /// The expressions of held sides at `time`; absorbing sides begin with 0.
  SideValues(const Room& room, std::string who, double time, const Context& context);
  /// On to the values at another time; whether any may have changed.
  bool update(double time, const Context& context);
  /// Adds what the walls give to the Laplacian of their neighbours, times `scale`.
  void add_to(Values& out, double scale) const;
  /// One number a place of the side, the lower of the other axes fastest; empty unless it is a wall.
  const Values& of(size_t side) const { return values_[side]; }
  Values& of(size_t side) { return values_[side]; }
  double time() const { return time_; }
  /// Calls f(place of the room next to the side, place of the side) for all places of a side.
  template <class F>
  static void each(const std::array<size_t, 3>& n, size_t side, F&& f) {
    const size_t a = side / 2;
    std::array<size_t, 3> lo{0, 0, 0}, hi = n;
    if (side % 2) lo[a] = n[a] - 1;
    hi[a] = lo[a] + 1;
    size_t at = 0;
    for (size_t k = lo[2]; k < hi[2]; ++k)
      for (size_t j = lo[1]; j < hi[1]; ++j)
        for (size_t i = lo[0]; i < hi[0]; ++i) f(i + n[0] * (j + n[1] * k), at++);
  }

 private:
  void evaluate(size_t side, double time, const Context& context);
  Room room_;
  std::string who_;
  std::array<Values, 6> values_;
  std::array<bool, 6> moves_{};
  double time_ = 0;
};

/// The places of a side.
UniformGrid side_grid(const Room& room, size_t side);
/// The grid of the unknowns and of the walls about them.
UniformGrid whole_grid(const Room& room);
/// A point field on it; edges where walls meet have the mean of what the walls hold there.
Field whole_field(const Room& room, const Values& u, const SideValues& sides, const char* name, FieldType type, const Context& context);

}  // namespace sg::pde
