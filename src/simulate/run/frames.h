// SPDX-License-Identifier: Apache-2.0
// Runs: simulations whose frames are computed one from another. A run's state is a function of its parameters and the number of the frame
// alone, so that it does not matter who asked for which time before.
#pragma once
#include <concepts>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/context.h"
#include "base/error.h"
#include "base/file/file.h"
#include "data/dataset.h"
#include "simulate/run/frame_params.h"
#include "simulate/run/given_data.h"
#include "simulate/run/kept_frames.h"
#include "simulate/run/state_file.h"

namespace sg {

/// The last whole frame before p.time. Throws Error(usage) beyond a million frames.
size_t frame_at(const FrameParams& p, const std::string& who);

/// What it will about take to show a frame from the beginning, on two cores.
struct RunCost {
  uint64_t bytes = 0;  ///< of the result
  double seconds = 0;
  std::optional<uint64_t> frames = {};  ///< none where there are no frames
  uint64_t steps = 0;                   ///< of all frames together, about; 0: that is not known
  uint64_t stored = 0;                  ///< the frame that a stored state goes on from; `frames` and `steps` are those left
  std::string guess = {};               ///< what the number of steps was guessed from; "": it follows from the parameters
};
/// Of a run whose frames take about so many steps each (0: not known). A stored state is taken for one of this run.
RunCost cost_of_run(const FrameParams& p, const std::string& who, uint64_t bytes, double seconds_a_step, double steps_a_frame);
/// The same where steps take the fastest flow through at most `cfl` cells of size h: `speed` is guessed.
RunCost cost_of_flow(const FrameParams& p, const std::string& who, uint64_t bytes, double seconds_a_step, double cfl, double h,
                     double speed);
/// How many equal steps of this length at most a frame takes.
double equal_steps(double frame, double longest);

/// Whether a run that takes so much is kept for the next call: at most a quarter of the memory allowed.
bool may_keep(size_t bytes, const Context& context);

/// Frames that the runs of this process have computed until now.
uint64_t computed_frames();
namespace detail {
void count_frame();
}

/// A Run lists what its next frame depends on, so that it can be stored: each_part(f) calls f(list) for lists of numbers, whose lengths
/// follow from the parameters, or for a Growing list, whose lengths consistent() checks. resume(context), where there is one, then finds
/// again what follows from them.
template <class Run>
concept Storable = requires(Run& run) {
  run.each_part([](auto&) {});
};

/// The text that a run is stored under: its name and parameters, and the content of what it was given.
std::string key_of_state(const std::string& parameters, const GivenData& given);
/// What is stored at the path. Throws Error(usage) where it belongs to another run than `key`, or to other data, Error(data) where it is
/// damaged.
StateFile state_of_run(const std::string& path, const std::string& key);

/// Goes on from what is stored at the path for the run `key`, unless that lies beyond `frame`; returns whether it does. Throws Error(usage)
/// where something else is there.
template <Storable Run>
bool go_on(Run& run, const std::string& path, const std::string& key, size_t frame, const Context& context) {
  if (!file_exists(path)) return false;
  StateFile file = state_of_run(path, key);
  if (file.frame() > frame) return false;
  run.each_part([&](auto& list) { file.fill(list); });
  if constexpr (requires {
                  { run.consistent() } -> std::convertible_to<bool>;
                })
    if (!run.consistent()) file.fail_length();
  if (run.frame() != file.frame()) file.fail_length();
  if constexpr (requires { run.resume(context); }) run.resume(context);
  return true;
}
template <Storable Run>
void store(Run& run, const std::string& path, const std::string& key) {
  StateWriter file(path, key, run.frame());
  run.each_part([&](auto& list) { file.add(list); });
  file.commit();
}

/// A frame of the run of these parameters: `make()` begins it, or the run that was shown last goes on where it is the same one and has not
/// gone beyond, or the one stored. A Run has size_t frame() const, void advance(const Context&) to the next frame,
/// DatasetPtr dataset(const Context&) const, and, where it takes much memory, size_t bytes() const. `params` may say any time. `given`: the
/// data that the run depends on besides, which it holds.
template <Storable Run, class Params, class Make>
DatasetPtr frame_of_run(const std::string& who, Params params, Make&& make, Context& context, const GivenData& given = {}) {
  static std::mutex mutex;
  static std::string kept_key, kept_store;  // and where it was stored
  static std::unique_ptr<Run> kept;
  const size_t frame = frame_at(params, who);
  const FrameParams frames = params;
  params.time = 0, params.store.clear(), params.store_every = FrameParams().store_every;
  const std::string parameters = who + " " + params_text(schema_of(params)), key = parameters + " " + given.objects();
  // Kept frames outlive what a run was given: their name is its content, not where it lies.
  const std::string kept_name = given.empty() || !KeptFrames::any() ? key : key_of_state(parameters, given);
  if (frames.store.empty())
    if (DatasetPtr kept_data = KeptFrames::find(kept_name, frame)) return kept_data;
  bool stores = !frames.store.empty();
  const std::string state = stores ? key_of_state(parameters, given) : std::string();
  std::unique_ptr<Run> run;
  bool stored_here = false;
  {
    const std::lock_guard lock(mutex);
    if (kept && kept_key == key && kept->frame() <= frame) run = std::move(kept), stored_here = kept_store == frames.store;
  }
  if (run && stores && !stored_here && file_exists(frames.store)) stores = state_of_run(frames.store, state).frame() <= frame;
  if (!run) {
    run = make();
    if (stores) stores = go_on(*run, frames.store, state, frame, context) || !file_exists(frames.store);
  }
  const size_t first = run->frame();
  while (run->frame() < frame) {
    context.check();
    context.progress(double(run->frame() - first) / double(frame - first), who);
    run->advance(context);
    detail::count_frame();
    if (run->frame() < frame && KeptFrames::wants(kept_name, frames, run->frame()))
      KeptFrames::keep(kept_name, frames, run->frame(), run->dataset(context));
    if (stores && (run->frame() % size_t(frames.store_every) == 0 || run->frame() == frame)) store(*run, frames.store, state);
  }
  DatasetPtr result = run->dataset(context);
  KeptFrames::keep(kept_name, frames, frame, result);
  const std::lock_guard lock(mutex);
  kept.reset();
  size_t bytes = 0;
  if constexpr (requires { run->bytes(); }) bytes = run->bytes();
  if (may_keep(bytes, context)) kept_key = key, kept_store = stores ? frames.store : std::string(), kept = std::move(run);
  return result;
}

}  // namespace sg
