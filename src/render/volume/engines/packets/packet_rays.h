// SPDX-License-Identifier: Apache-2.0
// The rays of a packet as plain arrays, and what draws tiles of them.
#pragma once
#include "render/volume/engines/packets/packets.h"

namespace sg::volume {

constexpr int most_lanes = 16;

struct RayPacket {
  // Places in q, one array per axis.
  alignas(64) float first[3][most_lanes], by[3][most_lanes];     ///< the middle of the first step, and one step
  alignas(64) float last[3][most_lanes];                         ///< the middle of the last, shorter step
  alignas(64) float entry[3][most_lanes], along[3][most_lanes];  ///< where the ray enters, and one world length
  alignas(64) float steps[most_lanes];                           ///< whole ones; 0 for a ray that misses
  alignas(64) float rest[most_lanes];                            ///< world length of the last step
  alignas(64) float length[most_lanes];                          ///< inside the box; <= 0 for a ray that misses
  alignas(64) float before[most_lanes];                          ///< share of the light that passes what was drawn before
  alignas(64) float direction[3][most_lanes];                    ///< world, unit
  alignas(64) double enter[most_lanes];                          ///< world length from the ray's origin
  alignas(64) double leave[most_lanes];
  alignas(64) double first_depth[most_lanes], per_length[most_lanes];  ///< depth = first_depth + t * per_length
  size_t pixel[most_lanes];
  bool inside[most_lanes];  ///< of the tile
};

/// What a packet found.
struct PacketResult {
  alignas(64) float r[most_lanes], g[most_lanes], b[most_lanes], transmittance[most_lanes];
  double surface[most_lanes];  ///< t of it; -1 = none
};

/// The part that a plan draws; null: its lattice is the whole.
template <class Plan>
const LatticePart* part_of(const Plan& plan) {
  if constexpr (requires { plan.part; }) return plan.part;
  else return nullptr;
}

/// What tells how bricks are passed, a byte each.
struct BrickBytes {
  const uint8_t* bytes = nullptr;              ///< null: no brick is empty
  const std::array<int32_t, 3>* up = nullptr;  ///< of SpaceAhead; null: the same bytes whichever way rays go
  bool codes = false;                          ///< Passages::codes; else distances to what is drawn
};
inline BrickBytes brick_bytes(const SpaceAhead* ahead) { return ahead ? BrickBytes{ahead->bricks.data(), &ahead->up} : BrickBytes(); }
inline BrickBytes brick_bytes(const UnevenPlan& plan) { return brick_bytes(plan.ahead); }
inline BrickBytes brick_bytes(const DetailPlan& plan) { return brick_bytes(plan.ahead); }
inline BrickBytes brick_bytes(const StridingPlan& plan) {
  if (plan.tables) return {plan.tables->passages.codes.data(), &plan.tables->passages.up, true};
  if (plan.skip_empty && plan.volume.any_empty) return {plan.volume.distance.data()};
  return {};
}

/// Adds the results to the frame.
void put(const Volume& volume, const LatticePart* part, const RayPacket& rays, const PacketResult& result, int lanes, Frame& frame);

/// A sample of one or two bytes, with or without a sign: told apart as they are read, so that vector code is compiled for two types only.
enum class SmallInteger : uint8_t {};

// draw_tile() for samples T, float or SmallInteger; each is an object file of its own.
template <class T>
void march_tile(const MarchingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);
template <class T>
void stride_tile(const StridingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);
template <class T>
void uneven_tile(const UnevenPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);
template <class T>
void detail_tile(const DetailPlan& plan, int x0, int y0, int x1, int y1, Frame& frame);

}  // namespace sg::volume
