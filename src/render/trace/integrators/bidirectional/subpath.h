// SPDX-License-Identifier: Apache-2.0
// SubPath: a path from the camera, or from a light, with what is needed to join it with another.
#pragma once
#include <optional>
#include <vector>

#include "render/trace/integrators/bidirectional/numbers.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/integrators/world.h"
#include "render/trace/light/emission.h"

namespace sg::trace {

/// All that both ends of paths need.
struct PathScene {
  const World& world;
  const Emission& emission;
  const PictureCamera& camera;
  int bounces;           ///< most turns of a path at surfaces
  bool roulette = true;  ///< ends paths that carry little at random
  int turns = bounces;   ///< most turns in all: more where there are media
};

/// A surface that the path met, or a place in a medium. What lets light pass straight on is an end of this path and yet no vertex of its
/// continuation: that has the same `parent`.
struct PathVertex {
  Vertex at;                        ///< in a medium its point and emission: without a normal, of no object
  std::optional<Collision> matter;  ///< of a medium
  int parent = -1;                  ///< -1: the camera or the light
  int level = 1;                    ///< turns of the path up to this one
  int surfaces = 0;                 ///< those at surfaces
  bool delta = false;               ///< the path went on by a delta
  Vec3f to_parent;                  ///< unit
  float distance = 0;               ///< from the parent, or infinite: a light
  Vec3f throughput;                 ///< of all before this vertex
  Insides around;                   ///< the bodies that the path came through
  double forward = 0;               ///< density with which it was drawn
  double reverse = 0;  ///< density with which the path the other way would draw it, if this one goes on for two vertices or more

  /// Zero in a medium.
  Vec3f normal() const { return at.point.face_normal; }
  /// Where a ray starts that goes on from here.
  Vec3f start(Vec3f direction) const { return matter ? at.point.position : leave(at.point, direction); }
  /// Surfaces within media are found from the camera alone: they face where a path came from, and others than both its ends agree on.
  bool seen_only() const { return matter && matter->on_surface; }
  Vec3f local_parent() const { return at.frame.to_local(to_parent); }
  /// The bodies on the side of a direction.
  Insides insides_along(Vec3f direction) const { return at.onward(around, -to_parent, direction); }
};

/// A stretch after a turn, in which lights that are no items may be met.
struct Stretch {
  int after;    ///< vertex
  Ray ray;      ///< from it, to the end of the stretch
  float t_min;  ///< where it begins
  double pdf;   ///< density of the direction, per solid angle
  Vec3f throughput;
  Vec3f absorption;  ///< of the matter there
};

struct SubPath {
  std::vector<PathVertex> vertices;
  // Of the camera:
  Vec2f pixel, on_lens;
  Vec3f straight;    ///< what surfaces that are seen straight on give off
  float passed = 0;  ///< share that went straight on to the background
  std::vector<Stretch> stretches;
  // Of a light:
  std::optional<EmittedRay> emitted;
  double light_reverse = 0;  ///< PathVertex::reverse of the light

  const PathVertex& vertex(int i) const { return vertices[size_t(i)]; }
};

/// Up to `levels` vertices, the last of which may give off light. `media`: the thread's own, or null.
void walk_from_camera(const PathScene& scene, MediaWalk* media, Vec2f pixel, int levels, Numbers& numbers, SubPath& path);
void walk_from_light(const PathScene& scene, MediaWalk* media, int levels, Numbers& numbers, SubPath& path);

/// |cos| of the angle between both; 1 for a zero normal: of a point, or of a place in a medium.
double across(Vec3f normal, Vec3f direction);
/// A density per solid angle at a distance as one per area of a surface with this normal, per volume of a medium.
double per_area(double per_solid_angle, Vec3f normal, Vec3f direction, float distance);

/// Whether there is light, of numbers that are finite.
bool shines(Vec3f light);

/// Light that arrives along `to_light` and leaves along the other, both local: by what a rounded normal makes of it (Veach 1997, 5.3), so
/// that paths from lights carry what paths from the camera would.
float rounded_normal_factor(const Vertex& v, Vec3f local_to_light, Vec3f to_light, Vec3f local_out, Vec3f out);

}  // namespace sg::trace
