// SPDX-License-Identifier: Apache-2.0
// SeedCurve: where a stream, path or streak surface begins.
#pragma once
#include <optional>
#include <vector>

#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct SeedCurveParams {
  std::optional<Vec3> from, to;
  std::optional<Vec3> center, normal;
  std::optional<double> radius;
  std::vector<double> points;
  bool nothing() const { return !from && !to && !center && !normal && !radius && points.empty(); }
};
void describe(Schema& s, SeedCurveParams& p);

/// A poly-line with a parameter from 0 to 1 in proportion to length; closed: 1 is 0 again.
struct SeedCurve {
  std::vector<Vec3> at;        ///< two or more; closed ones do not repeat the first
  std::vector<double> length;  ///< up to each of `at`; closed: one more, that of the whole
  bool closed = false;
  bool round = false;  ///< a circle, not the polygon of `at`
  Vec3 center, u, v;   ///< of the circle: center + u cos + v sin

  Vec3 operator()(double s) const;
  double whole() const { return length.back(); }
};

/// The line from-to, the circle about center, a line through `points`, or the longest line of `lines` (a mesh, or null). Throws
/// Error(usage) naming `who` unless exactly one of them is given, and for curves without length.
SeedCurve seed_curve(const SeedCurveParams& p, const DatasetPtr& lines, std::string_view who);

}  // namespace sg
