// SPDX-License-Identifier: Apache-2.0
// Surfaces around tensor lines: tubes with elliptic sections and crosses, whose half axes are the two other eigenvalues.
#pragma once
#include "filter/tensor/lines/tensor_lines.h"

namespace sg {

struct SectionOptions {
  enum class Shape : uint8_t { ellipse, cross } shape = Shape::ellipse;
  double factor = 1;          ///< half axis = |eigenvalue| * factor
  double max_radius = 1e300;  ///< larger sections are scaled down as a whole: their ratio stays
  double min_radius = 0;      ///< shorter half axes are drawn this long, so that thin sections stay visible
  int sides = 12;             ///< of an ellipse
};

/// Vertices in sections, one section a line point: `per_section` vertices each.
struct LineSurface {
  SurfaceMesh mesh;
  Array normals;  ///< f32, one a vertex
  size_t per_section = 0;
  std::vector<int64_t> line;  ///< per polygon: which line
  size_t limited = 0;         ///< sections that max_radius made smaller
};

/// The section's axes are the two eigenvectors that are not followed. Where their eigenvalues change places the axes are exchanged with
/// them, so that the surface is not twisted: of the four right-handed choices the one nearest to the section before is taken. Ends are
/// closed by flat polygons. A cross is two bands through the line, along the two axes.
LineSurface sections_around(const TensorLines& lines, int eigenvector, const SectionOptions& options, Context& ctx);

/// The length that 90 % of the larger half axes stay below for factor 1; 0 without lines.
double usual_half_axis(const TensorLines& lines, int eigenvector);

/// Lines as poly-lines; lines of one point are left out of the cells. Positions f64.
SurfaceMesh lines_as_mesh(const TensorLines& lines);

}  // namespace sg
