// SPDX-License-Identifier: Apache-2.0
// A substance that a given flow carries while it spreads: dc/dt + div(u c) = kappa lap c + s.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "data/dataset.h"
#include "simulate/pde/march.h"
#include "simulate/run/frames.h"

namespace sg {

enum class FluxScheme { upwind, central, limited };
constexpr auto enum_words(FluxScheme) {
  using enum FluxScheme;
  return std::array{Word{"upwind", upwind}, Word{"central", central}, Word{"limited", limited}};
}

struct AdvectionDiffusionParams : FrameParams, pde::RoomParams {
  std::string initial, velocity, source = "0";
  double diffusivity = 1e-4;
  FluxScheme scheme = FluxScheme::limited;
  std::optional<double> step;
};
void describe(Schema& s, AdvectionDiffusionParams& p);

namespace pde {

/// The state at a frame: finite volumes about the unknowns, with the flow at their faces; what leaves one enters the next. The value at a
/// face is that of the upwind cell (upwind: order 1, its error is a diffusivity of |u| h / 2), the mean of both (central: order 2,
/// oscillates where |u| h > 2 kappa), or the upwind cell's with van Leer's limited slope (1974; limited: order 2 but at extremes, without
/// new ones). Third-order Runge-Kutta steps. Insulated sides let the flow carry out what is there.
class AdvectionDiffusion {
 public:
  AdvectionDiffusion(const AdvectionDiffusionParams& p, const Context& context);
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  const Room& room() const { return room_; }
  const Values& values() const { return values_[0]; }
  /// The longest step at which a forward step of the upwind scheme makes no new extremes: 1 / (sum of |u|/h + 2 kappa sum of 1/h^2).
  double limit(const Context& context) const;
  DatasetPtr dataset(const Context& context) const;
  /// What the next frame depends on, and what follows from it; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 2> counts{frame_, taken_};
    f(counts);
    frame_ = counts[0], taken_ = counts[1];
    f(values_[0].values);
  }
  void resume(const Context& context);

 private:
  void find_velocity(double time, const Context& context);
  void carry(size_t axis, const Values& c, Values& out, const Context& context) const;
  AdvectionDiffusionParams params_;
  Room room_;
  SideValues sides_;
  std::array<Values, 3> velocity_;  // along each axis, at the faces across it
  std::vector<Values> values_, base_, slope_;
  Values source_;
  bool flow_moves_ = false, source_moves_ = false;
  size_t frame_ = 0, taken_ = 0;
};

}  // namespace pde

/// Point field concentration at the last frame before `time`. Throws Error(data), naming the step, where a stated step blows up.
DatasetPtr advection_diffusion(const AdvectionDiffusionParams& p, Context& context);
RunCost cost_of_advection_diffusion(const AdvectionDiffusionParams& p);

}  // namespace sg
