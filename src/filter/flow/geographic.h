// SPDX-License-Identifier: Apache-2.0
// Flows over longitude and latitude whose velocities are metres a second: traced unconverted, they would move a degree for each metre.
#pragma once
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Positions are in degrees and the velocity is in metres per second, according to the file (units of the coordinates and of the field).
bool needs_geographic(const Dataset& d, const Field& velocity);
/// Warns if so, and says what helps.
void warn_of_degrees(const Dataset& d, const Field& velocity, std::string_view who, Context& context);
/// Seconds in a unit of the file's time ("days since ...": 86400); 1 when it has none.
double seconds_of_time(const Dataset& d);

/// The datasets of `data` that have the point field `field` (2 or 3 components, m/s, or what its unit says: cm/s, km/h, knots), with
/// degrees of longitude (x) and latitude (y) in `seconds` in its place, f32: v_x / cos(latitude) on a sphere of 6371 km; z stays metres.
/// Throws Error(usage) naming `who` for latitudes beyond 90 degrees and for a field on cells.
Data geographic_flow(const Data& data, const std::string& field, double seconds, std::string_view who);
/// The other way round, of what was traced: the velocity `field` of its points, and their "speed".
DatasetPtr in_metres(const DatasetPtr& traced, const std::string& field, double seconds);

}  // namespace sg
