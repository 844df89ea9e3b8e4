// SPDX-License-Identifier: Apache-2.0
// Dust in the air: particles that fall, are dragged by the air, and drag it.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "simulate/fluid/dust/drag_exchange.h"
#include "simulate/fluid/dust/dust_params.h"
#include "simulate/fluid/walls/solids.h"
#include "simulate/run/state_file.h"

namespace sg::fluid {

template <class T>
class Dust {
 public:
  /// It appears in the boxes of the parameters, or else in these of the air's sources, or else in a ball high up. Throws Error(usage) where
  /// there is none, and for masses and drags that are not positive.
  Dust(const DustParams& p, const MacGrid& g, Vec3 up, const std::vector<Ball>& balls, const std::vector<Box3>& boxes,
       const Context& context);

  /// In a step that begins at `time`: what appears by its end, and the drag between dust and air.
  void drag(double time, double dt, Faces<T>& u, const Walls<T>& walls, const Context& context);
  /// With the air that the pressure has left, moves the dust. It stays at walls and balls that it meets, and leaves through open sides.
  void move(double time, double dt, const Faces<T>& u, const Walls<T>& walls, const Solids& solids, const Context& context);

  const std::vector<DustParticle>& particles() const { return particles_; }
  const DragLaw& law() const { return law_; }
  /// Whether it is asked for in place of the air.
  bool shown() const { return params_.show == DustShow::particles; }
  /// The velocity that the air has yet to lose: of what it gave the dust behind the last pressure.
  const Faces<double>& owed() const { return owed_; }
  /// Of the fastest particle, NaN where there is one.
  double fastest() const;
  size_t bytes() const;
  /// What the next step depends on; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 1> count{emitted_};
    Growing<std::vector<DustParticle>> particles{particles_};
    f(count), f(particles);
    for (Lattice<double>& l : owed_) f(l.values);
    emitted_ = count[0];
  }

  /// Mass per volume (of flat air per area) about the middles of the cells, beside the air's 1.
  Lattice<T> density(const Context& context) const;
  /// Points with velocity and id, in the order in which they appeared.
  DatasetPtr cloud(double time) const;

 private:
  void emit(double time);

  DustParams params_;
  MacGrid grid_;
  std::vector<Ball> balls_;
  std::vector<Box3> boxes_;
  std::vector<double> share_;  // of all of the sources' volume, up to each one's end
  DragLaw law_;
  DragExchange<T> exchange_;
  std::vector<DustParticle> particles_;
  std::vector<uint32_t> begin_;
  Faces<double> owed_;
  uint64_t emitted_ = 0;
};

}  // namespace sg::fluid
