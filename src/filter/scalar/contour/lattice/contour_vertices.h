// SPDX-License-Identifier: Apache-2.0
// What the two makers of contour points share. Inside filter/scalar only.
#pragma once
#include <bit>

#include "base/bits.h"
#include "filter/scalar/contour/contour_parts.h"

namespace sg::contouring {

/// The bits of the cut edges along an axis: word w of row r.
inline uint64_t cut_edges(const VertexJob& job, int axis, size_t r, size_t w) {
  if (job.cut) return job.cut[axis][r * job.words + w];
  const uint64_t *row = job.inside + r * job.words, here = row[w];
  if (axis == 1) return here ^ row[w + job.words];
  if (axis == 2) return here ^ row[w + job.words * job.frame.dims[1]];
  const uint64_t next = here >> 1 | (w + 1 < job.words ? row[w + 1] << 63 : 0);
  return (here ^ next) & cell_bits(w, job.frame.dims[0]);
}

/// Points of axis-parallel uniform grids, several at a time.
struct PlainVertices {
  const VertexJob& job;
  Vec3 first, step, scale;  ///< the first point, the spacing, half the inverse spacing
  const void* maker;
  void (*careful)(const void* maker, size_t v, size_t p, int axis);  ///< makes vertex v, on the edge from point p along the axis
};

/// Makes the points of rows begin to end. The same bytes as one after the other, with every target. `base` of the samples is
/// job.samples; (end - begin + 3 dims[1]) * dims[0] must be less than 2^31.
void make_plain_vertices(const PlainVertices& work, size_t begin, size_t end);

}  // namespace sg::contouring
