// SPDX-License-Identifier: Apache-2.0
// The source.
#include <memory>

#include "simulate/fluid/smoke.h"
#include "simulate/run/frames.h"

namespace sg {

namespace {

template <class T>
DatasetPtr frame_of_smoke(const SmokeParams& p, Context& context) {
  using Run = fluid::Smoke<T>;
  return frame_of_run<Run>(
      "smoke", p, [&] { return std::make_unique<Run>(p, context); }, context);
}

}  // namespace

DatasetPtr smoke(const SmokeParams& p, Context& context) {
  if (p.advection == fluid::Advection::explicit_euler) context.warn("smoke: explicit advection is unstable and will blow up");
  return p.type == FieldType::f64 ? frame_of_smoke<double>(p, context) : frame_of_smoke<float>(p, context);
}

}  // namespace sg
