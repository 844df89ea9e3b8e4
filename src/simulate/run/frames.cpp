// SPDX-License-Identifier: Apache-2.0
#include "simulate/run/frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string_view>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"

namespace sg {

void describe(Schema& s, FrameParams& p) {
  s("time", p.time, "When, from 0 on: the last whole frame before it is shown.").unit("time").at_least(0);
  s("frame", p.frame, "Time from frame to frame; each is computed from the one before.").unit("time").positive();
  s("store", p.store, "File that keeps the state of the run: a run that was broken off goes on from it, with the same numbers.")
      .unit("new file");
  s("store_every", p.store_every, "Frames after which the state is stored; the last one is in any case.").range(1, 1000000);
}

double last_frame(const FrameParams& p, double time) { return std::floor(time / p.frame * (1 + 1e-12) + 1e-9); }

size_t frame_at(const FrameParams& p, const std::string& who) {
  if (!std::isfinite(p.frame)) fail_usage("frames of infinite length", who + " frame", "give a finite time");
  const double frames = last_frame(p, p.time);
  if (!(frames <= 1e6)) fail_usage("that is more than a million frames away", who + " time", "ask for an earlier time or longer frames");
  return size_t(frames);
}

double equal_steps(double frame, double longest) { return std::max(1.0, std::ceil(frame / longest * (1 - 1e-12))); }

RunCost cost_of_run(const FrameParams& p, const std::string& who, uint64_t bytes, double seconds_a_step, double steps_a_frame) {
  const uint64_t last = frame_at(p, who);
  uint64_t stored = 0;
  try {
    if (!p.store.empty() && file_exists(p.store)) stored = StateFile(p.store).frame();
  } catch (const Error&) {
    // For the run to report.
  }
  if (stored > last) stored = 0;  // it begins anew for what lies before
  const double frames = double(last - stored), steps = frames * std::max(1.0, steps_a_frame);
  return {bytes, steps * seconds_a_step, last - stored, steps_a_frame > 0 ? uint64_t(std::min(steps, 1e18)) : 0, stored};
}

RunCost cost_of_flow(const FrameParams& p, const std::string& who, uint64_t bytes, double seconds_a_step, double cfl, double h,
                     double speed) {
  RunCost cost = cost_of_run(p, who, bytes, seconds_a_step, std::max(1.0, std::ceil(p.frame * speed / (cfl * h))));
  cost.guess = fmt::format("cfl={} at speeds of about {:.2g}", exact_number(cfl), speed);
  return cost;
}

namespace {

std::atomic<uint64_t> frames_so_far = 0;

}  // namespace

uint64_t computed_frames() { return frames_so_far; }
void detail::count_frame() { ++frames_so_far; }

namespace {

constexpr std::string_view before_content = "\ndata ";

std::string_view parameters_of(std::string_view key) { return key.substr(0, key.rfind(before_content)); }

}  // namespace

std::string key_of_state(const std::string& parameters, const GivenData& given) {
  return given.empty() ? parameters : parameters + std::string(before_content) + given.content();
}

StateFile state_of_run(const std::string& path, const std::string& key) {
  StateFile file(path);
  if (file.key() == key) return file;
  const bool other_data = key.find(before_content) != key.npos && parameters_of(file.key()) == parameters_of(key);
  fail_usage(
      other_data ? "is the state of this run in other data: the mesh or a field that it depends on differs" : "is the state of another run",
      "'" + path + "'", "remove it, or name another file as store");
}

bool may_keep(size_t bytes, const Context& context) { return context.memory_limit == 0 || bytes <= context.memory_limit / 4; }

}  // namespace sg
