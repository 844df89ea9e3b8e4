// SPDX-License-Identifier: Apache-2.0
// Heat through any mesh and along any surface, by linear finite elements: rho du/dt = div(kappa grad u) + s.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "simulate/pde/mesh/finite_elements.h"
#include "simulate/run/frames.h"

namespace sg {

enum class MeshHeatScheme { backward_euler, crank_nicolson };
constexpr auto enum_words(MeshHeatScheme) {
  using enum MeshHeatScheme;
  return std::array{Word{"backward_euler", backward_euler}, Word{"crank_nicolson", crank_nicolson}};
}

struct HeatOnMeshParams : FrameParams {
  bool steady = false;
  FieldName field;
  std::string initial, held, value, source = "0", diffusivity;
  MeshHeatScheme scheme = MeshHeatScheme::backward_euler;
  std::optional<double> step;
  std::string name = "temperature";
  double tolerance = 1e-8;
  int iterations = 20000;
};
void describe(Schema& s, HeatOnMeshParams& p);

namespace pde {

/// The state at a frame, one number a point. The border lets nothing pass where it is not held. With the lumped mass M (each point's share
/// of the cells about it), the stiffness K and F = M s:
///   backward_euler   (M + dt K) u' = M u + dt F'                      order 1 in time; no new extremes on meshes without obtuse angles
///   crank_nicolson   (M + dt K / 2) u' = (M - dt K / 2) u + dt (F + F') / 2   order 2 in time
///   steady           K u = F
/// of order 2 in space; steady linear temperatures are exact on any mesh of simplices.
class MeshHeat {
 public:
  MeshHeat(DatasetPtr mesh, const HeatOnMeshParams& p, const Context& context);
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  /// What the next frame depends on; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 1> count{frame_};
    f(count), f(u_), f(source_);
    frame_ = count[0];
  }
  /// Solves for the temperatures at which nothing changes any more.
  void settle(const Context& context);
  /// Of the points of the mesh, and then of what was added in the middle of polyhedra.
  const std::vector<double>& values() const { return u_; }
  const Simplices& simplices() const { return simplices_; }
  const Stiffness& stiffness() const { return stiffness_; }
  /// The mesh with the field.
  DatasetPtr dataset(const Context& context) const;

 private:
  /// At the points; those that count must be finite.
  std::vector<double> numbers_at(const std::string& expression, const char* word, double time, const Context& context) const;
  void hold(const std::vector<double>& values);
  HeatOnMeshParams params_;
  DatasetPtr mesh_;  // with the field border where it is asked for
  DatasetPtr shown_;
  Simplices simplices_;
  Stiffness stiffness_;
  std::vector<uint8_t> held_;
  std::vector<double> u_, source_, right_;
  bool value_moves_ = false, source_moves_ = false;
  size_t steps_ = 1, frame_ = 0;
  double dt_ = 0;
};

}  // namespace pde

/// The mesh with the point field `name` (f64) at the last frame before `time`, or where nothing changes any more (steady=true). Expressions
/// (filter/field/calc) read x, y, z, time, the fields of the mesh, and border: 1 at points on the border, else 0. Curved solids are
/// made linear first (tessellate). Throws Error(usage) for meshes without cells and mistakes in expressions, Error(data) for values that
/// are not finite, negative diffusivities, and steady heat that flows in and cannot flow out.
DatasetPtr heat_on_mesh(const DatasetPtr& in, const HeatOnMeshParams& p, Context& context);
/// Of a mesh that takes so many bytes, reckoned as one of triangles.
RunCost cost_of_heat_on_mesh(const HeatOnMeshParams& p, uint64_t bytes);

}  // namespace sg
