// SPDX-License-Identifier: Apache-2.0
// The thread that draws.
#include "serve/session/session.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "serve/renderer/tell.h"
#include "serve/session/limits.h"

namespace sg::serve {

namespace {

constexpr auto progress_pause = std::chrono::milliseconds(200);

std::string frame_message(const DrawnView& drawn, const WantedView& view, int number, uint64_t revision, bool final) {
  const Json header(
      Json::Members{{"is", text("frame")},
                    {"n", Json(view.n)},
                    {"view", Json(int64_t(number))},
                    {"revision", Json(revision)},
                    {"type", text(drawn.type)},
                    {"size", numbers({double(drawn.width), double(drawn.height)})},
                    {"of", numbers({double(view.request.width), double(view.request.height)})},
                    {"part", Json(drawn.part)},
                    {"coarse", Json(drawn.coarse)},
                    {"final", Json(final)},
                    {"told", text(drawn.told)},
                    {"camera", camera_json(drawn.camera)},
                    {"area", numbers({double(drawn.area[0]), double(drawn.area[1]), double(drawn.area[2]), double(drawn.area[3])})},
                    {"milliseconds", Json(1000 * drawn.seconds)}});
  const std::string head = header.dump();
  std::string message;
  message.reserve(4 + head.size() + drawn.bytes->size());
  for (int i = 0; i < 4; ++i) message += char(head.size() >> 8 * i & 255);
  return message + head + *drawn.bytes;
}

}  // namespace

void Session::draw_thread() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const bool dragged = std::chrono::steady_clock::now() < rest_at_;  // what takes longer waits for the end of it
    if (!left_.empty()) {
      const std::vector<int> left = std::exchange(left_, {});
      lock.unlock();
      for (const int v : left) renderer_->forget(v);
      lock.lock();
    } else if (!changes_.empty()) {
      const Change change = changes_.front();
      changes_.pop_front();
      make_change(change);
    } else if (needs_load_) {
      load(lock);
    } else if (auto [client, view] = next_view(true); view) {  // a picture at once, then what is told, then better pictures
      draw(lock, *client, *view);
    } else if (dragged) {
      work_.wait_until(lock, rest_at_);
    } else if (needs_tell_) {
      tell(lock);
    } else if (auto [any, finer] = next_view(false); finer) {
      draw(lock, *any, *finer);
    } else if (cold_ && loaded_) {
      warm_up(lock);
    } else {
      work_.wait(lock);
    }
  }
}

Context& Session::begin_work(int view) {
  running_ = std::make_unique<Context>(), running_view_ = view;
  running_->on_progress = [this, last = std::chrono::steady_clock::time_point{}](double share, std::string_view doing) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (now - last < progress_pause) return;
    last = now;
    const std::lock_guard lock(mutex_);
    send_all({{"is", text("progress")}, {"share", number(share)}, {"doing", text(std::string(doing))}});
  };
  return *running_;
}

// The view that has waited longest, moving ones and first pictures before others.
std::pair<Client*, WantedView*> Session::next_view(bool coarse_only) {
  std::pair<Client*, WantedView*> best{nullptr, nullptr};
  if (!loaded_) return best;
  const auto rank = [](const WantedView& v) { return std::tuple(v.next != Quality::moving, !v.moving, v.served); };
  for (auto& [id, client] : clients_)
    for (auto& [number, view] : client->views) {
      if (!view.due || view.on_its_way || (coarse_only && view.next != Quality::moving)) continue;
      if (!best.second || rank(view) < rank(*best.second)) best = {client.get(), &view};
    }
  return best;
}

// What is drawn by paths grows while nothing else is wanted.
void Session::send_finer(int id, const DrawnView& drawn, const WantedView& view, uint64_t revision) {
  const int number = view.request.view % most_views;
  const std::lock_guard lock(mutex_);
  const auto it = clients_.find(id);
  if (it == clients_.end() || revision != revision_) return;
  WantedView& now = it->second->views[number];
  if (now.n != view.n || now.on_its_way) return;
  now.on_its_way =
      it->second->socket->send_binary(std::make_shared<const std::string>(frame_message(drawn, view, number, revision, false)));
  now.whole = revision, now.whole_area = drawn.area;
}

void Session::draw(std::unique_lock<std::mutex>& lock, Client& client, WantedView& wanted) {
  const int id = client.id, renderer_view = wanted.request.view;
  WantedView view = wanted;
  const uint64_t revision = revision_;
  view.request.quality = view.next;
  // While something is dragged legends may be those of before.
  const bool has_legends = view.base > 0 && view.base == view.whole && (view.base == revision || live_);
  if (has_legends) view.request.part = view.whole_area;
  Context& context = begin_work(renderer_view);
  lock.unlock();
  DrawnView drawn;
  std::string problem;
  bool cancelled = false;
  try {
    drawn = renderer_->draw(
        view.request, [&](const DrawnView& finer) { send_finer(id, finer, view, revision); }, context);
  } catch (const Error& e) {
    cancelled = e.kind() == ErrorKind::cancelled, problem = e.what();
  } catch (const std::exception& e) {
    problem = e.what();
  }
  const bool final = view.next == Quality::exact;
  std::shared_ptr<const std::string> message;
  if (problem.empty() && !cancelled)
    message = std::make_shared<const std::string>(frame_message(drawn, view, renderer_view % most_views, revision, final));
  lock.lock();
  running_.reset();
  const auto it = clients_.find(id);
  if (it == clients_.end()) return;
  WantedView& now = it->second->views[renderer_view % most_views];
  now.served = std::chrono::steady_clock::now();
  if (cancelled) return;
  const bool newer = now.n != view.n;
  if (!problem.empty()) {
    if (!newer) now.due = false;
    refuse(id, view.n, {{"", "", problem}});
    return;
  }
  if (newer && !(now.moving && view.moving)) return;  // another view is wanted; while both move, late is better than nothing
  now.on_its_way = it->second->socket->send_binary(message);
  if (!drawn.part) now.whole = revision, now.whole_area = drawn.area;
  if (newer || now.next != view.next) return;
  if (view.moving || final) now.due = false;
  else now.next = view.next == Quality::moving ? Quality::draft : Quality::exact;
}

}  // namespace sg::serve
