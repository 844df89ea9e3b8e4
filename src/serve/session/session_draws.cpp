// SPDX-License-Identifier: Apache-2.0
// Pictures of views.
#include "serve/session/session.h"

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "base/error.h"
#include "serve/renderer/tell.h"
#include "serve/session/limits.h"
#include "serve/session/problem.h"

namespace sg::serve {

namespace {

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

void Session::draw(std::unique_lock<std::mutex>& lock, Work& work, ClientView which) {
  const int id = which.first->id, renderer_view = which.second->request.view;
  WantedView view = *which.second;
  const uint64_t revision = revision_;
  cold_ = false;
  view.request.quality = view.next;
  // While something is dragged legends may be those of before.
  const bool has_legends = view.base > 0 && view.base == view.whole && (view.base == revision || live_);
  if (has_legends) view.request.part = view.whole_area;
  Context& context = begin(work, Work::Kind::picture, id);
  work.view = renderer_view, work.quality = view.next, work.moves = view.moving;
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
    problem = problem_of(e);
  }
  const bool final = view.next == Quality::exact;
  std::shared_ptr<const std::string> message;
  if (problem.empty() && !cancelled)
    message = std::make_shared<const std::string>(frame_message(drawn, view, renderer_view % most_views, revision, final));
  lock.lock();
  end(work);
  if (cancelled && work.took_too_long) cancelled = false, problem = took_too_long(longest_);
  const auto it = clients_.find(id);
  if (it == clients_.end()) return;
  WantedView& now = it->second->views[renderer_view % most_views];
  now.served = std::chrono::steady_clock::now();
  const bool newer = now.n != view.n, late = now.moving && view.moving;  // while it moves, late is better than nothing
  if (revision != revision_ && (cancelled || !problem.empty() || !late)) return;
  if (cancelled) {
    if (work.gave_way && !newer) now.wait(), now.gave_way = true;  // it waits since the first time that it gave way
    return;
  }
  if (!problem.empty()) {
    if (!newer) now.due = false;
    refuse(id, view.n, {{"", "", problem}});
    return;
  }
  if (newer && !late) return;  // another view is wanted
  now.on_its_way = it->second->socket->send_binary(message);
  if (!drawn.part) now.whole = revision, now.whole_area = drawn.area;
  if (newer || now.next != view.next || revision != revision_) return;
  if (view.moving || final) now.due = false;
  else now.next = view.next == Quality::moving ? Quality::draft : Quality::exact;
  now.gave_way = false, now.wait();
}

}  // namespace sg::serve
