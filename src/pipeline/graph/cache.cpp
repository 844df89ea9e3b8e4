// SPDX-License-Identifier: Apache-2.0
#include "pipeline/graph/cache.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <list>
#include <map>
#include <mutex>
#include <set>
#include <tuple>
#include <unordered_map>

namespace sg {

namespace {

struct BufferRef {
  const void* owner;
  const std::byte* data;
  uint64_t size;
};

void add_buffer(const Array& a, std::vector<BufferRef>& out) {
  const Buffer& b = a.buffer();
  if (b.size > 0) out.push_back({b.owner.get(), b.data, b.size});
}

void add_cells(const CellArray& c, std::vector<BufferRef>& out) {
  add_buffer(c.connectivity, out);
  add_buffer(c.offsets, out);
}

void add_mesh(const Mesh& mesh, std::vector<BufferRef>& out) {
  if (auto* m = std::get_if<RectilinearGrid>(&mesh)) {
    for (const Array* a : {&m->x, &m->y, &m->z}) add_buffer(*a, out);
  } else if (auto* m = std::get_if<CurvilinearGrid>(&mesh)) {
    add_buffer(m->points.xyz, out);
  } else if (auto* m = std::get_if<UnstructuredMesh>(&mesh)) {
    for (const Array* a : {&m->points.xyz, &m->types, &m->polyhedron_faces}) add_buffer(*a, out);
    add_cells(m->cells, out);
    add_cells(m->faces, out);
  } else if (auto* m = std::get_if<SurfaceMesh>(&mesh)) {
    add_buffer(m->points.xyz, out);
    for (const CellArray* c : {&m->vertices, &m->lines, &m->polygons, &m->strips}) add_cells(*c, out);
  } else if (auto* m = std::get_if<PointCloud>(&mesh)) {
    add_buffer(m->points.xyz, out);
  }
}

void add_data(const Data& data, std::vector<BufferRef>& out) {
  if (auto* d = std::get_if<DatasetPtr>(&data); d && *d) {
    add_mesh((*d)->mesh(), out);
    for (const Field& f : (*d)->fields()) add_buffer(f.array, out);
    add_buffer((*d)->point_ghost(), out);
    add_buffer((*d)->cell_ghost(), out);
  } else if (auto* c = std::get_if<CollectionPtr>(&data); c && *c) {
    for (const Collection::Part& part : (*c)->parts) add_data(part.data, out);
  } else if (auto* t = std::get_if<TablePtr>(&data); t && *t) {
    for (const Field& f : (*t)->columns) add_buffer(f.array, out);
  }
}

// Each buffer once. Windows into one owner (a mapped file) that begin at different places are different buffers.
std::vector<BufferRef> buffers_of(const Data& data) {
  std::vector<BufferRef> all;
  add_data(data, all);
  auto before = [](const BufferRef& a, const BufferRef& b) {
    return std::tuple(a.owner, a.data, ~a.size) < std::tuple(b.owner, b.data, ~b.size);
  };
  std::sort(all.begin(), all.end(), before);
  auto same = [](const BufferRef& a, const BufferRef& b) { return a.owner == b.owner && a.data == b.data; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

struct KeyHash {
  size_t operator()(const Key& k) const { return size_t(k.lo); }
};

using WeakData = std::variant<std::weak_ptr<const Dataset>, std::weak_ptr<const Collection>, std::weak_ptr<const Table>>;

WeakData weakened(const Data& data) {
  return std::visit([](const auto& p) { return WeakData(std::weak_ptr(p)); }, data);
}

std::optional<Data> locked(const WeakData& weak) {
  return std::visit(
      [](const auto& w) -> std::optional<Data> {
        if (auto p = w.lock()) return Data(p);
        return std::nullopt;
      },
      weak);
}

}  // namespace

uint64_t data_bytes(const Data& data) {
  uint64_t sum = 0;
  for (const BufferRef& b : buffers_of(data)) sum += b.size;
  return sum;
}

struct Cache::State {
  struct Entry {
    Key key;
    Data data;
    std::vector<BufferRef> buffers;
  };
  struct Held {
    uint64_t size = 0;
    size_t entries = 0;
  };
  mutable std::mutex mutex;
  std::condition_variable finished;
  uint64_t limit = 0, bytes = 0;
  std::list<Entry> used;  // most recently used first
  std::unordered_map<Key, std::list<Entry>::iterator, KeyHash> kept;
  std::map<std::pair<const void*, const std::byte*>, Held> held;  // over all entries
  std::unordered_map<Key, WeakData, KeyHash> living;
  size_t sweep_at = 64;
  std::set<Key> running;

  void drop(std::list<Entry>::iterator entry, std::vector<Data>& dying) {
    for (const BufferRef& b : entry->buffers) {
      const auto h = held.find({b.owner, b.data});
      if (--h->second.entries > 0) continue;
      bytes -= h->second.size;
      held.erase(h);
    }
    kept.erase(entry->key);
    dying.push_back(std::move(entry->data));
    used.erase(entry);
  }

  void shrink(uint64_t to, std::vector<Data>& dying) {
    while (bytes > to && !used.empty()) drop(std::prev(used.end()), dying);
  }

  void keep(const Key& key, const Data& data, std::vector<Data>& dying) {
    living.insert_or_assign(key, weakened(data));
    if (living.size() > sweep_at) {  // drop dead entries now and then, at constant cost per result
      std::erase_if(living, [](const auto& item) { return !locked(item.second); });
      sweep_at = 2 * living.size() + 64;
    }
    if (limit == 0 || kept.contains(key)) return;
    std::vector<BufferRef> buffers = buffers_of(data);
    uint64_t own = 0;
    for (const BufferRef& b : buffers) own += b.size;
    if (own > limit) return;  // would push out everything and not fit
    for (const BufferRef& b : buffers) {
      Held& h = held[{b.owner, b.data}];
      if (h.entries++ == 0) h.size = b.size, bytes += b.size;
    }
    used.push_front({key, data, std::move(buffers)});
    kept[key] = used.begin();
    shrink(limit, dying);
  }

  std::optional<Data> find(const Key& key) {
    if (const auto k = kept.find(key); k != kept.end()) {
      used.splice(used.begin(), used, k->second);
      return k->second->data;
    }
    if (const auto l = living.find(key); l != living.end()) {
      if (auto data = locked(l->second)) return data;
      living.erase(l);
    }
    return std::nullopt;
  }
};

Cache::Cache(uint64_t limit) : state_(std::make_unique<State>()) { state_->limit = limit; }
Cache::~Cache() = default;

std::optional<Data> Cache::find(const Key& key) {
  std::lock_guard lock(state_->mutex);
  return state_->find(key);
}

std::optional<uint64_t> Cache::peek(const Key& key) const {
  std::optional<Data> data;
  {
    std::lock_guard lock(state_->mutex);
    if (const auto k = state_->kept.find(key); k != state_->kept.end()) data = k->second->data;
    else if (const auto l = state_->living.find(key); l != state_->living.end()) data = locked(l->second);
  }
  if (!data) return std::nullopt;
  return data_bytes(*data);
}

Data Cache::find_or_compute(const Key& key, Context& context, const std::function<Data()>& compute) {
  State& s = *state_;
  std::unique_lock lock(s.mutex);
  for (;;) {
    if (auto data = s.find(key)) return std::move(*data);
    if (s.running.insert(key).second) break;
    s.finished.wait_for(lock, std::chrono::milliseconds(20));
    lock.unlock();
    context.check();
    lock.lock();
  }
  lock.unlock();
  std::vector<Data> dying;  // freed outside the lock
  auto finish = [&](const Data* result) {
    {
      std::lock_guard relock(s.mutex);
      s.running.erase(key);
      if (result) s.keep(key, *result, dying);
    }
    s.finished.notify_all();
  };
  try {
    Data result = compute();
    finish(&result);
    return result;
  } catch (...) {
    finish(nullptr);
    throw;
  }
}

uint64_t Cache::limit() const {
  std::lock_guard lock(state_->mutex);
  return state_->limit;
}
uint64_t Cache::bytes() const {
  std::lock_guard lock(state_->mutex);
  return state_->bytes;
}
size_t Cache::size() const {
  std::lock_guard lock(state_->mutex);
  return state_->used.size();
}
void Cache::set_limit(uint64_t limit) {
  std::vector<Data> dying;
  std::lock_guard lock(state_->mutex);
  state_->limit = limit;
  state_->shrink(limit, dying);
  if (limit == 0)
    while (!state_->used.empty()) state_->drop(std::prev(state_->used.end()), dying);
}
void Cache::clear() {
  std::vector<Data> dying;
  std::lock_guard lock(state_->mutex);
  while (!state_->used.empty()) state_->drop(std::prev(state_->used.end()), dying);
  state_->living.clear();
}

}  // namespace sg
