// SPDX-License-Identifier: Apache-2.0
// The surfaces that represent one tensor: vertices in the frame of its eigenvectors, the same faces for all tensors of a shape.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/schema/enum_words.h"
#include "filter/tensor/sym_tensor.h"

namespace sg {

enum class TensorShape : uint8_t { ellipsoid, cuboid, cylinder, superquadric, reynolds, hwy };
constexpr auto enum_words(TensorShape) {
  using enum TensorShape;
  return std::array{Word{"ellipsoid", ellipsoid},       Word{"cuboid", cuboid},     Word{"cylinder", cylinder},
                    Word{"superquadric", superquadric}, Word{"reynolds", reynolds}, Word{"hwy", hwy}};
}

/// One vertex: place and normal in space relative to the tensor's place, and the direction whose n.s.n colours it.
struct GlyphVertex {
  Vec3 at, normal, direction;
};

/// Faces and parameters of the vertices; made once per operation.
class GlyphPattern {
 public:
  /// `resolution`: rows from pole to pole; twice as many around.
  GlyphPattern(TensorShape shape, int resolution, double gamma, double min_ratio = 0.01);
  size_t vertices() const { return count_; }
  const std::vector<int32_t>& ids() const { return ids_; }
  const std::vector<int32_t>& offsets() const { return offsets_; }

  /// Half axes = |eigenvalues| * factor (those below min_ratio of the largest count as that, so that nothing is without volume):
  ///   ellipsoid, cuboid   with these half axes;
  ///   cylinder            elliptic, along the eigenvector that differs most: the first where linear (cl >= cp), else the third;
  ///   superquadric        Kindlmann 2004: the exponents (1-cp)^gamma, (1-cl)^gamma of a superquadric along the same axis make edges where
  ///                       eigenvectors are certain and roundness where they are not; cl, cp of the absolute eigenvalues, by the trace;
  ///   reynolds            radius |n.s.n| in the direction n (Moore, Schorn, Moore 1996, "Reynolds" glyph): lobes;
  ///   hwy                 radius sqrt(|s n|^2 - (n.s.n)^2), the shear on the plane across n (Hashash, Yao, Wotring 2003).
  /// Normals are exact. `out` has room for vertices().
  void make(const Eigen3& e, double factor, GlyphVertex* out) const;

 private:
  void sphere_faces();
  void make_round(const Eigen3& e, double factor, GlyphVertex* out) const;
  void make_lobes(const Eigen3& e, double factor, GlyphVertex* out) const;
  void make_cuboid(const Eigen3& e, double factor, GlyphVertex* out) const;
  void make_cylinder(const Eigen3& e, double factor, GlyphVertex* out) const;
  TensorShape shape_;
  int rows_;
  double gamma_, min_ratio_;
  size_t count_ = 0;
  std::vector<int32_t> ids_, offsets_{0};
  std::vector<std::array<double, 4>> angles_;  ///< cos and sin around, cos and sin from the pole, of each vertex of a sphere
};

}  // namespace sg
