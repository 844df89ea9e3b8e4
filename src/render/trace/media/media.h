// SPDX-License-Identifier: Apache-2.0
// Media: all volumes of a scene, and the walkers that threads borrow to go through them.
#pragma once
#include <memory>
#include <vector>

#include "base/context.h"
#include "base/threads/lending.h"
#include "render/trace/media/media_walk.h"
#include "scene/scene.h"

namespace sg::trace {

class Media {
 public:
  Media() = default;
  /// The composited volumes of the scene. Throws Error(usage) for volumes with another ray function or algorithm, and as for pictures
  /// without paths.
  static std::shared_ptr<Media> make(const Scene& scene, const Projection& projection, Context& context);

  bool any() const { return !media_.empty(); }
  const Box3& bounds() const { return bounds_; }  ///< world
  std::vector<ParticipatingMedium>& media() { return media_; }
  /// Tells the coordinates of rays; before walkers are borrowed.
  void place(const Placement& placement) { placement_ = placement; }

  using Borrowed = Lending<MediaWalk>::Loan;
  /// Null when there are no media.
  Borrowed borrow() const;

 private:
  std::shared_ptr<const Scene> scene_;  // that the items belong to
  std::vector<ParticipatingMedium> media_;
  Box3 bounds_;
  Placement placement_;
  Lending<MediaWalk> walks_{[this] { return std::make_unique<MediaWalk>(media_, placement_); }};
};

}  // namespace sg::trace
