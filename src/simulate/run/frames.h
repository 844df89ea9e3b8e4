// SPDX-License-Identifier: Apache-2.0
// Runs: simulations whose frames are computed one from another. A run's state is a function of its parameters and the number of the frame
// alone, so that it does not matter who asked for which time before.
#pragma once
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// When, of every simulator.
struct FrameParams {
  double time = 0, frame = 0.04;
};
void describe(Schema& s, FrameParams& p);

/// The last whole frame before p.time. Throws Error(usage) beyond a million frames.
size_t frame_at(const FrameParams& p, const std::string& who);

/// A frame of the run of these parameters: `make()` begins it, or the run that was shown last goes on where it is the same one and has not
/// gone beyond. A Run has size_t frame() const, void advance(const Context&) to the next frame, and DatasetPtr dataset(const Context&)
/// const. `params` may say any time. What else the run depends on, such as the meshes given to it, is told apart by `of`.
template <class Run, class Params, class Make>
DatasetPtr frame_of_run(const std::string& who, Params params, Make&& make, Context& context, const std::string& of = {}) {
  static std::mutex mutex;
  static std::string kept_key;
  static std::unique_ptr<Run> kept;
  const size_t frame = frame_at(params, who);
  params.time = 0;
  const std::string key = params_text(schema_of(params)) + " " + of;
  std::unique_ptr<Run> run;
  {
    const std::lock_guard lock(mutex);
    if (kept && kept_key == key && kept->frame() <= frame) run = std::move(kept);
  }
  if (!run) run = make();
  const size_t first = run->frame();
  while (run->frame() < frame) {
    context.check();
    context.progress(double(run->frame() - first) / double(frame - first), who);
    run->advance(context);
  }
  DatasetPtr result = run->dataset(context);
  const std::lock_guard lock(mutex);
  kept_key = key, kept = std::move(run);
  return result;
}

}  // namespace sg
