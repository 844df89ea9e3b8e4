// SPDX-License-Identifier: Apache-2.0
// Heat in a box: du/dt = kappa lap u + s.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "data/dataset.h"
#include "simulate/pde/march.h"
#include "simulate/pde/solvers.h"
#include "simulate/run/frames.h"

namespace sg {

enum class HeatScheme { explicit_euler, crank_nicolson, backward_euler };
constexpr auto enum_words(HeatScheme) {
  using enum HeatScheme;
  return std::array{Word{"explicit", explicit_euler}, Word{"crank_nicolson", crank_nicolson}, Word{"backward_euler", backward_euler}};
}

struct HeatParams : FrameParams, pde::RoomParams {
  std::string initial;
  double diffusivity = 0.1;
  std::string source = "0";
  HeatScheme scheme = HeatScheme::explicit_euler;
  std::optional<double> step;
  pde::Solver solver = pde::Solver::multigrid;
  double tolerance = 1e-8;
};
void describe(Schema& s, HeatParams& p);

namespace pde {

/// The state at a frame. With L the second differences of room.h and steps of dt,
///   explicit         u' = u + dt (kappa L u + s): stable for dt <= 1 / (2 kappa sum of 1/h^2): h^2 / (2 d kappa) in d dimensions
///   backward_euler   (1 - dt kappa L) u' = u + dt s'
///   crank_nicolson   (1 - dt kappa L / 2) u' = (1 + dt kappa L / 2) u + dt (s + s') / 2
/// of order 1, 1 and 2 in time, 2 in space.
class Heat {
 public:
  Heat(const HeatParams& p, const Context& context);
  /// On to the next frame. Throws Error(data), naming the step, where the values grow beyond all numbers.
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  const Room& room() const { return room_; }
  const Values& values() const { return u_; }
  const Steps& steps() const { return steps_; }
  /// The longest stable step of the explicit scheme.
  double limit() const;
  DatasetPtr dataset(const Context& context) const;
  /// What the next frame depends on, and what follows from it; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 2> counts{frame_, taken_};
    f(counts);
    frame_ = counts[0], taken_ = counts[1];
    f(u_.values);
  }
  void resume(const Context& context);

 private:
  void step(double time, const Context& context);
  HeatParams params_;
  Room room_;
  Steps steps_;
  SideValues sides_;
  Values u_, source_, rate_;
  std::unique_ptr<LinearSolver> solver_;
  bool source_moves_ = false;
  size_t frame_ = 0, taken_ = 0;
};

}  // namespace pde

/// Point field temperature at the last frame before `time`; a uniform grid of the unknowns and the walls. Explicit steps beyond the limit
/// are taken as they are asked for, with a warning. Throws Error(usage) and Error(data) as Heat and make_room do.
DatasetPtr heat(const HeatParams& p, Context& context);
RunCost cost_of_heat(const HeatParams& p);

}  // namespace sg
