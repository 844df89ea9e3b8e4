// SPDX-License-Identifier: Apache-2.0
// Regions and surfaces by a formula: planes, spheres, boxes, outlines, quadrics, another mesh, any expression. Declared once for all
// operations that cut along them.
#pragma once
#include <functional>
#include <span>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

enum class CutAxis { none, x, y, z };
constexpr auto enum_words(CutAxis) {
  using enum CutAxis;
  return std::array{Word{"none", none}, Word{"x", x}, Word{"y", y}, Word{"z", z}};
}
/// Several planes at once, across these axes.
enum class CutPlanes { none, xyz, xy, xz, yz, x, y, z };
constexpr auto enum_words(CutPlanes) {
  using enum CutPlanes;
  return std::array{Word{"none", none}, Word{"xyz", xyz}, Word{"xy", xy}, Word{"xz", xz},
                    Word{"yz", yz},     Word{"x", x},     Word{"y", y},   Word{"z", z}};
}

/// 0 to 2; -1: none.
constexpr int axis_number(CutAxis axis) { return int(axis) - 1; }

struct ImplicitParams {
  std::optional<Vec3> origin = {};
  Vec3 normal{0, 0, 1};
  CutAxis axis = CutAxis::none;
  std::optional<double> position = {};
  std::vector<double> sphere = {}, cylinder = {}, box = {}, lasso = {}, quadric = {};
  std::optional<Vec3> lasso_eye = {};
  std::string function = {};
  // Several planes at once: slice only.
  CutPlanes planes = CutPlanes::none;
  std::vector<double> positions = {};
  double tolerance = 1e-3;  // slice and clip
};

/// Whether the words name something else than a plane.
inline bool names_shape(const ImplicitParams& p) {
  return !p.sphere.empty() || !p.cylinder.empty() || !p.box.empty() || !p.lasso.empty() || p.lasso_eye || !p.quadric.empty() ||
         !p.function.empty();
}

inline void describe_curved_tolerance(Schema& s, double& tolerance) {
  s("tolerance", tolerance,
    "Curved cells: largest distance between them and the straight cells cut in their place, as a share of the mesh's size, and of a "
    "field's range. Lengths, areas and volumes are equally accurate. Cells are halved at most 7 times, many large ones 2 times; a note "
    "says if the tolerance is not met.")
      .positive();
}

inline void describe_implicit(Schema& s, ImplicitParams& p) {
  s("origin", p.origin, "Point on the plane; default: the middle of the mesh.");
  s("normal", p.normal, "Normal of the plane.");
  s("axis", p.axis, "Shorthand for a normal along x, y or z.");
  s("position", p.position, "With axis: the plane's coordinate along it; default: the middle.");
  s("sphere", p.sphere, "Sphere instead of the plane: x,y,z of its centre, and its radius.");
  s("cylinder", p.cylinder, "Infinite cylinder: x,y,z of a point on its axis, the direction of the axis, and the radius.");
  s("box", p.box, "Box: x0,x1,y0,y1,z0,z1.");
  s("lasso", p.lasso,
    "What lies behind an outline: x,y,z of each corner of a polygon, which is swept along its normal, without end on both sides.");
  s("lasso_eye", p.lasso_eye, "With lasso: the outline is seen from this point, and what lies behind the point is outside.");
  s("quadric", p.quadric, "Quadric a0 x^2 + a1 y^2 + a2 z^2 + a3 xy + a4 yz + a5 xz + a6 x + a7 y + a8 z + a9 = 0, as ten numbers.");
  s("function", p.function, "Surface where an expression of x, y, z (or point fields) is zero, e.g. x^2+y^2-1; see calc.");
}

/// A function of place that is negative inside: behind a plane or an outline, in a sphere, cylinder, box or closed mesh, where an
/// expression is negative. Distances from planes, spheres, cylinders, boxes, outlines (lasso_region.h) and meshes; other functions as they
/// are.
struct ImplicitFunction {
  std::function<void(std::span<const Vec3> at, std::span<double> out)> evaluate;  ///< safe from several threads
  Array known;          ///< an expression of fields: its f64 values at the points of the mesh; evaluate is empty then
  bool plane = false;   ///< linear: cuts of edges need no search
  Vec3 origin, normal;  ///< of the plane
  double snap = 0;      ///< distances from the plane below this are rounding and count as 0
  std::string text;     ///< "a plane", "a sphere"

  double operator()(Vec3 p) const {
    double r = 0;
    evaluate({&p, 1}, {&r, 1});
    return r;
  }
  /// Direction of growth, not of unit length.
  Vec3 gradient(Vec3 p, double step) const;
};

/// Which function the parameters mean for this mesh. `surface` (a second input) is a closed surface or a solid mesh, else null; `who` names
/// the operation. Throws Error(usage) for a zero normal, an empty box, a radius that is not positive, numbers that are not finite, a wrong
/// count of numbers, two shapes at once.
ImplicitFunction implicit_function(const ImplicitParams& p, const DatasetPtr& in, const DatasetPtr& surface, std::string_view who,
                                   Context& ctx);

/// The plane through a point, across a unit normal, for a mesh with these bounds.
ImplicitFunction plane_function(Vec3 origin, Vec3 normal, const Box3& bounds);

/// Its values at the points of a mesh (not AMR): f64. Parallel.
Array values_at_points(const ImplicitFunction& f, const DatasetPtr& in, Context& ctx);

/// Moves each share t of the way from one place to another to where the function is zero; it has different signs at both ends, or the share
/// stays. By false position with halved weights (Illinois). Parallel.
void find_zeros(const ImplicitFunction& f, std::span<const Vec3> from, std::span<const Vec3> to, std::span<double> t);

}  // namespace sg
