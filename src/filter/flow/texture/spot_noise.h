// SPDX-License-Identifier: Apache-2.0
// spot_noise: a texture of many small spots that the flow stretches and bends.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct SpotNoiseParams {
  FieldName field;
  double radius = 4, stretch = 4, density = 3;
  bool bent = true;
  double contrast = 0.22;
  int64_t seed = 1;
  int64_t resolution = 0;
};
void describe(Schema& s, SpotNoiseParams& p);

/// The point field "spot noise" on a uniform grid (of texture::make_frame), of mean 0 and the standard deviation `contrast`, not clamped:
/// spots of intensity 1 or -1 at random places, fading to their rims, added up (van Wijk 1991). Where the flow is fastest a spot is
/// (1 + stretch) radius long to each side and radius/(1 + stretch) wide, so that its area stays; where there is none it is round. Bent
/// spots follow the streamline through their middle (de Leeuw and van Wijk 1995): a band of quads along it, each drawn as long as the line
/// goes. NaN where the flow has no value. Flat data only. The input's fields come along. Tiles of pixels add the spots that touch them in
/// the order of their numbers: threads do not matter. Throws Error(usage) as lic() does, and for solid data. O(spots area).
DatasetPtr spot_noise(const DatasetPtr& input, const SpotNoiseParams& params, Context& context);
/// The operation.
Data spot_noise_of(const Data& input, const SpotNoiseParams& params, Context& context);

}  // namespace sg
