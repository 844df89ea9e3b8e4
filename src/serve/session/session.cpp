// SPDX-License-Identifier: Apache-2.0
// Its beginning and end, who is there, and what is sent.
#include "serve/session/session.h"

#include "serve/guard/token.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

static_assert(answering.size() + 2 == Renderer::most_callers);  // two draw

std::shared_ptr<Session> Session::open(std::unique_ptr<Renderer> renderer, PipelineFile file, std::string title, std::string pictures_in,
                                       std::chrono::milliseconds longest) {
  std::shared_ptr<Session> s(new Session(std::move(renderer), std::move(file), std::move(title), std::move(pictures_in), longest));
  s->threads_.emplace_back([p = s.get()] { p->draw_thread(); });
  s->threads_.emplace_back([p = s.get()] { p->patient_thread(); });
  for (size_t i = 0; i < answering.size(); ++i) s->threads_.emplace_back([p = s.get(), i] { p->ask_thread(i); });
  if (longest.count() > 0) s->threads_.emplace_back([p = s.get()] { p->clock_thread(); });
  return s;
}

Session::Session(std::unique_ptr<Renderer> renderer, PipelineFile file, std::string title, std::string pictures_in,
                 std::chrono::milliseconds longest)
    : renderer_(std::move(renderer)),
      title_(std::move(title)),
      pictures_in_(std::move(pictures_in)),
      longest_(longest),
      history_(file),
      good_(std::move(file)) {}

Session::~Session() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (Work* work : works()) work->stop();
  }
  work_.notify_all(), questions_wait_.notify_all(), clock_.notify_all();
  for (std::thread& t : threads_) t.join();
}

size_t Session::clients() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

std::optional<Saved> Session::saved(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [known, saved] : saved_)
    if (same_secret(known, id)) return saved;
  return std::nullopt;
}

SocketHandler Session::join(Rights rights, const std::string& user, std::shared_ptr<Socket> socket) {
  const std::lock_guard lock(mutex_);
  const int id = next_client_++;
  auto client = std::make_unique<Client>();
  client->id = id, client->rights = rights, client->user = user, client->socket = std::move(socket);
  abandoned_ = false;
  if (!failed_.empty() && clients_.empty()) failed_.clear(), needs_load_ = true;  // the file may be another one by now
  clients_[id] = std::move(client);
  if (!state_.empty()) {
    Json::Members own = parse_json(state_, "state").members();
    own.emplace_back("may_edit", Json(rights == Rights::edit));
    send(id, own);
  }
  if (!failed_.empty()) refuse(id, 0, {{"", "", failed_}});
  tell_people();
  work_.notify_all();
  const std::weak_ptr<Session> self = weak_from_this();
  return {[self, id](std::string_view text) {
            if (const auto s = self.lock()) s->take_message(id, text);
          },
          [self, id] {
            if (const auto s = self.lock()) s->leave(id);
          }};
}

void Session::leave(int id) {
  const std::lock_guard lock(mutex_);
  const auto it = clients_.find(id);
  if (it == clients_.end()) return;
  for (const auto& [number, view] : it->second->views) interrupt(view.request.view), left_.push_back(view.request.view);
  work_.notify_all();
  clients_.erase(it);
  questions_.leave(id);
  if (clients_.empty() && !loaded_) abandoned_ = true, beside_.stop();
  for (Work& asking : asking_)
    if (asking.client == id) asking.stop();
  tell_people();
}

void Session::send(int id, const Json::Members& message) {
  const auto it = clients_.find(id);
  if (it != clients_.end()) it->second->socket->send_text(Json(message).dump());
}

void Session::send_all(const Json::Members& message) {
  const std::string words = Json(message).dump();
  for (const auto& [id, client] : clients_) client->socket->send_text(words);
}

// 0: all windows.
void Session::refuse(int id, uint64_t n, const std::vector<EditMistake>& mistakes) {
  std::vector<Json> errors;
  for (const EditMistake& m : mistakes)
    errors.emplace_back(Json::Members{{"at", text(m.at)}, {"word", text(m.word)}, {"text", text(m.text)}});
  const Json::Members message{{"is", text("refused")}, {"n", Json(n)}, {"errors", Json(std::move(errors))}};
  if (id == 0) send_all(message);
  else send(id, message);
}

void Session::tell_people() {
  for (const auto& [id, client] : clients_) {
    std::vector<Json> cursors;
    for (const auto& [other, c] : clients_)
      if (other != id && !c->cursor.empty()) cursors.push_back(parse_json(c->cursor, "cursor"));
    Json::Members people{{"is", text("people")},
                         {"count", Json(uint64_t(clients_.size()))},
                         {"cursors", Json(std::move(cursors))},
                         {"together", Json(together_)}};
    if (common_) people.emplace_back("camera", camera_json(*common_));
    if (common_) people.emplace_back("led", Json(leader_ == id));
    client->socket->send_text(Json(std::move(people)).dump());
  }
}

}  // namespace sg::serve
