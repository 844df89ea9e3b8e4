// SPDX-License-Identifier: Apache-2.0
#include "simulate/run/kept_frames.h"

#include <algorithm>
#include <list>
#include <map>
#include <mutex>
#include <utility>

namespace sg {

struct KeptFrames::State {
  std::vector<double> times;
  size_t most = 0, bytes = 0;
  std::map<std::pair<std::string, size_t>, DatasetPtr> kept;

  bool wants(const std::string& key, const FrameParams& params, size_t frame) const {
    if (kept.contains({key, frame})) return false;
    return std::any_of(times.begin(), times.end(), [&](double t) { return t >= 0 && last_frame(params, t) == double(frame); });
  }
};

namespace {

std::mutex mutex;
template <class State>
std::list<State>& living() {
  static std::list<State> all;
  return all;
}

size_t bytes_of_frame(const Dataset& d) {
  size_t bytes = d.as<UniformGrid>() ? 0 : 24 * d.point_count() + 40 * d.cell_count();
  for (const Field& f : d.fields()) bytes += f.array.bytes();
  return bytes;
}

}  // namespace

KeptFrames::KeptFrames(std::vector<double> times, size_t most) {
  const std::lock_guard lock(mutex);
  state_ = &living<State>().emplace_back(State{std::move(times), most, 0, {}});
}

KeptFrames::~KeptFrames() {
  std::list<State> gone;  // freed outside of the lock
  const std::lock_guard lock(mutex);
  std::list<State>& all = living<State>();
  gone.splice(gone.begin(), all, std::find_if(all.begin(), all.end(), [&](const State& s) { return &s == state_; }));
}

bool KeptFrames::any() {
  const std::lock_guard lock(mutex);
  return !living<State>().empty();
}

size_t KeptFrames::bytes() {
  const std::lock_guard lock(mutex);
  size_t sum = 0;
  for (const State& s : living<State>()) sum += s.bytes;
  return sum;
}

DatasetPtr KeptFrames::find(const std::string& key, size_t frame) {
  const std::lock_guard lock(mutex);
  for (const State& s : living<State>())
    if (const auto at = s.kept.find({key, frame}); at != s.kept.end()) return at->second;
  return nullptr;
}

bool KeptFrames::wants(const std::string& key, const FrameParams& params, size_t frame) {
  const std::lock_guard lock(mutex);
  const std::list<State>& all = living<State>();
  return std::any_of(all.begin(), all.end(), [&](const State& s) { return s.bytes < s.most && s.wants(key, params, frame); });
}

void KeptFrames::keep(const std::string& key, const FrameParams& params, size_t frame, const DatasetPtr& data) {
  const size_t bytes = bytes_of_frame(*data);
  const std::lock_guard lock(mutex);
  for (State& s : living<State>())
    if (s.bytes + bytes <= s.most && s.wants(key, params, frame)) s.kept.emplace(std::pair{key, frame}, data), s.bytes += bytes;
}

}  // namespace sg
