// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/packets/detail_table.h"

#include <algorithm>
#include <cmath>

namespace sg::volume {

namespace {
constexpr size_t most_points = 32;  // they are looked at one by one
}

DetailTable::Curve::Curve(const OpacityCurve& curve, double base) {
  for (const Vec2& p : curve.points) x.push_back(float(p.x - base)), y.push_back(float(p.y));
  slope.assign(x.size(), 0);
  for (size_t i = 0; i + 1 < x.size(); ++i)
    if (x[i + 1] > x[i]) slope[i] = (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
}

DetailTable::DetailTable(const VolumeItem& item, const Detail& detail, double base)
    : opacity(item.opacity, base),
      factor(item.detail.second_factor, 0),
      narrow(detail.transfer.narrow()),
      narrow_second(detail.transfer.narrow_second()),
      edges(detail.transfer.edges()),
      second_edges(detail.transfer.second_edges()),
      per_unit(float(1 / detail.unit)),
      most_sigma_t(detail.most_tau) {
  const auto draw = [&](float lo, float hi) {
    if (!drawn.empty() && lo <= drawn.back().hi) drawn.back().hi = hi;
    else drawn.push_back({lo, hi});
  };
  const auto &x = opacity.x, &y = opacity.y;
  if (y.front() > 0) draw(-HUGE_VALF, x.front());
  for (size_t i = 0; i + 1 < x.size(); ++i)
    if (y[i] > 0 || y[i + 1] > 0) draw(x[i], x[i + 1]);
  if (y.back() > 0) draw(x.back(), HUGE_VALF);
}

bool DetailTable::fits(const VolumeItem& item, const Detail& detail) {
  const TransferDetail& d = item.detail;
  return detail.axis == SecondAxis::gradient && !(detail.ink > 0) && d.widgets.empty() && !d.color_by_second && item.color.clamp &&
         item.opacity.points.size() <= most_points && d.second_factor.points.size() <= most_points;
}

}  // namespace sg::volume
