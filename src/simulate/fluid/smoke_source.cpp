// SPDX-License-Identifier: Apache-2.0
// The source: frames are computed one from another, and the last one computed is kept for the next call.
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "base/error.h"
#include "simulate/fluid/smoke.h"

namespace sg {

namespace {

using fluid::Smoke;

// A run that may go on. Its state is a function of the parameters and the frame alone, so that it does not matter who asked before.
template <class T>
struct Kept {
  std::mutex mutex;
  std::string of;
  std::unique_ptr<Smoke<T>> run;
};

template <class T>
DatasetPtr frame_of(const SmokeParams& p, size_t frame, Context& context) {
  static Kept<T> kept;
  SmokeParams timeless = p;
  timeless.time = 0;
  const std::string key = params_text(schema_of(timeless));
  std::unique_ptr<Smoke<T>> run;
  {
    const std::lock_guard lock(kept.mutex);
    if (kept.run && kept.of == key && kept.run->frame() <= frame) run = std::move(kept.run);
  }
  if (!run) run = std::make_unique<Smoke<T>>(timeless, context);
  const size_t first = run->frame();
  while (run->frame() < frame) {
    context.check();
    context.progress(double(run->frame() - first) / double(frame - first), "smoke");
    run->advance(context);
  }
  const DatasetPtr result = run->dataset(context);
  const std::lock_guard lock(kept.mutex);
  kept.of = key, kept.run = std::move(run);
  return result;
}

}  // namespace

DatasetPtr smoke(const SmokeParams& p, Context& context) {
  const double frames = std::floor(p.time / p.frame * (1 + 1e-12) + 1e-9);
  if (!(frames <= 1e6)) fail_usage("that is more than a million frames away", "smoke time", "ask for an earlier time or longer frames");
  if (p.advection == fluid::Advection::explicit_euler) context.warn("smoke: explicit advection is unstable and will blow up");
  return p.type == FieldType::f64 ? frame_of<double>(p, size_t(frames), context) : frame_of<float>(p, size_t(frames), context);
}

}  // namespace sg
