// SPDX-License-Identifier: Apache-2.0
#include "base/file/mapped_watch.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <map>
#include <mutex>
#include <utility>

#include "base/error.h"

namespace sg {

namespace {

// What the signal handler reads: blocks of places that are never freed, each free (begin 0) or taken.
struct Place {
  std::atomic<uintptr_t> begin{0}, end{0};
  std::atomic<bool> cut{false};
};
struct Block {
  Place places[512];
  Block* next = nullptr;
};
std::atomic<Block*> blocks{nullptr};
struct sigaction before {};
size_t page_size = 4096;

// Only what is safe in a handler: looks through the places, maps a page of zeros over the one that is gone.
void on_bus_error(int signal, siginfo_t* info, void* state) {
  const auto at = reinterpret_cast<uintptr_t>(info->si_addr);
  const int kept = errno;
  for (Block* b = blocks.load(std::memory_order_acquire); b; b = b->next)
    for (Place& p : b->places) {
      const uintptr_t begin = p.begin.load(std::memory_order_acquire);
      if (begin == 0 || at < begin || at >= p.end.load(std::memory_order_acquire)) continue;
      void* page = reinterpret_cast<void*>(at / page_size * page_size);
      if (::mmap(page, page_size, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == MAP_FAILED) break;
      p.cut.store(true);
      errno = kept;
      return;
    }
  if (before.sa_flags & SA_SIGINFO) {
    if (before.sa_sigaction) return before.sa_sigaction(signal, info, state);
  } else if (before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN) {
    return before.sa_handler(signal);
  }
  ::signal(signal, SIG_DFL);  // ends the program when this returns, as it would have
  ::raise(signal);
}

bool differs(const struct stat& a, const struct stat& b) {
  return a.st_size != b.st_size || a.st_mtim.tv_sec != b.st_mtim.tv_sec || a.st_mtim.tv_nsec != b.st_mtim.tv_nsec;
}

class Watch final : public MappedWatch {
 public:
  Watch() {
    page_size = size_t(::sysconf(_SC_PAGESIZE));
    struct sigaction act {};
    act.sa_sigaction = on_bus_error;
    act.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigemptyset(&act.sa_mask);
    ::sigaction(SIGBUS, &act, &before);
  }

  void add(const void* begin, size_t bytes, const std::string& path, const struct stat& st) override {
    const auto at = reinterpret_cast<uintptr_t>(begin);
    const std::lock_guard lock(mutex_);
    Place* p = free_place();
    p->cut = false;
    p->end.store(at + bytes, std::memory_order_release);
    p->begin.store(at, std::memory_order_release);
    bytes_ever_ += bytes;
    mapped_[at] = {at + bytes, ++count_, p, path, st};
  }

  void remove(const void* begin) noexcept override {
    const std::lock_guard lock(mutex_);
    const auto m = mapped_.find(reinterpret_cast<uintptr_t>(begin));
    if (m == mapped_.end()) return;
    if (has_changed(m->second)) gone_ = m->second.path, gone_number_ = m->second.number;
    m->second.place->begin.store(0, std::memory_order_release);
    free_.push_back(m->second.place);
    mapped_.erase(m);
  }

  bool holds(const void* p) const override {
    const auto at = reinterpret_cast<uintptr_t>(p);
    const std::lock_guard lock(mutex_);
    auto m = mapped_.upper_bound(at);
    return m != mapped_.begin() && at < std::prev(m)->second.end;
  }

  uint64_t now() const override {
    const std::lock_guard lock(mutex_);
    return count_ + 1;
  }

  uint64_t bytes_ever() const override {
    const std::lock_guard lock(mutex_);
    return bytes_ever_;
  }

  std::string changed(uint64_t since) override {
    const std::lock_guard lock(mutex_);
    if (since > 0 && gone_number_ >= since && !gone_.empty()) return std::exchange(gone_, {});
    for (const auto& [at, m] : mapped_)
      if (m.number >= since && has_changed(m)) return m.path;
    return {};
  }

 private:
  struct Mapped {
    uintptr_t end = 0;
    uint64_t number = 0;
    Place* place = nullptr;
    std::string path;
    struct stat st {};
  };

  Place* free_place() {
    if (free_.empty()) {
      auto* b = new Block;
      b->next = blocks.load();
      for (Place& p : b->places) free_.push_back(&p);
      blocks.store(b, std::memory_order_release);
    }
    Place* p = free_.back();
    free_.pop_back();
    return p;
  }

  static bool has_changed(const Mapped& m) {
    if (m.place->cut) return true;
    struct stat now {};
    if (::stat(m.path.c_str(), &now) != 0 || now.st_dev != m.st.st_dev || now.st_ino != m.st.st_ino) return false;
    return differs(now, m.st);
  }

  mutable std::mutex mutex_;
  std::map<uintptr_t, Mapped> mapped_;
  std::vector<Place*> free_;
  uint64_t count_ = 0, gone_number_ = 0, bytes_ever_ = 0;
  std::string gone_;  // a file that had changed when it was unmapped
};

std::atomic<MappedWatch*> shared{nullptr};

}  // namespace

MappedWatch& mapped_watch() {
  if (MappedWatch* w = shared) return *w;
  static Watch* own = new Watch;  // outlives every mapping
  return *own;
}

void share_mapped_watch(MappedWatch* watch) { shared = watch; }

void check_files_unchanged(uint64_t since) {
  if (const std::string path = mapped_watch().changed(since); !path.empty())
    fail_data("the file changed while it was being read", path, "read it again once it has been written completely");
}

}  // namespace sg
