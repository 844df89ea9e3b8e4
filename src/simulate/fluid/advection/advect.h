// SPDX-License-Identifier: Apache-2.0
// Quantities carried along by the flow of a staggered grid.
#pragma once
#include <array>
#include <span>

#include "base/context.h"
#include "base/schema/enum_words.h"
#include "simulate/fluid/mac_grid.h"

namespace sg::fluid {

/// How a field f is carried: df/dt + u . grad f = 0.
enum class Advection {
  explicit_euler,   ///< f - dt u . grad f with central differences: unstable at any step, kept to show why the others are there
  semi_lagrangian,  ///< f where the flow comes from (Stam 1999): stable at any step, first order, smooths
  maccormack,       ///< with the error of a step forth and back taken away (Selle, Fedkiw, Kim, Liu, Rossignac 2008): second order
  bfecc,            ///< with that error taken away before the step (Dupont, Liu 2003): second order
};
constexpr auto enum_words(Advection) {
  using enum Advection;
  return std::array{Word{"explicit", explicit_euler}, Word{"semi_lagrangian", semi_lagrangian}, Word{"maccormack", maccormack},
                    Word{"bfecc", bfecc}};
}

/// How the way back is found.
enum class BackTrace { euler, rk2, rk3 };
constexpr auto enum_words(BackTrace) {
  using enum BackTrace;
  return std::array{Word{"euler", euler}, Word{"rk2", rk2}, Word{"rk3", rk3}};
}

/// A step: fields move by u dt.
template <class T>
struct Carrier {
  const MacGrid& grid;
  const Faces<T>& velocity;  ///< length per time, in the middle of the faces
  double dt = 0;
  Advection scheme = Advection::maccormack;
  BackTrace trace = BackTrace::rk2;
  /// Corrected values stay between those from which the uncorrected one was mixed. Off: second order at extrema, too.
  bool limit = true;
};

/// A field on the way: `out` and `scratch` are as large as `f`, and other lattices.
template <class T>
struct Carried {
  const Lattice<T>* f;
  Lattice<T>* out;
  Lattice<T>* scratch;
};

/// Fields of the cells (axis -1) or a component of the velocity (its axis) after the step, in `out`. Outside of the box they have their
/// values at its border. With semi_lagrangian, and with `limit`, no value goes beyond those of f. `marks` is as large as they are.
template <class T>
void advect(const Carrier<T>& step, int axis, std::span<const Carried<T>> fields, Lattice<T>& marks, const Context& context);

}  // namespace sg::fluid
