// SPDX-License-Identifier: Apache-2.0
// When a simulator is shown, and where its state is kept.
#pragma once
#include <string>

#include "base/schema/schema.h"

namespace sg {

/// Of every simulator.
struct FrameParams {
  double time = 0, frame = 0.04;
  std::string store;
  int store_every = 10;
};
void describe(Schema& s, FrameParams& p);

/// The number of the last whole frame before a time.
double last_frame(const FrameParams& p, double time);

}  // namespace sg
