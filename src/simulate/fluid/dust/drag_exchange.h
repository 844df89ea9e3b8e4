// SPDX-License-Identifier: Apache-2.0
// Particles that the air drags along, and that drag it: momentum goes from one to the other, and none is lost.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "simulate/fluid/particle_grid.h"
#include "simulate/fluid/walls/walls.h"

namespace sg::fluid {

struct DustParticle {
  Vec3 x;  ///< from the grid's origin, in units of h
  Vec3 v;  ///< length per time
  uint64_t id = 0;
};

/// Of all particles alike. The air weighs 1 per volume (of flat air per area).
struct DragLaw {
  double mass = 1;  ///< of a particle
  double drag = 1;  ///< force on it per velocity of the air relative to it (Stokes)
  Vec3 pull;        ///< its acceleration by other forces
};

/// One step of
///   m dv/dt = k (U - v) + m pull,  U = sum over the faces f about a particle of w_f u_f      for each particle and component
///   h^d du_f/dt = -sum over particles of w_f k (U - v)                                         for each face
/// in the way of backward Euler, which no drag makes unstable. With beta = k dt/m and w = v + dt pull the new velocities are
///   v' = (w + beta U') / (1 + beta),    u'_f = u_f - sum w_f m (v' - w) / h^d,
/// of which the faces' are a symmetric positive definite system: conjugate gradients, whose matrix is never made; the number of iterations
/// grows as the root of the dust's weight beside the air's. What air and particles exchange is equal to rounding, whatever is left of its
/// residual. Solid faces and closed sides keep their velocity: what they take is lost to the walls.
template <class T>
class DragExchange {
 public:
  DragExchange(const MacGrid& g, const DragLaw& law);

  /// `particles` are sorted by cell, `begin` says where each cell's begin.
  void exchange(double dt, std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, Faces<T>& u, const Walls<T>& walls,
                const Context& context);
  /// The same particles' velocities once more, by those of the air behind the same step's pressure; `owed` becomes the velocity that the
  /// faces have to lose for it, at the next step's beginning.
  void follow(std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, const Faces<T>& u, Faces<double>& owed,
              const Context& context);
  /// Of the last exchange.
  int iterations() const { return iterations_; }

 private:
  void find_faces(const std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, const Faces<T>& u, const Walls<T>& walls,
                  double coupling, const Context& context);
  void solve(const std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, double coupling, const Context& context);
  template <class F>
  void spread(const std::vector<DustParticle>& particles, const std::vector<uint32_t>& begin, Faces<double>& to, const Context& context,
              F&& amount) const;
  template <class F>
  void each_free(const Context& context, F&& f) const;
  double product(const Faces<double>& a, const Faces<double>& b, const Context& context) const;
  void clear(Faces<double>& f, bool held_alone = false) const;
  double air_mass() const { return grid_.flat() ? grid_.h * grid_.h : grid_.h * grid_.h * grid_.h; }

  MacGrid grid_;
  DragLaw law_;
  std::vector<Vec3> before_;  // w of the particles
  double beta_ = 0;
  int iterations_ = 0;
  // The faces about the particles, which move or are held; the others' numbers are any.
  std::array<std::vector<uint32_t>, 3> free_, held_;
  Faces<double> x_, r_, z_, d_, q_, scale_;
};

}  // namespace sg::fluid
