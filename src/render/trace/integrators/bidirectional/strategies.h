// SPDX-License-Identifier: Apache-2.0
// The ways to make a whole path of the two halves (Veach 1997, chapter 10). A way has s vertices from the light, which is one of them, and
// the others from the camera.
#pragma once
#include <optional>
#include <vector>

#include "render/trace/integrators/bidirectional/densities.h"
#include "render/trace/integrators/bidirectional/subpath.h"

namespace sg::trace {

/// What a path adds to the picture, before its way's share (densities).
struct Contribution {
  Vec2f pixel;
  Vec3f value;         ///< of the whole picture's samples, one of which each way draws for each pixel: their mean is the pixel
  int from_light = 0;  ///< s
};

/// Makes paths. Every function gives a contribution, or nothing, and leaves the path's densities in densities(). `i` and `j` are vertices
/// of the halves.
class Strategies {
 public:
  explicit Strategies(const PathScene& scene) : scene_(scene), media_(scene.world.borrow_media()) {}

  /// Of the thread that makes the paths; null without media.
  MediaWalk* media() { return media_.get(); }

  /// s = 0: vertex i, not the first surface, gives off light.
  std::optional<Contribution> shining(const SubPath& camera, int i);
  /// s = 0: a light was met in this stretch.
  std::optional<Contribution> met(const SubPath& camera, const Stretch& stretch, const MetLight& light);
  /// All that are met in it.
  const std::vector<MetLight>& met_in(const Stretch& stretch);
  /// s = 1: a light is asked for from vertex i.
  std::optional<Contribution> asked(const SubPath& camera, int i, Numbers& numbers);
  /// s > 1: two vertices see each other.
  std::optional<Contribution> joined(const SubPath& light, int i, const SubPath& camera, int j, Numbers& numbers);
  /// s > 1, and the camera alone at the other end.
  std::optional<Contribution> onto_picture(const SubPath& light, int i, Numbers& numbers);

  const PathDensities& densities() const { return densities_; }
  double weight(const Contribution& c) const { return strategy_weight(densities_, size_t(c.from_light)); }

 private:
  void take_light(const SubPath& path, int end);
  void take_camera(const SubPath& path, int end);
  void end_light(const SubPath& path, int end, double backward);
  double asked_density(uint32_t light, Vec3f normal, Vec3f from, Vec3f direction, float distance) const;
  void set_light(uint32_t light, Vec3f normal, Vec3f towards_light, const PathVertex& next, float distance);

  Vec3f passes(const PathVertex& from, const Ray& ray, Numbers& numbers);

  const PathScene& scene_;
  Media::Borrowed media_;
  PathDensities densities_;
  std::vector<MetLight> met_;
};

}  // namespace sg::trace
