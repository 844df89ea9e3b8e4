// SPDX-License-Identifier: Apache-2.0
// What seeds have released in an unsteady flow, and further releases where the lines of it stretch or bend. Internal to unsteady/.
#pragma once
#include "filter/flow/unsteady/unsteady_run.h"

namespace sg {

/// Particles of a seed together, in the order of release; seeds so that neighbours in space follow each other.
class StreakFront {
 public:
  /// Every seed releases at each of `times` (ascending).
  StreakFront(const std::vector<Vec3>& seeds, const std::vector<double>& times);

  struct Refinement {
    double spacing = HUGE_VAL;  ///< neighbours farther apart than this get another between them
    double angle = M_PI;        ///< and those where the line turns by more
    double shortest = 0;        ///< but none where they are nearer than this
    size_t most = SIZE_MAX;     ///< particles in all
  };
  /// Through the open interval (or to `until` in it). With `refinement`, particles come between neighbours that have parted: one released
  /// in this interval starts at the seed; an older one is put between its neighbours where these were at the start of the interval, by the
  /// cubic in release time through four of them (in the middle of two whose times are numerically equal), and is advanced through the
  /// interval itself.
  void advance(const UnsteadyFlow& flow, double until, const TraceOptions& options, const Refinement* refinement, Context& context);
  /// Those released before `t` are gone.
  void bury(double t);

  size_t seeds() const { return slot_.size(); }
  std::span<const Particle> of(size_t seed) const { return std::span(all_).subspan(first_[slot_[seed]], count(seed)); }
  std::span<const double> born(size_t seed) const { return std::span(born_).subspan(first_[slot_[seed]], count(seed)); }
  size_t started() const;
  size_t size() const { return all_.size(); }
  bool full() const { return full_; }  ///< no more came, because of Refinement::most

 private:
  struct Insertion {
    size_t after = 0;  ///< comes behind this particle
    double born = 0;
    Particle particle;
  };
  size_t count(size_t seed) const { return first_[slot_[seed] + 1] - first_[slot_[seed]]; }
  std::vector<Insertion> wanted(size_t slot, double begin, double until, const Refinement& r) const;
  void insert(const std::vector<std::vector<Insertion>>& more, std::vector<Particle>& advanced);

  std::vector<Particle> all_, before_;  // before_: at the beginning of the interval
  std::vector<double> born_;
  std::vector<Vec3> seed_;     // by slot
  std::vector<size_t> first_;  // of each slot; one more
  std::vector<size_t> slot_;   // of a seed
  bool full_ = false;
};

}  // namespace sg
