// SPDX-License-Identifier: Apache-2.0
// Casting rays through prepared volumes of any kind: the reference, which supports everything. The lattice's packets are a faster way to
// the same picture.
#pragma once
#include <memory>
#include <vector>

#include "render/composite/fragments.h"
#include "render/volume/medium/optical_depth.h"
#include "render/volume/medium/preintegrated.h"
#include "render/volume/rays/functions.h"
#include "render/volume/rays/integrate.h"
#include "scene/scene.h"

namespace sg::volume {

/// One volume, ready for rays; shared by all threads.
struct CastVolume {
  const VolumeItem* item = nullptr;
  uint32_t id = 0;  ///< item number + 1
  std::unique_ptr<RaySource> source;
  std::unique_ptr<Medium> medium;
  std::unique_ptr<TransferFunction> transfer;  ///< with a detail that is not plain, else null
  std::unique_ptr<Detail> detail;
  std::unique_ptr<Preintegrated> table;  ///< with steps and classify=table, else null
  Budget budget;
  double step = 0;  ///< world length; 0 = by the tolerance
  double unit = 1;  ///< world length to which opacity refers
  float per_scale = 1;
  std::unique_ptr<std::vector<double>> levels;  ///< stored values
  Material material;
  std::shared_ptr<const LightEffects> effects;  ///< null = none
  bool averaged = false;                        ///< the source is that of means of cells (antialias), not the lattice's own

  /// Linear colour of a surface, or of whatever is drawn at one place, with this (stored) value. `second`: of the second field there, which
  /// counts where colours follow it.
  Vec3f color_at(float stored, float second) const;
  /// What takes light away.
  Extinction extinction() const { return {*medium, item->detail.plain() ? nullptr : detail.get()}; }
};

/// State of a ray before it meets anything.
struct CastRay {
  Vec3 origin, direction;
  double from = 0, to = 0;         ///< limits in t: near plane and opaque depth
  const LitRay* lights = nullptr;  ///< the scene's lights along this ray
  double jitter = 0;               ///< share of a step by which fixed steps start earlier
};

/// One thread's walkers.
class Caster {
 public:
  explicit Caster(const std::vector<CastVolume>& volumes);

  /// From near to far: the fragments, sorted by t (which stands in Fragment::depth), and the volumes, in order.
  void cast(const CastRay& ray, const std::vector<Fragment>& fragments, RayState& state);

 private:
  struct Active;
  struct Steps;
  void collect(Active& active, const CastRay& ray);
  void put(float t, Vec3f color, float alpha, uint32_t id);
  void maximum_difference(Active& active);
  void until(double to, RayState& state);

  std::vector<std::shared_ptr<Active>> composite_, others_;
  std::vector<Active*> active_;  // of this ray
  std::vector<Fragment> fragments_;
  std::vector<Crossing> crossings_;
  std::vector<Joint> joint_;
};

}  // namespace sg::volume
