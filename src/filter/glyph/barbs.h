// SPDX-License-Identifier: Apache-2.0
// Wind barbs: speed as strokes on a staff that points to where the wind comes from.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// The side of the strokes; latitude: by the sign of the latitude of each place.
enum class BarbHemisphere { latitude, north, south };
constexpr auto enum_words(BarbHemisphere) {
  using enum BarbHemisphere;
  return std::array{Word{"latitude", latitude}, Word{"north", north}, Word{"south", south}};
}

struct BarbParams {
  std::optional<std::string> unit;
  BarbHemisphere hemisphere = BarbHemisphere::latitude;
  FieldName latitude = {};
};
void describe(Schema& s, BarbParams& p);

/// Speeds are rounded to 5 knots; this is the fastest barb.
constexpr int barb_step = 5, most_barb_knots = 500;
/// The strokes of a rounded speed: pennants of 50, barbs of 10 and at most one half barb of 5 knots.
struct BarbStrokes {
  int pennants = 0, barbs = 0, half = 0;
};
BarbStrokes barb_strokes(int knots);

/// Shapes of speeds 0, 5, ..., 500 knots for the northern hemisphere, then of 5 ... 500 for the southern one: flat in x-y, lines and the
/// pennants' triangles; the wind blows along +x, the staff reaches from 0 to -1, strokes are on the side of low pressure (+y in the north).
/// Calm: a circle.
std::vector<DatasetPtr> barb_shapes();
/// Number of the shape of a speed (knots, not negative), in knots rounded half up.
int barb_shape(double knots, bool southern);

/// Knots of a speed of 1 in the unit: m/s, km/h, mph, ft/s, kn (any usual spelling). Throws Error(usage) for others.
double knots_per(const std::string& unit);

/// The dataset with two more point fields: i32 'barb' (number of the shape, -1 where the wind is not finite) and f64 x 9 'barb frame' (the
/// turn in the x-y plane). No unit: the field's own, else m/s with a note. Hemisphere: 'latitude' takes the sign of a point field of
/// degrees, or, where none is named, of y when the data lies within -90..90 and looks like degrees (x within -360..360, at least 10 wide);
/// else north.
DatasetPtr barb_places(const DatasetPtr& data, const std::string& vectors, const BarbParams& p, Context& context);

}  // namespace sg
