// SPDX-License-Identifier: Apache-2.0
#include "simulate/run/frames.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/error.h"

namespace sg {

void describe(Schema& s, FrameParams& p) {
  s("time", p.time, "When, from 0 on: the last whole frame before it is shown.").unit("time").at_least(0);
  s("frame", p.frame, "Time from frame to frame; each is computed from the one before.").unit("time").positive();
  s("store", p.store, "File that keeps the state of the run: a run that was broken off goes on from it, with the same numbers.")
      .unit("new file");
  s("store_every", p.store_every, "Frames after which the state is stored; the last one is in any case.").range(1, 1000000);
}

size_t frame_at(const FrameParams& p, const std::string& who) {
  if (!std::isfinite(p.frame)) fail_usage("frames of infinite length", who + " frame", "give a finite time");
  const double frames = std::floor(p.time / p.frame * (1 + 1e-12) + 1e-9);
  if (!(frames <= 1e6)) fail_usage("that is more than a million frames away", who + " time", "ask for an earlier time or longer frames");
  return size_t(frames);
}

double equal_steps(double frame, double longest) { return std::max(1.0, std::ceil(frame / longest * (1 - 1e-12))); }

RunCost cost_of_run(const FrameParams& p, const std::string& who, uint64_t bytes, double seconds_a_step, double steps_a_frame) {
  const double frames = double(frame_at(p, who)), steps = frames * std::max(1.0, steps_a_frame);
  return {bytes, steps * seconds_a_step, uint64_t(frames), steps_a_frame > 0 ? uint64_t(std::min(steps, 1e18)) : 0};
}

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
