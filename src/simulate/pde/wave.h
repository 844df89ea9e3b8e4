// SPDX-License-Identifier: Apache-2.0
// Waves in a box: d2u/dt2 = c^2 lap u + s.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "data/dataset.h"
#include "simulate/pde/march.h"
#include "simulate/run/frames.h"

namespace sg {

struct WaveParams : FrameParams, pde::RoomParams {
  WaveParams() { sides = "0"; }
  std::string initial, velocity = "0";
  double speed = 1;
  std::string source = "0";
  std::optional<double> step;
};
void describe(Schema& s, WaveParams& p);

namespace pde {

/// The state at a frame. Leapfrog, of order 2 in time and space: u'' = 2 u' - u + dt^2 (c^2 L u' + s), begun with
/// u' = u + dt v + dt^2 (c^2 L u + s) / 2; stable for c dt <= 1 / sqrt(sum of 1/h^2) (Courant, Friedrichs, Lewy 1928). A mode of the
/// eigenvalue -lambda of L turns at the w with sin(w dt / 2) = c dt sqrt(lambda) / 2. In one dimension a step of c dt = h moves waves by
/// whole cells, without error. Absorbing sides let through what meets them head on (Mur 1981).
class Wave {
 public:
  Wave(const WaveParams& p, const Context& context);
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  const Room& room() const { return room_; }
  const Values& values() const { return u_; }
  const Steps& steps() const { return steps_; }
  double limit() const;
  DatasetPtr dataset(const Context& context) const;
  /// What the next frame depends on, and what follows from it; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 2> counts{frame_, taken_};
    f(counts);
    frame_ = counts[0], taken_ = counts[1];
    f(u_.values), f(before_.values);
    for (size_t s = 0; s < 6; ++s) f(sides_.of(s).values);
  }
  void resume(const Context& context);

 private:
  void step(double time, const Context& context);
  WaveParams params_;
  Room room_;
  std::string initial_;
  Steps steps_;
  SideValues sides_;
  Values u_, before_, velocity_, source_, rate_;
  bool source_moves_ = false;
  size_t frame_ = 0, taken_ = 0;
};

}  // namespace pde

/// Point field height at the last frame before `time`. Steps beyond the limit are taken as they are asked for, with a warning, until the
/// values are beyond all numbers: Error(data) names the step.
DatasetPtr wave(const WaveParams& p, Context& context);
RunCost cost_of_wave(const WaveParams& p);

}  // namespace sg
