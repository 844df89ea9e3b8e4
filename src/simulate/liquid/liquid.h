// SPDX-License-Identifier: Apache-2.0
// A liquid with a free surface in a box, by smoothed particles (SPH): the break of a dam.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "simulate/liquid/kernel.h"
#include "simulate/liquid/neighbours.h"
#include "simulate/run/frames.h"

namespace sg {

struct LiquidParams : FrameParams {
  int size = 60;
  std::vector<double> bounds, fill;
  double density = 1000, viscosity = 0, sound = 0;
  std::optional<Vec3> gravity;
};
void describe(Schema& s, LiquidParams& p);

namespace liquid {

constexpr double tait_exponent = 7;

/// Weakly compressible SPH: Tait's equation of state, density by continuity with diffusion (Molteni, Colagrossi 2009; Fourtakas and others
/// 2019), walls of resting particles whose pressure is that of the liquid beside them (Adami, Hu, Adams 2012), along which it slips.
class Liquid {
 public:
  /// Throws Error(usage) for boxes without extent, liquid outside of the box, and more particles than memory could hold.
  Liquid(const LiquidParams& p, const Context& context);
  size_t frame() const { return frame_; }
  /// Throws Error(data), naming the frame, where the liquid flies apart.
  void advance(const Context& context);
  DatasetPtr dataset(const Context& context) const;
  /// What the next frame depends on; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 1> count{frame_};
    std::array<double, 1> fastest{fastest_};
    f(count), f(fastest), f(x_), f(v_), f(density_), f(pressure_), f(a_);
    frame_ = count[0], fastest_ = fastest[0];
  }
  double spacing() const { return spacing_; }
  double sound() const { return sound_; }
  size_t count() const { return x_.size(); }  ///< of the liquid
  std::span<const Vec3> places() const { return x_; }
  std::span<const Vec3> velocities() const { return v_; }
  std::span<const double> pressures() const { return pressure_; }

 private:
  struct Sorted {  // a particle of the liquid, or of a wall
    Vec3 x, v;
    double density, pressure;
    uint32_t from;
    bool wall;
  };
  void place_walls();
  void sort();
  void press_together(double dt, const Context& context);
  void press_walls(const Context& context);
  void pull(const Context& context);
  double step(double most, const Context& context);
  double pressure_of(double density) const;
  double density_of(double pressure) const;

  LiquidParams params_;
  Box3 box_;
  bool flat_;
  double spacing_, sound_ = 1, stiffness_ = 1, mass_, slip_;
  Vec3 gravity_;
  Kernel kernel_;
  Neighbours neighbours_;
  std::vector<Vec3> x_, v_, wall_, a_;
  std::vector<double> density_, pressure_;
  std::vector<Sorted> all_;
  std::vector<Vec3> everything_;
  double fastest_ = 0;
  size_t frame_ = 0;
};

}  // namespace liquid

/// Points with the fields velocity, pressure and density of the liquid at the last frame before `time`.
DatasetPtr liquid_source(const LiquidParams& p, Context& context);
RunCost cost_of_liquid(const LiquidParams& p);

}  // namespace sg
