// SPDX-License-Identifier: Apache-2.0
// Whose turn it is: what moves comes first, and what can wait does not wait for ever.
#include <algorithm>
#include <chrono>
#include <tuple>
#include <utility>

#include "serve/renderer/tell.h"
#include "serve/session/limits.h"
#include "serve/session/session.h"

namespace sg::serve {

namespace {

constexpr auto progress_pause = std::chrono::milliseconds(200);

}  // namespace

void Session::draw_thread() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const bool dragged = std::chrono::steady_clock::now() < rest_at_;  // what takes longer waits for the end of it
    if (const std::vector<int> left = forgettable(); !left.empty()) {
      lock.unlock();
      for (const int v : left) renderer_->forget(v);
      lock.lock();
    } else if (const ClientView moving = next_view(Quality::moving); moving.second) {
      draw(lock, drawing_, moving);  // a picture at once, then what is told, then better pictures
    } else if (!settled()) {
      work_.wait(lock);
    } else if (dragged) {
      work_.wait_until(lock, rest_at_);
    } else if (cold_ && loaded_ && clients_.empty()) {
      warm_up(lock);  // before what is told: histograms would keep the first picture waiting
    } else if (needs_tell_ && !beside_.is(Work::Kind::state)) {
      tell(lock, drawing_);
    } else if (const ClientView finer = next_view(Quality::exact); finer.second) {
      draw(lock, drawing_, finer);
    } else {
      work_.wait(lock);
    }
  }
}

// Steps run beside what moves. So does, in the end, what has waited for longer than `patience`: nothing that moves interrupts it then.
void Session::patient_thread() {
  constexpr Moment never = Moment::max();
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (!changes_.empty()) {
      const Change change = changes_.front();
      changes_.pop_front();
      make_change(change);
      work_.notify_all();
      continue;
    }
    if (needs_load_ && !abandoned_) {
      load(lock);
      continue;
    }
    const ClientView view = waiting_view();
    const Moment tell_at = loaded_ && needs_tell_ && !drawing_.is(Work::Kind::state) ? tell_since_ + patience : never;
    const Moment draw_at = view.second ? view.second->waits_since + patience : never, first = std::min(tell_at, draw_at);
    const Moment now = std::chrono::steady_clock::now();
    if (first == never) work_.wait(lock);
    else if (const Moment at = std::max(first, rest_at_); at > now) work_.wait_until(lock, at);
    else if (tell_at <= draw_at) tell(lock, beside_);
    else draw(lock, beside_, view);
  }
}

std::vector<Work*> Session::works() {
  std::vector<Work*> all{&drawing_, &beside_};
  for (Work& asking : asking_) all.push_back(&asking);
  return all;
}

// Ends what takes too long.
void Session::clock_thread() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    Work* first = nullptr;
    for (Work* work : works())
      if (work->goes_on() && work->until && !work->took_too_long && (!first || *work->until < *first->until)) first = work;
    if (!first) clock_.wait(lock);
    else if (const Moment until = *first->until; until > std::chrono::steady_clock::now()) clock_.wait_until(lock, until);
    else first->took_too_long = true, first->stop();
  }
}

Context& Session::begin(Work& work, Work::Kind kind, int client, std::chrono::steady_clock::duration spent) {
  work = {std::make_unique<Context>(), kind, client};
  const bool asked_for = kind == Work::Kind::picture || kind == Work::Kind::question || kind == Work::Kind::pipeline;
  if (asked_for && longest_.count() > 0) {
    work.until = std::chrono::steady_clock::now() + longest_ - spent;
    clock_.notify_all();
  }
  if (kind == Work::Kind::question) return *work.context;  // answers tell by themselves how far they are
  work.context->on_progress = [this, client, last = Moment()](double share, std::string_view doing) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (now - last < progress_pause) return;
    last = now;
    const Json::Members message{{"is", text("progress")}, {"share", number(share)}, {"doing", text(std::string(doing))}};
    const std::lock_guard lock(mutex_);
    if (client == 0) send_all(message);
    else send(client, message);
  };
  return *work.context;
}

void Session::end(Work& work) {
  work.context.reset();
  work_.notify_all();  // the other one sees what is left
}

// Views of windows that have gone, as long as none of them is drawn.
std::vector<int> Session::forgettable() {
  const auto kept = std::partition(left_.begin(), left_.end(), [&](int view) { return beside_.draws(view); });
  std::vector<int> gone(kept, left_.end());
  left_.erase(kept, left_.end());
  return gone;
}

// What was edited has run.
bool Session::settled() const { return changes_.empty() && !needs_load_ && !beside_.is(Work::Kind::pipeline); }

// The view that is to have a picture of that quality or a quicker one: quicker ones first, among them those that were served longest ago.
// While steps run only those that move.
Session::ClientView Session::next_view(Quality best) {
  ClientView next{nullptr, nullptr};
  if (!loaded_) return next;
  const auto rank = [](const WantedView& v) { return std::tuple(v.next, v.served); };
  for (auto& [id, client] : clients_)
    for (auto& [number, view] : client->views) {
      if (!view.due || view.on_its_way || view.next > best || !(view.moving || settled())) continue;
      if (view.next != Quality::moving && beside_.draws(view.request.view)) continue;
      if (!next.second || rank(view) < rank(*next.second)) next = {client.get(), &view};
    }
  return next;
}

// Of the views that wait for a better picture, and that nobody draws, the one that has waited longest.
Session::ClientView Session::waiting_view() {
  ClientView longest{nullptr, nullptr};
  if (!loaded_) return longest;
  for (auto& [id, client] : clients_)
    for (auto& [number, view] : client->views) {
      if (!view.due || view.on_its_way || view.next == Quality::moving || drawing_.draws(view.request.view)) continue;
      if (!longest.second || view.waits_since < longest.second->waits_since) longest = {client.get(), &view};
    }
  return longest;
}

void Session::restart_views() {
  for (auto& [id, client] : clients_)
    for (auto& [number, view] : client->views) view.restart();
}

// A view is wanted from elsewhere, or not any more.
void Session::interrupt(int view) {
  if (drawing_.is(Work::Kind::unseen)) drawing_.stop();
  for (Work* work : {&drawing_, &beside_})
    if (work->draws(view)) work->stop();
}

// What is told, and better pictures, are put back where a quicker picture is wanted.
void Session::make_way() {
  const bool picture = drawing_.is(Work::Kind::picture) && drawing_.quality != Quality::moving;
  if (!picture && !drawing_.is(Work::Kind::state)) return;
  const Quality quicker = picture && drawing_.quality == Quality::exact ? Quality::draft : Quality::moving;
  if (next_view(quicker).second) drawing_.gave_way = true, drawing_.stop();
}

}  // namespace sg::serve
