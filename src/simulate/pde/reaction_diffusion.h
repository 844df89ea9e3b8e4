// SPDX-License-Identifier: Apache-2.0
// Two substances that react and spread: spots, stripes, spirals.
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

enum class Reaction { gray_scott, fitzhugh_nagumo };
constexpr auto enum_words(Reaction) {
  using enum Reaction;
  return std::array{Word{"gray_scott", gray_scott}, Word{"fitzhugh_nagumo", fitzhugh_nagumo}};
}

struct ReactionDiffusionParams : FrameParams, pde::RoomParams {
  ReactionDiffusionParams() { size = 128, sides = "periodic", frame = 20; }
  Reaction model = Reaction::gray_scott;
  std::string initial_u, initial_v;
  std::optional<double> diffusivity_u, diffusivity_v;
  double feed = 0.037, kill = 0.06;
  double threshold = 0.7, damping = 0.8, recovery = 0.04;
  std::optional<double> step;
};
void describe(Schema& s, ReactionDiffusionParams& p);

namespace pde {

/// The state at a frame.
///   gray_scott        u' = Du lap u - u v^2 + feed (1 - u),  v' = Dv lap v + u v^2 - (feed + kill) v   (Pearson 1993)
///   fitzhugh_nagumo   u' = Du lap u + u - u^3/3 - v,         v' = Dv lap v + recovery (u + threshold - damping v)
/// by third-order Runge-Kutta steps (Shu, Osher 1988), stable while 4 D sum of 1/h^2 and the
/// reaction's own rate add up to less than 2.51 / dt. Held sides hold both at the same value.
class ReactionDiffusion {
 public:
  ReactionDiffusion(const ReactionDiffusionParams& p, const Context& context);
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  const Room& room() const { return room_; }
  const Values& u() const { return values_[0]; }
  const Values& v() const { return values_[1]; }
  const Steps& steps() const { return steps_; }
  DatasetPtr dataset(const Context& context) const;
  /// What the next frame depends on, and what follows from it; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 2> counts{frame_, taken_};
    f(counts);
    frame_ = counts[0], taken_ = counts[1];
    for (Values& v : values_) f(v.values);
  }
  void resume(const Context& context);

 private:
  void rates(const std::vector<Values>& at, double time, std::vector<Values>& out, const Context& context);
  ReactionDiffusionParams params_;
  Room room_;
  double du_, dv_;
  Steps steps_;
  SideValues sides_;
  std::vector<Values> values_, base_, slope_;
  size_t frame_ = 0, taken_ = 0;
};

}  // namespace pde

/// Point fields u and v at the last frame before `time`. Throws Error(data), naming the step, where a stated step blows up.
DatasetPtr reaction_diffusion(const ReactionDiffusionParams& p, Context& context);
RunCost cost_of_reaction_diffusion(const ReactionDiffusionParams& p);

}  // namespace sg
